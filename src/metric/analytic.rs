//! The analytic metric fields of the UGAWG's cube-cylinder (METHOD.md §1.14).
use super::Sym3;
use crate::mesh::vector::Vec3;

/// Least size of the fields.
const H0: f64 = 0.001;
/// Greatest size.
const H1: f64 = 0.1;

/// An analytic metric field over the unit cube, with or without the cylinder of radius 0.5 about the z axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Analytic {
    /// A layer of thickness 0.001 at z = 0.5.
    Linear,
    /// A layer on the cylinder r = 0.5, tangential sizes 0.1.
    Polar1,
    /// The same with the circumferential size down to 1/40 at the cylinder.
    Polar2,
}

impl Analytic {
    /// All fields.
    pub const ALL: [Self; 3] = [Self::Linear, Self::Polar1, Self::Polar2];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Polar1 => "polar-1",
            Self::Polar2 => "polar-2",
        }
    }

    /// The metric at p.
    pub fn at(self, p: Vec3) -> Sym3 {
        self.spectral(p, |h| 1.0 / (h * h))
    }

    /// ln M at p, straight from the sizes: the directions are known.
    pub fn log_at(self, p: Vec3) -> Sym3 {
        self.spectral(p, |h| -2.0 * h.ln())
    }

    /// √det M at p.
    pub fn density_at(self, p: Vec3) -> f64 {
        let [a, b, c] = self.sizes(p[0].hypot(p[1]), p[2]);
        1.0 / (a * b * c)
    }

    /// Whether the ratio of the sizes at p is one that doubles hold for certain. Only far away it is not.
    #[inline]
    pub fn is_moderate(p: Vec3) -> bool {
        p.iter().all(|x| x.abs() < 1e3)
    }

    /// The sizes at a distance from the z axis and a height: along x, y, z; in the polar fields away from the axis, around it, along it.
    #[inline]
    fn sizes(self, r: f64, z: f64) -> [f64; 3] {
        match self {
            Self::Linear => [H1, H1, size(z - 0.5)],
            Self::Polar1 => [size(r - 0.5), H1, H1],
            Self::Polar2 => [size(r - 0.5), circumferential(r), H1],
        }
    }

    /// Σ f(h_i) e_i e_iᵀ.
    #[inline]
    fn spectral(self, p: Vec3, f: impl Fn(f64) -> f64) -> Sym3 {
        let r = p[0].hypot(p[1]);
        let [radial, around, upright] = self.sizes(r, p[2]).map(f);
        if self == Self::Linear {
            return Sym3::diagonal(radial, around, upright);
        }
        // On the axis every direction is radial.
        let (c, s) = if r > 0.0 { (p[0] / r, p[1] / r) } else { (1.0, 0.0) };
        Sym3([
            radial * c * c + around * s * s,
            (radial - around) * c * s,
            radial * s * s + around * c * c,
            0.0,
            0.0,
            upright,
        ])
    }
}

impl std::fmt::Display for Analytic {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl std::str::FromStr for Analytic {
    type Err = super::Error;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Self::ALL.into_iter().find(|field| field.name() == name).ok_or_else(|| super::Error::Name(name.into()))
    }
}

/// Size across the layer, at a distance from its middle.
#[inline]
fn size(distance: f64) -> f64 {
    H0 + 2.0 * (H1 - H0) * distance.abs()
}

/// polar-2's size around the cylinder. The formula holds for r ≥ 0.5, d ≤ 1. Points inside the cylinder (on a chord of a coarse
/// boundary) get the value at its surface; by the formula the size would vanish at r = 0.467.
#[inline]
fn circumferential(r: f64) -> f64 {
    let d = (10.0 * (0.6 - r)).clamp(0.0, 1.0);
    d / 40.0 + H1 * (1.0 - d)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sizes_along(m: &Sym3, directions: [Vec3; 3]) -> [f64; 3] {
        directions.map(|v| 1.0 / m.quadratic(v).sqrt())
    }

    fn assert_close(found: [f64; 3], expected: [f64; 3]) {
        for i in 0..3 {
            assert!((found[i] - expected[i]).abs() < 1e-9 * expected[i], "{found:?} {expected:?}");
        }
    }

    #[test]
    fn sizes_are_moderate_where_it_is_said() {
        for field in Analytic::ALL {
            for p in [[999.0; 3], [0.0; 3], [-999.0, 0.0, 999.0], [0.5, 0.0, -999.0]] {
                assert!(Analytic::is_moderate(p));
                let [greatest, _, least] = field.log_at(p).sizes_of_log();
                assert!(greatest / least < super::super::held::GREATEST_RATIO);
            }
        }
        assert!(!Analytic::is_moderate([0.0, 1e3, 0.0]) && !Analytic::is_moderate([f64::NAN; 3]));
    }

    #[test]
    fn sizes_of_the_fields() {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_close(sizes_along(&Analytic::Linear.at([0.3, 0.9, 0.5]), axes), [0.1, 0.1, 0.001]);
        assert_close(sizes_along(&Analytic::Linear.at([0.3, 0.9, 0.0]), axes), [0.1, 0.1, 0.1]);
        assert_close(sizes_along(&Analytic::Linear.at([0.3, 0.9, 0.75]), axes), [0.1, 0.1, 0.0505]);
        let (c, s) = (0.6, 0.8);
        let polar = [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]];
        let at = |r: f64| [r * c, r * s, 0.2];
        assert_close(sizes_along(&Analytic::Polar1.at(at(0.5)), polar), [0.001, 0.1, 0.1]);
        assert_close(sizes_along(&Analytic::Polar1.at(at(1.0)), polar), [0.1, 0.1, 0.1]);
        assert_close(sizes_along(&Analytic::Polar2.at(at(0.5)), polar), [0.001, 0.025, 0.1]);
        assert_close(sizes_along(&Analytic::Polar2.at(at(0.55)), polar), [0.001 + 0.198 * 0.05, 0.0625, 0.1]);
        assert_close(sizes_along(&Analytic::Polar2.at(at(0.7)), polar), [0.001 + 0.198 * 0.2, 0.1, 0.1]);
    }

    #[test]
    fn logarithms_and_the_axis() {
        for field in Analytic::ALL {
            for p in [[0.0, 0.0, 0.3], [0.0, 0.46, 0.1], [0.31, 0.4, 0.5], [0.9, 0.2, 0.7]] {
                let (m, log) = (field.at(p), field.log_at(p));
                assert!(m.is_spd());
                for i in 0..6 {
                    assert!((m.ln().0[i] - log.0[i]).abs() < 1e-9, "{field} {p:?}");
                }
                assert!((field.density_at(p) / m.det().sqrt() - 1.0).abs() < 1e-12, "{field} {p:?}");
            }
            assert_eq!(field.name().parse::<Analytic>().unwrap(), field);
        }
        assert!("polar-3".parse::<Analytic>().unwrap_err().to_string().contains("polar-2"));
    }
}
