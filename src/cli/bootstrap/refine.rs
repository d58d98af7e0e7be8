//! The mesher's mesh, adapted to the metric of the geometry.
use super::arguments::Arguments;
use super::domain;
use super::ladder::Meshed;
use super::rung::Rung;
use crate::adapt::{self, Adapted, Options};
use crate::cli::Outcome;
use crate::cli::adapt::files::Targets;
use crate::cli::adapt::input::Input;
use crate::cli::adapt::progress::{Progress, finish_on_interrupt};
use crate::cli::adapt::report::{Asked, Report};
use crate::cli::{interrupt, table};
use crate::geometry::classify::Classification;
use crate::geometry::fidelity::{self, Fidelity};
use crate::geometry::{Geometry, Model};
use crate::mesh::TetMesh;
use crate::mesh::adjacency::MatchedFaces;
use crate::mesh::vector::{Vec3, distance};
use crate::metric::multiscale::{Bounds, Measure, bounded};
use crate::metric::{Background, Limits, Source, Sym3, field, grade};
use crate::sizing;
use crate::tasks::{Plan, Pool, Team, stage};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The mesher's mesh is coarse: what the geometry asks for between its vertices shows on the mesh that comes of it.
const CYCLES: usize = 2;

/// Most cycles, where a mesh was too coarse for what is asked of it.
const MOST_CYCLES: usize = 6;

/// The mesher's mesh and what came of it.
pub struct Refined {
    by: Rung,
    notices: Vec<String>,
    start: Arc<TetMesh>,
    source: Source,
    adapted: Adapted,
    fidelity: Fidelity,
    interrupted: bool,
    /// When the last cycle began, and when it was done; s from the start of the program.
    times: [Duration; 2],
}

/// Adapts the mesher's mesh to the metric of the geometry.
pub fn run(
    arguments: &Arguments,
    pool: &Pool,
    meshed: Meshed,
    model: &Model,
    start: Instant,
) -> Result<Refined, String> {
    let team = Team::new(pool, Plan::default());
    let named = |error: String| format!("{}: {error}", arguments.model.display());
    let (prepared, stop) = (start.elapsed(), finish_on_interrupt());
    let Meshed { mesh: first, place, by, mut notices } = meshed;
    let first = Arc::new(first);
    let (mut mesh, mut place) = (Arc::clone(&first), place);
    for cycle in 1..=MOST_CYCLES {
        let (mut logs, notice) = sizes(arguments, team, &mesh, &place, model).map_err(named)?;
        let is_last = limit(&mesh, &mut logs) == 0 && cycle >= CYCLES || cycle == MOST_CYCLES;
        notices.extend(notice.filter(|_| is_last));
        let faces = MatchedFaces::of(team, &mesh.tets.nodes);
        let source = Source::Background(Background::on(team, Arc::clone(&mesh), faces, logs));
        stage("geometry");
        let progress = Progress::new(!arguments.quiet, stop);
        let adapted = adapt::adapt(&mesh, &place, model, &source, &Options::default(), pool, &progress)
            .map_err(|error| named(error.to_string()))?;
        progress.finish();
        let interrupted = progress.interrupted();
        if !is_last && !interrupted {
            (mesh, place) = (Arc::new(adapted.extracted.mesh), adapted.extracted.classification);
            continue;
        }
        let times = [prepared, start.elapsed()];
        let fidelity = fidelity::measure(team, &adapted.extracted.mesh, model, &adapted.extracted.classification);
        return Ok(Refined { by, notices, start: first, source, adapted, fidelity, interrupted, times });
    }
    unreachable!("the last cycle returns")
}

impl Refined {
    /// Vertices off the model, whether a triangle of the surface is turned over, and pairs of triangles that cross: 0, false and 0 for a
    /// good mesh.
    fn flaws(&self) -> (usize, bool, usize) {
        let folded = self.fidelity.worst_normal.is_some_and(|worst| worst.deviation > FOLDED);
        (self.adapted.extracted.off_model.len(), folded, self.adapted.extracted.crossings.count)
    }

    /// Why another mesh to begin with may be better.
    pub fn flaw(&self) -> Option<String> {
        let (off, folded, crossings) = self.flaws();
        let at = |at: Option<Vec3>| at.map_or(String::new(), |at| format!(" at {}", table::place(at)));
        if self.interrupted || off == 0 && !folded && crossings == 0 {
            None
        } else if off > 0 {
            let first = self.adapted.extracted.off_model[0] as usize;
            let at = at(self.adapted.extracted.mesh.vertices.get(first).copied());
            Some(format!("{off} vertices of its surface found no room on the model, the first{at}"))
        } else if folded {
            Some(format!("its surface is folded{}", at(self.fidelity.worst_normal.map(|worst| worst.at))))
        } else {
            let first = self.adapted.extracted.crossings.first.first().map(|crossing| crossing.at);
            Some(format!("{crossings} pairs of triangles of its surface cross, the first{}", at(first)))
        }
    }

    /// Whether there is less wrong with it.
    pub fn is_better_than(&self, other: &Self) -> bool {
        self.flaws() < other.flaws()
    }

    /// Writes it, and prints the table of `adapt`.
    pub fn write(
        self,
        arguments: &Arguments,
        team: Team<'_>,
        (asked, targets): (&Asked, &Targets),
        model: Model,
        start: Instant,
    ) -> Outcome {
        let flaw = self.flaw().map(|flaw| format!("{}: {flaw}; no mesh to begin with gave a better one", self.by));
        for notice in self.notices.iter().chain(&flaw).filter(|_| !arguments.quiet) {
            crate::cli::note(notice);
        }
        let names = model.names().clone();
        let place = self.adapted.extracted.classification.clone();
        let input = Input { mesh: self.start, place, model, source: self.source, made: None, names };
        let report = Report::new(team, asked, &input, self.adapted);
        let [prepared, finished] = self.times;
        let report = targets.write(report, [prepared, finished, start.elapsed()])?;
        if !arguments.quiet {
            crate::cli::print(&format!("{:<26} {}\n{}", "mesher", self.by, report.text()))?;
        }
        Ok(if self.interrupted { interrupt::exit_code() } else { ExitCode::SUCCESS })
    }
}

/// 1 − n·n_CAD of a triangle that is turned over.
const FOLDED: f64 = 1.0;

/// ln M at the vertices: what the geometry asks for, no more than the complexity allows; and a notice where that is less.
fn sizes(
    arguments: &Arguments,
    team: Team<'_>,
    mesh: &TetMesh,
    place: &Classification,
    model: &Model,
) -> Result<(Vec<Sym3>, Option<String>), String> {
    let options = arguments.sizes.options(model, arguments.limits(), None);
    let (mut raw, _) = sizing::geometry_metric(team, mesh, place, model, &options);
    if arguments.far_field.is_some() {
        resolve_body(mesh, place, model, &mut raw);
    }
    let mut logs = raw.clone();
    grade(team, mesh, &mut logs, GRADATION);
    let own = field::complexity_between(team, mesh, &logs);
    let most = arguments.complexity;
    if own <= most {
        return Ok((logs, None));
    }
    let (gradation, limits) = (Some(GRADATION), Limits::default());
    let bounds = Bounds { complexity: most, measure: Measure::Between, gradation, limits, fixed: None };
    let (logs, _) = bounded(team, mesh, &raw, &bounds).map_err(|error| format!("the geometry's metric: {error}"))?;
    let notice = format!(
        "the geometry asks for a complexity of {own:.0}: its sizes are enlarged to {most} (give a greater --complexity to keep them)"
    );
    Ok((logs, Some(notice)))
}

/// No size below an eighth of the longest edge at a vertex: sizes are interpolated between the vertices of this mesh, and one much smaller
/// than the edges would reach far along them. Returns how many were made larger.
fn limit(mesh: &TetMesh, logs: &mut [Sym3]) -> usize {
    let mut longest = vec![0.0f64; logs.len()];
    for nodes in mesh.tets.nodes.iter().map(|nodes| nodes.map(|v| v as usize)) {
        for (i, a) in nodes.into_iter().enumerate() {
            for &b in &nodes[i + 1..] {
                let length = distance(mesh.vertices[a], mesh.vertices[b]);
                longest[a] = longest[a].max(length);
                longest[b] = longest[b].max(length);
            }
        }
    }
    let mut limited = 0;
    for (log, longest) in logs.iter_mut().zip(longest) {
        let least = longest / STEP;
        // λ ≤ 1/least²
        if log.eigen().values[2] > -2.0 * least.ln() {
            *log = Limits { hmin: Some(least), ..Limits::default() }.apply_to_log(log);
            limited += 1;
        }
    }
    limited
}

/// How many times smaller than an edge a size may be at its end.
const STEP: f64 = 8.0;

/// In a far field the default of the greatest size is none for the body: there it is that of the body alone.
fn resolve_body(mesh: &TetMesh, place: &Classification, model: &Model, logs: &mut [Sym3]) {
    let (faces, diagonal) = domain::body(model);
    let mut is_body = vec![false; model.topology().faces.len()];
    faces.iter().for_each(|&face| is_body[face as usize] = true);
    let size = Sym3::ZERO.plus_identity(-2.0 * (BODY * diagonal).ln());
    let mut done = vec![false; logs.len()];
    for (nodes, _) in mesh.triangles.nodes.iter().zip(&place.faces).filter(|(_, face)| is_body[**face as usize]) {
        for v in nodes.map(|v| v as usize) {
            if !std::mem::replace(&mut done[v], true) {
                logs[v] = logs[v].intersect_logs(&size);
            }
        }
    }
}

/// Greatest size on the body, of its diagonal.
const BODY: f64 = 0.1;

/// Growth of the sizes from an edge to the next, as elsewhere.
const GRADATION: f64 = 1.5;
