//! Metric fields at the vertices of a mesh: files, complexity.
use super::between::density_between;
use super::held::SIZES;
use super::{Error, Sym3};
use crate::mesh::TetMesh;
use crate::mesh::io::{self, Batch, FieldKind, Read, Solution, SolutionField};
use crate::mesh::vector::{Vec3, volume6};
use crate::tasks::{GRAIN, Team};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

mod slices;

/// A metric at every vertex of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Field {
    /// The metrics, shape (n,), in 1/length².
    pub metrics: Vec<Sym3>,
}

impl Field {
    /// Reads a .sol or .solb file of a mesh of so many vertices: symmetric tensors, each positive definite, or scalars, which are sizes h of
    /// the metric h⁻² I.
    pub fn read(path: &Path, vertices: usize) -> Result<Read<Self>, Error> {
        let Read { content: metrics, notices } =
            read_each(Team::alone(), path, Some(vertices), |m| m.is_spd().then_some(m))?;
        Ok(Read { content: Self { metrics }, notices })
    }

    /// Reads ln M at every vertex from a .sol or .solb file of M, with the checks of [`Field::read`]. The eigenvalues that tell whether a
    /// tensor is positive definite also give its logarithm.
    pub fn read_logs(team: Team<'_>, path: &Path, vertices: usize) -> Result<Read<Vec<Sym3>>, Error> {
        read_each(team, path, Some(vertices), checked_log)
    }

    /// ln M of metrics as [`Field::read_logs`] has it, to the last bit.
    ///
    /// # Panics
    /// When one is not positive definite.
    pub fn logs_of(team: Team<'_>, metrics: &[Sym3]) -> Vec<Sym3> {
        team.map(GRAIN, metrics.len(), |i| checked_log(metrics[i]).expect("a positive definite tensor"))
    }

    /// As [`Field::read_logs`], without a mesh: as many as the file has.
    pub fn read_all_logs(team: Team<'_>, path: &Path) -> Result<Read<Vec<Sym3>>, Error> {
        read_each(team, path, None, checked_log)
    }

    /// As [`Field::read`], from the fields of a file of whatever format; `path` is what errors say.
    ///
    /// # Errors
    /// As there.
    pub fn of_solution(path: &Path, solution: &Solution, vertices: usize) -> Result<Self, Error> {
        let read = of_each(Team::alone(), path, solution, Some(vertices), |m| m.is_spd().then_some(m))?;
        Ok(Self { metrics: read.content })
    }

    /// ln M of the fields of a file of whatever format, with the checks of [`Field::read`]; `path` is what errors say.
    ///
    /// # Errors
    /// As there.
    pub fn logs_of_solution(
        team: Team<'_>,
        path: &Path,
        solution: &Solution,
        vertices: Option<usize>,
    ) -> Result<Read<Vec<Sym3>>, Error> {
        of_each(team, path, solution, vertices, checked_log)
    }

    /// The metric as a file holds it; `path` is what errors say.
    ///
    /// # Errors
    /// [`Error::NotHeld`] when a tensor is not positive definite in doubles.
    pub fn solution(&self, team: Team<'_>, path: &Path) -> Result<Solution, Error> {
        tensors(team, path, 0, &self.metrics, held).map(tensor_field)
    }

    /// M = exp of these logarithms as a file holds it; `path` is what errors say.
    ///
    /// # Errors
    /// As of [`Field::solution`].
    pub fn solution_of_logs(team: Team<'_>, path: &Path, logs: &[Sym3]) -> Result<Solution, Error> {
        tensors(team, path, 0, logs, held_exp).map(tensor_field)
    }

    /// Writes .sol or .solb by the extension.
    ///
    /// # Errors
    /// When the file cannot be written, and [`Error::NotHeld`] when a tensor is not positive definite in doubles.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let mut batch = Batch::new();
        self.add(&mut batch, Team::alone(), path)?;
        Ok(batch.commit()?)
    }

    /// Writes M = exp of these logarithms, shape (n,), as [`Field::write`] does.
    ///
    /// # Errors
    /// As there.
    pub fn write_logs(team: Team<'_>, path: &Path, logs: &[Sym3]) -> Result<(), Error> {
        let mut batch = Batch::new();
        Self::add_logs(&mut batch, team, path, logs)?;
        Ok(batch.commit()?)
    }

    /// Adds M = exp of these logarithms, as [`Field::write_logs`] writes it, to files that belong together.
    ///
    /// # Errors
    /// As there.
    pub fn add_logs(batch: &mut Batch, team: Team<'_>, path: &Path, logs: &[Sym3]) -> Result<(), Error> {
        Ok(io::add_solution(batch, team, path, &Self::solution_of_logs(team, path, logs)?)?)
    }

    /// Adds .sol or .solb, as [`Field::write`] writes it, to files that belong together.
    ///
    /// # Errors
    /// As there.
    pub fn add(&self, batch: &mut Batch, team: Team<'_>, path: &Path) -> Result<(), Error> {
        Ok(io::add_solution(batch, team, path, &self.solution(team, path)?)?)
    }
}

/// A metric as a file holds it, or else its sizes.
fn held(metric: Sym3) -> Result<Sym3, [f64; 3]> {
    if metric.is_held() { Ok(metric) } else { Err(metric.sizes()) }
}

/// M of its logarithm as a file holds it, or else its sizes.
fn held_exp(log: Sym3) -> Result<Sym3, [f64; 3]> {
    log.held_exp().ok_or_else(|| log.sizes_of_log())
}

/// What `metric` gives for each of some vertices, from vertex `start` on, or else the error with its sizes, if it cannot be written.
fn tensors(
    team: Team<'_>,
    path: &Path,
    start: usize,
    of: &[Sym3],
    metric: impl Fn(Sym3) -> Result<Sym3, [f64; 3]> + Sync,
) -> Result<Vec<[f64; 6]>, Error> {
    let mut values = vec![[0.0; 6]; of.len()];
    let first = AtomicUsize::new(usize::MAX);
    team.fill(GRAIN, &mut values, |start, rows| {
        rows.iter_mut().zip(start..).for_each(|(row, v)| match metric(of[v]) {
            Ok(metric) => *row = metric.0,
            Err(_) => _ = first.fetch_min(v, Relaxed),
        });
    });
    let first = first.into_inner();
    if let Some(Err(sizes)) = of.get(first).map(|&of| metric(of)) {
        return Err(Error::NotHeld { path: path.into(), vertex: start + first + 1, sizes });
    }
    Ok(values)
}

/// The solution of these tensors.
fn tensor_field(tensors: Vec<[f64; 6]>) -> Solution {
    let (vertices, kind) = (tensors.len(), FieldKind::SymmetricTensor);
    Solution { vertices, fields: vec![SolutionField { kind, values: tensors.into_flattened() }] }
}

/// ln M; none when M is not positive definite.
fn checked_log(m: Sym3) -> Option<Sym3> {
    let mut eigen = m.eigen_spd();
    let positive = eigen.values[0] > 0.0;
    eigen.values = eigen.values.map(f64::ln);
    positive.then(|| Sym3::from_eigen(&eigen))
}

/// What `convert` makes of the metrics of a file; none for one that is not positive definite. Of isotropic sizes h they are h⁻² I.
fn read_each(
    team: Team<'_>,
    path: &Path,
    expected: Option<usize>,
    convert: impl Fn(Sym3) -> Option<Sym3> + Sync,
) -> Result<Read<Vec<Sym3>>, Error> {
    let Read { content, mut notices } = io::read_solution_on(team, path)?;
    let found = of_each(team, path, &content, expected, convert)?;
    notices.extend(found.notices);
    Ok(Read { content: found.content, notices })
}

/// The same of fields that were read.
fn of_each(
    team: Team<'_>,
    path: &Path,
    solution: &Solution,
    expected: Option<usize>,
    convert: impl Fn(Sym3) -> Option<Sym3> + Sync,
) -> Result<Read<Vec<Sym3>>, Error> {
    let kinds: Vec<_> = solution.fields.iter().map(|field| field.kind).collect();
    let kind = only_metric(path, &kinds)?;
    check_count(path, solution.vertices, expected)?;
    let content = of_vertices(team, path, solution, 0, convert)?;
    let mut notices = Vec::new();
    if kind == FieldKind::Scalar {
        let (least, greatest) = extremes(&solution.fields[0].values);
        notices.push(format!(
            "{}: one scalar a vertex: isotropic sizes, from {least:.4} to {greatest:.4} (a solution goes in by --field)",
            path.display()
        ));
    }
    Ok(Read { content, notices })
}

/// What `convert` makes of the metrics at some vertices, from vertex `start` on. There is one field, as [`only_metric`] has it.
fn of_vertices(
    team: Team<'_>,
    path: &Path,
    solution: &Solution,
    start: usize,
    convert: impl Fn(Sym3) -> Option<Sym3> + Sync,
) -> Result<Vec<Sym3>, Error> {
    let field = &solution.fields[0];
    let is_sizes = field.kind == FieldKind::Scalar;
    let metric = |vertex: usize| match is_sizes {
        true => Some(field.values[vertex]).filter(|h| SIZES.contains(h)).map(isotropic),
        false => Some(Sym3(field.values.as_chunks().0[vertex])),
    };
    let parts = team.chunks(GRAIN, solution.vertices, |range| {
        let convert = |vertex: usize| metric(vertex).and_then(&convert).ok_or(vertex);
        range.map(convert).collect::<Result<Vec<Sym3>, usize>>()
    });
    let wrong = |v: usize| match is_sizes {
        true => Error::NotASize { path: path.into(), vertex: start + v + 1, size: field.values[v] },
        false => {
            let eigenvalues = Sym3(field.values.as_chunks().0[v]).eigen_jacobi().values;
            Error::NotPositive { path: path.into(), vertex: start + v + 1, eigenvalues }
        }
    };
    let converted = parts.into_iter().collect::<Result<Vec<_>, usize>>().map_err(wrong)?;
    Ok(team.join(converted))
}

/// Whether there are as many metrics as vertices, where that is known.
fn check_count(path: &Path, found: usize, expected: Option<usize>) -> Result<(), Error> {
    match expected.filter(|&expected| expected != found) {
        Some(expected) => Err(Error::Count { path: path.into(), found, expected }),
        None => Ok(()),
    }
}

/// h⁻² I, the metric of the same size h in all directions.
fn isotropic(h: f64) -> Sym3 {
    Sym3::IDENTITY.times(1.0 / (h * h))
}

/// Least and greatest.
fn extremes(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &x| (a.min(x), b.max(x)))
}

/// The kind of the one field of a metric file: symmetric tensors, or scalars, which are sizes.
fn only_metric(path: &Path, kinds: &[FieldKind]) -> Result<FieldKind, Error> {
    if let &[kind @ (FieldKind::SymmetricTensor | FieldKind::Scalar)] = kinds {
        return Ok(kind);
    }
    let kinds: Vec<&str> = kinds.iter().map(|&kind| kind_name(kind)).collect();
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
pub fn complexity(team: Team<'_>, mesh: &TetMesh, metrics: &[Sym3]) -> f64 {
    let densities = team.map(GRAIN, metrics.len(), |v| metrics[v].sqrt_det());
    weighted_complexity(team, &mesh.vertices, &mesh.tets.nodes, &densities)
}

/// [`complexity`] from ln M: √det M = e^(tr/2).
pub fn complexity_of_logs(team: Team<'_>, mesh: &TetMesh, logs: &[Sym3]) -> f64 {
    complexity_of_tets(team, &mesh.vertices, &mesh.tets.nodes, logs)
}

/// [`complexity_of_logs`] of some tetrahedra, shape (t, 4), on vertices, shape (n, 3): the share that they have in that of their mesh.
pub fn complexity_of_tets(team: Team<'_>, vertices: &[Vec3], tets: &[[u32; 4]], logs: &[Sym3]) -> f64 {
    weighted_complexity(team, vertices, tets, &team.map(GRAIN, logs.len(), |v| density(&logs[v])))
}

fn weighted_complexity(team: Team<'_>, vertices: &[Vec3], tets: &[[u32; 4]], densities: &[f64]) -> f64 {
    let of_tet = |tet: &[u32; 4]| {
        let [a, b, c, d] = tet.map(|v| vertices[v as usize]);
        share(volume6(a, b, c, d), tet.map(|v| densities[v as usize]))
    };
    over_tets(team, tets, of_tet) / SHARES
}

/// The share of a tetrahedron in C, times [`SHARES`], from six times its volume and √det M at its vertices.
pub(super) fn share(volume6: f64, densities: [f64; 4]) -> f64 {
    volume6 * densities.iter().sum::<f64>()
}

/// A quarter of a sixth.
pub(super) const SHARES: f64 = 24.0;

/// √det M of ln M.
pub(super) fn density(log: &Sym3) -> f64 {
    (0.5 * log.trace()).exp()
}

/// Complexity ∫ √det M of what is between the vertices ([`super::between`]): where sizes in a tetrahedron differ by no more than a factor of 2 exactly,
/// since ln √det M is linear there. On a mesh that does not resolve its metric this, and not [`complexity_of_logs`], is what an adapted mesh will have.
pub fn complexity_between(team: Team<'_>, mesh: &TetMesh, logs: &[Sym3]) -> f64 {
    complexity_terms(team, &mesh.vertices, &mesh.tets.nodes, logs).into_iter().sum()
}

/// The terms of [`complexity_between`], one for [`GRAIN`] tetrahedra each: of a mesh in slices of multiples of these they are the same.
pub fn complexity_terms(team: Team<'_>, vertices: &[Vec3], tets: &[[u32; 4]], logs: &[Sym3]) -> Vec<f64> {
    let of_tet = |tet: &[u32; 4]| {
        let [a, b, c, d] = tet.map(|v| vertices[v as usize]);
        share_between(volume6(a, b, c, d), tet.map(|v| &logs[v as usize]))
    };
    team.chunks(GRAIN, tets.len(), |range| tets[range].iter().map(of_tet).sum())
}

/// The share of a tetrahedron in [`complexity_between`], from six times its volume and ln M at its vertices.
pub(super) fn share_between(volume6: f64, logs: [&Sym3; 4]) -> f64 {
    volume6 / 6.0 * density_between(logs)
}

/// Sum over the tetrahedra.
fn over_tets(team: Team<'_>, tets: &[[u32; 4]], of_tet: impl Fn(&[u32; 4]) -> f64 + Sync) -> f64 {
    team.sum(GRAIN, tets.len(), |range| tets[range].iter().map(&of_tet).sum())
}

/// Mean of e^ℓ over a tetrahedron, ℓ linear with these values at its vertices: Σ_k 3!/(k+3)! h_k(ℓ), with h_k the complete
/// homogeneous polynomial (Hermite–Genocchi); counted from the least value no term is negative.
pub(super) fn mean_exponential(values: [f64; 4]) -> f64 {
    let least = values.into_iter().fold(f64::INFINITY, f64::min);
    let above = values.map(|value| value - least);
    // partial[i] is the term with h_k of the first i + 1 values only.
    let (mut partial, mut sum) = ([1.0; 4], 1.0);
    for &reciprocal in &RECIPROCALS {
        let mut before = 0.0;
        for i in 0..4 {
            partial[i] = before + above[i] * reciprocal * partial[i];
            before = partial[i];
        }
        sum += partial[3];
        if partial[3] <= f64::EPSILON * sum {
            break;
        }
    }
    least.exp() * sum
}

/// 1/(k + 3) for the terms k = 1, 2, … of [`mean_exponential`]. There are enough terms for sizes that differ by a factor of 1e20 within a
/// tetrahedron.
static RECIPROCALS: [f64; 600] = {
    let (mut reciprocals, mut i) = ([0.0; 600], 0);
    while i < reciprocals.len() {
        reciprocals[i] = 1.0 / (i + 4) as f64;
        i += 1;
    }
    reciprocals
};

/// Factor of M that takes a field from one complexity to another: (target/present)^(2/3).
pub fn complexity_factor(present: f64, target: f64) -> f64 {
    (target / present).powf(2.0 / 3.0)
}

/// Scales the metrics to a complexity on this mesh; returns the factor of M.
pub fn scale_to_complexity(team: Team<'_>, mesh: &TetMesh, metrics: &mut [Sym3], target: f64) -> f64 {
    let factor = complexity_factor(complexity(team, mesh, metrics), target);
    team.fill(GRAIN, metrics, |_, metrics| metrics.iter_mut().for_each(|m| *m = m.times(factor)));
    factor
}

#[cfg(test)]
mod tests;
