//! Sizes that a user asks for in a place, and around it: distances of the vertices from faces of the model and from boxes, and how sizes grow
//! with them.
use crate::geometry::{Evaluate, Geometry, Model};
use crate::mesh::TetMesh;
use crate::mesh::adjacency::FACES;
use crate::mesh::vector::{Vec3, area2, dot, norm, sub};
use crate::tasks::{GRAIN, Team};

/// Vertices a task. Each task makes an evaluator.
const VERTICES: usize = 1 << 9;

/// The size at a distance from where it is h. Layers of the heights h, h g, h g², … that reach as far as d end with h + (g − 1) d.
pub fn grown(h: f64, growth: f64, distance: f64) -> f64 {
    h + (growth - 1.0) * distance
}

/// The distance of each vertex of a mesh from the nearest of these faces of its model, if it is less than `within`; else infinite.
pub fn from_faces(team: Team<'_>, mesh: &TetMesh, model: &Model, faces: &[u32], within: f64) -> Vec<f64> {
    team.collect(VERTICES, mesh.vertices.len(), |range, found| {
        let mut evaluator = model.evaluator();
        found.extend(range.map(|v| {
            faces.iter().fold(f64::INFINITY, |nearest, &face| {
                let on = evaluator.closest_on_face_within(face, mesh.vertices[v], nearest.min(within));
                on.map_or(nearest, |on| on.distance)
            })
        }));
    })
}

/// A box along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    /// Least and greatest corner.
    corners: [Vec3; 2],
}

impl Cuboid {
    /// Between two opposite corners, in any order.
    pub fn between(a: Vec3, b: Vec3) -> Self {
        let corner = |f: fn(f64, f64) -> f64| std::array::from_fn(|i| f(a[i], b[i]));
        Self { corners: [corner(f64::min), corner(f64::max)] }
    }

    /// The distance of each vertex of a mesh from the box. It is 0 at all vertices of a tetrahedron that it meets, so that what is interpolated
    /// between them is right all over the box, however coarse the mesh. None where it meets no tetrahedron.
    pub fn distances(&self, team: Team<'_>, mesh: &TetMesh) -> Option<Vec<f64>> {
        let meets = |t: usize| self.meets(mesh.tets.nodes[t].map(|v| mesh.vertices[v as usize]));
        let met = team.chunks(GRAIN, mesh.tets.len(), |range| range.filter(|&t| meets(t)).collect::<Vec<usize>>());
        let mut distances = team.map(GRAIN, mesh.vertices.len(), |v| self.distance(mesh.vertices[v]));
        let mut meets_any = false;
        for t in met.into_iter().flatten() {
            meets_any = true;
            mesh.tets.nodes[t].iter().for_each(|&v| distances[v as usize] = 0.0);
        }
        meets_any.then_some(distances)
    }

    fn distance(&self, p: Vec3) -> f64 {
        let [low, high] = self.corners;
        norm(std::array::from_fn(|i| (low[i] - p[i]).max(p[i] - high[i]).max(0.0)))
    }

    /// Whether neither the axes nor the faces of a tetrahedron keep it apart from the box. (Where only a plane along an edge of each does,
    /// it counts as met.)
    fn meets(&self, x: [Vec3; 4]) -> bool {
        let [low, high] = self.corners;
        let beside = |i: usize| x.iter().all(|p| p[i] < low[i]) || x.iter().all(|p| p[i] > high[i]);
        let behind = |[a, b, c]: [usize; 3]| {
            let outward = area2(x[a], x[b], x[c]);
            // The corner that is farthest inwards.
            let corner = std::array::from_fn(|i| if outward[i] > 0.0 { low[i] } else { high[i] });
            dot(outward, sub(corner, x[a])) > 0.0
        };
        !(0..3).any(beside) && !FACES.into_iter().any(behind)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    #[test]
    fn layers_that_grow_by_a_ratio_end_with_the_size_at_their_distance() {
        let (h, growth) = (0.01, 1.3);
        let (mut distance, mut layer) = (0.0, h);
        for _ in 0..12 {
            assert!((grown(h, growth, distance) / layer - 1.0).abs() < 1e-12, "{distance}");
            distance += layer;
            layer *= growth;
        }
    }

    #[test]
    fn a_box_within_a_tetrahedron_is_met_and_one_beside_it_is_not() {
        let tet = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let meets = |a: Vec3, b: Vec3| Cuboid::between(a, b).meets(tet);
        assert!(meets([0.11; 3], [0.1; 3]));
        assert!(meets([-1.0; 3], [2.0; 3]));
        assert!(meets([0.3; 3], [0.9; 3]));
        // Behind the slanting face only, and beside the others.
        assert!(!meets([0.34; 3], [0.9; 3]));
        assert!(!meets([-0.5, 0.1, 0.1], [-0.1, 0.2, 0.2]));
        assert!(!meets([0.1, 0.1, 1.1], [0.2, 0.2, 1.2]));
    }

    #[test]
    fn a_small_box_between_the_vertices_is_found_on_a_coarse_mesh() {
        let mesh = cube(1);
        let small = Cuboid::between([0.4, 0.3, 0.2], [0.41, 0.31, 0.21]);
        let distances = small.distances(Team::alone(), &mesh).unwrap();
        assert_eq!(distances.iter().filter(|&&d| d == 0.0).count(), 4, "{distances:?}");
        let far = distances.iter().fold(0.0, |a: f64, &b| a.max(b));
        assert!(far > 0.7, "{distances:?}");
        assert_eq!(Cuboid::between([2.0; 3], [3.0; 3]).distances(Team::alone(), &mesh), None);
    }
}
