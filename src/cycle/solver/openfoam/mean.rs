//! The mean of the last half of a solve that swings about instead of coming to rest: what it swings about says more of the flow than where the
//! last step happens to have left it.
use super::state::State;

/// So many looks at least make a mean,
const LOOKS: usize = 4;

/// of a flow that swings: between the looks it went so many times as far as from the first one to the last. A flow that is still on its way goes
/// hardly farther, and its last state is the better one; independent ones go as many times as far as there are steps between looks.
const SWINGS: f64 = 2.0;

/// The looks at a flow from a step on.
pub struct Mean {
    /// The step; looks before it do not count.
    from: usize,
    looks: usize,
    sum: Option<State>,
    /// Pressure at the first look.
    first: Vec<f64>,
    /// How far it went from look to look.
    path: f64,
}

impl Mean {
    /// Of no looks yet.
    pub fn from(step: usize) -> Self {
        Self { from: step, looks: 0, sum: None, first: Vec::new(), path: 0.0 }
    }

    /// A look at a step; `moved`: how far the pressure went since the one before.
    pub fn look(&mut self, step: usize, state: &State, moved: f64) {
        if step < self.from {
            return;
        }
        self.looks += 1;
        match &mut self.sum {
            None => (self.sum, self.first) = (Some(state.clone()), state.pressure.clone()),
            Some(sum) => {
                sum.values_mut().zip(state.values()).for_each(|(sum, value)| *sum += value);
                self.path += moved;
            }
        }
    }

    /// The mean and of how many looks, where the flow swings about; `distance` measures two pressures as `moved` was, of which `last` is the last.
    pub fn of_swings(self, last: &[f64], distance: impl Fn(&[f64], &[f64]) -> f64) -> Option<(State, usize)> {
        let mut mean = self.sum.filter(|_| self.looks >= LOOKS && self.path > SWINGS * distance(&self.first, last))?;
        let part = 1.0 / self.looks as f64;
        mean.values_mut().for_each(|value| *value *= part);
        Some((mean, self.looks))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of a flow of one cell, whose pressure is this at the looks.
    fn mean(pressures: &[f64]) -> Option<(State, usize)> {
        let mut mean = Mean::from(2);
        let state = |p: f64| State { pressure: vec![p], temperature: vec![2.0 * p], velocity: vec![p, 0.0, -p] };
        mean.look(1, &state(1e9), 1.0);
        for (k, &p) in pressures.iter().enumerate() {
            mean.look(2 + k, &state(p), if k > 0 { (p - pressures[k - 1]).abs() } else { 1e9 });
        }
        mean.of_swings(&pressures[pressures.len() - 1..], |a, b| (a[0] - b[0]).abs())
    }

    #[test]
    fn a_flow_that_swings_has_its_mean() {
        let (state, looks) = mean(&[1.0, 3.0, 1.0, 3.0, 1.0]).unwrap();
        let near = |a: f64, b: f64| (a - b).abs() < 1e-14;
        assert!(looks == 5 && near(state.pressure[0], 1.8) && near(state.temperature[0], 3.6), "{state:?}");
        assert!(near(state.velocity[0], 1.8) && state.velocity[1] == 0.0 && near(state.velocity[2], -1.8), "{state:?}");
    }

    #[test]
    fn one_that_is_on_its_way_or_was_hardly_looked_at_has_none() {
        assert_eq!(mean(&[1.0, 2.0, 3.0, 3.5, 3.2]), None);
        assert_eq!(mean(&[1.0, 3.0, 1.0]), None);
        assert!(Mean::from(0).of_swings(&[], |_, _| 0.0).is_none());
    }
}
