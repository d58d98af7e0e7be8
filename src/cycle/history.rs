//! What the finished steps tell, for the report and the terminal.
use super::data::{Adapted, SolveResult};
use super::done::finished;
use super::layout::{Layout, STEPS};
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;

/// Seconds by step.
pub type Seconds = BTreeMap<&'static str, f64>;

/// A cycle as far as it is done: its mesh, the solution on it, and how long its steps took.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Cycle {
    /// From 1.
    pub cycle: u32,
    /// The complexity that its mesh was adapted to, in the cycle before; none of the first mesh.
    pub complexity: Option<f64>,
    /// Vertices.
    pub vertices: usize,
    /// Tetrahedra.
    pub tets: usize,
    /// Functionals of the solution.
    pub functionals: BTreeMap<String, f64>,
    /// Wall times, s.
    pub seconds: Seconds,
    /// Edge lengths, mean ratios and more of the mesh in its metric, as `adapt --report` has them; none of the first mesh.
    pub statistics: Option<Value>,
    /// Processes that adapted the mesh, where it was adapted part by part.
    pub processes: Option<usize>,
    /// Whether there are pictures.
    pub pictures: bool,
}

/// All cycles.
#[derive(Clone, Debug, Default, Serialize)]
pub struct History {
    /// In their order.
    pub cycles: Vec<Cycle>,
    /// Seconds of the first mesh.
    pub start_seconds: f64,
    /// Why the loop ended; none while it goes on.
    pub ended: Option<String>,
}

impl History {
    /// Of the finished steps up to the solve of a cycle.
    pub fn of(layout: &Layout, last: u32) -> Self {
        let start_seconds = finished::<Value>(&layout.start()).map_or(0.0, |done| done.seconds);
        let cycles = (1..=last).filter_map(|cycle| Cycle::of(layout, cycle)).collect();
        Self { cycles, start_seconds, ended: None }
    }
}

impl Cycle {
    /// Of a cycle whose solve is done.
    fn of(layout: &Layout, cycle: u32) -> Option<Self> {
        let solved = finished::<SolveResult>(&layout.step(cycle, "solve"))?.result;
        let seconds =
            STEPS.iter().filter_map(|&step| Some((step, finished::<Value>(&layout.step(cycle, step))?.seconds)));
        let adapted = (cycle > 1).then(|| layout.step(cycle - 1, "adapt"));
        let report = adapted.as_ref().and_then(|folder| fs::read(folder.join("report.json")).ok());
        let report: Option<Value> = report.and_then(|bytes| serde_json::from_slice(&bytes).ok());
        let processes = report.as_ref().and_then(|report| Some(report["parts"]["processes"].as_array()?.len()));
        Some(Self {
            cycle,
            complexity: adapted.and_then(|folder| finished::<Adapted>(&folder)).map(|done| done.result.complexity),
            vertices: solved.vertices,
            tets: solved.tets,
            functionals: solved.functionals,
            seconds: seconds.collect(),
            statistics: report.and_then(|mut report| Some(report.get_mut("statistics")?.take())),
            processes,
            pictures: finished::<Value>(&layout.step(cycle, "picture")).is_some(),
        })
    }
}
