//! The cells of a case. All but tetrahedra are cut into such, their pieces: what is summed over cells or faces is summed over those.
use crate::formats::Dataset;
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, scale, volume6};

/// The cells of a mesh, in the order of its case: the tetrahedra come first.
pub struct Cells {
    /// The mesh, with the pieces of cells that are no tetrahedra.
    pub mesh: TetMesh,
    /// The cell of each tetrahedron of the mesh.
    pub of: Vec<u32>,
    /// Six times their volumes.
    pub volumes: Vec<f64>,
}

impl Cells {
    /// Of a mesh with its stack.
    pub fn of(data: Dataset) -> Self {
        let of = data.stack.cells_of_tets(&data.mesh);
        let mut volumes = vec![0.0; data.cells()];
        for (&cell, volume) in of.iter().zip(tet_volumes(&data.mesh)) {
            volumes[cell as usize] += volume;
        }
        Self { mesh: data.mesh, of, volumes }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.volumes.len()
    }

    /// Their centroids.
    pub fn centroids(&self) -> Vec<Vec3> {
        let mut sums = vec![([0.0; 3], 0.0); self.count()];
        for ((nodes, &cell), volume) in self.mesh.tets.nodes.iter().zip(&self.of).zip(tet_volumes(&self.mesh)) {
            let (sum, all) = &mut sums[cell as usize];
            for v in nodes {
                self.mesh.vertices[*v as usize].iter().zip(&mut *sum).for_each(|(x, sum)| *sum += 0.25 * volume * x);
            }
            *all += volume;
        }
        sums.into_iter().map(|(sum, all)| scale(sum, 1.0 / all)).collect()
    }
}

/// Six times the volumes of the tetrahedra.
fn tet_volumes(mesh: &TetMesh) -> impl Iterator<Item = f64> + '_ {
    mesh.tets.nodes.iter().map(|nodes| {
        let [a, b, c, d] = nodes.map(|v| mesh.vertices[v as usize]);
        volume6(a, b, c, d).abs()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::on_prisms;

    #[test]
    fn a_prism_is_a_cell() {
        let (mut mesh, mut stack) = on_prisms(2, 0.1);
        stack.join(&mut mesh).unwrap();
        let cells = Cells::of(Dataset { mesh, stack, ..Dataset::default() });
        assert_eq!((cells.count(), cells.mesh.tets.len()), (48 + 8, 48 + 3 * 8));
        assert!((cells.volumes.iter().sum::<f64>() - 6.6).abs() < 1e-12);
        assert!(cells.volumes[48..].iter().all(|volume| (volume - 6.0 * 0.1 / 8.0).abs() < 1e-12));
        assert!(cells.centroids()[48..].iter().all(|centroid| (centroid[2] + 0.05).abs() < 1e-12));
    }
}
