//! Values of cells to the vertices, and back.
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, dot, sub};
use crate::metric::Sym3;
use crate::tasks::{Buckets, GRAIN, Team};

/// Mean weight below which the weights are what rounding left of them.
const LEAST: f64 = 0.1;

/// The centroid of a tetrahedron.
fn centroid(vertices: &[Vec3], nodes: [u32; 4]) -> Vec3 {
    let p = nodes.map(|v| vertices[v as usize]);
    std::array::from_fn(|k| 0.25 * (p[0][k] + p[1][k] + p[2][k] + p[3][k]))
}

/// Values at the vertices, shape (vertices, width), from those of the cells, shape (tetrahedra, width). Zero at a vertex without a tetrahedron.
/// The same to the bit on any number of threads.
///
/// A mean with the weights 1 + λ·d of Holmes & Connell (*Solution of the 2D Navier-Stokes equations on unstructured adaptive grids*, AIAA 89-1932),
/// d the way to a centroid: those nearest to 1 that meet linear functions, whatever the anisotropy of the cells. They are held to
/// [0, 2], so that there is no new extremum; on the boundary, where all centroids lie to one side, a mean is left. Where hardly any weight is (all centroids
/// lie in one direction) all are the same.
pub fn cells_to_vertices(team: Team<'_>, mesh: &TetMesh, values: &[f64], width: usize) -> Vec<f64> {
    let (vertices, tets) = (&mesh.vertices, &mesh.tets.nodes);
    let at = Buckets::of::<4>(team, vertices.len(), tets.len(), |t| tets[t]);
    team.collect(GRAIN, vertices.len(), |range, found| {
        let (mut ways, mut sum) = (Vec::new(), vec![0.0; width]);
        for vertex in range {
            ways.clear();
            ways.extend(
                at.of_key(vertex).map(|entry| sub(centroid(vertices, tets[entry as usize / 4]), vertices[vertex])),
            );
            let mut slope = slope(&ways);
            let weight = |slope: Vec3, way: Vec3| (1.0 + dot(slope, way)).clamp(0.0, 2.0);
            if ways.iter().map(|&way| weight(slope, way)).sum::<f64>() < LEAST * ways.len() as f64 {
                slope = [0.0; 3];
            }
            sum.fill(0.0);
            let mut total = 0.0;
            for (entry, &way) in at.of_key(vertex).zip(&ways) {
                let weight = weight(slope, way);
                total += weight;
                let cell = &values[entry as usize / 4 * width..][..width];
                sum.iter_mut().zip(cell).for_each(|(sum, value)| *sum += weight * value);
            }
            found.extend(sum.iter().map(|&sum| if total > 0.0 { sum / total } else { 0.0 }));
        }
    })
}

/// λ of the weights 1 + λ·d for which Σ (1 + λ·d) d = 0, in the directions that the ways d span: -(Σ d dᵀ)⁻¹ Σ d.
fn slope(ways: &[Vec3]) -> Vec3 {
    /// Squares of extents below this part of the greatest are rounding.
    const FLAT: f64 = 1e-15;
    let (mut moments, mut first) = (Sym3::ZERO, [0.0; 3]);
    for &d in ways {
        moments = moments.plus(Sym3::outer(d, 1.0));
        first = std::array::from_fn(|k| first[k] + d[k]);
    }
    let eigen = moments.eigen();
    let most = eigen.values.iter().fold(0.0f64, |a, &b| a.max(b));
    let mut slope = [0.0; 3];
    for (value, direction) in eigen.values.iter().zip(eigen.vectors) {
        if *value > FLAT * most {
            let along = -dot(direction, first) / value;
            slope = std::array::from_fn(|k| slope[k] + along * direction[k]);
        }
    }
    slope
}

/// Values of the cells, shape (tetrahedra, width): the mean of those at the vertices of each, shape (vertices, width), which is the
/// value of their linear interpolant at the centroid.
pub fn vertices_to_cells(team: Team<'_>, mesh: &TetMesh, values: &[f64], width: usize) -> Vec<f64> {
    team.collect(GRAIN, mesh.tets.len(), |range, found| {
        for nodes in &mesh.tets.nodes[range] {
            found.extend((0..width).map(|k| 0.25 * nodes.iter().map(|&v| values[v as usize * width + k]).sum::<f64>()));
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    /// There and back on a mesh of n³ cells with moved vertices, stretched: the greatest error inside and on the boundary.
    fn errors(n: u32, stretch: f64, at: impl Fn(Vec3) -> f64) -> [f64; 2] {
        let mut mesh = cube(n);
        let inner: Vec<bool> = mesh.vertices.iter().map(|p| p.iter().all(|&x| x > 0.0 && x < 1.0)).collect();
        for (p, _) in mesh.vertices.iter_mut().zip(&inner).filter(|(_, inner)| **inner) {
            let q = *p;
            *p = std::array::from_fn(|i| q[i] + 0.15 / f64::from(n) * (97.0 * q[(i + 1) % 3] + 31.0 * q[i]).sin());
        }
        let turned = |p: Vec3| [p[0] + p[2] * stretch, p[1], p[0] - p[2] * stretch];
        let flat: Vec<Vec3> = mesh.vertices.iter().map(|&p| turned(p)).collect();
        let linear: Vec<f64> = mesh.vertices.iter().flat_map(|&p| [at(p), 3.0]).collect();
        let mesh = TetMesh { vertices: flat, ..mesh };
        let cells = vertices_to_cells(Team::alone(), &mesh, &linear, 2);
        let back = cells_to_vertices(Team::alone(), &mesh, &cells, 2);
        let mut worst = [0.0f64; 2];
        for ((inner, was), is) in inner.iter().zip(linear.chunks(2)).zip(back.chunks(2)) {
            assert!((is[1] - 3.0).abs() < 1e-14, "constants stay");
            let worst = &mut worst[usize::from(!inner)];
            *worst = worst.max((is[0] - was[0]).abs());
        }
        worst
    }

    #[test]
    fn linear_functions_are_met_at_centroids_and_come_back() {
        let mesh = cube(3);
        let at = |p: Vec3| 1.0 + p[0] - 2.0 * p[2];
        let linear: Vec<f64> = mesh.vertices.iter().map(|&p| at(p)).collect();
        for (nodes, value) in mesh.tets.nodes.iter().zip(vertices_to_cells(Team::alone(), &mesh, &linear, 1)) {
            assert!((value - at(centroid(&mesh.vertices, *nodes))).abs() < 1e-14);
        }
        // However flat the cells are: in a layer a function that changes across it.
        for (stretch, rounding) in [(1.0, 1e-13), (1e-3, 1e-9), (1e-6, 1e-3)] {
            let [inside, boundary] = errors(6, stretch, at);
            assert!(inside < rounding, "{stretch}: {inside}");
            assert!(boundary < 0.3, "within the cells at the boundary: {boundary}");
        }
    }

    #[test]
    fn no_value_is_beyond_those_of_the_cells() {
        let step = |p: Vec3| if p[0] + 0.3 * p[1] > 0.61 { 1.0 } else { 0.0 };
        let mut mesh = cube(5);
        mesh.vertices.push([0.5; 3]);
        mesh.vertex_refs.push(0);
        let cells: Vec<f64> = mesh.tets.nodes.iter().map(|&nodes| step(centroid(&mesh.vertices, nodes))).collect();
        let found = cells_to_vertices(Team::alone(), &mesh, &cells, 1);
        assert!(found.iter().all(|x| (0.0..=1.0).contains(x)));
        assert_eq!(found.last(), Some(&0.0), "without a tetrahedron");
        // One tetrahedron: all its vertices have its value.
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let single = crate::mesh::samples::with_boundary(corners.to_vec(), vec![[0, 1, 2, 3]]);
        assert_eq!(cells_to_vertices(Team::alone(), &single, &[7.0], 1), [7.0; 4]);
    }
}
