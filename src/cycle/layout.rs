//! Where the files of a loop lie.
use std::path::{Path, PathBuf};

/// The folder of a loop.
#[derive(Clone, Debug)]
pub struct Layout {
    root: PathBuf,
}

/// The file that a finished step leaves in its folder.
pub const DONE: &str = "done.json";

/// The step that draws.
pub const PICTURE: &str = "picture";

/// The steps of a cycle, in their order. A picture comes between solve and metric where one is drawn.
pub const STEPS: [&str; 5] = ["solve", PICTURE, "metric", "adapt", "transfer"];

impl Layout {
    /// Of a folder, absolute.
    pub fn new(root: PathBuf) -> Self {
        Self { root }
    }

    /// The folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// What the loop is: the configuration that it began with.
    pub fn state(&self) -> PathBuf {
        self.root.join("loop.json")
    }

    /// Held by the run that works here.
    pub fn lock(&self) -> PathBuf {
        self.root.join("lock")
    }

    /// What mpirun says where it cannot start processes.
    pub fn launch(&self) -> PathBuf {
        self.root.join("mpirun.log")
    }

    /// The report page.
    pub fn page(&self) -> PathBuf {
        self.root.join("report.html")
    }

    /// The last mesh and solution, when the loop has ended.
    pub fn result(&self) -> PathBuf {
        self.root.join("result")
    }

    /// The figures as JSON.
    pub fn figures(&self) -> PathBuf {
        self.root.join("report.json")
    }

    /// The first step.
    pub fn start(&self) -> PathBuf {
        self.root.join("start")
    }

    /// The folder of a cycle, from 1.
    pub fn cycle(&self, cycle: u32) -> PathBuf {
        self.root.join(format!("cycle-{cycle:02}"))
    }

    /// The folder of a step.
    pub fn step(&self, cycle: u32, step: &str) -> PathBuf {
        self.cycle(cycle).join(step)
    }

    /// The mesh of a cycle's solve: the start's, or what the cycle before adapted.
    pub fn mesh(&self, cycle: u32) -> PathBuf {
        let folder = if cycle == 1 { self.start() } else { self.step(cycle - 1, "adapt") };
        folder.join("mesh.meshb")
    }

    /// The solution of a cycle.
    pub fn solution(&self, cycle: u32) -> PathBuf {
        self.step(cycle, "solve").join("solution.solb")
    }

    /// The solution of the cycle before, brought to the mesh of this one.
    pub fn transferred(&self, cycle: u32) -> PathBuf {
        self.step(cycle - 1, "transfer").join("solution.solb")
    }

    /// A folder by its place in the loop, for people: `cycle-03/adapt`.
    pub fn name(&self, folder: &Path) -> String {
        folder.strip_prefix(&self.root).unwrap_or(folder).display().to_string()
    }

    /// The folders of the steps that follow from that of one, and are there: the last one first, so that what a kill leaves is none without
    /// those before it. Nothing follows from a picture.
    pub fn after(&self, folder: &Path) -> Vec<PathBuf> {
        let inside = folder.strip_prefix(&self.root).unwrap_or(folder);
        let mut names = inside.iter().map(|name| name.to_string_lossy());
        let cycle = names.next().and_then(|name| number(&name)).unwrap_or(0);
        let step = names.next().and_then(|name| STEPS.iter().position(|step| *step == name));
        if step.is_some_and(|step| STEPS[step] == PICTURE) {
            return Vec::new();
        }
        let cycles = self.cycles().into_iter().rev().filter(|&(number, _)| number >= cycle);
        let all = cycles.flat_map(|(number, path)| {
            let first = if number == cycle { step.map_or(0, |step| step + 1) } else { 0 };
            STEPS[first..].iter().rev().map(move |step| path.join(step)).collect::<Vec<_>>()
        });
        all.filter(|path| path.is_dir()).collect()
    }

    /// Whether the step of a folder is done.
    pub fn is_done(&self, folder: &Path) -> bool {
        folder.join(DONE).is_file()
    }

    /// The cycles of which a step is done.
    pub fn finished(&self, step: &str) -> Vec<u32> {
        let numbers = self.cycles().into_iter().map(|(cycle, _)| cycle);
        numbers.filter(|&cycle| self.is_done(&self.step(cycle, step))).collect()
    }

    /// All folders of cycles that are there, in their order.
    fn cycles(&self) -> Vec<(u32, PathBuf)> {
        let entries = std::fs::read_dir(&self.root).into_iter().flatten().flatten();
        let numbered = entries.filter_map(|entry| Some((number(&entry.file_name().to_string_lossy())?, entry.path())));
        let mut found: Vec<(u32, PathBuf)> = numbered.filter(|(_, path)| path.is_dir()).collect();
        found.sort();
        found
    }

    /// All folders of steps that are there: the start, and the cycles.
    pub fn present(&self) -> Vec<PathBuf> {
        let start = Some(self.start()).filter(|path| path.is_dir());
        self.cycles().into_iter().map(|(_, path)| path).chain(start).collect()
    }
}

/// The number of a folder of a cycle.
fn number(name: &str) -> Option<u32> {
    name.strip_prefix("cycle-").filter(|number| number.bytes().all(|c| c.is_ascii_digit()))?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_follows_from_a_step_is_found_last_first() {
        let root = tempfile::tempdir().unwrap();
        let layout = Layout::new(root.path().into());
        let make = |path: PathBuf| std::fs::create_dir_all(path).unwrap();
        make(layout.start());
        for (cycle, steps) in [(1, &STEPS[..]), (99, &["solve", "adapt"]), (100, &["solve"])] {
            steps.iter().for_each(|step| make(layout.step(cycle, step)));
        }
        let after =
            |folder: PathBuf| -> Vec<String> { layout.after(&folder).iter().map(|path| layout.name(path)).collect() };
        assert_eq!(after(layout.step(100, "solve")), [""; 0]);
        assert_eq!(after(layout.step(99, "solve")), ["cycle-100/solve", "cycle-99/adapt"]);
        assert_eq!(after(layout.step(1, "metric"))[3..], ["cycle-01/transfer", "cycle-01/adapt"]);
        assert_eq!(after(layout.step(1, PICTURE)), [""; 0]);
        assert_eq!(after(layout.start()).len(), 8);
        assert_eq!(layout.present().len(), 4);
    }
}
