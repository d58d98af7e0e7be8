//! One HTML file with all that is needed to see a mesh: data, program and style. It loads nothing.
use super::colour::{self, Rgb};
use super::cut::Style;
use super::pack::{Entry, Kind, Packer};
use super::picture::{Colour, Options};
use super::scene::{NamesFile, OfModel, Reference, Scene};
use super::streamlines::{Point, streamlines};
use crate::mesh::io::{Batch, Error};
use crate::mesh::vector::{Vec3, sub};
use crate::tasks::{GRAIN, Team};
use serde::Serialize;
use std::collections::BTreeSet;
use std::path::Path;

const FRAME: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/page.css");

/// The program, in the order of what builds on what.
const PROGRAM: [&str; 12] = [
    include_str!("page/inflate.js"),
    include_str!("page/data.js"),
    include_str!("page/camera.js"),
    include_str!("page/section.js"),
    include_str!("page/model.js"),
    include_str!("page/paint.js"),
    include_str!("page/mouse.js"),
    include_str!("page/panel.js"),
    include_str!("page/labels.js"),
    include_str!("page/names.js"),
    include_str!("page/frame.js"),
    include_str!("page/main.js"),
];

/// What the program is told beside the arrays.
#[derive(Serialize)]
struct Head<'s> {
    title: &'s str,
    centre: Vec3,
    bounds: [Vec3; 2],
    arrays: &'s [Entry],
    surfaces: Vec<Listed<'s>>,
    regions: Vec<Listed<'s>>,
    fields: Vec<FieldHead<'s>>,
    quality: &'s str,
    histogram: &'s [usize],
    figures: &'s [[String; 2]],
    maps: Maps,
    start: Start<'s>,
    /// How many entities a model has; of a mesh the page counts itself.
    counts: Option<&'s str>,
    names: &'s NamesFile,
}

#[derive(Serialize)]
struct Listed<'s> {
    reference: i32,
    count: usize,
    name: Option<&'s str>,
    colour: String,
    /// What else there is to tell.
    about: Option<&'s str>,
}

#[derive(Serialize)]
struct FieldHead<'s> {
    name: &'s str,
    range: [f32; 2],
    logarithmic: bool,
}

/// What is seen first.
#[derive(Serialize)]
struct Start<'s> {
    view: Option<[f64; 2]>,
    at: Option<Vec3>,
    zoom: f64,
    plane: Option<(Vec3, f64)>,
    hidden: &'s BTreeSet<i32>,
    below: Option<f32>,
    /// Whether the cut goes along the plane.
    along: bool,
    isolines: u32,
    colour: String,
    range: Option<[f32; 2]>,
    wire: bool,
    numbers: bool,
}

#[derive(Serialize)]
struct Maps {
    quality: [Rgb; 6],
    field: [Rgb; 6],
    nothing: Rgb,
}

/// Writes the page: the surface, all tetrahedra, the qualities and the fields. Coordinates are 32 bits relative to the box's middle.
///
/// # Errors
/// [`Error::System`] when the file cannot be written.
pub fn write_page(team: Team<'_>, scene: &Scene<'_>, options: &Options, path: &Path) -> Result<(), Error> {
    let mut batch = Batch::new();
    add_page(&mut batch, team, scene, options, path)?;
    batch.commit()
}

/// Adds the page, as [`write_page`] writes it, to files that belong together.
///
/// # Errors
/// As there.
pub fn add_page(
    batch: &mut Batch,
    team: Team<'_>,
    scene: &Scene<'_>,
    options: &Options,
    path: &Path,
) -> Result<(), Error> {
    let packer = packed(team, scene, &streamlines(team, scene, options));
    let given = &scene.given;
    let head = Head {
        title: &given.title,
        centre: scene.centre(),
        bounds: scene.bounds,
        arrays: &packer.entries,
        surfaces: scene.surfaces.iter().map(|one| listed(one, given.model.as_ref())).collect(),
        regions: scene.regions.iter().map(|one| listed(one, None)).collect(),
        fields: given
            .fields
            .iter()
            .map(|field| FieldHead { name: &field.name, range: field.range, logarithmic: field.logarithmic })
            .collect(),
        quality: &scene.quality.name,
        histogram: &scene.quality.histogram,
        figures: &given.figures,
        maps: Maps { quality: colour::QUALITY, field: colour::FIELD, nothing: colour::NOTHING },
        start: start(options),
        counts: given.model.as_ref().map(|model| model.counts.as_str()),
        names: &given.names_file,
    };
    // A "<" in a string could end the element that it stands in.
    let head = serde_json::to_string(&head).unwrap_or_default().replace('<', "\\u003c");
    let blocks = packer.blocks();
    batch.add(path, |file| {
        let mut rest = FRAME;
        while let Some((before, after)) = rest.split_once("{{") {
            let (name, behind) = after.split_once("}}").unwrap_or((after, ""));
            file.write_all(before.as_bytes())?;
            match name {
                "title" => file.write_all(escaped(&given.title).as_bytes())?,
                "style" => file.write_all(STYLE.as_bytes())?,
                "head" => file.write_all(head.as_bytes())?,
                "program" => PROGRAM.iter().try_for_each(|part| file.write_all(part.as_bytes()))?,
                _ => {
                    for block in &blocks {
                        file.write_all(block.as_bytes())?;
                        file.write_all(b"\n")?;
                    }
                }
            }
            rest = behind;
        }
        file.write_all(rest.as_bytes())
    })
}

fn start(options: &Options) -> Start<'_> {
    let colour = match options.colour {
        Colour::Reference => "reference".into(),
        Colour::Quality => "quality".into(),
        Colour::Field(number) => format!("field {number}"),
    };
    let Options { view, at, zoom, part, range, wire, numbers, isolines, .. } = options;
    let plane = part.plane.map(|plane| (plane.normal, plane.offset));
    Start {
        view: *view,
        at: *at,
        zoom: *zoom,
        plane,
        hidden: &part.hidden,
        below: part.below,
        along: part.style == Style::Plane,
        isolines: *isolines,
        colour,
        range: *range,
        wire: *wire,
        numbers: *numbers,
    }
}

fn listed<'s>(one: &'s Reference, model: Option<&'s OfModel>) -> Listed<'s> {
    Listed {
        reference: one.reference,
        count: one.count,
        name: one.name.as_deref(),
        colour: colour::hexadecimal(one.colour),
        about: model.and_then(|model| model.about.get(&one.reference)).map(String::as_str),
    }
}

fn packed<'t>(team: Team<'t>, scene: &Scene<'_>, flow: &[Vec<Point>]) -> Packer<'t> {
    let (mesh, centre) = (scene.mesh, scene.centre());
    let near = |p: Vec3| sub(p, centre).map(|x| x as f32);
    let place = |list: &[Reference], reference: i32| list.partition_point(|one| one.reference < reference) as u32;
    let mut packer = Packer::new(team);
    packer.reals("points", &team.map(GRAIN, mesh.vertices.len(), |v| near(mesh.vertices[v])));
    packer.numbers("tets", &mesh.tets.nodes);
    packer.numbers("regions", &team.map(GRAIN, mesh.tets.len(), |t| [place(&scene.regions, mesh.tets.refs[t])]));
    packer.small("masks", Kind::U8, mesh.tets.len(), |t| u32::from(scene.surface.masks[t]));
    let qualities = &scene.quality.values;
    // 1 and above stand for shapes that are positive, however bad.
    packer.small("quality", Kind::U16, qualities.len(), |t| {
        let q = qualities[t].min(1.0);
        if q > 0.0 { ((65535.0 * q).round() as u32).max(1) } else { 0 }
    });
    let triangles = &scene.surface.triangles;
    packer.numbers("triangles", &triangles.nodes);
    packer.numbers("surfaces", &team.map(GRAIN, triangles.len(), |t| [place(&scene.surfaces, triangles.refs[t])]));
    packer.numbers("sides", &scene.surface.sides);
    packer.numbers("edges", &scene.ridges.nodes);
    for (number, field) in scene.given.fields.iter().enumerate() {
        packer.reals(&format!("field {number}"), field.values.as_chunks::<1>().0);
    }
    let chords = scene.given.model_edges.iter().flat_map(|polygon| polygon.windows(2));
    let chords: Vec<[f32; 6]> = chords
        .map(|ends| {
            let (a, b) = (near(ends[0]), near(ends[1]));
            [a[0], a[1], a[2], b[0], b[1], b[2]]
        })
        .collect();
    packer.reals("model edges", &chords);
    let flow = flow.iter().flat_map(|line| line.windows(2)).map(|ends| {
        let [a, b] = [0, 1].map(|i| near(ends[i].at));
        [a[0], a[1], a[2], b[0], b[1], b[2]]
    });
    packer.reals("streamlines", &flow.collect::<Vec<_>>());
    packer
}

/// Text within HTML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
