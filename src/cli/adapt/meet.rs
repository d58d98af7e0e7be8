//! Meeting a number of vertices: the mesh is counted, and made again with another complexity where it has too many or too few.
use super::input::{Input, InputArguments};
use crate::adapt::Adapted;
use crate::cli::metric::common::Amount;
use crate::cli::note;
use crate::cli::table::Table;
use crate::tasks::Team;
use serde::Serialize;
use std::mem::replace;

/// A number of vertices is met if it is off by no more than this share.
const NEAR: f64 = 0.1;

/// Meshes made at most. The number of vertices is nearly proportional to the complexity: two meet it as a rule.
const TRIES: u32 = 4;

/// The complexity is changed by no more than this factor at a time.
const GREATEST_CHANGE: f64 = 10.0;

/// How a number of vertices was met.
#[derive(Clone, Copy, Serialize)]
pub struct Meeting {
    /// The number.
    pub wanted: f64,
    /// Of the metric of the last mesh.
    pub complexity: f64,
    /// Meshes that were made.
    pub meshes: u32,
    /// Whether the last mesh has so many, within 10 %.
    pub is_met: bool,
}

impl Meeting {
    /// What the table says of it.
    pub fn row(&self, table: &mut Table) {
        let Self { wanted, complexity, meshes, is_met } = self;
        let missed = if *is_met { "" } else { "; not met: bounds of the sizes, or what must stay, leave no such mesh" };
        let plural = if *meshes == 1 { "mesh" } else { "meshes" };
        let figures = format_args!("{wanted} ({meshes} {plural} made, the complexity is {complexity:.0}{missed})");
        table.row("vertices wanted", figures);
    }
}

/// What `adapt` makes of the input. With --vertices it is made again, from the same mesh, with the complexity by which so many are expected after
/// those that were counted, until they are met, or no more is gained, or the user has enough of it.
pub fn adapted<E>(
    arguments: &InputArguments,
    team: Team<'_>,
    input: &mut Input,
    adapt: impl Fn(&Input) -> Result<Adapted, E>,
    is_interrupted: impl Fn() -> bool,
) -> Result<Adapted, E> {
    let mut best = adapt(input)?;
    let Amount { vertices: Some(wanted), .. } = arguments.amount else { return Ok(best) };
    let count = |adapted: &Adapted| adapted.extracted.mesh.vertices.len() as f64;
    let off = |adapted: &Adapted| (count(adapted) / wanted).ln().abs();
    let is_near = |adapted: &Adapted| (count(adapted) / wanted - 1.0).abs() <= NEAR;
    let mut complexity = arguments.amount.complexity().unwrap_or_default();
    let mut meshes = 1;
    while meshes < TRIES && !is_near(&best) && !is_interrupted() {
        let next = complexity * (wanted / count(&best)).clamp(1.0 / GREATEST_CHANGE, GREATEST_CHANGE);
        // Bounds of the sizes may leave no such metric.
        let Ok((source, made)) = arguments.source_of(team, input, next) else { break };
        note(format_args!("{} vertices, not {wanted}: again, with a complexity of {next:.0}", count(&best)));
        let before = (replace(&mut input.source, source), replace(&mut input.made, made));
        let again = adapt(input)?;
        meshes += 1;
        if off(&again) >= off(&best) || is_interrupted() {
            (input.source, input.made) = before;
            break;
        }
        (best, complexity) = (again, next);
    }
    input.meeting = Some(Meeting { wanted, complexity, meshes, is_met: is_near(&best) });
    Ok(best)
}
