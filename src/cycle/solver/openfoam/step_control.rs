//! How fast a solve may go: slower where it blew up, and after some calm faster again.

/// How often the Courant number, or the relaxation, is halved at most before it is given up.
const HALVINGS: usize = 5;

/// Blocks without trouble after which what was halved is doubled again.
const CALM: usize = 4;

/// Blow-ups at a number of halvings after which it is not tried again. A flow may bear later what it did not at its beginning, but where
/// it fails a second time it would fail for ever, and each failure disturbs a flow that had converged.
const TRIALS: u8 = 2;

/// The length of steps (Courant number or relaxation), by how often it was halved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StepControl {
    halvings: usize,
    /// Blocks since the last trouble.
    calm: usize,
    /// Blow-ups at each number of halvings.
    failed: [u8; HALVINGS + 1],
}

impl StepControl {
    /// How often it is halved.
    pub fn halvings(&self) -> i32 {
        self.halvings as i32
    }

    /// After a blow-up: half as fast. Whether that can be.
    pub fn slow_down(&mut self) -> bool {
        let can = self.halvings < HALVINGS;
        self.failed[self.halvings] = self.failed[self.halvings].saturating_add(1);
        self.calm = 0;
        self.halvings += usize::from(can);
        can
    }

    /// After a block that ended well: one halving less if there were enough of them, and if that has not failed too often.
    pub fn go_on(&mut self) {
        self.calm += 1;
        if self.calm >= CALM && self.halvings > 0 && self.failed[self.halvings - 1] < TRIALS {
            (self.halvings, self.calm) = (self.halvings - 1, 0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pace_that_fails_twice_is_not_taken_up_again() {
        let mut control = StepControl::default();
        for _ in 0..2 {
            assert!(control.halvings() == 0 && control.slow_down() && control.halvings() == 1);
            (0..CALM).for_each(|_| control.go_on());
        }
        (0..10 * CALM).for_each(|_| control.go_on());
        assert_eq!(control.halvings(), 1);
        // The next lower one still has its trial.
        assert!(control.slow_down() && control.halvings() == 2);
        (0..CALM).for_each(|_| control.go_on());
        assert_eq!(control.halvings(), 1);
    }

    #[test]
    fn it_is_given_up_after_some_halvings() {
        let mut control = StepControl::default();
        for halvings in 1..=HALVINGS as i32 {
            assert!(control.slow_down());
            assert_eq!(control.halvings(), halvings);
        }
        assert!(!control.slow_down() && control.halvings() == HALVINGS as i32);
    }
}
