//! One process.
use super::{Ranks, Traffic};

/// A run of one process: it is rank 0 of 1, and whom it writes to is itself.
#[derive(Clone, Copy, Debug, Default)]
pub struct Alone;

impl Ranks for Alone {
    fn rank(&self) -> usize {
        0
    }

    fn count(&self) -> usize {
        1
    }

    fn exchange(&self, messages: Vec<(usize, Vec<u8>)>) -> Vec<(usize, Vec<u8>)> {
        for (to, _) in &messages {
            assert!(*to == 0, "a message to rank {to} of 1");
        }
        messages
    }

    fn gather(&self, own: &[u8]) -> Vec<Vec<u8>> {
        vec![own.to_vec()]
    }

    fn traffic(&self) -> Traffic {
        Traffic::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_process_writes_to_itself() {
        let messages = vec![(0, vec![1, 2]), (0, vec![]), (0, vec![3])];
        assert_eq!(Alone.exchange(messages.clone()), messages);
        assert_eq!(Alone.gather(&[4, 5]), [[4, 5]]);
        assert_eq!(Alone.traffic(), Traffic { sent: 0, waited: 0.0 });
    }

    #[test]
    #[should_panic(expected = "rank 1 of 1")]
    fn no_one_else_is_there() {
        Alone.exchange(vec![(1, vec![])]);
    }
}
