//! What was done: the table on the terminal and the JSON.
use super::chords;
use super::drafts::{self, Draft};
use super::input::OnModel;
use super::meet::Meeting;
use super::rounds::Parts;
use super::stack::Kept;
use crate::adapt::forecast::Forecast;
use crate::adapt::{Adapted, GrowthEnd, KINDS, Kind, Refusal, Work};
use crate::cli::metric::fields::Made;
use crate::cli::metric::goal;
use crate::cli::table::{Table, place};
use crate::formats::Format;
use crate::geometry::classify::Classification;
#[cfg(feature = "occt")]
use crate::geometry::classify::associate;
use crate::geometry::fidelity::{self, Fidelity};
use crate::geometry::{Model, Names};
use crate::mesh::TetMesh;
use crate::mesh::crossing::{Crossing, Crossings};
use crate::mesh::numbers::from_one;
use crate::mesh::stack::Stack;
use crate::metric::Sym3;
use crate::metric::statistics::Statistics;
use crate::sizing::chords::Limited;
use crate::tasks::Team;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Wall times, s.
#[derive(Default, Serialize)]
pub struct Seconds {
    /// Reading the inputs and putting the mesh on the model.
    pub read_and_classify: f64,
    /// Adaptation.
    pub adapt: f64,
    /// In the model's evaluators during the adaptation, of all threads together.
    pub geometry: f64,
    /// Everything, the writing of this report apart.
    pub total: f64,
}

/// One operation over the run.
#[derive(Serialize)]
struct Operation {
    attempts: u64,
    done: u64,
    refused: BTreeMap<String, u64>,
    sweeps: u32,
    seconds: f64,
}

/// What the user asked for, as the report has it.
#[derive(Clone, Serialize)]
pub struct Asked {
    /// The mesh, or the model that the mesh was made of.
    #[serde(serialize_with = "crate::cli::files::text::path")]
    pub input: PathBuf,
    /// Where the adapted mesh goes.
    #[serde(serialize_with = "crate::cli::files::text::path")]
    pub output: PathBuf,
    /// Threads.
    pub threads: usize,
    /// The complexity.
    pub complexity_wanted: Option<f64>,
}

/// Where the metric of an adapted mesh goes beside it; none where its own file holds it.
pub fn metric_path(mesh: &Path) -> Option<PathBuf> {
    let is_inside = Format::of(mesh).is_ok_and(Format::holds_fields);
    (!is_inside).then(|| mesh.with_extension("solb"))
}

/// Why a mesh stopped growing, and what helps.
fn why_growth_ended(end: GrowthEnd) -> &'static str {
    match end {
        GrowthEnd::NotAccountedFor => {
            "there are far more vertices than the metric's complexity accounts for: then no mesh meets it. On a curved wall it asks for cells much \
             flatter than the wall bends within an edge, or its sizes differ by orders of magnitude within a cell, or are many times the domain \
             in some directions; bound it by --limit-chords, --aspect-ratio, --hmax or --gradation, or with --field leave the geometry in (no --no-geometry)"
        }
        GrowthEnd::MaxVertices => {
            "it has as many vertices as it may have, and the metric is not met; ask for fewer (`adapt`: a smaller --complexity; `bootstrap`: fewer \
             --segments), or give a greater --max-vertices"
        }
        GrowthEnd::Memory => {
            "there is no memory for more vertices, and the metric is not met; ask for fewer (`adapt`: a smaller --complexity; `bootstrap`: fewer \
             --segments)"
        }
    }
}

/// Why bad tetrahedra were left untried.
const UNREPAIRED: &str = "more than a mesh has that meets its metric, and the last of them were not tried again; bound the metric by \
     --aspect-ratio or --gradation";

/// The report of a run.
#[derive(Serialize)]
pub struct Report {
    version: &'static str,
    #[serde(flatten)]
    asked: Asked,
    /// How the metric was made, with --field.
    #[serde(skip_serializing_if = "Option::is_none")]
    multiscale: Option<Made>,
    /// The same with --goal.
    #[serde(skip_serializing_if = "Option::is_none")]
    goal: Option<goal::Made>,
    /// What was cut along curved walls.
    #[serde(skip_serializing_if = "Option::is_none")]
    chords: Option<Limited>,
    /// The drafts that were made before, with --wall on a coarse mesh.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    drafts: Vec<Draft>,
    /// How a number of vertices was met, with --vertices.
    #[serde(skip_serializing_if = "Option::is_none")]
    vertices_wanted: Option<Meeting>,
    /// The rounds and the processes, part by part.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) parts: Option<Parts>,
    /// Prisms, pyramids and hexahedra, which stayed as they are; all other figures are of the tetrahedra beside them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) kept: Option<Kept>,
    input_vertices: usize,
    input_tets: usize,
    pub(super) statistics: Statistics,
    fidelity: Fidelity,
    /// Boundary vertices, from 0 and in JSON from 1, that found no room on the model: their tetrahedra would be inverted at its closest point.
    #[serde(serialize_with = "from_one")]
    pub(super) off_model: Vec<u32>,
    /// Whether it stopped growing before its metric was met, and why.
    overgrown: bool,
    growth_end: Option<GrowthEnd>,
    /// What the run was expected to take, before its passes began.
    forecast: Option<Forecast>,
    /// Tetrahedra of a mean ratio below 0.5 that were left untried in the end, since there were too many.
    unrepaired: usize,
    /// Surface triangles beyond --normal-deviation or --hausdorff.
    deviating: usize,
    /// Pairs of boundary triangles that cross, and the first of them.
    crossings: Crossings,
    /// Whether there were such in the input.
    #[serde(skip)]
    input_crosses: bool,
    operations: BTreeMap<&'static str, Operation>,
    /// Wall times.
    pub seconds: Seconds,
    /// The adapted mesh.
    #[serde(skip)]
    pub mesh: TetMesh,
    /// Its cells that are no tetrahedra.
    #[serde(skip)]
    pub stack: Stack,
    /// What its references are called.
    #[serde(skip)]
    pub names: Names,
    /// The metric at its vertices.
    #[serde(skip)]
    pub metrics: Vec<Sym3>,
    /// Where its boundary lies, and the vertices that had to stay, until it is measured.
    #[serde(skip)]
    boundary: Option<(Classification, Vec<u32>)>,
}

impl Report {
    /// Associates the adapted mesh with the model, or gives it back the features of the input's surface. It is not measured yet. What was forecast
    /// may be known.
    pub fn new(asked: &Asked, input: &OnModel, adapted: Adapted, forecast: Option<Forecast>) -> Self {
        let extracted = adapted.extracted;
        let (mut mesh, model) = (extracted.mesh, &input.model);
        // The stack's boundary keeps its references, and so does what continues it.
        #[cfg(feature = "occt")]
        let refs = input.beside.as_ref().map(|_| mesh.triangles.refs.clone());
        let names = match model {
            Model::Discrete(surface) => {
                surface.restore(&mut mesh, &extracted.classification);
                input.names.clone()
            }
            #[cfg(feature = "occt")]
            Model::Occt(_) if associate(&mut mesh, &extracted.classification).references_replaced => {
                // References that are the numbers of the faces now have the names of the model.
                Names { triangles: model.names().triangles.clone(), ..input.names.clone() }
            }
            #[cfg(feature = "occt")]
            Model::Occt(_) => input.names.clone(),
        };
        #[cfg(feature = "occt")]
        let names = match refs {
            Some(refs) if matches!(model, Model::Occt(_)) => {
                mesh.triangles.refs = refs;
                input.names.clone()
            }
            _ => names,
        };
        Self {
            version: env!("CARGO_PKG_VERSION"),
            asked: asked.clone(),
            multiscale: input.how.made.clone(),
            goal: input.how.goal.clone(),
            chords: input.how.chords,
            drafts: input.how.drafts.clone(),
            vertices_wanted: input.meeting,
            parts: None,
            kept: None,
            input_vertices: input.size[0],
            input_tets: input.size[1],
            statistics: Statistics::default(),
            fidelity: Fidelity::default(),
            off_model: extracted.off_model,
            overgrown: adapted.growth_end.is_some(),
            growth_end: adapted.growth_end,
            forecast,
            unrepaired: adapted.unrepaired,
            deviating: adapted.deviating,
            crossings: extracted.crossings,
            input_crosses: input.crosses,
            operations: operations(&adapted.work),
            seconds: Seconds { geometry: adapted.geometry.as_secs_f64(), ..Seconds::default() },
            mesh,
            stack: Stack::default(),
            names,
            metrics: extracted.metrics,
            boundary: Some((extracted.classification, extracted.held)),
        }
    }

    /// Measures the mesh against its metric and the model, once.
    pub fn measure(&mut self, team: Team<'_>, model: &Model) {
        if self.measure_boundary(team, model) {
            self.statistics = Statistics::in_metric(team, &self.mesh, &self.metrics);
        }
    }

    /// Measures the boundary against the model, once: whether it was not measured before.
    pub fn measure_boundary(&mut self, team: Team<'_>, model: &Model) -> bool {
        let Some((place, held)) = self.boundary.take() else { return false };
        self.fidelity = fidelity::measure_adapted(team, &self.mesh, model, &place, &held);
        true
    }

    /// Whether the mesh is not to be used: a vertex is off the model, or the boundary crosses itself and that of the input did not.
    pub fn is_refused(&self) -> bool {
        !self.off_model.is_empty() || (self.crosses() && !self.input_crosses)
    }

    /// Whether its boundary crosses itself.
    pub fn crosses(&self) -> bool {
        self.crossings.count > 0
    }

    /// Whether the mesh ended before its metric was met, since there was to be, or could be, no more of it.
    fn is_incomplete(&self) -> bool {
        matches!(self.growth_end, Some(GrowthEnd::MaxVertices | GrowthEnd::Memory))
    }

    /// Why it did.
    pub fn why_incomplete(&self) -> Option<&'static str> {
        self.growth_end.filter(|_| self.is_incomplete()).map(why_growth_ended)
    }

    /// The table for the terminal.
    pub fn text(&self) -> String {
        let mut table = Table::new();
        table.row("input", format_args!("{} vertices, {} tetrahedra", self.input_vertices, self.input_tets));
        if let Some(kept) = &self.kept {
            kept.row(&mut table);
        }
        if let Some(made) = &self.multiscale {
            made.rows(&mut table);
        }
        if let Some(made) = &self.goal {
            made.rows(&mut table);
        }
        if let Some(limited) = &self.chords {
            chords::row(limited, &mut table);
        }
        drafts::row(&self.drafts, &mut table);
        if let Some(meeting) = &self.vertices_wanted {
            meeting.row(&mut table);
        }
        if let Some(parts) = &self.parts {
            parts.rows(&mut table);
        }
        table.statistics(&self.statistics);
        table.fidelity(&self.fidelity);
        if let [first, ..] = self.off_model[..] {
            let (count, at) = (self.off_model.len(), place(self.mesh.vertices[first as usize]));
            let what = "their tetrahedra would be inverted there";
            table.row(
                "found no room on the model",
                format_args!("{count} vertices, {what}; the first: {} at {at}", first + 1),
            );
        }
        if self.deviating > 0 {
            table.row(
                "beyond the bounds",
                format_args!(
                    "{} surface triangles: no room to split them, or their vertices must stay",
                    self.deviating
                ),
            );
        }
        if let [Crossing { triangles: [a, b], at }, ..] = self.crossings.first[..] {
            let (count, at) = (self.crossings.count, place(at));
            table.row(
                "THE BOUNDARY CROSSES ITSELF",
                format_args!("{count} pairs of triangles; the first: {} and {} at {at}", a + 1, b + 1),
            );
        }
        let kept_apart: u64 = self.operations.values().filter_map(|operation| operation.refused.get("crossing")).sum();
        if kept_apart > 0 {
            table.row(
                "kept apart",
                format_args!(
                    "{kept_apart} changes of the boundary were refused, which would have brought it through itself across a narrow void: \
                     edges stay as short there as that needs"
                ),
            );
        }
        if let Some(end) = self.growth_end {
            table.row("stopped growing", why_growth_ended(end));
        }
        if self.unrepaired > 0 {
            table.row("left as they are", format_args!("{} bad tetrahedra: {UNREPAIRED}", self.unrepaired));
        }
        table.line("");
        table.line(&format!("{:<14}{:>12}{:>12}{:>9}{:>10}", "operation", "attempts", "done", "sweeps", "seconds"));
        for kind in Kind::ALL {
            let o = &self.operations[kind.name()];
            let line = format!("{:<14}{:>12}{:>12}{:>9}{:>10.2}", kind.name(), o.attempts, o.done, o.sweeps, o.seconds);
            table.line(&line);
        }
        let Seconds { read_and_classify, adapt, geometry, total } = self.seconds;
        table.row(
            "seconds",
            format_args!(
                "{total:.2} (reading {read_and_classify:.2}, adapting {adapt:.2}, of that {geometry:.2} thread seconds in the model), {} threads",
                self.asked.threads
            ),
        );
        let metric = metric_path(&self.asked.output).map_or(String::new(), |path| format!(", {}", path.display()));
        table.row("written", format_args!("{}{metric}", self.asked.output.display()));
        table.text().to_owned()
    }
}

fn operations(work: &[Work; KINDS]) -> BTreeMap<&'static str, Operation> {
    let named = |work: &Work| Operation {
        attempts: work.counts.attempts,
        done: work.counts.done,
        refused: Refusal::ALL
            .iter()
            .map(|&r| (format!("{r:?}").to_lowercase(), work.counts.refused[r as usize]))
            .filter(|&(_, count)| count > 0)
            .collect(),
        sweeps: work.sweeps,
        seconds: work.time.as_secs_f64(),
    };
    Kind::ALL.iter().map(|&kind| (kind.name(), named(&work[kind as usize]))).collect()
}
