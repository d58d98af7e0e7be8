//! A tree of boxes for nearest-item searches.
use super::vector::Vec3;

/// Items in a leaf.
const LEAF: usize = 4;

/// Deepest tree: halving 2³² items into leaves of 4 takes 30 levels.
const DEPTH: usize = 40;

/// Least and greatest corner.
type Bounds = [Vec3; 2];

/// A balanced binary tree over boxes. The items of a node are a range of `items`; node i has the children 2i+1 and 2i+2 and
/// halves its range, so no links are stored.
pub struct BoxTree {
    items: Vec<u32>,
    bounds: Vec<Bounds>,
}

impl BoxTree {
    /// Over `count` > 0 items with boxes `bounds_of(item)`.
    pub fn new(count: usize, bounds_of: impl Fn(u32) -> Bounds) -> Self {
        let boxes: Vec<Bounds> = (0..count as u32).map(bounds_of).collect();
        let mut items: Vec<u32> = (0..count as u32).collect();
        let mut levels = 0;
        while count.div_ceil(1 << levels) > LEAF {
            levels += 1;
        }
        let mut bounds = vec![[[0.0; 3]; 2]; (2 << levels) - 1];
        build(0, &mut items, &boxes, &mut bounds);
        Self { items, bounds }
    }

    /// Visits the items whose boxes lie nearer to p than a bound (squared distance), near ones first; `visit` returns the new bound.
    pub fn nearest(&self, p: Vec3, mut bound: f64, mut visit: impl FnMut(u32) -> f64) {
        // Node, range of items, squared distance of its box.
        let mut stack = [(0usize, 0usize, 0usize, 0.0f64); DEPTH + 1];
        stack[0] = (0, 0, self.items.len(), square_distance(p, &self.bounds[0]));
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let (node, begin, end, square) = stack[top];
            if square >= bound {
                continue;
            }
            if 2 * node + 2 >= self.bounds.len() {
                for &item in &self.items[begin..end] {
                    bound = visit(item);
                }
                continue;
            }
            let middle = begin + (end - begin).div_ceil(2);
            let left = (2 * node + 1, begin, middle, square_distance(p, &self.bounds[2 * node + 1]));
            let right = (2 * node + 2, middle, end, square_distance(p, &self.bounds[2 * node + 2]));
            let (near, far) = if left.3 <= right.3 { (left, right) } else { (right, left) };
            stack[top] = far;
            stack[top + 1] = near;
            top += 2;
        }
    }
}

/// Fills the bounds of a node and orders its items, halved along the longest side of the box of their middles.
fn build(node: usize, items: &mut [u32], boxes: &[Bounds], bounds: &mut [Bounds]) {
    let mut all = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    let mut middles = all;
    for &item in items.iter() {
        let [low, high] = boxes[item as usize];
        for i in 0..3 {
            all[0][i] = all[0][i].min(low[i]);
            all[1][i] = all[1][i].max(high[i]);
            middles[0][i] = middles[0][i].min(low[i] + high[i]);
            middles[1][i] = middles[1][i].max(low[i] + high[i]);
        }
    }
    bounds[node] = all;
    if 2 * node + 2 >= bounds.len() {
        return;
    }
    let side = |i: usize| middles[1][i] - middles[0][i];
    let axis = (0..3).max_by(|&i, &j| side(i).total_cmp(&side(j))).unwrap_or(0);
    let key = |item: u32| boxes[item as usize][0][axis] + boxes[item as usize][1][axis];
    let middle = items.len().div_ceil(2);
    if middle < items.len() {
        items.select_nth_unstable_by(middle, |&a, &b| key(a).total_cmp(&key(b)));
    }
    let (left, right) = items.split_at_mut(middle);
    build(2 * node + 1, left, boxes, bounds);
    build(2 * node + 2, right, boxes, bounds);
}

/// Squared distance from p to a box; 0 inside.
#[inline(always)]
fn square_distance(p: Vec3, [low, high]: &Bounds) -> f64 {
    (0..3).map(|i| (low[i] - p[i]).max(p[i] - high[i]).max(0.0).powi(2)).sum()
}
