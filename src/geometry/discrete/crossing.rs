//! Where the smooth patches of a surface go through each other: between walls that are nearer than the patches bulge, the triangles do not.
use super::build::Discrete;
use super::patch::Patch;
use crate::mesh::box_tree::BoxTree;
use crate::mesh::triangle_pair::meeting;
use crate::mesh::vector::Vec3;
use crate::tasks::Team;

/// The sides of a patch are cut into so many parts. Two patches that reach into each other by less than about a sixteenth of their rise are missed.
const PARTS: usize = 4;

/// Two triangles by their numbers, the lower first, and a point where their patches meet.
type Meeting = ([u32; 2], Vec3);

/// A triangle of a patch.
#[derive(Clone, Copy)]
struct Piece<'d> {
    patch: &'d Patch,
    triangle: usize,
}

impl Piece<'_> {
    fn is_curved(self) -> bool {
        self.patch.is_curved(self.triangle)
    }

    /// Flat triangles between points of it.
    fn facets(self) -> Vec<[Vec3; 3]> {
        let parts = if self.is_curved() { PARTS } else { 1 };
        let at = |i: usize, j: usize| {
            let [b, c] = [i, j].map(|k| k as f64 / parts as f64);
            self.patch.at(self.triangle, [1.0 - b - c, b, c])
        };
        let mut facets = Vec::with_capacity(parts * parts);
        for (i, j) in (0..parts).flat_map(|i| (0..parts - i).map(move |j| (i, j))) {
            facets.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
            if i + j + 1 < parts {
                facets.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        facets
    }

    /// A point where it meets another one that shares no corner with it.
    fn meets(self, other: Self) -> Option<Vec3> {
        let [own, theirs] = [self, other].map(|piece| piece.patch.corners(piece.triangle));
        if !(self.is_curved() || other.is_curved()) || own.iter().any(|p| theirs.contains(p)) {
            return None;
        }
        let others = other.facets();
        self.facets().iter().find_map(|a| others.iter().find_map(|b| meeting(a, b)))
    }
}

impl Discrete {
    /// A point where two smooth patches go through each other whose triangles share no corner, in model units; none where none do. It is the
    /// same for any number of threads. Triangles that go through each other as they are, both flat, are not looked for.
    pub fn crossing(&self, team: Team<'_>) -> Option<Vec3> {
        let of_patch = |patch| (0..Patch::len(patch)).map(move |triangle| Piece { patch, triangle });
        let pieces: Vec<Piece<'_>> = self.patches.iter().flat_map(of_patch).collect();
        if !pieces.iter().any(|piece| piece.is_curved()) {
            return None;
        }
        let bounds = |i: u32| pieces[i as usize].patch.bounds_of(pieces[i as usize].triangle);
        let tree = BoxTree::on(team, pieces.len(), bounds);
        let found = tree.overlapping_pairs(
            team,
            bounds,
            |_, _| true,
            |first: &mut Option<Meeting>, i, j| {
                let pair = [i.min(j), i.max(j)];
                if first.is_none_or(|(before, _)| pair < before) {
                    let at = pieces[pair[0] as usize].meets(pieces[pair[1] as usize]);
                    *first = at.map(|at| (pair, at)).or(*first);
                }
            },
        );
        found.into_iter().flatten().min_by_key(|(pair, _)| *pair).map(|(_, at)| at)
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples::sphere;
    use super::super::{DEFAULT_RIDGE_ANGLE, DiscreteOptions};
    use super::*;
    use crate::mesh::TetMesh;
    use crate::mesh::vector::norm;
    use crate::tasks::{Plan, Pool};

    /// Two balls of radius 2, as flat triangles `gap` apart at their nearest.
    fn two_balls(n: u32, gap: f64) -> TetMesh {
        let mut mesh = sphere(n);
        let used: Vec<u32> = mesh.triangles.nodes.iter().flatten().copied().collect();
        let most = used.iter().map(|&v| mesh.vertices[v as usize][0]).fold(f64::MIN, f64::max);
        // Turned about x by 0.3, so that no corners face each other.
        let (sine, cosine) = 0.3_f64.sin_cos();
        let count = mesh.vertices.len() as u32;
        let moved = |p: &Vec3| [-p[0] + 2.0 * most + gap, -(cosine * p[1] - sine * p[2]), sine * p[1] + cosine * p[2]];
        let more: Vec<Vec3> = mesh.vertices.iter().map(moved).collect();
        mesh.vertices.extend(more);
        mesh.vertex_refs.resize(mesh.vertices.len(), 0);
        for (nodes, reference) in std::mem::take(&mut mesh.triangles).iter() {
            mesh.triangles.push(nodes, reference);
            mesh.triangles.push(nodes.map(|v| v + count), reference);
        }
        mesh
    }

    fn crossing(mesh: &TetMesh, smooth: bool, threads: usize) -> Option<Vec3> {
        let options = DiscreteOptions { ridge_angle_deg: DEFAULT_RIDGE_ANGLE, smooth };
        let (pool, alone) = (Pool::new(threads).unwrap(), Team::alone());
        Discrete::new(alone, mesh, &options).unwrap().0.crossing(Team::new(&pool, Plan::default()))
    }

    #[test]
    fn balls_whose_patches_bulge_into_each_other_cross_and_their_triangles_do_not() {
        // With n = 3 no vertex is at the pole: the flat triangles are 0.19 inside the ball there.
        let flat = two_balls(3, 0.1);
        let at = crossing(&flat, true, 1).unwrap();
        let centre =
            flat.triangles.nodes.iter().flatten().map(|&v| flat.vertices[v as usize][0]).fold(f64::MIN, f64::max) / 2.0
                - 1.0;
        assert!(norm([at[0] - 1.0 - centre, at[1], at[2]]) < 1.5, "{at:?}");
        assert_eq!(crossing(&flat, true, 3), Some(at));
        assert_eq!(crossing(&flat, false, 1), None);
        assert_eq!(crossing(&two_balls(3, 0.5), true, 1), None);
        assert_eq!(crossing(&sphere(3), true, 1), None);
    }
}
