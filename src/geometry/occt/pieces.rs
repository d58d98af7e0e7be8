//! Cuts a face or an edge into flat pieces, in a tree.
use super::surface::Jet;
use super::tree::{Node, boxed};
use crate::mesh::vector::{Vec3, cross, dot, norm, unit};

/// A piece is flat when its thickness is at most this share of its extent.
const FLAT: f64 = 0.05;
/// And when its normal turns by at most this along u and along v (radians, by samples).
const TURN: f64 = 0.5;
/// Samples of the curvature in each direction, ends included.
const SAMPLES: usize = 5;
/// Most halvings of a smooth span.
const HALVINGS: u32 = 12;
/// Between the samples the curvature may exceed theirs by this factor.
const EXCESS: f64 = 1.5;

/// S and its derivatives at parameters.
pub type Jets<'a> = dyn FnMut([f64; 2]) -> Jet + 'a;

/// Adds points whose hull grown by a margin holds the piece over a rectangle, and returns the margin (see `hull`).
pub type Hull<'a> = dyn FnMut(&mut Jets, [[f64; 2]; 2], &mut Vec<Vec3>) -> f64 + 'a;

/// What a tree is made of.
pub struct Source<'a> {
    /// S and its derivatives.
    pub jet: &'a mut Jets<'a>,
    /// Points about a piece, and their margin.
    pub hull: &'a mut Hull<'a>,
}

/// The cuts of a range: its ends and the breaks between them, or those of `count` equal pieces where there are no breaks.
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

/// The nodes of a face, or of an edge (whose second cuts are two zeros).
pub fn cut(source: &mut Source, cuts: [Vec<f64>; 2]) -> Vec<Node> {
    let whole = cuts.each_ref().map(|cuts| [0, cuts.len() - 1]);
    let mut builder = Builder { source, cuts, nodes: Vec::new(), points: Vec::new() };
    builder.spans(whole);
    builder.nodes
}

struct Builder<'a, 'b> {
    source: &'a mut Source<'b>,
    cuts: [Vec<f64>; 2],
    nodes: Vec<Node>,
    /// Hull points of the leaves so far, in their order.
    points: Vec<Vec3>,
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
        // Cut the direction in which the normal turns more; where only the hull is too thick, the longer one.
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
        self.nodes[index] = boxed(here, rectangle, &self.points[first..], margin);
        self.nodes[index].second = second;
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
