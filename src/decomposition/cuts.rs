//! Where a mesh is cut: planes that share the work evenly and cross few tetrahedra.
use super::piece::Piece;
use crate::mesh::vector::{Vec3, volume6};

/// A tetrahedron at a former cut counts as so many where it is crossed: cuts move to where none was.
const FORMER_CUT: f64 = 8.0;

/// A cut between two parts leaves each its share of the work, within this share of both; one that others follow is so much nearer to its share.
const SLACK: f64 = 0.06;

/// So many places are tried for a cut, along each axis.
const PLACES: usize = 24;

/// Vertices for a unit of complexity.
const VERTICES_PER_COMPLEXITY: f64 = 1.9;

/// A tetrahedron that is there already is as much work as so many vertices that are made.
const WORK_OF_GIVEN: f64 = 0.03;

/// A tetrahedron that stands for several.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Sample {
    /// Its box.
    low: Vec3,
    high: Vec3,
    centre: Vec3,
    /// Of the tetrahedra that it stands for.
    work: f64,
    /// How many it stands for.
    count: f64,
    /// 1 where it is at a former cut, else 0.
    waits: u64,
}

impl Sample {
    /// The box of some.
    pub fn box_of(samples: &[Self]) -> [Vec3; 2] {
        let over = |f: fn(f64, f64) -> f64, none: f64, corner: fn(&Self) -> Vec3| {
            samples.iter().map(corner).fold([none; 3], |a, b| [0, 1, 2].map(|k| f(a[k], b[k])))
        };
        [over(f64::min, f64::INFINITY, |sample| sample.low), over(f64::max, f64::NEG_INFINITY, |sample| sample.high)]
    }
}

/// At most so many tetrahedra of a piece, evenly spread over its list.
pub fn samples(piece: &Piece, most: usize) -> Vec<Sample> {
    let step = piece.len().div_ceil(most.max(1)).max(1);
    let count = step as f64;
    (0..piece.len())
        .step_by(step)
        .map(|t| {
            let nodes = piece.mesh.tets.nodes[t];
            let [a, b, c, d] = nodes.map(|v| piece.mesh.vertices[v as usize]);
            let trace: f64 = nodes.iter().map(|&v| piece.logs[v as usize].trace()).sum();
            let complexity = volume6(a, b, c, d) / 6.0 * (trace / 8.0).exp();
            let over = |f: fn(f64, f64) -> f64| [0, 1, 2].map(|k| f(f(a[k], b[k]), f(c[k], d[k])));
            Sample {
                low: over(f64::min),
                high: over(f64::max),
                centre: centre(piece, t),
                work: count * (VERTICES_PER_COMPLEXITY * complexity + WORK_OF_GIVEN),
                count,
                waits: u64::from(piece.waits(t)),
            }
        })
        .collect()
}

/// The centroid of a tetrahedron.
fn centre(piece: &Piece, t: usize) -> Vec3 {
    let [a, b, c, d] = piece.mesh.tets.nodes[t].map(|v| piece.mesh.vertices[v as usize]);
    [0, 1, 2].map(|k| 0.25 * ((a[k] + b[k]) + (c[k] + d[k])))
}

/// Where a mesh is cut into parts.
pub struct Cuts {
    /// The planes.
    pub tree: Tree,
    /// The work that each part is expected to be.
    pub work: Vec<f64>,
}

/// A tree of cuts. Its leaves are the parts.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Tree {
    /// A part.
    Part(u32),
    /// A plane across an axis: what lies below it, and the rest.
    Plane(usize, f64, Box<[Tree; 2]>),
}

impl Cuts {
    /// Into so many parts. Where the samples leave no choice, some parts have nothing. It is the same on any number of threads.
    pub fn of(mut samples: Vec<Sample>, parts: usize, threads: usize) -> Self {
        let parts = parts.max(1);
        let tree = Tree::of(&mut samples, 0, parts as u32, threads);
        let mut work = vec![0.0; parts];
        samples.iter().for_each(|sample| work[tree.part_at(sample.centre) as usize] += sample.work);
        Self { tree, work }
    }

    /// The box of each part, of what lies in this one.
    pub fn boxes(&self, whole: [Vec3; 2]) -> Vec<[Vec3; 2]> {
        let mut boxes = vec![whole; self.work.len()];
        self.tree.put_boxes(whole, &mut boxes);
        boxes
    }

    /// The part of each tetrahedron: that in which its centroid lies.
    pub fn owners(&self, piece: &Piece) -> Vec<u32> {
        (0..piece.len()).map(|t| self.tree.part_at(centre(piece, t))).collect()
    }
}

impl Tree {
    fn of(samples: &mut [Sample], first: u32, parts: u32, threads: usize) -> Self {
        let half = parts / 2;
        if half == 0 {
            return Self::Part(first);
        }
        let slack = SLACK / f64::from(parts).log2();
        let Some((axis, at)) = best_cut(samples, (f64::from(half) / f64::from(parts), slack), threads) else {
            return Self::Part(first);
        };
        samples.sort_by_key(|sample| sample.centre[axis] >= at);
        let middle = samples.partition_point(|sample| sample.centre[axis] < at);
        let (below, above) = samples.split_at_mut(middle);
        let below = |threads| Self::of(below, first, half, threads);
        let above = |threads| Self::of(above, first + half, parts - half, threads);
        let sides = at_once(threads, below, above);
        Self::Plane(axis, at, Box::new(sides))
    }

    fn put_boxes(&self, own: [Vec3; 2], boxes: &mut [[Vec3; 2]]) {
        match self {
            Self::Part(part) => boxes[*part as usize] = own,
            Self::Plane(axis, at, sides) => {
                let [mut below, mut above] = [own, own];
                below[1][*axis] = at.clamp(own[0][*axis], own[1][*axis]);
                above[0][*axis] = below[1][*axis];
                sides[0].put_boxes(below, boxes);
                sides[1].put_boxes(above, boxes);
            }
        }
    }

    /// Whether a point is no farther than this, along each axis, from one of the planes that bound its part.
    pub fn is_near(&self, p: Vec3, reach: Vec3) -> bool {
        match self {
            Self::Part(_) => false,
            Self::Plane(axis, at, sides) => {
                let above = p[*axis] - at;
                above.abs() <= reach[*axis] || sides[usize::from(above >= 0.0)].is_near(p, reach)
            }
        }
    }

    fn part_at(&self, p: Vec3) -> u32 {
        let mut here = self;
        loop {
            match here {
                Self::Part(part) => return *part,
                Self::Plane(axis, at, sides) => here = &sides[usize::from(p[*axis] >= *at)],
            }
        }
    }
}

/// The plane that crosses the fewest tetrahedra of those that leave this share of the work below, within the slack, or where there is none such
/// the nearest to that share; none where all samples are at one place.
fn best_cut(samples: &[Sample], share: (f64, f64), threads: usize) -> Option<(usize, f64)> {
    let best = |axis: usize| {
        let mut order: Vec<_> = samples.iter().map(|sample| (sample.centre[axis], sample.work)).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let (excess, places) = places(&order, share);
        let crossed = crossed(samples, axis, &places);
        let cuts = places.into_iter().zip(crossed).map(|(at, crossed)| ([excess, crossed], (axis, at)));
        cuts.reduce(|best, cut| if cut.0 < best.0 { cut } else { best })
    };
    let [x, yz] = at_once(threads, |_| [best(0), None], |threads| at_once(threads, |_| best(1), |_| best(2)));
    let found = [x, yz].into_iter().flatten().flatten();
    found.reduce(|best, cut| if cut.0 < best.0 { cut } else { best }).map(|(_, cut)| cut)
}

/// The results of both, on as many threads as they are told they have.
fn at_once<T: Send>(threads: usize, a: impl FnOnce(usize) -> T + Send, b: impl FnOnce(usize) -> T) -> [T; 2] {
    let half = threads / 2;
    if half == 0 {
        return [a(1), b(1)];
    }
    std::thread::scope(|scope| {
        let a = scope.spawn(move || a(half));
        let b = b(threads - half);
        [a.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)), b]
    })
}

/// Places for a cut, ascending, and how much farther they are from the share than they should be. `order` has the places and the work of the
/// samples, ascending.
fn places(order: &[(f64, f64)], (share, slack): (f64, f64)) -> (f64, Vec<f64>) {
    let all: f64 = order.iter().map(|sample| sample.1).sum();
    let (mut below, mut last) = (0.0, order.first().map_or(0.0, |first| first.0));
    let (mut window, mut nearest) = (Vec::new(), None);
    for &(at, work) in order {
        // What has its centre at the cut lies above.
        if at > last {
            let off = f64::abs(below / all - share);
            if off <= slack {
                window.push(at);
            } else if nearest.is_none_or(|(least, _)| off < least) {
                nearest = Some((off, at));
            }
            last = at;
        }
        below += work;
    }
    if window.is_empty() {
        return nearest.map_or((0.0, Vec::new()), |(off, at)| (off - slack, vec![at]));
    }
    let step = window.len().div_ceil(PLACES);
    (0.0, window.into_iter().skip(step / 2).step_by(step).collect())
}

/// What a cut at each of these places, which ascend, would cross.
fn crossed(samples: &[Sample], axis: usize, places: &[f64]) -> Vec<f64> {
    // What begins and ends to be crossed, from place to place. All are whole numbers, so the sums are exact.
    let mut change = vec![0.0; places.len() + 1];
    for sample in samples {
        let first = places.partition_point(|&at| at <= sample.low[axis]);
        let end = places.partition_point(|&at| at < sample.high[axis]);
        if first < end {
            let cost = sample.count * if sample.waits == 1 { FORMER_CUT } else { 1.0 };
            change[first] += cost;
            change[end] -= cost;
        }
    }
    let mut sum = 0.0;
    let sums = change.iter().take(places.len()).map(|change| {
        sum += change;
        sum
    });
    sums.collect()
}
