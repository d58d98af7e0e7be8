//! Cells of a face or an edge, each in a ball: what the global search rules out by.
use crate::mesh::vector::{Vec3, add, distance, scale};

/// A piece of parameter space and the ball around its points.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    /// Middle of the ball.
    pub center: Vec3,
    /// Its radius.
    pub radius: f64,
    /// Bounds of u, and of v (zeros on an edge).
    pub bounds: [[f64; 2]; 2],
}

impl Cell {
    /// No point of the cell is closer than this.
    #[inline]
    pub fn least_distance(&self, point: Vec3) -> f64 {
        distance(self.center, point) - self.radius
    }

    /// The middle of the parameters.
    pub fn middle(&self) -> [f64; 2] {
        self.bounds.map(|[low, high]| 0.5 * (low + high))
    }
}

/// Samples in a cell and direction, ends included.
const SAMPLES: usize = 4;
/// The ball holds the samples; between them a smooth piece strays little, and this much is allowed for it.
const MARGIN: f64 = 1.25;

/// Bounds of the `k`th of `count` equal pieces.
fn piece(range: [f64; 2], count: usize, k: usize) -> [f64; 2] {
    let at = |k: usize| if k == count { range[1] } else { range[0] + (range[1] - range[0]) * k as f64 / count as f64 };
    [at(k), at(k + 1)]
}

/// Cuts a face into `counts` cells of u and v (v fastest), or an edge into `[n, 0]`.
pub fn cut(mut at: impl FnMut([f64; 2]) -> Vec3, range: [[f64; 2]; 2], counts: [usize; 2]) -> Vec<Cell> {
    let mut cells = Vec::with_capacity(counts[0] * counts[1].max(1));
    for i in 0..counts[0] {
        for j in 0..counts[1].max(1) {
            let v = if counts[1] == 0 { [0.0; 2] } else { piece(range[1], counts[1], j) };
            cells.push(cell(&mut at, [piece(range[0], counts[0], i), v], counts[1] == 0));
        }
    }
    cells
}

fn cell(at: &mut impl FnMut([f64; 2]) -> Vec3, bounds: [[f64; 2]; 2], is_curve: bool) -> Cell {
    let part = |k: usize, i: usize| {
        let s = i as f64 / (SAMPLES - 1) as f64;
        bounds[k][0] * (1.0 - s) + bounds[k][1] * s
    };
    let rows = if is_curve { 1 } else { SAMPLES };
    let mut points = [[0.0; 3]; SAMPLES * SAMPLES];
    for i in 0..SAMPLES {
        for j in 0..rows {
            points[i * rows + j] = at([part(0, i), part(1, j)]);
        }
    }
    let points = &points[..SAMPLES * rows];
    let sum = points.iter().fold([0.0; 3], |sum, &p| add(sum, p));
    let center = scale(sum, 1.0 / points.len() as f64);
    let radius = points.iter().map(|&p| distance(center, p)).fold(0.0, f64::max);
    Cell { center, radius: MARGIN * radius, bounds }
}
