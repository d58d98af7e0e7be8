//! A face or an edge cut into flat pieces, in a tree of oriented boxes. The global search rules out pieces by it.
use super::pieces::{Source, cut};
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
    /// Half its sides along them.
    pub half: Vec3,
    /// Greatest curvature (1/length) towards the normal and away from it; of leaves only.
    pub bends: [f64; 2],
    /// The greatest curvature of the piece and of all that lies as near as it is wide.
    about: f64,
    /// The second child; the first is the next node. None in a leaf.
    pub second: u32,
    /// Whether all of it lies outside the trimmed face, so that no search looks into it.
    outside: bool,
}

/// No child.
pub const LEAF: u32 = u32::MAX;
/// Where curvature times distance is below this, |S − p|² has one minimum over a piece and those beside it. In theory it is below 1 (the
/// centre of curvature), but the curvatures are from samples.
const CONVEX: f64 = 0.5;
/// How far beyond a piece its surroundings go, in its widths.
const BESIDE: f64 = 1.0;
/// More than the depth of any tree: the number of spans is halved, then a span ten times.
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

    /// Whether a foot at `uv` of distance `reach` rules out closer points in the piece: the foot lies in the piece or beside it, and there
    /// the distance has one minimum.
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

impl Tree {
    /// Cuts a face, or an edge (whose second cuts are two zeros).
    pub fn new(source: &mut Source, cuts: [Vec<f64>; 2], periods: [Option<f64>; 2]) -> Self {
        let mut tree = Self(cut(source, cuts));
        for i in 0..tree.0.len() {
            if tree.0[i].second == LEAF {
                tree.0[i].about = tree.surroundings(i, periods);
            }
        }
        tree
    }

    /// Leaves out the pieces of these parameters that lie outside the trimmed face, but not all.
    pub fn trimmed(mut self, is_outside: impl Fn([[f64; 2]; 2]) -> bool) -> Self {
        for i in (0..self.0.len()).rev() {
            let second = self.0[i].second;
            self.0[i].outside = if second == LEAF {
                is_outside(self.0[i].bounds)
            } else {
                self.0[i + 1].outside && self.0[second as usize].outside
            };
        }
        if self.0[0].outside {
            self.0.iter_mut().for_each(|node| node.outside = false);
        }
        self
    }

    /// No point of it is closer than this.
    pub fn least_distance(&self, point: Vec3) -> f64 {
        self.0[0].least_distance(point)
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
            if node.outside {
                continue;
            }
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

    /// The leaf with the nearest middle, of those that come within the limit; none for a point of NaN.
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
pub fn boxed(jet: &Jet, bounds: [[f64; 2]; 2], points: &[Vec3], margin: f64) -> Node {
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
    Node { bounds, center, axes, half, bends: [0.0; 2], about: 0.0, second: LEAF, outside: false }
}
