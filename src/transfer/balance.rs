//! The last correction: the integral of a component is brought to its target, within its bounds.
use super::mass::sums;
use crate::tasks::{GRAIN, Team};
use std::convert::Infallible;

/// Rounds. The first does it, the others correct what rounding has left.
const ROUNDS: usize = 4;

/// A component of rows of values, wherever they are.
pub trait Medium {
    /// Why they cannot be had.
    type Error;

    /// Σ weight·value, and Σ |weight·value|.
    ///
    /// # Errors
    /// When values cannot be had.
    fn masses(&self) -> Result<[f64; 2], Self::Error>;

    /// Σ weight·(goal − value).
    ///
    /// # Errors
    /// As there.
    fn room(&self, goal: Goal) -> Result<f64, Self::Error>;

    /// Moves each value by this part of its way to the goal ([`Goal::moved`]).
    ///
    /// # Errors
    /// As there.
    fn go(&mut self, goal: Goal, part: f64) -> Result<(), Self::Error>;
}

/// Where values go to.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    /// Up, or down.
    up: bool,
    /// Bounds of all vertices, where those of each vertex do not count.
    overall: Option<[f64; 2]>,
}

impl Goal {
    /// That of a vertex with these bounds.
    #[inline]
    pub fn of(&self, bounds: [f64; 2]) -> f64 {
        let [low, high] = self.overall.unwrap_or(bounds);
        if self.up { high } else { low }
    }

    /// A value after a part of its way.
    #[inline]
    pub fn moved(&self, value: f64, bounds: [f64; 2], part: f64) -> f64 {
        let goal = self.of(bounds);
        let moved = value + part * (goal - value);
        if self.up { moved.min(goal.max(value)) } else { moved.max(goal.min(value)) }
    }
}

/// Moves each value towards the bound of its vertex, all by the same part of the way, such that Σ weight·value becomes `target`. Where
/// all the way is not enough, the bounds of all vertices count. Returns by how much the sum was changed.
///
/// # Errors
/// Those of the medium.
pub fn balance<M: Medium>(values: &mut M, overall: [f64; 2], target: f64) -> Result<f64, M::Error> {
    let first = values.masses()?;
    let mut now = first;
    for round in 0..ROUNDS {
        let missing = target - now[0];
        if missing.abs() <= f64::EPSILON * now[1] {
            break;
        }
        // The first rounds use each vertex' own bounds. If these are not wide enough, the later ones use the bounds of all vertices.
        let goal = Goal { up: missing > 0.0, overall: (2 * round >= ROUNDS).then_some(overall) };
        let room = values.room(goal)?;
        if room == 0.0 {
            continue;
        }
        values.go(goal, (missing / room).clamp(0.0, 1.0))?;
        now = values.masses()?;
    }
    Ok(now[0] - first[0])
}

/// A component of rows in memory.
pub struct InMemory<'v> {
    /// Who works on it.
    pub team: Team<'v>,
    /// Number of values in a row.
    pub width: usize,
    /// Which of them.
    pub component: usize,
    /// Rows of values, shape (n, width).
    pub values: &'v mut [f64],
    /// Of all values.
    pub bounds: &'v [[f64; 2]],
    /// Of the vertices, shape (n,).
    pub weights: &'v [f64],
}

impl InMemory<'_> {
    fn at(&self, v: usize) -> usize {
        v * self.width + self.component
    }
}

impl Medium for InMemory<'_> {
    type Error = Infallible;

    fn masses(&self) -> Result<[f64; 2], Infallible> {
        let found = sums(self.team, self.weights.len(), 2, |v, row| {
            let term = self.weights[v] * self.values[self.at(v)];
            (row[0], row[1]) = (term, term.abs());
        });
        Ok([found[0], found[1]])
    }

    fn room(&self, goal: Goal) -> Result<f64, Infallible> {
        let term = |v: usize| self.weights[v] * (goal.of(self.bounds[self.at(v)]) - self.values[self.at(v)]);
        Ok(sums(self.team, self.weights.len(), 1, |v, row| row[0] = term(v))[0])
    }

    fn go(&mut self, goal: Goal, part: f64) -> Result<(), Infallible> {
        let Self { width, component, bounds, .. } = *self;
        self.team.fill(width * GRAIN, self.values, |start, rows| {
            for (row, v) in rows.chunks_exact_mut(width).zip(start / width..) {
                row[component] = goal.moved(row[component], bounds[v * width + component], part);
            }
        });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn balanced(values: &[f64], bounds: &[[f64; 2]], target: f64) -> Vec<f64> {
        let (mut values, weights) = (values.to_vec(), [1.0, 2.0, 3.0]);
        let (team, width, component) = (Team::alone(), 1, 0);
        let mut medium = InMemory { team, width, component, values: &mut values, bounds, weights: &weights };
        let Ok(_) = balance(&mut medium, [0.0, 10.0], target);
        values
    }

    #[test]
    fn towards_the_bounds_as_far_as_needed() {
        let bounds = [[0.0, 4.0], [2.0, 2.0], [1.0, 5.0]];
        // From 1 + 4 + 9 = 14 by 4.5 of the 9 that there is room for; what has no room stays.
        assert_eq!(balanced(&[1.0, 2.0, 3.0], &bounds, 18.5), [2.5, 2.0, 4.0]);
        // Down by 3.5 of 7.
        assert_eq!(balanced(&[1.0, 2.0, 3.0], &bounds, 10.5), [0.5, 2.0, 2.0]);
        assert_eq!(balanced(&[1.0, 2.0, 3.0], &bounds, 14.0), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn beyond_the_bounds_nearby_those_of_all_count() {
        let found = balanced(&[1.0, 2.0, 3.0], &[[1.0; 2], [2.0; 2], [3.0; 2]], 37.0);
        assert_eq!(found, [5.5, 6.0, 6.5]);
        // Never beyond those.
        assert_eq!(balanced(&[1.0, 2.0, 3.0], &[[0.0, 10.0]; 3], 1e3), [10.0; 3]);
        assert_eq!(balanced(&[5.0; 3], &[[5.0; 2]; 3], -7.0), [0.0; 3]);
    }
}
