//! The ball of a vertex laid out for trying other places for it: the energy that smoothing lowers.
//!
//! E = Σ 1/Q³ over the tetrahedra + Σ ((L − 1/L)/2)² over the edges at the vertex. The second is sinh² ln L: 0 at unit length, the same for
//! twice and for half of it.
use super::ids::{FACE, TetId, VertexId};
use super::store::Store;
use crate::mesh::vector::{Vec3, add, lerp, scale};
use crate::metric::Sym3;
use crate::metric::batch::{Batch, Shapes, Spokes};
use crate::metric::lanes::{LANES, Lanes};

/// Length in the metric of the step down the gradient.
const STEP: f64 = 0.3;

/// Q³ at least, where a tetrahedron that is nearly flat would make the energy blind for all others.
const LEAST_CUBE: f64 = 1e-18;

/// A vertex with the triangles opposite to it and the vertices joined to it. Allocated once.
#[derive(Default)]
pub struct Fan {
    batches: Vec<Batch>,
    spokes: Vec<Spokes>,
    tets: usize,
    ends: usize,
    /// Q³ at the place that was tried last.
    cubes: Vec<Lanes>,
    /// Part of the energy of the shapes there.
    energy: f64,
}

#[inline(always)]
fn misfit(length: f64) -> f64 {
    let difference = length - 1.0 / length;
    0.25 * difference * difference
}

impl Fan {
    /// Lays out the ball of v: its tetrahedra, and the vertices joined to it.
    pub fn fill(&mut self, store: &Store, v: VertexId, ball: &[TetId], link: &[VertexId]) {
        (self.tets, self.ends) = (ball.len(), link.len());
        self.batches.resize_with(ball.len().div_ceil(LANES), Batch::default);
        for (some, batch) in ball.chunks(LANES).zip(&mut self.batches) {
            for lane in 0..LANES {
                let w = store.vertices(some[lane.min(some.len() - 1)]);
                let i = w.iter().position(|&x| x == v).expect("the ball holds its vertex");
                let face = FACE[i].map(|k| w[k]);
                let logs = face.map(|x| store.log(x));
                batch.set(lane, face.map(|x| store.position(x)), [&logs[0], &logs[1], &logs[2]]);
            }
            batch.prepare();
        }
        self.spokes.resize_with(link.len().div_ceil(LANES), Spokes::default);
        for (some, spokes) in link.chunks(LANES).zip(&mut self.spokes) {
            for lane in 0..LANES {
                let x = some[lane.min(some.len() - 1)];
                spokes.set(lane, store.position(x), &store.metric(x));
            }
        }
    }

    /// The energy with the vertex at p, of metric M there; and the place that the lengths ask for: the mean of the points that have
    /// unit distance from the neighbours, in the direction of p (pliant).
    pub fn present(&mut self, p: Vec3, log: &Sym3, metric: &Sym3) -> (f64, Vec3) {
        self.falls_below(f64::INFINITY, p, log);
        let mut sum = [0.0; 3];
        let mut energy = self.energy;
        for (first, spokes) in (0..self.ends).step_by(LANES).zip(&self.spokes) {
            let lengths = spokes.lengths(p, metric);
            for lane in 0..LANES.min(self.ends - first) {
                energy += misfit(lengths[lane]);
                sum = add(sum, lerp(spokes.end(lane), p, 1.0 / lengths[lane].max(0.1)));
            }
        }
        (energy, scale(sum, 1.0 / self.ends as f64))
    }

    /// Whether the shapes' part of the energy is below the limit with the vertex at p: no tetrahedron is inverted then (exact).
    /// Without a limit flat tetrahedra count as all but flat.
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

    /// Whether the energy is below the limit, after [`Fan::falls_below`] at the same place.
    pub fn lengths_allow(&self, limit: f64, p: Vec3, metric: &Sym3) -> bool {
        let mut energy = self.energy;
        for (first, spokes) in (0..self.ends).step_by(LANES).zip(&self.spokes) {
            let lengths = spokes.lengths(p, metric);
            energy += lengths.iter().take(self.ends - first).map(|&length| misfit(length)).sum::<f64>();
        }
        energy < limit
    }

    /// Mean ratios at the place that was tried last, in the order of the ball.
    pub fn mean_ratios(&self) -> impl Iterator<Item = f64> + '_ {
        self.cubes.iter().flat_map(|&cubes| Shapes { cubes }.mean_ratios()).take(self.tets)
    }

    /// A step down the gradient of the shapes' energy: M⁻¹∇E, after [`Fan::present`] at the same place.
    pub fn downhill(&mut self, p: Vec3, log: &Sym3, metric: &Sym3) -> Vec3 {
        self.falls_below(f64::INFINITY, p, log);
        let mut gradient = [0.0; 3];
        for ((first, batch), cubes) in (0..self.tets).step_by(LANES).zip(&self.batches).zip(&self.cubes) {
            gradient = add(gradient, batch.pull(p, log, cubes, LANES.min(self.tets - first)));
        }
        // The pull is up the quality.
        let step = metric.inverse().apply(gradient);
        let length = metric.quadratic(step).sqrt();
        add(p, scale(step, if length > 0.0 { STEP / length } else { 0.0 }))
    }
}
