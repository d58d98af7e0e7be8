//! Progress on the terminal: a bar a pass, with counts; and the interrupt.
use crate::adapt::{Counts, KINDS, Kind, Observer};
use crate::cli::{interrupt, terminal};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// Lets the first interrupt end the work after the running sweep, and a second one end the program at once.
pub fn finish_on_interrupt() -> &'static AtomicBool {
    interrupt::finish_on("ends as soon as it can and writes the mesh (again: ends at once, and writes none)")
}

/// How often the time is drawn anew.
const TICK: Duration = Duration::from_millis(200);

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
    /// Vertices now.
    vertices: u64,
    /// How many are expected in the end; 0 where that is not known.
    expected: u64,
}

impl Progress {
    /// Draws if standard error is a terminal, and not with --quiet.
    pub fn new(stop: &'static AtomicBool) -> Self {
        let state = State {
            bar: ProgressBar::hidden(),
            pass: None,
            kind: Kind::Split,
            began: Instant::now(),
            done: [0; KINDS],
            vertices: 0,
            expected: 0,
        };
        let shown = !terminal::is_quiet() && std::io::IsTerminal::is_terminal(&std::io::stderr());
        Self { shown, stop, state: Mutex::new(state) }
    }

    /// Whether anything is drawn.
    pub fn is_shown(&self) -> bool {
        self.shown
    }

    /// So many vertices are expected.
    pub fn expect(&self, vertices: f64) {
        self.state.lock().expect("no panic while drawing").expected = vertices.round() as u64;
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
    fn leave(&mut self) {
        if !self.bar.is_hidden() {
            std::mem::replace(&mut self.bar, ProgressBar::hidden()).abandon();
            crate::cli::tell("");
        }
        self.pass = None;
    }

    fn describe(&self) -> String {
        let [_, _, reconnect, smooth, ..] = self.done;
        let (name, now) = (self.kind.name(), self.vertices);
        let expected = if self.expected > 0 { format!(" of about {}", self.expected) } else { String::new() };
        format!("{name:<12} {now}{expected} vertices, {reconnect} flips, {smooth} moves")
    }
}

impl Observer for Progress {
    fn vertices(&self, count: usize) {
        self.state.lock().expect("no panic while drawing").vertices = count as u64;
    }

    fn begin(&self, kind: Kind, pass: usize, items: usize) {
        let mut state = self.state.lock().expect("no panic while drawing");
        state.kind = kind;
        state.began = Instant::now();
        if self.shown && state.pass != Some(pass) {
            state.leave();
            let style = ProgressStyle::with_template("pass {prefix:>2} [{bar:16}] {elapsed:>4} {wide_msg}");
            let style = style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> ");
            let target = ProgressDrawTarget::stderr();
            state.bar = ProgressBar::with_draw_target(Some(0), target).with_style(style);
            state.bar.set_prefix(format!("{}", pass + 1));
            state.bar.enable_steady_tick(TICK);
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
        match state.kind {
            Kind::Split => state.vertices += counts.done,
            Kind::Collapse => state.vertices = state.vertices.saturating_sub(counts.done),
            _ => {}
        }
        let text = state.describe();
        state.bar.set_message(text);
        if terminal::tells_sweeps() {
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
