//! From values of tetrahedra to values at vertices.
use crate::mesh::TetMesh;
use crate::mesh::vector::volume6;

/// The mean of the values of the tetrahedra about each vertex, by volume. `values` has the shape (tetrahedra, `width`), the result
/// (vertices, `width`); 0 at a vertex without a tetrahedron of any volume.
pub fn to_vertices(mesh: &TetMesh, width: usize, values: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0; mesh.vertices.len() * width];
    let mut volumes = vec![0.0; mesh.vertices.len()];
    for (nodes, values) in mesh.tets.nodes.iter().zip(values.chunks_exact(width.max(1))) {
        let [a, b, c, d] = nodes.map(|v| mesh.vertices[v as usize]);
        let volume = volume6(a, b, c, d).abs();
        for &v in nodes {
            volumes[v as usize] += volume;
            for (sum, value) in sums[v as usize * width..][..width].iter_mut().zip(values) {
                *sum += volume * value;
            }
        }
    }
    for (sums, &volume) in sums.chunks_exact_mut(width.max(1)).zip(&volumes) {
        if volume > 0.0 {
            sums.iter_mut().for_each(|sum| *sum /= volume);
        }
    }
    sums
}
