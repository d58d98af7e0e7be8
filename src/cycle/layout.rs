//! Where the files of a loop lie.
use std::path::{Path, PathBuf};

/// The folder of a loop.
#[derive(Clone, Debug)]
pub struct Layout {
    root: PathBuf,
}

/// The steps of a cycle, in their order. A picture comes between solve and metric where one is drawn.
pub const STEPS: [&str; 5] = ["solve", "picture", "metric", "adapt", "transfer"];

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

    /// The report page.
    pub fn page(&self) -> PathBuf {
        self.root.join("report.html")
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

    /// All folders of steps that are there.
    pub fn present(&self) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(&self.root).into_iter().flatten().flatten();
        let is_ours = |name: &str| {
            name == "start"
                || name.strip_prefix("cycle-").is_some_and(|number| number.bytes().all(|c| c.is_ascii_digit()))
        };
        let mut found: Vec<PathBuf> = entries
            .filter(|entry| is_ours(&entry.file_name().to_string_lossy()))
            .map(|entry| entry.path())
            .filter(|path| path.is_dir())
            .collect();
        found.sort();
        found
    }
}
