//! Runs a prepared case, some steps at a time, until it stands still or its steps are used up. What blows up is repeated, to see where, then with
//! first order there, and if that does not help with smaller steps.
use super::adjoint;
use super::cells::Cells;
use super::dictionaries::{Steps, write_stage};
use super::first_order::FirstOrderCells;
use super::flow::Flow;
use super::forces::{Coefficients, Walls};
use super::mean::Mean;
use super::method::{Method, Scheme, Stage};
use super::programs::{Failure, Program, solve};
use super::state::{State, field};
use super::step_control::StepControl;
use crate::formats::foam;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// The file of the plan in the folder of the case.
pub const PLAN: &str = "plan.json";

/// The file of the results there.
pub const RESULT: &str = "coefficients.json";

/// The folder of the mean fields there, where the flow swings about.
const MEAN: &str = "mean";

/// How often a block may blow up with ever more cells of first order before it is made slower.
const TRIALS: usize = 3;

/// What is to be done with a case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// The program, that of the stage's method.
    pub program: Program,
    /// The flow.
    pub flow: Flow,
    /// References of the walls.
    pub walls: Vec<i32>,
    /// Patches of planes of symmetry.
    pub symmetry: Vec<String>,
    /// How.
    pub stage: Stage,
    /// Steps of first order before.
    pub start_steps: usize,
    /// Further steps at most.
    pub steps: usize,
    /// Steps between two looks.
    pub block: usize,
    /// It stands still when pressure and coefficients change by less than this over a block, relatively, twice in a row.
    pub still: f64,
    /// The adjoint that is wanted too.
    pub adjoint: Option<adjoint::Plan>,
}

/// What came of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Of the fields that count, those of [`Outcome::fields`].
    pub coefficients: Coefficients,
    /// Steps that were made and kept.
    pub steps: usize,
    /// Relative change over the last block: of the pressure (root of squares over the volume) or a coefficient, whichever is more.
    pub change: f64,
    /// Whether it stood still before the steps were used up.
    pub still: bool,
    /// Blocks that blew up and were repeated.
    pub repeated: usize,
    /// Cells that were solved to first order in the end, where it had blown up.
    pub first_order: usize,
    /// Of how many looks at a flow that swings about the mean was taken, and is what counts; 0: what counts is the last step.
    pub averaged: usize,
    /// Iterations of the adjoint and its flow of constant density.
    pub adjoint: Option<usize>,
}

impl Outcome {
    /// The folder of the fields that count: the mean ones, or those of the last step.
    ///
    /// # Errors
    /// When there is none of the last step.
    pub fn fields(&self, case: &Path) -> Result<PathBuf, String> {
        if self.averaged > 0 { Ok(case.join(MEAN)) } else { last_time(case) }
    }
}

/// Runs the case in the folder as its plan says, until `stop` is set; `tell` is given a line a block.
///
/// # Errors
/// When a file is not there or cannot be written, or it blows up however small the steps are: with the last lines of its log.
pub fn drive(case: &Path, stop: &AtomicBool, tell: &mut dyn FnMut(&str)) -> Result<Outcome, String> {
    let path = case.join(PLAN);
    let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let text = std::fs::read_to_string(&path).map_err(|error| named(&error))?;
    let plan: Plan = serde_json::from_str(&text).map_err(|error| named(&error))?;
    let cells = Cells::of(foam::read_mesh(case).map_err(|error| error.to_string())?);
    let mut run = Run::new(case, &plan, &cells, stop)?;
    let first = Stage { scheme: Scheme::Upwind, ..plan.stage };
    while run.at < plan.start_steps {
        run.block(first, plan.start_steps, tell)?;
    }
    let end = plan.start_steps + plan.steps;
    let mut calm = 0;
    while run.at < end && calm < 2 {
        let still = run.block(plan.stage, end, tell)?;
        calm = if still { calm + 1 } else { 0 };
    }
    let (still, mut averaged) = (calm >= 2, 0);
    if !still && let Some((mean, looks)) = run.mean() {
        mean.write(&case.join(MEAN))?;
        run.coefficients = run.walls.coefficients(&plan.flow, &mean.pressure, &mean.velocity);
        averaged = looks;
    }
    let mut outcome = Outcome {
        coefficients: run.coefficients,
        steps: run.at,
        change: run.change,
        still,
        repeated: run.repeated,
        first_order: run.marks.count,
        averaged,
        adjoint: None,
    };
    if let Some(wanted) = &plan.adjoint {
        let of = (&*outcome.fields(case)?, cells.count());
        outcome.adjoint = Some(adjoint::run(case, (&plan.flow, wanted), of, stop, tell)?);
    }
    let text = serde_json::to_string_pretty(&outcome).map_err(|error| error.to_string())?;
    std::fs::write(case.join(RESULT), text).map_err(|error| format!("{}: {error}", case.join(RESULT).display()))?;
    Ok(outcome)
}

struct Run<'a> {
    case: &'a Path,
    plan: &'a Plan,
    cells: &'a Cells,
    stop: &'a AtomicBool,
    walls: Walls,
    /// The step whose fields are there.
    at: usize,
    state: State,
    coefficients: Coefficients,
    change: f64,
    pace: StepControl,
    repeated: usize,
    marks: FirstOrderCells,
    mean: Mean,
}

impl<'a> Run<'a> {
    fn new(case: &'a Path, plan: &'a Plan, cells: &'a Cells, stop: &'a AtomicBool) -> Result<Self, String> {
        let state = State::read(&case.join("0"), cells.count())?;
        let walls = Walls::of(cells, &plan.walls);
        let (coefficients, change) = (Coefficients::default(), f64::INFINITY);
        let (pace, marks) = (StepControl::default(), FirstOrderCells::none(cells.count()));
        let mean = Mean::from(plan.start_steps + plan.steps.div_ceil(2));
        Ok(Self { case, plan, cells, stop, walls, at: 0, state, coefficients, change, pace, repeated: 0, marks, mean })
    }

    /// Makes the next block of steps, at most to step `end`; whether the flow stood still over it.
    fn block(&mut self, stage: Stage, end: usize, tell: &mut dyn FnMut(&str)) -> Result<bool, String> {
        let (start, end) = (self.at, (self.at + self.plan.block).min(end));
        let limits = stage.method == Method::Central && stage.scheme != Scheme::Upwind;
        let (mut watched, mut trials) = (false, TRIALS);
        loop {
            let slower = stage.slower(self.pace.halvings());
            let marked = limits && self.marks.count > 0;
            let time = self.case.join(start.to_string());
            if marked {
                self.marks.write(self.case, &time, &self.plan.symmetry)?;
            }
            write_stage(self.case, &self.plan.flow, slower, Steps { start, end, watched, marked })?;
            let ended = self.start(end);
            if marked {
                FirstOrderCells::remove(&time);
            }
            let error = match ended {
                Ok(state) => {
                    self.take(end, state);
                    let Coefficients { lift, drag } = self.coefficients;
                    tell(&format!(
                        "step {end:>6}  CL {lift:>10.6}  CD {drag:>10.6}  change {:>9.2e}  {} {:?}",
                        self.change,
                        slower.pace(),
                        stage.scheme
                    ));
                    return Ok(self.change < self.plan.still);
                }
                Err(Failure::BlewUp(error)) => error,
                Err(Failure::Stopped(error)) => return Err(error),
            };
            self.repeated += 1;
            let blew_up = format!("step {end:>6}  blew up at {}", slower.pace());
            let failed = if watched && trials > 0 { self.mark() } else { 0 };
            if limits && !watched {
                watched = true;
                tell(&format!("{blew_up}: again from step {start}, to see where"));
            } else if failed > 0 {
                trials -= 1;
                let count = self.marks.count;
                tell(&format!(
                    "{blew_up} in {failed} cells: from step {start} with first order there, in {count} cells in all"
                ));
            } else if self.pace.slow_down() {
                tell(&format!("{blew_up}: half of that from step {start}"));
            } else {
                return Err(format!("however small the steps, {error}"));
            }
            self.forget();
        }
    }

    /// Marks cells where the block that blew up has failed, as its last fields show it; how many cells, which had no mark before.
    fn mark(&mut self) -> usize {
        let Ok(last) = last_time(self.case) else { return 0 };
        let (cells, before) = (self.cells.count(), &self.state);
        let (Ok(pressure), Ok(temperature)) = (field(&last, "p", cells), field(&last, "T", cells)) else { return 0 };
        self.marks.add(self.cells, [&before.pressure, &before.temperature], [&pressure, &temperature])
    }

    /// Removes what the steps after the last good one have left.
    fn forget(&self) {
        while let Some(last) = foam::newest_time(self.case)
            && last != self.case.join(self.at.to_string())
            && std::fs::remove_dir_all(&last).is_ok()
        {}
    }

    /// Makes the steps up to `end`: the fields there.
    fn start(&self, end: usize) -> Result<State, Failure> {
        let log = self.case.join(format!("log.{end}"));
        solve(self.case, &self.plan.program, &log, self.stop)?;
        let _ = std::fs::remove_file(&log); // of no use any more
        State::read(&self.case.join(end.to_string()), self.cells.count()).map_err(Failure::BlewUp)
    }

    /// Takes over a block that ended well, and drops the one before.
    fn take(&mut self, next: usize, state: State) {
        let coefficients = self.walls.coefficients(&self.plan.flow, &state.pressure, &state.velocity);
        let outside = self.plan.flow.pressure;
        // Where nothing but rounding is left, that is still.
        let away = self.size(|cell| state.pressure[cell] - outside) + self.size(|_| 1e-6 * outside);
        let moved = self.distance(&state.pressure, &self.state.pressure);
        let Coefficients { lift, drag } = self.coefficients;
        let forces = (coefficients.lift - lift).abs().max((coefficients.drag - drag).abs())
            / coefficients.lift.abs().max(coefficients.drag.abs()).max(1e-6);
        self.change = moved / away;
        if !self.walls.is_empty() {
            self.change = self.change.max(forces);
        }
        if self.at > 0 {
            remove(&self.case.join(self.at.to_string()));
        }
        self.mean.look(next, &state, moved);
        (self.at, self.state, self.coefficients) = (next, state, coefficients);
        self.pace.go_on();
    }

    /// Root of the integral of the square: the noise of a large far field must not outweigh the body's surroundings.
    fn size(&self, of: impl Fn(usize) -> f64) -> f64 {
        let volumes = self.cells.volumes.iter().enumerate();
        volumes.map(|(cell, volume)| volume * of(cell).powi(2)).sum::<f64>().sqrt()
    }

    /// The size of what two fields differ by.
    fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        self.size(|cell| a[cell] - b[cell])
    }

    /// The mean of the last half, if the flow swings about, and of how many looks it is.
    fn mean(&mut self) -> Option<(State, usize)> {
        let mean = std::mem::replace(&mut self.mean, Mean::from(usize::MAX));
        mean.of_swings(&self.state.pressure, |a, b| self.distance(a, b))
    }
}

/// Removes a folder of a time, which another will replace.
fn remove(folder: &Path) {
    let _ = std::fs::remove_dir_all(folder); // it may not have been written
}

/// The folder of the last step.
pub fn last_time(case: &Path) -> Result<PathBuf, String> {
    foam::newest_time(case).ok_or_else(|| format!("{}: there is no time folder", case.display()))
}
