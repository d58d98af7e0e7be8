//! Coordinates and metrics of some vertices.
use super::Error;
use crate::mesh::io::slices::{MeshReader, SolutionReader};
use crate::mesh::ranges::gathered;
use crate::mesh::vector::{Vec3, distance, sub};
use crate::metric::quality::edge_length;
use crate::metric::statistics::Part;
use crate::metric::{Analytic, Field, Figures, Lengths, Sym3};
use crate::tasks::{GRAIN, Team};

/// What a mesh is measured in.
#[derive(Clone, Copy)]
pub enum Metrics<'m> {
    /// Space.
    None,
    /// The metric of a file, with as many vertices as the mesh.
    File(&'m SolutionReader),
    /// An analytic metric.
    Analytic(Analytic),
}

/// Where coordinates and metrics come from.
pub(super) struct Source<'s> {
    pub mesh: &'s MeshReader,
    pub metrics: Metrics<'s>,
}

impl Source<'_> {
    /// The coordinates, shape (n, 3), of vertices in ascending order, shape (n,).
    pub fn points(&self, team: Team<'_>, nodes: &[u32]) -> Result<Vec<Vec3>, Error> {
        gathered(team, nodes, [0.0; 3], |range| -> Result<_, Error> { Ok(self.mesh.vertices(Team::alone(), range)?.0) })
    }

    /// The metrics at them, if there is one.
    pub fn metrics(&self, team: Team<'_>, nodes: &[u32], points: &[Vec3]) -> Result<Option<Vec<Sym3>>, Error> {
        Ok(match self.metrics {
            Metrics::None => None,
            Metrics::Analytic(field) => Some(team.map(GRAIN, points.len(), |v| field.at(points[v]))),
            Metrics::File(file) => {
                let read = |range| -> Result<_, Error> { Ok(Field::metrics_in(Team::alone(), file, range)?) };
                Some(gathered(team, nodes, Sym3::ZERO, read)?)
            }
        })
    }

    /// The figures of a part, without the lengths of its edges. The metrics are none without a metric, or without vertices.
    pub fn figures(&self, part: Part<'_>, metrics: Option<&[Sym3]>) -> Figures {
        match self.metrics {
            Metrics::None => Figures::without_edges_in_space(Team::alone(), part),
            _ => Figures::without_edges_in_metric(Team::alone(), part, metrics.unwrap_or_default()),
        }
    }

    /// Lengths of no edge.
    pub fn lengths(&self) -> Lengths {
        match self.metrics {
            Metrics::None => Lengths::in_space(),
            _ => Lengths::in_metric(),
        }
    }
}

/// The length of an edge, in the metrics if there are some.
pub(super) fn length([a, b]: [u32; 2], points: &[Vec3], metrics: Option<&[Sym3]>) -> f64 {
    let (a, b) = (a as usize, b as usize);
    match metrics {
        Some(metrics) => edge_length(sub(points[b], points[a]), &metrics[a], &metrics[b]),
        None => distance(points[a], points[b]),
    }
}
