//! The metric of the layers along walls.
use super::feet::Feet;
use super::foot::Foot;
use super::growth::{Growth, Outside};
use super::spalding::{held_velocity, velocity};
use super::spec::Wall;
use crate::geometry::Model;
use crate::geometry::classify::Classification;
use crate::mesh::TetMesh;
use crate::mesh::vertex_neighbours::VertexNeighbours;
use crate::metric::field::complexity_between;
use crate::metric::gradation::grade_with;
use crate::metric::multiscale::{self, Bounds, Measure, Norm, Unreachable, bounded, multiscale_of_hessians, reach};
use crate::metric::{Limits, Sym3, intersect_all};
use crate::tasks::{GRAIN, Team, stage};
use serde::Serialize;

/// A wall, and the faces of the model that it is.
#[derive(Clone, Debug)]
pub struct Asked {
    /// What its layers are to be like.
    pub wall: Wall,
    /// The faces, from 0.
    pub faces: Vec<u32>,
}

/// What the metric of walls is made by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Sizes where no layer is.
    pub outside: Outside,
    /// The complexity that is met: by the sizes along the walls and outside, or where a wall follows Spalding's law by those of the law. Without,
    /// sizes are as they are asked for.
    pub complexity: Option<f64>,
    /// The norm of the interpolation error of u⁺.
    pub norm: Norm,
    /// Whether sizes stay as they are asked for at each vertex, however much they differ from one to the next: see [`wall_metric`].
    pub exact: bool,
}

/// What was found and done.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Each wall.
    pub walls: Vec<OfWall>,
    /// Vertices whose sizes gradation has made smaller.
    pub graded: usize,
}

/// What was found of a wall.
#[derive(Clone, Debug, Serialize)]
pub struct OfWall {
    /// What was asked for.
    #[serde(flatten)]
    pub wall: Wall,
    /// How many faces it is.
    pub faces: usize,
    /// How many vertices of the mesh are on it.
    pub vertices: usize,
    /// Least and greatest size across the wall at these in the metric, model units; none where there are none.
    pub first_heights: Option<[f64; 2]>,
}

/// Sizes of layers grow by no more than this from an edge to the next, or by their own growth.
const GRADATION: f64 = 2.0;

/// Why there is no metric.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// Spalding's law has no scale of its own.
    #[error("law=spalding makes the metric that is best for a complexity: give one")]
    NoComplexity,
    /// No such metric has the complexity.
    #[error(transparent)]
    Multiscale(#[from] multiscale::Error),
}

impl From<Unreachable> for Error {
    fn from(error: Unreachable) -> Self {
        Self::Multiscale(error.into())
    }
}

/// ln M at the vertices, shape (n,), of the layers along some walls, intersected; outside of them the greatest size. Lengths are in model units.
///
/// Layers that are prescribed have the size h(d) along the gradient of the exact distance d ([`Growth::log`]). Spalding's u⁺(d) has the second
/// derivatives u⁺″ n nᵀ + u⁺′ ∇²d, from which the multiscale metric of the complexity follows.
///
/// Along a wall whose curvature changes from one vertex to the next, as at the tip of a wing, sizes would grow faster than a mesh can follow. So, unless
/// `exact`, the layers are graded, by a factor of 2 from an edge to the next, or by their own growth where that is more.
///
/// # Errors
/// [`Error::NoComplexity`] with Spalding's law and no complexity; [`Error::Multiscale`] where that cannot be reached.
pub fn wall_metric(
    team: Team<'_>,
    (mesh, place, model): (&TetMesh, &Classification, &Model),
    asked: &[Asked],
    options: &Options,
) -> Result<(Vec<Sym3>, Summary), Error> {
    let is_spalding = asked.iter().any(|asked| asked.wall.spalding.is_some());
    if is_spalding && options.complexity.is_none() {
        return Err(Error::NoComplexity);
    }
    let outside = &options.outside;
    let feet: Vec<Feet> = asked
        .iter()
        .map(|asked| {
            let layers = asked.wall.growth.as_ref().map(|growth| (growth, outside));
            Feet::of(team, (mesh, place, model), &asked.faces, layers)
        })
        .collect();
    stage("distances");
    let prescribed: Vec<(&Feet, Growth)> =
        feet.iter().zip(asked).filter_map(|(feet, asked)| Some((feet, asked.wall.growth?))).collect();
    // Layers grow by g − 1 a unit of length, gradation lets sizes grow by ln r.
    let ratio = prescribed.iter().map(|(_, growth)| (growth.growth - 1.0).exp()).fold(GRADATION, f64::max);
    let around = (!options.exact).then(|| VertexNeighbours::of_mesh(team, mesh));
    let mut graded = 0;
    let mut layered = |along: f64| {
        let mut logs = layers(team, &prescribed, mesh.vertices.len(), outside, along);
        if let Some(around) = &around {
            graded = grade_with(team, &mesh.vertices, around, &mut logs, ratio).changed;
        }
        logs
    };
    let logs = match options.complexity {
        None => layered(1.0),
        Some(complexity) if is_spalding => {
            let fixed = (!prescribed.is_empty()).then(|| layered(1.0));
            let limits = Limits { hmax: Some(outside.greatest), ..Limits::default() };
            let measure = Measure::Between;
            let alone = Bounds { complexity, measure, gradation: None, limits, fixed: None, by_others: None };
            let how = multiscale::Options { recovery: Default::default(), norm: options.norm, bounds: alone };
            let mut raw: Option<Vec<Sym3>> = None;
            for (feet, asked) in feet.iter().zip(asked) {
                let Some(unit) = asked.wall.spalding else { continue };
                let (hessians, range) = spalding_hessians(team, feet, unit);
                let (logs, _) = multiscale_of_hessians(team, mesh, (&hessians, range), &how)?;
                match &mut raw {
                    None => raw = Some(logs),
                    Some(raw) => drop(intersect_all(team, raw, &logs)),
                }
            }
            let bounds = Bounds { fixed: fixed.as_deref(), ..alone };
            bounded(team, mesh, &raw.unwrap_or_default(), &bounds)?.0
        }
        Some(complexity) => {
            let mut logs = Vec::new();
            reach(complexity, |scale| {
                logs = layered((-0.5 * scale).exp());
                complexity_between(team, mesh, &logs)
            })?;
            logs
        }
    };
    stage("layers");
    let walls = feet.iter().zip(asked).map(|(feet, asked)| OfWall::of(team, feet, asked, &logs)).collect();
    Ok((logs, Summary { walls, graded }))
}

/// ln M of the layers that are prescribed. Sizes along the walls and outside are multiplied by `along`, those across stay. Sizes that doubles do not hold
/// beside these are cut.
fn layers(team: Team<'_>, walls: &[(&Feet, Growth)], vertices: usize, outside: &Outside, along: f64) -> Vec<Sym3> {
    let none = Sym3::ZERO.plus_identity(-2.0 * (outside.greatest * along).ln());
    team.map(GRAIN / 4, vertices, |v| {
        let of = |(feet, growth): &(&Feet, Growth)| {
            let logs = feet.at(v).iter().filter_map(|foot| growth.log(foot, outside, along));
            logs.fold(None, intersected)
        };
        walls.iter().filter_map(of).fold(None, intersected).unwrap_or(none).held_log()
    })
}

fn intersected(all: Option<Sym3>, log: Sym3) -> Option<Sym3> {
    Some(all.map_or(log, |all| all.intersect_logs(&log)))
}

/// |∇²u⁺| at the vertices, 1/length², of Spalding's law along a wall, and the greatest u⁺. `unit` is the height of y⁺ = 1. At y⁺ below 7 the second
/// derivative across is that of y⁺ = 7.
fn spalding_hessians(team: Team<'_>, feet: &Feet, unit: f64) -> (Vec<Sym3>, f64) {
    let of = |foot: &Foot| {
        let velocity = held_velocity(foot.distance / unit);
        foot.hessian([velocity.first / unit, velocity.second / (unit * unit)]).magnitude()
    };
    let hessians = team.map(GRAIN / 4, feet.len(), |v| {
        let nearest = feet.distance(v);
        // On an edge of the wall all its faces are the nearest.
        feet.at(v).iter().filter(|foot| foot.distance <= nearest).map(of).fold(Sym3::ZERO, Sym3::plus)
    });
    let most = |range: std::ops::Range<usize>| range.map(|v| feet.distance(v)).fold(0.0, f64::max);
    let farthest = team.chunks(GRAIN, feet.len(), most).into_iter().fold(0.0, f64::max);
    (hessians, velocity(farthest / unit).value)
}

impl OfWall {
    fn of(team: Team<'_>, feet: &Feet, asked: &Asked, logs: &[Sym3]) -> Self {
        let parts = team.chunks(GRAIN, feet.len(), |range| {
            let (mut vertices, mut least, mut greatest) = (0, f64::INFINITY, 0.0f64);
            for v in range.filter(|&v| feet.distance(v) == 0.0) {
                let foot = &feet.at(v)[0];
                let across = logs[v].exp().quadratic(foot.normal).powf(-0.5);
                (vertices, least, greatest) = (vertices + 1, across.min(least), across.max(greatest));
            }
            (vertices, [least, greatest])
        });
        let none = (0, [f64::INFINITY, 0.0]);
        let (vertices, heights) =
            parts.into_iter().fold(none, |(n, [a, b]), (m, [c, d])| (n + m, [f64::min(a, c), f64::max(b, d)]));
        let first_heights = (vertices > 0).then_some(heights);
        Self { wall: asked.wall.clone(), faces: asked.faces.len(), vertices, first_heights }
    }
}
