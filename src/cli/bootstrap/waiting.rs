//! A line on the terminal while something runs that tells nothing by itself.
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::time::Duration;

/// How often the seconds are drawn anew.
const TICK: Duration = Duration::from_millis(200);

/// A line with what runs and since when; it goes when this is dropped.
pub struct Waiting(ProgressBar);

impl Waiting {
    /// Draws it if `wanted` and standard error is a terminal.
    pub fn for_what(what: &str, wanted: bool) -> Self {
        if !(wanted && std::io::stderr().is_terminal()) {
            return Self(ProgressBar::hidden());
        }
        let style = ProgressStyle::with_template("{msg}: {elapsed}").unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr()).with_style(style);
        bar.set_message(what.to_owned());
        bar.enable_steady_tick(TICK);
        Self(bar)
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
