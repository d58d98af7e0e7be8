//! The multiscale metric of a mesh larger than memory, to the bit that of [`super::multiscale`].
//!
//! The mesh is gone through twice: slice by slice of the tetrahedra ([`mesh`]), then range by range of the vertices, for the neighbours of each
//! ([`Neighbours`]). From there on a scratch folder has all that is needed: neighbours, points and values of each vertex, nodes and volume of
//! each tetrahedron. Hessians are fitted vertex by vertex ([`hessians`]), sums are taken over the tetrahedra in the order of the file, and sizes
//! grow by the same front as in memory ([`gradation`]). A few numbers a vertex are held ([`Sizes`]).
mod error;
mod gradation;
mod hessians;
mod local;
mod mesh;
mod sizes;
mod stored;
#[cfg(test)]
mod tests;

pub use error::Error;
pub use sizes::Sizes;

use super::multiscale::{Bounds, Measure, Norm, Spectrum, Summary, meet, try_reach, within};
use super::summary::{self, Percentiles};
use super::{Field, Limits, Sym3, intersect_all};
use crate::mesh::io::slices::{MeshReader, MetricWriter, SolutionReader};
use crate::mesh::ranges::{Column, Scratch};
use crate::tasks::{Team, stage};
use hessians::Absolute;
use mesh::Mesh;
use stored::Stored;

/// A step in time of a sensor: a number of each vertex of a file.
#[derive(Clone, Copy, Debug)]
pub struct Step<'f> {
    /// The file, with as many vertices as the mesh.
    pub file: &'f SolutionReader,
    /// Which number, from 0 through all fields.
    pub component: usize,
}

/// Which metric is made; Hessians are recovered by fit.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// The norm of the error.
    pub norm: Norm,
    /// The complexity Σ_v √det(M_v)·V_v that is met, to 1 %.
    pub complexity: f64,
    /// Greatest growth of sizes, above 1; none for no gradation.
    pub gradation: Option<f64>,
    /// Bounds of the sizes. No size is ever above the diameter of the mesh's box.
    pub limits: Limits,
}

/// Vertices that are read and written at once where nothing but themselves matters.
const SLICE: usize = 1 << 14;

/// The metric of some sensors, in a scratch folder.
pub struct Metric<'t> {
    team: Team<'t>,
    mesh: Mesh,
    logs: Column<Sym3>,
}

/// The multiscale metric of some sensors, each with its steps in time, and what was done.
///
/// # Errors
/// When a file cannot be read or is wrong, or the scratch folder not be written; [`Error::Multiscale`] for fields of which there is no metric,
/// [`Error::TooFew`] where a piece of the mesh is too small.
pub fn multiscale<'t>(
    team: Team<'t>,
    mesh: &MeshReader,
    sensors: &[Vec<Step<'_>>],
    options: &Options,
    (sizes, scratch): (&Sizes, &Scratch),
) -> Result<(Metric<'t>, Summary), Error> {
    let mesh = Mesh::read(team, mesh, sizes, scratch)?;
    stage("mesh read");
    let limits = within(options.limits, mesh.diameter);
    let bounds = Bounds {
        complexity: options.complexity,
        measure: Measure::AtVertices,
        gradation: options.gradation,
        limits,
        fixed: None,
        by_others: None,
    };
    let (mut raw, mut unfitted) = (None, 0);
    for (number, steps) in sensors.iter().enumerate() {
        let found = hessians::absolute(team, &mesh, (number, steps), sizes, scratch)?;
        stage("hessians");
        unfitted = unfitted.max(found.unfitted);
        let logs = optimal_logs(team, &mesh, &found, (options.norm, &bounds), scratch)?;
        stage("optimal");
        match &raw {
            None => raw = Some(logs),
            Some(raw) => intersect(team, mesh.vertices, raw, &logs)?,
        }
    }
    let raw = raw.ok_or(super::multiscale::Error::Nothing)?;
    let (logs, summary) = meet(&Stored { team, mesh: &mesh, raw: &raw, scratch }, &bounds)?;
    Ok((Metric { team, mesh, logs }, Summary { unfitted, ..summary }))
}

/// ln M of the optimal metric of a sensor at the complexity wanted, without other bounds than the greatest size.
fn optimal_logs(
    team: Team<'_>,
    mesh: &Mesh,
    found: &Absolute,
    (norm, bounds): (Norm, &Bounds<'_>),
    scratch: &Scratch,
) -> Result<Column<Sym3>, Error> {
    let (logs, hmax) = (scratch.column()?, bounds.limits.hmax.unwrap_or(mesh.diameter));
    try_reach(bounds.complexity, |log_scale| -> Result<f64, Error> {
        each_slice(team, SLICE, mesh.vertices, |range| {
            let mut slice = found.hessians.read(range.clone())?;
            for log in &mut slice {
                *log = Spectrum::of(log, found.floor).log_metric(norm, log_scale, hmax);
            }
            Ok(logs.write(range.start, &slice)?)
        })?;
        mesh.complexity(team, &logs)
    })?;
    Ok(logs)
}

/// Intersects ln M at all vertices with that of another metric.
fn intersect(team: Team<'_>, vertices: usize, raw: &Column<Sym3>, other: &Column<Sym3>) -> Result<(), Error> {
    each_slice(team, SLICE, vertices, |range| {
        let mut slice = raw.read(range.clone())?;
        intersect_all(Team::alone(), &mut slice, &other.read(range.clone())?);
        Ok(raw.write(range.start, &slice)?)
    })?;
    Ok(())
}

/// What `f` makes of slices of so many items, each a task, in their order.
///
/// # Errors
/// The first one.
fn each_slice<T: Send>(
    team: Team<'_>,
    size: usize,
    items: usize,
    f: impl Fn(std::ops::Range<usize>) -> Result<T, Error> + Sync,
) -> Result<Vec<T>, Error> {
    team.chunks(size, items, f).into_iter().collect()
}

impl Metric<'_> {
    /// Writes M.
    ///
    /// # Errors
    /// When the file cannot be written, or a tensor is not positive definite in doubles.
    pub fn put(&self, to: &MetricWriter) -> Result<(), Error> {
        each_slice(self.team, SLICE, self.mesh.vertices, |range| {
            Ok(Field::put_logs(Team::alone(), to, range.start, &self.logs.read(range.clone())?)?)
        })?;
        Ok(())
    }

    /// Its figures.
    ///
    /// # Errors
    /// When the scratch folder cannot be read.
    pub fn summary(&self) -> Result<summary::Summary, Error> {
        let Self { team, mesh, logs } = self;
        let mut percentiles = [Percentiles::default(); 4];
        for (percentiles, logarithm) in percentiles.iter_mut().zip(summary::LOGARITHMS) {
            let of = |log: &Sym3| logarithm(&summary::log_sizes(log)).exp();
            *percentiles = Percentiles::of(mesh.of_each(*team, logs, of)?);
        }
        let complexities = [mesh.complexity(*team, logs)?, mesh.complexity_between(*team, logs)?];
        Ok(summary::Summary::of_parts(mesh.vertices, complexities, percentiles))
    }
}
