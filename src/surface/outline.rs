//! The border of a face in the plane of its parameters: corners and segments between them, with seams on two sides and poles as lines.
use super::plane::{NONE, Point};
use super::points::Points;
use crate::geometry::{EdgeUse, Evaluate, Geometry, OcctEvaluator, OcctModel, Use};
use crate::mesh::vector::{Vec3, dot, norm, sub, unit};

/// A piece of an edge on the border of a face.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// Its corners.
    pub ends: [u32; 2],
    /// The edge, and which of its pieces; of a degenerate edge no piece is to be divided.
    pub edge: u32,
    /// The piece.
    pub piece: u32,
    /// Whether the face is on one side of it alone.
    pub counts: bool,
    /// Whether the face is on the left from its second corner to its first.
    pub is_against: bool,
}

impl Segment {
    /// Its corners, the face on the left.
    pub fn along(&self) -> [u32; 2] {
        let [a, b] = self.ends;
        if self.is_against { [b, a] } else { [a, b] }
    }
}

/// How parameters become a plane in which lengths and angles are on the average those in space: x = a·u + s·v, y = b·v.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    a: f64,
    s: f64,
    b: f64,
}

impl Default for Scale {
    fn default() -> Self {
        Self { a: 1.0, s: 0.0, b: 1.0 }
    }
}

impl Scale {
    /// Cosines of the angle between the lines of u and v below which they count as upright, and above which as this.
    const SKEW: [f64; 2] = [0.3, 0.995];

    fn of_face(on: &mut OcctEvaluator, range: [[f64; 2]; 2], face: u32) -> Self {
        let (mut sums, mut skew) = ([0.0; 2], 0.0);
        let mut count = 0.0;
        for i in 0..5 {
            for j in 0..5 {
                let at = |k: usize, i: usize| range[k][0] + (range[k][1] - range[k][0]) * (0.1 + 0.2 * i as f64);
                let jet = on.surface(face, [at(0, i), at(1, j)]);
                let [u, v] = [norm(jet.du), norm(jet.dv)];
                if u.is_finite() && v.is_finite() {
                    sums = [sums[0] + u, sums[1] + v];
                    skew += dot(jet.du, jet.dv);
                    count += 1.0;
                }
            }
        }
        let [a, v] = sums.map(|sum| if sum > 0.0 { sum / count } else { 1.0 });
        let cosine = skew / (count * a * v);
        let [least, most] = Self::SKEW;
        let cosine = if cosine.abs() > least { cosine.clamp(-most, most) } else { 0.0 };
        Self { a, s: v * cosine, b: v * (1.0 - cosine * cosine).sqrt() }
    }

    /// The place of parameters in the plane.
    pub fn place(&self, [u, v]: Point) -> Point {
        [self.a * u + self.s * v, self.b * v]
    }

    /// The parameters of a place in the plane.
    pub fn parameters(&self, [x, y]: Point) -> Point {
        let v = y / self.b;
        [(x - self.s * v) / self.a, v]
    }
}

/// The border of a face.
#[derive(Clone, Debug, Default)]
pub struct Outline {
    /// How the plane is scaled.
    pub scale: Scale,
    /// Corners in the scaled plane.
    pub corners: Vec<Point>,
    /// The point of each corner among all points; several corners may have one.
    pub points: Vec<u32>,
    /// Segments.
    pub segments: Vec<Segment>,
}

/// One use of an edge: its corners from its start to its end by parameter.
struct Line {
    of: EdgeUse,
    corners: Vec<u32>,
    is_degenerate: bool,
}

/// An end of a line.
struct End {
    corner: u32,
    point: u32,
    wire: u32,
    /// Whether the wire comes here by its line, or leaves; none of what is inside.
    comes: Option<bool>,
    /// Length of the piece at it, in the scaled plane.
    reach: f64,
}

/// Ends of one vertex nearer than this share of the pieces at them are one corner.
const NEAR: f64 = 0.2;

/// The border of a face; none where an edge has no place on it.
pub fn outline(
    model: &OcctModel,
    on: &mut OcctEvaluator,
    points: &Points,
    face: u32,
    segments: f64,
) -> Option<Outline> {
    let topology = model.topology();
    let uses = model.edge_uses(face);
    let mut border =
        Outline { scale: Scale::of_face(on, topology.faces[face as usize].range, face), ..Outline::default() };
    let mut lines = Vec::new();
    for of in uses.into_iter().filter(|of| of.way != Use::External) {
        let entity = &topology.edges[of.edge as usize];
        let (t, ids) = if entity.degenerate {
            let vertex = entity.vertices.into_iter().flatten().next()?;
            let t = turns(model, on, face, of, segments)?;
            let ids = vec![points.of_vertex(vertex); t.len()];
            (t, ids)
        } else {
            (points.parameters(of.edge).to_vec(), points.chain(of.edge))
        };
        if t.len() < 2 {
            // An edge without length.
            continue;
        }
        let uv = parameters(model, on, face, of, &t)?;
        let first = border.corners.len() as u32;
        let scale = border.scale;
        border.corners.extend(uv.into_iter().map(|uv| scale.place(uv)));
        border.points.extend(ids);
        lines.push(Line {
            of,
            corners: (first..border.corners.len() as u32).collect(),
            is_degenerate: entity.degenerate,
        });
    }
    for vertex in model.loose_vertices(face) {
        let at = on.closest_on_face(face, topology.vertices.get(vertex as usize)?.point, None);
        border.corners.push(border.scale.place(at.uv));
        border.points.push(points.of_vertex(vertex));
    }
    join(&mut border, &lines);
    Some(border)
}

/// Parameters on the face of points of an edge.
fn parameters(model: &OcctModel, on: &mut OcctEvaluator, face: u32, of: EdgeUse, t: &[f64]) -> Option<Vec<Point>> {
    if let Some(uv) = model.edge_parameters(of.edge, face, of.way == Use::Reversed, t) {
        return Some(uv);
    }
    // No curve there: feet of perpendiculars, each from the one before.
    let mut found: Vec<Point> = Vec::with_capacity(t.len());
    for &t in t {
        let point = on.edge_frame(of.edge, t).point;
        let at = match found.last() {
            Some(&uv) => on.closest_on_surface(face, point, uv),
            None => on.closest_on_face(face, point, None),
        };
        if !at.uv.iter().all(|x| x.is_finite()) {
            return None;
        }
        found.push(at.uv);
    }
    Some(found)
}

/// Parameters that divide a degenerate edge by how far the face turns about the pole along it.
fn turns(model: &OcctModel, on: &mut OcctEvaluator, face: u32, of: EdgeUse, segments: f64) -> Option<Vec<f64>> {
    const PLACES: usize = 8;
    let topology = model.topology();
    let [from, to] = topology.edges[of.edge as usize].range;
    let t: Vec<f64> = (0..=PLACES).map(|i| from + (to - from) * i as f64 / PLACES as f64).collect();
    let uv = model.edge_parameters(of.edge, face, of.way == Use::Reversed, &t)?;
    let range = topology.faces[face as usize].range;
    // A step into the face: across the line of the pole.
    let along = (0..2).max_by(|&i, &j| {
        let share = |k: usize| (uv[PLACES][k] - uv[0][k]).abs() / (range[k][1] - range[k][0]);
        share(i).total_cmp(&share(j))
    })?;
    let across = 1 - along;
    let middle = 0.5 * (range[across][0] + range[across][1]);
    let away: Vec<Vec3> = uv
        .iter()
        .map(|&uv| {
            let mut inner = uv;
            inner[across] += 0.01 * (middle - uv[across]);
            unit(sub(on.point_on_surface(face, inner), on.point_on_surface(face, uv)))
        })
        .collect();
    let turned: f64 = away.windows(2).map(|w| dot(w[0], w[1]).clamp(-1.0, 1.0).acos()).filter(|x| x.is_finite()).sum();
    let count = (turned * segments).ceil().clamp(1.0, 64.0) as usize;
    Some((0..=count).map(|i| if i == count { to } else { from + (to - from) * i as f64 / count as f64 }).collect())
}

/// Makes the ends of lines that meet one corner, and lists the segments.
fn join(border: &mut Outline, lines: &[Line]) {
    let gap = |border: &Outline, a: u32, b: u32| {
        let [p, q] = [a, b].map(|c| border.corners[c as usize]);
        (p[0] - q[0]).hypot(p[1] - q[1])
    };
    let mut ends = Vec::with_capacity(2 * lines.len());
    for line in lines {
        let last = line.corners.len() - 1;
        for (at, next, is_start) in [(0, 1, true), (last, last - 1, false)] {
            let comes = match line.of.way {
                Use::Forward => Some(!is_start),
                Use::Reversed => Some(is_start),
                _ => None,
            };
            let [corner, next] = [at, next].map(|k| line.corners[k]);
            let point = border.points[corner as usize];
            ends.push(End { corner, point, wire: line.of.wire, comes, reach: gap(border, corner, next) });
        }
    }
    // Corner by corner what it is one with.
    let mut same: Vec<u32> = (0..border.corners.len() as u32).collect();
    let mut order: Vec<usize> = (0..ends.len()).collect();
    order.sort_by_key(|&i| ends[i].point);
    let mut gaps = Vec::new();
    for group in order.chunk_by(|&i, &j| ends[i].point == ends[j].point) {
        match_group(border, &ends, group, &mut same, &mut gaps);
    }
    let root = |same: &[u32], mut c: u32| {
        while same[c as usize] != c {
            c = same[c as usize];
        }
        c
    };
    // In the middle of all that are one.
    let mut sums = vec![([0.0; 2], 0.0); border.corners.len()];
    for end in &ends {
        let (sum, count) = &mut sums[root(&same, end.corner) as usize];
        let at = border.corners[end.corner as usize];
        *sum = [sum[0] + at[0], sum[1] + at[1]];
        *count += 1.0;
    }
    for (corner, (sum, count)) in sums.iter().enumerate() {
        if *count > 1.0 {
            border.corners[corner] = [sum[0] / count, sum[1] / count];
        }
    }
    for line in lines {
        let counts = line.of.way != Use::Internal;
        for (k, pair) in line.corners.windows(2).enumerate() {
            let ends = [root(&same, pair[0]), root(&same, pair[1])];
            let piece = if line.is_degenerate { NONE } else { k as u32 };
            let is_against = line.of.way == Use::Reversed;
            border.segments.push(Segment { ends, edge: line.of.edge, piece, counts, is_against });
        }
    }
    for [a, b] in gaps {
        let ends = [root(&same, a), root(&same, b)];
        if ends[0] != ends[1] {
            border.segments.push(Segment { ends, edge: NONE, piece: NONE, counts: true, is_against: false });
        }
    }
    compact(border, &same, root);
}

/// Joins the ends at one vertex: each that comes with the nearest that leaves, and all that are near.
fn match_group(border: &Outline, ends: &[End], group: &[usize], same: &mut [u32], gaps: &mut Vec<[u32; 2]>) {
    let between = |i: usize, j: usize| {
        let [p, q] = [i, j].map(|i| border.corners[ends[i].corner as usize]);
        (p[0] - q[0]).hypot(p[1] - q[1])
    };
    let join = |same: &mut [u32], i: usize, j: usize| {
        let [a, b] = [i, j].map(|i| {
            let mut c = ends[i].corner;
            while same[c as usize] != c {
                c = same[c as usize];
            }
            c
        });
        same[a.max(b) as usize] = a.min(b);
    };
    let mut pairs = Vec::new();
    for &i in group {
        for &j in group {
            if ends[i].comes == Some(true) && ends[j].comes == Some(false) {
                pairs.push((between(i, j), ends[i].wire != ends[j].wire, i, j));
            }
            if i < j && between(i, j) <= NEAR * ends[i].reach.min(ends[j].reach) {
                join(same, i, j);
            }
        }
    }
    pairs.sort_by(|a, b| (a.1, a.0).partial_cmp(&(b.1, b.0)).unwrap_or(std::cmp::Ordering::Equal));
    let mut taken: Vec<usize> = Vec::new();
    for (far, _, i, j) in pairs {
        if taken.contains(&i) || taken.contains(&j) {
            continue;
        }
        taken.extend([i, j]);
        if far <= 2.0 * ends[i].reach.min(ends[j].reach) {
            join(same, i, j);
        } else {
            // A pole without an edge of its own.
            gaps.push([ends[i].corner, ends[j].corner]);
        }
    }
}

/// Drops the corners that others stand for.
fn compact(border: &mut Outline, same: &[u32], root: impl Fn(&[u32], u32) -> u32) {
    let mut new = vec![NONE; same.len()];
    let (mut corners, mut points) = (Vec::new(), Vec::new());
    for corner in 0..same.len() {
        if same[corner] == corner as u32 {
            new[corner] = corners.len() as u32;
            corners.push(border.corners[corner]);
            points.push(border.points[corner]);
        }
    }
    for segment in &mut border.segments {
        segment.ends = segment.ends.map(|c| new[root(same, c) as usize]);
    }
    border.segments.retain(|segment| segment.ends[0] != segment.ends[1]);
    (border.corners, border.points) = (corners, points);
}
