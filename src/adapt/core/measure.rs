//! Length, orientation and shape of what is in the store.
use super::access::Access;
use super::ids::VertexId;
use super::store::Store;
use super::worker::Worker;
use crate::mesh::predicate::is_positive;
use crate::mesh::vector::{sub, volume6};
use crate::metric::lanes::{LANES, Lanes, exponentials};
use crate::metric::quality::{edge_length, mean_length, mean_ratio};
use crate::tasks::{GRAIN, Team};

/// Complexity of a metric on the mesh as it is: Σ √det M̄ |k| over the tetrahedra, where (det M̄)^(−1/6), the mean size, is the mean of those at the
/// vertices, nearly as sizes are between them; `trace` is that of ln M at a vertex. Only each `step`-th tetrahedron is asked, for all.
pub fn complexity(team: Team<'_>, store: &Store, step: usize, trace: impl Fn(VertexId) -> f64 + Sync) -> f64 {
    step as f64
        * team.sum(GRAIN, store.tet_bound(), |range| {
            // Several at a time: the exponential function takes most of the time.
            let (mut tets, mut sum) = (store.live_tets_each(range, step).fuse(), 0.0);
            loop {
                let (mut logs, mut volumes) = ([Lanes::ZERO; 4], [0.0; LANES]);
                let mut count = 0;
                for (lane, t) in (0..LANES).zip(&mut tets) {
                    let vertices = store.vertices(t);
                    let [a, b, c, d] = vertices.map(|v| store.position(v));
                    for (logs, v) in logs.iter_mut().zip(vertices) {
                        logs.0[lane] = trace(v) / -6.0;
                    }
                    volumes[lane] = volume6(a, b, c, d) / 6.0;
                    count += 1;
                }
                if count == 0 {
                    return sum;
                }
                let sizes = logs.map(|logs| exponentials(&logs).0);
                sum += (0..count)
                    .map(|lane| {
                        let size = 0.25 * sizes.iter().map(|sizes| sizes[lane]).sum::<f64>();
                        volumes[lane] / (size * size * size)
                    })
                    .sum::<f64>();
            }
        })
}

/// Whether an edge whose squared lengths in the metrics of its ends are given is longer than the limit.
#[inline(always)]
pub fn is_longer(a: f64, b: f64, limit: f64) -> bool {
    let square = limit * limit;
    match (a > square, b > square) {
        (true, true) => true,
        (false, false) => false,
        _ => mean_length(a.sqrt(), b.sqrt()) > limit,
    }
}

/// As [`is_longer`], whether it is shorter.
#[inline(always)]
pub fn is_shorter(a: f64, b: f64, limit: f64) -> bool {
    let square = limit * limit;
    match (a < square, b < square) {
        (true, true) => true,
        (false, false) => false,
        _ => mean_length(a.sqrt(), b.sqrt()) < limit,
    }
}

impl<A: Access> Worker<'_, '_, A> {
    /// Length of the edge in the metric.
    #[inline]
    pub fn length(&self, a: VertexId, b: VertexId) -> f64 {
        let v = sub(self.store.position(b), self.store.position(a));
        edge_length(v, &self.store.metric(a), &self.store.metric(b))
    }

    /// Whether the edge is longer than the limit. Its length lies between those in the metrics of its ends, so most edges need neither
    /// a root nor a logarithm.
    #[inline]
    pub fn is_longer(&self, a: VertexId, b: VertexId, limit: f64) -> bool {
        let v = sub(self.store.position(b), self.store.position(a));
        is_longer(self.store.metric(a).quadratic(v), self.store.metric(b).quadratic(v), limit)
    }

    /// Whether the edge is shorter than the limit.
    #[inline]
    pub fn is_shorter(&self, a: VertexId, b: VertexId, limit: f64) -> bool {
        let v = sub(self.store.position(b), self.store.position(a));
        is_shorter(self.store.metric(a).quadratic(v), self.store.metric(b).quadratic(v), limit)
    }

    /// Mean ratio of the tetrahedron that the vertices make; at most 0 when it is not positive (exact).
    #[inline]
    pub fn shape(&self, vertices: [VertexId; 4]) -> f64 {
        let points = vertices.map(|v| self.store.position(v));
        if !is_positive(points) {
            return 0.0;
        }
        let logs = vertices.map(|v| self.store.log(v));
        mean_ratio(points, [&logs[0], &logs[1], &logs[2], &logs[3]])
    }
}
