//! Mean ratios of several tetrahedra at once: the inner loop of smoothing, of stars and of edge removal.
//!
//! A [`Batch`] holds [`LANES`] triangles with all that does not depend on the fourth vertex, the apex, so that trying another
//! place for it costs little. It is compiled for the baseline, AVX2 and AVX-512, and chosen at run time. There is no fused
//! multiplication in it, so all of these give the same bits.
use super::Sym3;
use super::exponential::{SERIES, STRONG};
use super::lanes::{
    LANES, LaneSym3, LaneVec3, Lanes, add_dyad, apply, contract, cross, det, dot, everywhere, everywhere_tensor,
    squared, sub,
};
use super::strong;
use crate::mesh::vector::Vec3;
use multiversion::multiversion;

/// (36/3^(1/3))³ (1/6)²: the factor of the cubed mean ratio when six times the volume is used.
pub(super) const FACTOR: f64 = 432.0;

/// Error bound of the sign of six times a volume, in the product of the edges' greatest components: thrice the forward
/// error of the 3×3 determinant of rounded differences.
const UNCERTAIN: f64 = 4e-14;

/// Triangles (a, b, c), one a lane, each to be joined to an apex p such that (a, b, c, p) is positive.
#[derive(Clone)]
pub struct Batch {
    pub(super) corners: [LaneVec3; 3],
    /// Normal of twice the area.
    pub(super) area: LaneVec3,
    /// Error bound of the volume, in the apex's greatest component from a.
    uncertain: Lanes,
    /// Σ vvᵀ over the triangle's edges.
    pub(super) dyads: LaneSym3,
    /// Σ ln M over the triangle's vertices.
    log_sum: LaneSym3,
}

/// Mean ratios of the tetrahedra of a [`Batch`].
#[derive(Clone, Copy, Debug)]
pub struct Shapes {
    /// Q³, which needs no cube root. 0 where a tetrahedron is not positive, or so flat that only exact arithmetic could tell: these are refused.
    pub cubes: Lanes,
}

impl Shapes {
    /// Q; 0 where a tetrahedron is not surely positive.
    #[inline]
    pub fn mean_ratios(&self) -> [f64; LANES] {
        roots(&self.cubes).0
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn roots(cubes: &Lanes) -> Lanes {
    cubes.above(f64::MIN_POSITIVE, cubes.max(Lanes::all(f64::MIN_POSITIVE)).cbrt(), Lanes::ZERO)
}

impl Default for Batch {
    fn default() -> Self {
        Self {
            corners: [[Lanes::ZERO; 3]; 3],
            area: [Lanes::ZERO; 3],
            uncertain: Lanes::ZERO,
            dyads: [Lanes::ZERO; 6],
            log_sum: [Lanes::ZERO; 6],
        }
    }
}

impl Batch {
    /// Sets one triangle; all lanes must be set, the last ones by repetition. Then [`Batch::prepare`].
    #[inline(always)]
    pub fn set(&mut self, lane: usize, points: [Vec3; 3], logs: [&Sym3; 3]) {
        let sum = Sym3(std::array::from_fn(|i| logs[0].0[i] + logs[1].0[i] + logs[2].0[i]));
        self.set_with_sum(lane, points, &sum);
    }

    /// As [`Batch::set`], from Σ ln M over the triangle's vertices.
    #[inline(always)]
    pub fn set_with_sum(&mut self, lane: usize, points: [Vec3; 3], log_sum: &Sym3) {
        for k in 0..3 {
            for i in 0..3 {
                self.corners[k][i].0[lane] = points[k][i];
            }
        }
        for i in 0..6 {
            self.log_sum[i].0[lane] = log_sum.0[i];
        }
    }

    /// Computes what does not depend on the apex.
    #[inline]
    pub fn prepare(&mut self) {
        prepare(self);
    }

    /// The tetrahedra with one apex p, its metric given as ln M.
    #[inline]
    pub fn shapes(&self, p: Vec3, log: &Sym3) -> Shapes {
        Shapes { cubes: cubes_at(self, p, log) }
    }

    /// The tetrahedra, each with an apex of its own.
    #[inline]
    pub fn shapes_each(&self, apex: &LaneVec3, log: &LaneSym3) -> Shapes {
        Shapes { cubes: cubes_each(self, apex, log) }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn prepare(batch: &mut Batch) {
    let [a, b, c] = &batch.corners;
    let (ab, ac, bc) = (sub(b, a), sub(c, a), sub(c, b));
    let largest = |v: &LaneVec3| v[0].abs().max(v[1].abs()).max(v[2].abs());
    batch.area = cross(&ab, &ac);
    batch.uncertain = largest(&ab) * largest(&ac) * UNCERTAIN;
    let mut dyads = [Lanes::ZERO; 6];
    for v in [ab, ac, bc] {
        add_dyad(&mut dyads, &v);
    }
    batch.dyads = dyads;
}

/// exp S of traceless tensors S as coefficients of 1, S and S²: as in exponential.rs, without its branches.
struct Exponential {
    a: [Lanes; 3],
    /// The isolated eigenvalue of S.
    root: Lanes,
    /// Difference of the extreme eigenvalues of S.
    spread: Lanes,
}

#[inline(always)]
fn exponential(s: &LaneSym3, s2: &LaneSym3) -> Exponential {
    let p = (s2[0] + s2[2] + s2[5]) * (1.0 / 6.0);
    let r = det(s) * 0.5;
    if !p.any_above(SERIES * SERIES) {
        // All are nearly isotropic.
        return Exponential { a: series(&p, &r), root: Lanes::ZERO, spread: Lanes::ZERO };
    }
    let least = Lanes::all(SERIES * SERIES);
    let safe = p.max(least);
    // The roots of x³ = 3p x + 2r: the isolated one, then y ≤ z.
    let root = safe.sqrt();
    let c = cosine_of_third((r.abs() / (safe * root)).min(Lanes::all(1.0)));
    let x = (root * c * 2.0).copysign(r);
    let close = ((safe * 3.0 - x * x * 0.75) * 4.0).max(Lanes::all(1e-10)).sqrt();
    let (y, z) = (x * -0.5 - close * 0.5, x * -0.5 + close * 0.5);
    let (ex, ey, ez) = (x.exp(), y.exp(), z.exp());
    let fxy = (ey - ex) / (y - x);
    let fyz = (ez - ey) / close;
    let fxyz = (fyz - fxy) / (z - x);
    let newton = [ex - fxy * x + fxyz * x * y, fxy + fxyz * z, fxyz];
    let spread = close.max(x.abs() * 1.5 + close * 0.5);
    let a = if p.any_below(SERIES * SERIES) {
        let series = series(&p, &r);
        let chosen = |i: usize| p.above(SERIES * SERIES, newton[i], series[i]);
        [chosen(0), chosen(1), chosen(2)]
    } else {
        newton
    };
    Exponential { a, root: x, spread }
}

/// Σ Sⁿ/n! up to n = 9.
#[inline(always)]
fn series(p: &Lanes, r: &Lanes) -> [Lanes; 3] {
    let mut a = [Lanes::all(1.0), Lanes::ZERO, Lanes::ZERO];
    for n in (1..=9).rev() {
        let over = 1.0 / f64::from(n);
        a = [*r * a[2] * (2.0 * over) + 1.0, (a[0] + *p * a[2] * 3.0) * over, a[1] * over];
    }
    a
}

/// As in eigen.rs.
#[inline(always)]
fn cosine_of_third(t: Lanes) -> Lanes {
    let (t2, k) = (t * t, &super::eigen::COSINE);
    let low = (t * k[1] + k[0]) + (t * k[3] + k[2]) * t2;
    let high = (t * k[5] + k[4]) + (t * k[7] + k[6]) * t2;
    let c = low + high * (t2 * t2);
    let c2 = c * c;
    c - (c * (c2 * 4.0 + -3.0) - t) / (c2 * 12.0 + -3.0)
}

/// The traceless part of the mean of ln M.
#[inline(always)]
fn deviator(batch: &Batch, log: &LaneSym3) -> LaneSym3 {
    let mut s = *log;
    for i in 0..6 {
        s[i] = (batch.log_sum[i] + log[i]) * 0.25;
    }
    let mean = (s[0] + s[2] + s[5]) * (1.0 / 3.0);
    for i in [0, 2, 5] {
        s[i] = s[i] - mean;
    }
    s
}

/// [`cubes`] with one apex, passed as numbers: eight equal ones would be written to memory and read again.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn cubes_at(batch: &Batch, apex: Vec3, log: &Sym3) -> Lanes {
    cubes(batch, &everywhere(apex), &everywhere_tensor(log))
}

/// [`cubes`] with an apex each.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn cubes_each(batch: &Batch, apex: &LaneVec3, log: &LaneSym3) -> Lanes {
    cubes(batch, apex, log)
}

/// Cubed mean ratios, 0 where the sign of the volume may be rounding.
#[inline(always)]
fn cubes(batch: &Batch, apex: &LaneVec3, log: &LaneSym3) -> Lanes {
    let [a, b, c] = &batch.corners;
    let (pa, pb, pc) = (sub(apex, a), sub(apex, b), sub(apex, c));
    let volume = dot(&batch.area, &pa);
    let largest = pa[0].abs().max(pa[1].abs()).max(pa[2].abs());
    let surely = volume - batch.uncertain * largest;
    if !surely.any_above(0.0) {
        return Lanes::ZERO;
    }
    let mut dyads = batch.dyads;
    for v in [pa, pb, pc] {
        add_dyad(&mut dyads, &v);
    }
    let s = deviator(batch, log);
    let s2 = squared(&s);
    let Exponential { a: [a0, a1, a2], root, spread } = exponential(&s, &s2);
    let mut sum = a0 * (dyads[0] + dyads[2] + dyads[5]) + a1 * contract(&dyads, &s) + a2 * contract(&dyads, &s2);
    if spread.any_above(STRONG) {
        let vectors = [sub(b, a), sub(c, a), sub(c, b), pa, pb, pc];
        sum = spread.above(STRONG, strong::form(&s, root, &vectors), sum);
    }
    let cubes = volume * volume / (sum * sum * sum) * FACTOR;
    surely.above(0.0, cubes, Lanes::ZERO)
}

/// Edges at one vertex, one a lane, by their other ends.
#[derive(Clone, Copy)]
pub struct IncidentEdges {
    pub(super) ends: LaneVec3,
    metrics: LaneSym3,
}

impl Default for IncidentEdges {
    fn default() -> Self {
        Self { ends: [Lanes::ZERO; 3], metrics: [Lanes::ZERO; 6] }
    }
}

impl IncidentEdges {
    /// Sets one end.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, point: Vec3, metric: &Sym3) {
        for i in 0..3 {
            self.ends[i].0[lane] = point[i];
        }
        for i in 0..6 {
            self.metrics[i].0[lane] = metric.0[i];
        }
    }

    /// One end.
    #[inline(always)]
    pub fn end(&self, lane: usize) -> Vec3 {
        self.ends.map(|x| x.0[lane])
    }

    /// Lengths of the edges to p, with the metric M there, by the log law of METHOD.md §1.3 (as [`super::quality::mean_length`]).
    #[inline]
    pub fn lengths(&self, p: Vec3, metric: &Sym3) -> [f64; LANES] {
        lengths_to(self, p, metric).0
    }
}

/// [`lengths`] with p and its metric passed as numbers.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn lengths_to(edges: &IncidentEdges, p: Vec3, metric: &Sym3) -> Lanes {
    lengths(edges, &everywhere(p), &everywhere_tensor(metric))
}

/// The lengths of the edges to p, with the metric there.
#[inline(always)]
pub(super) fn lengths(edges: &IncidentEdges, p: &LaneVec3, metric: &LaneSym3) -> Lanes {
    let v = sub(&edges.ends, p);
    let here = dot(&v, &apply(metric, &v)).max(Lanes::all(f64::MIN_POSITIVE)).sqrt();
    let there = dot(&v, &apply(&edges.metrics, &v)).max(Lanes::all(f64::MIN_POSITIVE)).sqrt();
    let (difference, sum) = (here - there, here + there);
    let square = difference * difference / (sum * sum);
    let by_series = sum * 0.5 / over_atanh(&square);
    if !square.any_above(NEAR) {
        return by_series;
    }
    square.above(NEAR, difference / (here / there).ln(), by_series)
}

/// δ² up to which the series of atanh δ is summed: lengths at both ends that differ by half.
const NEAR: f64 = 0.04;

/// atanh δ/δ of δ², up to [`NEAR`], to 1e-13.
#[inline(always)]
fn over_atanh(square: &Lanes) -> Lanes {
    let fourth = *square * *square;
    let even = ((fourth * (1.0 / 17.0) + 1.0 / 13.0) * fourth + 1.0 / 9.0) * fourth + 1.0 / 5.0;
    let odd = ((fourth * (1.0 / 15.0) + 1.0 / 11.0) * fourth + 1.0 / 7.0) * fourth + 1.0 / 3.0;
    even * fourth + odd * *square + 1.0
}

#[cfg(test)]
mod tests {
    use super::super::quality::{edge_length, mean_ratio};
    use super::super::random::spd;
    use super::*;
    use proptest::prelude::*;

    fn points() -> impl Strategy<Value = [Vec3; 7]> {
        prop::array::uniform7(prop::array::uniform3(-1.0..1.0f64))
    }

    fn batch(x: &[Vec3; 7], logs: &[Sym3; 4]) -> Batch {
        let mut batch = Batch::default();
        for lane in 0..LANES {
            let k = lane % 4;
            batch.set(lane, [x[k], x[k + 1], x[k + 2]], [&logs[0], &logs[1], &logs[2]]);
        }
        batch.prepare();
        batch
    }

    proptest! {
        /// The batch gives what the tetrahedra give one by one, of any anisotropy.
        #[test]
        fn as_one_by_one(x in points(), m in prop::array::uniform4(prop_oneof![spd(0.1), spd(6.0), spd(14.0)])) {
            let logs = m.map(|m| m.ln());
            let batch = batch(&x, &logs);
            let shapes = batch.shapes(x[6], &logs[3]);
            for (lane, found) in shapes.mean_ratios().into_iter().enumerate() {
                let k = lane % 4;
                let one = [x[k], x[k + 1], x[k + 2], x[6]];
                let wanted = mean_ratio(one, logs.each_ref()).max(0.0);
                prop_assert!((found - wanted).abs() <= 1e-9 * wanted, "lane {lane}: {found} {wanted}");
            }
        }

        /// Lengths as one by one.
        #[test]
        fn incident_edges_as_edges(x in points(), m in prop::array::uniform4(prop_oneof![spd(0.01), spd(3.0)])) {
            let mut edges = IncidentEdges::default();
            for lane in 0..LANES {
                edges.set(lane, x[lane % 6], &m[lane.min(2)]);
            }
            for (lane, found) in edges.lengths(x[6], &m[3]).into_iter().enumerate() {
                let v: Vec3 = std::array::from_fn(|i| x[lane % 6][i] - x[6][i]);
                let wanted = edge_length(v, &m[lane.min(2)], &m[3]);
                prop_assert!((found - wanted).abs() <= 1e-12 * wanted, "{found} {wanted}");
            }
        }
    }

    #[test]
    fn flat_and_inverted_tetrahedra_have_none() {
        let logs = [Sym3::ZERO; 4];
        let mut batch = Batch::default();
        for lane in 0..LANES {
            batch.set(lane, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [&logs[0]; 3]);
        }
        batch.prepare();
        assert_eq!(batch.shapes([0.2, 0.3, 0.0], &logs[3]).mean_ratios(), [0.0; LANES]);
        assert_eq!(batch.shapes([0.2, 0.3, -1.0], &logs[3]).mean_ratios(), [0.0; LANES]);
        // So flat that only the exact predicate knows the sign.
        assert_eq!(batch.shapes([0.2, 0.3, 1e-17], &logs[3]).mean_ratios(), [0.0; LANES]);
        let q = batch.shapes([0.2, 0.3, 1e-9], &logs[3]).mean_ratios();
        assert!(q[0] > 0.0 && q[0] < 1e-5, "{q:?}");
    }
}
