//! The scale at which a metric has a given complexity.

/// Complexities that differ by less than this share are equal.
const TOLERANCE: f64 = 2e-3;

/// ln C grows by 3/2 of ln M where nothing bounds the sizes.
const FREE_SLOPE: f64 = 1.5;

/// The logarithm of the scale of M moves by no more than this in a step,
const LONGEST_STEP: f64 = 8.0;

/// and by no more than this in all: a factor of 1e17.
const FARTHEST: f64 = 40.0;

/// No scale has that complexity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unreachable {
    /// The complexity that came nearest.
    pub nearest: f64,
}

/// The logarithm of the scale at which `complexity`, which grows with it, is `target`, to [`TOLERANCE`]; and how often it was asked. The
/// last call is at the scale that is returned.
///
/// Secants within a bracket: an evaluation with gradation costs much, and the curve is nearly straight.
pub fn reach(target: f64, mut complexity: impl FnMut(f64) -> f64) -> Result<(f64, u32), Unreachable> {
    let (mut scale, mut slope, mut last) = (0.0f64, FREE_SLOPE, None::<(f64, f64)>);
    let (mut below, mut above) = (f64::NEG_INFINITY, f64::INFINITY);
    let mut nearest = (f64::INFINITY, 0.0);
    for asked in 1..=60 {
        let found = complexity(scale);
        let miss = (found / target).ln();
        if miss.abs() <= TOLERANCE {
            return Ok((scale, asked));
        }
        if miss.abs() < nearest.0 {
            nearest = (miss.abs(), found);
        }
        if miss < 0.0 {
            below = below.max(scale)
        } else {
            above = above.min(scale)
        }
        if let Some((scale_before, miss_before)) = last {
            slope = (miss - miss_before) / (scale - scale_before);
        }
        last = Some((scale, miss));
        // Flatter than any metric whose complexity a scale can still change: a long step tells whether it can.
        let step = if slope > 0.05 {
            (-miss / slope).clamp(-LONGEST_STEP, LONGEST_STEP)
        } else {
            LONGEST_STEP.copysign(-miss)
        };
        let next = scale + step;
        let is_inside = next > below && next < above;
        scale = if is_inside { next } else { 0.5 * (below + above) };
        // A bracket closed to rounding, or a NaN from a complexity that is none.
        let is_over = !(above - below > 1e-9 && scale.abs() <= FARTHEST);
        if is_over {
            break;
        }
    }
    Err(Unreachable { nearest: nearest.1 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_free_metric_takes_two_steps() {
        let (scale, asked) = reach(5000.0, |scale| 3.0 * (1.5 * scale).exp()).unwrap();
        assert!((3.0 * (1.5 * scale).exp() / 5000.0 - 1.0).abs() < 1e-9);
        assert_eq!(asked, 2);
    }

    #[test]
    fn bounds_and_kinks_are_no_trouble() {
        // Saturating at both ends, a kink, and a nearly flat piece between.
        let curves: [fn(f64) -> f64; 3] = [
            |s| 10.0 + 1e6 / (1.0 + (-2.0 * s + 5.0).exp()),
            |s| if s < 3.0 { (0.1 * s).exp() * 100.0 } else { (4.0 * (s - 3.0) + 0.3).exp() * 100.0 },
            |s| (s * 1.5 + (3.0 * s).sin() * 0.4).exp(),
        ];
        for curve in curves {
            for target in [90.0, 200.0, 9e4] {
                let mut last = f64::NAN;
                let (_, asked) = reach(target, |s| {
                    last = curve(s);
                    last
                })
                .unwrap();
                assert!((last / target - 1.0).abs() < 0.003 && asked < 20, "{target} {last} after {asked}");
            }
        }
    }

    #[test]
    fn what_bounds_forbid_is_said() {
        let bounded = |s: f64| (1.5 * s).exp().clamp(10.0, 1000.0);
        assert_eq!(reach(5000.0, bounded), Err(Unreachable { nearest: 1000.0 }));
        assert_eq!(reach(5.0, bounded), Err(Unreachable { nearest: 10.0 }));
        assert!(reach(5.0, |_| f64::NAN).is_err());
        // A jump has no scale of the value within.
        assert!(reach(500.0, |s| if s < 1.0 { 100.0 } else { 900.0 }).is_err());
    }
}
