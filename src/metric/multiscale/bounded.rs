//! Limits and gradation, and the scale at which the complexity is met with them.
use super::reach::{NEARLY, Unreachable, reach_within, try_reach};
use super::{Error, Measure, Summary};
use crate::mesh::TetMesh;
use crate::mesh::vertex_neighbours::VertexNeighbours;
use crate::metric::{Limits, Sym3, gradation, intersect_all};
use crate::tasks::{GRAIN, Team, stage};
use serde::Serialize;

/// First guess of the logarithm of the scale at which a metric has the complexity wanted after gradation.
const USUAL_SCALE: f64 = -0.2;

/// A bound of sizes that depends on the others at the same vertex, so that it is applied at each scale. It makes no size larger, and what it has
/// cut it leaves as it is.
pub trait SizeBound: std::fmt::Debug + Sync {
    /// Cuts ln M at the vertices of the mesh, shape (n,).
    fn apply(&self, team: Team<'_>, logs: &mut [Sym3]) -> Cut;
}

/// What a bound has cut.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Cut {
    /// Vertices whose sizes were cut.
    pub vertices: usize,
    /// The greatest ratio of a size to what it was cut to.
    pub greatest: f64,
}

impl Default for Cut {
    fn default() -> Self {
        Self { vertices: 0, greatest: 1.0 }
    }
}

impl Cut {
    /// That of other vertices too.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self { vertices: self.vertices + other.vertices, greatest: self.greatest.max(other.greatest) }
    }
}

/// The complexity of a metric, and what bounds its sizes.
#[derive(Clone, Copy, Debug)]
pub struct Bounds<'f> {
    /// The complexity C that is met, to 1 %, within all bounds.
    pub complexity: f64,
    /// How C is measured from ln M at the vertices.
    pub measure: Measure,
    /// Greatest growth of sizes, above 1; none for no gradation.
    pub gradation: Option<f64>,
    /// Bounds of the sizes.
    pub limits: Limits,
    /// ln of a metric that is intersected whatever the scale, shape (n,): what the geometry asks for, or sizes in some places.
    pub fixed: Option<&'f [Sym3]>,
    /// A bound of sizes by each other, after all others and after gradation.
    pub by_others: Option<&'f dyn SizeBound>,
}

impl Bounds<'_> {
    /// Limits ln M at the vertices, intersects it with what is fixed, and bounds sizes by each other. Returns at how many vertices the limits
    /// changed it, and what the last has cut.
    pub fn apply(&self, team: Team<'_>, logs: &mut [Sym3]) -> (usize, Option<Cut>) {
        let limited = self.limits.apply(team, logs);
        if let Some(fixed) = self.fixed {
            intersect_all(team, logs, fixed);
        }
        (limited, self.by_others.map(|bound| bound.apply(team, logs)))
    }
}

/// Where ln M at the vertices is, and what is done with it there. The metric before its bounds, at scale 1, is called raw.
pub(in crate::metric) trait Medium {
    /// ln M at the vertices.
    type Logs;
    /// Why there is no metric.
    type Error: From<Unreachable>;

    /// Room for one.
    fn room(&self) -> Result<Self::Logs, Self::Error>;

    /// Puts into `to` what `from` (none: the raw metric) is at another scale, its logarithm given, within the bounds. Returns what
    /// [`Bounds::apply`] does.
    fn scaled(
        &self,
        from: Option<&Self::Logs>,
        log_scale: f64,
        bounds: &Bounds<'_>,
        to: &mut Self::Logs,
    ) -> Result<(usize, Option<Cut>), Self::Error>;

    /// As [`Medium::scaled`], in place.
    fn rescale(&self, logs: &mut Self::Logs, log_scale: f64, bounds: &Bounds<'_>) -> Result<(), Self::Error>;

    /// Lets sizes grow by a ratio at most.
    fn grade(&self, logs: &mut Self::Logs, ratio: f64) -> Result<(), Self::Error>;

    /// The complexity, as it is measured here.
    fn complexity(&self, logs: &Self::Logs, measure: Measure) -> Result<f64, Self::Error>;
}

/// A metric in memory.
pub(super) struct InMemory<'m> {
    pub team: Team<'m>,
    pub mesh: &'m TetMesh,
    /// The neighbours of the vertices; none without gradation.
    pub around: Option<VertexNeighbours>,
    pub raw: &'m [Sym3],
}

impl Medium for InMemory<'_> {
    type Logs = Vec<Sym3>;
    type Error = Error;

    fn room(&self) -> Result<Vec<Sym3>, Error> {
        Ok(Vec::new())
    }

    fn scaled(
        &self,
        from: Option<&Vec<Sym3>>,
        log_scale: f64,
        bounds: &Bounds<'_>,
        to: &mut Vec<Sym3>,
    ) -> Result<(usize, Option<Cut>), Error> {
        let from = from.map_or(self.raw, Vec::as_slice);
        self.team.remap(GRAIN, to, from.len(), |v| from[v].plus_identity(log_scale));
        Ok(bounds.apply(self.team, to))
    }

    fn rescale(&self, logs: &mut Vec<Sym3>, log_scale: f64, bounds: &Bounds<'_>) -> Result<(), Error> {
        self.team.fill(GRAIN, logs, |_, logs| logs.iter_mut().for_each(|log| *log = log.plus_identity(log_scale)));
        bounds.apply(self.team, logs);
        Ok(())
    }

    fn grade(&self, logs: &mut Vec<Sym3>, ratio: f64) -> Result<(), Error> {
        if let Some(around) = &self.around {
            gradation::grade_with(self.team, &self.mesh.vertices, around, logs, ratio);
        }
        Ok(())
    }

    fn complexity(&self, logs: &Vec<Sym3>, measure: Measure) -> Result<f64, Error> {
        Ok(measure.of(self.team, self.mesh, logs))
    }
}

/// The metric within its bounds and graded, at the scale at which it has the complexity wanted. `raw` is ln M before that.
///
/// # Errors
/// [`Error::Unreachable`] when there is no such scale.
pub fn bounded(
    team: Team<'_>,
    mesh: &TetMesh,
    raw: &[Sym3],
    bounds: &Bounds<'_>,
) -> Result<(Vec<Sym3>, Summary), Error> {
    let around = bounds.gradation.map(|_| VertexNeighbours::of_mesh(team, mesh));
    meet(&InMemory { team, mesh, around, raw }, bounds)
}

/// As [`bounded`], wherever the metric is.
pub(in crate::metric) fn meet<M: Medium>(medium: &M, bounds: &Bounds<'_>) -> Result<(M::Logs, Summary), M::Error> {
    let (mut of, mut scale, mut rounds) = (None, 0.0, 0);
    if let Some(ratio) = bounds.gradation {
        let (logs, at, asked) = graded(medium, ratio, bounds)?;
        (of, scale, rounds) = (Some(logs), at, asked);
    }
    let (mut logs, mut reached) = (medium.room()?, 0.0);
    let (more, again) = try_reach(bounds.complexity, |more| -> Result<f64, M::Error> {
        medium.scaled(of.as_ref(), more, bounds, &mut logs)?;
        reached = medium.complexity(&logs, bounds.measure)?;
        Ok(reached)
    })?;
    let mut before = of.map_or_else(|| medium.room(), Ok)?;
    let (limited, cut) = medium.scaled(None, scale + more, bounds, &mut before)?;
    let summary = Summary {
        complexity_before_gradation: medium.complexity(&before, bounds.measure)?,
        complexity: reached,
        limited,
        cut,
        unfitted: 0,
        rounds: if bounds.gradation.is_some() { rounds } else { again },
    };
    Ok((logs, summary))
}

/// ln M, graded, of nearly the complexity wanted; the scale of the raw metric from which it was graded; and the number of gradings.
///
/// Gradation costs most of all. So a metric whose complexity is nearly right will do; it is scaled afterwards. A metric that was graded by
/// the ratio r^k is graded by r when its sizes are multiplied by 1/k or less, for in the bound on growth ln r stands beside |e|/h only.
/// For the same reason a metric that was graded and then made coarser is nowhere finer than the graded one at the coarser scale. So
/// grading goes on from it instead of from the beginning, unless there is a least size, which does not scale.
fn graded<M: Medium>(medium: &M, ratio: f64, bounds: &Bounds<'_>) -> Result<(M::Logs, f64, u32), M::Error> {
    let ratio = ratio.powf(1.0 - NEARLY / 3.0);
    let (mut logs, mut last) = (medium.room()?, f64::NEG_INFINITY);
    let (scale, rounds) = reach_within(NEARLY, bounds.complexity, USUAL_SCALE, |scale| -> Result<f64, M::Error> {
        if scale < last && bounds.limits.hmin.is_none() {
            medium.rescale(&mut logs, scale - last, bounds)?;
        } else {
            medium.scaled(None, scale, bounds, &mut logs)?;
        }
        last = scale;
        medium.grade(&mut logs, ratio)?;
        stage("graded");
        medium.complexity(&logs, bounds.measure)
    })?;
    Ok((logs, scale, rounds))
}
