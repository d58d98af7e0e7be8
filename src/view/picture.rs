//! A picture of a scene with its legend, as PNG.
use super::camera::Camera;
use super::colour::{self, Rgb};
use super::cut::{Part, Plane, Shown};
use super::font;
use super::raster::{Drawing, Fill, Image, Line, Triangle};
use super::scene::{Reference, Scene};
use super::values::ScalarField;
use crate::mesh::adjacency::FACES;
use crate::mesh::io::{self, Error};
use crate::mesh::vector::{Vec3, area2, distance, dot, scale, unit};
use crate::tasks::{GRAIN, Team};
use std::path::Path;

const PAPER: Rgb = [1.0; 3];
const INK: Rgb = [0.13, 0.15, 0.19];
const PALE: Rgb = [0.42, 0.45, 0.50];
const RIDGE: Rgb = [0.09, 0.11, 0.16];
const MODEL: Rgb = [0.85, 0.10, 0.45];
const BAR: Rgb = [0.80, 0.82, 0.86];

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
    let image = draw(team, scene, options);
    io::write_beside(path, |file| {
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
    let room = [30.0, 76.0, width as f64 / unit - 240.0, height as f64 / unit - 150.0].map(|x| x * unit);
    camera.fit(points, room, options.zoom);
    if let Some(at) = options.at {
        camera.target = at;
    }
    let triangles = triangles(team, scene, options, &shown, &camera);
    let lines = lines(scene, options, &shown, &camera, unit);
    let map: &[Rgb] = if options.colour == Colour::Quality { &colour::QUALITY } else { &colour::FIELD };
    let drawing = Drawing { triangles: &triangles, lines: &lines, map, wire: options.wire };
    let image = drawing.image(team, [width, height], PAPER);
    let mut sheet = Sheet { image, unit, scene, options };
    sheet.title();
    sheet.axes(&camera);
    sheet.ruler(&camera);
    match options.colour {
        Colour::Reference => sheet.references(),
        Colour::Quality | Colour::Field(_) => sheet.map(map),
    }
    sheet.image
}

/// The vertices that are to fit in: those of all that is shown, but where surfaces are hidden, of the others alone, since the tetrahedra
/// behind a cut reach as far as the hidden ones did.
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
    // Edges of the model belong to no surface of the mesh: where some are hidden, those about the others are drawn.
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
fn range_of(scene: &Scene<'_>, options: &Options) -> [f32; 2] {
    match options.colour {
        Colour::Field(field) => options.range.unwrap_or(scene.given.fields[field].range),
        _ => [0.0, 1.0],
    }
}

/// The picture while what stands around the scene is drawn.
struct Sheet<'s> {
    image: Image,
    /// Pixels a unit of the layout.
    unit: f64,
    scene: &'s Scene<'s>,
    options: &'s Options,
}

impl Sheet<'_> {
    /// Width and height in units of the layout.
    fn size(&self) -> [f64; 2] {
        [self.image.width as f64 / self.unit, self.image.height as f64 / self.unit]
    }

    fn text(&mut self, text: &str, at: [f64; 2], height: f64, colour: Rgb) -> f64 {
        let at = at.map(|x| x * self.unit);
        self.image.text(text, at, height * self.unit, colour) / self.unit
    }

    fn stroke(&mut self, ends: [[f64; 2]; 2], colour: Rgb) {
        let ends = ends.map(|p| p.map(|x| x * self.unit));
        self.image.strokes(&[ends], 0.6 * self.unit.max(1.0), colour);
    }

    fn title(&mut self) {
        let scene = self.scene;
        self.text(&scene.given.title, [30.0, 40.0], 13.0, INK);
        let [tets, triangles] = [scene.mesh.tets.len(), scene.surface.triangles.len()];
        let mut line = format!(
            "{} vertices   {} tetrahedra   {} triangles",
            grouped(scene.mesh.vertices.len()),
            grouped(tets),
            grouped(triangles)
        );
        if let Some(Plane { normal: [x, y, z], offset }) = self.options.part.plane {
            let normal = match [x, y, z].map(|x| x.abs() == 1.0) {
                [true, ..] => format!("x = {}", short(offset * x)),
                [_, true, _] => format!("y = {}", short(offset * y)),
                [.., true] => format!("z = {}", short(offset * z)),
                _ => format!("({}, {}, {})·p = {}", short(x), short(y), short(z), short(offset)),
            };
            line += &format!("   cut at {normal}");
        }
        if !self.options.part.hidden.is_empty() {
            let hidden: Vec<String> = self.options.part.hidden.iter().map(i32::to_string).collect();
            line += &clipped(&format!("   without {}", hidden.join(", ")), 200.0);
        }
        if let Some(below) = self.options.part.below {
            line += &format!("   mean ratio below {}", short(f64::from(below)));
        }
        self.text(&line, [30.0, 62.0], 8.5, PALE);
    }

    fn axes(&mut self, camera: &Camera) {
        let [_, height] = self.size();
        let origin = [58.0, height - 46.0];
        // The farthest first.
        let mut axes = [0, 1, 2].map(|i| (i, [camera.right[i], camera.up[i], camera.toward[i]]));
        axes.sort_by(|a, b| a.1[2].total_cmp(&b.1[2]));
        for (axis, [right, up, _]) in axes {
            let colour = [[0.78, 0.20, 0.18], [0.16, 0.55, 0.24], [0.16, 0.36, 0.75]][axis];
            let end = [origin[0] + 26.0 * right, origin[1] - 26.0 * up];
            self.stroke([origin, end], colour);
            self.text(
                ["x", "y", "z"][axis],
                [origin[0] + 36.0 * right - 3.0, origin[1] - 36.0 * up + 3.5],
                9.0,
                colour,
            );
        }
    }

    /// A line of a round length.
    fn ruler(&mut self, camera: &Camera) {
        let [_, height] = self.size();
        let widest = 170.0 * self.unit / camera.scale;
        if !(widest > 0.0 && widest.is_finite()) {
            return;
        }
        let ten = 10.0f64.powf(widest.log10().floor());
        let length = [5.0, 2.0, 1.0].into_iter().map(|digit| digit * ten).find(|&x| x <= widest).unwrap_or(ten);
        let (left, y) = (130.0, height - 34.0);
        let right = left + length * camera.scale / self.unit;
        self.stroke([[left, y], [right, y]], INK);
        [left, right].iter().for_each(|&x| self.stroke([[x, y - 4.0], [x, y + 4.0]], INK));
        let label = short(length);
        self.text(&label, [0.5 * (left + right - font::width(&label, 9.0)), y - 9.0], 9.0, INK);
    }

    fn references(&mut self) {
        let [width, height] = self.size();
        let (left, mut y) = (width - 190.0, 96.0);
        let scene = self.scene;
        let cut = self.options.part.plane.is_some() || self.options.part.below.is_some();
        let lists = [("surfaces", &scene.surfaces, true), ("regions", &scene.regions, cut)];
        for (what, list, _) in lists.into_iter().filter(|(_, list, wanted)| *wanted && !list.is_empty()) {
            self.text(what, [left, y], 9.0, PALE);
            y += 22.0;
            let hidden = |one: &&Reference| what == "surfaces" && self.options.part.hidden.contains(&one.reference);
            let seen: Vec<&Reference> = list.iter().filter(|one| !hidden(one)).collect();
            for (number, one) in seen.iter().enumerate() {
                if y > height - 90.0 {
                    self.text(&format!("and {} more", seen.len() - number), [left, y], 9.0, PALE);
                    break;
                }
                let swatch = [left, y - 11.0, 16.0, 13.0].map(|x| x * self.unit);
                self.image.rectangle(swatch, one.colour);
                let name = one.name.as_ref().map_or(String::new(), |name| format!("  {name}"));
                self.text(&clipped(&format!("{}{name}", one.reference), 150.0), [left + 25.0, y], 9.5, INK);
                y += 21.0;
            }
            y += 14.0;
        }
    }

    fn map(&mut self, map: &[Rgb]) {
        let [width, height] = self.size();
        let (left, top, wide, high) = (width - 112.0, 150.0, 18.0, height - 290.0);
        let scene = self.scene;
        let range = range_of(scene, self.options);
        let (name, logarithmic) = match self.options.colour {
            Colour::Field(field) => (scene.given.fields[field].name.clone(), scene.given.fields[field].logarithmic),
            _ => (scene.quality.name.clone(), false),
        };
        for (line, part) in name.split(", ").enumerate() {
            self.text(&clipped(part, 205.0), [width - 212.0, 98.0 + 18.0 * line as f64], 9.0, INK);
        }
        if self.options.colour == Colour::Quality {
            self.histogram([left - 8.0, top, 80.0, high]);
        }
        let rows = (high * self.unit) as usize;
        for row in 0..rows {
            let place = [left * self.unit, top * self.unit + row as f64, wide * self.unit, 1.0];
            self.image.rectangle(place, colour::between(map, 1.0 - (row as f32 + 0.5) / rows as f32));
        }
        for value in ticks(range, logarithmic) {
            let y = top + high * (1.0 - f64::from(ScalarField::place(value, range, logarithmic)));
            self.stroke([[left + wide, y], [left + wide + 5.0, y]], INK);
            self.text(&short(f64::from(value)), [left + wide + 10.0, y + 4.5], 9.0, INK);
        }
    }

    /// Bars to the left of the map, by the logarithm of the number: that the bad ones are seen.
    fn histogram(&mut self, [right, top, longest, high]: [f64; 4]) {
        let histogram = &self.scene.quality.histogram;
        let length = |count: usize| (1.0 + count as f64).ln();
        let most = histogram.iter().copied().max().unwrap_or(0);
        let each = high / histogram.len() as f64;
        for (class, &count) in histogram.iter().enumerate().filter(|(_, count)| **count > 0) {
            let bar = longest * length(count) / length(most);
            let y = top + high - (class + 1) as f64 * each;
            let place = [right - bar, y + 0.08 * each, bar, 0.84 * each].map(|x| x * self.unit);
            self.image.rectangle(place, BAR);
        }
        self.text("number, log scale", [right - longest - 10.0, top + high + 20.0], 7.5, PALE);
    }
}

/// A text cut to a width, in units of the layout, at the usual height.
fn clipped(text: &str, width: f64) -> String {
    if font::width(text, 9.5) <= width {
        return text.into();
    }
    let mut kept = String::new();
    for letter in text.chars() {
        kept.push(letter);
        if font::width(&kept, 9.5) > width - 12.0 {
            break;
        }
    }
    kept + "..."
}

/// Round numbers between the ends.
fn ticks([low, high]: [f32; 2], logarithmic: bool) -> Vec<f32> {
    if !(low < high) {
        return vec![low];
    }
    if logarithmic && low > 0.0 && high / low >= 100.0 {
        let (first, last) = (f64::from(low).log10().ceil() as i32, f64::from(high).log10().floor() as i32);
        let step = ((last - first) / 8 + 1) as usize;
        return (first..=last).step_by(step).map(|power| 10.0f64.powi(power) as f32).collect();
    }
    let (low, high) = (f64::from(low), f64::from(high));
    let rough = (high - low) / 8.0;
    let ten = 10.0f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|x| x * ten).find(|&x| x >= rough).unwrap_or(rough);
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last).map(|i| (i as f64 * step) as f32).collect()
}

/// A number for a label: four figures, no zeros at its end.
fn short(x: f64) -> String {
    let magnitude = x.abs();
    if magnitude != 0.0 && !(1e-3..1e5).contains(&magnitude) {
        let text = format!("{x:.2e}");
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{power}", digits.trim_end_matches('0').trim_end_matches('.'));
    }
    let digits = if magnitude == 0.0 { 0 } else { (3 - magnitude.log10().floor() as i32).clamp(0, 6) };
    let text = format!("{x:.*}", digits as usize);
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".into() } else { text.into() }
}

/// A count with spaces between thousands.
fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_labels() {
        let texts = [0.0, 0.5, 1.0, 1234.0, 0.2 + 0.1, 1e-5, 2.5e7, -3.0].map(short);
        assert_eq!(texts, ["0", "0.5", "1", "1234", "0.3", "1e-5", "2.5e7", "-3"]);
        assert_eq!([1, 1000, 1234567].map(grouped), ["1", "1 000", "1 234 567"]);
        assert_eq!(ticks([0.0, 1.0], false).len(), 6);
        assert_eq!(ticks([1e-3, 2.0], true), [1e-3, 1e-2, 0.1, 1.0]);
        assert_eq!(ticks([2.0, 2.0], false), [2.0]);
    }

    #[test]
    fn the_usual_view_sees_the_cut() {
        for text in ["x=0", "-x=0", "y=0", "-y=0", "z=0", "-z=0", "1,1,1=0"] {
            let plane: Plane = text.parse().unwrap();
            let view = usual_view(Some(plane));
            assert!(dot(plane.normal, Camera::from(view).toward) > 0.4, "{text}: {view:?}");
        }
    }
}
