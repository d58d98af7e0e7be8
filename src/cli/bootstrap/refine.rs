//! The mesher's mesh, adapted to the metric of the geometry.
use super::arguments::Arguments;
use super::domain;
use super::flaws::Flaws;
use super::ladder::Meshed;
use super::rung::Rung;
use crate::adapt::forecast::most_in_memory;
use crate::adapt::{self, Adapted, Options};
use crate::cli::Outcome;
use crate::cli::adapt::files::Targets;
use crate::cli::adapt::input::OnModel;
use crate::cli::adapt::progress::{Progress, finish_on_interrupt};
use crate::cli::adapt::report::{Asked, Report};
use crate::cli::waiting::Waiting;
use crate::cli::{INVALID, interrupt};
use crate::geometry::classify::Classification;
use crate::geometry::fidelity::{self, Fidelity};
use crate::geometry::{Geometry, Model, Names};
use crate::memory;
use crate::mesh::TetMesh;
use crate::mesh::adjacency::MatchedFaces;
use crate::metric::field::complexity_between;
use crate::metric::multiscale::{Bounds, Measure, bounded};
use crate::metric::{Background, Limits, Source, Sym3};
use crate::sizing::{self, Body};
use crate::tasks::{GRAIN, Plan, Pool, Team, stage};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Most cycles. There are two at least: of a large mesh all but the last make drafts.
const MOST_CYCLES: usize = 6;

/// A mesh is good enough when the complexity that the geometry asks for on it differs by less than this share. Where it will, it is not asked.
const SETTLED: f64 = 0.05;

/// Where smooth patches go through each other, a finer mesh finds a narrower gap, and the complexity grows by more than this share in a cycle.
const RUNAWAY: f64 = 1.0;

/// Edges of a draft are so many times as long as the geometry asks for. On an eighth of the vertices what it asks for is known nearly as well,
/// and the last cycle halves all edges. (With 1.5 it does so too, and they are too short then.)
const COARSER: f64 = 2.0;

/// Where the geometry asks for no more than this complexity there are no drafts: they would save less than a second, and a few hundred vertices do
/// not show what it asks for.
const SMALL: f64 = 8_000.0;

/// The mesher's mesh and what came of it.
pub struct Refined {
    by: Rung,
    notices: Vec<String>,
    start: Arc<TetMesh>,
    adapted: Adapted,
    fidelity: Fidelity,
    interrupted: bool,
    /// When the last cycle began, and when it was done; s from the start of the program.
    times: [Duration; 2],
}

/// Why there is no mesh.
pub enum Failed {
    /// The kernel made none; or, of smooth patches, one that other commands refuse.
    OnModel(String),
    /// Anything else, as a full disk; it names its file.
    Otherwise(String),
}

impl From<String> for Failed {
    fn from(why: String) -> Self {
        Self::Otherwise(why)
    }
}

impl Failed {
    /// Why, with the file of the model.
    pub fn of(self, model: &Path) -> String {
        match self {
            Self::OnModel(why) => format!("{}: {why}", model.display()),
            Self::Otherwise(why) => why,
        }
    }
}

/// Adapts the mesher's mesh to the metric of the geometry. Where the model is smooth patches through triangles (`is_smooth`), it ends as soon
/// as they are seen not to fit.
pub fn run(
    arguments: &Arguments,
    pool: &Pool,
    meshed: Meshed,
    (model, is_smooth): (&Model, bool),
    start: Instant,
) -> Result<Refined, Failed> {
    let team = Team::new(pool, Plan::default());
    let named = |error: String| format!("{}: {error}", arguments.model.display());
    let (prepared, stop) = (start.elapsed(), finish_on_interrupt());
    let Meshed { mesh: first, place, by, mut notices } = meshed;
    let first = Arc::new(first);
    let (mut mesh, mut place) = (Arc::clone(&first), place);
    let mut sizes = self::sizes(arguments, team, &mesh, &place, model).map_err(named)?;
    let (mut is_last, mut change) = (false, None);
    let max_vertices = arguments.max_vertices.map(|most| most as usize).or_else(most_in_memory);
    for cycle in 1.. {
        stage(&format!("geometry asks for {:.0}", sizes.complexity));
        let progress = Progress::new(stop);
        progress.expect_further(usize::from(!is_last));
        if is_last {
            // Before, what the geometry asks for is not known well, and a draft has fewer vertices.
            progress.tell_forecasts(max_vertices, &arguments.output);
        }
        let is_draft = !is_last && sizes.complexity > SMALL;
        let options = Options { max_vertices, is_draft, ..Options::default() };
        let source = sizes.source(team, if is_draft { COARSER } else { 1.0 });
        let adapted = adapt::adapt(&mesh, &place, model, &source, &options, pool, &progress)
            .map_err(|error| Failed::OnModel(error.to_string()))?;
        progress.finish();
        progress.has_room()?;
        let interrupted = progress.interrupted();
        // Nothing is gained where the mesh may have no more vertices.
        let is_full = adapted.growth_end.is_some();
        // On a small mesh the complexity may change again after the cycle that was to be the last.
        let asks_again = sizes.complexity <= SMALL && cycle < MOST_CYCLES && !is_full;
        if !interrupted && (!is_last || asks_again) {
            let result = (Arc::new(adapted.extracted.mesh.clone()), adapted.extracted.classification.clone());
            let next = self::sizes(arguments, team, &result.0, &result.1, model).map_err(named)?;
            let new = next.complexity / sizes.complexity - 1.0;
            if is_smooth && new > RUNAWAY {
                let flaws = Flaws::of(&adapted, &on_model(team, &adapted, model));
                if let Some(why) = flaws.worst().filter(|_| flaws.are_refused()) {
                    return Err(Failed::OnModel(why));
                }
            }
            let is_known = new.abs() < SETTLED;
            if !(is_last && is_known) {
                is_last = is_known || is_full || cycle + 1 >= MOST_CYCLES || next_change(change, new) < SETTLED;
                ((mesh, place), sizes, change) = (result, next, Some(new));
                continue;
            }
        }
        notices.extend(sizes.notice);
        let times = [prepared, start.elapsed()];
        let fidelity = on_model(team, &adapted, model);
        return Ok(Refined { by, notices, start: first, adapted, fidelity, interrupted, times });
    }
    unreachable!("the last cycle returns")
}

fn on_model(team: Team<'_>, adapted: &Adapted, model: &Model) -> Fidelity {
    fidelity::measure(team, &adapted.extracted.mesh, model, &adapted.extracted.classification)
}

/// By what share the complexity will change on the next mesh, where it changed by these on the last two: while it goes on in one direction,
/// changes shrink by about the same factor.
fn next_change(before: Option<f64>, last: f64) -> f64 {
    match before.map(|before| last / before) {
        Some(ratio) if (0.0..1.0).contains(&ratio) => last.abs() * ratio,
        _ => last.abs(),
    }
}

impl Refined {
    /// What is wrong with it.
    pub fn flaws(&self) -> Flaws {
        Flaws::of(&self.adapted, &self.fidelity)
    }

    /// Whether the user ended it: it is as far as it came.
    pub fn is_interrupted(&self) -> bool {
        self.interrupted
    }

    /// Writes it, and prints the table of `adapt`.
    pub fn write(
        self,
        arguments: &Arguments,
        team: Team<'_>,
        (asked, targets): (&Asked, &Targets),
        (model, names): (Model, Names),
        start: Instant,
    ) -> Outcome {
        let flaws = self.flaws();
        let flaw = flaws.worst().filter(|_| !self.interrupted).map(|flaw| match &model {
            // Of its triangles there is one.
            Model::Discrete(_) => flaw,
            #[cfg(feature = "occt")]
            Model::Occt(_) => format!("{}: {flaw}; no mesh to begin with gave a better one", self.by),
        });
        self.notices.iter().chain(&flaw).for_each(crate::cli::note);
        let place = self.adapted.extracted.classification.clone();
        let size = [self.start.vertices.len(), self.start.tets.len()];
        let on = OnModel {
            mesh: self.start,
            size,
            crosses: false,
            place,
            model,
            names,
            how: Default::default(),
            meeting: None,
            beside: None,
        };
        let report = Report::new(asked, &on, self.adapted, None);
        let (report, lost) = targets.write((team, &on.model), report, (start, self.times))?;
        lost.iter().for_each(crate::cli::note);
        arguments.figures.print(&report, || format!("{:<26} {}\n{}", "mesher", self.by, report.text()))?;
        Ok(if self.interrupted {
            interrupt::exit_code()
        } else if flaws.are_refused() {
            ExitCode::from(INVALID)
        } else if let Some(why) = report.why_incomplete() {
            crate::cli::note(format_args!("the mesh stopped growing: {why}"));
            ExitCode::from(memory::end::EXIT_CODE)
        } else {
            ExitCode::SUCCESS
        })
    }
}

/// What the geometry asks for.
struct Sizes {
    /// A mesh that resolves it.
    on: Arc<TetMesh>,
    /// ln M there, no more than the complexity allows.
    logs: Vec<Sym3>,
    /// Its own complexity.
    complexity: f64,
    /// What the user should know.
    notice: Option<String>,
}

impl Sizes {
    /// The metric with all sizes `coarser` by this factor.
    fn source(&self, team: Team<'_>, coarser: f64) -> Source {
        let less = Sym3::IDENTITY.times(-2.0 * coarser.ln());
        let logs = team.map(GRAIN, self.logs.len(), |v| self.logs[v].plus(less));
        let faces = MatchedFaces::of(team, &self.on.tets.nodes);
        let background = Background::on(team, Arc::clone(&self.on), faces, logs);
        Source::Background(background)
    }
}

/// What the geometry asks for on a mesh.
fn sizes(
    arguments: &Arguments,
    team: Team<'_>,
    mesh: &Arc<TetMesh>,
    place: &Classification,
    model: &Model,
) -> Result<Sizes, String> {
    let _line = Waiting::for_what("the geometry's sizes");
    let options = arguments.sizes.options(model, arguments.limits(), None);
    let body = arguments.far_field.is_some().then(|| body(model));
    let resolved = sizing::resolved_metric(team, mesh, place, model, (&options, body.as_ref()));
    let on = Arc::clone(resolved.halved.as_ref().map_or(mesh, |halved| &halved.mesh));
    let logs = resolved.graded;
    let complexity = complexity_between(team, &on, &logs);
    let most = arguments.complexity;
    if complexity <= most {
        return Ok(Sizes { on, logs, complexity, notice: None });
    }
    let (gradation, limits) = (Some(GRADATION), Limits::default());
    let bounds =
        Bounds { complexity: most, measure: Measure::Between, gradation, limits, fixed: None, by_others: None };
    let enlarged = bounded(team, &on, &resolved.logs, &bounds);
    let (logs, _) = enlarged.map_err(|error| format!("the geometry's metric: {error}"))?;
    let notice = format!(
        "the geometry asks for a complexity of {complexity:.0}: its sizes are enlarged to {most} (give a greater --complexity to keep \
         them)"
    );
    Ok(Sizes { on, logs, complexity, notice: Some(notice) })
}

/// In a far field the default of the greatest size is none for the body: there it is that of the body alone.
fn body(model: &Model) -> Body {
    let (of_body, diagonal) = domain::body(model);
    let mut faces = vec![false; model.topology().faces.len()];
    of_body.iter().for_each(|&face| faces[face as usize] = true);
    Body { faces, greatest: BODY * diagonal }
}

/// Greatest size on the body, of its diagonal.
const BODY: f64 = 0.1;

/// Growth of the sizes from an edge to the next, as elsewhere.
const GRADATION: f64 = 1.5;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_in_one_direction_go_on_to_shrink() {
        assert_eq!(next_change(None, 0.5), 0.5);
        assert!((next_change(Some(0.5), 0.1) - 0.02).abs() < 1e-15);
        assert!((next_change(Some(-0.5), -0.1) - 0.02).abs() < 1e-15);
        // What grows, or goes back, is not foretold.
        assert_eq!(next_change(Some(0.1), 0.2), 0.2);
        assert_eq!(next_change(Some(-0.5), 0.1), 0.1);
    }
}
