//! Metric fields at the vertices of a mesh: files, complexity.
use super::{Error, Sym3};
use crate::mesh::io::{self, FieldKind, Read, Solution, SolutionField};
use crate::mesh::{TetMesh, vector::volume6};
use std::path::Path;

/// A metric at every vertex of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Field {
    /// The metrics, shape (n,), in 1/length².
    pub metrics: Vec<Sym3>,
}

impl Field {
    /// Reads a .sol or .solb file of a mesh of so many vertices. Every tensor must be positive definite.
    pub fn read(path: &Path, vertices: usize) -> Result<Read<Self>, Error> {
        let Read { content, notices } = io::read_solution(path)?;
        let tensors = only_tensors(path, &content)?;
        if content.vertices != vertices {
            return Err(Error::Count { path: path.into(), found: content.vertices, expected: vertices });
        }
        let metrics: Vec<Sym3> =
            tensors.values.chunks_exact(6).map(|m| Sym3([m[0], m[1], m[2], m[3], m[4], m[5]])).collect();
        if let Some(vertex) = metrics.iter().position(|m| !m.is_spd()) {
            let eigenvalues = metrics[vertex].eigen_jacobi().values;
            return Err(Error::NotPositive { path: path.into(), vertex: vertex + 1, eigenvalues });
        }
        Ok(Read { content: Self { metrics }, notices })
    }

    /// Writes .sol or .solb by the extension.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let values = self.metrics.iter().flat_map(|m| m.0).collect();
        let field = SolutionField { kind: FieldKind::SymmetricTensor, values };
        Ok(io::write_solution(path, &Solution { vertices: self.metrics.len(), fields: vec![field] })?)
    }

    /// ln M at every vertex.
    pub fn logs(&self) -> Vec<Sym3> {
        self.metrics.iter().map(Sym3::ln).collect()
    }
}

/// The one tensor field of a solution.
fn only_tensors<'a>(path: &Path, solution: &'a Solution) -> Result<&'a SolutionField, Error> {
    if let [field] = &solution.fields[..]
        && field.kind == FieldKind::SymmetricTensor
    {
        return Ok(field);
    }
    let kinds: Vec<&str> = solution.fields.iter().map(|field| kind_name(field.kind)).collect();
    let found =
        if kinds.is_empty() { "no field at the vertices".into() } else { format!("fields: {}", kinds.join(", ")) };
    Err(Error::Kind { path: path.into(), found })
}

fn kind_name(kind: FieldKind) -> &'static str {
    match kind {
        FieldKind::Scalar => "scalar",
        FieldKind::Vector => "vector",
        FieldKind::SymmetricTensor => "symmetric tensor",
        FieldKind::Tensor => "tensor",
    }
}

/// Complexity C = Σ_v √det(M_v)·V_v of a mesh with a metric at every vertex; V_v is a quarter of the volume of the
/// tetrahedra at v. A unit mesh has about 2C vertices and 12C tetrahedra.
pub fn complexity(mesh: &TetMesh, metrics: &[Sym3]) -> f64 {
    weighted_complexity(mesh, metrics.iter().map(Sym3::sqrt_det).collect())
}

/// [`complexity`] from ln M: √det M = e^(tr/2).
pub fn complexity_of_logs(mesh: &TetMesh, logs: &[Sym3]) -> f64 {
    weighted_complexity(mesh, logs.iter().map(|log| (0.5 * log.trace()).exp()).collect())
}

fn weighted_complexity(mesh: &TetMesh, densities: Vec<f64>) -> f64 {
    let of_tet = |tet: &[u32; 4]| {
        let [a, b, c, d] = tet.map(|v| mesh.vertices[v as usize]);
        let density: f64 = tet.iter().map(|&v| densities[v as usize]).sum();
        volume6(a, b, c, d) * density
    };
    mesh.tets.nodes.iter().map(of_tet).sum::<f64>() / 24.0
}

/// Factor of M that takes a field from one complexity to another: (target/present)^(2/3).
pub fn complexity_factor(present: f64, target: f64) -> f64 {
    (target / present).powf(2.0 / 3.0)
}

/// Scales the metrics to a complexity on this mesh; returns the factor of M.
pub fn scale_to_complexity(mesh: &TetMesh, metrics: &mut [Sym3], target: f64) -> f64 {
    let factor = complexity_factor(complexity(mesh, metrics), target);
    for m in metrics {
        *m = m.times(factor);
    }
    factor
}
