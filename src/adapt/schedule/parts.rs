//! The mesh in parts for one round of the deterministic scheduler: half-spaces cut the items in halves, again and again.
//!
//! The cuts depend on the mesh and the items alone. Of several directions the one whose cut crosses the fewest tetrahedra is taken. So a
//! cut runs along a boundary layer and not across it; and in a later round, whose items lie beside the cuts of the last, across those.
use super::Item;
use crate::adapt::core::ids::VertexId;
use crate::adapt::core::store::Store;
use crate::mesh::vector::{Vec3, dot};

/// The normals that are tried for a cut.
const DIRECTIONS: [Vec3; 9] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 0.0, 1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, 1.0],
    [0.0, 1.0, -1.0],
];

/// How many items a part are sampled to find the cuts.
const SAMPLED: usize = 32;

/// A cut. A point is on the second side when its coordinate along the direction is above `offset`.
#[derive(Clone, Copy, Default)]
struct Cut {
    direction: usize,
    offset: f64,
}

/// Parts by a binary tree of cuts.
pub struct Parts {
    /// The cut of node i; its sides are nodes 2i + 1 and 2i + 2.
    cuts: Vec<Cut>,
}

/// A sampled item: along each direction the coordinate of its vertex, and the extent of a tetrahedron there.
struct Sample {
    at: [f64; DIRECTIONS.len()],
    extent: [[f64; 2]; DIRECTIONS.len()],
}

impl Sample {
    fn of(store: &Store, v: VertexId) -> Self {
        let corners = store.vertices(store.tet_of(v)).map(|x| store.position(x));
        let along = |d: &Vec3| corners.map(|p| dot(p, *d));
        let extent = DIRECTIONS
            .map(|d| along(&d).into_iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], x| [x.min(l), x.max(h)]));
        Self { at: DIRECTIONS.map(|d| dot(store.position(v), d)), extent }
    }
}

impl Parts {
    /// Cuts the items into `count` parts, a power of two.
    pub fn of<I: Item>(store: &Store, items: impl ExactSizeIterator<Item = I>, count: usize) -> Self {
        let stride = items.len().div_ceil(SAMPLED * count).max(1);
        let vertices = items.step_by(stride).map(|item| item.vertices(store)[0]);
        let samples: Vec<_> =
            vertices.filter(|&v| v.is_some() && store.is_vertex(v)).map(|v| Sample::of(store, v)).collect();
        let mut cuts = vec![Cut::default(); count - 1];
        let mut order: Vec<u32> = (0..samples.len() as u32).collect();
        cut(&samples, &mut order, &mut cuts, 0);
        Self { cuts }
    }

    /// The parts in which points lie. Several at a time, so that the processor works on them side by side.
    #[inline]
    pub fn hold<const N: usize>(&self, points: [Vec3; N]) -> [usize; N] {
        let mut nodes = [0; N];
        for _ in 0..(self.cuts.len() + 1).ilog2() {
            for (node, p) in nodes.iter_mut().zip(points) {
                let cut = self.cuts[*node];
                *node = 2 * *node + 1 + usize::from(dot(p, DIRECTIONS[cut.direction]) > cut.offset);
            }
        }
        nodes.map(|node| node - self.cuts.len())
    }
}

/// Finds the cut of one node and of those below it.
fn cut(samples: &[Sample], order: &mut [u32], cuts: &mut [Cut], node: usize) {
    if node >= cuts.len() || order.is_empty() {
        return;
    }
    let middle = order.len() / 2;
    let mut best = (usize::MAX, Cut::default());
    for direction in 0..DIRECTIONS.len() {
        let offset = halve(samples, order, direction);
        let crossed = |s: &&u32| {
            let [low, high] = samples[**s as usize].extent[direction];
            low <= offset && offset < high
        };
        let crossings = order.iter().filter(crossed).count();
        if crossings < best.0 {
            best = (crossings, Cut { direction, offset });
        }
    }
    cuts[node] = best.1;
    halve(samples, order, best.1.direction);
    let (below, above) = order.split_at_mut(middle);
    cut(samples, below, cuts, 2 * node + 1);
    cut(samples, above, cuts, 2 * node + 2);
}

/// Brings the half with lesser coordinates along a direction to the front. Returns where the other half begins.
fn halve(samples: &[Sample], order: &mut [u32], direction: usize) -> f64 {
    let at = |s: &u32| samples[*s as usize].at[direction];
    let middle = order.len() / 2;
    let (_, middle, _) = order.select_nth_unstable_by(middle, |x, y| at(x).total_cmp(&at(y)).then(x.cmp(y)));
    at(middle)
}
