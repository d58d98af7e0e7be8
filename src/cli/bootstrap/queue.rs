//! In which order the rungs are tried, and how long each may take.
use super::rung::Rung;
use std::collections::VecDeque;
use std::time::Duration;

/// A rung gets a third of the time at first, unless it is the last: a mesher that does not end on a model (gmsh's volumes between walls that are much thinner
/// than wide, its surfaces at an apex) would keep the user waiting, and mostly another rung is done at once.
const FIRST: u32 = 3;

/// The rungs that are left. What took too long comes once more behind all others, with all the time that is left.
pub struct Queue {
    waiting: VecDeque<Rung>,
    limit: Duration,
    /// What was used of the time.
    spent: Duration,
    /// Programs that are not there.
    gone: Vec<&'static str>,
    /// What took too long, and comes again.
    slow: Vec<Rung>,
}

impl Queue {
    /// All rungs in their order; together they may not take longer than `limit`.
    pub fn new(rungs: impl Iterator<Item = Rung>, limit: Duration) -> Self {
        Self { waiting: rungs.collect(), limit, spent: Duration::ZERO, gone: Vec::new(), slow: Vec::new() }
    }

    /// The next rung, and how long it may take. Where a program took too long only its light rungs are tried.
    pub fn next(&mut self) -> Option<(Rung, Duration)> {
        let left = self.limit.saturating_sub(self.spent);
        while !left.is_zero() {
            let rung = self.waiting.pop_front()?;
            let (program, is_again) = (rung.program(), self.slow.contains(&rung));
            let is_slow = self.slow.iter().any(|slow| slow.program() == program);
            let is_hopeless = !is_again && !rung.is_light() && is_slow;
            if !is_hopeless && !self.gone.contains(&program) {
                let is_last = self.waiting.is_empty();
                return Some((rung, if is_again || is_last { left } else { left.min(self.limit / FIRST) }));
            }
        }
        None
    }

    /// Whether the time ended before the rungs did.
    pub fn is_over(&self) -> bool {
        !self.waiting.is_empty() && self.spent >= self.limit
    }

    /// A rung has used so much of the time.
    pub fn spend(&mut self, time: Duration) {
        self.spent += time;
    }

    /// There is no such program.
    pub fn is_gone(&mut self, program: &'static str) {
        self.gone.push(program);
    }

    /// No rung of this program will do.
    pub fn give_up(&mut self, program: &str) {
        self.waiting.retain(|rung| rung.program() != program);
    }

    /// Only rungs of this program are tried any more.
    pub fn keep(&mut self, program: &str) {
        self.waiting.retain(|rung| rung.program() == program);
    }

    /// It was ended.
    pub fn took_too_long(&mut self, rung: Rung) {
        if !self.slow.contains(&rung) {
            self.slow.push(rung);
            self.waiting.push_back(rung);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::rung::Choice;
    use super::*;

    const WHOLE: Duration = Duration::from_secs(100);

    /// All rungs that come, of which some use all of their time, and the others a hundredth of all.
    fn tried(is_slow: impl Fn(Rung) -> bool) -> Vec<(Rung, Duration)> {
        let mut queue = Queue::new(Rung::of(Choice::Auto), WHOLE);
        let mut tried = Vec::new();
        while let Some((rung, limit)) = queue.next() {
            tried.push((rung, limit));
            if is_slow(rung) {
                queue.spend(limit);
                queue.took_too_long(rung);
            } else {
                queue.spend(WHOLE / 100);
            }
        }
        tried
    }

    #[test]
    fn all_come_in_their_order_with_a_part_of_the_time() {
        let all: Vec<_> = Rung::of(Choice::Auto).collect();
        let tried = tried(|_| false);
        assert_eq!(tried.iter().map(|(rung, _)| *rung).collect::<Vec<_>>(), all);
        let (last, others) = tried.split_last().unwrap();
        assert!(others.iter().all(|(_, limit)| *limit == WHOLE / FIRST));
        // The last one has all that is left.
        assert_eq!(last.1, WHOLE - WHOLE / 100 * others.len() as u32);
    }

    #[test]
    fn only_a_program_that_is_kept_comes_again() {
        let mut queue = Queue::new(Rung::of(Choice::Auto), WHOLE);
        let program = queue.next().unwrap().0.program();
        queue.keep(program);
        let mut rest = Vec::new();
        while let Some((rung, _)) = queue.next() {
            rest.push(rung.program());
        }
        assert!(!rest.is_empty() && rest.iter().all(|of| *of == program), "{rest:?}");
    }

    #[test]
    fn a_program_that_is_given_up_comes_no_more() {
        let mut queue = Queue::new(Rung::of(Choice::Auto), WHOLE);
        let program = queue.next().unwrap().0.program();
        queue.give_up(program);
        let others: Vec<&str> = std::iter::from_fn(|| queue.next()).map(|(rung, _)| rung.program()).collect();
        assert!(!others.is_empty() && !others.contains(&program), "{others:?}");
    }

    #[test]
    fn what_took_too_long_comes_again_at_the_end_and_only_light_rungs_of_its_program_before() {
        let slow = Rung::of(Choice::Gmsh).next().unwrap();
        let tried = tried(|rung| rung == slow);
        let at = tried.iter().position(|(rung, _)| *rung == slow).unwrap();
        assert_eq!(tried[at].1, WHOLE / FIRST);
        let (last, left) = *tried.last().unwrap();
        assert!(last == slow && tried.len() > at + 1);
        let between = &tried[at + 1..tried.len() - 1];
        assert_eq!(left, WHOLE - WHOLE / FIRST - WHOLE / 100 * (at + between.len()) as u32);
        assert!(between.iter().any(|(rung, _)| rung.program() == "gmsh"));
        assert!(between.iter().all(|(rung, _)| rung.is_light() || rung.program() == "netgen"));
    }

    #[test]
    fn all_together_take_no_longer_than_the_limit() {
        let all = tried(|_| true);
        assert!(all.iter().map(|(_, limit)| *limit).sum::<Duration>() <= WHOLE);
        let mut queue = Queue::new(Rung::of(Choice::Auto), WHOLE);
        assert!(!queue.is_over());
        queue.spend(WHOLE);
        assert!(queue.is_over() && queue.next().is_none());
    }

    #[test]
    fn one_alone_has_all_the_time() {
        let alone = Rung::Netgen { finer: 1.0 };
        assert_eq!(Queue::new([alone].into_iter(), WHOLE).next(), Some((alone, WHOLE)));
    }

    #[test]
    fn what_is_not_there_is_not_tried_again() {
        let mut queue = Queue::new(Rung::of(Choice::Auto), WHOLE);
        queue.is_gone("gmsh");
        while let Some((rung, _)) = queue.next() {
            assert_ne!(rung.program(), "gmsh");
        }
    }
}
