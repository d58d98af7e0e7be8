//! What layers a mesh has along a wall, beside those that are asked for.
use super::growth::Growth;
use crate::mesh::TetMesh;
use crate::mesh::adjacency::FACES;
use crate::mesh::vector::{Vec3, add, area2, norm, scale, unit, volume6};
use crate::metric::implied::unit_metric;
use serde::Serialize;
use std::collections::HashSet;

/// Points across are counted as far as the size that is asked for is so many times the first height: there the layers are thin.
const DEPTH: f64 = 100.0;

/// The layers of a mesh along a wall. Lengths are in model units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// Vertices on the wall with a tetrahedron upon a triangle of it.
    pub vertices: usize,
    /// First height that is asked for.
    pub asked: f64,
    /// Mean of the first heights of these vertices: each is the mean distance from the wall of the vertices opposite to the wall's triangles there. In
    /// a regular tetrahedron that is √(2/3) = 0.816 of the size.
    pub mean: f64,
    /// Their standard deviation as a share of the mean.
    pub deviation: f64,
    /// Least and greatest distance of a single one of the opposite vertices.
    pub least: f64,
    /// See `least`.
    pub greatest: f64,
    /// As far from the wall points across are counted.
    pub depth: f64,
    /// Points across that are asked for, ∫ dd/h(d).
    pub points_asked: f64,
    /// Points across that the mesh has, ∫ (nᵀ M_K n)^½ dd, M_K the metric in which a tetrahedron has unit edges, n the gradient of the distance in
    /// it; the mean over the wall.
    pub points: f64,
}

/// Measures the layers of a mesh whose vertices have these distances from a wall, shape (n,), and whose triangles are on it where `is_wall` says so.
/// None where no tetrahedron stands on the wall.
pub fn measure(
    mesh: &TetMesh,
    distances: &[f64],
    is_wall: impl Fn(usize) -> bool,
    growth: &Growth,
) -> Option<Measured> {
    let First { heights, least, greatest } = first_heights(mesh, distances, is_wall);
    let count = heights.len() as f64;
    let mean = heights.iter().sum::<f64>() / count;
    let square = heights.iter().map(|height| (height - mean).powi(2)).sum::<f64>() / count;
    let depth = growth.reach(DEPTH * growth.first);
    let points_asked = DEPTH.ln() / (growth.growth - 1.0);
    (!heights.is_empty()).then(|| Measured {
        vertices: heights.len(),
        asked: growth.first,
        mean,
        deviation: square.sqrt() / mean,
        least,
        greatest,
        depth,
        points_asked,
        points: points_asked * share_across(mesh, distances, depth, growth),
    })
}

/// The first height at each vertex of the wall that has one, in the order of the vertices; and the least and greatest of a tetrahedron.
struct First {
    heights: Vec<f64>,
    least: f64,
    greatest: f64,
}

fn first_heights(mesh: &TetMesh, distances: &[f64], is_wall: impl Fn(usize) -> bool) -> First {
    let sorted = |mut nodes: [u32; 3]| {
        nodes.sort_unstable();
        nodes
    };
    let walls: HashSet<[u32; 3]> =
        (0..mesh.triangles.len()).filter(|&t| is_wall(t)).map(|t| sorted(mesh.triangles.nodes[t])).collect();
    let mut sums = vec![(0.0, 0u32); mesh.vertices.len()];
    let (mut least, mut greatest) = (f64::INFINITY, 0.0f64);
    for nodes in &mesh.tets.nodes {
        if nodes.iter().filter(|&&v| distances[v as usize] == 0.0).count() < 3 {
            continue;
        }
        for (opposite, face) in FACES.iter().enumerate() {
            let height = distances[nodes[opposite] as usize];
            let face = face.map(|i| nodes[i]);
            if height > 0.0 && walls.contains(&sorted(face)) {
                (least, greatest) = (least.min(height), greatest.max(height));
                for v in face {
                    let (sum, count) = &mut sums[v as usize];
                    (*sum, *count) = (*sum + height, *count + 1);
                }
            }
        }
    }
    let heights = sums.into_iter().filter(|(_, count)| *count > 0).map(|(sum, count)| sum / f64::from(count));
    First { heights: heights.collect(), least, greatest }
}

/// The points across that a mesh has within a depth, as a share of those asked for: both integrated over the tetrahedra there.
fn share_across(mesh: &TetMesh, distances: &[f64], depth: f64, growth: &Growth) -> f64 {
    let (mut found, mut asked) = (0.0, 0.0);
    for nodes in &mesh.tets.nodes {
        let at = nodes.map(|v| distances[v as usize]);
        let middle = 0.25 * at.iter().sum::<f64>();
        if middle > depth {
            continue;
        }
        let corners = nodes.map(|v| mesh.vertices[v as usize]);
        let (Some(metric), Some(gradient)) = (unit_metric(corners), gradient(corners, at)) else { continue };
        let volume = volume6(corners[0], corners[1], corners[2], corners[3]) / 6.0;
        found += volume * metric.quadratic(unit(gradient)).sqrt();
        asked += volume / growth.across(middle);
    }
    if asked > 0.0 { found / asked } else { 0.0 }
}

/// The gradient of what is linear in a tetrahedron with these values at the corners; none where it vanishes.
fn gradient([a, b, c, d]: [Vec3; 4], at: [f64; 4]) -> Option<Vec3> {
    let six = volume6(a, b, c, d);
    // Inward areas of the faces opposite to the second, third and fourth corner.
    let faces = [area2(a, c, d), area2(a, d, b), area2(a, b, c)];
    let mut sum = [0.0; 3];
    for (face, value) in faces.into_iter().zip(&at[1..]) {
        sum = add(sum, scale(face, (value - at[0]) / six));
    }
    (norm(sum) > 0.0 && norm(sum).is_finite()).then_some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;
    use crate::mesh::vector::sub;

    #[test]
    fn a_gradient_is_that_of_a_plane() {
        let corners = [[0.1, 0.0, 0.2], [1.0, 0.1, 0.0], [0.0, 1.2, 0.1], [0.2, 0.1, 0.9]];
        let found = gradient(corners, corners.map(|p| 3.0 * p[0] - 2.0 * p[1] + 0.5 * p[2] + 7.0)).unwrap();
        assert!(norm(sub(found, [3.0, -2.0, 0.5])) < 1e-13, "{found:?}");
        assert_eq!(gradient(corners, [1.0; 4]), None);
    }

    /// A cube whose heights above its lower side grow by a ratio: layers as they are asked for.
    #[test]
    fn layers_that_grow_as_asked_are_found() {
        let (n, growth) = (20, 1.3);
        let growth = Growth { first: 1e-3, growth, tangential: None, chord: None };
        let mut mesh = cube(n);
        let height = |k: i32| growth.first * (growth.growth.powi(k) - 1.0) / (growth.growth - 1.0);
        mesh.vertices.iter_mut().for_each(|p| p[2] = height((p[2] * f64::from(n)).round() as i32));
        let distances: Vec<f64> = mesh.vertices.iter().map(|p| p[2]).collect();
        let is_wall = |t: usize| mesh.triangles.nodes[t].iter().all(|&v| mesh.vertices[v as usize][2] == 0.0);
        let found = measure(&mesh, &distances, is_wall, &growth).unwrap();
        assert_eq!((found.vertices, found.asked), (21 * 21, 1e-3));
        assert!((found.mean / 1e-3 - 1.0).abs() < 1e-9 && found.deviation < 1e-9, "{found:?}");
        // Of the six tetrahedra of a cell each has three edges across, and its unit metric the size of the cell across.
        assert!((found.points / found.points_asked - 1.0).abs() < 0.3, "{found:?}");
        assert!((found.points_asked - 100f64.ln() / 0.3).abs() < 1e-12);
        assert!(measure(&mesh, &distances, |_| false, &growth).is_none());
    }
}
