//! The ring about an edge, and the best way to fill it with triangles.
//!
//! Each triangle (i, k, j) of ring vertices stands for two tetrahedra, one on each end of the edge. Dynamic programming over the polygon
//! (Klincsek 1980; Shewchuk 2002) finds the best triangulation. Volumes come first: most rings have no
//! triangulation of positive tetrahedra at all, and of the others only the triangles that can be part of one are measured.
use super::criteria::{Criterion, mean_ratio_score};
use crate::adapt::core::ids::VertexId;
use crate::adapt::core::store::Store;
use crate::mesh::vector::{Vec3, volume6};
use crate::metric::Sym3;
use crate::metric::batch::Batch;
use crate::metric::lanes::LANES;

/// Longest ring that is looked at.
pub const LONGEST_RING: usize = 7;

type Table<T> = [[T; LONGEST_RING]; LONGEST_RING];

/// Triangles of a ring of the greatest length.
const MOST_TRIANGLES: usize = LONGEST_RING * (LONGEST_RING - 1) * (LONGEST_RING - 2) / 6;

/// A ring with its tables. Allocated once.
#[derive(Default)]
pub struct Ring {
    /// The two ends of the edge, then the ring.
    cavity: Vec<VertexId>,
    points: Vec<Vec3>,
    logs: Vec<Sym3>,
    /// Whether a triangle's two tetrahedra are positive, as bits of k by (i, j).
    positive: Table<u8>,
    /// Whether the polygon i..j can be filled.
    fillable: Table<bool>,
    /// The score of a triangle's two tetrahedra, by (i, j) and k.
    value: Table<[f64; LONGEST_RING]>,
    /// Mean ratios of a triangle's two tetrahedra, that at the second end of the edge first; by (i, j) and k.
    ratios: Table<[[f64; 2]; LONGEST_RING]>,
    /// Best score of the polygon i..j, and its triangle's third vertex.
    score: Table<f64>,
    third: Table<usize>,
    /// Triangles to be measured.
    wanted: Vec<[usize; 3]>,
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
        self.points.clear();
        self.points.extend(self.cavity.iter().map(|&v| store.position(v)));
        self.logs.clear();
        self.logs.extend(self.cavity.iter().map(|&v| store.log(v)));
    }

    /// Whether a triangulation with positive tetrahedra (in floating point) may exist; lists the triangles that can be in one.
    pub fn is_feasible(&mut self) -> bool {
        let n = self.len();
        let [a, b] = [self.points[0], self.points[1]];
        for i in 0..n - 1 {
            self.fillable[i][i + 1] = true;
        }
        for width in 2..n {
            for i in 0..n - width {
                let j = i + width;
                self.positive[i][j] = 0;
                for k in (i + 1..j).filter(|&k| self.fillable[i][k] && self.fillable[k][j]) {
                    let [x, y, z] = [i, k, j].map(|l| self.points[l + 2]);
                    if volume6(x, y, z, b) > 0.0 && volume6(x, z, y, a) > 0.0 {
                        self.positive[i][j] |= 1 << k;
                    }
                }
                self.fillable[i][j] = self.positive[i][j] != 0;
            }
        }
        let all = self.polygons().iter().all(|&(i, j)| self.fillable[i][j]);
        if all {
            self.list_wanted();
        }
        all
    }

    fn polygons(&self) -> &[(usize, usize)] {
        &self.polygons[..self.sides]
    }

    /// Lists the triangles that are in some triangulation of the whole ring.
    fn list_wanted(&mut self) {
        self.wanted.clear();
        let n = self.len();
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
                    self.wanted.push([i, k, j]);
                }
            }
        }
        debug_assert!(self.wanted.len() <= MOST_TRIANGLES);
    }

    /// Scores the listed triangles by the mean ratio, two at a time.
    pub fn score_mean_ratios(&mut self) {
        for two in self.wanted.chunks(LANES / 2) {
            let mut apex = [[0.0; 3]; LANES];
            let mut log = [Sym3::ZERO; LANES];
            for lane in 0..LANES {
                let [i, k, j] = two[(lane / 2).min(two.len() - 1)].map(|l| l + 2);
                let (face, end) = if lane % 2 == 0 { ([i, k, j], 1) } else { ([i, j, k], 0) };
                let logs = face.map(|l| &self.logs[l]);
                self.batch.set(lane, face.map(|l| self.points[l]), logs);
                (apex[lane], log[lane]) = (self.points[end], self.logs[end]);
            }
            self.batch.prepare();
            let q = self.batch.shapes_of(&apex, &log).mean_ratios();
            for (which, &[i, k, j]) in two.iter().enumerate() {
                let ratios = [q[2 * which], q[2 * which + 1]];
                self.ratios[i][j][k] = ratios;
                self.value[i][j][k] = mean_ratio_score(ratios[0]) + mean_ratio_score(ratios[1]);
            }
        }
    }

    /// Scores the listed triangles one by one.
    pub fn score_each(&mut self, criterion: Criterion, score: impl Fn([VertexId; 4], &[VertexId]) -> f64) {
        let cavity = &self.cavity;
        for &[i, k, j] in &self.wanted {
            let [x, y, z] = [i, k, j].map(|l| cavity[l + 2]);
            let ends = [score([x, y, z, cavity[1]], cavity), score([x, z, y, cavity[0]], cavity)];
            self.value[i][j][k] = criterion.join(ends[0], ends[1]);
        }
    }

    /// Finds the best triangulation of scored triangles. Returns whether it scores more than `wanted`.
    pub fn triangulate(&mut self, criterion: Criterion, wanted: f64) -> bool {
        let n = self.len();
        for i in 0..n - 1 {
            self.score[i][i + 1] = criterion.nothing();
        }
        // Wide polygons were listed first.
        for width in 2..n {
            for i in 0..n - width {
                self.score[i][i + width] = f64::NEG_INFINITY;
            }
        }
        for &[i, k, j] in self.wanted.iter().rev() {
            let sides = criterion.join(self.score[i][k], self.score[k][j]);
            let value = criterion.join(sides, self.value[i][j][k]);
            if value > self.score[i][j] {
                (self.score[i][j], self.third[i][j]) = (value, k);
            }
        }
        let found = self.polygons().iter().map(|&(i, j)| self.score[i][j]);
        found.fold(criterion.nothing(), |x, y| criterion.join(x, y)) > wanted
    }

    /// The triangles of the triangulation found, in the order of the ring, each with the side of the interface that it is on and the mean ratios
    /// of its tetrahedra, that at the second end of the edge first, as [`Ring::score_mean_ratios`] found them.
    pub fn each_triangle(&self, mut take: impl FnMut([VertexId; 3], usize, [f64; 2])) {
        for (side, &polygon) in self.polygons().iter().enumerate() {
            let mut open = [(0, 0); LONGEST_RING];
            let mut depth = 1;
            open[0] = polygon;
            while depth > 0 {
                depth -= 1;
                let (i, j) = open[depth];
                if j - i < 2 {
                    continue;
                }
                let k = self.third[i][j];
                take([i, k, j].map(|l| self.cavity[l + 2]), side, self.ratios[i][j][k]);
                open[depth] = (i, k);
                open[depth + 1] = (k, j);
                depth += 2;
            }
        }
    }
}
