//! The energy that smoothing lowers, to second order about a vertex: inner loop of smoothing.
//!
//! The metric of a tetrahedron is exp of the mean of ln M over its vertices. Here it is the mean of M, which needs no exponential and differs
//! in second order: that tells well enough where the energy is lowest. Whether the energy falls there is computed with the first.
use super::Sym3;
use super::batch::{Batch, IncidentEdges, lengths};
use super::lanes::{LANES, LaneSym3, LaneVec3, Lanes, add_dyad, apply, everywhere, everywhere_tensor, sub};
use crate::mesh::vector::Vec3;
use multiversion::multiversion;

/// Lengths below this count as this: the energy of a short edge is bounded.
pub const SHORTEST: f64 = 0.1;

/// A function of a point near p to second order: E(p) + g·d + dᵀHd/2.
#[derive(Clone, Copy, Debug)]
pub struct QuadraticModel {
    /// Value.
    pub energy: f64,
    /// Gradient.
    pub gradient: Vec3,
    /// Hessian, positive definite.
    pub hessian: Sym3,
}

/// Sums over the tetrahedra and edges at a vertex, eight at a time.
#[derive(Clone)]
pub struct Energy {
    at: Vec3,
    metric: Sym3,
    /// Whether all volumes were positive.
    is_positive: bool,
    value: Lanes,
    gradient: LaneVec3,
    hessian: LaneSym3,
}

impl Energy {
    /// Of nothing yet, for a vertex at p with the metric M.
    #[inline]
    pub fn at(p: Vec3, metric: &Sym3) -> Self {
        Self {
            at: p,
            metric: *metric,
            is_positive: true,
            value: Lanes::ZERO,
            gradient: [Lanes::ZERO; 3],
            hessian: [Lanes::ZERO; 6],
        }
    }

    /// Adds Σ 1/Q³ over the tetrahedra that the vertex makes with triangles. `metrics` is ΣM over the vertices of each triangle, `energies` 1/Q³
    /// of each tetrahedron as it is. A lane without a tetrahedron has the energy 0, and repeats the triangle of another.
    #[inline]
    pub fn add_tets(&mut self, triangles: &Batch, metrics: &LaneSym3, energies: &Lanes) {
        add_tets(self, triangles, metrics, energies);
    }

    /// Adds Σ ((L − 1/L)/2)² over the first `count` edges to the vertex.
    #[inline]
    pub fn add_edges(&mut self, edges: &IncidentEdges, count: usize) {
        add_edges(self, edges, &weights(count));
    }

    /// The sum as a function of the vertex' place; none where a tetrahedron is not positive (in floating point).
    #[inline]
    pub fn model(&self) -> Option<QuadraticModel> {
        self.is_positive.then(|| QuadraticModel {
            energy: self.value.sum(),
            gradient: self.gradient.map(Lanes::sum),
            hessian: Sym3(self.hessian.map(Lanes::sum)),
        })
    }
}

/// 1 for the first `count` lanes, else 0.
#[inline(always)]
fn weights(count: usize) -> Lanes {
    Lanes(std::array::from_fn(|lane| if lane < count { 1.0 } else { 0.0 }))
}

/// 1/Q³ is S³/(432 V²) but for a factor, with S the sum of the squared edges in the mean metric M̂ and V six times the volume (METHOD.md §2.4).
/// With v = ∇V/V and s = ∇S/S its gradient is (3s − 2v)/Q³ and its Hessian (6 (v − s)(v − s)ᵀ + 18 M̂/S)/Q³, which is positive definite: each
/// tetrahedron's part is convex.
///
/// The compiler vectorizes the loop over the lanes. From operations on whole [`Lanes`] it made gathers here, and operations on single numbers,
/// which took several times as long with AVX-512.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn add_tets(sum: &mut Energy, triangles: &Batch, metrics: &LaneSym3, energies: &Lanes) {
    let ([p0, p1, p2], own) = (sum.at, sum.metric.0);
    let [[a0, a1, a2], [b0, b1, b2], [c0, c1, c2]] = &triangles.corners;
    let ([n0, n1, n2], [d0, d1, d2, d3, d4, d5]) = (&triangles.area, &triangles.dyads);
    let [m0, m1, m2, m3, m4, m5] = metrics;
    let Energy { value, gradient: [g0, g1, g2], hessian: [h0, h1, h2, h3, h4, h5], .. } = sum;
    let mut volumes = Lanes::ZERO;
    for k in 0..LANES {
        let pa = [p0 - a0.0[k], p1 - a1.0[k], p2 - a2.0[k]];
        let pb = [p0 - b0.0[k], p1 - b1.0[k], p2 - b2.0[k]];
        let pc = [p0 - c0.0[k], p1 - c1.0[k], p2 - c2.0[k]];
        let area = [n0.0[k], n1.0[k], n2.0[k]];
        let mean = [
            m0.0[k] + own[0],
            m1.0[k] + own[1],
            m2.0[k] + own[2],
            m3.0[k] + own[3],
            m4.0[k] + own[4],
            m5.0[k] + own[5],
        ];
        let volume = area[0] * pa[0] + area[1] * pa[1] + area[2] * pa[2];
        let squares = (d0.0[k] + pa[0] * pa[0] + pb[0] * pb[0] + pc[0] * pc[0]) * mean[0]
            + (d2.0[k] + pa[1] * pa[1] + pb[1] * pb[1] + pc[1] * pc[1]) * mean[2]
            + (d5.0[k] + pa[2] * pa[2] + pb[2] * pb[2] + pc[2] * pc[2]) * mean[5]
            + ((d1.0[k] + pa[0] * pa[1] + pb[0] * pb[1] + pc[0] * pc[1]) * mean[1]
                + (d3.0[k] + pa[0] * pa[2] + pb[0] * pb[2] + pc[0] * pc[2]) * mean[3]
                + (d4.0[k] + pa[1] * pa[2] + pb[1] * pb[2] + pc[1] * pc[2]) * mean[4])
                * 2.0;
        let (over_volume, over_squares) = (1.0 / volume, 1.0 / squares);
        let out = [pa[0] + pb[0] + pc[0], pa[1] + pb[1] + pc[1], pa[2] + pb[2] + pc[2]];
        let v = [area[0] * over_volume, area[1] * over_volume, area[2] * over_volume];
        let s = [
            (mean[0] * out[0] + mean[1] * out[1] + mean[3] * out[2]) * over_squares * 2.0,
            (mean[1] * out[0] + mean[2] * out[1] + mean[4] * out[2]) * over_squares * 2.0,
            (mean[3] * out[0] + mean[4] * out[1] + mean[5] * out[2]) * over_squares * 2.0,
        ];
        let energy = energies.0[k];
        g0.0[k] += (s[0] * 3.0 - v[0] * 2.0) * energy;
        g1.0[k] += (s[1] * 3.0 - v[1] * 2.0) * energy;
        g2.0[k] += (s[2] * 3.0 - v[2] * 2.0) * energy;
        let step = [v[0] - s[0], v[1] - s[1], v[2] - s[2]];
        let (stiffness, six) = (over_squares * 3.0, energy * 6.0);
        h0.0[k] += (step[0] * step[0] + mean[0] * stiffness) * six;
        h1.0[k] += (step[0] * step[1] + mean[1] * stiffness) * six;
        h2.0[k] += (step[1] * step[1] + mean[2] * stiffness) * six;
        h3.0[k] += (step[0] * step[2] + mean[3] * stiffness) * six;
        h4.0[k] += (step[1] * step[2] + mean[4] * stiffness) * six;
        h5.0[k] += (step[2] * step[2] + mean[5] * stiffness) * six;
        value.0[k] += energy;
        volumes.0[k] = volume;
    }
    sum.is_positive &= !volumes.any_below(f64::MIN_POSITIVE);
}

/// φ = ((L − 1/L)/2)², with ∇L = M(p − x)/L. Of its Hessian only the part that is never negative.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn add_edges(sum: &mut Energy, edges: &IncidentEdges, weights: &Lanes) {
    let (p, own) = (everywhere(sum.at), everywhere_tensor(&sum.metric));
    let length = lengths(edges, &p, &own).max(Lanes::all(SHORTEST));
    let over = Lanes::all(1.0) / length;
    let difference = length - over;
    let square = over * over;
    sum.value = sum.value + difference * difference * *weights * 0.25;
    let slope = difference * (square + 1.0) * *weights * 0.5;
    let curvature = (square * square * 3.0 + 1.0) * *weights * 0.5;
    let mut out = apply(&own, &sub(&p, &edges.ends));
    for i in 0..3 {
        out[i] = out[i] * over;
        sum.gradient[i] = sum.gradient[i] + out[i] * slope;
    }
    let mut dyad = [Lanes::ZERO; 6];
    add_dyad(&mut dyad, &out);
    for i in 0..6 {
        sum.hessian[i] = sum.hessian[i] + dyad[i] * curvature;
    }
}

#[cfg(test)]
mod tests {
    use super::super::lanes::LANES;
    use super::super::random::spd;
    use super::*;
    use crate::mesh::vector::dot;
    use proptest::prelude::*;

    proptest! {
        /// Gradient and Hessian are those of the sum, found here by differences; in one metric for all, the edges about unit length.
        #[test]
        fn the_model_fits(x in prop::array::uniform7(prop::array::uniform3(-1.0..1.0f64)), m in spd(2.0), d in prop::array::uniform3(-1.0..1.0f64)) {
            let log = m.ln();
            let (mut batch, mut edges) = (Batch::default(), IncidentEdges::default());
            for lane in 0..LANES {
                let k = lane % 2;
                batch.set(lane, [x[k], x[k + 1], x[k + 2]], [&log; 3]);
                edges.set(lane, x[lane % 4], &m);
            }
            batch.prepare();
            let shapes = batch.shapes(x[6], &log).mean_ratios();
            if shapes[0] < 0.05 || shapes[1] < 0.05 {
                return Ok(());
            }
            let at = |step: f64| {
                let p: Vec3 = std::array::from_fn(|i| x[6][i] + step * d[i]);
                let mut energy = Energy::at(p, &m);
                let of = |lane: usize| if lane < 2 { batch.shapes(p, &log).mean_ratios()[lane].powi(-3) } else { 0.0 };
                energy.add_tets(&batch, &everywhere_tensor(&m.times(3.0)), &Lanes(std::array::from_fn(of)));
                energy.model()
            };
            let model = at(0.0).unwrap();
            let exact: f64 = shapes[..2].iter().map(|q| 1.0 / q.powi(3)).sum();
            prop_assert!((model.energy / exact - 1.0).abs() < 1e-9);
            // A step that changes the energy by about 1e-10 of it: small to the third derivative, large to the rounding.
            let curvature = model.hessian.quadratic(d);
            let step = 1e-5 * (model.energy / curvature).sqrt();
            let (Some(ahead), Some(behind)) = (at(step), at(-step)) else { return Ok(()) };
            let slope = |model: &QuadraticModel| dot(model.gradient, d);
            let found = (ahead.energy - behind.energy) / (2.0 * step);
            let size = (model.energy * curvature).sqrt();
            prop_assert!((slope(&model) - found).abs() < 1e-4 * size, "{} {found}", slope(&model));
            let found = (slope(&ahead) - slope(&behind)) / (2.0 * step);
            prop_assert!((curvature - found).abs() < 1e-3 * curvature, "{curvature} {found}");
            // The edges: value and gradient.
            let of_edges = |step: f64| {
                let p: Vec3 = std::array::from_fn(|i| x[6][i] + step * d[i]);
                let mut energy = Energy::at(p, &m);
                energy.add_edges(&edges, 3);
                energy.model().unwrap()
            };
            let squares: Vec<f64> = (0..3).map(|k| m.quadratic(crate::mesh::vector::sub(x[k], x[6]))).collect();
            if squares.iter().any(|&square| square < 4.0 * SHORTEST * SHORTEST) {
                return Ok(());
            }
            let model = of_edges(0.0);
            let exact: f64 = squares.iter().map(|square| 0.25 * (square + 1.0 / square - 2.0)).sum();
            prop_assert!((model.energy - exact).abs() < 1e-9 * exact.max(1.0));
            let step = 1e-6 * squares[0].sqrt() / m.quadratic(d).sqrt();
            let found = (of_edges(step).energy - of_edges(-step).energy) / (2.0 * step);
            prop_assert!((slope(&model) - found).abs() < 1e-5 * (slope(&model).abs() + model.energy / step * 1e-6), "{} {found}", slope(&model));
        }

        /// Of two tetrahedra on both sides of a face one is inverted.
        #[test]
        fn no_model_of_what_is_inverted(m in spd(2.0)) {
            let (log, mut batch) = (m.ln(), Batch::default());
            for lane in 0..LANES {
                let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, if lane == 3 { 1.0 } else { -1.0 }]];
                batch.set(lane, corners, [&log; 3]);
            }
            batch.prepare();
            let mut energy = Energy::at([0.0; 3], &m);
            energy.add_tets(&batch, &everywhere_tensor(&m.times(3.0)), &Lanes::all(1.0));
            prop_assert!(energy.model().is_none());
        }
    }
}
