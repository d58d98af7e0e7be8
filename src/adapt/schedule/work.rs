//! What the passes report: kinds of operations with their times and counts, and the observer.
use crate::adapt::core::refusal::Counts;
use crate::adapt::forecast::Forecast;
use std::time::Duration;

/// Number of kinds of operations.
pub const KINDS: usize = 6;

/// A kind of operation, for progress and report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Insertion.
    Split,
    /// Collapse.
    Collapse,
    /// Reconnection.
    Reconnect,
    /// Smoothing.
    Smooth,
    /// Projection on the model.
    Project,
    /// Repair of the worst tetrahedra.
    Repair,
}

impl Kind {
    /// All kinds, in the order of their counters.
    pub const ALL: [Kind; KINDS] =
        [Kind::Split, Kind::Collapse, Kind::Reconnect, Kind::Smooth, Kind::Project, Kind::Repair];

    /// The name in progress and reports.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Split => "insertion",
            Kind::Collapse => "collapse",
            Kind::Reconnect => "reconnection",
            Kind::Smooth => "smoothing",
            Kind::Project => "projection",
            Kind::Repair => "repair",
        }
    }
}

/// Time and counts of one kind of operation.
#[derive(Clone, Copy, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Work {
    /// Counts over all sweeps.
    pub counts: Counts,
    /// Sweeps.
    pub sweeps: u32,
    /// Wall time.
    pub time: Duration,
}

/// Is told what happens. Called from several threads.
pub trait Observer: Sync {
    /// The passes begin with so many vertices.
    fn vertices(&self, _count: usize) {}
    /// What the passes will take, told once they begin.
    fn forecast(&self, _forecast: &Forecast) {}
    /// This share of the work is done, from 0 to 1, and so many vertices are expected at the end: told after each pass.
    fn share(&self, _done: f64, _vertices: f64) {}
    /// A sweep begins.
    fn begin(&self, _kind: Kind, _pass: usize, _items: usize) {}
    /// This many more items are done.
    fn advance(&self, _items: usize) {}
    /// The sweep is over.
    fn end(&self, _counts: &Counts) {}
    /// Whether to stop as soon as can be: within a sweep, too.
    fn stop(&self) -> bool {
        false
    }
}

/// An observer that does nothing.
pub struct Silent;

impl Observer for Silent {}
