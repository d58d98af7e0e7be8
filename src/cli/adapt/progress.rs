//! Progress on the terminal: a bar a pass, with counts; and the interrupt.
use crate::adapt::forecast::{Forecast, seconds_left};
use crate::adapt::{Counts, KINDS, Kind, Observer};
use crate::cli::files::room;
use crate::cli::{events, interrupt, terminal};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// Lets the first interrupt end the work after the running sweep, and a second one end the program at once.
pub fn finish_on_interrupt() -> &'static AtomicBool {
    interrupt::finish_on("ends as soon as it can and writes the mesh (again: ends at once, and writes none)")
}

/// The same for one of several processes, which mpirun ends one second after an interrupt, done or not.
pub fn finish_on_interrupt_of_mpirun() -> &'static AtomicBool {
    interrupt::finish_on(
        "writes the mesh if that can be in the one second that mpirun leaves (SIGUSR1 to mpirun leaves as long as it takes); with a scratch folder \
         the same command goes on",
    )
}

/// How often the time is drawn anew.
const TICK: Duration = Duration::from_millis(200);

/// A run that is to take so long is told of beforehand, s: for a shorter one nobody waits.
const WORTH_TELLING: f64 = 1.0;

/// A time that is not known well.
fn about(seconds: f64) -> String {
    match seconds {
        _ if seconds < 1.0 => "less than a second".into(),
        _ if seconds < 99.5 => format!("about {seconds:.0} s"),
        _ if seconds < 5_970.0 => format!("about {:.0} min", seconds / 60.0),
        _ => format!("about {:.0} h", seconds / 3600.0),
    }
}

/// Shows what the adapter does.
pub struct Progress {
    shown: bool,
    stop: &'static AtomicBool,
    /// Whether there is no room for the mesh.
    is_in_vain: AtomicBool,
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
    /// Whether forecasts are told.
    tells_forecasts: bool,
    /// Most that there may be.
    most: Option<usize>,
    /// Where the mesh goes.
    output: Option<PathBuf>,
    /// Why it cannot be written there.
    no_room: Option<String>,
    /// What the first run was expected to take.
    forecast: Option<Forecast>,
    /// When the passes began, how long they were expected to take, s, and what share of them is done.
    passes: (Instant, f64, f64),
    /// Runs that come after this one at least.
    further: usize,
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
            tells_forecasts: false,
            most: None,
            output: None,
            no_room: None,
            forecast: None,
            passes: (Instant::now(), 0.0, 0.0),
            further: 0,
        };
        let shown = !terminal::is_quiet() && std::io::IsTerminal::is_terminal(&std::io::stderr());
        Self { shown, stop, is_in_vain: AtomicBool::new(false), state: Mutex::new(state) }
    }

    /// Forecasts are told, and where there are to be more than so many vertices a warning. A run ends at once where the disk of the output has no
    /// room for its mesh ([`Progress::has_room`]).
    pub fn tell_forecasts(&self, most: Option<usize>, output: &Path) {
        let mut state = self.state.lock().expect("no panic while drawing");
        (state.tells_forecasts, state.most) = (!terminal::is_quiet(), most);
        state.output = Some(output.to_owned());
    }

    /// Whether the disk has room for the mesh of the last run, by its forecast.
    ///
    /// # Errors
    /// How much room there is, and how much it takes.
    pub fn has_room(&self) -> Result<(), String> {
        self.state.lock().expect("no panic while drawing").no_room.take().map_or(Ok(()), Err)
    }

    /// So many runs come after this one at least, each of which takes about as long.
    pub fn expect_further(&self, runs: usize) {
        self.state.lock().expect("no panic while drawing").further = runs;
    }

    /// What the last run was expected to take.
    pub fn forecast(&self) -> Option<Forecast> {
        self.state.lock().expect("no panic while drawing").forecast
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

    /// What most people want to know comes first: a terminal may be narrow.
    fn describe(&self) -> String {
        let [_, _, reconnect, smooth, ..] = self.done;
        let (name, now) = (self.kind.name(), self.vertices);
        let expected = if self.expected > 0 { format!(" of ~{}", self.expected) } else { String::new() };
        let (began, forecast, share) = self.passes;
        let left = seconds_left(began.elapsed().as_secs_f64(), share, forecast) + self.further as f64 * forecast;
        format!("{} left, {now}{expected} vertices, {name}, {reconnect} flips, {smooth} moves", about(left))
    }
}

impl Observer for Progress {
    fn vertices(&self, count: usize) {
        self.state.lock().expect("no panic while drawing").vertices = count as u64;
    }

    fn forecast(&self, forecast: &Forecast) {
        let mut state = self.state.lock().expect("no panic while drawing");
        let Forecast { vertices, seconds, bytes } = *forecast;
        state.expected = vertices.round() as u64;
        state.forecast = Some(*forecast);
        state.passes = (Instant::now(), seconds, 0.0);
        events::tell(|| json!({ "kind": "forecast", "vertices": vertices, "seconds": seconds, "bytes": bytes }));
        let written = state.most.map_or(vertices, |most| vertices.min(most as f64));
        state.no_room = state.output.as_deref().and_then(|output| room::lacking(output, written));
        self.is_in_vain.store(state.no_room.is_some(), Relaxed);
        if !state.tells_forecasts {
            return;
        }
        let vertices = vertices.round();
        if seconds >= WORTH_TELLING {
            let (time, megabytes) = (about(seconds), bytes / 1e6);
            crate::cli::tell(format_args!("the metric asks for about {vertices} vertices: {time}, {megabytes:.0} MB"));
        }
        if let Some(most) = state.most.filter(|&most| vertices > most as f64) {
            crate::cli::note(format_args!(
                "the mesh will end with {most} vertices (--max-vertices, or what there is memory for), and not meet the metric"
            ));
        }
    }

    fn share(&self, done: f64, vertices: f64) {
        let mut state = self.state.lock().expect("no panic while drawing");
        state.passes.2 = done;
        state.expected = vertices.round() as u64;
    }

    fn begin(&self, kind: Kind, pass: usize, items: usize) {
        let mut state = self.state.lock().expect("no panic while drawing");
        state.kind = kind;
        state.began = Instant::now();
        events::tell_often(|| {
            let (began, forecast, share) = state.passes;
            let left = seconds_left(began.elapsed().as_secs_f64(), share, forecast) + state.further as f64 * forecast;
            json!({
                "kind": "pass", "pass": pass + 1, "operation": kind.name(), "vertices": state.vertices,
                "expected": state.expected, "share": share, "left": left,
            })
        });
        if self.shown && state.pass != Some(pass) {
            state.leave();
            let style = ProgressStyle::with_template("pass {prefix:>2} [{bar:8}] {elapsed:>4}, {wide_msg}");
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
        self.interrupted() || self.is_in_vain.load(Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_is_seen_on_a_narrow_terminal() {
        static STOP: AtomicBool = AtomicBool::new(false);
        let progress = Progress::new(&STOP);
        progress.expect_further(1);
        Observer::forecast(&progress, &Forecast { vertices: 1_234_567.0, seconds: 3600.0, bytes: 1e9 });
        progress.vertices(1_000_000);
        let told = progress.state.lock().unwrap().describe();
        // The bar before it has 25 of 80 columns; a second run takes as long as this one.
        assert!(told[..54].starts_with("about 2 h left, 1000000 of ~1234567 vertices, "), "{told}");
    }
}
