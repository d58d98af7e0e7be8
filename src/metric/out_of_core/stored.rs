//! ln M at the vertices in a scratch folder, scaled, bounded and graded there.
use super::gradation::grade;
use super::mesh::Mesh;
use super::{Error, SLICE, each_slice};
use crate::mesh::ranges::{Column, Scratch};
use crate::metric::Sym3;
use crate::metric::multiscale::{Bounds, Cut, Measure, Medium};
use crate::tasks::Team;

/// A metric in a scratch folder. It knows no bounds but limits, and no complexity but that at the vertices.
pub(super) struct Stored<'m> {
    pub team: Team<'m>,
    pub mesh: &'m Mesh,
    pub raw: &'m Column<Sym3>,
    pub scratch: &'m Scratch,
}

impl Stored<'_> {
    /// Scales and bounds; returns at how many vertices the limits changed it.
    fn rescaled(
        &self,
        from: &Column<Sym3>,
        log_scale: f64,
        bounds: &Bounds<'_>,
        to: &Column<Sym3>,
    ) -> Result<usize, Error> {
        let limited = each_slice(self.team, SLICE, self.mesh.vertices, |range| {
            let mut slice = from.read(range.clone())?;
            slice.iter_mut().for_each(|log| *log = log.plus_identity(log_scale));
            let limited = bounds.limits.apply(Team::alone(), &mut slice);
            to.write(range.start, &slice)?;
            Ok(limited)
        })?;
        Ok(limited.into_iter().sum())
    }
}

impl Medium for Stored<'_> {
    type Logs = Column<Sym3>;
    type Error = Error;

    fn room(&self) -> Result<Column<Sym3>, Error> {
        Ok(self.scratch.column()?)
    }

    fn scaled(
        &self,
        from: Option<&Column<Sym3>>,
        log_scale: f64,
        bounds: &Bounds<'_>,
        to: &mut Column<Sym3>,
    ) -> Result<(usize, Option<Cut>), Error> {
        Ok((self.rescaled(from.unwrap_or(self.raw), log_scale, bounds, to)?, None))
    }

    fn rescale(&self, logs: &mut Column<Sym3>, log_scale: f64, bounds: &Bounds<'_>) -> Result<(), Error> {
        self.rescaled(logs, log_scale, bounds, logs).map(drop)
    }

    fn grade(&self, logs: &mut Column<Sym3>, ratio: f64) -> Result<(), Error> {
        grade(self.team, self.mesh, logs, ratio).map(drop)
    }

    fn complexity(&self, logs: &Column<Sym3>, _: Measure) -> Result<f64, Error> {
        self.mesh.complexity(self.team, logs)
    }
}
