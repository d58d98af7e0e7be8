//! Threads that are not there. `GEO_ADAPT_SIMULATE=16` runs all tasks one after the other on one thread, cut as for 16 threads, measures each,
//! and says how long 16 threads would have taken: what is outside of loops takes as long as it took, and of a loop's tasks each goes, in their
//! order, to the thread that is free first (greedy, as the back-end with shared queues does it). What threads take from each other, memory
//! and the processor's clock, is not simulated: `cases/threads --simulate` holds it against two threads that are there.
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use std::fmt::Write;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Instant;

/// To wake the threads at the begin of a loop and to wait for the last one, s.
const LOOP: f64 = 5e-6;

/// To take a task from a queue, s (docs/decisions/tasks.md).
const TASK: f64 = 7e-8;

/// The simulation of this process, once it has begun.
static RUN: OnceLock<Mutex<Run>> = OnceLock::new();

/// What one section of the program took, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Section {
    /// Outside of loops.
    serial: f64,
    /// Of all tasks together.
    work: f64,
    /// Of the longest task of each loop: no number of threads takes less.
    span: f64,
    /// Of the loops, on the threads that are simulated.
    loops: f64,
}

impl Section {
    fn add(&mut self, other: Self) {
        self.serial += other.serial;
        self.work += other.work;
        self.span += other.span;
        self.loops += other.loops;
    }

    /// A loop of tasks that took so long each.
    fn of_loop(threads: usize, seconds: &[f64]) -> Self {
        Self {
            serial: 0.0,
            work: seconds.iter().sum(),
            span: seconds.iter().copied().fold(0.0, f64::max),
            loops: greedy(threads, seconds),
        }
    }

    fn simulated(self) -> f64 {
        self.serial + self.loops
    }
}

/// How long so many threads take for tasks that take so long, each of which goes to the thread that is free first.
fn greedy(threads: usize, seconds: &[f64]) -> f64 {
    // Times above 0 have the order of their bits.
    let mut free: BinaryHeap<Reverse<u64>> = (0..threads.min(seconds.len())).map(|_| Reverse(0)).collect();
    let mut end: f64 = 0.0;
    for task in seconds {
        let Some(Reverse(begin)) = free.pop() else { break };
        let done = f64::from_bits(begin) + TASK + task;
        end = end.max(done);
        free.push(Reverse(done.to_bits()));
    }
    end + LOOP
}

struct Run {
    threads: usize,
    /// When what is measured now began: at the end of the last loop, or of the last section.
    since: Instant,
    /// The section that runs; none between named ones, whose time goes to the stage that ends next.
    current: Option<&'static str>,
    unnamed: Section,
    sections: BTreeMap<String, Section>,
}

impl Run {
    /// What the section that runs now took goes here.
    fn add(&mut self, some: Section) {
        match self.current {
            Some(name) => self.sections.entry(name.to_owned()).or_default().add(some),
            None => self.unnamed.add(some),
        }
    }

    /// The time since what was measured last is outside of loops.
    fn end_serial(&mut self) {
        let now = Instant::now();
        let serial = (now - self.since).as_secs_f64();
        self.since = now;
        self.add(Section { serial, ..Section::default() });
    }
}

fn run() -> Option<MutexGuard<'static, Run>> {
    Some(RUN.get()?.lock().unwrap_or_else(PoisonError::into_inner))
}

/// How many threads are to be simulated, if that is wanted.
pub fn threads_to_simulate() -> Option<usize> {
    std::env::var("GEO_ADAPT_SIMULATE").ok()?.parse().ok().filter(|threads| (1..=4096).contains(threads))
}

/// From now on threads are simulated.
pub(super) fn begin(threads: usize) {
    let (since, current) = (Instant::now(), None);
    RUN.get_or_init(|| {
        Mutex::new(Run { threads, since, current, unnamed: Section::default(), sections: BTreeMap::new() })
    });
}

/// A loop's tasks, done one after the other.
pub(super) fn each(tasks: impl Iterator<Item = impl FnOnce()>) {
    if let Some(mut run) = run() {
        run.end_serial();
    }
    let mut before = Instant::now();
    let seconds: Vec<f64> = tasks
        .map(|task| {
            task();
            let now = Instant::now();
            let taken = (now - before).as_secs_f64();
            before = now;
            taken
        })
        .collect();
    if let Some(mut run) = run() {
        let some = Section::of_loop(run.threads, &seconds);
        run.add(some);
        run.since = Instant::now();
    }
}

/// What runs from now on belongs to the section of this name, or to none.
pub fn section(name: Option<&'static str>) {
    if let Some(mut run) = run() {
        run.end_serial();
        run.current = name;
    }
}

/// A stage is over: what ran outside of sections was its own.
pub(super) fn end_stage(name: &str) {
    if let Some(mut run) = run() {
        run.end_serial();
        let unnamed = std::mem::take(&mut run.unnamed);
        run.sections.entry(name.to_owned()).or_default().add(unnamed);
    }
}

/// The result as a line of JSON, if threads were simulated: seconds by section.
pub fn told() -> Option<String> {
    end_stage("end");
    let run = run()?;
    let mut all = Section::default();
    let mut line = format!("simulated {{\"threads\": {}, \"sections\": {{", run.threads);
    for (k, (name, some)) in run.sections.iter().enumerate() {
        let Section { serial, work, span, .. } = *some;
        let comma = if k > 0 { ", " } else { "" };
        let _ = write!(
            line,
            "{comma}\"{name}\": {{\"serial\": {serial:.6}, \"work\": {work:.6}, \"span\": {span:.6}, \"simulated\": {:.6}}}",
            some.simulated()
        );
        all.add(*some);
    }
    let Section { serial, work, span, .. } = all;
    let _ = write!(line, "}}, \"serial\": {serial:.6}, \"work\": {work:.6}, \"span\": {span:.6}, ");
    let _ = write!(line, "\"one\": {:.6}, \"simulated\": {:.6}}}", serial + work, all.simulated());
    Some(line)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_task_goes_to_the_thread_that_is_free_first() {
        // Two threads: 3 and 1, then 1 goes behind the 1, and 2 behind that: 4.
        let taken = greedy(2, &[3.0, 1.0, 1.0, 2.0]);
        assert!((taken - 4.0).abs() < 1e-3, "{taken}");
        assert!((greedy(8, &[3.0, 1.0, 1.0, 2.0]) - 3.0).abs() < 1e-3);
        assert!((greedy(1, &[3.0, 1.0, 1.0, 2.0]) - 7.0).abs() < 1e-3);
        assert!(greedy(4, &[]) < 1e-3);
    }

    #[test]
    fn a_loop_has_its_work_and_its_longest_task() {
        let section = Section::of_loop(2, &[0.5, 0.25, 0.25]);
        assert_eq!((section.work, section.span, section.serial), (1.0, 0.5, 0.0));
        assert!((section.simulated() - 0.5).abs() < 1e-3);
    }
}
