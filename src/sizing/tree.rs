//! A tree of boxes, built on all threads.
use crate::mesh::hilbert;
use crate::mesh::vector::{Vec3, lerp};
use crate::tasks::{GRAIN, Team};

/// Least and greatest corner.
pub type Box3 = [Vec3; 2];

/// Holds nothing and meets nothing.
pub const EMPTY: Box3 = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];

/// Items of a leaf.
const LEAF: usize = 4;
/// Most nodes on the stack of a search: one more for each level, of which there are fewer than 32.
const STACK: usize = 64;

/// The box around two boxes.
pub fn join(a: Box3, b: Box3) -> Box3 {
    [std::array::from_fn(|i| a[0][i].min(b[0][i])), std::array::from_fn(|i| a[1][i].max(b[1][i]))]
}

/// The box around points.
pub fn box_of(points: impl IntoIterator<Item = Vec3>) -> Box3 {
    points.into_iter().fold(EMPTY, |all, p| join(all, [p, p]))
}

/// Whether two boxes have a point in common.
#[inline]
pub fn meet(a: &Box3, b: &Box3) -> bool {
    (0..3).all(|i| a[0][i] <= b[1][i] && b[0][i] <= a[1][i])
}

/// Items with boxes along the Hilbert curve, under a full binary tree: node i has the children 2i + 1 and 2i + 2.
pub struct Tree {
    order: Vec<u32>,
    boxes: Vec<Box3>,
    nodes: Vec<Box3>,
}

impl Tree {
    /// Over items with these boxes.
    pub fn new(team: Team<'_>, boxes: &[Box3]) -> Self {
        let order = hilbert::order(team, boxes.len(), |i| lerp(boxes[i][0], boxes[i][1], 0.5));
        let sorted = team.map(GRAIN, order.len(), |i| boxes[order[i] as usize]);
        let mut width = order.len().div_ceil(LEAF).next_power_of_two();
        let mut level = team.map(GRAIN, width, |leaf| {
            let items = (leaf * LEAF).min(sorted.len())..((leaf + 1) * LEAF).min(sorted.len());
            sorted[items].iter().copied().fold(EMPTY, join)
        });
        let mut levels = Vec::new();
        while width > 1 {
            width /= 2;
            let above = team.map(GRAIN, width, |i| join(level[2 * i], level[2 * i + 1]));
            levels.push(std::mem::replace(&mut level, above));
        }
        levels.push(level);
        let nodes = team.join_slices(levels.iter().rev().map(Vec::as_slice));
        Self { order, boxes: sorted, nodes }
    }

    /// Calls `visit` with the items whose boxes are admitted, until it returns false. Returns whether it never did. A box that is not
    /// admitted must hold no box that is.
    pub fn each_where(&self, admits: impl Fn(&Box3) -> bool, mut visit: impl FnMut(u32) -> bool) -> bool {
        let first_leaf = self.nodes.len() / 2;
        let mut stack = [0usize; STACK];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let node = stack[top];
            if !admits(&self.nodes[node]) {
                continue;
            }
            if node < first_leaf {
                stack[top] = 2 * node + 2;
                stack[top + 1] = 2 * node + 1;
                top += 2;
                continue;
            }
            let begin = (node - first_leaf) * LEAF;
            for i in begin..(begin + LEAF).min(self.order.len()) {
                if admits(&self.boxes[i]) && !visit(self.order[i]) {
                    return false;
                }
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tasks::{Plan, Pool};

    #[test]
    fn finds_what_a_look_at_all_finds() {
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) as f64 / (1u64 << 31) as f64
        };
        let pool = Pool::new(3).unwrap();
        for count in [0, 1, 4, 5, 1000, 20_000] {
            let mut some = || {
                let low: Vec3 = std::array::from_fn(|_| random());
                [low, low.map(|x| x + 0.1 * random())]
            };
            let boxes: Vec<Box3> = (0..count).map(|_| some()).collect();
            let trees = [Team::alone(), Team::new(&pool, Plan::default())].map(|team| Tree::new(team, &boxes));
            for _ in 0..20 {
                let query = some();
                let expected: Vec<u32> = (0..count as u32).filter(|&i| meet(&boxes[i as usize], &query)).collect();
                for tree in &trees {
                    let mut found = Vec::new();
                    assert!(tree.each_where(
                        |items| meet(items, &query),
                        |i| {
                            found.push(i);
                            true
                        }
                    ));
                    found.sort_unstable();
                    assert_eq!(found, expected);
                }
            }
        }
    }
}
