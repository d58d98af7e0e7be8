//! The gradation of a metric as it is: the ratio r that each edge would need.
use super::super::Sym3;
use super::super::frame::Frame;
use super::super::summary::Percentiles;
use super::TOLERANCE;
use crate::mesh::TetMesh;
use crate::mesh::adjacency::Edges;
use crate::mesh::vector::sub;
use crate::tasks::{GRAIN, Team};

/// The percentiles are taken from about so many edges.
const SAMPLES: usize = 1 << 18;

/// Greatest ln r that is measured.
const FASTEST: f64 = 700.0;

/// Ratios r of growth, 1 where nothing grows.
pub type Growths = Percentiles;

/// For each edge the least ratio r at which [`super::grade`] leaves it as it is. Percentiles over the edges (a sample, if there are many),
/// and the greatest of all edges; ln r is right to 1e-4 of itself.
pub fn measure(team: Team<'_>, mesh: &TetMesh, logs: &[Sym3]) -> Growths {
    let frames = team.map(GRAIN, logs.len(), |v| Frame::of_log(&logs[v]));
    let edges = Edges::of(team, &mesh.tets.nodes);
    let edges: Vec<[u32; 2]> =
        team.collect(GRAIN, edges.nodes(), |range, found| edges.for_each(range, |edge| found.push(edge)));
    let is_graded = |[p, q]: [u32; 2], growth: f64| {
        let e = sub(mesh.vertices[q as usize], mesh.vertices[p as usize]);
        let [of_p, of_q] = [p, q].map(|v| &frames[v as usize]);
        let within = |from: &Frame, to: &Frame| to.relative(from, from.grown(e, growth)).is_below(1.0 + TOLERANCE);
        within(of_p, of_q) && within(of_q, of_p)
    };
    let step = edges.len().div_ceil(SAMPLES).max(1);
    let sample = team.map(GRAIN / 16, edges.len().div_ceil(step), |i| {
        needed(0.0, |growth| is_graded(edges[i * step], growth)).exp()
    });
    let greatest = team.chunks(GRAIN, edges.len(), |range| {
        edges[range].iter().fold(0.0, |least, &edge| needed(least, |growth| is_graded(edge, growth)))
    });
    let mut growths = Percentiles::of(sample);
    growths.greatest = greatest.into_iter().fold(growths.greatest, |a, growth| a.max(growth.exp()));
    growths
}

/// The least growth ln r, not below `least`, at which an edge is graded, to 1e-4 of it.
fn needed(least: f64, is_graded: impl Fn(f64) -> bool) -> f64 {
    if is_graded(least) {
        return least;
    }
    let (mut low, mut high) = (least, (2.0 * least).max(1e-3));
    while high < FASTEST && !is_graded(high) {
        (low, high) = (high, 2.0 * high);
    }
    if high >= FASTEST {
        return FASTEST;
    }
    while high - low > 1e-4 * high {
        let middle = 0.5 * (low + high);
        if is_graded(middle) { high = middle } else { low = middle }
    }
    high
}
