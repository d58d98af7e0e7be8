//! Drafts of `adapt --wall`: meshes with thicker layers, by which a coarse mesh comes to thin ones along curved walls.
use super::Arguments;
use super::input::{Error, Input, InputArguments, OnModel, Placed};
use super::parts;
use super::progress::Progress;
use super::source::{How, Making, On, Raw};
use crate::adapt::{self, Adapted, GrowthEnd, Options};
use crate::cli::note;
use crate::cli::table::Table;
use crate::cli::waiting::Waiting;
use crate::geometry::classify::Classification;
use crate::mesh::TetMesh;
use crate::metric::{Source, Sym3};
use crate::sizing::chords::ChordLimit;
use crate::sizing::layer::{THICKER, thickness};
use crate::tasks::{GRAIN, Plan, Pool, Team, stage};
use serde::Serialize;
use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// A draft that was made.
#[derive(Clone, Copy, Serialize)]
pub struct Draft {
    /// How many times as thick as asked for its layers are at the walls.
    thicker: f64,
    /// Its vertices.
    vertices: usize,
    /// Time for it, s.
    seconds: f64,
}

/// The time for drafts.
pub(super) fn time(drafts: &[Draft]) -> Duration {
    Duration::from_secs_f64(drafts.iter().map(|draft| draft.seconds).sum())
}

/// What the table says of drafts.
pub(super) fn row(drafts: &[Draft], table: &mut Table) {
    if drafts.is_empty() {
        return;
    }
    let each =
        drafts.iter().map(|draft| format!("{} vertices with layers {} times as thick", draft.vertices, draft.thicker));
    let each = each.collect::<Vec<_>>().join(", ");
    table.row("drafts before", format_args!("{each} ({:.2} s)", time(drafts).as_secs_f64()));
}

/// What is said where a mesh would need drafts that are not made, and why not.
fn told(why: &str) -> String {
    format!(
        "the mesh is too coarse for layers as thin as those of --wall along curved walls, and {why}: adapt it first to thicker layers, such as ten times \
         those asked for, and then its result"
    )
}

impl InputArguments {
    /// The power of ten by which the layers along walls must be thicker so that the mesh follows its curved walls; 0 where they may be as they are.
    fn thickness(&self, team: Team<'_>, on: &OnModel) -> Result<u32, String> {
        if self.walls.is_empty() {
            return Ok(0);
        }
        let OnModel { mesh, place, model, names, .. } = on;
        let asked = On { place, model, names, beside: None }.places(mesh).walls(&self.walls)?;
        let outside = self.outside_layers(team, mesh, model)?;
        let found = thickness(team, (mesh, place, model), &asked, &outside);
        stage("walls held against the mesh");
        Ok(found)
    }

    /// What is said of a mesh that is adapted part by part, where drafts would be made of it as a whole.
    pub(super) fn without_drafts(&self, team: Team<'_>, on: &OnModel) -> Result<Option<String>, String> {
        let found = self.thickness(team, on)?;
        Ok((found > 0).then(|| told("part by part no drafts are made")))
    }

    /// The same with layers so many times as thick.
    fn thicker(&self, factor: f64) -> Self {
        let walls = self.walls.iter().map(|walls| walls.thicker(factor)).collect();
        Self { walls, ..self.clone() }
    }

    /// The metric that is given or made of fields, without walls and bounds, on the mesh that it comes with; none where it is one size.
    fn ground(&self, team: Team<'_>, placed: &mut Placed, notices: &mut Vec<String>) -> Result<Option<Source>, Error> {
        if self.field.size.is_some() {
            return Ok(None);
        }
        let raw = Self {
            walls: Vec::new(),
            local: Vec::new(),
            no_geometry: true,
            limit_chords: Some(ChordLimit::Off),
            multiscale: self.multiscale.unbounded(),
            ..self.clone()
        };
        let faces = placed.take_faces(team);
        let Placed { on: OnModel { mesh, place, model, names, .. }, raw: given, .. } = placed;
        let on = On { place, model, names, beside: None };
        let making = Making { mesh, raw: given, on, share: None, complexity: self.amount.complexity() };
        let (source, _) = raw.unscaled(team, making, faces, notices)?;
        stage("metric without walls");
        Ok(Some(source))
    }
}

/// ln M of a source at the vertices of a mesh.
fn logs_of(team: Team<'_>, source: &Source, mesh: &TetMesh) -> Vec<Sym3> {
    team.collect(GRAIN, mesh.vertices.len(), |range, found| {
        let mut hint = 0;
        found.extend(mesh.vertices[range].iter().map(|&p| source.log_at(p, &mut hint)));
    })
}

fn waiting() -> Waiting {
    Waiting::for_what("making the metric")
}

/// What is said before drafts with layers so many times as thick.
fn announced(factors: &[f64]) -> String {
    let all = factors.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
    let what = "the mesh is too coarse for layers as thin as those of --wall along curved walls";
    match factors {
        [_] => format!("{what}: a draft with layers {all} times as thick comes first"),
        _ => format!("{what}: {} drafts with layers {all} times as thick come first", factors.len()),
    }
}

/// Why no drafts can be made of a mesh.
fn hindrance(on: &OnModel) -> Option<&'static str> {
    if on.beside.is_some() {
        return Some("beside prisms, pyramids and hexahedra no drafts are made");
    }
    has_mixed_references(&on.mesh, &on.place)
        .then_some("no drafts are made where a face of the model has triangles of several references")
}

/// Whether a face of the model has triangles of several references: a mesh that is adapted has one on each.
fn has_mixed_references(mesh: &TetMesh, place: &Classification) -> bool {
    let mut of_face = HashMap::new();
    let each = mesh.triangles.refs.iter().zip(&place.faces);
    each.into_iter().any(|(reference, face)| of_face.entry(face).or_insert(reference) != &reference)
}

impl Arguments {
    /// What a cycle begins with. Where the mesh is too coarse for the layers along curved walls, drafts are made first, each with layers a tenth as thick
    /// as those of the last, and the metric anew on each. An interrupt ends them: then what came of the running one is the result.
    pub(super) fn input(
        &self,
        team: Team<'_>,
        (pool, plan): (&Pool, Plan),
        mut placed: Placed,
        stop: &'static AtomicBool,
        notices: &mut Vec<String>,
    ) -> Result<(Input, Option<Adapted>), Error> {
        let named = |error: String| -> Error { format!("{}: {error}", self.input.mesh.display()).into() };
        let powers = self.input.thickness(team, &placed.on).map_err(named)?;
        let why_not = if powers > 0 { hindrance(&placed.on) } else { None };
        notices.extend(why_not.map(told));
        if powers == 0 || why_not.is_some() {
            let _line = waiting();
            return Ok((self.input.ready(team, placed, notices)?, None));
        }
        let factors: Vec<f64> = (1..=powers as i32).rev().map(|power| THICKER.powi(power)).collect();
        note(announced(&factors));
        let ground = self.input.ground(team, &mut placed, notices)?;
        let freeze = parts::frozen(&self.freeze, &placed.on.mesh, &placed.on.names).map_err(named)?;
        let options = Options { is_draft: true, ..self.options(plan, freeze) };
        let (mut drafts, mut first) = (Vec::new(), None);
        for thicker in factors {
            let start = Instant::now();
            let line = waiting();
            // What keeps a metric from being made for thicker layers is told of those that are asked for.
            let Ok((source, how)) = self.input.thicker(thicker).metric(team, &mut placed, &mut Vec::new()) else {
                break;
            };
            drop(line);
            let progress = Progress::new(stop);
            let OnModel { mesh, place, model, .. } = &placed.on;
            let adapted = adapt::adapt(mesh, place, model, &source, &options, pool, &progress);
            progress.finish();
            let adapted = adapted.map_err(|error| named(error.to_string()))?;
            let first =
                first.get_or_insert_with(|| How { made: how.made.clone(), goal: how.goal.clone(), ..How::default() });
            if progress.interrupted() {
                let Placed { mut on, raw, .. } = placed;
                on.how = How { made: first.made.clone(), goal: first.goal.clone(), drafts, ..how };
                return Ok((Input { on, source, raw: Some(raw) }, Some(adapted)));
            }
            let extracted = adapted.extracted;
            if !extracted.off_model.is_empty() || (extracted.crossings.count > 0 && !placed.on.crosses) {
                break;
            }
            let (vertices, seconds) = (extracted.mesh.vertices.len(), start.elapsed().as_secs_f64());
            drafts.push(Draft { thicker, vertices, seconds });
            let logs = ground.as_ref().map(|ground| logs_of(team, ground, &extracted.mesh));
            placed.raw = Raw { logs, ..Raw::default() };
            (placed.on.mesh, placed.on.place) = (Arc::new(extracted.mesh), extracted.classification);
            placed.faces = None;
            stage("draft");
            if matches!(adapted.growth_end, Some(GrowthEnd::MaxVertices | GrowthEnd::Memory)) {
                break;
            }
        }
        let line = waiting();
        let mut input = self.input.ready(team, placed, notices)?;
        drop(line);
        if let Some(How { made, goal, .. }) = first.filter(|_| !drafts.is_empty()) {
            (input.on.how.made, input.on.how.goal) = (made, goal);
        }
        input.on.how.drafts = drafts;
        Ok((input, None))
    }
}
