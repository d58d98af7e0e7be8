//! Analytic scalar fields to try adaptation on, and the error of their linear interpolation on a mesh.
//!
//! The three functions of Tsolakis 2021 (equations 21 to 23), on the unit cube.
use crate::mesh::TetMesh;
use crate::mesh::quadrature::{KEAST, Rule, WALKINGTON};
use crate::mesh::vector::{Vec3, volume6};
use crate::tasks::Team;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// An analytic scalar.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scalar {
    /// Waves of two amplitudes; continuous, with kinks where the amplitude changes.
    Sinfun3,
    /// Two fronts beside y = 0.3, and at z = 0 a layer that is 1e-6 thin at its thinnest.
    Tanh3,
    /// Small waves, and a jump of π where sin 5y = 2xz.
    Sinatan3,
}

impl Scalar {
    /// All functions.
    pub const ALL: [Self; 3] = [Self::Sinfun3, Self::Tanh3, Self::Sinatan3];

    /// As the command line spells it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sinfun3 => "sinfun3",
            Self::Tanh3 => "tanh3",
            Self::Sinatan3 => "sinatan3",
        }
    }

    /// The value at p.
    pub fn at(self, [x, y, z]: Vec3) -> f64 {
        match self {
            Self::Sinfun3 => {
                let s = (x - 0.4) * (y - 0.4) * (z - 0.4);
                let wide = s > -PI / 50.0 && s <= 2.0 * PI / 50.0;
                (if wide { 1.0 } else { 0.1 }) * (50.0 * s).sin()
            }
            Self::Tanh3 => ((x + 1.3).powi(20) * (y - 0.3).powi(9) * z).tanh(),
            Self::Sinatan3 => 0.1 * (50.0 * x * z).sin() + (0.1 / ((5.0 * y).sin() - 2.0 * x * z)).atan(),
        }
    }

    /// Values at the vertices of a mesh, shape (n,).
    pub fn on(self, team: Team<'_>, mesh: &TetMesh) -> Vec<f64> {
        team.map(GRAIN, mesh.vertices.len(), |v| self.at(mesh.vertices[v]))
    }

    /// The L2 norm of the difference between this function and the piecewise linear one with these values at the vertices, shape (n,).
    ///
    /// Each tetrahedron is integrated by two rules of degree 5, which agree up to that degree. Where they differ by more than a tenth of the
    /// integral (or of the mean integral, where that is more) the tetrahedron is cut into eight, [`HALVINGS`] times at most.
    pub fn error(self, team: Team<'_>, mesh: &TetMesh, values: &[f64]) -> f64 {
        let tets = &mesh.tets.nodes;
        let piece = |tet: [u32; 4]| Piece {
            corners: tet.map(|v| mesh.vertices[v as usize]),
            values: tet.map(|v| values[v as usize]),
        };
        let rough =
            team.sum(GRAIN, tets.len(), |range| tets[range].iter().map(|&tet| piece(tet).squares(self)[0]).sum());
        let mean = rough / tets.len().max(1) as f64;
        let all = team.sum(GRAIN, tets.len(), |range| {
            tets[range].iter().map(|&tet| piece(tet).integral(self, mean, HALVINGS)).sum()
        });
        all.sqrt()
    }
}

/// Tetrahedra a task: each takes some microseconds.
const GRAIN: usize = 256;

/// Most halvings of a tetrahedron. A jump is then within a 32nd of it.
const HALVINGS: u32 = 5;

/// The two rules may differ by this share of the integral.
const DOUBT: f64 = 0.1;

/// The pairs of corners whose middles are the corners of the eight halves: four at the corners, four about a diagonal of the octahedron between.
const HALVES: [[[usize; 2]; 4]; 8] = [
    [[0, 0], [0, 1], [0, 2], [0, 3]],
    [[1, 0], [1, 1], [1, 2], [1, 3]],
    [[2, 0], [2, 1], [2, 2], [2, 3]],
    [[3, 0], [3, 1], [3, 2], [3, 3]],
    [[0, 1], [2, 3], [0, 2], [0, 3]],
    [[0, 1], [2, 3], [0, 3], [1, 3]],
    [[0, 1], [2, 3], [1, 3], [1, 2]],
    [[0, 1], [2, 3], [1, 2], [0, 2]],
];

/// A tetrahedron with a linear function.
#[derive(Clone, Copy)]
struct Piece {
    corners: [Vec3; 4],
    values: [f64; 4],
}

impl Piece {
    /// ∫ (function - linear)² by both rules.
    fn squares(&self, function: Scalar) -> [f64; 2] {
        let [a, b, c, d] = self.corners;
        let volume = volume6(a, b, c, d).abs() / 6.0;
        [&WALKINGTON[..], &KEAST[..]].map(|rule| volume * self.mean_square(function, rule))
    }

    fn mean_square(&self, function: Scalar, rule: &Rule) -> f64 {
        let at = |place: &[f64; 4]| {
            let point = std::array::from_fn(|axis| (0..4).map(|i| place[i] * self.corners[i][axis]).sum());
            let linear: f64 = (0..4).map(|i| place[i] * self.values[i]).sum();
            function.at(point) - linear
        };
        rule.iter().map(|(place, weight)| weight * at(place).powi(2)).sum()
    }

    /// The integral, to a tenth of itself or of `mean`.
    fn integral(&self, function: Scalar, mean: f64, halvings: u32) -> f64 {
        let [first, second] = self.squares(function);
        let found = (first + second) / 2.0;
        if halvings == 0 || (first - second).abs() <= DOUBT * found.max(mean) {
            return found;
        }
        HALVES.iter().map(|pairs| self.half(pairs).integral(function, mean / 8.0, halvings - 1)).sum()
    }

    fn half(&self, pairs: &[[usize; 2]; 4]) -> Self {
        let middle =
            |[i, j]: [usize; 2]| std::array::from_fn(|axis| (self.corners[i][axis] + self.corners[j][axis]) / 2.0);
        Self { corners: pairs.map(middle), values: pairs.map(|[i, j]| (self.values[i] + self.values[j]) / 2.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    #[test]
    fn values_of_the_dissertations_functions() {
        // Computed by cases/convergence_study/scalars.py.
        let p = [0.3, 0.7, 0.9];
        let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        close(Scalar::Sinfun3.at(p), -0.681_638_760_023_334_2);
        close(Scalar::Tanh3.at(p), 0.993_359_753_333_667_1);
        close(Scalar::Sinatan3.at(p), -0.031_414_261_166_846_31);
    }

    #[test]
    fn rules_are_exact_to_degree_five() {
        // ∫ of λ0^a λ1^b λ2^c λ3^d over its mean: 3! a! b! c! d! / (a+b+c+d+3)!.
        let factorial = |n: u32| (1..=n).map(f64::from).product::<f64>();
        for rule in [&WALKINGTON[..], &KEAST[..]] {
            for powers in
                [[0, 0, 0, 0], [1, 0, 0, 0], [2, 1, 0, 0], [1, 1, 1, 1], [2, 1, 1, 1], [5, 0, 0, 0], [3, 2, 0, 0]]
            {
                let term = |place: &[f64; 4]| (0..4).map(|i| place[i].powi(powers[i] as i32)).product::<f64>();
                let found: f64 = rule.iter().map(|(place, weight)| weight * term(place)).sum();
                let exact = 6.0 * powers.iter().map(|&n| factorial(n)).product::<f64>()
                    / factorial(powers.iter().sum::<u32>() + 3);
                assert!((found - exact).abs() < 1e-14, "{powers:?}: {found} {exact}");
            }
        }
    }

    #[test]
    fn the_error_is_that_of_the_study_and_falls_with_the_square_of_the_size() {
        let error = |n: u32| {
            let mesh = cube(n);
            Scalar::Sinfun3.error(Team::alone(), &mesh, &Scalar::Sinfun3.on(Team::alone(), &mesh))
        };
        let (coarse, fine) = (error(16), error(32));
        assert!((coarse / fine - 4.0).abs() < 1.0, "{coarse} {fine}");
        // cases/convergence_study/quadrature.py on the same mesh; its second function jumps.
        assert!((coarse - 0.033_345).abs() < 2e-4, "{coarse}");
        let mesh = cube(16);
        let jump = Scalar::Sinatan3.error(Team::alone(), &mesh, &Scalar::Sinatan3.on(Team::alone(), &mesh));
        assert!((jump - 0.3555).abs() < 0.02 * 0.3555, "{jump}");
    }
}
