//! Axes: from values to pixels, with ticks at round numbers.
use super::text::short;

/// One axis.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Values at the ends; their logarithms on a logarithmic axis.
    ends: [f64; 2],
    logarithmic: bool,
    /// Pixels at the ends.
    pixels: [f64; 2],
}

impl Axis {
    /// An axis that shows all the values, with some room at the ends.
    pub fn of(values: &[f64], logarithmic: bool, pixels: [f64; 2]) -> Self {
        let placed = values.iter().map(|&value| if logarithmic { value.log10() } else { value });
        let [low, high] = placed.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
        let room = if high > low { 0.06 * (high - low) } else { 0.1 * low.abs().max(1e-12) };
        Self { ends: [low - room, high + room], logarithmic, pixels }
    }

    /// A linear axis from 0 to a value.
    pub fn from_zero(high: f64, pixels: [f64; 2]) -> Self {
        Self { ends: [0.0, if high > 0.0 { high } else { 1.0 }], logarithmic: false, pixels }
    }

    /// The pixel of a value.
    pub fn at(&self, value: f64) -> f64 {
        let placed = if self.logarithmic { value.log10() } else { value };
        let [low, high] = self.ends;
        self.pixels[0] + (placed - low) / (high - low) * (self.pixels[1] - self.pixels[0])
    }

    /// Round values within the ends, about six, each with its text.
    pub fn ticks(&self) -> Vec<(f64, String)> {
        let [low, high] = self.ends;
        let values: Vec<f64> = if self.logarithmic {
            let decades = high - low;
            let digits: &[f64] = match decades {
                d if d > 2.5 => &[1.0],
                d if d > 1.2 => &[1.0, 3.0],
                _ => &[1.0, 2.0, 3.0, 5.0, 7.0],
            };
            let stride = (decades / 6.0).ceil().max(1.0) as i32;
            let powers = (low.floor() as i32..=high.ceil() as i32).filter(|power| power.rem_euclid(stride) == 0);
            let all = powers.flat_map(|power| digits.iter().map(move |digit| digit * 10f64.powi(power)));
            all.filter(|value| (low..=high).contains(&value.log10())).collect()
        } else {
            let step = round_step((high - low) / 5.0);
            let first = (low / step).ceil() as i64;
            let last = (high / step + 1e-9).floor() as i64;
            (first..=last).map(|n| n as f64 * step).collect()
        };
        values.into_iter().map(|value| (value, short(value))).collect()
    }
}

/// The least of 1, 2, 5 times a power of ten that is not below a step.
fn round_step(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|digit| digit * power).find(|&round| round >= step * 0.999).unwrap_or(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_and_ticks() {
        let axis = Axis::of(&[0.0, 10.0], false, [100.0, 0.0]);
        assert!((axis.at(5.0) - 50.0).abs() < 1e-9);
        let texts = |axis: &Axis| axis.ticks().into_iter().map(|(_, text)| text).collect::<Vec<_>>();
        assert_eq!(texts(&axis), ["0", "5", "10"]);
        let axis = Axis::of(&[100.0, 10_000.0], true, [0.0, 200.0]);
        assert!((axis.at(1000.0) - 100.0).abs() < 1e-9);
        assert_eq!(texts(&axis), ["100", "300", "1000", "3000", "10000"]);
        assert_eq!(texts(&Axis::from_zero(8.0, [0.0, 1.0])), ["0", "2", "4", "6", "8"]);
        // A value that does not change has an axis too.
        assert!(Axis::of(&[2.0, 2.0], false, [0.0, 1.0]).at(2.0).is_finite());
    }
}
