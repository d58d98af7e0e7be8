//! Rules of integration over a tetrahedron.

/// A rule: points by barycentric coordinates, each with its weight; the weights have the sum 1.
pub type Rule = [([f64; 4], f64)];

const A1: f64 = 0.310_885_919_263_300_6;
const A2: f64 = 0.092_735_250_310_891_23;
const A3: f64 = 0.045_503_704_125_649_65;
const WA1: f64 = 0.112_687_925_718_015_85;
const WA2: f64 = 0.073_493_043_116_361_95;
const WA3: f64 = 0.042_546_020_777_081_466;

/// Walkington 2000, 14 points, exact to degree 5.
pub const WALKINGTON: [([f64; 4], f64); 14] = {
    let (r1, r2, h) = (1.0 - 3.0 * A1, 1.0 - 3.0 * A2, 0.5 - A3);
    [
        ([r1, A1, A1, A1], WA1),
        ([A1, r1, A1, A1], WA1),
        ([A1, A1, r1, A1], WA1),
        ([A1, A1, A1, r1], WA1),
        ([r2, A2, A2, A2], WA2),
        ([A2, r2, A2, A2], WA2),
        ([A2, A2, r2, A2], WA2),
        ([A2, A2, A2, r2], WA2),
        ([A3, A3, h, h], WA3),
        ([A3, h, A3, h], WA3),
        ([A3, h, h, A3], WA3),
        ([h, A3, A3, h], WA3),
        ([h, A3, h, A3], WA3),
        ([h, h, A3, A3], WA3),
    ]
};

/// (13 - √91)/52.
const B: f64 = 0.066_550_153_573_664_28;

/// Keast 1986, 15 points, exact to degree 5.
pub const KEAST: [([f64; 4], f64); 15] = {
    let (t, w1) = (1.0 / 3.0, 81.0 / 2240.0);
    let (e, f, w2) = (1.0 / 11.0, 8.0 / 11.0, 161_051.0 / 2_304_960.0);
    let (h, w3) = (0.5 - B, 338.0 / 5145.0);
    [
        ([0.25; 4], 6544.0 / 36015.0),
        ([0.0, t, t, t], w1),
        ([t, 0.0, t, t], w1),
        ([t, t, 0.0, t], w1),
        ([t, t, t, 0.0], w1),
        ([f, e, e, e], w2),
        ([e, f, e, e], w2),
        ([e, e, f, e], w2),
        ([e, e, e, f], w2),
        ([B, B, h, h], w3),
        ([B, h, B, h], w3),
        ([B, h, h, B], w3),
        ([h, B, B, h], w3),
        ([h, B, h, B], w3),
        ([h, h, B, B], w3),
    ]
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_are_exact_to_degree_five() {
        // The mean of λ0^a λ1^b λ2^c λ3^d over a tetrahedron is 3! a! b! c! d! / (a + b + c + d + 3)!.
        let factorial = |n: u32| (1..=n).map(f64::from).product::<f64>();
        for (name, rule) in [("Walkington", &WALKINGTON[..]), ("Keast", &KEAST[..])] {
            for powers in
                [[0, 0, 0, 0], [1, 0, 0, 0], [0, 2, 1, 0], [1, 1, 1, 1], [0, 0, 5, 0], [2, 1, 1, 1], [0, 3, 0, 2]]
            {
                let found: f64 = rule
                    .iter()
                    .map(|(place, weight)| weight * (0..4).map(|i| place[i].powi(powers[i] as i32)).product::<f64>())
                    .sum();
                let exact =
                    6.0 * powers.map(factorial).iter().product::<f64>() / factorial(powers.iter().sum::<u32>() + 3);
                assert!((found - exact).abs() < 1e-14, "{name} {powers:?}: {found} for {exact}");
            }
        }
    }
}
