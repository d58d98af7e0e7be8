//! A line on the terminal while something runs that tells nothing by itself: what, and for how long.
use super::events;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// After so long the line appears: what takes less needs none.
const DELAY: Duration = Duration::from_millis(500);

/// How often the seconds are drawn anew.
const TICK: Duration = Duration::from_millis(200);

/// The line, if there is one.
static LINE: Mutex<Option<ProgressBar>> = Mutex::new(None);

fn line() -> MutexGuard<'static, Option<ProgressBar>> {
    LINE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A line with what runs and since when; it goes when this is dropped. Within another it says something else for a while.
pub struct Waiting {
    /// What the line said before, where it was there.
    before: Option<String>,
    is_first: bool,
}

impl Waiting {
    /// Draws it if standard error is a terminal, and not with --quiet.
    pub fn for_what(what: &str) -> Self {
        events::tell(|| serde_json::json!({ "kind": "stage", "what": what }));
        if super::terminal::is_quiet() || !std::io::stderr().is_terminal() {
            return Self { before: None, is_first: false };
        }
        let mut line = line();
        if let Some(bar) = &*line {
            let before = bar.message();
            bar.set_message(what.to_owned());
            return Self { before: Some(before), is_first: false };
        }
        let style = ProgressStyle::with_template("{wide_msg} {elapsed:>6}");
        let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden()).with_style(style);
        bar.set_message(what.to_owned());
        *line = Some(bar.clone());
        std::thread::spawn(move || appear(&bar));
        Self { before: None, is_first: true }
    }
}

/// Shows the line, if it is still wanted.
fn appear(bar: &ProgressBar) {
    std::thread::sleep(DELAY);
    let line = line();
    if line.is_some() && !bar.is_finished() {
        bar.set_draw_target(ProgressDrawTarget::stderr());
        bar.enable_steady_tick(TICK);
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        let mut line = line();
        match (self.is_first, self.before.take()) {
            (true, _) => {
                if let Some(bar) = line.take() {
                    bar.finish_and_clear();
                }
            }
            (false, Some(before)) => line.iter().for_each(|bar| bar.set_message(before.clone())),
            (false, None) => {}
        }
    }
}

/// Prints something while the line is away.
pub fn aside<T>(print: impl FnOnce() -> T) -> T {
    let bar = line().clone();
    match bar {
        Some(bar) => bar.suspend(print),
        None => print(),
    }
}
