//! A mesh and its metric in files, of which ranges are read.
use super::super::Error;
use super::{Input, Vertices};
use crate::mesh::Elements;
use crate::mesh::io::slices::{MeshReader, SolutionReader};
use crate::mesh::ranges::gathered;
use crate::metric::{Field, Source, Sym3};
use crate::tasks::Team;
use std::ops::Range;

/// Where the metric of a mesh in files comes from.
pub enum MetricOf {
    /// A file of as many vertices.
    File(SolutionReader),
    /// ln M, everywhere the same.
    Uniform(Sym3),
    /// An analytic field.
    Analytic(Source),
}

/// A mesh and its metric in files.
pub struct Files {
    pub(super) mesh: MeshReader,
    pub(super) metric: MetricOf,
    /// Logarithm of the factor of M.
    log_factor: f64,
}

impl Files {
    /// A mesh and where its metric comes from.
    pub fn new(mesh: MeshReader, metric: MetricOf) -> Self {
        Self { mesh, metric, log_factor: 0.0 }
    }

    /// Scales M by e^`log_factor`.
    pub fn scale(&mut self, log_factor: f64) {
        match &mut self.metric {
            MetricOf::Analytic(source) => source.scale(Team::alone(), log_factor),
            _ => self.log_factor += log_factor,
        }
    }

    /// The analytic field, if that is what the metric comes from.
    pub fn analytic(&self) -> Option<Source> {
        let MetricOf::Analytic(Source::Analytic { field, log_scale }) = self.metric else { return None };
        Some(Source::Analytic { field, log_scale })
    }

    /// The mesh's file.
    pub fn reader(&self) -> &MeshReader {
        &self.mesh
    }
}

impl Input for Files {
    fn size(&self) -> [usize; 2] {
        let counts = self.mesh.counts();
        [counts.vertices, counts.tets]
    }

    fn tets(&self, range: Range<usize>) -> Result<Elements<4>, Error> {
        Ok(self.mesh.tets(Team::alone(), range)?)
    }

    fn vertices(&self, numbers: &[u32]) -> Result<Vertices, Error> {
        let of_mesh = gathered(Team::alone(), numbers, ([0.0; 3], 0), |range| {
            let (points, refs) = self.mesh.vertices(Team::alone(), range)?;
            Ok::<_, Error>(points.into_iter().zip(refs).collect())
        });
        let (points, refs): (Vec<_>, Vec<_>) = of_mesh?.into_iter().unzip();
        let logs = match &self.metric {
            MetricOf::File(file) => {
                let logs =
                    gathered(Team::alone(), numbers, Sym3::ZERO, |range| Field::logs_in(Team::alone(), file, range));
                logs?.into_iter().map(|log: Sym3| log.held_log().plus_identity(self.log_factor)).collect()
            }
            MetricOf::Uniform(log) => vec![log.plus_identity(self.log_factor); numbers.len()],
            MetricOf::Analytic(source) => points.iter().map(|&p| source.log_at(p, &mut 0)).collect(),
        };
        Ok(Vertices { points, refs, logs })
    }
}
