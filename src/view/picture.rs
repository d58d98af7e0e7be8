//! A picture of a scene with its legend, as PNG.
use super::camera::Camera;
use super::colour::{self, Rgb};
use super::cut::{Part, Plane, Shown};
use super::image::Image;
use super::raster::{Drawing, Fill, Line, Triangle};
use super::scene::{Reference, Scene};
use super::sheet::{PAPER, Sheet};
use super::values::ScalarField;
use crate::mesh::adjacency::FACES;
use crate::mesh::io::{Batch, Error};
use crate::mesh::vector::{Vec3, area2, distance, dot, scale, unit};
use crate::tasks::{GRAIN, Team};
use std::path::Path;

const RIDGE: Rgb = [0.09, 0.11, 0.16];
const MODEL: Rgb = [0.85, 0.10, 0.45];

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

fn draw(team: Team<'_>, scene: &Scene<'_>, options: &Options) -> Image {
    let [width, height] = options.size.map(|x| x as usize);
    let unit = (width as f64 / 1200.0).min(height as f64 / 900.0).max(0.5);
    let shown = options.part.of(team, scene);
    let mut camera = Camera::from(options.view.unwrap_or_else(|| usual_view(options.part.plane)));
    let points = in_view(scene, options, &shown).into_iter().map(|v| scene.mesh.vertices[v as usize]);
    let room = [30.0, 76.0, width as f64 / unit - 256.0, height as f64 / unit - 150.0].map(|x| x * unit);
    camera.fit(points, room, options.zoom);
    if let Some(at) = options.at {
        camera.target = at;
    }
    let triangles = triangles(team, scene, options, &shown, &camera);
    let lines = lines(scene, options, &shown, &camera, unit);
    let map: &[Rgb] = if options.colour == Colour::Quality { &colour::QUALITY } else { &colour::FIELD };
    let drawing = Drawing { triangles: &triangles, lines: &lines, map, wire: options.wire };
    let image = drawing.image(team, [width, height], PAPER);
    let mut sheet = Sheet { image, unit, scene, options, alone: shown.faces.len() / 4 };
    if options.at.is_some() || options.zoom > 1.0 {
        sheet.frame(room);
    }
    sheet.title();
    sheet.axes(&camera);
    sheet.ruler(&camera);
    match options.colour {
        Colour::Reference => sheet.references(),
        Colour::Quality | Colour::Field(_) => sheet.map(map),
    }
    sheet.image
}

/// The vertices that must fit into the picture: all that is shown. Where surfaces are hidden, only those of the other surfaces count, since
/// the tetrahedra behind a cut reach as far as the hidden surfaces.
fn in_view(scene: &Scene<'_>, options: &Options, shown: &Shown) -> Vec<u32> {
    let surface = shown.triangles.iter().flat_map(|&t| scene.surface.triangles.nodes[t as usize]);
    let inside = shown.faces.iter().filter(|_| options.part.hidden.is_empty());
    let inside = inside.flat_map(|&side| scene.mesh.tets.nodes[side as usize / 4]);
    let found: Vec<u32> = surface.chain(inside).collect();
    if found.is_empty() { scene.surface.triangles.nodes.iter().flatten().copied().collect() } else { found }
}

/// The first of the views that sees the cut.
fn usual_view(plane: Option<Plane>) -> [f64; 2] {
    let sees = |view: &[f64; 2]| plane.is_none_or(|plane| dot(plane.normal, Camera::from(*view).toward) > 0.4);
    VIEWS.into_iter().find(sees).unwrap_or(VIEWS[0])
}

fn triangles(team: Team<'_>, scene: &Scene<'_>, options: &Options, shown: &Shown, camera: &Camera) -> Vec<Triangle> {
    let light = unit(std::array::from_fn(|i| 0.28 * camera.right[i] + 0.42 * camera.up[i] + camera.toward[i]));
    let triangle = |nodes: [u32; 3], fill: Fill| {
        let points = nodes.map(|v| scene.mesh.vertices[v as usize]);
        let normal = unit(area2(points[0], points[1], points[2]));
        // Both sides are bright.
        let normal = if dot(normal, camera.toward) < 0.0 { scale(normal, -1.0) } else { normal };
        let shade = (0.58 + 0.44 * dot(normal, light).max(0.0)).min(1.0) as f32;
        Triangle { corners: points.map(|p| camera.place(p)), shade, fill }
    };
    let flat = |q: f32| Fill::Flat(if q.is_nan() { colour::NOTHING } else { colour::between(&colour::QUALITY, q) });
    let values = |nodes: [u32; 3], field: usize| {
        let (field, range) = (&scene.given.fields[field], range_of(scene, options));
        Fill::Values(nodes.map(|v| ScalarField::place(field.values[v as usize], range, field.logarithmic)))
    };
    let of = |list: &[Reference], reference: i32| {
        list.get(list.partition_point(|one| one.reference < reference)).map_or(colour::NOTHING, |one| one.colour)
    };
    let surface = team.map(GRAIN, shown.triangles.len(), |i| {
        let t = shown.triangles[i];
        let nodes = scene.surface.triangles.nodes[t as usize];
        let fill = match options.colour {
            Colour::Reference => Fill::Flat(of(&scene.surfaces, scene.surface.triangles.refs[t as usize])),
            Colour::Quality => flat(scene.quality_of_triangle(t)),
            Colour::Field(field) => values(nodes, field),
        };
        triangle(nodes, fill)
    });
    let faces = team.map(GRAIN, shown.faces.len(), |i| {
        let (tet, face) = (shown.faces[i] as usize / 4, shown.faces[i] as usize % 4);
        let nodes = FACES[face].map(|k| scene.mesh.tets.nodes[tet][k]);
        let fill = match options.colour {
            Colour::Reference => Fill::Flat(of(&scene.regions, scene.mesh.tets.refs[tet])),
            Colour::Quality => flat(scene.quality.values[tet]),
            Colour::Field(field) => values(nodes, field),
        };
        triangle(nodes, fill)
    });
    team.join(vec![surface, faces])
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
    ridges.chain(model.map(|ends| line([ends[0], ends[1]], MODEL, 0.6))).collect()
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
