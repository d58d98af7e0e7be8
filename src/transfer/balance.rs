//! The last correction: the integral of a component is brought to its target, within its bounds.
use super::mass::sums;
use crate::tasks::{GRAIN, Team};

/// Rounds. The first does it, the others correct what rounding has left.
const ROUNDS: usize = 4;

/// A component of rows of values.
#[derive(Clone, Copy)]
pub struct Of {
    /// Number of values in a row.
    pub width: usize,
    /// Which of them.
    pub component: usize,
}

/// Moves each value towards the bound of its vertex, all by the same part of the way, such that Σ weight·value becomes `target`. Where
/// all the way is not enough, the bounds of all vertices count. Returns by how much the sum was changed.
pub fn balance(
    team: Team<'_>,
    of: Of,
    values: &mut [f64],
    bounds: &[[f64; 2]],
    overall: [f64; 2],
    weights: &[f64],
    target: f64,
) -> f64 {
    let Of { width, component } = of;
    let at = |v: usize| v * width + component;
    let mass = |values: &[f64]| {
        sums(team, weights.len(), 2, |v, row| {
            let term = weights[v] * values[at(v)];
            (row[0], row[1]) = (term, term.abs());
        })
    };
    let first = mass(values);
    let mut now = first.clone();
    for round in 0..ROUNDS {
        let missing = target - now[0];
        if missing.abs() <= f64::EPSILON * now[1] {
            break;
        }
        // The first rounds use each vertex' own bounds. If these are not wide enough, the later ones use the bounds of all vertices.
        let goal = |v: usize| {
            let [low, high] = if 2 * round < ROUNDS { bounds[at(v)] } else { overall };
            if missing > 0.0 { high } else { low }
        };
        let room = sums(team, weights.len(), 1, |v, row| row[0] = weights[v] * (goal(v) - values[at(v)]))[0];
        if room == 0.0 {
            continue;
        }
        let part = (missing / room).clamp(0.0, 1.0);
        team.fill(width * GRAIN, values, |start, rows| {
            for (row, v) in rows.chunks_exact_mut(width).zip(start / width..) {
                let (value, goal) = (row[component], goal(v));
                let moved = value + part * (goal - value);
                row[component] = if missing > 0.0 { moved.min(goal.max(value)) } else { moved.max(goal.min(value)) };
            }
        });
        now = mass(values);
    }
    now[0] - first[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn balanced(values: &[f64], bounds: &[[f64; 2]], target: f64) -> Vec<f64> {
        let (mut values, weights) = (values.to_vec(), [1.0, 2.0, 3.0]);
        balance(Team::alone(), Of { width: 1, component: 0 }, &mut values, bounds, [0.0, 10.0], &weights, target);
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
