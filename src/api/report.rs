//! The figures to judge an adapted mesh by.
use super::AdaptedMesh;
use crate::geometry::Model;
use crate::geometry::fidelity::{self, Fidelity};
use crate::metric::{Statistics, Sym3};
use crate::tasks::Team;
use serde::Serialize;

/// What an adapted mesh is like, in the metric and on the model: the figures of `geo-adapt adapt --report`.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Counts, volume, edge lengths and mean ratios in the metric.
    pub statistics: Statistics,
    /// How far vertices and triangles are from the model.
    pub fidelity: Fidelity,
}

impl Report {
    pub(super) fn of(team: Team<'_>, adapted: &AdaptedMesh, model: &Model) -> Self {
        let metrics: Vec<Sym3> = adapted.metric.iter().map(|&terms| Sym3(terms)).collect();
        Self {
            statistics: Statistics::in_metric(team, &adapted.mesh, &metrics),
            fidelity: fidelity::measure_adapted(team, &adapted.mesh, model, &adapted.place, &adapted.held),
        }
    }
}
