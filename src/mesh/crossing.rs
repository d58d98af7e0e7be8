//! Where a surface passes through itself.
use super::TetMesh;
use super::adjacency::{FACES, MatchedFaces, NONE};
use super::box_tree::{Bounds, BoxTree};
use super::triangle_pair::{Corners, meeting};
use super::vector::Vec3;
use crate::tasks::Team;
use serde::Serialize;

/// Triangles a task.
const GRAIN: usize = 256;

/// Two triangles that cross.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Crossing {
    /// The triangles, the lower number first.
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
/// they bound. So many are told.
pub fn of_boundary(team: Team<'_>, mesh: &TetMesh, faces: &MatchedFaces, told: usize) -> Crossings {
    let triangles = team.collect(1 << 12, mesh.tets.len(), |range, found| {
        for t in range {
            let open = (0..4).filter(|&i| faces.neighbours[t][i] == NONE);
            found.extend(open.map(|i| FACES[i].map(|k| mesh.vertices[mesh.tets.nodes[t][k] as usize])));
        }
    });
    crossings(team, triangles.len(), |i| triangles[i], told)
}

/// Pairs of triangles, all looking outward, that have more in common than corners and edges ([`meeting`]); of these so many are told.
/// The result does not depend on the threads.
pub fn crossings(team: Team<'_>, count: usize, corners: impl Fn(usize) -> Corners + Sync, told: usize) -> Crossings {
    if count == 0 {
        return Crossings::default();
    }
    let tree = BoxTree::new(count, |i| bounds(&corners(i as usize)));
    let parts = team.chunks(GRAIN, count, |range| {
        let mut found = Crossings::default();
        let mut near: Vec<usize> = Vec::new();
        for i in range {
            let a = corners(i);
            let around = bounds(&a);
            near.clear();
            tree.overlapping(&around, |j| near.extend((j as usize > i).then_some(j as usize)));
            near.sort_unstable();
            for &j in &near {
                let b = corners(j);
                let Some(at) = overlap(&around, &b).then(|| meeting(&a, &b)).flatten() else { continue };
                found.count += 1;
                if found.first.len() < told {
                    found.first.push(Crossing { triangles: [i, j], at });
                }
            }
        }
        found
    });
    let mut all = Crossings::default();
    for part in parts {
        all.count += part.count;
        all.first.extend(part.first.into_iter().take(told - all.first.len()));
    }
    all
}

/// The box of a triangle.
fn bounds([p, q, r]: &Corners) -> Bounds {
    [[0, 1, 2].map(|k| p[k].min(q[k]).min(r[k])), [0, 1, 2].map(|k| p[k].max(q[k]).max(r[k]))]
}

/// Whether a triangle's box touches another.
fn overlap([low, high]: &Bounds, b: &Corners) -> bool {
    let [from, to] = bounds(b);
    (0..3).all(|k| low[k] <= to[k] && from[k] <= high[k])
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
        let corners = |i: usize| mesh.triangles.nodes[i].map(|v| mesh.vertices[v as usize]);
        let count = mesh.triangles.len();
        let alone = crossings(Team::alone(), count, corners, 5);
        assert!(alone.count > 20 && alone.first.len() == 5, "{alone:?}");
        // Every pair is there once; one of each cube.
        let mut plain = 0;
        for i in 0..triangles.len() {
            plain += (0..2 * triangles.len()).filter(|&j| j > i && meeting(&corners(i), &corners(j)).is_some()).count();
        }
        assert_eq!(alone.count, plain);
        for Crossing { triangles: [i, j], at } in &alone.first {
            assert!(*i < triangles.len() && *j >= triangles.len());
            assert!(at.iter().all(|x| (0.5..=1.0).contains(x)), "{at:?}");
        }
        for threads in [2, 3] {
            let pool = Pool::new(threads).unwrap();
            let team = Team::new(&pool, Plan::default());
            assert_eq!(crossings(team, count, corners, 5), alone);
        }
    }
}
