//! Progress on the terminal: a bar a pass, with counts; and the interrupt.
use crate::adapt::{Counts, KINDS, Kind, Observer};
use crate::cli::interrupt;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Instant;

/// Lets the first interrupt end the work after the running sweep, and a second one end the program at once.
pub fn finish_on_interrupt() -> &'static AtomicBool {
    interrupt::finish_on("ends after this sweep and writes the mesh (again: ends at once)")
}

/// Shows what the adapter does.
pub struct Progress {
    shown: bool,
    stop: &'static AtomicBool,
    state: Mutex<State>,
}

struct State {
    bar: ProgressBar,
    pass: Option<usize>,
    kind: Kind,
    began: Instant,
    done: [u64; KINDS],
}

impl Progress {
    /// Draws if `wanted` and standard error is a terminal.
    pub fn new(wanted: bool, stop: &'static AtomicBool) -> Self {
        let state = State {
            bar: ProgressBar::hidden(),
            pass: None,
            kind: Kind::Split,
            began: Instant::now(),
            done: [0; KINDS],
        };
        let shown = wanted && std::io::IsTerminal::is_terminal(&std::io::stderr());
        Self { shown, stop, state: Mutex::new(state) }
    }

    /// The work is over.
    pub fn finish(&self) {
        self.state.lock().expect("no panic while drawing").leave();
    }

    /// Whether the user ended it.
    pub fn interrupted(&self) -> bool {
        self.stop.load(Relaxed)
    }
}

impl State {
    /// Leaves the bar of a pass as it is, and its line.
    fn leave(&self) {
        if !self.bar.is_hidden() {
            self.bar.abandon();
            crate::cli::tell("");
        }
    }

    fn describe(&self) -> String {
        let [split, collapse, reconnect, smooth, ..] = self.done;
        let name = self.kind.name();
        format!("{name:<12} {split} in, {collapse} out, {reconnect} flips, {smooth} moves")
    }
}

impl Observer for Progress {
    fn begin(&self, kind: Kind, pass: usize, items: usize) {
        let mut state = self.state.lock().expect("no panic while drawing");
        state.kind = kind;
        state.began = Instant::now();
        if self.shown && state.pass != Some(pass) {
            state.leave();
            let style = ProgressStyle::with_template("pass {prefix:>2} [{bar:16}] {wide_msg}");
            let style = style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> ");
            let target = ProgressDrawTarget::stderr();
            state.bar = ProgressBar::with_draw_target(Some(0), target).with_style(style);
            state.bar.set_prefix(format!("{}", pass + 1));
            state.done = [0; KINDS];
        }
        state.pass = Some(pass);
        state.bar.set_length(items as u64);
        state.bar.set_position(0);
        let text = state.describe();
        state.bar.set_message(text);
    }

    fn advance(&self, items: usize) {
        if let Ok(state) = self.state.try_lock() {
            state.bar.inc(items as u64);
        }
    }

    fn end(&self, counts: &Counts) {
        let mut state = self.state.lock().expect("no panic while drawing");
        let kind = state.kind as usize;
        state.done[kind] += counts.done;
        let text = state.describe();
        state.bar.set_message(text);
        if std::env::var_os("GEO_ADAPT_TRACE").is_some() {
            let ms = state.began.elapsed().as_secs_f64() * 1e3;
            crate::cli::tell(format_args!(
                "{:2} {:8} {ms:7.1} ms {:8} {:7} {:?}",
                state.pass.unwrap_or(0),
                format!("{:?}", state.kind),
                counts.attempts,
                counts.done,
                counts.refused
            ));
        }
    }

    fn stop(&self) -> bool {
        self.interrupted()
    }
}
