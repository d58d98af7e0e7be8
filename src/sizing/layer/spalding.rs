//! Spalding's law of the wall (METHOD.md §1.15): u⁺ of y⁺, and the height of a y⁺ from Reynolds' number.

/// Kármán's constant.
pub const KAPPA: f64 = 0.41;
/// The constant of the logarithmic law.
pub const B: f64 = 5.0;

/// The u⁺ at which |d²u⁺/dy⁺²| is greatest: y⁺ = 7.065.
const PEAK: f64 = 6.53646;

/// u⁺ at a place, with its derivatives by y⁺.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Velocity {
    /// u⁺.
    pub value: f64,
    /// du⁺/dy⁺, positive.
    pub first: f64,
    /// d²u⁺/dy⁺², negative.
    pub second: f64,
}

/// y⁺ of u⁺ and its first two derivatives: y⁺ = u⁺ + e^(−κB) (e^(κu⁺) − 1 − κu⁺ − (κu⁺)²/2 − (κu⁺)³/6) (Spalding, J. Appl. Mech. 28, 1961).
pub fn height(u: f64) -> [f64; 3] {
    let (x, factor) = (KAPPA * u, (-KAPPA * B).exp());
    let fourth = rest(x);
    let third = fourth + x * x * x / 6.0;
    let second = third + 0.5 * x * x;
    [u + factor * fourth, 1.0 + factor * KAPPA * third, factor * KAPPA * KAPPA * second]
}

/// e^x − 1 − x − x²/2 − x³/6. Where the terms cancel, by its series.
fn rest(x: f64) -> f64 {
    if x > 1.5 {
        return x.exp() - 1.0 - x * (1.0 + x * (0.5 + x / 6.0));
    }
    let (mut term, mut sum) = (x * x * x * x / 24.0, 0.0);
    for k in 5..30 {
        sum += term;
        term *= x / f64::from(k);
    }
    sum
}

/// u⁺ at y⁺ ≥ 0, by Newton's steps.
pub fn velocity(y: f64) -> Velocity {
    let mut u = y.min((1.0 + y * (KAPPA * B).exp()).ln() / KAPPA);
    for _ in 0..40 {
        let [at, slope, _] = height(u);
        let step = (at - y) / slope;
        u = (u - step).max(0.0);
        if step.abs() <= 1e-14 * u {
            break;
        }
    }
    let [_, slope, bend] = height(u);
    Velocity { value: u, first: 1.0 / slope, second: -bend / (slope * slope * slope) }
}

/// The same, but nearer to the wall than y⁺ = 7 with the second derivative of there, where it is greatest. At the wall u⁺ is linear and asks for
/// no cells, but what is solved for is not only u⁺: the sizes of the buffer layer go on to the wall.
pub fn held_velocity(y: f64) -> Velocity {
    let velocity = velocity(y);
    if velocity.value >= PEAK {
        return velocity;
    }
    let [_, slope, bend] = height(PEAK);
    Velocity { second: -bend / (slope * slope * slope), ..velocity }
}

/// The height of y⁺ = 1, ν/u_τ, in units of the length: u_τ = U √(c_f/2), c_f = 0.026 Re^(−1/7) of a flat plate (METHOD.md §1.15). `reynolds` is U L/ν,
/// of this `length` L.
pub fn viscous_length(reynolds: f64, length: f64) -> f64 {
    length / (reynolds * (0.5 * friction(reynolds)).sqrt())
}

/// The coefficient of friction of a turbulent flat plate, 0.026 Re^(−1/7).
pub fn friction(reynolds: f64) -> f64 {
    0.026 * reynolds.powf(-1.0 / 7.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_law_is_linear_at_the_wall_and_logarithmic_far_away() {
        for y in [0.0, 1e-9, 1e-3, 0.1] {
            assert!((velocity(y).value - y).abs() <= 1e-4 * y, "{y}");
        }
        for y in [1e3, 1e5, 1e7] {
            let logarithmic = f64::ln(y) / KAPPA + B;
            assert!((velocity(y).value - logarithmic).abs() < 0.1, "{y}");
        }
        // Between, to the figures of a table of the law: u⁺ = 10 has y⁺ = 10 + e^-2.05 (e^4.1 − 1 − 4.1 − 8.405 − 11.486833…).
        let y = 10.0 + f64::exp(-2.05) * (f64::exp(4.1) - 1.0 - 4.1 - 8.405 - 4.1_f64.powi(3) / 6.0);
        assert!((velocity(y).value - 10.0).abs() < 1e-12);
    }

    #[test]
    fn the_inverse_is_exact_and_its_derivatives_are_those_of_differences() {
        for i in -60..140 {
            let y = 1.2_f64.powi(i);
            let Velocity { value, first, second } = velocity(y);
            assert!((height(value)[0] / y - 1.0).abs() < 1e-13, "{y}");
            let e = 1e-3 * y;
            let [below, above] = [velocity(y - e), velocity(y + e)];
            assert!(((above.value - below.value) / (2.0 * e) / first - 1.0).abs() < 1e-5, "{y}");
            let difference = (above.first - below.first) / (2.0 * e);
            assert!((difference - second).abs() <= 1e-4 * second.abs() + 1e-12 / y, "{y} {difference} {second}");
        }
    }

    #[test]
    fn the_second_derivative_is_held_where_it_is_greatest() {
        let most = (1..20_000).map(|i| velocity(f64::from(i) * 1e-3).second.abs()).fold(0.0, f64::max);
        assert!((held_velocity(0.0).second.abs() / most - 1.0).abs() < 1e-6, "{most}");
        assert_eq!(held_velocity(30.0), velocity(30.0));
        let [y, ..] = height(PEAK);
        assert!((held_velocity(0.999 * y).second / velocity(1.001 * y).second - 1.0).abs() < 1e-5, "it has no jump");
    }

    #[test]
    fn the_first_height_of_a_plate() {
        // Re = 6e6: c_f = 0.026 · 0.1075 = 2.796e-3, u_τ/U = 0.03739, so y⁺ = 1 is at 4.457e-6 of the length.
        let y = viscous_length(6e6, 1.0);
        assert!((y / 4.457e-6 - 1.0).abs() < 2e-3, "{y}");
        assert!((viscous_length(6e6, 2.0) / y - 2.0).abs() < 1e-15);
    }
}
