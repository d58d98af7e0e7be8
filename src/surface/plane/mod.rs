//! Constrained Delaunay triangulation in the plane, with exact predicates: points, then segments between them, then what they bound.
mod constrain;
mod insert;
mod region;
#[cfg(test)]
mod tests;

pub use region::Region;
use robust::Coord;

/// A point of the plane.
pub type Point = [f64; 2];

/// No triangle, no segment.
pub const NONE: u32 = u32::MAX;

/// Coordinates are less than this: the predicates multiply four of them.
const MODERATE: f64 = 1e60;

/// Corners of the square around all points.
const FRAME: usize = 4;

/// Why the segments bound no region of the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Conflict {
    /// Two points are the same; their numbers.
    Equal(u32, u32),
    /// A point lies in a segment.
    Touch {
        /// The point.
        point: u32,
        /// The segment.
        segment: u32,
    },
    /// Two segments cross.
    Cross(u32, u32),
    /// A coordinate is no number, or the search came to no end.
    Lost,
}

/// A triangulation of a square around the points. Triangles are counter-clockwise.
#[derive(Clone, Debug)]
pub struct Plane {
    points: Vec<Point>,
    /// The whole square.
    region: Region,
    /// A triangle at each point; none at those that are not inserted yet.
    at: Vec<u32>,
}

/// Positive where c is on the left of the line from a to b: exact.
#[inline]
pub fn turn(a: Point, b: Point, c: Point) -> f64 {
    let at = |p: Point| Coord { x: p[0], y: p[1] };
    robust::orient2d(at(a), at(b), at(c))
}

/// Positive where d lies in the circle through a, b, c, which are counter-clockwise: exact.
#[inline]
pub fn in_circle(a: Point, b: Point, c: Point, d: Point) -> f64 {
    let at = |p: Point| Coord { x: p[0], y: p[1] };
    robust::incircle(at(a), at(b), at(c), at(d))
}

/// The numbers below `count`, each in the middle between two of those before it, and the lower of these (of 0 itself). Points in a row, as
/// those of a border are, flip few edges in that order.
fn bisecting(count: usize) -> impl Iterator<Item = (u32, u32)> {
    let bits = count.next_power_of_two().trailing_zeros();
    let reversed = move |i: usize| if bits == 0 { 0 } else { i.reverse_bits() >> (usize::BITS - bits) };
    (0..count.next_power_of_two())
        .map(reversed)
        .filter(move |&i| i < count)
        .map(|i| (i as u32, (i & i.wrapping_sub(1)) as u32))
}

impl Plane {
    /// The Delaunay triangulation of points, which keep their numbers.
    ///
    /// # Errors
    /// [`Conflict::Equal`] where two are the same, [`Conflict::Lost`] where one is not finite.
    pub fn new(points: &[Point]) -> Result<Self, Conflict> {
        let mut plane = Self::framing(points)?;
        for (number, before) in bisecting(points.len()) {
            let [vertex, near] = [number, before].map(|number| number + FRAME as u32);
            let from = plane.at[near as usize];
            plane.insert(vertex, if from == NONE { 0 } else { from })?;
        }
        Ok(plane)
    }

    /// A square far around the points, as two triangles.
    fn framing(points: &[Point]) -> Result<Self, Conflict> {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in points {
            for k in 0..2 {
                let is_moderate = point[k].abs() < MODERATE;
                if !is_moderate {
                    return Err(Conflict::Lost);
                }
                low[k] = low[k].min(point[k]);
                high[k] = high[k].max(point[k]);
            }
        }
        if points.is_empty() {
            (low, high) = ([0.0; 2], [1.0; 2]);
        }
        let side = (high[0] - low[0]).max(high[1] - low[1]);
        let reach = 8.0 * if side > 0.0 { side } else { 1.0 + low[0].abs() + low[1].abs() };
        let [x0, y0, x1, y1] = [low[0] - reach, low[1] - reach, high[0] + reach, high[1] + reach];
        let mut all = Vec::with_capacity(points.len() + FRAME);
        all.extend([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]);
        all.extend(points);
        let mut at = vec![NONE; all.len()];
        at[..FRAME].copy_from_slice(&[0, 0, 0, 1]);
        Ok(Self {
            points: all,
            region: Region {
                triangles: vec![[0, 1, 2], [0, 2, 3]],
                beside: vec![[NONE, 1, NONE], [NONE, NONE, 0]],
                fixed: vec![[NONE; 3]; 2],
            },
            at,
        })
    }

    fn point(&self, vertex: u32) -> Point {
        self.points[vertex as usize]
    }

    /// The place of a vertex in a triangle.
    fn place(&self, triangle: u32, vertex: u32) -> usize {
        self.region.triangles[triangle as usize].iter().position(|&v| v == vertex).unwrap_or(0)
    }

    /// Turns the edge opposite to corner i of a triangle into the other diagonal ([`Region::flip`]).
    fn flip(&mut self, t: u32, i: usize) {
        let (u, [a, b, c, d]) = self.region.flip(t, i);
        self.now_at([(a, t), (b, t), (d, t), (c, u)]);
    }

    /// Notes a triangle at each of some vertices.
    fn now_at<const N: usize>(&mut self, places: [(u32, u32); N]) {
        for (vertex, triangle) in places {
            self.at[vertex as usize] = triangle;
        }
    }

    /// The triangle with the directed edge from a to b, and the place of the corner opposite.
    fn edge(&self, a: u32, b: u32) -> Option<(u32, usize)> {
        let start = self.at[a as usize];
        let mut t = start;
        // Round a, against the clock, then the other way where that ends at the frame.
        for step in [1, 2] {
            loop {
                let i = self.place(t, a);
                if self.region.triangles[t as usize][(i + 1) % 3] == b {
                    return Some((t, (i + 2) % 3));
                }
                t = self.region.beside[t as usize][(i + step) % 3];
                if t == NONE || t == start {
                    break;
                }
            }
            if t == start {
                return None;
            }
            t = start;
        }
        None
    }
}
