//! Which complexity a cycle has, and when the loop ends.
use super::config::{Converged, Schedule, Until};

impl Schedule {
    /// The complexity of the adaptation of a cycle, from 1.
    pub fn of_cycle(&self, cycle: u32) -> f64 {
        let raised = self.factor.powi(((cycle - 1) / self.every) as i32);
        (self.complexity * raised).min(self.max_complexity.unwrap_or(f64::INFINITY))
    }

    /// The number of adaptations after which the loop ends, where the schedule says.
    pub fn last(&self) -> Option<u32> {
        // Some hundred doublings are more than any number of vertices.
        let most = self.max_complexity.filter(|_| self.factor > 1.0);
        let reached = most.and_then(|most| (0..4096).find(|&n| self.of_cycle(n * self.every + 1) >= most));
        let fine = reached.map(|n| (n + 1) * self.every);
        [fine, self.cycles].into_iter().flatten().min()
    }

    /// Why the loop ends where the goal's error is estimated to be so much, if it does.
    pub fn ends_with(&self, error: Option<f64>) -> Option<String> {
        let (Until { functional, below }, error) = (self.until.as_ref()?, error?);
        (error < *below).then(|| format!("the error in {functional} is estimated as {error:.2e}, below {below}"))
    }

    /// Why the loop ends after a solve, if it does: so many adaptations are done, and the functional had these values in all solves.
    pub fn ends(&self, adaptations: u32, functional: &[f64]) -> Option<String> {
        if let Some(converged) = &self.converged
            && converged.is_reached(functional)
        {
            let Converged { functional, change, cycles } = converged;
            return Some(format!("{functional} changed by less than {change} over {cycles} cycles"));
        }
        if Some(adaptations) != self.last() {
            return None;
        }
        if self.cycles == Some(adaptations) {
            return Some(if adaptations == 1 {
                "1 cycle is done".into()
            } else {
                format!("{adaptations} cycles are done")
            });
        }
        Some(format!("complexity {} is reached", self.of_cycle(adaptations)))
    }
}

impl Converged {
    /// Whether the last changes are all small.
    fn is_reached(&self, values: &[f64]) -> bool {
        let count = self.cycles as usize;
        let small = |pair: &[f64]| (pair[1] - pair[0]).abs() <= self.change * pair[1].abs();
        values.len() > count && values[values.len() - count - 1..].windows(2).all(small)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn schedule() -> Schedule {
        Schedule {
            complexity: 100.0,
            factor: 2.0,
            every: 2,
            max_complexity: None,
            cycles: None,
            converged: None,
            until: None,
        }
    }

    #[test]
    fn complexities_grow_and_end() {
        let mut schedule = schedule();
        schedule.max_complexity = Some(300.0);
        let all: Vec<f64> = (1..=6).map(|cycle| schedule.of_cycle(cycle)).collect();
        assert_eq!(all, [100.0, 100.0, 200.0, 200.0, 300.0, 300.0]);
        assert_eq!(schedule.last(), Some(6));
        assert!(schedule.ends(5, &[]).is_none());
        assert_eq!(schedule.ends(6, &[]).unwrap(), "complexity 300 is reached");
        schedule.cycles = Some(3);
        assert_eq!(schedule.last(), Some(3));
        assert_eq!(schedule.ends(3, &[]).unwrap(), "3 cycles are done");
        schedule.max_complexity = Some(400.0);
        schedule.cycles = None;
        assert_eq!(schedule.last(), Some(6));
        schedule.factor = 1.0;
        assert_eq!(schedule.last(), None);
    }

    #[test]
    fn a_small_error_ends_the_loop() {
        let mut schedule = schedule();
        assert!(schedule.ends_with(Some(0.0)).is_none());
        schedule.until = Some("error(lift) < 1e-3".parse().unwrap());
        assert!(schedule.ends_with(None).is_none() && schedule.ends_with(Some(2e-3)).is_none());
        let said = schedule.ends_with(Some(9e-4)).unwrap();
        assert_eq!(said, "the error in lift is estimated as 9.00e-4, below 0.001");
    }

    #[test]
    fn a_functional_that_stays_ends_the_loop() {
        let mut schedule = schedule();
        schedule.converged = Some(Converged { functional: "drag".into(), change: 0.01, cycles: 2 });
        assert!(schedule.ends(1, &[1.0, 1.0]).is_none(), "one change is not two");
        assert!(schedule.ends(3, &[1.0, 1.02, 1.02, 1.021]).is_some());
        assert!(schedule.ends(2, &[1.0, 1.02, 1.021]).is_none());
        assert!(schedule.ends(2, &[0.0, 0.0, 0.0]).is_some());
        assert!(schedule.ends(2, &[f64::NAN, f64::NAN, f64::NAN]).is_none());
    }
}
