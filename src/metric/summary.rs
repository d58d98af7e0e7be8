//! What a metric asks for: its sizes, their ratios and anisotropic quotients, as percentiles over the vertices.
use super::{Sym3, field};
use crate::mesh::TetMesh;
use crate::tasks::{GRAIN, Team};
use serde::Serialize;

/// Percentiles of values, with the least and the greatest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Percentiles {
    /// The least; 0 without values.
    pub least: f64,
    /// 1 %.
    pub p1: f64,
    /// 10 %.
    pub p10: f64,
    /// 50 %.
    pub median: f64,
    /// 90 %.
    pub p90: f64,
    /// 99 %.
    pub p99: f64,
    /// The greatest; 0 without values.
    pub greatest: f64,
}

impl Percentiles {
    /// Of values in whichever order (nearest rank).
    pub fn of(mut values: Vec<f64>) -> Self {
        let Some(last) = values.len().checked_sub(1) else { return Self::default() };
        let [p1, p10, p50, p90, p99] = [0.01, 0.1, 0.5, 0.9, 0.99].map(|share| (share * last as f64).round() as usize);
        // Each is selected among the values below, or above, the last one. That is much less work than to sort all.
        let select = |values: &mut [f64], place: usize| *values.select_nth_unstable_by(place, f64::total_cmp).1;
        Self {
            median: select(&mut values, p50),
            p10: select(&mut values[..=p50], p10),
            p1: select(&mut values[..=p10], p1),
            least: select(&mut values[..=p1], 0),
            p90: select(&mut values[p50..], p90 - p50),
            p99: select(&mut values[p90..], p99 - p90),
            greatest: select(&mut values[p99..], last - p99),
        }
    }
}

/// ln h of ln M, ascending.
pub(super) fn log_sizes(log: &Sym3) -> [f64; 3] {
    let [a, b, c] = log.eigen().values;
    [-0.5 * c, -0.5 * b, -0.5 * a]
}

/// What percentiles are taken of, by [`log_sizes`], as logarithms: least and greatest size, aspect ratio, anisotropic quotient.
pub(super) const LOGARITHMS: [fn(&[f64; 3]) -> f64; 4] =
    [|h| h[0], |h| h[2], |h| h[2] - h[0], |h| 2.0 * h[2] - h[0] - h[1]];

/// The figures of a metric at the vertices of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Vertices of the mesh.
    pub vertices: usize,
    /// C = Σ_v √det(M_v)·V_v: a unit mesh has about 2C vertices and 12C tetrahedra.
    pub complexity: f64,
    /// ∫ √det M of the log-Euclidean interpolant: below `complexity` where the mesh does not resolve its metric.
    pub complexity_between: f64,
    /// Least size at a vertex, length.
    pub least_size: Percentiles,
    /// Greatest size at a vertex, length.
    pub greatest_size: Percentiles,
    /// Greatest over least size at a vertex.
    pub aspect_ratio: Percentiles,
    /// Anisotropic quotient h_max³/(h1 h2 h3) at a vertex (Loseille & Alauzet 2011): 1 where sizes are equal, the aspect ratio
    /// where two are great, its square where one is.
    pub anisotropic_quotient: Percentiles,
}

impl Summary {
    /// Of ln M at the vertices, shape (n,).
    pub fn of(team: Team<'_>, mesh: &TetMesh, logs: &[Sym3]) -> Self {
        let sizes = team.map(GRAIN, logs.len(), |v| log_sizes(&logs[v]));
        let of_each = team.chunks(1, LOGARITHMS.len(), |range| {
            Percentiles::of(sizes.iter().map(|h| LOGARITHMS[range.start](h).exp()).collect())
        });
        let complexities = [field::complexity_of_logs(team, mesh, logs), field::complexity_between(team, mesh, logs)];
        Self::of_parts(mesh.vertices.len(), complexities, [0, 1, 2, 3].map(|which| of_each[which]))
    }

    /// Of the number of vertices, the complexities (at the vertices, between them), and the percentiles in the order of [`LOGARITHMS`].
    pub(super) fn of_parts(vertices: usize, complexities: [f64; 2], percentiles: [Percentiles; 4]) -> Self {
        let [complexity, complexity_between] = complexities;
        let [least_size, greatest_size, aspect_ratio, anisotropic_quotient] = percentiles;
        Self { vertices, complexity, complexity_between, least_size, greatest_size, aspect_ratio, anisotropic_quotient }
    }
}
