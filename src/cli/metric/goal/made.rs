//! The metric of a goal, and what was done for it; `adapt --goal` has it too.
use super::file::Asked;
use crate::cli::files::reading::Carrier;
use crate::cli::metric::common::Failure;
use crate::cli::table::{Table, figure};
use crate::mesh::TetMesh;
use crate::metric::Sym3;
use crate::metric::goal::{Boundary, Goal};
use crate::metric::multiscale::{Cut, Norm, Options, Summary};
use crate::metric::recovery::Recovery;
use crate::tasks::{Team, stage};
use serde::Serialize;
use std::path::PathBuf;

/// The metric that was made, for tables and JSON.
#[derive(Clone, Serialize)]
pub struct Made {
    #[serde(serialize_with = "crate::cli::files::text::path")]
    goal: PathBuf,
    terms: usize,
    hessian: Recovery,
    boundary: Boundary,
    norm: Norm,
    gradation: Option<f64>,
    complexity_wanted: f64,
    #[serde(flatten)]
    summary: Summary,
}

/// ln M at the vertices of the mesh, shape (n,), and what was done; `boundary` stands before that of the file. The last vertices are `copies`, on which the files have nothing.
pub fn make(
    team: Team<'_>,
    (mesh, copies): (&TetMesh, &[u32]),
    (asked, of): (&Asked, Carrier<'_>),
    (options, boundary): (&Options<'_>, Option<Boundary>),
    notices: &mut Vec<String>,
) -> Result<(Vec<Sym3>, Made), Failure> {
    let boundary = boundary.or(asked.boundary()).unwrap_or_default();
    let mut goal = Goal::new(team, mesh, options.recovery, boundary);
    asked.add_to(&mut goal, (team, of, copies), notices)?;
    stage("terms");
    let terms = goal.terms();
    let (logs, summary) = goal.metric(options).map_err(|error| format!("{}: {error}", asked.path.display()))?;
    let Options { recovery: hessian, norm, bounds } = *options;
    let (gradation, complexity_wanted) = (bounds.gradation, bounds.complexity);
    let goal = asked.path.clone();
    Ok((logs, Made { goal, terms, hessian, boundary, norm, gradation, complexity_wanted, summary }))
}

impl Made {
    /// What the bound of sizes by each other has cut.
    pub fn cut(&self) -> Option<Cut> {
        self.summary.cut
    }

    /// Rows of a table that tell what was done.
    pub fn rows(&self, table: &mut Table) {
        let Summary { complexity_before_gradation, complexity, limited, unfitted, rounds, .. } = self.summary;
        let plural = if self.terms == 1 { "term" } else { "terms" };
        table.row("goal", format_args!("{} ({} {plural})", self.goal.display(), self.terms));
        table.row("hessian", format_args!("{}, on the boundary {}", self.hessian.name(), self.boundary.name()));
        if unfitted > 0 {
            table.row("hessian of neighbours", format_args!("{unfitted} vertices: too few points around them"));
        }
        table.row("norm", format_args!("L^{}", self.norm));
        table.row("gradation", self.gradation.map_or_else(|| "off".into(), figure));
        table.row("limited", format_args!("{limited} vertices"));
        table.row("complexity wanted", figure(self.complexity_wanted));
        let before = figure(complexity_before_gradation);
        table.row(
            "complexity reached",
            format_args!("{} ({before} before gradation; {rounds} rounds)", figure(complexity)),
        );
    }
}
