//! A picture of a scene with its legend, as PNG.
use super::camera::Camera;
use super::colour::{self, Rgb};
use super::cut::{Part, Plane, Shown, Style};
use super::image::Image;
use super::labels::{Patch, Spot, spots};
use super::raster::{Drawing, Fill, Line, Triangle};
use super::scene::{Reference, Scene};
use super::section::{self, Corner, Of};
use super::sheet::{PAPER, Sheet, between, short};
use super::streamlines::{Point, streamlines};
use super::values::ScalarField;
use crate::mesh::adjacency::FACES;
use crate::mesh::io::{Batch, Error};
use crate::mesh::vector::{Vec3, area2, distance, dot, scale, unit};
use crate::tasks::{GRAIN, Team};
use std::path::Path;

const RIDGE: Rgb = [0.09, 0.11, 0.16];
const MODEL: Rgb = [0.85, 0.10, 0.45];
const FLOW: Rgb = [0.06, 0.07, 0.10];
const ISOLINE: Rgb = [0.10, 0.10, 0.14];

/// How much of the picture a body takes in a cut through what is around it.
const AROUND_BODY: f64 = 0.5;

/// Views to choose from (azimuth, elevation): the first is the usual one, others see cuts that it does not.
const VIEWS: [[f64; 2]; 6] = [[-55.0, 25.0], [35.0, 25.0], [125.0, 25.0], [215.0, 25.0], [-55.0, 50.0], [-55.0, -35.0]];

/// What elements are coloured by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colour {
    /// References of triangles and tetrahedra.
    Reference,
    /// Shapes.
    Quality,
    /// A field, by its number.
    Field(usize),
}

/// How a picture is made.
#[derive(Clone, Debug)]
pub struct Options {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Azimuth and elevation, degrees; without, one that sees the cut.
    pub view: Option<[f64; 2]>,
    /// The point in the middle; without, all that is shown lies around it.
    pub at: Option<Vec3>,
    /// So many times larger than what fits.
    pub zoom: f64,
    /// What is shown.
    pub part: Part,
    /// What it is coloured by.
    pub colour: Colour,
    /// Ends of the colour map of a field; without, its least and greatest value.
    pub range: Option<[f32; 2]>,
    /// Whether lines are drawn between elements.
    pub wire: bool,
    /// About how many lines of equal value a field has on a cut along the plane, else on the surface.
    pub isolines: u32,
    /// How many streamlines there are.
    pub streamlines: u32,
    /// Whether surfaces have their number and name on them.
    pub numbers: bool,
}

/// Draws a scene and writes it as PNG.
///
/// # Errors
/// [`Error::System`] when the file cannot be written.
pub fn write_picture(team: Team<'_>, scene: &Scene<'_>, options: &Options, path: &Path) -> Result<(), Error> {
    let mut batch = Batch::new();
    add_picture(&mut batch, team, scene, options, path)?;
    batch.commit()
}

/// Adds the picture, as [`write_picture`] writes it, to files that belong together.
///
/// # Errors
/// As there.
pub fn add_picture(
    batch: &mut Batch,
    team: Team<'_>,
    scene: &Scene<'_>,
    options: &Options,
    path: &Path,
) -> Result<(), Error> {
    let image = draw(team, scene, options);
    batch.add(path, |file| {
        let mut encoder = png::Encoder::new(file, image.width as u32, image.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let bytes: Vec<u8> = image.pixels.iter().flat_map(|&pixel| colour::bytes(pixel)).collect();
        encoder.write_header().and_then(|mut writer| writer.write_image_data(&bytes)).map_err(std::io::Error::other)
    })
}

/// What is to be said where a plane is given that cuts nothing.
pub fn nothing_cut(team: Team<'_>, scene: &Scene<'_>, options: &Options) -> Option<String> {
    let plane = options.part.plane?;
    let behind = team.chunks(GRAIN, scene.mesh.vertices.len(), |range| {
        range.filter(|&v| plane.is_behind(scene.mesh.vertices[v])).count()
    });
    let behind: usize = behind.into_iter().sum();
    let along = scene.bounds[0]
        .iter()
        .zip(scene.bounds[1])
        .zip(plane.normal)
        .fold([0.0; 2], |[low, high], ((&a, b), n)| [low + (n * a).min(n * b), high + (n * a).max(n * b)]);
    // An axis that is seen from the other side has its sign changed.
    let is_axis = plane.normal.iter().any(|x| x.abs() == 1.0);
    let ends = if is_axis && plane.normal.iter().any(|x| *x == -1.0) { [-along[1], -along[0]] } else { along };
    let (low, high) = (short(ends[0]), short(ends[1]));
    if behind == 0 {
        Some(format!(
            "the cut takes all away: nothing is behind the plane; give one between {low} and {high}, or the other side"
        ))
    } else if behind == scene.mesh.vertices.len() {
        Some(format!("the cut meets nothing: all is behind the plane; give one between {low} and {high}"))
    } else {
        None
    }
}

fn draw(team: Team<'_>, scene: &Scene<'_>, options: &Options) -> Image {
    let [width, height] = options.size.map(|x| x as usize);
    let unit = (width as f64 / 1200.0).min(height as f64 / 900.0).max(0.5);
    let shown = options.part.of(team, scene);
    let points = in_view(scene, options, &shown);
    // Of a flow about a small body more is to be seen than the body.
    let is_around = options.part.plane.is_some() || options.streamlines > 0;
    let is_small = extent(&points) < scene.radius();
    // What is inside may then reach beyond what fits.
    let is_partial = is_around && !options.part.hidden.is_empty();
    let is_flow = is_partial && is_small && options.at.is_none();
    let mut camera = Camera::from(options.view.unwrap_or_else(|| usual_view(options.part.plane)));
    let room = [30.0, 76.0, width as f64 / unit - 256.0, height as f64 / unit - 150.0].map(|x| x * unit);
    camera.fit(points.into_iter(), room, options.zoom * if is_flow { AROUND_BODY } else { 1.0 });
    if let Some(at) = options.at {
        camera.target = at;
    }
    let triangles = triangles(team, scene, options, &shown, &camera);
    let mut lines = lines(scene, options, &shown, &camera, unit);
    let flow = streamlines(team, scene, options);
    lines.extend(flow.iter().flat_map(|line| flow_lines(scene, options, line, &camera, unit)));
    let map: &[Rgb] = if options.colour == Colour::Quality { &colour::QUALITY } else { &colour::FIELD };
    let drawing = Drawing { triangles: &triangles, lines: &lines, map, wire: options.wire };
    let image = drawing.image(team, [width, height], PAPER);
    let mut sheet = Sheet { image, unit, scene, options, alone: shown.faces.len() / 4 };
    if options.at.is_some() || options.zoom > 1.0 || is_partial || options.streamlines > 0 {
        sheet.frame(room);
    }
    if options.numbers {
        sheet.labels(&labels(scene, &shown, &triangles, unit, [width, height]));
    }
    sheet.title();
    if let Some(message) = nothing_cut(team, scene, options) {
        sheet.say(&message);
    }
    sheet.axes(&camera);
    sheet.ruler(&camera);
    match options.colour {
        Colour::Reference => sheet.references(),
        Colour::Quality | Colour::Field(_) => sheet.map(map),
    }
    sheet.image
}

/// Where the numbers of the surfaces go, and what they are.
fn labels(
    scene: &Scene<'_>,
    shown: &Shown,
    triangles: &[Triangle],
    unit: f64,
    size: [usize; 2],
) -> Vec<(Spot, String)> {
    let reference = |t: u32| scene.surface.triangles.refs[t as usize];
    let first_piece = shown.triangles.len() + shown.faces.len();
    let owner = |i: usize| match (shown.triangles.get(i), i.checked_sub(first_piece).map(|k| shown.pieces[k].of)) {
        (Some(&t), _) | (_, Some(Of::Triangle(t))) => Some(reference(t)),
        _ => None,
    };
    let patches: Vec<Patch> =
        triangles.iter().enumerate().map(|(i, t)| Patch { corners: t.corners, owner: owner(i) }).collect();
    let text = |reference: i32| {
        let at = scene.surfaces.partition_point(|one| one.reference < reference);
        let name =
            scene.surfaces.get(at).and_then(|one| one.name.as_deref()).map_or(String::new(), |name| format!(" {name}"));
        format!("{reference}{name}")
    };
    spots(&patches, size, 2.0 * unit).into_iter().map(|spot| (spot, text(spot.owner))).collect()
}

/// The points that must fit into the picture: all that is shown. Where surfaces are hidden, only those of the other surfaces count, since
/// the tetrahedra behind a cut reach as far as the hidden surfaces.
fn in_view(scene: &Scene<'_>, options: &Options, shown: &Shown) -> Vec<Vec3> {
    let vertices = &scene.mesh.vertices;
    let is_all = options.part.hidden.is_empty();
    let surface = shown.triangles.iter().flat_map(|&t| scene.surface.triangles.nodes[t as usize]);
    let inside = shown.faces.iter().filter(|_| is_all);
    let inside = inside.flat_map(|&side| scene.mesh.tets.nodes[side as usize / 4]);
    let pieces = shown.pieces.iter().filter(|piece| is_all || matches!(piece.of, Of::Triangle(_)));
    let pieces = pieces.flat_map(|piece| piece.corners).map(|corner| corner.point(vertices));
    let found: Vec<Vec3> = surface.chain(inside).map(|v| vertices[v as usize]).chain(pieces).collect();
    if found.is_empty() {
        scene.surface.triangles.nodes.iter().flatten().map(|&v| vertices[v as usize]).collect()
    } else {
        found
    }
}

/// The diagonal of the box of points.
fn extent(points: &[Vec3]) -> f64 {
    let low = points.iter().copied().reduce(|a, b| std::array::from_fn(|i| a[i].min(b[i]))).unwrap_or_default();
    let high = points.iter().copied().reduce(|a, b| std::array::from_fn(|i| a[i].max(b[i]))).unwrap_or_default();
    distance(low, high)
}

/// The first of the views that sees the cut.
fn usual_view(plane: Option<Plane>) -> [f64; 2] {
    let sees = |view: &[f64; 2]| plane.is_none_or(|plane| dot(plane.normal, Camera::from(*view).toward) > 0.4);
    VIEWS.into_iter().find(sees).unwrap_or(VIEWS[0])
}

fn triangles(team: Team<'_>, scene: &Scene<'_>, options: &Options, shown: &Shown, camera: &Camera) -> Vec<Triangle> {
    let light = unit(std::array::from_fn(|i| 0.28 * camera.right[i] + 0.42 * camera.up[i] + camera.toward[i]));
    let drawn = |points: [Vec3; 3], fill: Fill, sides: u8| {
        let normal = unit(area2(points[0], points[1], points[2]));
        // Both sides are bright.
        let normal = if dot(normal, camera.toward) < 0.0 { scale(normal, -1.0) } else { normal };
        let shade = (0.58 + 0.44 * dot(normal, light).max(0.0)).min(1.0) as f32;
        Triangle { corners: points.map(|p| camera.place(p)), shade, fill, sides }
    };
    let triangle = |nodes: [u32; 3], fill: Fill| drawn(nodes.map(|v| scene.mesh.vertices[v as usize]), fill, 0b111);
    let flat = |q: f32| Fill::Flat(if q.is_nan() { colour::NOTHING } else { colour::between(&colour::QUALITY, q) });
    let values = |nodes: [u32; 3], field: usize| {
        let (field, range) = (&scene.given.fields[field], range_of(scene, options));
        Fill::Values(nodes.map(|v| ScalarField::place(field.values[v as usize], range, field.logarithmic)))
    };
    let of = |list: &[Reference], reference: i32| {
        list.get(list.partition_point(|one| one.reference < reference)).map_or(colour::NOTHING, |one| one.colour)
    };
    let of_triangle = |t: u32| match options.colour {
        Colour::Reference => Fill::Flat(of(&scene.surfaces, scene.surface.triangles.refs[t as usize])),
        _ => flat(scene.quality_of_triangle(t)),
    };
    let of_tet = |tet: usize| match options.colour {
        Colour::Reference => Fill::Flat(of(&scene.regions, scene.mesh.tets.refs[tet])),
        _ => flat(scene.quality.values[tet]),
    };
    let surface = team.map(GRAIN, shown.triangles.len(), |i| {
        let t = shown.triangles[i];
        let nodes = scene.surface.triangles.nodes[t as usize];
        triangle(nodes, if let Colour::Field(field) = options.colour { values(nodes, field) } else { of_triangle(t) })
    });
    let faces = team.map(GRAIN, shown.faces.len(), |i| {
        let (tet, face) = (shown.faces[i] as usize / 4, shown.faces[i] as usize % 4);
        let nodes = FACES[face].map(|k| scene.mesh.tets.nodes[tet][k]);
        triangle(nodes, if let Colour::Field(field) = options.colour { values(nodes, field) } else { of_tet(tet) })
    });
    let pieces = team.map(GRAIN, shown.pieces.len(), |i| {
        let piece = &shown.pieces[i];
        let points = piece.corners.map(|corner| corner.point(&scene.mesh.vertices));
        let (own, is_inside) = match piece.of {
            Of::Triangle(t) => (of_triangle(t), false),
            Of::Tet(tet) => (of_tet(tet as usize), true),
        };
        let Colour::Field(field) = options.colour else { return drawn(points, own, piece.sides) };
        let (field, range) = (&scene.given.fields[field], range_of(scene, options));
        let place = |corner: Corner| ScalarField::place(corner.value(&field.values), range, field.logarithmic);
        // A smooth map has no elements.
        drawn(points, Fill::Values(piece.corners.map(place)), if is_inside { 0 } else { piece.sides })
    });
    team.join(vec![surface, faces, pieces])
}

/// A streamline with an arrow in its middle: in the colours of the field, but on a cut in ink, where it would not be seen else.
fn flow_lines(scene: &Scene<'_>, options: &Options, points: &[Point], camera: &Camera, unit: f64) -> Vec<Line> {
    let is_section = options.part.plane.is_some() && options.part.style == Style::Plane;
    let colour = |point: &Point| match options.colour {
        Colour::Field(field) if !is_section => {
            let field = &scene.given.fields[field];
            let value = point.value(scene.mesh, &field.values);
            colour::between(&colour::FIELD, ScalarField::place(value, range_of(scene, options), field.logarithmic))
        }
        _ => FLOW,
    };
    let line = |ends: [[f64; 3]; 2], colour: Rgb| Line { ends, half_width: 0.8 * unit, lift: 1.6 * unit, colour };
    let mut found: Vec<Line> =
        points.windows(2).map(|ends| line([0, 1].map(|i| camera.place(ends[i].at)), colour(&ends[0]))).collect();
    let middle = points.len() / 2;
    if let Some(before) = middle.checked_sub(1) {
        let [from, tip] = [before, middle].map(|i| camera.place(points[i].at));
        let (x, y) = (tip[0] - from[0], tip[1] - from[1]);
        let length = x.hypot(y);
        if length > 0.0 {
            let (along, across) = (7.0 * unit / length, 3.5 * unit / length);
            for side in [1.0, -1.0] {
                let end = [tip[0] - along * x - side * across * y, tip[1] - along * y + side * across * x, tip[2]];
                found.push(line([tip, end], colour(&points[middle])));
            }
        }
    }
    found
}

/// Lines of equal values of the field on the cut along the plane; without such a cut, on the surface.
fn isolines(scene: &Scene<'_>, options: &Options, shown: &Shown) -> Vec<[Vec3; 2]> {
    let Colour::Field(field) = options.colour else { return Vec::new() };
    let values = &scene.given.fields[field].values;
    let levels = levels(scene, options);
    let mut found = Vec::new();
    let mut draw = |corners: [Corner; 3]| {
        let points = corners.map(|corner| corner.point(&scene.mesh.vertices));
        section::isolines(corners.map(|corner| corner.value(values)), &levels, |ends| {
            found.push(
                ends.map(|shares| std::array::from_fn(|k| (0..3).map(|i| f64::from(shares[i]) * points[i][k]).sum())),
            );
        });
    };
    let mut inside = shown.pieces.iter().filter(|piece| matches!(piece.of, Of::Tet(_))).peekable();
    if inside.peek().is_some() {
        inside.for_each(|piece| draw(piece.corners));
    } else {
        let surface = shown.triangles.iter().map(|&t| scene.surface.triangles.nodes[t as usize]);
        surface.for_each(|nodes| draw(nodes.map(|v| Corner { ends: [v, v], t: 0.0 })));
    }
    found
}

/// The values of the isolines: round numbers, about as many as are asked for.
pub(super) fn levels(scene: &Scene<'_>, options: &Options) -> Vec<f32> {
    match options.colour {
        Colour::Field(field) if options.isolines > 0 => {
            between(range_of(scene, options), scene.given.fields[field].logarithmic, options.isolines as usize)
        }
        _ => Vec::new(),
    }
}

fn lines(scene: &Scene<'_>, options: &Options, shown: &Shown, camera: &Camera, unit: f64) -> Vec<Line> {
    let line = |ends: [Vec3; 2], colour: Rgb, half_width: f64| Line {
        ends: ends.map(|p| camera.place(p)),
        half_width: half_width * unit,
        lift: 1.2 * unit,
        colour,
    };
    let ridges = shown
        .edges
        .iter()
        .map(|&e| line(scene.ridges.nodes[e as usize].map(|v| scene.mesh.vertices[v as usize]), RIDGE, 0.75));
    // Edges of the model belong to no surface of the mesh. Where surfaces are hidden, those near the others are drawn.
    let some_hidden = !options.part.hidden.is_empty();
    let [low, high] = if some_hidden { box_of_shown(scene, options) } else { scene.bounds };
    let margin = 0.01 * distance(low, high);
    let within = |p: Vec3| {
        options.part.plane.is_none_or(|plane| plane.is_behind(p))
            && (!some_hidden || (0..3).all(|i| p[i] > low[i] - margin && p[i] < high[i] + margin))
    };
    let model = scene.given.model_edges.iter().flat_map(|polygon| polygon.windows(2));
    let model = model.filter(|ends| ends.iter().all(|&p| within(p)));
    let clipped = shown.ends.iter().map(|ends| line(ends.map(|end| end.point(&scene.mesh.vertices)), RIDGE, 0.75));
    let isolines = isolines(scene, options, shown).into_iter().map(|ends| line(ends, ISOLINE, 0.45));
    isolines.chain(ridges).chain(clipped).chain(model.map(|ends| line([ends[0], ends[1]], MODEL, 0.6))).collect()
}

/// The box of the surfaces that are not hidden.
fn box_of_shown(scene: &Scene<'_>, options: &Options) -> [Vec3; 2] {
    let triangles = scene.surface.triangles.iter().filter(|(_, reference)| !options.part.hidden.contains(reference));
    let points = triangles.flat_map(|(nodes, _)| nodes.map(|v| scene.mesh.vertices[v as usize]));
    points.fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[low, high], p| {
        [std::array::from_fn(|i| low[i].min(p[i])), std::array::from_fn(|i| high[i].max(p[i]))]
    })
}

/// The ends of the colour map.
pub(super) fn range_of(scene: &Scene<'_>, options: &Options) -> [f32; 2] {
    match options.colour {
        Colour::Field(field) => options.range.unwrap_or(scene.given.fields[field].range),
        _ => [0.0, 1.0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_usual_view_sees_the_cut() {
        for text in ["x=0", "-x=0", "y=0", "-y=0", "z=0", "-z=0", "1,1,1=0"] {
            let plane: Plane = text.parse().unwrap();
            let view = usual_view(Some(plane));
            assert!(dot(plane.normal, Camera::from(view).toward) > 0.4, "{text}: {view:?}");
        }
    }
}
