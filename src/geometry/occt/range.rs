//! Parameters and their ranges.

/// A parameter may be outside its range by this share of it from rounding alone.
const ROUNDING: f64 = 1e-12;

/// Takes `x` into the range, by the period or else to the nearer end. Also returns whether it lay in the range, but for rounding.
pub fn place(x: f64, range: [f64; 2], period: Option<f64>) -> (f64, bool) {
    let [low, high] = range;
    let x = match period {
        // The window of one period around the range's middle.
        Some(period) if x < low || x > high => x - period * ((x - 0.5 * (low + high)) / period).round(),
        _ => x,
    };
    let slack = ROUNDING * (high - low);
    (x.clamp(low, high), x >= low - slack && x <= high + slack)
}

/// `x` moved by whole periods to within half a period of `near`.
pub fn bring_near(x: f64, near: f64, period: Option<f64>) -> f64 {
    period.map_or(x, |period| x - period * ((x - near) / period).round())
}

/// The longest steps of a descent: half of the ranges.
pub fn longest(ranges: [[f64; 2]; 2]) -> [f64; 2] {
    ranges.map(|[low, high]| 0.5 * (high - low))
}

/// Whether the range spans the whole period.
pub fn is_whole(range: [f64; 2], period: Option<f64>) -> bool {
    period.is_some_and(|period| range[1] - range[0] >= period * (1.0 - 1e-9))
}

/// Width of the interval between two breaks that `t` lies in, or of the range where there are none about it.
pub fn span_about(breaks: &[f64], range: [f64; 2], t: f64) -> f64 {
    let about = breaks.windows(2).find(|pair| pair[0] <= t && t <= pair[1]);
    about.map_or(range[1] - range[0], |pair| pair[1] - pair[0])
}
