//! `adapt --vertices`: a number of vertices is met ([`crate::adapt::meeting`]).
use super::input::{Input, InputArguments};
use crate::adapt::Adapted;
use crate::adapt::meeting::{Met, meet};
use crate::cli::metric::common::Amount;
use crate::cli::note;
use crate::cli::table::Table;
use crate::tasks::Team;
use serde::Serialize;
use std::mem::replace;

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
    let first = adapt(input)?;
    let Amount { vertices: Some(wanted), .. } = arguments.amount else { return Ok(first) };
    let complexity = arguments.amount.complexity().unwrap_or_default();
    let mut before = None;
    let make = |next: f64, count: usize| {
        // Bounds of the sizes may leave no such metric.
        let Ok((source, how)) = arguments.source_of(team, input, next) else { return Ok(None) };
        note(format_args!("{count} vertices, not {wanted}: again, with a complexity of {next:.0}"));
        before = Some((replace(&mut input.source, source), replace(&mut input.on.how, how)));
        adapt(input).map(Some)
    };
    let count = |adapted: &Adapted| adapted.extracted.mesh.vertices.len();
    let Met { best, complexity, meshes, is_met, is_last } =
        meet(wanted, (first, complexity), count, make, is_interrupted)?;
    if let Some(before) = before.filter(|_| !is_last) {
        (input.source, input.on.how) = before;
    }
    input.on.meeting = Some(Meeting { wanted, complexity, meshes, is_met });
    Ok(best)
}
