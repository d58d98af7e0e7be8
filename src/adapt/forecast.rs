//! What a run will take: vertices, seconds, memory. How well that is known beforehand: docs/decisions/forecast.md.
use crate::memory;
use crate::metric::Sym3;
use crate::metric::batch::Batch;
use std::hint::black_box;
use std::time::Instant;

/// The greatest complexity: a unit of it has twelve tetrahedra, ids have 32 bits, and some ids are not used.
pub const GREATEST_COMPLEXITY: f64 = 2e8;

/// Vertices for a unit of complexity, those apart that the boundary brings.
const VERTICES_PER_COMPLEXITY: f64 = 1.7;

/// Vertices for a unit of the area of the boundary in the metric, beside those of the complexity: a vertex on the boundary has half a cell.
const VERTICES_PER_AREA: f64 = 0.5;

/// A vertex that is made takes as long as so many mean ratios.
const RATIOS_A_VERTEX: f64 = 3_000.0;

/// A vertex that is given takes as long as this share of one that is made.
const SHARE_OF_GIVEN: f64 = 0.13;

/// Share of a thread that each further thread is worth.
const WORTH_OF_THREAD: f64 = 0.9;

/// Memory for a vertex of the adapted mesh at the greatest, bytes.
const BYTES_A_VERTEX: f64 = 1_200.0;

/// Share of the memory that can be had which a mesh may take.
const SHARE_OF_MEMORY: f64 = 0.9;

/// Batches of mean ratios that tell the speed of this machine. They take a millisecond.
const BATCHES: usize = 5_000;

/// As many vertices as there is memory for, as far as the system tells.
pub fn most_in_memory() -> Option<usize> {
    memory::available().map(|bytes| (SHARE_OF_MEMORY * bytes as f64 / BYTES_A_VERTEX) as usize)
}

/// What a run will take.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Forecast {
    /// Vertices of the adapted mesh.
    pub vertices: f64,
    /// Wall time of the adaptation, s.
    pub seconds: f64,
    /// Memory, bytes.
    pub bytes: f64,
}

impl Forecast {
    /// Of a mesh of `input` vertices that becomes one of `vertices`, on so many threads of this machine.
    pub fn of(vertices: f64, input: usize, threads: usize) -> Self {
        Self::at_speed(vertices, input, threads, seconds_a_ratio())
    }

    /// The same on a machine whose mean ratios take so long, s.
    fn at_speed(vertices: f64, input: usize, threads: usize, seconds_a_ratio: f64) -> Self {
        let work = vertices + SHARE_OF_GIVEN * input as f64;
        let threads = 1.0 + WORTH_OF_THREAD * (threads as f64 - 1.0);
        let seconds = work * RATIOS_A_VERTEX * seconds_a_ratio / threads;
        Self { vertices, seconds, bytes: BYTES_A_VERTEX * vertices.max(input as f64) }
    }
}

/// Vertices of a mesh of this complexity, whose boundary and interfaces have this area in the metric.
pub fn vertices(complexity: f64, area: f64) -> f64 {
    VERTICES_PER_COMPLEXITY * complexity + VERTICES_PER_AREA * area
}

/// Seconds that are left where `elapsed` went for a share of the work, and `expected` were forecast for all of it: the forecast counts as much
/// as a tenth of the work.
pub fn seconds_left(elapsed: f64, share: f64, expected: f64) -> f64 {
    const WEIGHT: f64 = 0.1;
    ((elapsed + WEIGHT * expected) / (share + WEIGHT) - elapsed).max(0.0)
}

/// How long a mean ratio takes on this machine, s.
fn seconds_a_ratio() -> f64 {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let log = Sym3::diagonal(0.1, 0.2, 0.3);
    let mut batch = Batch::default();
    (0..crate::metric::lanes::LANES).for_each(|lane| batch.set(lane, corners, [&log; 3]));
    let mut ratios = |count: usize| {
        let began = Instant::now();
        for k in 0..count {
            batch.prepare();
            let apex = [0.0, 0.0, 1.0 + 1e-3 * (k % 8) as f64];
            black_box(black_box(&batch).shapes(black_box(apex), &log));
        }
        began.elapsed().as_secs_f64() / (count * crate::metric::lanes::LANES) as f64
    };
    ratios(BATCHES / 5);
    ratios(BATCHES)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_forecast_gives_way_to_what_is_seen() {
        assert_eq!(seconds_left(0.0, 0.0, 10.0), 10.0);
        // Half is done, in much less time than was expected.
        assert!((seconds_left(1.0, 0.5, 10.0) - 2.333).abs() < 1e-3);
        assert_eq!(seconds_left(5.0, 1.0, 1.0), 0.0);
    }

    #[test]
    fn more_vertices_take_longer_and_more_threads_less() {
        let of = |vertices, threads| Forecast::at_speed(vertices, 100, threads, 1e-8);
        let [few, many, shared] = [of(1e3, 1), of(1e6, 1), of(1e6, 8)];
        assert!(seconds_a_ratio() > 0.0 && many.seconds > 100.0 * few.seconds && shared.seconds < 0.5 * many.seconds);
        assert!(many.bytes > 100.0 * few.bytes && many.bytes == shared.bytes);
    }
}
