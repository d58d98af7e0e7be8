//! The distance from triangles.
use super::search::VERTICES;
use crate::geometry::discrete::{BoxTree, box_of, closest_on_triangle};
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, add, dot, scale, sub};
use crate::tasks::{GRAIN, Team};

/// The exact distance of each vertex of a mesh from those of its triangles that have one of these references, shape (n,), model units; 0 at the
/// corners of these, infinite where there are none.
pub fn from_triangles(team: Team<'_>, mesh: &TetMesh, references: &[i32]) -> Vec<f64> {
    let asked = mesh.triangles.iter().filter(|(_, reference)| references.contains(reference));
    let nodes: Vec<[u32; 3]> = asked.map(|(nodes, _)| nodes).collect();
    let corners = |k: usize| nodes[k].map(|v| mesh.vertices[v as usize]);
    let boxes: Vec<[Vec3; 2]> = team.map(GRAIN, nodes.len(), |k| box_of(corners(k)));
    let tree = BoxTree::new(&boxes);
    let mut is_on = vec![false; mesh.vertices.len()];
    nodes.iter().flatten().for_each(|&v| is_on[v as usize] = true);
    team.map(VERTICES, mesh.vertices.len(), |v| {
        if is_on[v] {
            return 0.0;
        }
        let (point, mut nearest) = (mesh.vertices[v], f64::INFINITY);
        tree.nearest(point, f64::INFINITY, |k| {
            let square = square_from(corners(k as usize), point);
            nearest = nearest.min(square);
            square
        });
        nearest.sqrt()
    })
}

/// The square of the distance of a point from a triangle.
fn square_from([a, b, c]: [Vec3; 3], point: Vec3) -> f64 {
    let [u, v, w] = closest_on_triangle([a, b, c], point);
    let way = sub(point, add(add(scale(a, u), scale(b, v)), scale(c, w)));
    dot(way, way)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;
    use crate::tasks::{Plan, Pool};

    #[test]
    fn the_distance_is_that_of_all_triangles() {
        let mut mesh = cube(5);
        mesh.vertices
            .iter_mut()
            .for_each(|p| *p = [p[0] + 0.1 * p[1] * p[2], p[1] * (1.0 + p[0]), p[2] - 0.3 * p[0] * p[0]]);
        let references: Vec<i32> = mesh.triangles.refs.first().copied().into_iter().collect();
        let found = from_triangles(Team::alone(), &mesh, &references);
        let asked: Vec<[Vec3; 3]> = mesh
            .triangles
            .iter()
            .filter(|(_, reference)| references.contains(reference))
            .map(|(nodes, _)| nodes.map(|v| mesh.vertices[v as usize]))
            .collect();
        assert!(!asked.is_empty() && asked.len() < mesh.triangles.len());
        for (point, found) in mesh.vertices.iter().zip(&found) {
            let least = asked.iter().map(|&corners| square_from(corners, *point)).fold(f64::INFINITY, f64::min).sqrt();
            assert!((found - least).abs() < 1e-14, "{found} {least}");
        }
        assert!(found.contains(&0.0) && found.iter().any(|&distance| distance > 0.5));
        let pool = Pool::new(3).unwrap();
        assert_eq!(from_triangles(Team::new(&pool, Plan::default()), &mesh, &references), found);
        assert!(from_triangles(Team::alone(), &mesh, &[-7]).iter().all(|distance| distance.is_infinite()));
    }
}
