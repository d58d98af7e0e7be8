//! A picture in memory, and what is drawn on it without depth: rectangles, lines, text.
use super::colour::Rgb;
use super::font::{self, Segment};

/// A picture: rows from the top, each from the left.
pub struct Image {
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The colours.
    pub pixels: Vec<Rgb>,
}

impl Image {
    /// Fills a rectangle: left, top, width and height in pixels; its borders may lie within pixels.
    pub fn rectangle(&mut self, [left, top, width, height]: [f64; 4], colour: Rgb) {
        let share =
            |i: usize, from: f64, to: f64| ((i as f64 + 1.0).min(to) - (i as f64).max(from)).clamp(0.0, 1.0) as f32;
        for y in top.max(0.0) as usize..((top + height).ceil().max(0.0) as usize).min(self.height) {
            for x in left.max(0.0) as usize..((left + width).ceil().max(0.0) as usize).min(self.width) {
                let cover = share(x, left, left + width) * share(y, top, top + height);
                self.blend(x, y, colour, cover);
            }
        }
    }

    /// Draws lines of one colour together, so that crossings are not darker.
    pub fn strokes(&mut self, segments: &[Segment], half_width: f64, colour: Rgb) {
        let ends = || segments.iter().flatten();
        let bound = |i: usize, f: fn(f64, f64) -> f64, none: f64| ends().map(|p| p[i]).fold(none, f);
        let far = half_width + 1.0;
        let clipped = |i: usize, size: usize| {
            let low = (bound(i, f64::min, f64::INFINITY) - far).max(0.0) as usize;
            low..((bound(i, f64::max, f64::NEG_INFINITY) + far).max(0.0) as usize + 1).min(size)
        };
        for y in clipped(1, self.height) {
            for x in clipped(0, self.width) {
                let p = [x as f64 + 0.5, y as f64 + 0.5];
                let least = segments.iter().map(|segment| distance(p, segment)).fold(f64::INFINITY, f64::min);
                self.blend(x, y, colour, (half_width + 0.5 - least).clamp(0.0, 1.0) as f32);
            }
        }
    }

    /// Writes a text that begins at x and stands on y, its capitals so high; returns where it ends.
    pub fn text(&mut self, text: &str, at: [f64; 2], height: f64, colour: Rgb) -> f64 {
        let mut x = at[0];
        let half_width = (0.075 * height).max(0.55);
        for letter in text.chars() {
            let (segments, next) = font::lay_out(letter.encode_utf8(&mut [0; 4]), [x, at[1]], height);
            self.strokes(&segments, half_width, colour);
            x = next;
        }
        x
    }

    /// What is under a text becomes of one colour, so that it can be read on any.
    pub fn halo(&mut self, text: &str, at: [f64; 2], height: f64, colour: Rgb) {
        let (segments, _) = font::lay_out(text, at, height);
        self.strokes(&segments, (0.075 * height).max(0.55) + (0.2 * height).max(1.5), colour);
    }

    fn blend(&mut self, x: usize, y: usize, colour: Rgb, cover: f32) {
        let pixel = &mut self.pixels[y * self.width + x];
        (0..3).for_each(|i| pixel[i] += cover * (colour[i] - pixel[i]));
    }
}

fn distance(p: [f64; 2], [a, b]: &Segment) -> f64 {
    let (v, to) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let square = v[0] * v[0] + v[1] * v[1];
    let t = if square > 0.0 { ((to[0] * v[0] + to[1] * v[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
    (to[0] - t * v[0]).hypot(to[1] - t * v[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_leaves_ink() {
        let mut image = Image { width: 60, height: 60, pixels: vec![[1.0; 3]; 3600] };
        let end = image.text("Ag", [5.0, 40.0], 20.0, [0.0; 3]);
        let ink = |columns: std::ops::Range<usize>| {
            columns
                .flat_map(|x| (0..60).map(move |y| (x, y)))
                .filter(|&(x, y)| image.pixels[y * 60 + x][0] < 0.5)
                .count()
        };
        assert!(ink(0..4) == 0 && ink(4..20) > 30 && ink(end as usize + 2..60) == 0);
    }
}
