//! The ball of a vertex, laid out so that other places for the vertex are tried quickly, and the energy that smoothing lowers.
//!
//! E = Σ 1/Q³ over the tetrahedra + Σ ((L − 1/L)/2)² over the edges at the vertex. The second is sinh² ln L: 0 at unit length, the same for
//! twice and for half of it.
use crate::adapt::core::ids::{FACE, TetId, VertexId, place_of};
use crate::adapt::core::store::Store;
use crate::mesh::vector::{Vec3, add, lerp, scale};
use crate::metric::Sym3;
use crate::metric::batch::{Batch, IncidentEdges, Shapes};
use crate::metric::energy::{Energy, QuadraticModel, SHORTEST};
use crate::metric::lanes::{LANES, LaneSym3, Lanes};

/// Q³ counts as at least this. A tetrahedron that is nearly flat would else hide all others in the energy.
const LEAST_CUBE: f64 = 1e-18;

/// A vertex with the triangles opposite to it and the vertices joined to it. Allocated once.
#[derive(Default)]
pub struct SmoothingPatch {
    /// Surface triangles at the vertex (outward), with their tags.
    pub triangles: Vec<([VertexId; 3], u32)>,
    /// The worst mean ratio of the tetrahedra as they are.
    pub worst: f64,
    batches: Vec<Batch>,
    incident: Vec<IncidentEdges>,
    tets: usize,
    ends: usize,
    /// ΣM over the vertices of each triangle of the link.
    metrics: Vec<LaneSym3>,
    /// 1/Q³ of the tetrahedra as they are; 0 in lanes without one.
    kept: Vec<Lanes>,
    /// Q³ at the place that was tried last.
    cubes: Vec<Lanes>,
    /// The part of the energy that comes of the tetrahedra, there.
    energy: f64,
}

#[inline(always)]
fn misfit(length: f64) -> f64 {
    let difference = length - 1.0 / length;
    0.25 * difference * difference
}

impl SmoothingPatch {
    /// Lays out the ball of v: its tetrahedra, and the vertices joined to it.
    pub fn fill(&mut self, store: &Store, v: VertexId, ball: &[TetId], link: &[VertexId]) {
        (self.tets, self.ends) = (ball.len(), link.len());
        // They are not made again where the next ball is larger.
        while self.batches.len() * LANES < ball.len() {
            self.batches.push(Batch::default());
        }
        self.kept.clear();
        self.metrics.clear();
        for (some, batch) in ball.chunks(LANES).zip(&mut self.batches) {
            let mut kept = Lanes::ZERO;
            for (energy, &t) in kept.0.iter_mut().zip(some) {
                let q = store.quality(t);
                *energy = 1.0 / (q * q * q).max(LEAST_CUBE);
            }
            self.kept.push(kept);
            let mut metrics = [Lanes::ZERO; 6];
            for lane in 0..LANES {
                let w = store.vertices(some[lane.min(some.len() - 1)]);
                let face = FACE[place_of(v, w)].map(|k| w[k]);
                batch.set_with_sum(lane, face.map(|x| store.position(x)), &store.log_sum(face));
                let sum = store.metric_sum(face).0;
                (0..6).for_each(|i| metrics[i].0[lane] = sum[i]);
            }
            self.metrics.push(metrics);
            batch.prepare();
        }
        while self.incident.len() * LANES < link.len() {
            self.incident.push(IncidentEdges::default());
        }
        for (some, incident) in link.chunks(LANES).zip(&mut self.incident) {
            for lane in 0..LANES {
                let x = some[lane.min(some.len() - 1)];
                incident.set(lane, store.position(x), &store.metric(x));
            }
        }
    }

    /// The energy to second order about the vertex' place p; none where a tetrahedron is not positive (in floating point).
    pub fn model(&self, p: Vec3, metric: &Sym3) -> Option<QuadraticModel> {
        let mut sum = Energy::at(p, metric);
        for (first, incident) in (0..self.ends).step_by(LANES).zip(&self.incident) {
            sum.add_edges(incident, LANES.min(self.ends - first));
        }
        for ((batch, metrics), energies) in self.batches.iter().zip(&self.metrics).zip(&self.kept) {
            sum.add_tets(batch, metrics, energies);
        }
        sum.model()
    }

    /// The mean, over the neighbours, of the point at unit distance from each in the direction of p (pliant smoothing).
    pub fn pliant(&self, p: Vec3, metric: &Sym3) -> Vec3 {
        let mut sum = [0.0; 3];
        for (first, incident) in (0..self.ends).step_by(LANES).zip(&self.incident) {
            let lengths = incident.lengths(p, metric);
            for lane in 0..LANES.min(self.ends - first) {
                sum = add(sum, lerp(incident.end(lane), p, 1.0 / lengths[lane].max(SHORTEST)));
            }
        }
        scale(sum, 1.0 / self.ends as f64)
    }

    /// The energy with the vertex at p. Flat tetrahedra count as nearly flat.
    pub fn energy(&mut self, p: Vec3, log: &Sym3, metric: &Sym3) -> f64 {
        self.falls_below(f64::INFINITY, p, log);
        self.with_lengths(p, metric)
    }

    /// Whether the tetrahedra's part of the energy is below the limit with the vertex at p. If so, no tetrahedron is inverted (exact).
    /// With an infinite limit flat tetrahedra count as nearly flat.
    pub fn falls_below(&mut self, limit: f64, p: Vec3, log: &Sym3) -> bool {
        self.cubes.clear();
        self.energy = 0.0;
        for (first, batch) in (0..self.tets).step_by(LANES).zip(&self.batches) {
            let Shapes { cubes } = batch.shapes(p, log);
            for lane in 0..LANES.min(self.tets - first) {
                if limit.is_finite() && cubes.0[lane] <= 0.0 {
                    return false;
                }
                self.energy += 1.0 / cubes.0[lane].max(LEAST_CUBE);
            }
            if self.energy >= limit {
                return false;
            }
            self.cubes.push(cubes);
        }
        true
    }

    /// The whole energy, after [`SmoothingPatch::falls_below`] at the same place.
    pub fn with_lengths(&self, p: Vec3, metric: &Sym3) -> f64 {
        let mut energy = self.energy;
        for (first, incident) in (0..self.ends).step_by(LANES).zip(&self.incident) {
            let lengths = incident.lengths(p, metric);
            energy += lengths.iter().take(self.ends - first).map(|&length| misfit(length)).sum::<f64>();
        }
        energy
    }

    /// Mean ratios at the place that was tried last, in the order of the ball.
    pub fn mean_ratios(&self) -> impl Iterator<Item = f64> + '_ {
        self.cubes.iter().flat_map(|&cubes| Shapes { cubes }.mean_ratios()).take(self.tets)
    }
}
