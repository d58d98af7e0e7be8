//! Progress over the whole loop: a bar over its cycles with the step that runs and the last line of its log, and a row for each cycle that is done.
use crate::cli::print;
use crate::cli::table::figure;
use crate::cli::terminal::PrintError;
use crate::cycle::{Cycle, Observer, Schedule};
use crate::process::last_line;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Shows what the loop does.
pub struct Progress {
    wanted: bool,
    bar: ProgressBar,
    schedule: Schedule,
    /// Whether a step has run since the last cycle that was told.
    worked: AtomicBool,
    /// When that was.
    told: Mutex<Instant>,
    headed: AtomicBool,
    running: Running,
    /// Why a row could not be printed. The loop goes on all the same: it may have run for days.
    failed: Mutex<Option<PrintError>>,
}

/// The step that runs, and its log.
type Running = Arc<Mutex<(String, PathBuf)>>;

/// How long between two looks at the log.
const LOOK: Duration = Duration::from_millis(500);

impl Progress {
    /// Draws a bar if `wanted` and standard error is a terminal; rows if `wanted`.
    pub fn new(wanted: bool, schedule: &Schedule) -> Self {
        let running = Running::default();
        let shown = wanted && std::io::IsTerminal::is_terminal(&std::io::stderr());
        let bar = if shown {
            let template = "cycle {pos:>2}{prefix} [{bar:10}] {elapsed:>4} {wide_msg}";
            let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
            let length = schedule.last().map_or(0, |last| u64::from(last) + 1);
            let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::stderr());
            bar.set_style(style.progress_chars("=> "));
            bar.set_prefix(schedule.last().map_or_else(String::new, |last| format!(" of {}", last + 1)));
            bar.enable_steady_tick(LOOK);
            follow(bar.clone(), Arc::clone(&running));
            bar
        } else {
            ProgressBar::hidden()
        };
        Self {
            wanted,
            bar,
            schedule: schedule.clone(),
            worked: AtomicBool::new(false),
            told: Mutex::new(Instant::now()),
            headed: AtomicBool::new(false),
            running,
            failed: Mutex::default(),
        }
    }

    /// The work is over.
    ///
    /// # Errors
    /// When a row could not be printed.
    pub fn finish(&self) -> Result<(), PrintError> {
        self.bar.finish_and_clear();
        self.failed.lock().expect("no panic while it is held").take().map_or(Ok(()), Err)
    }

    /// Says when the end is expected, after a cycle: the time of the others is as their complexity to that of this one.
    fn expect(&self, cycle: u32) {
        let took = std::mem::replace(&mut *self.told.lock().expect("no panic while it is held"), Instant::now());
        let Some(last) = self.schedule.last() else { return };
        let worked = self.worked.swap(false, Relaxed);
        let left = remaining(&self.schedule, cycle, last).filter(|_| worked);
        let left = left.map(|share| format!(", about {} left", duration(took.elapsed().as_secs_f64() * share)));
        self.bar.set_prefix(format!(" of {}{}", last + 1, left.unwrap_or_default()));
    }

    /// Something that stays above the bar.
    fn tell(&self, line: &str) {
        let done = self.bar.suspend(|| print(&format!("{line}\n")));
        if let Err(error) = done {
            self.failed.lock().expect("no panic while it is held").get_or_insert(error);
        }
    }
}

/// Shows what the running step said last, until the bar is finished.
fn follow(bar: ProgressBar, running: Running) {
    std::thread::spawn(move || {
        while !bar.is_finished() {
            let (step, log) = running.lock().expect("no panic while it is held").clone();
            let line = last_line(&log).unwrap_or_default().replace(char::is_control, " ");
            bar.set_message(format!("{step}  {}", line.split_whitespace().collect::<Vec<_>>().join(" ")));
            std::thread::sleep(LOOK);
        }
    });
}

impl Observer for Progress {
    fn begin(&self, step: &str, log: &Path) {
        let number = step.strip_prefix("cycle-").and_then(|rest| rest.split('/').next()).and_then(|n| n.parse().ok());
        self.bar.set_position(number.unwrap_or(0));
        self.worked.store(true, Relaxed);
        let name = step.rsplit('/').next().unwrap_or(step).to_owned();
        self.bar.set_message(name.clone());
        *self.running.lock().expect("no panic while it is held") = (name, log.to_owned());
    }

    fn end(&self, _: &str, _: f64) {}

    fn note(&self, text: &str) {
        if self.wanted {
            self.bar.suspend(|| crate::cli::note(text));
        }
    }

    fn cycle(&self, cycle: &Cycle) {
        if !self.wanted {
            return;
        }
        self.expect(cycle.cycle);
        if !self.headed.swap(true, Relaxed) {
            let names: Vec<String> = cycle.functionals.keys().map(|name| format!("{name:>0$}", width(name))).collect();
            self.tell(&format!(
                "{:>5} {:>11} {:>9} {:>10} {:>7}{}",
                "cycle",
                "complexity",
                "vertices",
                "tetrahedra",
                "unit",
                names.concat()
            ));
        }
        let complexity = cycle.complexity.map_or_else(|| "-".into(), figure);
        let unit = cycle.statistics.as_ref().and_then(|all| all["metric"]["unit_edges"].as_f64());
        let unit = unit.map_or_else(|| "-".into(), |share| format!("{:.1} %", 100.0 * share));
        let value = |(name, &value): (&String, &f64)| format!("{:>1$}", figure(value), width(name));
        let values: Vec<String> = cycle.functionals.iter().map(value).collect();
        self.tell(&format!(
            "{:>5} {complexity:>11} {:>9} {:>10} {unit:>7}{}",
            cycle.cycle,
            cycle.vertices,
            cycle.tets,
            values.concat()
        ));
    }
}

/// The width of the column of a functional.
fn width(name: &str) -> usize {
    (name.chars().count() + 2).max(12)
}

/// The time of the cycles to come, up to the adaptation `last`, in that of the one that ended with the solve of `cycle`. None of the first solve, on
/// a mesh of no complexity.
fn remaining(schedule: &Schedule, cycle: u32, last: u32) -> Option<f64> {
    let this = schedule.of_cycle(cycle.checked_sub(1).filter(|&before| before > 0)?);
    Some((cycle..=last).map(|next| schedule.of_cycle(next) / this).sum())
}

/// Seconds for people.
fn duration(seconds: f64) -> String {
    match seconds {
        _ if seconds < 90.0 => format!("{seconds:.0} s"),
        _ if seconds < 5400.0 => format!("{:.0} min", seconds / 60.0),
        _ => format!("{:.1} h", seconds / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_grows_with_the_complexity() {
        let schedule = Schedule {
            complexity: 100.0,
            factor: 2.0,
            every: 1,
            max_complexity: Some(800.0),
            cycles: None,
            converged: None,
            until: None,
        };
        assert_eq!(schedule.last(), Some(4));
        assert_eq!(remaining(&schedule, 1, 4), None);
        // After the first adaptation and the second solve: 2 + 4 + 8 times as much.
        assert_eq!(remaining(&schedule, 2, 4), Some(14.0));
        assert_eq!(remaining(&schedule, 5, 4), Some(0.0));
        assert_eq!([20.0, 600.0, 7200.0].map(duration), ["20 s", "10 min", "2.0 h"]);
    }
}
