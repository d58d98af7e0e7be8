//! The triangles of one face: first those of its border, then as fine as its surface wants, by halving edges and turning diagonals.
mod halve;
mod refine;
mod turn;

use super::outline::{Outline, Scale};
use super::plane::{Conflict, NONE, Plane, Point, Region};
use super::points::Points;
use crate::geometry::OcctEvaluator;
use crate::mesh::vector::{Vec3, add, area2, cross, distance, dot, norm, scale, sub};
use std::ops::{Deref, DerefMut};

/// Cosines between a triangle and its surface: what new ones must have, if the old ones had it; below what one looks away.
const UPRIGHT: f64 = 0.5;
const TURNED: f64 = 0.1;
/// Triangles of this share of their face may look where they will.
const SMALL: f64 = 2e-3;

/// The triangles of a face.
#[derive(Clone, Debug, Default)]
pub struct Patch {
    /// Places in the scaled plane.
    plane: Vec<Point>,
    scale: Scale,
    /// Coordinates.
    pub at: Vec<Vec3>,
    /// Unit normals Su × Sv; zero where there is none.
    normals: Vec<Vec3>,
    sizes: Vec<f64>,
    /// The diagonal of the border's box.
    reach: f64,
    /// The number among all points; [`NONE`] for those inside the face.
    pub points: Vec<u32>,
    /// Whether a corner is one of several of a pole.
    is_pole: Vec<bool>,
    /// The direction of that pole's line.
    pole_lines: Vec<Option<Point>>,
    /// The triangles, counter-clockwise in the plane of the parameters.
    region: Region,
    /// Whether chords of the border keep points away; else only those that would turn triangles over.
    pub is_strict: bool,
    /// Segments whose chords were in the way of a point.
    pub pressed: Vec<u32>,
}

/// A patch is its triangles, with places for their corners.
impl Deref for Patch {
    type Target = Region;

    fn deref(&self) -> &Region {
        &self.region
    }
}

impl DerefMut for Patch {
    fn deref_mut(&mut self) -> &mut Region {
        &mut self.region
    }
}

/// What is asked of the surface at a point.
struct Sample {
    at: Vec3,
    normal: Vec3,
    bend: f64,
}

/// Point, unit normal Su × Sv and greatest curvature of a face.
fn sample(on: &mut OcctEvaluator, face: u32, uv: Point) -> Sample {
    let jet = on.surface(face, uv);
    let across = cross(jet.du, jet.dv);
    let (area, sides) = (norm(across), norm(jet.du) * norm(jet.dv));
    let has_area = area > 1e-7 * sides && area > 0.0;
    if !has_area {
        return Sample { at: jet.point, normal: [0.0; 3], bend: 0.0 };
    }
    let normal = scale(across, 1.0 / area);
    let (e, f, g) = (dot(jet.du, jet.du), dot(jet.du, jet.dv), dot(jet.dv, jet.dv));
    let (l, m, n) = (dot(jet.duu, normal), dot(jet.duv, normal), dot(jet.dvv, normal));
    let square = area * area;
    let mean = 0.5 * (e * n - 2.0 * f * m + g * l) / square;
    let product = (l * n - m * m) / square;
    let bend = mean.abs() + (mean * mean - product).max(0.0).sqrt();
    Sample { at: jet.point, normal, bend: if bend.is_finite() { bend } else { 0.0 } }
}

impl Patch {
    /// The triangles of a border alone.
    ///
    /// # Errors
    /// What of the border is in conflict, by corners and segments of the outline.
    pub fn new(on: &mut OcctEvaluator, face: u32, outline: &Outline, points: &Points) -> Result<Self, Vec<Conflict>> {
        let mut plane = Plane::new(&outline.corners).map_err(|conflict| vec![conflict])?;
        let mut counts: Vec<bool> = outline.segments.iter().map(|segment| segment.counts).collect();
        let mut conflicts = Vec::new();
        for (i, segment) in outline.segments.iter().enumerate() {
            match plane.constrain(segment.ends, i as u32) {
                Ok(None) => {}
                Ok(Some(other)) => {
                    let of = &outline.segments[other as usize];
                    if of.edge == segment.edge && of.piece == segment.piece {
                        counts[other as usize] ^= segment.counts;
                    } else {
                        conflicts.push(Conflict::Cross(i as u32, other));
                    }
                }
                Err(Conflict::Lost) => return Err(vec![Conflict::Lost]),
                Err(conflict) => conflicts.push(conflict),
            }
        }
        if !conflicts.is_empty() {
            return Err(conflicts);
        }
        let region = plane.region(|segment| counts[segment as usize]);
        Ok(Self::of_region(on, face, outline, points, region))
    }

    fn of_region(on: &mut OcctEvaluator, face: u32, outline: &Outline, points: &Points, region: Region) -> Self {
        let mut patch = Self {
            plane: outline.corners.clone(),
            scale: outline.scale,
            at: outline.points.iter().map(|&p| points.at[p as usize]).collect(),
            sizes: vec![f64::INFINITY; outline.corners.len()],
            points: outline.points.clone(),
            region,
            ..Self::default()
        };
        patch.normals = (0..patch.plane.len()).map(|i| sample(on, face, patch.uv(i as u32)).normal).collect();
        patch.is_pole = vec![false; outline.corners.len()];
        patch.pole_lines = vec![None; outline.corners.len()];
        let extent = |k: usize| {
            let all = || patch.at.iter().map(|p| p[k]);
            all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
        };
        patch.reach = norm([0, 1, 2].map(extent));
        for segment in &outline.segments {
            let [a, b] = segment.ends.map(|c| c as usize);
            if segment.piece == NONE {
                (patch.is_pole[a], patch.is_pole[b]) = (true, true);
                let [p, q] = [a, b].map(|c| patch.plane[c]);
                let far = (q[0] - p[0]).hypot(q[1] - p[1]);
                let line = (far > 0.0).then(|| [(q[0] - p[0]) / far, (q[1] - p[1]) / far]);
                (patch.pole_lines[a], patch.pole_lines[b]) = (line, line);
            }
            let length = distance(patch.at[a], patch.at[b]);
            // Pieces of a pole have no length, and say nothing.
            if length > 0.0 {
                for c in [a, b] {
                    let size = &mut patch.sizes[c];
                    *size = if size.is_finite() { size.max(length) } else { length };
                }
            }
        }
        patch
    }

    /// Triangles that are known, of corners without parameters.
    pub fn of_triangles(at: Vec<Vec3>, points: Vec<u32>, triangles: Vec<[u32; 3]>) -> Self {
        let count = at.len();
        Self {
            plane: vec![[0.0; 2]; count],
            scale: Scale::default(),
            at,
            normals: vec![[0.0; 3]; count],
            sizes: vec![f64::INFINITY; count],
            reach: 0.0,
            points,
            is_pole: vec![false; count],
            pole_lines: vec![None; count],
            region: Region {
                beside: vec![[NONE; 3]; triangles.len()],
                fixed: vec![[NONE; 3]; triangles.len()],
                triangles,
            },
            is_strict: false,
            pressed: Vec::new(),
        }
    }

    /// Its plane is none of parameters.
    pub fn forget_plane(&mut self) {
        self.normals.iter_mut().for_each(|normal| *normal = [0.0; 3]);
    }

    /// Parameters of a corner.
    pub fn uv(&self, corner: u32) -> Point {
        self.scale.parameters(self.plane[corner as usize])
    }

    /// About how far a triangle is off its face, model units: where the normals at the ends of a chord of length L lean by θ from the plane
    /// across it, the arc above it is L θ/4 high.
    pub fn off(&self, corners: [u32; 3]) -> f64 {
        let height = |i: usize| {
            let [a, b] = [corners[i], corners[(i + 1) % 3]];
            let chord = sub(self.spot(b), self.spot(a));
            let lean = |c: u32| dot(self.normals[c as usize], chord).abs();
            0.25 * lean(a).max(lean(b))
        };
        (0..3).map(height).fold(0.0, f64::max)
    }

    fn spot(&self, corner: u32) -> Vec3 {
        self.at[corner as usize]
    }

    fn place(&self, triangle: u32, corner: u32) -> Option<usize> {
        self.triangles[triangle as usize].iter().position(|&c| c == corner)
    }

    /// Whether two corners are one point in space.
    fn is_one(&self, a: u32, b: u32) -> bool {
        self.points[a as usize] != NONE && self.points[a as usize] == self.points[b as usize]
    }

    /// Triangles that look away from the surface, each with the segments on its edges.
    pub fn turned_away(&self) -> Vec<(u32, [u32; 3])> {
        let mut found = Vec::new();
        for (t, corners) in self.triangles.iter().enumerate() {
            let [p, q, r] = corners.map(|c| self.spot(c));
            let is_flat = norm(area2(p, q, r)) <= 1e-12 * distance(p, q).max(distance(q, r)).powi(2);
            let is_small = distance(p, q).max(distance(q, r)) < SMALL * self.reach;
            if !is_flat && !is_small && look([p, q, r], corners.map(|c| self.normals[c as usize])) < TURNED {
                found.push((t as u32, self.fixed[t]));
            }
        }
        found
    }
}

/// The cosine between the normal of a triangle and the mean of those of its corners; 1 where there is none to compare.
fn look([p, q, r]: [Vec3; 3], normals: [Vec3; 3]) -> f64 {
    let n = area2(p, q, r);
    let mean = add(add(normals[0], normals[1]), normals[2]);
    let size = norm(n) * norm(mean);
    let is_flat = norm(n) <= 1e-12 * distance(p, q).max(distance(q, r)).powi(2);
    let is_positive = size > 0.0;
    if !is_positive {
        1.0
    } else if is_flat {
        0.0
    } else {
        dot(n, mean) / size
    }
}
