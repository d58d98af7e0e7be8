//! The ring about an edge, and the best way to fill it with triangles.
//!
//! Each triangle (i, k, j) of ring vertices stands for two tetrahedra, one on each end of the edge. Dynamic programming over the polygon
//! (Klincsek 1980; Shewchuk 2002) finds the best triangulation.
//!
//! All is done in one metric first, the mean of those at all vertices: in its unit space a mean ratio costs a few operations and no
//! exponential. Sums of 1/Q − 1 are within a few per cent of those in the tetrahedra's own metrics, and most rings have nothing to gain by
//! far more than that (docs/decisions/reconnection.md). So only what may gain is measured.
use super::criteria::{Criterion, mean_ratio_score};
use crate::adapt::core::ids::VertexId;
use crate::adapt::core::store::Store;
use crate::mesh::vector::{Vec3, cross, dot, sub};
use crate::metric::Sym3;
use crate::metric::batch::Batch;
use crate::metric::lanes::{LANES, Lanes};
use crate::metric::unit_space::{UnitSpace, inverse_mean_ratios};

/// Longest ring that is looked at.
pub const LONGEST_RING: usize = 7;

type Table<T> = [[T; LONGEST_RING]; LONGEST_RING];

/// Triangles of a ring of the greatest length.
const MOST_TRIANGLES: usize = LONGEST_RING * (LONGEST_RING - 1) * (LONGEST_RING - 2) / 6;

/// An estimate may be off by this share of the present score: one that misses what is wanted by less is measured.
const ESTIMATED_TO: f64 = 0.05;

/// Where the determinant of the mean metric is more than this times the geometric mean of those at the vertices, the metric varies too much
/// for estimates: about a curved wall its thin direction turns.
const VARIES: f64 = 1.2;

/// A triangle of the best triangulation.
#[derive(Clone, Copy)]
pub struct Filling {
    /// Its vertices, in the order of the ring.
    pub vertices: [VertexId; 3],
    /// The side of the interface that it is on.
    pub side: usize,
    /// Mean ratios of its tetrahedra, that at the second end of the edge first.
    pub ratios: [f64; 2],
}

/// A ring with its tables. Allocated once.
#[derive(Default)]
pub struct Ring {
    /// The two ends of the edge, then the ring.
    cavity: Vec<VertexId>,
    /// The ring as the two ends of the edge see it, in the unit space of the mean metric.
    seen: [[Vec3; 2]; LONGEST_RING],
    /// Whether one metric serves for all.
    is_even: bool,
    /// Six times the volumes of a triangle's two tetrahedra there, that at the first end first; by (i, j) and k.
    volumes: Table<[[f64; 2]; LONGEST_RING]>,
    /// Whether a triangle's two tetrahedra are positive, as bits of k by (i, j).
    positive: Table<u8>,
    /// Whether the polygon i..j can be filled.
    fillable: Table<bool>,
    /// The score of a triangle's two tetrahedra, by (i, j) and k.
    value: Table<[f64; LONGEST_RING]>,
    /// Best score of the polygon i..j, and its triangle's third vertex.
    score: Table<f64>,
    third: Table<usize>,
    /// Triangles that can be in a triangulation.
    possible: Vec<[usize; 3]>,
    /// Those of the best triangulation.
    best: Vec<Filling>,
    batch: Batch,
    /// The polygons to be filled, from their first to their last vertex: one, or two on both sides of an interface.
    polygons: [(usize, usize); 2],
    /// How many of them there are.
    sides: usize,
}

impl Ring {
    fn len(&self) -> usize {
        self.cavity.len() - 2
    }

    /// All vertices of the cavity.
    pub fn cavity(&self) -> &[VertexId] {
        &self.cavity
    }

    /// The triangles of the best triangulation, once it is measured.
    pub fn best(&self) -> &[Filling] {
        &self.best
    }

    /// Reads the ends of the edge and the ring. With an interface from the first vertex of the ring to the `across`-th, the polygons on both
    /// sides of it are filled. The second ends at the first vertex again, so the ring has at most [`LONGEST_RING`] − 1 vertices.
    pub fn fill(&mut self, store: &Store, ends: [VertexId; 2], ring: &[VertexId], across: Option<usize>) {
        self.cavity.clear();
        self.cavity.extend(ends);
        self.cavity.extend(ring);
        (self.polygons, self.sides) = match across {
            None => ([(0, ring.len() - 1), (0, 0)], 1),
            Some(middle) => {
                self.cavity.push(ring[0]);
                ([(0, middle), (middle, ring.len())], 2)
            }
        };
        self.straighten(store);
    }

    /// Brings the ring to the space in which the mean metric is the unit tensor, but for a factor.
    fn straighten(&mut self, store: &Store) {
        let (sum, trace) = self
            .cavity
            .iter()
            .fold((Sym3::ZERO, 0.0), |(sum, trace), &v| (sum.plus(store.metric(v)), trace + store.log(v).trace()));
        // A multiple of the mean, so that sizes of any magnitude can be computed with.
        let (share, scale) = (1.0 / self.cavity.len() as f64, 1.0 / sum.trace());
        let space = UnitSpace::of(&sum.times(scale));
        let geometric = (share / 3.0 * trace).exp() * scale / share;
        self.is_even = space.det() < VARIES * geometric.powi(3);
        let a = store.position(self.cavity[0]);
        let straight = |v: VertexId| space.vector(sub(store.position(v), a));
        let end = straight(self.cavity[1]);
        for (seen, &v) in self.seen.iter_mut().zip(&self.cavity[2..]) {
            let from_a = straight(v);
            *seen = [from_a, sub(from_a, end)];
        }
    }

    /// Whether a triangulation with positive tetrahedra (in floating point) may exist; lists the triangles that can be in one.
    pub fn is_feasible(&mut self) -> bool {
        // Most rings are of four or five: for these the compiler unrolls all loops.
        match self.len() {
            4 => self.can_be_filled(4),
            5 => self.can_be_filled(5),
            n => self.can_be_filled(n),
        }
    }

    #[inline(always)]
    fn can_be_filled(&mut self, n: usize) -> bool {
        let seen = &self.seen;
        for i in 0..n - 1 {
            self.fillable[i][i + 1] = true;
        }
        for width in 2..n {
            for i in 0..n - width {
                let j = i + width;
                let [of_a, of_b] = [0, 1].map(|end| cross(seen[i][end], seen[j][end]));
                self.positive[i][j] = 0;
                for k in (i + 1..j).filter(|&k| self.fillable[i][k] && self.fillable[k][j]) {
                    let volumes = [-dot(seen[k][0], of_a), dot(seen[k][1], of_b)];
                    self.volumes[i][j][k] = volumes;
                    self.positive[i][j] |= u8::from(volumes.iter().all(|&volume| volume > 0.0)) << k;
                }
                self.fillable[i][j] = self.positive[i][j] != 0;
            }
        }
        let all = self.polygons().iter().all(|&(i, j)| self.fillable[i][j]);
        if all {
            self.list_possible(n);
        }
        all
    }

    fn polygons(&self) -> &[(usize, usize)] {
        &self.polygons[..self.sides]
    }

    /// Lists the triangles that are in some triangulation of the whole ring.
    #[inline(always)]
    fn list_possible(&mut self, n: usize) {
        self.possible.clear();
        let mut reached = [[false; LONGEST_RING]; LONGEST_RING];
        self.polygons().iter().for_each(|&(i, j)| reached[i][j] = true);
        for width in (2..n).rev() {
            for i in 0..n - width {
                let j = i + width;
                if !reached[i][j] {
                    continue;
                }
                for k in (i + 1..j).filter(|k| self.positive[i][j] >> k & 1 == 1) {
                    reached[i][k] = true;
                    reached[k][j] = true;
                    self.possible.push([i, k, j]);
                }
            }
        }
        debug_assert!(self.possible.len() <= MOST_TRIANGLES);
    }

    /// Finds the best triangulation by mean ratios, in place of what scores `old`. Returns whether it may score more than `wanted`.
    pub fn is_promising(&mut self, store: &Store, old: f64, wanted: f64) -> bool {
        let score = match (self.is_even, self.len()) {
            (true, 4) => self.estimate(4),
            (true, 5) => self.estimate(5),
            (true, n) => self.estimate(n),
            (false, _) => {
                self.measure_possible(store);
                self.triangulate(Criterion::MeanRatio)
            }
        };
        score > wanted - ESTIMATED_TO * old.abs()
    }

    /// Scores the possible triangles in the mean metric, and finds the best triangulation. Returns its score.
    #[inline(always)]
    fn estimate(&mut self, n: usize) -> f64 {
        let (mut to_ends, mut between) = ([[0.0; 2]; LONGEST_RING], [[0.0; LONGEST_RING]; LONGEST_RING]);
        for i in 0..n {
            to_ends[i] = self.seen[i].map(|v| dot(v, v));
            for j in i + 1..n {
                let v = sub(self.seen[j][0], self.seen[i][0]);
                between[i][j] = dot(v, v);
            }
        }
        for some in self.possible.chunks(LANES / 2) {
            let (mut volumes, mut sums) = (Lanes::all(1.0), Lanes::all(1.0));
            for (which, &[i, k, j]) in some.iter().enumerate() {
                let sides = between[i][k] + between[k][j] + between[i][j];
                for end in 0..2 {
                    volumes.0[2 * which + end] = self.volumes[i][j][k][end];
                    sums.0[2 * which + end] = sides + to_ends[i][end] + to_ends[k][end] + to_ends[j][end];
                }
            }
            let inverse = inverse_mean_ratios(&volumes, &sums).0;
            for (which, &[i, k, j]) in some.iter().enumerate() {
                self.value[i][j][k] = 2.0 - inverse[2 * which] - inverse[2 * which + 1];
            }
        }
        self.triangulate_of(n, Criterion::MeanRatio)
    }

    /// Scores the possible triangles, each tetrahedron in its own metric.
    fn measure_possible(&mut self, store: &Store) {
        for some in self.possible.chunks(LANES / 2) {
            let faces = |which: usize| some[which.min(some.len() - 1)].map(|l| self.cavity[l + 2]);
            let ratios = mean_ratios(&mut self.batch, store, [self.cavity[0], self.cavity[1]], faces);
            for (&[i, k, j], ratios) in some.iter().zip(ratios) {
                self.value[i][j][k] = score_of(ratios);
            }
        }
    }

    /// Scores the possible triangles one by one, and finds the best triangulation. Returns its score.
    pub fn score_each(&mut self, criterion: Criterion, score: impl Fn([VertexId; 4], &[VertexId]) -> f64) -> f64 {
        let cavity = &self.cavity;
        for &[i, k, j] in &self.possible {
            let [x, y, z] = [i, k, j].map(|l| cavity[l + 2]);
            let ends = [score([x, y, z, cavity[1]], cavity), score([x, z, y, cavity[0]], cavity)];
            self.value[i][j][k] = criterion.join(ends[0], ends[1]);
        }
        self.triangulate(criterion)
    }

    /// Finds the best triangulation of scored triangles. Returns its score.
    fn triangulate(&mut self, criterion: Criterion) -> f64 {
        self.triangulate_of(self.len(), criterion)
    }

    #[inline(always)]
    fn triangulate_of(&mut self, n: usize, criterion: Criterion) -> f64 {
        for i in 0..n - 1 {
            self.score[i][i + 1] = criterion.nothing();
        }
        // Wide polygons were listed first.
        for width in 2..n {
            for i in 0..n - width {
                self.score[i][i + width] = f64::NEG_INFINITY;
            }
        }
        for &[i, k, j] in self.possible.iter().rev() {
            let sides = criterion.join(self.score[i][k], self.score[k][j]);
            let value = criterion.join(sides, self.value[i][j][k]);
            if value > self.score[i][j] {
                (self.score[i][j], self.third[i][j]) = (value, k);
            }
        }
        let found = self.polygons().iter().map(|&(i, j)| self.score[i][j]);
        found.fold(criterion.nothing(), |x, y| criterion.join(x, y))
    }

    /// Measures the mean ratios of the best triangulation, each in the metric of its tetrahedron. Returns its score by these.
    pub fn measure(&mut self, store: &Store) -> f64 {
        self.list_best();
        let mut score = 0.0;
        for some in self.best.chunks_mut(LANES / 2) {
            let faces = |which: usize| some[which.min(some.len() - 1)].vertices;
            let ratios = mean_ratios(&mut self.batch, store, [self.cavity[0], self.cavity[1]], faces);
            for (filling, ratios) in some.iter_mut().zip(ratios) {
                filling.ratios = ratios;
                score += score_of(ratios);
            }
        }
        score
    }

    /// Lists the triangles of the best triangulation.
    fn list_best(&mut self) {
        self.best.clear();
        for side in 0..self.sides {
            let mut open = [(0, 0); LONGEST_RING];
            let mut depth = 1;
            open[0] = self.polygons[side];
            while depth > 0 {
                depth -= 1;
                let (i, j) = open[depth];
                if j - i < 2 {
                    continue;
                }
                let k = self.third[i][j];
                let vertices = [i, k, j].map(|l| self.cavity[l + 2]);
                self.best.push(Filling { vertices, side, ratios: [0.0; 2] });
                open[depth] = (i, k);
                open[depth + 1] = (k, j);
                depth += 2;
            }
        }
    }
}

/// The score of a triangle by the mean ratios of its two tetrahedra.
fn score_of(ratios: [f64; 2]) -> f64 {
    ratios.into_iter().map(mean_ratio_score).sum()
}

/// Mean ratios of the tetrahedra of four triangles, in their own metrics: those at the second end of the edge first.
fn mean_ratios(
    batch: &mut Batch,
    store: &Store,
    ends: [VertexId; 2],
    triangle: impl Fn(usize) -> [VertexId; 3],
) -> [[f64; 2]; LANES / 2] {
    for which in 0..LANES / 2 {
        let face = triangle(which);
        let ([x, y, z], logs) = (face.map(|v| store.position(v)), store.log_sum(face));
        batch.set_with_sum(2 * which, [x, y, z], &logs);
        batch.set_with_sum(2 * which + 1, [x, z, y], &logs);
    }
    batch.prepare();
    let [a, b] = ends.map(|v| (store.position(v), store.log(v)));
    let in_turn =
        |second: f64, first: f64| Lanes(std::array::from_fn(|lane| if lane % 2 == 0 { second } else { first }));
    let apex = std::array::from_fn(|i| in_turn(b.0[i], a.0[i]));
    let log = std::array::from_fn(|i| in_turn(b.1.0[i], a.1.0[i]));
    let q = batch.shapes_each(&apex, &log).mean_ratios();
    std::array::from_fn(|which| [q[2 * which], q[2 * which + 1]])
}

#[cfg(test)]
mod tests;
