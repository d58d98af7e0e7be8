//! What stands around the scene in a picture: title, legend, axes and ruler.
use super::camera::Camera;
use super::colour::{self, Rgb};
use super::cut::Plane;
use super::font;
use super::image::Image;
use super::labels::Spot;
use super::picture::{Colour, Options, levels, range_of};
use super::scene::{Reference, Scene};
use super::values::ScalarField;
use std::collections::BTreeSet;

/// Background.
pub const PAPER: Rgb = [1.0; 3];
const INK: Rgb = [0.13, 0.15, 0.19];
const PALE: Rgb = [0.42, 0.45, 0.50];
const BAR: Rgb = [0.80, 0.82, 0.86];

/// The picture while what stands around the scene is drawn.
pub struct Sheet<'s> {
    /// The picture.
    pub image: Image,
    /// Pixels a unit of the layout.
    pub unit: f64,
    /// What is shown.
    pub scene: &'s Scene<'s>,
    /// How.
    pub options: &'s Options,
    /// Tetrahedra where only bad ones are shown.
    pub alone: usize,
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

    /// Clears everything outside of a rectangle, in pixels. An enlarged scene would else run through the legend.
    pub fn frame(&mut self, [left, top, width, height]: [f64; 4]) {
        let [right, bottom] = [left + width, top + height];
        let [whole, high] = [self.image.width as f64, self.image.height as f64];
        let around = [
            [0.0, 0.0, whole, top],
            [0.0, bottom, whole, high - bottom],
            [0.0, 0.0, left, high],
            [right, 0.0, whole - right, high],
        ];
        around.into_iter().for_each(|rectangle| self.image.rectangle(rectangle, PAPER));
        let corners = [[left, top], [right, top], [right, bottom], [left, bottom]].map(|p| p.map(|x| x / self.unit));
        (0..4).for_each(|i| self.stroke([corners[i], corners[(i + 1) % 4]], BAR));
    }

    /// The title, and what is shown of how many elements.
    pub fn title(&mut self) {
        let scene = self.scene;
        self.text(&scene.given.title, [30.0, 40.0], 13.0, INK);
        let [tets, triangles] = [scene.mesh.tets.len(), scene.surface.triangles.len()];
        let mut line = match &scene.given.model {
            Some(model) => model.counts.replace(", ", "   "),
            None => format!(
                "{} vertices   {} tetrahedra   {} triangles",
                grouped(scene.mesh.vertices.len()),
                grouped(tets),
                grouped(triangles)
            ),
        };
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
            let hidden = self.options.part.hidden.iter().map(|reference| {
                let label = scene.given.names.triangles.get(reference);
                label.and_then(|label| label.name.clone()).unwrap_or_else(|| reference.to_string())
            });
            let mut hidden: Vec<String> = hidden.collect();
            let mut known = BTreeSet::new();
            hidden.retain(|name| known.insert(name.clone()));
            line += &clipped(&format!("   without {}", hidden.join(", ")), 200.0);
        }
        if let (Some(velocity), 1..) = (&scene.given.velocity, self.options.streamlines) {
            line += &format!("   streamlines of {}", velocity.name);
        }
        if let Some(below) = self.options.part.below {
            line += &format!("   mean ratio below {}: {} tetrahedra", short(f64::from(below)), grouped(self.alone));
        }
        self.text(&line, [30.0, 62.0], 8.5, PALE);
    }

    /// A message under the title.
    pub fn say(&mut self, message: &str) {
        self.text(message, [38.0, 94.0], 8.5, [0.72, 0.16, 0.12]);
    }

    /// Numbers and names on surfaces, the roomiest first; what would lie on another label is left out.
    pub fn labels(&mut self, labels: &[(Spot, String)]) {
        const HEIGHT: f64 = 9.5;
        let mut taken: Vec<[f64; 4]> = Vec::new();
        for (spot, text) in labels {
            let text = clipped(text, 150.0);
            let wide = font::width(&text, HEIGHT);
            let [x, y] = spot.at.map(|x| x / self.unit);
            let [left, top] = [x - 0.5 * wide - 3.0, y - 0.5 * HEIGHT - 3.0];
            let place = [left, top, left + wide + 6.0, top + HEIGHT + 6.0];
            let apart = |other: &[f64; 4]| {
                place[2] < other[0] || other[2] < place[0] || place[3] < other[1] || other[3] < place[1]
            };
            if !taken.iter().all(apart) {
                continue;
            }
            taken.push(place);
            self.image.halo(&text, [left + 3.0, top + 3.0 + HEIGHT].map(|x| x * self.unit), HEIGHT * self.unit, PAPER);
            self.text(&text, [left + 3.0, top + 3.0 + HEIGHT], HEIGHT, INK);
        }
    }

    /// The directions of the axes.
    pub fn axes(&mut self, camera: &Camera) {
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
    pub fn ruler(&mut self, camera: &Camera) {
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

    /// The legend of references.
    pub fn references(&mut self) {
        let [width, height] = self.size();
        let (left, mut y) = (width - 190.0, 96.0);
        let scene = self.scene;
        let cut = self.options.part.plane.is_some() || self.options.part.below.is_some();
        let surfaces = if scene.given.model.is_some() { "faces" } else { "surfaces" };
        let lists = [(surfaces, &scene.surfaces, true), ("regions", &scene.regions, cut)];
        for (what, list, _) in lists.into_iter().filter(|(_, list, wanted)| *wanted && !list.is_empty()) {
            self.text(what, [left, y], 9.0, PALE);
            y += 22.0;
            let hidden = |one: &&Reference| what == surfaces && self.options.part.hidden.contains(&one.reference);
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

    /// The legend of a map of colours.
    pub fn map(&mut self, map: &[Rgb]) {
        let [width, height] = self.size();
        let (left, top, wide, high) = (width - 112.0, 150.0, 18.0, height - 290.0);
        let scene = self.scene;
        let range = range_of(scene, self.options);
        let (name, logarithmic) = match self.options.colour {
            Colour::Field(field) => (scene.given.fields[field].name.clone(), scene.given.fields[field].logarithmic),
            _ => (scene.quality.name.clone(), false),
        };
        for (line, part) in name.split(", ").enumerate() {
            self.text(&clipped(part, 190.0), [width - 206.0, 98.0 + 18.0 * line as f64], 9.0, INK);
        }
        let mut marks = Vec::new();
        let levels = levels(scene, self.options);
        if let [first, second, ..] = levels[..] {
            let step = if logarithmic {
                "isolines".into()
            } else {
                format!("isolines every {}", short(f64::from(second - first)))
            };
            self.text(&step, [width - 206.0, 116.0], 7.5, PALE);
        }
        for y in
            levels.iter().map(|&level| top + high * (1.0 - f64::from(ScalarField::place(level, range, logarithmic))))
        {
            marks.push([[left, y], [left + wide, y]]);
        }
        if self.options.colour == Colour::Quality {
            self.histogram([left - 8.0, top, 80.0, high]);
        }
        let rows = (high * self.unit) as usize;
        for row in 0..rows {
            let place = [left * self.unit, top * self.unit + row as f64, wide * self.unit, 1.0];
            self.image.rectangle(place, colour::between(map, 1.0 - (row as f32 + 0.5) / rows as f32));
        }
        marks.into_iter().for_each(|ends| self.stroke(ends, INK));
        for value in ticks(range, logarithmic) {
            let y = top + high * (1.0 - f64::from(ScalarField::place(value, range, logarithmic)));
            self.stroke([[left + wide, y], [left + wide + 5.0, y]], INK);
            self.text(&short(f64::from(value)), [left + wide + 10.0, y + 4.5], 9.0, INK);
        }
    }

    /// Bars to the left of the map, by the logarithm of the number, so that a few bad elements are seen.
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
        self.text("number, log scale", [right - longest, top + high + 20.0], 7.5, PALE);
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

/// Round numbers between the ends, as a legend has them.
fn ticks(range: [f32; 2], logarithmic: bool) -> Vec<f32> {
    between(range, logarithmic, 8)
}

/// Round numbers between the ends, about so many.
pub fn between([low, high]: [f32; 2], logarithmic: bool, count: usize) -> Vec<f32> {
    if low >= high {
        return vec![low];
    }
    if logarithmic && low > 0.0 && high / low >= 100.0 {
        // A power of ten in 32 bits may lie beside the power itself.
        let slack = 1e-6;
        let first = (f64::from(low).log10() - slack).ceil() as i32;
        let last = (f64::from(high).log10() + slack).floor() as i32;
        let step = ((last - first) / count as i32 + 1) as usize;
        return (first..=last).step_by(step).map(|power| 10.0f64.powi(power) as f32).collect();
    }
    let (low, high) = (f64::from(low), f64::from(high));
    let rough = (high - low) / count as f64;
    let ten = 10.0f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|x| x * ten).find(|&x| x >= rough).unwrap_or(rough);
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last).map(|i| (i as f64 * step) as f32).collect()
}

/// A number for a label: four figures, no zeros at its end.
pub fn short(x: f64) -> String {
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
}
