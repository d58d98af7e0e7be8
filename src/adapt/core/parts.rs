//! The mesh in parts, one a task: half-spaces cut the items in halves, again and again.
//!
//! The cuts depend on the mesh and the items alone. Of several directions the one whose cut crosses the fewest tetrahedra is taken. So a
//! cut runs along a boundary layer and not across it; and in a later round, whose items lie beside the cuts of the last, across those.
use crate::mesh::vector::{Vec3, dot};
use crate::tasks::Team;

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

/// Samples that are taken in a task.
const FEW: usize = 64;

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

/// A sampled item: along each direction the coordinate of a vertex of it, and the extent of a tetrahedron there.
#[derive(Clone, Copy)]
pub struct Sample {
    at: [f64; DIRECTIONS.len()],
    extent: [[f64; 2]; DIRECTIONS.len()],
}

impl Sample {
    /// Of the position of a vertex and those of the corners of a tetrahedron at it.
    pub fn of(vertex: Vec3, corners: [Vec3; 4]) -> Self {
        let along = |d: &Vec3| corners.map(|p| dot(p, *d));
        let extent = DIRECTIONS
            .map(|d| along(&d).into_iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], x| [x.min(l), x.max(h)]));
        Self { at: DIRECTIONS.map(|d| dot(vertex, d)), extent }
    }
}

impl Parts {
    /// Cuts so many items into `count` parts, a power of two. `sample` gives the sample of an item, none where it is gone.
    pub fn of(team: Team<'_>, items: usize, count: usize, sample: impl Fn(usize) -> Option<Sample> + Sync) -> Self {
        let stride = items.div_ceil(SAMPLED * count).max(1);
        let samples: Vec<_> = team.collect(FEW, items.div_ceil(stride), |range, found| {
            found.extend(range.filter_map(|at| sample(at * stride)));
        });
        let mut cuts = Vec::with_capacity(count - 1);
        let mut order: Vec<u32> = (0..samples.len() as u32).collect();
        let mut nodes = vec![&mut order[..]];
        // Level by level, all directions of all nodes side by side.
        while cuts.len() + 1 < count {
            let trials = team.map(1, nodes.len() * DIRECTIONS.len(), |trial| {
                let (node, direction) = (trial / DIRECTIONS.len(), trial % DIRECTIONS.len());
                Trial::of(&samples, &*nodes[node], direction)
            });
            let best = trials.chunks(DIRECTIONS.len()).map(|trials| {
                let least = trials.iter().min_by_key(|trial| trial.crossings);
                least.map_or(Cut::default(), |trial| trial.cut)
            });
            let first = cuts.len();
            cuts.extend(best);
            let mut halves: Vec<_> = nodes.into_iter().zip(&cuts[first..]).collect();
            team.fill(1, &mut halves, |_, halves| {
                for (node, cut) in halves {
                    halve(&samples, node, cut.direction);
                }
            });
            nodes =
                halves.into_iter().flat_map(|(node, _)| <[_; 2]>::from(node.split_at_mut(node.len() / 2))).collect();
        }
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

/// A cut that is tried at one node.
#[derive(Clone, Copy)]
struct Trial {
    /// Sampled tetrahedra that it crosses.
    crossings: usize,
    cut: Cut,
}

impl Trial {
    /// The cut of some samples in halves along a direction.
    fn of(samples: &[Sample], node: &[u32], direction: usize) -> Self {
        let Some(offset) = halve(samples, &mut node.to_vec(), direction) else {
            return Self { crossings: 0, cut: Cut::default() };
        };
        let is_crossed = |s: &&u32| {
            let [low, high] = samples[**s as usize].extent[direction];
            low <= offset && offset < high
        };
        Self { crossings: node.iter().filter(is_crossed).count(), cut: Cut { direction, offset } }
    }
}

/// Brings the half with lesser coordinates along a direction to the front. Returns where the other half begins; none without samples.
fn halve(samples: &[Sample], node: &mut [u32], direction: usize) -> Option<f64> {
    let at = |s: &u32| samples[*s as usize].at[direction];
    let middle = node.len() / 2;
    if node.is_empty() {
        return None;
    }
    let (_, middle, _) = node.select_nth_unstable_by(middle, |x, y| at(x).total_cmp(&at(y)).then(x.cmp(y)));
    Some(at(middle))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapt::tests::bench::{Bench, Shape, sample};
    use crate::tasks::{Plan, Pool};

    /// The parts of all vertices, as they are found by so many threads.
    fn parts(threads: usize, count: usize) -> Vec<usize> {
        let sample = sample(Shape::Round, 6, 0.4);
        let bench = Bench::new(&sample, 1, 5);
        let (pool, store) = (Pool::new(threads).unwrap(), &bench.context.store);
        let vertices: Vec<_> = store.live_vertices().collect();
        let position = |v| store.position(v);
        let sample = |v| Sample::of(position(v), store.vertices(store.tet_of(v)).map(position));
        let team = Team::new(&pool, Plan::default());
        let parts = Parts::of(team, vertices.len(), count, |at| Some(sample(vertices[at])));
        vertices.iter().map(|&v| parts.hold([store.position(v)])[0]).collect()
    }

    #[test]
    fn parts_are_as_large_and_the_same_for_all_threads() {
        for count in [2, 8, 32] {
            let of_one = parts(1, count);
            for threads in [2, 3] {
                assert_eq!(parts(threads, count), of_one);
            }
            let mean = of_one.len() / count;
            let sizes: Vec<_> = (0..count).map(|part| of_one.iter().filter(|&&of| of == part).count()).collect();
            // Planes of the cube's vertices are on one side of a cut or the other.
            assert!(sizes.iter().all(|&size| size <= 3 * mean), "{count}: {sizes:?}");
        }
    }
}
