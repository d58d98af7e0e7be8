//! The loop from its beginning, or from where it was left, to its end.
use super::changes::Changes;
use super::config::{Config, Loaded, TransferMethod};
use super::data::SolveResult;
use super::done::write_json;
use super::error::Error;
use super::history::History;
use super::inputs::{self, Fingerprints};
use super::launch;
use super::layout::Layout;
use super::observer::{Observer, Options};
use super::pipeline::Pipeline;
use super::result::{self, Files};
use super::solver::Choice;
use super::step::Steps;
use super::{leftovers, report};
use crate::geometry::names;
use crate::mesh::io::read_mesh;
use crate::process::Stop;
use crate::ranks;
use serde::{Deserialize, Serialize};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::Write;
use std::sync::atomic::Ordering::Relaxed;

/// How a loop ended.
#[derive(Debug)]
pub struct Ended {
    /// Why.
    pub reason: String,
    /// All cycles.
    pub history: History,
    /// What the folder of the result holds.
    pub files: Files,
}

/// What `loop.json` says.
#[derive(Serialize, Deserialize)]
pub(super) struct State {
    version: String,
    config: Config,
    inputs: Fingerprints,
}

impl State {
    /// Of the loop as it would begin now.
    ///
    /// # Errors
    /// When an input cannot be read.
    pub(super) fn of(loaded: &Loaded) -> Result<Self, Error> {
        let (config, inputs) = (loaded.config.clone(), inputs::fingerprints(loaded)?);
        Ok(Self { version: env!("CARGO_PKG_VERSION").into(), config, inputs })
    }
}

/// What of it is known whatever else has changed from a version to the next.
#[derive(Deserialize)]
struct Version {
    version: String,
}

/// Runs the loop to its end.
///
/// # Errors
/// [`Error::Interrupted`] when the user ended it, [`Error::Failed`] with place and remedy. In both cases it goes on with the same call.
pub fn run(loaded: &Loaded, options: &Options, observer: &dyn Observer, stop: &Stop) -> Result<Ended, Error> {
    launchable(loaded)?;
    let folder = loaded.output();
    let named = |error: std::io::Error| Error::Failed(format!("{}: {error}", folder.display()));
    fs::create_dir_all(&folder).map_err(named)?;
    // Without `..`: its files are named in commands.
    let layout = Layout::new(folder.canonicalize().map_err(named)?);
    let lock = File::create(layout.lock()).map_err(named)?;
    if matches!(lock.try_lock(), Err(TryLockError::WouldBlock)) {
        return Err(Error::Failed(format!(
            "{}: another run of geo-adapt cycle works in this folder: wait for its end, or give another [output] folder",
            layout.root().display()
        )));
    }
    let steps = Steps { layout: &layout, observer, stop };
    launch::meet(loaded.config.adapt.processes(), &layout.launch(), stop).map_err(|error| match error {
        Error::Failed(message) => Error::Failed(format!("{}: {message}", loaded.path.display())),
        other => other,
    })?;
    begin(loaded, options, steps)?;
    let threads = loaded.config.threads.map_or_else(Vec::new, |threads| vec!["--threads".into(), threads.to_string()]);
    let pipeline = Pipeline { loaded, steps, options, threads };
    let outcome = go(&pipeline, observer, stop);
    drop(lock);
    outcome
}

/// Refuses what asks for programs that are not there, before the first of them has worked for an hour.
///
/// # Errors
/// Which, and how to get it.
pub(super) fn launchable(loaded: &Loaded) -> Result<(), Error> {
    let (config, several) = (&loaded.config, loaded.config.adapt.processes());
    let own = if several > 1 { ranks::check() } else { Ok(()) };
    let own = own.map_err(|error| format!("[adapt] processes is above 1, but {error}; or give processes = 1"));
    let checked = own.and_then(|()| launch::check("[adapt]", several));
    let checked = checked.and_then(|()| config.solver.solver().check(&loaded.base));
    checked.map_err(|error| Error::Failed(format!("{}: {error}", loaded.path.display())))
}

/// Begins a loop, or goes on with what is there.
fn begin(loaded: &Loaded, options: &Options, steps: Steps<'_>) -> Result<(), Error> {
    let layout = steps.layout;
    let state = State::of(loaded)?;
    leftovers::remove_temporaries(layout);
    if !options.restart {
        for change in found(loaded, layout, &state)? {
            steps.observer.note(&format!("{change}: taken, for nothing that depends on it is done"));
        }
        return write_json(&layout.state(), &state);
    }
    // First what says that there is a loop: a kill on the way leaves one that asks for --restart again.
    let _ = fs::remove_file(layout.state());
    let _ = fs::remove_dir_all(layout.result());
    for folder in layout.present() {
        for step in super::layout::STEPS {
            steps.clear(&folder.join(step))?;
        }
        steps.clear(&folder)?;
    }
    write_json(&layout.state(), &state)
}

/// Finds what is there: nothing, or a loop that goes on with this state. The changes of its configuration that can be taken.
///
/// # Errors
/// When it is another loop, or one that cannot be read.
pub(super) fn found(loaded: &Loaded, layout: &Layout, state: &State) -> Result<Vec<String>, Error> {
    let place = layout.state().display().to_string();
    let bytes = match fs::read(layout.state()) {
        Ok(bytes) => bytes,
        Err(_) if layout.present().is_empty() => return Ok(Vec::new()),
        Err(error) => {
            return Err(Error::Failed(format!(
                "{place}: {error}; but there are steps of a loop beside it: --restart removes them and begins anew"
            )));
        }
    };
    let unreadable = |error: serde_json::Error| {
        Error::Failed(format!(
            "{place}: the loop in this folder cannot be read ({error}): --restart removes it and begins anew"
        ))
    };
    let Version { version } = serde_json::from_slice(&bytes).map_err(unreadable)?;
    if version != state.version {
        return Err(Error::Failed(format!(
            "{place}: this loop was begun by geo-adapt {version}, and this is {}: their steps do not make one loop. Go on with that one, \
             give another [output] folder, or --restart to throw away what is there",
            state.version
        )));
    }
    let old: State = serde_json::from_slice(&bytes).map_err(unreadable)?;
    let Changes { refused, taken } = Changes::of(layout, &old.config, &loaded.config);
    if !refused.is_empty() {
        return Err(Error::Failed(format!(
            "{}: the loop in {} was begun with another configuration, and steps are done that depend on it: {}. Change it back to go on, \
             give another [output] folder, or --restart to throw away what is there",
            loaded.path.display(),
            layout.root().display(),
            refused.join("; ")
        )));
    }
    let mut inputs = inputs::differences(&old.inputs, &state.inputs);
    // What no finished step has read may change.
    let of_solver: Vec<String> = [&old.config, &loaded.config]
        .into_iter()
        .flat_map(|config| config.solver.solver().inputs(&loaded.base))
        .map(|path| path.to_string_lossy().into_owned())
        .collect();
    let (began, solved) = (layout.is_done(&layout.start()), !layout.finished("solve").is_empty());
    inputs.retain(|(path, _)| if of_solver.contains(path) { solved } else { began });
    if !inputs.is_empty() {
        return Err(Error::Failed(format!(
            "{place}: what the loop began with is not the same any more: {}. Put it back to go on, give another [output] folder, or \
             --restart to throw away what is there",
            inputs.into_iter().map(|(_, text)| text).collect::<Vec<_>>().join("; ")
        )));
    }
    Ok(taken)
}

fn go(pipeline: &Pipeline<'_>, observer: &dyn Observer, stop: &Stop) -> Result<Ended, Error> {
    let (layout, config) = (pipeline.steps.layout, &pipeline.loaded.config);
    let begun = pipeline.start()?.result;
    let transfers = config.transfer.method != TransferMethod::None;
    let mut functional = Vec::new();
    let mut before: Option<SolveResult> = None;
    let mut cycle = 1;
    let solver = referenced(pipeline, observer)?;
    let (reason, history, files) = loop {
        let fields = before.as_ref().filter(|_| transfers);
        let solved = pipeline.solve(cycle, &solver, fields.map(|solved| &solved.fields[..]))?.result;
        if let Some(converged) = &config.schedule.converged {
            let value = solved.functionals.get(&converged.functional).ok_or_else(|| {
                let known: Vec<&str> = solved.functionals.keys().map(String::as_str).collect();
                let known = if known.is_empty() { "none".into() } else { known.join(", ") };
                format!(
                    "[schedule.converged] functional: the solver tells no '{}'; it tells {known}",
                    converged.functional
                )
            })?;
            functional.push(*value);
        }
        let estimated = config.goal.as_ref().and_then(|goal| goal.estimated(&solved.functionals));
        let ends = config.schedule.ends_with(estimated).or_else(|| config.schedule.ends(cycle - 1, &functional));
        // The last mesh of a complexity is shown.
        let last =
            cycle > 1 && (ends.is_some() || config.schedule.of_cycle(cycle - 1) != config.schedule.of_cycle(cycle));
        if config.output.pictures && last {
            pipeline.picture(cycle, &solved.fields)?;
        }
        let mut history = History::of(layout, cycle);
        history.cycles.last().into_iter().for_each(|last| observer.cycle(last));
        history.ended = ends.clone();
        write_json(&layout.figures(), &history)?;
        report::write(layout, config, &history)?;
        if let Some(reason) = ends {
            let files = result::write(layout, pipeline.loaded, &history, cycle, &solved)?;
            break (reason, history, files);
        }
        pipeline.metric(cycle, &solver, &solved.fields)?;
        pipeline.adapt(cycle, &begun)?;
        if transfers {
            pipeline.transfer(cycle)?;
        }
        if stop.asked.load(Relaxed) {
            return Err(Error::Interrupted);
        }
        before = Some(solved);
        cycle += 1;
    };
    Ok(Ended { reason, history, files })
}

/// The solver with reference values of its coefficients, where it has some and the configuration does not give them. It is said in the log of
/// the first mesh, of whose walls they are in all cycles.
fn referenced(pipeline: &Pipeline<'_>, observer: &dyn Observer) -> Result<Choice, Error> {
    let (layout, choice) = (pipeline.steps.layout, &pipeline.loaded.config.solver);
    if !choice.wants_reference() {
        return Ok(choice.clone());
    }
    let (mesh, names) = (read_mesh(&layout.mesh(1))?.content, names::read(&layout.mesh(1))?);
    let (choice, said) = choice.referenced(&mesh, &names);
    if !layout.is_done(&layout.step(1, "solve")) {
        observer.note(&said);
        let path = layout.start().join("log.txt");
        let open = OpenOptions::new().append(true).create(true).open(&path);
        let written = open.and_then(|mut log| writeln!(log, "{said}"));
        written.map_err(|error| Error::Failed(format!("{}: {error}", path.display())))?;
    }
    Ok(choice)
}
