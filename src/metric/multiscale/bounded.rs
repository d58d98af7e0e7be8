//! Limits and gradation, and the scale at which the complexity is met with them.
use super::reach::{NEARLY, Unreachable, reach, reach_within};
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
    bounded_with(team, mesh, None, raw, bounds)
}

/// As [`bounded`], with the neighbours of the vertices, if they are known.
pub(super) fn bounded_with(
    team: Team<'_>,
    mesh: &TetMesh,
    around: Option<VertexNeighbours>,
    raw: &[Sym3],
    bounds: &Bounds<'_>,
) -> Result<(Vec<Sym3>, Summary), Error> {
    let target = bounds.complexity;
    let scaled = |logs: &[Sym3], scale: f64, to: &mut Vec<Sym3>| {
        team.remap(GRAIN, to, logs.len(), |v| logs[v].plus_identity(scale));
        bounds.apply(team, to)
    };
    let complexity = |logs: &[Sym3]| bounds.measure.of(team, mesh, logs);
    let unreachable = |Unreachable { nearest }| Error::Unreachable { target, nearest };
    let (mut of, mut scale, mut rounds) = (Vec::new(), 0.0, 0);
    if let Some(ratio) = bounds.gradation {
        let around = around.unwrap_or_else(|| VertexNeighbours::of_mesh(team, mesh));
        (of, scale, rounds) = graded(team, mesh, &around, raw, (ratio, bounds)).map_err(unreachable)?;
    }
    let of = if bounds.gradation.is_some() { &of } else { raw };
    let (mut logs, mut reached) = (Vec::new(), 0.0);
    let (more, again) = reach(target, |more| {
        scaled(of, more, &mut logs);
        reached = complexity(&logs);
        reached
    })
    .map_err(unreachable)?;
    let mut before = Vec::new();
    let (limited, cut) = scaled(raw, scale + more, &mut before);
    let summary = Summary {
        complexity_before_gradation: complexity(&before),
        complexity: reached,
        limited,
        cut,
        unfitted: 0,
        rounds: if bounds.gradation.is_some() { rounds } else { again },
    };
    Ok((logs, summary))
}

/// ln M, graded, of nearly the complexity wanted; the scale of `raw` from which it was graded; and the number of gradings.
///
/// Gradation costs most of all. So a metric whose complexity is nearly right will do; it is scaled afterwards. A metric that was graded by
/// the ratio r^k is graded by r when its sizes are multiplied by 1/k or less, for in the bound on growth ln r stands beside |e|/h only.
/// For the same reason a metric that was graded and then made coarser is nowhere finer than the graded one at the coarser scale. So
/// grading goes on from it instead of from the beginning, unless there is a least size, which does not scale.
fn graded(
    team: Team<'_>,
    mesh: &TetMesh,
    around: &VertexNeighbours,
    raw: &[Sym3],
    (ratio, bounds): (f64, &Bounds<'_>),
) -> Result<(Vec<Sym3>, f64, u32), Unreachable> {
    let ratio = ratio.powf(1.0 - NEARLY / 3.0);
    let (mut logs, mut last) = (Vec::new(), f64::NEG_INFINITY);
    let (scale, rounds) = reach_within(NEARLY, bounds.complexity, USUAL_SCALE, |scale| {
        if scale < last && bounds.limits.hmin.is_none() {
            team.fill(GRAIN, &mut logs, |_, logs: &mut [Sym3]| {
                logs.iter_mut().for_each(|log| *log = log.plus_identity(scale - last));
            });
        } else {
            team.remap(GRAIN, &mut logs, raw.len(), |v| raw[v].plus_identity(scale));
        }
        last = scale;
        bounds.apply(team, &mut logs);
        gradation::grade_with(team, &mesh.vertices, around, &mut logs, ratio);
        stage("graded");
        bounds.measure.of(team, mesh, &logs)
    })?;
    Ok((logs, scale, rounds))
}
