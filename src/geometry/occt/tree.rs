//! A face or an edge cut into flat pieces, in a tree of oriented boxes: what the global search rules out by.
use super::range::bring_near;
use super::surface::Jet;
use crate::mesh::vector::{Vec3, cross, dot, norm, scale, sub, unit};

/// A piece of parameter space and a box around its points.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// Bounds of u, and of v (zeros on an edge).
    pub bounds: [[f64; 2]; 2],
    /// Middle of the box.
    pub center: Vec3,
    /// Its axes: along S_u, across it, and the normal of the piece's middle.
    axes: [Vec3; 3],
    half: Vec3,
    /// Greatest curvature (1/length) towards the normal and away from it; of leaves only.
    bends: [f64; 2],
    /// The greatest curvature of the piece and of all that lies as near as it is wide.
    about: f64,
    /// The second child; the first is the next node. None in a leaf.
    second: u32,
}

/// No child.
const LEAF: u32 = u32::MAX;
/// A piece is flat when its thickness is at most this share of its extent.
const FLAT: f64 = 0.05;
/// And when its normal turns by at most this along u and along v (radians, by samples).
const TURN: f64 = 0.5;
/// Samples of the curvature in each direction, ends included.
const SAMPLES: usize = 5;
/// Most halvings of a smooth span.
const HALVINGS: u32 = 12;
/// What the curvatures of samples are allowed to be exceeded by between them.
const EXCESS: f64 = 1.5;
/// Curvature times distance below which |S − p|² has one minimum over a piece and those beside it; 1 is the centre of
/// curvature, and the curvatures are from samples.
const CONVEX: f64 = 0.5;
/// How far beyond a piece its surroundings go, in its widths.
const BESIDE: f64 = 1.0;
/// Depth of a tree, amply: spans are halved in number, then ten times in length.
const DEPTH: usize = 128;

impl Node {
    /// The middle of the parameters.
    pub fn middle(&self) -> [f64; 2] {
        self.bounds.map(|[low, high]| 0.5 * (low + high))
    }

    /// No point of the piece is closer than this.
    #[inline]
    pub fn least_distance(&self, point: Vec3) -> f64 {
        let arm = sub(point, self.center);
        let mut sum = 0.0;
        for k in 0..3 {
            let beyond = dot(arm, self.axes[k]).abs() - self.half[k];
            // Written so that NaN stays NaN.
            sum += if beyond < 0.0 { 0.0 } else { beyond * beyond };
        }
        sum.sqrt()
    }

    /// Whether the distance from the point has one minimum over the piece, as far as it is less than `reach`.
    pub fn is_simple(&self, point: Vec3, reach: f64) -> bool {
        let arm = sub(point, self.center);
        let height = dot(arm, self.axes[2]);
        let aside = dot(arm, self.axes[0]).hypot(dot(arm, self.axes[1]));
        let bend = match height {
            h if h > aside => self.bends[0],
            h if h < -aside => self.bends[1],
            _ => self.bends[0].max(self.bends[1]),
        };
        bend * reach < CONVEX
    }

    /// Whether a foot at `uv` leaves no other point of the piece closer than `reach`, which is its distance: it lies in
    /// the piece or beside it, and there the distance has one minimum.
    pub fn is_covered(&self, uv: [f64; 2], periods: [Option<f64>; 2], reach: f64) -> bool {
        let middle = self.middle();
        self.about * reach < CONVEX
            && (0..2).all(|k| {
                let [low, high] = self.bounds[k];
                (bring_near(uv[k], middle[k], periods[k]) - middle[k]).abs() <= (0.5 + BESIDE) * (high - low)
            })
    }
}

/// Nodes in the order of a walk that goes down first.
#[derive(Debug)]
pub struct Tree(Vec<Node>);

/// S and its derivatives at parameters.
pub type Jets<'a> = dyn FnMut([f64; 2]) -> Jet + 'a;

/// What a tree is made of: evaluation, and points whose hull grown by a margin holds a piece (see `hull`).
pub struct Source<'a> {
    /// S and its derivatives.
    pub jet: &'a mut Jets<'a>,
    /// Points about a piece, and their margin.
    pub hull: &'a mut dyn FnMut(&mut Jets, [[f64; 2]; 2], &mut Vec<Vec3>) -> f64,
}

/// Where a range is cut: at its ends and at the breaks between them, or into `count` equal pieces where there are none.
pub fn cuts(range: [f64; 2], period: Option<f64>, breaks: &[f64], count: usize) -> Vec<f64> {
    let [low, high] = range;
    let mut all = vec![low];
    if breaks.len() > 1 {
        let slack = 1e-9 * (high - low);
        for turn in if period.is_some() { -2..=2 } else { 0..=0 } {
            let shift = period.unwrap_or(0.0) * f64::from(turn);
            all.extend(breaks.iter().map(|t| t + shift).filter(|t| *t > low + slack && *t < high - slack));
        }
        all.sort_unstable_by(f64::total_cmp);
        all.dedup();
    } else {
        all.extend((1..count).map(|k| low + (high - low) * k as f64 / count as f64));
    }
    all.push(high);
    all
}

struct Builder<'a, 'b> {
    source: &'a mut Source<'b>,
    cuts: [Vec<f64>; 2],
    nodes: Vec<Node>,
    /// Hull points of the leaves so far, in their order.
    points: Vec<Vec3>,
}

impl Tree {
    /// Cuts a face, or an edge (whose second cuts are two zeros).
    pub fn new(source: &mut Source, cuts: [Vec<f64>; 2], periods: [Option<f64>; 2]) -> Self {
        let whole = cuts.each_ref().map(|cuts| [0, cuts.len() - 1]);
        let mut builder = Builder { source, cuts, nodes: Vec::new(), points: Vec::new() };
        builder.spans(whole);
        let mut tree = Self(builder.nodes);
        for i in 0..tree.0.len() {
            if tree.0[i].second == LEAF {
                tree.0[i].about = tree.surroundings(i, periods);
            }
        }
        tree
    }

    /// The greatest curvature of the leaves that meet the surroundings of a leaf.
    fn surroundings(&self, leaf: usize, periods: [Option<f64>; 2]) -> f64 {
        let wide = self.0[leaf].bounds.map(|[low, high]| {
            let more = BESIDE * (high - low);
            [low - more, high + more]
        });
        let turns = |k: usize| if periods[k].is_some() { -1..=1 } else { 0..=0 };
        let mut bend = 0.0f64;
        for (i, j) in turns(0).flat_map(|i| turns(1).map(move |j| (i, j))) {
            let shift = [i, j].map(f64::from).into_iter().zip(periods).map(|(n, period)| n * period.unwrap_or(0.0));
            let mut wide = wide;
            wide.iter_mut().zip(shift).for_each(|(wide, shift)| *wide = wide.map(|t| t + shift));
            bend = bend.max(self.greatest(0, wide));
        }
        bend
    }

    /// The greatest curvature of the leaves below a node that meet a rectangle.
    fn greatest(&self, node: u32, rectangle: [[f64; 2]; 2]) -> f64 {
        let here = &self.0[node as usize];
        if (0..2).any(|k| here.bounds[k][0] > rectangle[k][1] || here.bounds[k][1] < rectangle[k][0]) {
            return 0.0;
        }
        if here.second == LEAF {
            return here.bends[0].max(here.bends[1]);
        }
        self.greatest(node + 1, rectangle).max(self.greatest(here.second, rectangle))
    }

    /// Calls `look(leaf, limit)` for the leaves that may hold a point closer than the limit, near ones first; it
    /// returns the new limit.
    pub fn visit<'t>(&'t self, point: Vec3, mut limit: f64, mut look: impl FnMut(&'t Node, f64) -> f64) {
        let mut stack = [(0.0, 0u32); DEPTH];
        stack[0] = (self.0[0].least_distance(point), 0);
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (least, index) = stack[count];
            // A NaN is less than nothing.
            if !matches!(least.partial_cmp(&limit), Some(std::cmp::Ordering::Less)) {
                continue;
            }
            let node = &self.0[index as usize];
            if node.second == LEAF {
                limit = look(node, limit);
                continue;
            }
            let children = [index + 1, node.second].map(|i| (self.0[i as usize].least_distance(point), i));
            let [near, far] = if children[1].0 < children[0].0 { [1, 0] } else { [0, 1] };
            stack[count] = children[far];
            stack[count + 1] = children[near];
            count += 2;
        }
    }

    /// The leaf whose middle is nearest, if one reaches within the limit; none for a point that is no number.
    pub fn nearest(&self, point: Vec3, limit: f64) -> Option<&Node> {
        let mut best = (f64::INFINITY, None);
        self.visit(point, limit, |leaf, limit| {
            let length = norm(sub(leaf.center, point));
            if length < best.0 {
                best = (length, Some(leaf));
            }
            limit.min(length)
        });
        best.1
    }
}

impl Builder<'_, '_> {
    /// The rectangle of a block of spans.
    fn rectangle(&self, spans: [[usize; 2]; 2]) -> [[f64; 2]; 2] {
        [0, 1].map(|k: usize| spans[k].map(|i| self.cuts[k][i]))
    }

    /// Adds the node of a block of spans and all below it; returns the margin of its points.
    fn spans(&mut self, spans: [[usize; 2]; 2]) -> f64 {
        let rectangle = self.rectangle(spans);
        let counts = spans.map(|[from, to]| to - from);
        if counts == [1, 1] {
            return self.piece(rectangle, 0);
        }
        let here = self.jet(rectangle);
        let sizes = extents(&here, rectangle);
        let k = if counts[1] == 1 || (counts[0] > 1 && sizes[0] >= sizes[1]) { 0 } else { 1 };
        let middle = usize::midpoint(spans[k][0], spans[k][1]);
        let (mut low, mut high) = (spans, spans);
        low[k][1] = middle;
        high[k][0] = middle;
        self.branch(&here, rectangle, |builder| builder.spans(low), |builder| builder.spans(high))
    }

    /// Adds the node of a piece of one span and those below it.
    fn piece(&mut self, rectangle: [[f64; 2]; 2], depth: u32) -> f64 {
        let here = self.jet(rectangle);
        let first = self.points.len();
        let margin = (self.source.hull)(self.source.jet, rectangle, &mut self.points);
        let mut node = boxed(&here, rectangle, &self.points[first..], margin);
        let bending = self.bending(rectangle);
        let [u_turn, v_turn] = bending.turns;
        let is_flat = node.half[2] <= FLAT * node.half[0].max(node.half[1]);
        if depth == HALVINGS || (is_flat && u_turn.max(v_turn) <= TURN) {
            node.bends = bending.bends;
            self.nodes.push(node);
            return margin;
        }
        self.points.truncate(first);
        // Where it turns more; where only the hull is thick, the longer side.
        let sizes = extents(&here, rectangle);
        let is_curve = rectangle[1][0] == rectangle[1][1];
        let k = if u_turn.max(v_turn) > 0.1 * TURN { v_turn > u_turn } else { sizes[1] > sizes[0] };
        let k = usize::from(k && !is_curve);
        let [low, high] = rectangle[k];
        let middle = 0.5 * (low + high);
        let (mut below, mut above) = (rectangle, rectangle);
        below[k][1] = middle;
        above[k][0] = middle;
        self.branch(
            &here,
            rectangle,
            |builder| builder.piece(below, depth + 1),
            |builder| builder.piece(above, depth + 1),
        )
    }

    fn branch(
        &mut self,
        here: &Jet,
        rectangle: [[f64; 2]; 2],
        one: impl FnOnce(&mut Self) -> f64,
        other: impl FnOnce(&mut Self) -> f64,
    ) -> f64 {
        let (index, first) = (self.nodes.len(), self.points.len());
        self.nodes.push(boxed(here, rectangle, &[], 0.0));
        let margin = one(self);
        let second = self.nodes.len() as u32;
        let margin = margin.max(other(self));
        self.nodes[index] = Node { second, ..boxed(here, rectangle, &self.points[first..], margin) };
        margin
    }

    fn jet(&mut self, rectangle: [[f64; 2]; 2]) -> Jet {
        (self.source.jet)(rectangle.map(|[low, high]| 0.5 * (low + high)))
    }

    /// How a piece bends, by samples.
    fn bending(&mut self, rectangle: [[f64; 2]; 2]) -> Bending {
        let is_curve = rectangle[1][0] == rectangle[1][1];
        let widths = rectangle.map(|[low, high]| high - low);
        let at = |k: usize, i: usize| {
            let s = i as f64 / (SAMPLES - 1) as f64;
            rectangle[k][0] * (1.0 - s) + rectangle[k][1] * s
        };
        let mut all = Bending { bends: [0.0; 2], turns: [0.0; 2] };
        for i in 0..SAMPLES {
            for j in 0..if is_curve { 1 } else { SAMPLES } {
                let here = (self.source.jet)([at(0, i), at(1, j)]);
                let [least, greatest] = curvatures(&here, is_curve);
                all.bends = [all.bends[0].max(EXCESS * greatest), all.bends[1].max(-EXCESS * least)];
                let turns = if is_curve {
                    [norm(cross(here.du, here.duu)) / dot(here.du, here.du), 0.0]
                } else {
                    let normal = unit(cross(here.du, here.dv));
                    [(here.du, here.duu), (here.dv, here.dvv)].map(|(d, dd)| dot(dd, normal).abs() / norm(d))
                };
                // At a pole 0/0 is NaN, which is no maximum.
                all.turns = [0, 1].map(|k: usize| all.turns[k].max(turns[k] * widths[k]));
            }
        }
        all
    }
}

/// Curvatures as in [`Node`], and how far the normal turns along u and v, radians.
struct Bending {
    bends: [f64; 2],
    turns: [f64; 2],
}

/// How long a piece is in u and v, from the derivatives at its middle.
fn extents(jet: &Jet, rectangle: [[f64; 2]; 2]) -> [f64; 2] {
    [norm(jet.du) * (rectangle[0][1] - rectangle[0][0]), norm(jet.dv) * (rectangle[1][1] - rectangle[1][0])]
}

/// Least and greatest principal curvature towards Su × Sv; infinite where there is no normal. Of a curve ± its own.
fn curvatures(jet: &Jet, is_curve: bool) -> [f64; 2] {
    if is_curve {
        let speed = norm(jet.du);
        let bend = norm(cross(jet.du, jet.duu)) / (speed * speed * speed);
        return if bend.is_finite() { [-bend, bend] } else { [f64::NEG_INFINITY, f64::INFINITY] };
    }
    let normal = unit(cross(jet.du, jet.dv));
    let [e, f, g] = [dot(jet.du, jet.du), dot(jet.du, jet.dv), dot(jet.dv, jet.dv)];
    let [l, m, n] = [jet.duu, jet.duv, jet.dvv].map(|second| dot(second, normal));
    let area2 = e * g - f * f;
    let mean = 0.5 * (e * n - 2.0 * f * m + g * l) / area2;
    let root = (mean * mean - (l * n - m * m) / area2).max(0.0).sqrt();
    let all = [mean - root, mean + root];
    if area2 > 1e-18 * (e * g) && all.iter().all(|x| x.is_finite()) { all } else { [f64::NEG_INFINITY, f64::INFINITY] }
}

/// Axes along S_u (or S_v) and the normal; some axes where there is neither.
fn axes(jet: &Jet) -> [Vec3; 3] {
    let along = if norm(jet.du) > 0.0 { unit(jet.du) } else { unit(jet.dv) };
    if !along.iter().all(|x| x.is_finite()) || norm(along) == 0.0 {
        return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    }
    let mut normal = unit(cross(jet.du, jet.dv));
    if norm(normal) < 0.5 {
        // A curve, or a pole: any direction across.
        let least = (0..3).min_by(|&a, &b| along[a].abs().total_cmp(&along[b].abs())).unwrap_or(0);
        let mut other = [0.0; 3];
        other[least] = 1.0;
        normal = unit(cross(along, other));
    }
    [along, cross(normal, along), normal]
}

/// The box of some points grown by a margin, on the axes of a piece's middle; a leaf without curvatures.
fn boxed(jet: &Jet, bounds: [[f64; 2]; 2], points: &[Vec3], margin: f64) -> Node {
    let axes = axes(jet);
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let mut size = 0.0f64;
    for &point in points {
        for k in 0..3 {
            let x = dot(point, axes[k]);
            low[k] = low[k].min(x);
            high[k] = high[k].max(x);
            size = size.max(point[k].abs());
        }
    }
    let mut center = [0.0; 3];
    for k in 0..3 {
        let part = scale(axes[k], 0.5 * (low[k] + high[k]));
        center = [center[0] + part[0], center[1] + part[1], center[2] + part[2]];
    }
    // The last term is the rounding of the products.
    let half = [0, 1, 2].map(|k: usize| 0.5 * (high[k] - low[k]) + margin + 4e-15 * size);
    Node { bounds, center, axes, half, bends: [0.0; 2], about: 0.0, second: LEAF }
}
