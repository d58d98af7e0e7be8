//! What a run would do: for `geo-adapt cycle --dry-run`. Nothing is written.
use super::adaptation::{self, begun};
use super::config::{Loaded, TransferMethod};
use super::error::Error;
use super::layout::Layout;
use super::observer::Options;
use super::run::{State, found, launchable};
use std::path::{Path, PathBuf};

/// What a run would do.
#[derive(Debug)]
pub struct Plan {
    /// The folder of the loop.
    pub folder: PathBuf,
    /// Steps that are done, in their order: `cycle-01/solve`.
    pub finished: Vec<String>,
    /// Changes of the configuration that would be taken.
    pub taken: Vec<String>,
    /// The step that comes next; none where the loop has ended.
    pub next: Option<String>,
    /// The command of the next adaptation; none where there is none.
    pub adaptation: Option<String>,
    /// The adaptations that the schedule has, with their complexities: the first so many.
    pub complexities: Vec<f64>,
    /// Adaptations at most, where that is known.
    pub last: Option<u32>,
}

/// Complexities that are told at most.
const TOLD: u32 = 50;

/// Finds what a run of the loop would do.
///
/// # Errors
/// What the run would refuse.
pub fn plan(loaded: &Loaded, options: &Options) -> Result<Plan, Error> {
    let restart = options.restart;
    launchable(loaded)?;
    let folder = loaded.output();
    check_folder(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let layout = Layout::new(folder.canonicalize().unwrap_or(folder));
    let taken = if restart { Vec::new() } else { found(loaded, &layout, &State::of(loaded)?)? };
    let schedule = &loaded.config.schedule;
    let last = schedule.last();
    let all = steps(loaded, last.unwrap_or(TOLD));
    let is_done = |step: &&String| !restart && layout.is_done(&layout.root().join(step));
    let finished: Vec<String> = all.iter().take_while(is_done).cloned().collect();
    let next = all.get(finished.len()).cloned();
    let complexities = (1..=last.unwrap_or(TOLD).min(TOLD)).map(|cycle| schedule.of_cycle(cycle)).collect();
    let adapted = finished.iter().filter(|step| step.ends_with("/adapt")).count() as u32;
    let adaptation = (adapted < last.unwrap_or(TOLD)).then(|| {
        let begun = begun(loaded, &layout.mesh(1));
        adaptation::call(loaded, &layout, options.threads, adapted + 1, &begun).map(|call| call.line())
    });
    let adaptation = adaptation.transpose()?;
    Ok(Plan { folder: layout.root().to_owned(), finished, taken, next, adaptation, complexities, last })
}

/// The steps of a loop of so many adaptations, without its pictures.
fn steps(loaded: &Loaded, adaptations: u32) -> Vec<String> {
    let transfers = loaded.config.transfer.method != TransferMethod::None;
    let mut steps = vec!["start".to_owned()];
    let layout = Layout::new(PathBuf::new());
    let mut add = |cycle: u32, step: &str| steps.push(layout.step(cycle, step).display().to_string());
    for cycle in 1..=adaptations {
        ["solve", "metric", "adapt"].into_iter().for_each(|step| add(cycle, step));
        if transfers {
            add(cycle, "transfer");
        }
    }
    add(adaptations + 1, "solve");
    steps
}

/// Refuses a folder that could not be made or written to.
fn check_folder(folder: &Path) -> std::io::Result<()> {
    let there = folder.ancestors().find(|path| path.exists()).unwrap_or(folder);
    let within = if there == folder { folder.join("loop.json") } else { there.join("loop") };
    if !there.is_dir() {
        return Err(std::io::Error::other(format!("{} is no folder", there.display())));
    }
    crate::mesh::io::check_writable(&within)
}
