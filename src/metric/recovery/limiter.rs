//! Hessians at jumps, where no quadratic function fits the field, and what a mesh needs there (METHOD.md §1.10).
//!
//! Across a jump J of u a linear element of thickness h is wrong by about J whatever its size: as if |H| were J/h² across the jump, and
//! J·k/h along it, with k the curvature of the jump's surface. A fit gives less. It spreads the jump over its stencil, its smaller second
//! derivatives are noise, and it takes vertices beside the jump into the layer when their second ring crosses it.
//!
//! So three things are done where the fit leaves much unexplained of a step that is a good part of the field's range. The smoother of two
//! stencils is taken (as ENO schemes do: Harten, Engquist, Osher, Chakravarthy 1987). The strongest second derivative counts more. And |H|
//! is averaged among neighbours that are at the jump too. All other vertices are left as they are.
use super::quadratic::Fitted;
use super::rings::Rings;
use crate::metric::{Eigen, Sym3};
use crate::tasks::{GRAIN, Team};

/// A fit that leaves this share of the variance unexplained may be across a jump.
const ROUGH: f64 = 0.25;

/// Shares of the field's range. A step below the first is no jump; one above the second is a full jump.
const STEPS: [f64; 2] = [0.1, 0.3];

/// How much is added to the strongest second derivative, as a multiple of it, where the fit explains nothing of a jump. Where it explains
/// some, this is multiplied by the root of the roughness. On sinatan3 (cases/convergence, complexity 16 000, cycles until nothing changes) the error times the root of the vertices is
/// 4.75 with 6 and roughness itself, 4.30 with 9, 4.23 with 12; with 24 and more the rest of the mesh starves, from cycle to cycle.
const SHARPER: f64 = 12.0;

/// Vertices at the jump are alike when the logarithms of their greatest eigenvalues differ by less than this.
const ALIKE: f64 = 1.0;

/// How often |H| is averaged.
const PASSES: usize = 2;

/// Tells jumps from smooth fields.
#[derive(Clone, Copy, Debug)]
pub struct Limiter {
    /// The greatest value of the field minus the least.
    range: f64,
}

impl Limiter {
    /// Of a field, shape (n,).
    pub fn of(team: Team<'_>, values: &[f64]) -> Self {
        let extent = |values: &[f64]| {
            values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &x| [low.min(x), high.max(x)])
        };
        let parts = team.chunks(GRAIN, values.len(), |range| extent(&values[range]));
        let [low, high] = extent(parts.as_flattened());
        Self { range: high - low }
    }

    /// The roughness of a fit to points whose values differ by `step`: 0 where the field is smooth, 1 at a full jump that it does not explain.
    #[inline]
    fn roughness(self, fitted: &Fitted, step: f64) -> f64 {
        let [low, high] = STEPS.map(|share| share * self.range);
        let unexplained = ((fitted.unexplained - ROUGH) / (1.0 - ROUGH)).clamp(0.0, 1.0);
        unexplained * ((step - low) / (high - low)).clamp(0.0, 1.0)
    }

    /// Whether the fit to the first ring, which has few points, is better than that to two rings, since only the second crosses a jump.
    #[inline]
    pub fn prefers(self, near: &Fitted, wide: &Fitted, step: f64) -> bool {
        let size = |fitted: &Fitted| fitted.hessian.0.iter().fold(0.0f64, |a, x| a.max(x.abs()));
        self.roughness(wide, step) > 0.0 && size(near) < size(wide)
    }

    /// |H| with its greatest eigenvalue raised, at a jump; none elsewhere.
    #[inline]
    pub fn sharpened(self, fitted: &Fitted, step: f64) -> Option<Sym3> {
        let roughness = self.roughness(fitted, step);
        (roughness > 0.0).then(|| {
            let Eigen { values, vectors } = fitted.hessian.eigen();
            let mut values = values.map(f64::abs);
            let strongest = (1..3).fold(0, |a, b| if values[b] > values[a] { b } else { a });
            values[strongest] *= 1.0 + SHARPER * roughness.sqrt();
            Sym3::from_eigen(&Eigen { values, vectors })
        })
    }
}

/// Replaces |H| of vertices at a jump by the log-Euclidean mean with those of similar neighbours at the jump. That removes the noise of
/// directions and of small eigenvalues.
pub fn average(team: Team<'_>, rings: &Rings, hessians: &mut [Option<Sym3>], is_jump: &[bool]) {
    for _ in 0..PASSES {
        let logs = team.map(GRAIN, hessians.len(), |v| hessians[v].filter(|_| is_jump[v]).map(|hessian| log(&hessian)));
        team.fill(GRAIN / 8, hessians, |start, hessians| {
            for (slot, v) in hessians.iter_mut().zip(start..) {
                let Some((own, top)) = logs[v] else { continue };
                let near = rings.neighbours(v as u32).iter().filter_map(|&other| logs[other as usize]);
                let near = near.filter(|(_, other)| (other - top).abs() < ALIKE);
                let (sum, count) = near.fold((own, 1.0), |(sum, count), (log, _)| (sum.plus(log), count + 1.0));
                *slot = Some(sum.times(1.0 / count).exp());
            }
        });
    }
}

/// ln |H| with eigenvalues of 1e-12 of the greatest at least, and the logarithm of that.
fn log(hessian: &Sym3) -> (Sym3, f64) {
    let eigen = hessian.eigen();
    let top = eigen.values.iter().fold(f64::MIN_POSITIVE, |a, x| a.max(x.abs()));
    let values = eigen.values.map(|x| x.abs().max(1e-12 * top).ln());
    (Sym3::from_eigen(&Eigen { values, ..eigen }), top.ln())
}
