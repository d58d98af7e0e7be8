//! A rasteriser: triangles and lines with a depth buffer, nine samples a pixel. Bands of rows are drawn apart, on all threads.
use super::colour::{NOTHING, Rgb, between};
use super::image::Image;
use crate::tasks::Team;

/// Samples a pixel in each direction.
const SAMPLES: usize = 3;

/// Rows of a band.
const BAND: usize = 24;

/// Half the width of the lines between elements, pixels.
const HALF_WIRE: f64 = 0.42;

/// Triangles lower than the first (in pixels) get no lines around them, those higher than the second get full ones. Otherwise a fine mesh
/// would be black.
const WIRE_FADES: [f64; 2] = [2.0, 7.0];

/// How dark the lines between elements are.
const WIRE: f32 = 0.62;

/// What a triangle is filled with.
#[derive(Clone, Copy)]
pub enum Fill {
    /// One colour.
    Flat(Rgb),
    /// A value at each corner: a place on the map, from 0 to 1, or NaN.
    Values([f32; 3]),
}

/// A triangle in the picture.
#[derive(Clone, Copy)]
pub struct Triangle {
    /// Pixels from the left and the top, and how near, in pixels.
    pub corners: [[f64; 3]; 3],
    /// How bright it is, at most 1.
    pub shade: f32,
    /// Its colour.
    pub fill: Fill,
    /// A bit for each side, opposite to the corner of that number, that has a line where there are lines between elements.
    pub sides: u8,
}

/// A line in the picture, hidden by what is before it.
#[derive(Clone, Copy)]
pub struct Line {
    /// As the corners of triangles.
    pub ends: [[f64; 3]; 2],
    /// Half its width, pixels.
    pub half_width: f64,
    /// So much nearer it counts, pixels: lines lie on triangles.
    pub lift: f64,
    /// Its colour.
    pub colour: Rgb,
}

/// What is drawn.
pub struct Drawing<'d> {
    /// The triangles, in any order.
    pub triangles: &'d [Triangle],
    /// The lines, later ones over earlier ones.
    pub lines: &'d [Line],
    /// Colours of values.
    pub map: &'d [Rgb],
    /// Whether lines are drawn between the elements.
    pub wire: bool,
}

/// Samples of a band.
struct Band {
    width: usize,
    /// First and last row of samples, the last one not included.
    rows: [usize; 2],
    near: Vec<f64>,
    colours: Vec<Rgb>,
}

impl Drawing<'_> {
    /// Draws it on a background.
    pub fn image(&self, team: Team<'_>, [width, height]: [usize; 2], background: Rgb) -> Image {
        let bands = team.chunks(BAND, height, |rows| {
            let [first, last] = [rows.start * SAMPLES, rows.end * SAMPLES];
            let size = width * SAMPLES * (last - first);
            let (near, colours) = (vec![f64::NEG_INFINITY; size], vec![background; size]);
            let mut band = Band { width: width * SAMPLES, rows: [first, last], near, colours };
            self.triangles.iter().for_each(|triangle| band.triangle(triangle, self));
            self.lines.iter().for_each(|line| band.line(line));
            band.pixels(width)
        });
        Image { width, height, pixels: team.join(bands) }
    }
}

impl Band {
    /// Samples from `low` to `high` of a picture's row or column, within bounds.
    fn span(low: f64, high: f64, [first, last]: [usize; 2]) -> std::ops::Range<usize> {
        // The middle of sample i is at i + 1/2. Casts from floats saturate.
        let from = ((low - 0.5).ceil().max(0.0) as usize).max(first);
        let to = ((high - 0.5).floor() + 1.0).max(0.0) as usize;
        from..to.min(last).max(from)
    }

    fn triangle(&mut self, triangle: &Triangle, drawing: &Drawing<'_>) {
        let scaled = |p: [f64; 3]| p.map(|x| x * SAMPLES as f64);
        let corners = triangle.corners.map(scaled);
        let [low, high] =
            [f64::min, f64::max].map(|f| [0, 1].map(|i| corners.map(|p| p[i]).into_iter().reduce(f).unwrap_or(0.0)));
        let rows = Self::span(low[1], high[1], self.rows);
        if rows.is_empty() {
            return;
        }
        let [a, b, c] = corners;
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        // Barycentric coordinates are linear: w[i] = start[i] + x·along[i] + y·down[i].
        let side = |i: usize| (corners[(i + 1) % 3], corners[(i + 2) % 3]);
        let along: [f64; 3] = std::array::from_fn(|i| (side(i).0[1] - side(i).1[1]) / area);
        let down: [f64; 3] = std::array::from_fn(|i| (side(i).1[0] - side(i).0[0]) / area);
        let heights: [f64; 3] = std::array::from_fn(|i| 1.0 / along[i].hypot(down[i]));
        let lowest = heights.into_iter().fold(f64::INFINITY, f64::min) / SAMPLES as f64;
        let dark = if drawing.wire { WIRE * smooth(lowest, WIRE_FADES) } else { 0.0 };
        let reach = HALF_WIRE * SAMPLES as f64;
        let flat = match triangle.fill {
            Fill::Flat(colour) => Some(colour.map(|x| x * triangle.shade)),
            Fill::Values(_) => None,
        };
        for row in rows {
            let y = row as f64 + 0.5;
            // Where all three coordinates are positive.
            let (mut from, mut to) = (low[0], high[0]);
            let at_row: [f64; 3] = std::array::from_fn(|i| {
                let origin = side(i).0;
                let w = -origin[0] * along[i] + (y - origin[1]) * down[i];
                if along[i] > 0.0 {
                    from = from.max(-w / along[i]);
                } else if along[i] < 0.0 {
                    to = to.min(-w / along[i]);
                }
                w
            });
            let start = (row - self.rows[0]) * self.width;
            for column in Self::span(from, to, [0, self.width]) {
                let x = column as f64 + 0.5;
                let w: [f64; 3] = std::array::from_fn(|i| at_row[i] + x * along[i]);
                if w.iter().any(|&w| w < -1e-9) {
                    continue;
                }
                let near = w[0] * a[2] + w[1] * b[2] + w[2] * c[2];
                if near <= self.near[start + column] {
                    continue;
                }
                self.near[start + column] = near;
                let mut colour = flat.unwrap_or_else(|| triangle.mixed(w, drawing.map));
                if dark > 0.0 && (0..3).any(|i| triangle.sides >> i & 1 == 1 && w[i] * heights[i] < reach) {
                    colour = colour.map(|x| x * (1.0 - dark));
                }
                self.colours[start + column] = colour;
            }
        }
    }

    fn line(&mut self, line: &Line) {
        let [a, b] = line.ends.map(|p| p.map(|x| x * SAMPLES as f64));
        let (reach, lift) = (line.half_width * SAMPLES as f64, line.lift * SAMPLES as f64);
        let v = [b[0] - a[0], b[1] - a[1]];
        let square = v[0] * v[0] + v[1] * v[1];
        for row in Self::span(a[1].min(b[1]) - reach, a[1].max(b[1]) + reach, self.rows) {
            let y = row as f64 + 0.5;
            // The part of the line that is within reach of the row.
            let ends = [y - reach, y + reach].map(|y| if v[1] == 0.0 { f64::NAN } else { (y - a[1]) / v[1] });
            let (from, to) =
                if v[1] == 0.0 { (0.0, 1.0) } else { (ends[0].min(ends[1]).max(0.0), ends[0].max(ends[1]).min(1.0)) };
            let [left, right] = [from, to].map(|t| a[0] + t * v[0]);
            let start = (row - self.rows[0]) * self.width;
            for column in Self::span(left.min(right) - reach, left.max(right) + reach, [0, self.width]) {
                let to = [column as f64 + 0.5 - a[0], y - a[1]];
                let along = if square > 0.0 { ((to[0] * v[0] + to[1] * v[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
                let far = (to[0] - along * v[0]).hypot(to[1] - along * v[1]);
                let near = a[2] + along * (b[2] - a[2]) + lift;
                if far <= reach && near >= self.near[start + column] {
                    self.colours[start + column] = line.colour;
                }
            }
        }
    }

    /// Means of the samples.
    fn pixels(&self, width: usize) -> Vec<Rgb> {
        let rows = (self.rows[1] - self.rows[0]) / SAMPLES;
        let mut pixels = Vec::with_capacity(rows * width);
        for row in 0..rows {
            for column in 0..width {
                let mut sum = [0.0; 3];
                for sample in 0..SAMPLES * SAMPLES {
                    let at = (row * SAMPLES + sample / SAMPLES) * self.width + column * SAMPLES + sample % SAMPLES;
                    (0..3).for_each(|i| sum[i] += self.colours[at][i]);
                }
                pixels.push(sum.map(|x| x / (SAMPLES * SAMPLES) as f32));
            }
        }
        pixels
    }
}

impl Triangle {
    fn mixed(&self, w: [f64; 3], map: &[Rgb]) -> Rgb {
        let Fill::Values(values) = self.fill else { return NOTHING };
        let value: f32 = (0..3).map(|i| w[i] as f32 * values[i]).sum();
        let colour = if value.is_nan() { NOTHING } else { between(map, value) };
        colour.map(|x| x * self.shade)
    }
}

/// From 0 at the first to 1 at the second, without a kink.
fn smooth(x: f64, [from, to]: [f64; 2]) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    (t * t * (3.0 - 2.0 * t)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Rgb = [1.0, 0.0, 0.0];
    const BLUE: Rgb = [0.0, 0.0, 1.0];
    const WHITE: Rgb = [1.0; 3];

    fn square(depth: [f64; 4], colour: Rgb) -> [Triangle; 2] {
        let p = [[10.0, 10.0, depth[0]], [50.0, 10.0, depth[1]], [50.0, 50.0, depth[2]], [10.0, 50.0, depth[3]]];
        let triangle =
            |i: [usize; 3]| Triangle { corners: i.map(|i| p[i]), shade: 1.0, fill: Fill::Flat(colour), sides: 0b111 };
        [triangle([0, 1, 2]), triangle([2, 3, 0])]
    }

    fn drawn(triangles: &[Triangle], lines: &[Line]) -> Image {
        Drawing { triangles, lines, map: &[WHITE, RED], wire: false }.image(Team::alone(), [60, 60], WHITE)
    }

    #[test]
    fn the_nearer_hides_and_planes_meet_where_they_are_equally_near() {
        // One leans over the other: they cross at x = 30.
        let leaning = square([0.0, 40.0, 40.0, 0.0], RED);
        let level = square([20.0; 4], BLUE);
        for triangles in [[leaning, level].concat(), [level, leaning].concat()] {
            let image = drawn(&triangles, &[]);
            let at = |x: usize, y: usize| image.pixels[y * 60 + x];
            assert_eq!((at(20, 30), at(40, 30), at(5, 5)), (BLUE, RED, WHITE));
            // Whole within, no seam along the diagonal, and whole pixels at a border that lies between pixels.
            assert!((10..50).all(|i| at(i, i) != WHITE) && at(9, 30) == WHITE && at(50, 30) == WHITE);
        }
    }

    #[test]
    fn lines_are_hidden_by_what_is_before_them_only() {
        let line = |near: f64| Line {
            ends: [[0.0, 30.5, near], [60.0, 30.5, near]],
            half_width: 1.5,
            lift: 0.5,
            colour: BLUE,
        };
        let triangles = square([10.0; 4], RED);
        let at = |image: &Image, x: usize| image.pixels[30 * 60 + x];
        let (behind, on) = (drawn(&triangles, &[line(0.0)]), drawn(&triangles, &[line(10.0)]));
        assert_eq!((at(&behind, 30), at(&behind, 5)), (RED, BLUE));
        assert_eq!((at(&on, 30), at(&on, 5)), (BLUE, BLUE));
    }

    #[test]
    fn values_run_from_corner_to_corner() {
        let mut triangles = square([0.0; 4], RED);
        for (triangle, values) in triangles.iter_mut().zip([[0.0, 1.0, 1.0], [1.0, 0.0, 0.0]]) {
            triangle.fill = Fill::Values(values);
        }
        let image = drawn(&triangles, &[]);
        let green = |x: usize| image.pixels[30 * 60 + x][1];
        assert!(green(11) > 0.95 && (green(30) - 0.5).abs() < 0.02 && green(48) < 0.05);
        triangles.iter_mut().for_each(|triangle| triangle.fill = Fill::Values([f32::NAN; 3]));
        assert_eq!(drawn(&triangles, &[]).pixels[30 * 60 + 30], NOTHING);
    }
}
