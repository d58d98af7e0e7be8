//! Weights of terms: given, or the derivatives of an adjoint by direction, each in absolute value.
use super::Error;
use crate::mesh::TetMesh;
use crate::metric::recovery::{Recovery, Rings, gradients};
use crate::tasks::{GRAIN, Team};
use std::fmt;
use std::str::FromStr;

/// A derivative by directions, which count from 0: x, y, z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Derivative {
    /// ∂_i.
    First(usize),
    /// ∂_i ∂_j.
    Second(usize, usize),
}

const DIRECTIONS: [char; 3] = ['x', 'y', 'z'];

impl FromStr for Derivative {
    type Err = String;

    /// Of `x`, `xy` and so on.
    fn from_str(text: &str) -> Result<Self, String> {
        let found: Option<Vec<usize>> = text.chars().map(|c| DIRECTIONS.iter().position(|&d| d == c)).collect();
        match found.as_deref() {
            Some(&[i]) => Ok(Self::First(i)),
            Some(&[i, j]) => Ok(Self::Second(i, j)),
            _ => Err(format!("'{text}' is no derivative: give x, y, z, or two of them, xx, xy and so on")),
        }
    }
}

impl fmt::Display for Derivative {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::First(i) => write!(f, "{}", DIRECTIONS[i]),
            Self::Second(i, j) => write!(f, "{}{}", DIRECTIONS[i], DIRECTIONS[j]),
        }
    }
}

/// The weight of a term, at the vertices.
#[derive(Clone, Copy, Debug)]
pub enum Weight<'f> {
    /// Values from 0 on, shape (n,).
    Given(&'f [f64]),
    /// Σ |c| |∂λ| of an adjoint λ, shape (n,), with a coefficient for each derivative: |b_x| for `x` of an advection b ∂_x u, ε for `xx` of a
    /// diffusion ε ∂_xx u.
    Adjoint(&'f [f64], &'f [(Derivative, f64)]),
}

impl Weight<'_> {
    /// Its values, shape (n,).
    pub(super) fn values(
        self,
        team: Team<'_>,
        mesh: &TetMesh,
        rings: &Rings,
        recovery: Recovery,
    ) -> Result<Vec<f64>, Error> {
        let values = match self {
            Self::Given(values) => values.to_vec(),
            Self::Adjoint(adjoint, coefficients) => {
                check_finite(team, adjoint)?;
                let has =
                    |second: bool| coefficients.iter().any(|(d, _)| matches!(d, Derivative::Second(..)) == second);
                let first = if has(false) { gradients(team, mesh, rings, adjoint) } else { Vec::new() };
                let second = if has(true) { recovery.hessians(team, mesh, rings, adjoint).0 } else { Vec::new() };
                let of = |v: usize, derivative: Derivative| match derivative {
                    Derivative::First(i) => first[v][i],
                    Derivative::Second(i, j) => second[v].at(i, j),
                };
                team.map(GRAIN, adjoint.len(), |v| {
                    coefficients.iter().map(|&(derivative, c)| (c * of(v, derivative)).abs()).sum()
                })
            }
        };
        let wrong = |v: usize| !(values[v] >= 0.0 && values[v].is_finite());
        match team.first(GRAIN, values.len(), wrong) {
            Some(vertex) => Err(Error::Weight { vertex, value: values[vertex] }),
            None => Ok(values),
        }
    }
}

/// Refuses what is not finite.
fn check_finite(team: Team<'_>, values: &[f64]) -> Result<(), Error> {
    match team.first(GRAIN, values.len(), |v| !values[v].is_finite()) {
        Some(vertex) => Err(Error::NotFinite { vertex }),
        None => Ok(()),
    }
}
