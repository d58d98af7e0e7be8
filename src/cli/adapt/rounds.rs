//! What the report says of a run part by part: its rounds and its processes.
use crate::cli::table::{Table, figure};
use crate::decomposition::{Adapted, NearCuts, Numbered, Quality, Told};
use crate::ranks::{Ranks, Traffic};
use serde::Serialize;

/// What the report says of a run part by part.
#[derive(Clone, Serialize)]
pub struct Parts {
    rounds: Vec<Told>,
    numbering: Numbered,
    /// Time for measuring the boundary before the rest is written, by rank 0, s.
    pub boundary_measured: f64,
    processes: Vec<Process>,
    /// How good the mesh is near former cuts and far from them.
    pub near_cuts: NearCuts,
}

/// What a process did until the mesh was adapted.
#[derive(Clone, Copy, Serialize)]
struct Process {
    /// Bytes sent to others.
    sent: u64,
    /// Time spent in sending, and in waiting for others, s.
    waited: f64,
    /// Seconds of its parts, all threads together.
    worked: f64,
}

impl Parts {
    /// Of all processes. Collective.
    pub fn of(adapted: &Adapted<'_>, ranks: &dyn Ranks) -> Self {
        let Traffic { sent, waited } = ranks.traffic();
        let own = [sent.to_le_bytes(), waited.to_le_bytes()].concat();
        let read = |bytes: Vec<u8>| {
            let [sent, waited] = [0, 8].map(|at| bytes[at..at + 8].try_into().unwrap_or_default());
            Process { sent: u64::from_le_bytes(sent), waited: f64::from_le_bytes(waited), worked: 0.0 }
        };
        let mut processes: Vec<Process> = ranks.gather(&own).into_iter().map(read).collect();
        // A run that goes on has rounds of another number of processes.
        for part in adapted.told().iter().flat_map(|told| &told.of_parts) {
            if let Some(process) = processes.get_mut(part.rank as usize) {
                process.worked += part.seconds;
            }
        }
        Self {
            rounds: adapted.told().to_vec(),
            numbering: adapted.numbered(),
            boundary_measured: 0.0,
            processes,
            near_cuts: NearCuts::default(),
        }
    }

    /// What the table says of it.
    pub fn rows(&self, table: &mut Table) {
        let parts: Vec<String> = self.rounds.iter().map(|told| told.parts.to_string()).collect();
        table.row("parts, round by round", parts.join(", "));
        let [greatest, sum] =
            self.rounds.iter().map(Told::greatest_and_sum).fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
        table.row("seconds of parts", format_args!("{sum:.2} in all, {greatest:.2} of the slowest of each round"));
        let NearCuts { untouched, around, at_cuts } = self.near_cuts;
        for (name, found) in [("at former cuts", at_cuts), ("around them", around), ("far from all cuts", untouched)] {
            if let (Some(Quality { tets, mean_ratio, least_ratio, unit_edges, .. }), true) = (found, around.is_some()) {
                let (least, mean, unit) = (figure(least_ratio), figure(mean_ratio), 100.0 * unit_edges);
                table.row(
                    name,
                    format_args!("{tets} tetrahedra, mean ratio least {least} mean {mean}, {unit:.2} % unit edges"),
                );
            }
        }
        if self.processes.len() > 1 {
            let sent: u64 = self.processes.iter().map(|process| process.sent).sum();
            let most = |of: fn(&Process) -> f64| self.processes.iter().map(of).fold(0.0, f64::max);
            let waited = most(|process| process.waited);
            let mean = self.processes.iter().map(|process| process.worked).sum::<f64>() / self.processes.len() as f64;
            let figures = format_args!(
                "{}; {:.1} MB sent, {waited:.2} s waited at the most; the busiest works {:.2} times the mean",
                self.processes.len(),
                sent as f64 / 1e6,
                most(|process| process.worked) / mean.max(f64::MIN_POSITIVE)
            );
            table.row("processes", figures);
        }
    }
}
