//! The multiscale metric: from fields at the vertices to the metric whose mesh has the least interpolation error in an L^p norm for its
//! number of vertices (METHOD.md §1.9; Loseille & Alauzet 2011).
//!
//! Fields → Hessians ([`Recovery`]) → |H|, averaged over the steps of a sensor → L^p metric of each sensor at the complexity wanted →
//! their intersection → limits, gradation, and the scale at which the complexity is met with these.
//!
//! The metrics of several sensors are intersected, each at the same complexity. So each has the sizes that it would have alone, up to one
//! factor for all, and units do not matter. Steps in time of one sensor are not intersected: their |H| are averaged, which makes the error
//! over the whole time least for one mesh at all steps (Alauzet, Belme, Loseille: fixed-point iteration).
mod bounded;
mod norm;
mod optimal;
mod reach;
pub(super) mod sensor;
#[cfg(test)]
mod tests;

use bounded::InMemory;
pub use bounded::{Bounds, Cut, SizeBound, bounded};
pub(super) use bounded::{Medium, meet};
pub use norm::Norm;

use super::recovery::{Recovery, Rings};
use super::{Limits, Sym3, field, intersect_all};
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, distance};
use crate::tasks::{GRAIN, Team, stage};
pub(super) use optimal::Spectrum;
pub(super) use reach::try_reach;
pub use reach::{Unreachable, five_digits, reach};
use serde::Serialize;

/// Which metric is made.
#[derive(Clone, Copy, Debug)]
pub struct Options<'f> {
    /// How Hessians are recovered.
    pub recovery: Recovery,
    /// The norm of the error.
    pub norm: Norm,
    /// Complexity, growth and bounds of the sizes. No size is ever above the diameter of the mesh's box.
    pub bounds: Bounds<'f>,
}

/// How the complexity is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Measure {
    /// Σ_v √det(M_v)·V_v, as metrics are compared.
    #[default]
    AtVertices,
    /// ∫ √det M of what is between the vertices. It predicts the vertices of the adapted mesh even where this mesh does not resolve its metric.
    Between,
}

impl Measure {
    fn of(self, team: Team<'_>, mesh: &TetMesh, logs: &[Sym3]) -> f64 {
        match self {
            Self::AtVertices => field::complexity_of_logs(team, mesh, logs),
            Self::Between => field::complexity_between(team, mesh, logs),
        }
    }
}

/// What was done.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Complexity before gradation at the scale that was found.
    pub complexity_before_gradation: f64,
    /// Complexity that was reached.
    pub complexity: f64,
    /// Vertices whose sizes the limits changed, before gradation.
    pub limited: usize,
    /// What the bound of sizes by each other cut, before gradation.
    #[serde(skip)]
    pub cut: Option<Cut>,
    /// Vertices that have the Hessian of their neighbours, since the points around them do not determine one.
    pub unfitted: usize,
    /// How often the metric was scaled, limited and graded.
    pub rounds: u32,
}

/// Why there is no metric. Sensors, steps and vertices count from 0.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// There is no sensor, or one without a step.
    #[error("no field is given")]
    Nothing,
    /// The second derivatives of a sensor are rounding.
    #[error(
        "the field is constant or linear to rounding: it has no second derivatives, so that no size follows from it; give another field"
    )]
    Flat {
        /// The sensor.
        sensor: usize,
    },
    /// A value is NaN or infinite.
    #[error("the value of vertex {} is not a finite number", vertex + 1)]
    NotFinite {
        /// The sensor.
        sensor: usize,
        /// The step.
        step: usize,
        /// The vertex.
        vertex: usize,
    },
    /// The limits do not let the complexity come near.
    #[error(
        "a complexity of {target} cannot be reached: with these limits the nearest is {}; give another --complexity or --vertices, or \
         change what bounds the sizes at any complexity: --local, --wall, --hmin, --hmax or --aspect-ratio (no size is above the \
         diameter of the mesh's box)",
        five_digits(*nearest)
    )]
    Unreachable {
        /// The complexity wanted.
        target: f64,
        /// The nearest one.
        nearest: f64,
    },
}

impl From<Unreachable> for Error {
    fn from(Unreachable { target, nearest }: Unreachable) -> Self {
        Self::Unreachable { target, nearest }
    }
}

/// ln M at the vertices, shape (n,), of the multiscale metric of some sensors. Each sensor has a field, shape (n,), for each step in
/// time; mostly there is one.
///
/// # Panics
/// When a field has not one value a vertex.
pub fn multiscale(
    team: Team<'_>,
    mesh: &TetMesh,
    sensors: &[Vec<&[f64]>],
    options: &Options<'_>,
) -> Result<(Vec<Sym3>, Summary), Error> {
    if sensors.is_empty() || sensors.iter().any(Vec::is_empty) {
        return Err(Error::Nothing);
    }
    let diameter = diameter(team, mesh);
    let limits = within(options.bounds.limits, diameter);
    let (hmax, bounds) = (limits.hmax.unwrap_or(diameter), Bounds { limits, ..options.bounds });
    let rings = Rings::of(team, mesh);
    stage("rings");
    let (mut raw, mut unfitted) = (Vec::new(), 0);
    for (number, steps) in sensors.iter().enumerate() {
        let found = sensor::absolute(team, mesh, &rings, options.recovery, (number, steps), diameter)?;
        unfitted = unfitted.max(found.unfitted);
        stage("hessians");
        let logs = optimal_logs(team, mesh, (&found.hessians, found.floor), options, hmax)?;
        stage("optimal");
        if raw.is_empty() {
            raw = logs;
        } else {
            intersect_all(team, &mut raw, &logs);
        }
    }
    let medium = InMemory { team, mesh, around: Some(rings.into_neighbours()), raw: &raw };
    let (logs, summary) = meet(&medium, &bounds)?;
    Ok((logs, Summary { unfitted, ..summary }))
}

/// ln M at the vertices, shape (n,), of a field whose |H| at the vertices is known, shape (n,), and need not be recovered from the mesh. `range` is
/// the greatest difference of its values.
///
/// # Errors
/// [`Error::Unreachable`] when the bounds do not let the complexity come near.
pub fn multiscale_of_hessians(
    team: Team<'_>,
    mesh: &TetMesh,
    (hessians, range): (&[Sym3], f64),
    options: &Options<'_>,
) -> Result<(Vec<Sym3>, Summary), Error> {
    let diameter = diameter(team, mesh);
    let limits = within(options.bounds.limits, diameter);
    let floor = sensor::floor(range, diameter);
    let raw = optimal_logs(team, mesh, (hessians, floor), options, limits.hmax.unwrap_or(diameter))?;
    bounded(team, mesh, &raw, &Bounds { limits, ..options.bounds })
}

/// The metric of one |H| at the vertices, as that of a sensor is made. `rings` are those of the mesh.
pub(super) fn of_absolute(
    team: Team<'_>,
    mesh: &TetMesh,
    rings: Rings,
    found: &sensor::Absolute,
    options: &Options<'_>,
) -> Result<(Vec<Sym3>, Summary), Error> {
    let diameter = diameter(team, mesh);
    let limits = within(options.bounds.limits, diameter);
    let hmax = limits.hmax.unwrap_or(diameter);
    let raw = optimal_logs(team, mesh, (&found.hessians, found.floor), options, hmax)?;
    let medium = InMemory { team, mesh, around: Some(rings.into_neighbours()), raw: &raw };
    let (logs, summary) = meet(&medium, &Bounds { limits, ..options.bounds })?;
    Ok((logs, Summary { unfitted: found.unfitted, ..summary }))
}

/// The limits, where no size is above the diameter.
pub(super) fn within(limits: Limits, diameter: f64) -> Limits {
    Limits { hmax: Some(limits.hmax.unwrap_or(diameter).min(diameter)), ..limits }
}

/// ln M of the optimal metric of a sensor at the complexity wanted, without other bounds than `hmax`.
fn optimal_logs(
    team: Team<'_>,
    mesh: &TetMesh,
    (hessians, floor): (&[Sym3], f64),
    options: &Options<'_>,
    hmax: f64,
) -> Result<Vec<Sym3>, Error> {
    let spectra = team.map(GRAIN, hessians.len(), |v| Spectrum::of(&hessians[v], floor));
    let mut logs = Vec::new();
    // Unless sizes are at their bound, the second round is right.
    let reached = reach(options.bounds.complexity, |scale| {
        let log = |v: usize| spectra[v].log_metric(options.norm, scale, hmax);
        team.remap(GRAIN, &mut logs, spectra.len(), log);
        options.bounds.measure.of(team, mesh, &logs)
    });
    reached?;
    Ok(logs)
}

/// The diagonal of the box of the vertices that tetrahedra have.
pub fn diameter(team: Team<'_>, mesh: &TetMesh) -> f64 {
    let tets = &mesh.tets.nodes;
    let parts = team.chunks(GRAIN, tets.len(), |range| {
        Extent::of(tets[range].iter().flatten().map(|&v| mesh.vertices[v as usize]))
    });
    parts.into_iter().fold(Extent::NONE, Extent::and).diagonal()
}

/// The box of some points.
#[derive(Clone, Copy)]
pub(super) struct Extent([Vec3; 2]);

impl Extent {
    /// That of none.
    pub const NONE: Self = Self([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]]);

    /// That of these.
    pub fn of(points: impl Iterator<Item = Vec3>) -> Self {
        points.fold(Self::NONE, |found, p| found.and(Self([p, p])))
    }

    /// That of others too.
    pub fn and(self, Self([l, h]): Self) -> Self {
        let Self([low, high]) = self;
        Self([std::array::from_fn(|i| low[i].min(l[i])), std::array::from_fn(|i| high[i].max(h[i]))])
    }

    /// Its diagonal.
    pub fn diagonal(self) -> f64 {
        let Self([low, high]) = self;
        distance(low, high)
    }
}
