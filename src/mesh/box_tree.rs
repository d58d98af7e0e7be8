//! A tree of boxes for nearest-item searches.
use super::vector::Vec3;

/// Items in a leaf.
const LEAF: usize = 4;

/// Deepest tree: halving 2³² items into leaves of 4 takes 30 levels.
const DEPTH: usize = 40;

/// Least and greatest corner.
pub type Bounds = [Vec3; 2];

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

    /// Visits the items whose boxes touch a box, in the order of the tree.
    pub fn overlapping(&self, box_: &Bounds, mut visit: impl FnMut(u32)) {
        let touches = |other: &Bounds| (0..3).all(|i| box_[0][i] <= other[1][i] && other[0][i] <= box_[1][i]);
        // Node and range of items.
        let mut stack = [(0usize, 0usize, 0usize); DEPTH + 1];
        stack[0] = (0, 0, self.items.len());
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let (node, begin, end) = stack[top];
            if !touches(&self.bounds[node]) {
                continue;
            }
            if 2 * node + 2 >= self.bounds.len() {
                self.items[begin..end].iter().for_each(|&item| visit(item));
                continue;
            }
            let middle = begin + (end - begin).div_ceil(2);
            stack[top] = (2 * node + 2, middle, end);
            stack[top + 1] = (2 * node + 1, begin, middle);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_touches_a_box_is_found() {
        let low = |item: u32| [0, 1, 2].map(|i| f64::from(item.wrapping_mul([7919, 104_729, 1_299_709][i]) % 1000));
        let bounds = |item: u32| [low(item), low(item).map(|x| x + 40.0)];
        let tree = BoxTree::new(777, bounds);
        for (from, side) in [(100.0, 300.0), (960.0, 10.0), (-5.0, 2.0), (0.0, 2000.0)] {
            let asked = [[from; 3], [from + side; 3]];
            let mut found = vec![0; 777];
            tree.overlapping(&asked, |item| found[item as usize] += 1);
            for item in 0..777 {
                let [low, high] = bounds(item);
                let touches = (0..3).all(|i| low[i] <= asked[1][i] && asked[0][i] <= high[i]);
                // A leaf whose box touches shows all its items.
                assert!(if touches { found[item as usize] == 1 } else { found[item as usize] <= 1 });
            }
            assert!(side > 5.0 || found.iter().all(|&count| count == 0));
        }
    }
}
