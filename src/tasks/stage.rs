//! Stages of a run, told on standard error to whoever measures: `GEO_ADAPT_TRACE=1`.
use std::sync::{LazyLock, Mutex};
use std::time::Instant;

static LAST: LazyLock<Mutex<(Instant, Instant)>> = LazyLock::new(|| Mutex::new((Instant::now(), Instant::now())));

/// Says, if the trace is wanted, that a stage is over: its seconds since the one before, those since the first, and where the
/// system tells it (Linux) the memory in use now and the most there was, MB.
pub fn stage(name: &str) {
    if std::env::var_os("GEO_ADAPT_TRACE").is_none() {
        return;
    }
    let mut last = LAST.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let now = Instant::now();
    let [step, all] = [now - last.1, now - last.0].map(|time| time.as_secs_f64());
    last.1 = now;
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let megabytes = |field: &str| {
        let line = status.lines().find_map(|line| line.strip_prefix(field))?;
        Some(line.split_whitespace().next()?.parse::<f64>().ok()? / 1000.0)
    };
    let memory = megabytes("VmRSS:").zip(megabytes("VmHWM:"));
    let memory = memory.map_or(String::new(), |(now, most)| format!("{now:>7.0} MB, most {most:.0}"));
    eprintln!("stage {name:<22}{step:>7.2} s, at {all:>6.2} s {memory}");
}
