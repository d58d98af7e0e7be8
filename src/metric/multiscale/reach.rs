//! The scale at which a metric has a given complexity.

/// Complexities that differ by less than this share are equal.
const TOLERANCE: f64 = 2e-3;

/// A metric that is scaled once more afterwards may differ from the target complexity by this share.
pub const NEARLY: f64 = 0.09;

/// ln C grows by 3/2 of the logarithm of the scale where nothing bounds the sizes.
const FREE_SLOPE: f64 = 1.5;

/// The logarithm of the scale of M moves by no more than this in a step,
const LONGEST_STEP: f64 = 8.0;

/// and by no more than this in all: a factor of 1e17.
const FARTHEST: f64 = 40.0;

/// No scale has that complexity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unreachable {
    /// The complexity wanted.
    pub target: f64,
    /// The complexity that came nearest.
    pub nearest: f64,
}

/// A complexity as a user may give it back: five digits, whole from 10 000 on. It is that complexity within [`TOLERANCE`].
pub fn five_digits(complexity: f64) -> String {
    let digits = if complexity > 0.0 { (4.0 - complexity.log10().floor()).clamp(0.0, 9.0) } else { 0.0 };
    format!("{complexity:.*}", digits as usize)
}

/// The logarithm of the scale at which `complexity`, which grows with the scale, is `target`, to [`TOLERANCE`]; and how often it was
/// called. The last call is at the scale that is returned.
///
/// By secants, since a call with gradation costs much and the curve is nearly straight. When two secants have not halved the bracket, it
/// is bisected.
pub fn reach(target: f64, mut complexity: impl FnMut(f64) -> f64) -> Result<(f64, u32), Unreachable> {
    try_reach(target, |scale| Ok(complexity(scale)))
}

/// As [`reach`], of a complexity that may not be had.
pub fn try_reach<E: From<Unreachable>>(
    target: f64,
    complexity: impl FnMut(f64) -> Result<f64, E>,
) -> Result<(f64, u32), E> {
    reach_within(TOLERANCE, target, 0.0, complexity)
}

/// As [`try_reach`], to a tolerance, from a first guess of the scale.
pub fn reach_within<E: From<Unreachable>>(
    tolerance: f64,
    target: f64,
    guess: f64,
    mut complexity: impl FnMut(f64) -> Result<f64, E>,
) -> Result<(f64, u32), E> {
    let (mut scale, mut slope, mut last) = (guess, FREE_SLOPE, None::<(f64, f64)>);
    let (mut below, mut above) = (f64::NEG_INFINITY, f64::INFINITY);
    // How wide the bracket was when it was last halved, and how often not since.
    let (mut width, mut patience) = (f64::INFINITY, 0);
    let mut nearest = (f64::INFINITY, 0.0);
    for asked in 1..=60 {
        let found = complexity(scale)?;
        let miss = (found / target).ln();
        if miss.abs() <= tolerance {
            return Ok((scale, asked));
        }
        if miss.abs() < nearest.0 {
            nearest = (miss.abs(), found);
        }
        if miss < 0.0 {
            below = scale;
        } else {
            above = scale;
        }
        if let Some((scale_before, miss_before)) = last {
            slope = (miss - miss_before) / (scale - scale_before);
        }
        last = Some((scale, miss));
        (width, patience) = if above - below <= 0.5 * width { (above - below, 2) } else { (width, patience - 1) };
        // Where the curve is flat, a long step tells whether the scale can still change the complexity.
        let step = if slope > 0.05 { -miss / slope } else { f64::INFINITY.copysign(-miss) };
        let next = scale + step.clamp(-LONGEST_STEP, LONGEST_STEP);
        let is_bracketed = below.is_finite() && above.is_finite();
        scale = if is_bracketed && (patience < 0 || !(below < next && next < above)) {
            0.5 * (below + above)
        } else {
            next
        };
        // The bracket has closed (the complexity jumps), the scale is far away (a bound holds it), or the complexity is not a number.
        if above - below < 1e-9 || scale.is_nan() || scale.abs() > FARTHEST {
            break;
        }
    }
    Err(Unreachable { target, nearest: nearest.1 }.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_complexity_that_is_told_can_be_given_back() {
        for complexity in [3e-5, 0.0123456, 1.0, 695.94, 1166.2, 98765.4, 1e7 / 3.0] {
            let told = five_digits(complexity);
            assert!(
                (told.parse::<f64>().unwrap() / complexity - 1.0).abs() < TOLERANCE && !told.contains('e'),
                "{told}"
            );
        }
        assert_eq!([1166.2, 98765.4, 0.0].map(five_digits), ["1166.2", "98765", "0"]);
    }

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
        assert_eq!(reach(5000.0, bounded), Err(Unreachable { target: 5000.0, nearest: 1000.0 }));
        assert_eq!(reach(5.0, bounded), Err(Unreachable { target: 5.0, nearest: 10.0 }));
        assert!(reach(5.0, |_| f64::NAN).is_err());
        // A jump has no scale of the value within.
        assert!(reach(500.0, |s| if s < 1.0 { 100.0 } else { 900.0 }).is_err());
    }
}
