//! Runs a prepared configuration of SU2. What diverges is run again with a lower Courant number, to first order for a while, then back; at last from
//! the free stream.
use super::cfg::Cfg;
use super::{CONFIG, HISTORY, RESTART, history};
use crate::process::{Log, Outcome as Ended, Runner, Tie, errors_or_last_lines};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// The file of the plan in the folder of the step.
pub const PLAN: &str = "plan.json";

/// The file of what came of it there.
pub const RESULT: &str = "outcome.json";

/// The configuration of a single run of SU2, and what it says.
const RUN: &str = "run.cfg";
const LOG: &str = "su2.log";

/// Where the run of first order leaves its solution.
const FIRST: &str = "first";

/// By how much the Courant number is lowered each time.
const SLOWER: f64 = 4.0;

/// How often a solve is run again.
const AGAIN: u32 = 3;

/// The time between two looks at the history of a run, and between two looks at whether the run shall end.
const LOOK: Duration = Duration::from_secs(5);
const TICK: Duration = Duration::from_millis(20);

/// Schemes that are centred: to first order they are Lax and Friedrichs'.
const CENTRED: [&str; 4] = ["JST", "JST_KE", "JST_MAT", "LAX-FRIEDRICH"];

/// What is to be done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// The program with the words before its configuration.
    pub words: Vec<String>,
    /// Variables of its environment.
    pub environment: Vec<(String, String)>,
    /// Iterations of first order, where they are wanted.
    pub first_order: u32,
}

/// What came of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// How often it diverged.
    pub diverged: u32,
    /// Iterations of the run that counts.
    pub iterations: u64,
}

/// How a run of SU2 failed.
enum Failure {
    /// It diverged: another run may not.
    Diverged(String),
    /// Nothing else will do.
    Stopped(String),
}

/// Runs SU2 in a folder as its plan says, until `stop` is set; `tell` is given a line where it diverges.
///
/// # Errors
/// When a file is not there or cannot be written, or SU2 refuses its configuration, or diverges each time: with the last lines of its log.
pub fn drive(folder: &Path, stop: &AtomicBool, tell: &mut dyn FnMut(&str)) -> Result<Outcome, String> {
    let path = folder.join(PLAN);
    let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let text = std::fs::read_to_string(&path).map_err(|error| named(&error))?;
    let plan: Plan = serde_json::from_str(&text).map_err(|error| named(&error))?;
    let asked = Cfg::read(&folder.join(CONFIG))?;
    let mut diverged = 0;
    loop {
        let stages = stages(&asked, plan.first_order, diverged);
        let run = |stage: &Cfg| run(folder, &plan, stage, stop);
        match stages.iter().try_for_each(run) {
            Ok(()) => break,
            Err(Failure::Stopped(error)) => return Err(error),
            Err(Failure::Diverged(error)) if diverged == AGAIN => return Err(format!("however slow it is, {error}")),
            Err(Failure::Diverged(_)) => diverged += 1,
        }
        let from = if diverged == AGAIN { "from the free stream" } else { "from the same start" };
        tell(&format!(
            "diverged: again {from}, with a Courant number of {}, {} iterations of first order before",
            courant(&asked, diverged),
            plan.first_order
        ));
    }
    let iterations = history::rows(&folder.join(HISTORY).with_extension("csv"));
    let outcome = Outcome { diverged, iterations };
    let text = serde_json::to_string_pretty(&outcome).map_err(|error| error.to_string())?;
    let path = folder.join(RESULT);
    std::fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(outcome)
}

/// The Courant number after so many failures.
fn courant(asked: &Cfg, diverged: u32) -> f64 {
    let given = asked.get("CFL_NUMBER").and_then(|value| value.parse().ok()).unwrap_or(1.25);
    given / SLOWER.powi(diverged as i32)
}

/// The runs of an attempt.
fn stages(asked: &Cfg, first_order: u32, diverged: u32) -> Vec<Cfg> {
    if diverged == 0 {
        return vec![asked.clone()];
    }
    let mut slow = asked.clone();
    slow.set("CFL_NUMBER", &courant(asked, diverged).to_string());
    if diverged > 1 {
        slow.set("CFL_ADAPT", "NO");
    }
    let mut first = slow.clone();
    let scheme = asked.get("CONV_NUM_METHOD_FLOW").unwrap_or_default();
    if CENTRED.contains(&scheme.as_str()) {
        first.set("CONV_NUM_METHOD_FLOW", "LAX-FRIEDRICH");
    } else {
        first.set("MUSCL_FLOW", "NO");
    }
    first.set("MUSCL_TURB", "NO");
    first.set("ITER", &first_order.to_string());
    first.set("RESTART_FILENAME", FIRST);
    if diverged == AGAIN {
        first.set("RESTART_SOL", "NO");
    }
    slow.set("RESTART_SOL", "YES");
    slow.set("SOLUTION_FILENAME", FIRST);
    vec![first, slow]
}

/// A run of SU2.
fn run(folder: &Path, plan: &Plan, cfg: &Cfg, stop: &AtomicBool) -> Result<(), Failure> {
    let log = folder.join(LOG);
    let named = |error: std::io::Error| Failure::Stopped(format!("{}: {error}", log.display()));
    let history = folder.join(HISTORY).with_extension("csv");
    // What an earlier run has left is none of this one.
    for left in [&history, &folder.join(RESTART).with_extension("dat"), &folder.join(RESTART).with_extension("csv")] {
        let _ = std::fs::remove_file(left);
    }
    cfg.write(&folder.join(RUN)).map_err(Failure::Stopped)?;
    let said = Log::create(&log).map_err(named)?;
    let [program, before @ ..] = &plan.words[..] else { return Err(Failure::Stopped("no program".into())) };
    let mut command = Command::new(program);
    command.args(before).arg(RUN).current_dir(folder);
    command.envs(plan.environment.iter().map(|(name, value)| (name, value)));
    // In the group that the loop gave us, which ends as one.
    let run =
        |stop: &AtomicBool| Runner { tie: Tie::Shared, limit: None, stop, log: Some(&said) }.run(&mut command, |_| ());
    let (ended, diverged) = watched(&history, stop, run);
    if let Some(error) = diverged {
        return Err(Failure::Diverged(error));
    }
    let ended = ended
        .map_err(|error| Failure::Stopped(format!("{program} could not be started ({error}): is it installed?")))?;
    let told = || {
        format!(
            "{} {ended}; the end of {}:\n{}",
            plan.words.join(" "),
            log.display(),
            errors_or_last_lines(&log, &["Error"])
        )
    };
    let has_diverged = || std::fs::read(&log).is_ok_and(|text| String::from_utf8_lossy(&text).contains("diverged"));
    match ended {
        Ended::Done => history::check(&history).map_err(Failure::Diverged),
        // A crash before the first iteration is no divergence.
        Ended::Crashed(_) if history::rows(&history) > 0 => Err(Failure::Diverged(told())),
        Ended::Code(_) if has_diverged() => Err(Failure::Diverged(told())),
        _ => Err(Failure::Stopped(told())),
    }
}

/// Runs SU2 by `run`, which must end it when the flag that it gets is set: when `stop` is, or when the history tells of divergence. Returns what `run`
/// does, and what the history told.
fn watched<T>(history: &Path, stop: &AtomicBool, run: impl FnOnce(&AtomicBool) -> T) -> (T, Option<String>) {
    let [shall_end, has_ended] = [false, false].map(AtomicBool::new);
    let watch = || {
        let mut looked = Instant::now();
        while !has_ended.load(Ordering::SeqCst) {
            std::thread::sleep(TICK);
            if stop.load(Ordering::SeqCst) {
                shall_end.store(true, Ordering::SeqCst);
            }
            if looked.elapsed() > LOOK {
                looked = Instant::now();
                // There is no history before the first iteration.
                if history.exists()
                    && let Err(error) = history::check(history)
                {
                    shall_end.store(true, Ordering::SeqCst);
                    return Some(error);
                }
            }
        }
        None
    };
    std::thread::scope(|scope| {
        let watching = scope.spawn(watch);
        let ended = run(&shall_end);
        has_ended.store(true, Ordering::SeqCst);
        (ended, watching.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(text: &str) -> Cfg {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.cfg");
        std::fs::write(&path, text).unwrap();
        Cfg::read(&path).unwrap()
    }

    #[test]
    fn what_diverges_goes_slower_and_to_first_order_first() {
        let cfg =
            asked("CFL_NUMBER= 8 % mine\nMUSCL_FLOW= YES\nRESTART_SOL= YES\nSOLUTION_FILENAME= before\nITER= 500\n");
        assert_eq!(stages(&cfg, 100, 0).len(), 1);
        let [first, then] = &stages(&cfg, 100, 1)[..] else { panic!("two") };
        let of = |cfg: &Cfg, key: &str| cfg.get(key).unwrap_or_default();
        assert_eq!(
            [of(first, "CFL_NUMBER"), of(first, "MUSCL_FLOW"), of(first, "ITER"), of(first, "RESTART_SOL")],
            ["2", "NO", "100", "YES"]
        );
        assert_eq!([of(then, "CFL_NUMBER"), of(then, "MUSCL_FLOW"), of(then, "ITER")], ["2", "YES", "500"]);
        assert_eq!([of(then, "RESTART_SOL"), of(then, "SOLUTION_FILENAME")], ["YES", "first"]);
        let last = &stages(&cfg, 100, AGAIN)[0];
        assert_eq!([of(last, "RESTART_SOL"), of(last, "CFL_ADAPT"), of(last, "CFL_NUMBER")], ["NO", "NO", "0.125"]);
        let centred = &stages(&asked("CONV_NUM_METHOD_FLOW= JST\n"), 10, 1)[0];
        assert_eq!(of(centred, "CONV_NUM_METHOD_FLOW"), "LAX-FRIEDRICH");
    }
}
