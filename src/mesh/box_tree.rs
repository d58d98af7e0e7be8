//! A tree of boxes for nearest-item searches.
use super::vector::{Vec3, add};
use crate::tasks::{GRAIN, Team};
use std::cell::Cell;
use std::ops::Range;

/// Items in a leaf.
const LEAF: usize = 4;

/// Leaves a task of a search for pairs.
const LEAVES: usize = 64;

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
    pub fn new(count: usize, bounds_of: impl Fn(u32) -> Bounds + Sync) -> Self {
        Self::on(Team::alone(), count, bounds_of)
    }

    /// As [`BoxTree::new`], on the threads of a team: the same tree.
    pub fn on(team: Team<'_>, count: usize, bounds_of: impl Fn(u32) -> Bounds + Sync) -> Self {
        let boxes = team.map(GRAIN, count, |item| bounds_of(item as u32));
        let mut levels = 0;
        while count.div_ceil(1 << levels) > LEAF {
            levels += 1;
        }
        let mut items: Vec<u32> = (0..count as u32).collect();
        let middles = team.map(GRAIN, count, |item| add(boxes[item][0], boxes[item][1]));
        order(team, &mut items, &middles, levels);
        let mut tree = Self { items, bounds: vec![NOTHING; (2 << levels) - 1] };
        let (ranges, inner) = (tree.ranges(), tree.bounds.len() / 2);
        team.fill(GRAIN, &mut tree.bounds[inner..], |start, leaves| {
            for (bounds, range) in leaves.iter_mut().zip(&ranges[inner + start..]) {
                *bounds = tree.items[range.clone()].iter().fold(NOTHING, |all, &item| join(all, boxes[item as usize]));
            }
        });
        for node in (0..inner).rev() {
            tree.bounds[node] = join(tree.bounds[2 * node + 1], tree.bounds[2 * node + 2]);
        }
        tree
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
        self.leaves_where(
            |node, _| overlap(box_, &self.bounds[node]),
            |range| self.items[range].iter().for_each(|&item| visit(item)),
        );
    }

    /// Whether one of the items whose boxes touch a box is asked for.
    pub fn any_overlapping(&self, box_: &Bounds, mut is_asked: impl FnMut(u32) -> bool) -> bool {
        let found = Cell::new(false);
        self.leaves_where(
            |node, _| !found.get() && overlap(box_, &self.bounds[node]),
            |range| found.set(self.items[range].iter().any(|&item| is_asked(item))),
        );
        found.get()
    }

    /// Visits each pair of items whose boxes touch once, but for pairs of a leaf and a node that are not `wanted`; both are told by their
    /// numbers among all nodes. Tasks take leaves, and each has a state of its own; these come back in the order of the tree. `boxes` are
    /// those that the tree was made of.
    pub fn overlapping_pairs<S: Default + Send>(
        &self,
        team: Team<'_>,
        boxes: impl Fn(u32) -> Bounds + Sync,
        wanted: impl Fn(usize, usize) -> bool + Sync,
        visit: impl Fn(&mut S, u32, u32) + Sync,
    ) -> Vec<S> {
        let boxes = team.map(GRAIN, self.items.len(), |place| boxes(self.items[place]));
        let (ranges, inner) = (self.ranges(), self.bounds.len() / 2);
        team.chunks(LEAVES, inner + 1, |leaves| {
            let mut state = S::default();
            for leaf in leaves.map(|leaf| inner + leaf) {
                let (own, around) = (&ranges[leaf], &self.bounds[leaf]);
                // A pair is found from its first leaf.
                let is_asked = |node: usize, range: &Range<usize>| {
                    range.end > own.start && overlap(around, &self.bounds[node]) && wanted(leaf, node)
                };
                self.leaves_where(is_asked, |others| {
                    for i in own.clone() {
                        for j in others.clone() {
                            if (j > i || others.start > own.start) && overlap(&boxes[i], &boxes[j]) {
                                visit(&mut state, self.items[i], self.items[j]);
                            }
                        }
                    }
                });
            }
            state
        })
    }

    /// A value for each node, of its items.
    pub fn of_nodes<T: Copy + Send>(&self, team: Team<'_>, of: impl Fn(&[u32]) -> T + Sync) -> Vec<T> {
        let ranges = self.ranges();
        team.map(1, ranges.len(), |node| of(&self.items[ranges[node].clone()]))
    }

    /// The places in `items` of each node.
    fn ranges(&self) -> Vec<Range<usize>> {
        let mut ranges: Vec<Range<usize>> = Vec::with_capacity(self.bounds.len());
        ranges.push(0..self.items.len());
        for node in 1..self.bounds.len() {
            let (first, second) = halves(&ranges[(node - 1) / 2]);
            ranges.push(if node % 2 == 1 { first } else { second });
        }
        ranges
    }

    /// Visits the leaves, in order, that are asked for, as all nodes above them are: by their places in `items`.
    #[inline(always)]
    fn leaves_where(&self, is_asked: impl Fn(usize, &Range<usize>) -> bool, mut visit: impl FnMut(Range<usize>)) {
        let mut stack: [(usize, Range<usize>); DEPTH + 1] = std::array::from_fn(|_| (0, 0..0));
        stack[0] = (0, 0..self.items.len());
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let (node, range) = stack[top].clone();
            if !is_asked(node, &range) {
                continue;
            }
            if 2 * node + 2 >= self.bounds.len() {
                visit(range);
                continue;
            }
            let (first, second) = halves(&range);
            stack[top] = (2 * node + 2, second);
            stack[top + 1] = (2 * node + 1, first);
            top += 2;
        }
    }
}

/// The places of a node's two children.
#[inline(always)]
fn halves(range: &Range<usize>) -> (Range<usize>, Range<usize>) {
    let middle = range.start + half(range.len());
    (range.start..middle, middle..range.end)
}

/// Items of the first child of a node of so many.
#[inline(always)]
fn half(count: usize) -> usize {
    count.div_ceil(2)
}

/// Whether two boxes touch.
#[inline(always)]
pub fn overlap(a: &Bounds, b: &Bounds) -> bool {
    (0..3).all(|i| a[0][i] <= b[1][i] && b[0][i] <= a[1][i])
}

/// Orders the items of a tree of so many levels below its root: level by level as long as they are many, which all threads share, then
/// a branch a task. `middles` are twice the middles of the boxes.
fn order(team: Team<'_>, items: &mut [u32], middles: &[Vec3], mut levels: usize) {
    let mut branches = vec![items];
    while levels > 0 && branches[0].len() > GRAIN {
        team.fill(1, &mut branches, |_, branches| branches.iter_mut().for_each(|items| halve(items, middles)));
        branches =
            branches.into_iter().flat_map(|items| <[_; 2]>::from(items.split_at_mut(half(items.len())))).collect();
        levels -= 1;
    }
    team.fill(1, &mut branches, |_, branches| {
        branches.iter_mut().for_each(|items| order_branch(items, middles, levels));
    });
}

/// Orders the items of a branch of so many levels.
fn order_branch(items: &mut [u32], middles: &[Vec3], levels: usize) {
    if levels > 0 {
        halve(items, middles);
        let (left, right) = items.split_at_mut(half(items.len()));
        order_branch(left, middles, levels - 1);
        order_branch(right, middles, levels - 1);
    }
}

/// Orders the items of a node so that each child has one half of them, along the longest side of the box of their middles.
fn halve(items: &mut [u32], middles: &[Vec3]) {
    let [low, high] = items.iter().fold(NOTHING, |all, &item| join(all, [middles[item as usize]; 2]));
    let axis = (0..3).max_by(|&i, &j| (high[i] - low[i]).total_cmp(&(high[j] - low[j]))).unwrap_or(0);
    let key = |item: u32| middles[item as usize][axis];
    let middle = half(items.len());
    if middle < items.len() {
        items.select_nth_unstable_by(middle, |&a, &b| key(a).total_cmp(&key(b)));
    }
}

/// The box of no item.
const NOTHING: Bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];

/// The box of two boxes.
#[inline(always)]
fn join(a: Bounds, b: Bounds) -> Bounds {
    [[0, 1, 2].map(|i| a[0][i].min(b[0][i])), [0, 1, 2].map(|i| a[1][i].max(b[1][i]))]
}

/// Squared distance from p to a box; 0 inside.
#[inline(always)]
fn square_distance(p: Vec3, [low, high]: &Bounds) -> f64 {
    (0..3).map(|i| (low[i] - p[i]).max(p[i] - high[i]).max(0.0).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tasks::{Plan, Pool};

    #[test]
    fn threads_make_the_same_tree() {
        let pool = Pool::new(3).unwrap();
        // Many middles are equal.
        let low = |item: u32| [0, 1, 2].map(|i| f64::from(item.wrapping_mul([7919, 104_729, 1_299_709][i]) % 50));
        let bounds = |item: u32| [low(item), low(item).map(|x| x + 3.0)];
        for count in [1, 5, GRAIN, 5 * GRAIN + 3] {
            let (alone, team) = (BoxTree::new(count, bounds), Team::new(&pool, Plan::default()));
            let tree = BoxTree::on(team, count, bounds);
            assert!(tree.items == alone.items && tree.bounds == alone.bounds, "{count}");
        }
    }

    #[test]
    fn each_pair_is_found_once() {
        let low = |item: u32| [0, 1, 2].map(|i| f64::from(item.wrapping_mul([7919, 104_729, 1_299_709][i]) % 1000));
        let bounds = |item: u32| [low(item), low(item).map(|x| x + 100.0)];
        for count in [1, 4, 5, 333] {
            let tree = BoxTree::new(count, bounds);
            let parts: Vec<Vec<[u32; 2]>> = tree.overlapping_pairs(
                Team::alone(),
                bounds,
                |_, _| true,
                |found: &mut Vec<_>, i, j| found.push([i.min(j), i.max(j)]),
            );
            let mut found = parts.concat();
            found.sort_unstable();
            let all = (0..count as u32).flat_map(|i| (i + 1..count as u32).map(move |j| [i, j]));
            let expected: Vec<_> = all.filter(|&[i, j]| overlap(&bounds(i), &bounds(j))).collect();
            assert_eq!(found, expected);
            assert!(count < 9 || expected.len() > 100);
        }
    }

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
