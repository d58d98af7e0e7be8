//! Sizes that a user prescribes in the layers along a wall.
use super::foot::Foot;
use crate::metric::{Eigen, Sym3};
use crate::sizing::around::grown;
use serde::Serialize;

/// Layers along a wall: their first height, and how they grow. Lengths are in model units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Growth {
    /// Size across the wall, on it.
    pub first: f64,
    /// Ratio of the heights of a layer and the one below it, above 1.
    pub growth: f64,
    /// Size along the wall, on it; without, that of its curvature.
    pub tangential: Option<f64>,
    /// Sizes along the wall are at most this share of √(8 h R), h the size across and R the radius there; none for no such bound.
    pub chord: Option<f64>,
}

/// What sizes are where no layer is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Outside {
    /// Greatest size, model units.
    pub greatest: f64,
    /// Segments n for a radian of the wall's curvature κ: the size along the wall is 1/(n κ).
    pub segments: f64,
}

impl Growth {
    /// h(d), the size across at a distance from the wall.
    pub fn across(&self, distance: f64) -> f64 {
        grown(self.first, self.growth, distance)
    }

    /// Layers so many times as thick at the wall.
    pub fn thicker(&self, factor: f64) -> Self {
        Self { first: factor * self.first, ..*self }
    }

    /// How far from the wall the size across is below another.
    pub fn reach(&self, size: f64) -> f64 {
        (size - self.first).max(0.0) / (self.growth - 1.0)
    }

    /// ln M at a point with this foot: h(d) across, along the wall what its curvature asks for, a share of the chord, or what is given. None where the
    /// layers have grown to the size outside. Sizes along the wall, and outside, are multiplied by `along`.
    pub fn log(&self, foot: &Foot, outside: &Outside, along: f64) -> Option<Sym3> {
        let (across, greatest) = (self.across(foot.distance), outside.greatest * along);
        if across >= greatest {
            return None;
        }
        let along = |i: usize| {
            let on_wall = self.tangential.unwrap_or(1.0 / (outside.segments * foot.bends[i]));
            let size = grown(along * on_wall, self.growth, foot.distance).min(greatest);
            let chord = self.chord.map_or(f64::INFINITY, |share| share * (8.0 * across * foot.radii[i]).sqrt());
            // Cells that are as long as thick follow any wall.
            size.min(chord).max(across)
        };
        let [first, second] = foot.directions;
        let values = [across, along(0), along(1)].map(|h| -2.0 * h.ln());
        Some(Sym3::from_eigen(&Eigen { values, vectors: [foot.normal, first, second] }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::vector::{Vec3, dot};

    const OUTSIDE: Outside = Outside { greatest: 0.1, segments: 2.0 };

    /// About a cylinder of radius 0.5 along z, at a distance outside of it.
    fn foot(distance: f64) -> Foot {
        let radius = 0.5 + distance;
        Foot {
            distance,
            normal: [1.0, 0.0, 0.0],
            directions: [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            curvatures: [1.0 / radius, 0.0],
            bends: [2.0, 0.0],
            radii: [radius, f64::INFINITY],
            is_inside: true,
        }
    }

    fn size(log: &Sym3, direction: Vec3) -> f64 {
        let eigen = log.eigen();
        (0..3).map(|i| eigen.values[i].exp() * dot(eigen.vectors[i], direction).powi(2)).sum::<f64>().powf(-0.5)
    }

    #[test]
    fn sizes_across_and_along_a_cylinder() {
        let growth = Growth { first: 1e-5, growth: 1.2, tangential: None, chord: Some(0.5) };
        for distance in [0.0, 1e-5, 1e-3, 0.1] {
            let foot = foot(distance);
            let log = growth.log(&foot, &OUTSIDE, 1.0).unwrap();
            let across = 1e-5 + 0.2 * distance;
            let chord = 0.5 * (8.0 * across * (0.5 + distance)).sqrt();
            for (direction, expected) in
                [(foot.normal, across), (foot.directions[0], chord.min(0.1)), (foot.directions[1], 0.1)]
            {
                assert!((size(&log, direction) / expected - 1.0).abs() < 1e-9, "{distance} {direction:?}");
            }
        }
        assert_eq!(growth.log(&foot(0.6), &OUTSIDE, 1.0), None, "the layers have grown to the size outside");
        assert!((growth.reach(0.1) - 0.49995).abs() < 1e-12);
    }

    #[test]
    fn without_a_chord_the_curvature_decides_or_what_is_given() {
        let growth = Growth { first: 1e-5, growth: 1.2, tangential: None, chord: None };
        let along = |growth: Growth| {
            let log = growth.log(&foot(0.0), &Outside { greatest: 1.0, segments: 10.0 }, 1.0).unwrap();
            [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|direction| size(&log, direction))
        };
        let near = |found: [f64; 2], expected: [f64; 2]| {
            assert!((0..2).all(|i| (found[i] / expected[i] - 1.0).abs() < 1e-9), "{found:?} {expected:?}");
        };
        near(along(growth), [0.05, 1.0]);
        near(along(Growth { tangential: Some(0.02), ..growth }), [0.02, 0.02]);
        near(along(Growth { tangential: Some(0.02), chord: Some(0.5), ..growth }), [0.5 * (4e-5_f64).sqrt(), 0.02]);
    }

    #[test]
    fn an_edge_has_cells_that_are_as_long_as_thick_about_it() {
        let growth = Growth { first: 1e-4, growth: 1.2, tangential: None, chord: Some(0.5) };
        let edge = Foot { bends: [f64::INFINITY, 0.0], radii: [1e-3, f64::INFINITY], ..foot(1e-3) };
        let log = growth.log(&edge, &OUTSIDE, 1.0).unwrap();
        let (across, chord) = (3e-4, 0.5 * (8.0 * 3e-4 * 1e-3_f64).sqrt());
        assert!((size(&log, edge.normal) / across - 1.0).abs() < 1e-9);
        assert!((size(&log, edge.directions[0]) / chord.min(across) - 1.0).abs() < 1e-9);
    }
}
