//! In which order the rungs are tried, and how long each may take.
use super::rung::Rung;
use std::collections::VecDeque;
use std::time::Duration;

/// A rung gets a third of the time at first: a mesher that does not end on a model (gmsh's volumes between walls that are much thinner
/// than wide, its surfaces at an apex) would keep the user waiting, and mostly another rung is done at once.
const FIRST: u32 = 3;

/// The rungs that are left. What took too long comes once more behind all others, with the whole time.
pub struct Queue {
    waiting: VecDeque<(Rung, Duration)>,
    limit: Duration,
    /// Programs that are not there, and those that took too long.
    gone: Vec<&'static str>,
    slow: Vec<&'static str>,
}

impl Queue {
    /// All rungs in their order; none may take longer than `limit`.
    pub fn new(rungs: impl Iterator<Item = Rung>, limit: Duration) -> Self {
        let waiting = rungs.map(|rung| (rung, limit / FIRST)).collect();
        Self { waiting, limit, gone: Vec::new(), slow: Vec::new() }
    }

    /// The next rung, and how long it may take. Where a program took too long only its light rungs are tried.
    pub fn next(&mut self) -> Option<(Rung, Duration)> {
        while let Some((rung, limit)) = self.waiting.pop_front() {
            let (program, is_again) = (rung.program(), limit == self.limit);
            let is_hopeless = !is_again && !rung.is_light() && self.slow.contains(&program);
            if !is_hopeless && !self.gone.contains(&program) {
                return Some((rung, limit));
            }
        }
        None
    }

    /// There is no such program.
    pub fn is_gone(&mut self, program: &'static str) {
        self.gone.push(program);
    }

    /// It was ended after this time.
    pub fn took_too_long(&mut self, rung: Rung, limit: Duration) {
        self.slow.push(rung.program());
        if limit < self.limit {
            self.waiting.push_back((rung, self.limit));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::rung::Choice;
    use super::*;

    const WHOLE: Duration = Duration::from_secs(100);

    /// All rungs that come, of which some take too long at first.
    fn tried(is_slow: impl Fn(Rung) -> bool) -> Vec<(Rung, Duration)> {
        let mut queue = Queue::new(Rung::of(Choice::Auto), WHOLE);
        let mut tried = Vec::new();
        while let Some((rung, limit)) = queue.next() {
            tried.push((rung, limit));
            if limit < WHOLE && is_slow(rung) {
                queue.took_too_long(rung, limit);
            }
        }
        tried
    }

    #[test]
    fn all_come_in_their_order_with_a_part_of_the_time() {
        let all: Vec<_> = Rung::of(Choice::Auto).map(|rung| (rung, WHOLE / FIRST)).collect();
        assert_eq!(tried(|_| false), all);
    }

    #[test]
    fn what_took_too_long_comes_again_at_the_end_and_only_light_rungs_of_its_program_before() {
        let first = Rung::of(Choice::Auto).next().unwrap();
        let tried = tried(|rung| rung == first);
        assert_eq!(tried.first(), Some(&(first, WHOLE / FIRST)));
        assert_eq!(tried.last(), Some(&(first, WHOLE)));
        let between = &tried[1..tried.len() - 1];
        assert!(between.iter().any(|(rung, _)| *rung == Rung::Triangles));
        assert!(between.iter().all(|(rung, limit)| *limit < WHOLE && (rung.is_light() || rung.program() == "netgen")));
    }

    #[test]
    fn what_is_not_there_is_not_tried_again() {
        let mut queue = Queue::new(Rung::of(Choice::Auto), WHOLE);
        queue.is_gone("gmsh");
        while let Some((rung, _)) = queue.next() {
            assert_eq!(rung.program(), "netgen");
        }
    }
}
