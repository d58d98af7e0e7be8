//! Stages of a run, told on standard error to whoever measures: `GEO_ADAPT_STAGES=1`.
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{LazyLock, Mutex};
use std::time::Instant;

/// When the first stage began, and the last with the processor's time by then.
static BEGAN: LazyLock<(Instant, Mutex<(Instant, f64)>)> =
    LazyLock::new(|| (Instant::now(), Mutex::new((Instant::now(), processor_seconds()))));

static TELLS: AtomicBool = AtomicBool::new(false);

/// From now on stages are told, whatever the environment says.
pub fn tell_stages() {
    TELLS.store(true, Relaxed);
}

/// Says, if the trace is wanted, that a stage is over: its seconds since the one before by the clock and (where the system tells it:
/// Linux) on the processors, those since the first, the memory in use now and the most there was, MB.
pub fn stage(name: &str) {
    super::simulation::end_stage(name);
    if !TELLS.load(Relaxed) && std::env::var_os("GEO_ADAPT_STAGES").is_none() {
        return;
    }
    let (first, last) = &*BEGAN;
    let mut last = last.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let (now, processor) = (Instant::now(), processor_seconds());
    let [step, all] = [now - last.0, now - *first].map(|time| time.as_secs_f64());
    let cpu = processor - last.1;
    *last = (now, processor);
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let megabytes = |field: &str| {
        let line = status.lines().find_map(|line| line.strip_prefix(field));
        let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
        kilobytes.unwrap_or(f64::NAN) / 1000.0
    };
    let [memory, most] = ["VmRSS:", "VmHWM:"].map(megabytes);
    let _ = writeln!(
        std::io::stderr(),
        "stage {name:<18}{step:>7.2} s, cpu {cpu:>6.2} s, at {all:>6.2} s, {memory:>6.0} MB, most {most:.0} MB"
    );
}

/// Time of all threads in the program and in the system, in hundredths of a second as Linux tells it; NaN elsewhere.
fn processor_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // Behind the name in parentheses the state is the third field, the times the fourteenth and fifteenth.
    let ticks = text.rsplit_once(')').map(|(_, rest)| {
        let times = rest.split_whitespace().skip(11).take(2);
        times.filter_map(|field| field.parse::<f64>().ok()).sum::<f64>()
    });
    ticks.unwrap_or(f64::NAN) / 100.0
}
