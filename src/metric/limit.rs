//! Bounds of the sizes and of their ratio, vertex by vertex.
use super::Sym3;
use crate::tasks::{GRAIN, Team};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// What sizes a metric may have; none where there is no bound.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Least size, length > 0.
    pub hmin: Option<f64>,
    /// Greatest size, length ≥ `hmin`.
    pub hmax: Option<f64>,
    /// Greatest ratio of two sizes at a point, ≥ 1.
    pub aspect_ratio: Option<f64>,
}

impl Limits {
    /// Whether nothing is limited.
    pub fn are_none(&self) -> bool {
        *self == Self::default()
    }

    /// ln M with its sizes within the limits: those below `hmin` are raised to it, those above `hmax` and then those above
    /// `aspect_ratio` times the least are cut. A metric within them comes back bit for bit.
    pub fn apply_to_log(&self, log: &Sym3) -> Sym3 {
        if self.are_far_from(log) {
            return *log;
        }
        let eigen = log.eigen();
        let within = self.exponents(eigen.values);
        let inside = |(a, b): (&f64, &f64)| (a - b).abs() <= ROUNDING * (1.0 + b.abs());
        if within.iter().zip(&eigen.values).all(inside) {
            return *log;
        }
        Sym3::from_eigen(&super::Eigen { values: within, ..eigen })
    }

    /// Whether Gershgorin's circles tell that all sizes are within the limits. For most tensors they do, and no eigenvalues are needed.
    #[inline]
    fn are_far_from(&self, log: &Sym3) -> bool {
        let [a, b, c, d, e, f] = log.0;
        let [ab, ac, bc] = [b, d, e].map(f64::abs);
        let rows = [(a, ab + ac), (c, ab + bc), (f, ac + bc)];
        let least = rows.iter().fold(f64::INFINITY, |least, (x, radius)| least.min(x - radius));
        let greatest = rows.iter().fold(f64::NEG_INFINITY, |greatest, (x, radius)| greatest.max(x + radius));
        self.exponents([least, least, greatest]) == [least, least, greatest]
    }

    /// The eigenvalues ln λ = −2 ln h within the limits.
    fn exponents(&self, values: [f64; 3]) -> [f64; 3] {
        let exponent = |h: f64| -2.0 * h.ln();
        let low = self.hmax.map_or(f64::NEG_INFINITY, exponent);
        let high = self.hmin.map_or(f64::INFINITY, exponent);
        let values = values.map(|x| x.max(low).min(high));
        let Some(ratio) = self.aspect_ratio else { return values };
        let greatest = values.into_iter().fold(f64::NEG_INFINITY, f64::max);
        values.map(|x| x.max(greatest - 2.0 * ratio.ln()))
    }

    /// Limits ln M at all vertices, shape (n,). Returns at how many that changed it.
    pub fn apply(&self, team: Team<'_>, logs: &mut [Sym3]) -> usize {
        if self.are_none() {
            return 0;
        }
        let changed = AtomicUsize::new(0);
        team.fill(GRAIN, logs, |_, logs| {
            let limited = logs.iter_mut().filter_map(|log| {
                let limited = self.apply_to_log(log);
                (limited != *log).then(|| *log = limited)
            });
            changed.fetch_add(limited.count(), Relaxed);
        });
        changed.into_inner()
    }
}

/// Relative difference of exponents that is rounding, as in a metric that has been limited before.
const ROUNDING: f64 = 1e-13;

#[cfg(test)]
mod tests {
    use super::super::random::spd;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn sizes_are_within(m in spd(13.8), hmin in 1e-3..1.0f64, over in 1.0..1e3f64, ratio in 1.0..1e3f64) {
            let hmax = hmin * over;
            let limits = Limits { hmin: Some(hmin), hmax: Some(hmax), aspect_ratio: Some(ratio) };
            let log = m.ln();
            let limited = limits.apply_to_log(&log);
            let h = limited.eigen().values.map(|x| (-0.5 * x).exp());
            for h in h {
                prop_assert!(h > hmin * (1.0 - 1e-10) && h < hmax * (1.0 + 1e-10), "{h}");
                prop_assert!(h / f64::min(limited.exp().sizes()[2], hmax) < ratio * (1.0 + 1e-6));
            }
            prop_assert_eq!(limits.apply_to_log(&limited), limited);
        }
    }

    #[test]
    fn small_sizes_stay_and_great_ones_are_cut() {
        let log = Sym3::from_sizes([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.5, 1e-3, 0.1]).ln();
        let sizes = |limits: Limits| limits.apply_to_log(&log).exp().sizes();
        let close = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a / b - 1.0).abs() < 1e-10);
        let none = Limits::default();
        assert!(close(sizes(Limits { aspect_ratio: Some(20.0), ..none }), [0.02, 0.02, 1e-3]));
        assert!(close(sizes(Limits { hmin: Some(0.2), ..none }), [0.5, 0.2, 0.2]));
        assert!(close(sizes(Limits { hmax: Some(0.2), ..none }), [0.2, 0.1, 1e-3]));
        assert_eq!(none.apply(Team::alone(), &mut [log]), 0);
        let mut logs = [log, Sym3::ZERO];
        assert_eq!(Limits { hmin: Some(0.2), ..none }.apply(Team::alone(), &mut logs), 1);
        assert_eq!(logs[1], Sym3::ZERO);
    }
}
