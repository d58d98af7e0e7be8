//! Where a surface passes through itself.
use super::TetMesh;
use super::adjacency::{FACES, MatchedFaces, NONE};
use super::box_tree::{Bounds, BoxTree};
use super::numbers::from_one;
use super::triangle_pair::{Corners, crossing};
use super::unfolded::are_unfolded;
use super::vector::Vec3;
use crate::tasks::Team;
use serde::Serialize;

/// Two triangles that cross.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Crossing {
    /// The triangles, the lower number first; from 0, in JSON from 1.
    #[serde(serialize_with = "from_one")]
    pub triangles: [usize; 2],
    /// Where they meet.
    pub at: Vec3,
}

/// The pairs of triangles that cross.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Crossings {
    /// How many there are.
    pub count: usize,
    /// The first few, in the order of the triangles.
    pub first: Vec<Crossing>,
}

/// Where the boundary of a mesh of positive tetrahedra passes through itself; triangles are numbered in the order of the tetrahedra that
/// they bound. At most `told` pairs are named.
pub fn of_boundary(team: Team<'_>, mesh: &TetMesh, faces: &MatchedFaces, told: usize) -> Crossings {
    let triangles = team.collect(1 << 12, mesh.tets.len(), |range, found| {
        for t in range {
            let open = (0..4).filter(|&i| faces.neighbours[t][i] == NONE);
            found.extend(open.map(|i| FACES[i].map(|k| mesh.tets.nodes[t][k])));
        }
    });
    crossings(team, &triangles, |v| mesh.vertices[v as usize], told)
}

/// Pairs of triangles, all looking outward, that pass through each other ([`crossing`]). At most `told` of them are named. The result does
/// not depend on the threads.
pub fn crossings(team: Team<'_>, triangles: &[[u32; 3]], at: impl Fn(u32) -> Vec3 + Sync, told: usize) -> Crossings {
    crossings_of(team, triangles, at, |_| true, crossing, told)
}

/// A test of two triangles, by their nodes and corners, that gives where they meet.
pub type Test = fn((&[u32; 3], &Corners), (&[u32; 3], &Corners)) -> Option<Vec3>;

/// As [`crossings`], of the triangles that are asked for, with each other and with all, by a test.
pub fn crossings_of(
    team: Team<'_>,
    triangles: &[[u32; 3]],
    at: impl Fn(u32) -> Vec3 + Sync,
    is_asked: impl Fn(usize) -> bool + Sync,
    test: Test,
    told: usize,
) -> Crossings {
    let count = triangles.len();
    if !(0..count).any(&is_asked) {
        return Crossings::default();
    }
    let corners = |i: usize| triangles[i].map(&at);
    let unfolded = are_unfolded(team, triangles, &at);
    // Neighbours at a vertex that is safe need no test; most pairs with boxes that overlap are such.
    let is_safe = |v: u32, other: &[u32; 3]| unfolded[v as usize] && other.contains(&v);
    let bounds = |i: u32| bounds(&corners(i as usize));
    let asked: Vec<bool> = (0..count).map(is_asked).collect();
    let tree = BoxTree::on(team, count, bounds);
    let parts = tree.overlapping_pairs(
        team,
        bounds,
        |_, _| true,
        |found: &mut Crossings, i, j| {
            let [i, j] = [i.min(j) as usize, i.max(j) as usize];
            let (a, b) = (&triangles[i], &triangles[j]);
            if !(asked[i] || asked[j]) || a.iter().any(|&v| is_safe(v, b)) {
                return;
            }
            if let Some(at) = test((a, &corners(i)), (b, &corners(j))) {
                found.add(Crossing { triangles: [i, j], at }, told);
            }
        },
    );
    let mut all = Crossings::default();
    for part in parts {
        all.count += part.count;
        all.first.extend(part.first);
    }
    all.keep_first(told);
    all
}

impl Crossings {
    /// Counts a pair. No more than twice as many as are told are kept.
    fn add(&mut self, crossing: Crossing, told: usize) {
        self.count += 1;
        self.first.push(crossing);
        if self.first.len() >= told.saturating_mul(2).max(1 << 6) {
            self.keep_first(told);
        }
    }

    fn keep_first(&mut self, told: usize) {
        self.first.sort_unstable_by_key(|crossing| crossing.triangles);
        self.first.truncate(told);
    }
}

/// The box of a triangle.
fn bounds([p, q, r]: &Corners) -> Bounds {
    [[0, 1, 2].map(|k| p[k].min(q[k]).min(r[k])), [0, 1, 2].map(|k| p[k].max(q[k]).max(r[k]))]
}

#[cfg(test)]
mod tests {
    use super::super::samples::cube;
    use super::*;
    use crate::tasks::{Plan, Pool};

    #[test]
    fn a_cube_does_not_cross_itself() {
        let mesh = cube(6);
        let faces = MatchedFaces::of(Team::alone(), &mesh.tets.nodes);
        assert_eq!(of_boundary(Team::alone(), &mesh, &faces, 3), Crossings::default());
    }

    #[test]
    fn two_cubes_cross_and_the_threads_do_not_matter() {
        let mut mesh = cube(8);
        let (vertices, triangles) = (mesh.vertices.clone(), mesh.triangles.nodes.clone());
        let count = vertices.len() as u32;
        mesh.vertices.extend(vertices.iter().map(|p| p.map(|x| 0.71 * x + 0.5)));
        mesh.triangles.nodes.extend(triangles.iter().map(|t| t.map(|v| v + count)));
        let at = |v: u32| mesh.vertices[v as usize];
        let all = &mesh.triangles.nodes;
        let alone = crossings(Team::alone(), all, at, 5);
        assert!(alone.count > 20 && alone.first.len() == 5, "{alone:?}");
        // Every pair is there once; one of each cube.
        let mut plain = 0;
        for i in 0..triangles.len() {
            let crosses = |j: usize| crossing((&all[i], &all[i].map(at)), (&all[j], &all[j].map(at))).is_some();
            plain += (i + 1..all.len()).filter(|&j| crosses(j)).count();
        }
        assert_eq!(alone.count, plain);
        for Crossing { triangles: [i, j], at } in &alone.first {
            assert!(*i < triangles.len() && *j >= triangles.len());
            assert!(at.iter().all(|x| (0.5..=1.0).contains(x)), "{at:?}");
        }
        for threads in [2, 3] {
            let pool = Pool::new(threads).unwrap();
            let team = Team::new(&pool, Plan::default());
            assert_eq!(crossings(team, all, at, 5), alone);
        }
    }
}
