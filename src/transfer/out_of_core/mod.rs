//! Transfer between meshes larger than memory, to the bit that of [`super::interpolate()`].
//!
//! Space is divided into cells such that each has few points of both meshes ([`cells`]). The new vertices are dealt out to the cells that they are
//! in, the old tetrahedra to all whose boxes, somewhat larger, they touch ([`part`]). So each cell has what holds its vertices, by itself. A vertex
//! outside of the old mesh has its nearest tetrahedron there too, where that is nearer than the part of the mesh reaches; for what is farther, all
//! tetrahedra are gone through once more ([`far`]).
//!
//! What a vertex gets depends on the meshes alone ([`crate::mesh::locate::Searcher`]), so the cells do not matter.
mod cells;
mod conservative;
mod error;
mod far;
mod gathered;
mod measure;
mod part;
mod points;
mod sizes;
mod stored;
#[cfg(test)]
mod tests;

pub use conservative::{Overlap, conservative};
pub use error::Error;
pub use sizes::Sizes;

use super::mass::Component;
use super::places::tolerance;
use super::{Places, interpolate_in};
use crate::mesh::io::slices::{MeshReader, SolutionReader, SolutionWriter};
use crate::mesh::ranges::{Scratch, Table};
use crate::tasks::{GRAIN, Team, stage};
use cells::Cells;
use std::ops::Range;
use stored::Stored;

/// Vertices that are read and written at once.
const SLICE: usize = 2 * GRAIN;

/// Slices of new vertices or tetrahedra that are dealt out to cells at once.
const AT_ONCE: usize = 8;

/// Why a field cannot be read.
pub type Wrong = Box<dyn std::error::Error + Send + Sync>;

/// The fields at the vertices of the old mesh, in rows of all values of a vertex.
pub trait Field: Sync {
    /// Values of a row.
    fn width(&self) -> usize;

    /// The rows of some vertices, shape (n, width).
    ///
    /// # Errors
    /// When they cannot be read, or are wrong.
    fn rows(&self, range: Range<usize>) -> Result<Vec<f64>, Wrong>;

    /// What is interpolated instead of the rows, if that is something else, of the same shape.
    fn interpolated(&self, rows: &[f64]) -> Option<Vec<f64>>;

    /// The new rows at places in tetrahedra of these nodes, given those that are interpolated at all nodes.
    fn interpolate(&self, tets: &[[u32; 4]], places: &Places, rows: &[f64]) -> Vec<f64>;
}

/// All fields of a file, linear in each tetrahedron.
pub struct Linear<'f>(pub &'f SolutionReader);

impl Field for Linear<'_> {
    fn width(&self) -> usize {
        self.0.width()
    }

    fn rows(&self, range: Range<usize>) -> Result<Vec<f64>, Wrong> {
        Ok(self.0.rows(Team::alone(), range)?)
    }

    fn interpolated(&self, _: &[f64]) -> Option<Vec<f64>> {
        None
    }

    fn interpolate(&self, tets: &[[u32; 4]], places: &Places, rows: &[f64]) -> Vec<f64> {
        interpolate_in(Team::alone(), tets, places, self.width(), rows)
    }
}

/// What came of it, in a scratch folder.
pub struct Transferred<'m> {
    /// New vertices outside the old mesh.
    pub outside: usize,
    /// Greatest distance of a new vertex from the old mesh, length.
    pub farthest: f64,
    meshes: [Stored<'m>; 2],
    rows: [Table; 2],
}

/// How far outside vertices are.
#[derive(Clone, Copy, Debug, Default)]
struct Found {
    outside: usize,
    farthest: f64,
}

impl Found {
    fn of(distances: impl Iterator<Item = f64> + Clone, tolerance: f64) -> Self {
        let outside = distances.clone().filter(|&distance| distance > tolerance).count();
        Self { outside, farthest: distances.fold(0.0, f64::max) }
    }

    fn and(self, other: Self) -> Self {
        Self { outside: self.outside + other.outside, farthest: self.farthest.max(other.farthest) }
    }
}

/// Fields of the old mesh at the vertices of the new one, by interpolation.
///
/// # Errors
/// When a file cannot be read or is wrong, or the scratch folder not be written.
pub fn interpolate<'m>(
    team: Team<'_>,
    meshes: [&'m MeshReader; 2],
    field: &impl Field,
    by: (&Sizes, &Scratch),
) -> Result<Transferred<'m>, Error> {
    interpolate_to(team, meshes, field, by, |[_, new]| new.check_tets(team))
}

/// The same, if `check` likes the meshes.
fn interpolate_to<'m>(
    team: Team<'_>,
    [old, new]: [&'m MeshReader; 2],
    field: &impl Field,
    (sizes, scratch): (&Sizes, &Scratch),
    check: impl FnOnce([&Stored<'m>; 2]) -> Result<(), Error>,
) -> Result<Transferred<'m>, Error> {
    let old = Stored::read(team, old, scratch)?;
    let (raw, interpolated) = store(team, field, old.counts().vertices, scratch)?;
    let new = Stored::read(team, new, scratch)?;
    check([&old, &new])?;
    stage("vertices read");
    let rows = Table::new(scratch, field.width())?;
    let from = interpolated.as_ref().unwrap_or(&raw);
    let (found, far) = points::settle(team, [&old, &new], (field, from, &rows), (sizes, scratch))?;
    stage("interpolated");
    let found = found.and(far::settle(team, &old, &far, (field, from, &rows), (sizes, tolerance(&old.size())))?);
    stage("those far away");
    let Found { outside, farthest } = found;
    Ok(Transferred { outside, farthest, meshes: [old, new], rows: [raw, rows] })
}

/// The rows as they are, and what is interpolated if that is something else.
fn store(
    team: Team<'_>,
    field: &impl Field,
    vertices: usize,
    scratch: &Scratch,
) -> Result<(Table, Option<Table>), Error> {
    let (raw, other) = (Table::new(scratch, field.width())?, Table::new(scratch, field.width())?);
    let slices = team.chunks(SLICE, vertices, |range| -> Result<bool, Error> {
        let rows = field.rows(range.clone()).map_err(Error::Field)?;
        raw.write(range.start, &rows)?;
        let interpolated = field.interpolated(&rows);
        interpolated.as_ref().map_or(Ok(()), |rows| other.write(range.start, rows))?;
        Ok(interpolated.is_some())
    });
    let is_other = slices.into_iter().collect::<Result<Vec<bool>, _>>()?.contains(&true);
    Ok((raw, is_other.then_some(other)))
}

/// Cells whose numbers of old tetrahedra and new vertices fit.
fn cells_of(old: &Stored<'_>, new: &Stored<'_>, fits: impl Fn(usize, usize) -> bool) -> Cells {
    // Tetrahedra reach out of the box that their vertices are in.
    let tets = 1.25 * old.counts().tets as f64 / old.samples.0.len().max(1) as f64;
    Cells::of(&new.samples.0, &old.samples.0, |points, samples| {
        fits((tets * samples as f64) as usize, points * new.samples.1)
    })
}

impl Transferred<'_> {
    /// Writes the new rows.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn put(&self, team: Team<'_>, to: &SolutionWriter) -> Result<(), Error> {
        let rows = &self.rows[1];
        let slices = team.chunks(SLICE, self.meshes[1].counts().vertices, |range| -> Result<(), Error> {
            Ok(to.put(Team::alone(), range.start, (rows.width(), &rows.read(range)?))?)
        });
        slices.into_iter().collect()
    }

    /// Volume and components of the old and the new mesh.
    ///
    /// # Errors
    /// When a mesh or the scratch folder cannot be read.
    pub fn measure(&self, team: Team<'_>) -> Result<[(f64, Vec<Component>); 2], Error> {
        Ok([
            measure::measure(team, &self.meshes[0], &self.rows[0])?,
            measure::measure(team, &self.meshes[1], &self.rows[1])?,
        ])
    }
}
