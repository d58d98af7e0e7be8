//! A tree of boxes for nearest-item queries.
use crate::mesh::vector::Vec3;

/// Items of a leaf.
const LEAF: usize = 4;

/// An axis-aligned box: least and greatest corner.
pub(crate) type Box3 = [Vec3; 2];

/// The empty box.
pub(crate) const EMPTY: Box3 = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];

/// The box around points.
pub(crate) fn box_of(points: impl IntoIterator<Item = Vec3>) -> Box3 {
    points.into_iter().fold(EMPTY, |b, p| join(b, [p, p]))
}

/// The box around two boxes.
pub(crate) fn join(a: Box3, b: Box3) -> Box3 {
    [std::array::from_fn(|i| a[0][i].min(b[0][i])), std::array::from_fn(|i| a[1][i].max(b[1][i]))]
}

/// Square of the distance from a point to a box, zero inside.
fn distance2(b: &Box3, p: Vec3) -> f64 {
    (0..3).map(|i| (b[0][i] - p[i]).max(p[i] - b[1][i]).max(0.0).powi(2)).sum()
}

enum Kind {
    /// Range in `items`.
    Leaf(u32, u32),
    /// The right child; the left one follows its parent.
    Inner(u32),
}

struct Node {
    bounds: Box3,
    kind: Kind,
}

/// Boxes of items, halved at the median of their longest side; depth ⌈log2 n⌉.
pub(crate) struct BoxTree {
    nodes: Vec<Node>,
    items: Vec<u32>,
}

impl BoxTree {
    /// Builds the tree over the boxes of items 0, 1, …; O(n log n).
    pub fn new(boxes: &[Box3]) -> Self {
        let mut tree = Self { nodes: Vec::new(), items: (0..boxes.len() as u32).collect() };
        if !boxes.is_empty() {
            tree.build(boxes, 0, boxes.len());
        }
        tree
    }

    /// The box about all items.
    pub fn bounds(&self) -> Box3 {
        self.nodes.first().map_or(EMPTY, |root| root.bounds)
    }

    fn build(&mut self, boxes: &[Box3], first: usize, last: usize) {
        let items = &mut self.items[first..last];
        let bounds = items.iter().fold(EMPTY, |b, &i| join(b, boxes[i as usize]));
        let node = self.nodes.len();
        if items.len() <= LEAF {
            self.nodes.push(Node { bounds, kind: Kind::Leaf(first as u32, last as u32) });
            return;
        }
        let extent = |axis: usize| bounds[1][axis] - bounds[0][axis];
        let axis = (1..3).fold(0, |best, axis| if extent(axis) > extent(best) { axis } else { best });
        let centre = |i: u32| boxes[i as usize][0][axis] + boxes[i as usize][1][axis];
        let half = items.len() / 2;
        items.select_nth_unstable_by(half, |&i, &j| centre(i).total_cmp(&centre(j)));
        self.nodes.push(Node { bounds, kind: Kind::Inner(0) });
        self.build(boxes, first, first + half);
        self.nodes[node].kind = Kind::Inner(self.nodes.len() as u32);
        self.build(boxes, first + half, last);
    }

    /// The nearest item: `measure` gives the square of an item's distance. Only items nearer than `bound` (a squared
    /// distance) are looked for: none if there is none.
    pub fn nearest(&self, p: Vec3, mut bound: f64, mut measure: impl FnMut(u32) -> f64) -> Option<u32> {
        // The tree halves its items, so 64 levels suffice for any 32-bit count.
        let mut stack = [(0u32, 0.0f64); 64];
        let mut depth = 0;
        let mut best = None;
        if let Some(root) = self.nodes.first() {
            stack[0] = (0, distance2(&root.bounds, p));
            depth = 1;
        }
        while depth > 0 {
            depth -= 1;
            let (node, distance) = stack[depth];
            if distance >= bound {
                continue;
            }
            match self.nodes[node as usize].kind {
                Kind::Leaf(first, last) => {
                    for &item in &self.items[first as usize..last as usize] {
                        let distance = measure(item);
                        if distance < bound {
                            (bound, best) = (distance, Some(item));
                        }
                    }
                }
                Kind::Inner(right) => {
                    let mut children = [node + 1, right].map(|c| (c, distance2(&self.nodes[c as usize].bounds, p)));
                    if children[0].1 < children[1].1 {
                        children.swap(0, 1);
                    }
                    stack[depth] = children[0];
                    stack[depth + 1] = children[1];
                    depth += 2;
                }
            }
        }
        best
    }
}
