//! The conservative transfer by slices, to the bit that of [`crate::transfer::conservative()`].
//!
//! When the new vertices have the values of the nearest points, the new tetrahedra are dealt out to cells by their centroids, and the old ones to all
//! cells that their boxes touch. What each new tetrahedron gets goes to a table by its number. Then ranges of the new vertices, with all
//! tetrahedra at them in their order, add it up, in the same parts as in memory.
use super::cells::{grown, longest, split};
use super::gathered::gather;
use super::part::{self, Part, Read, Tet};
use super::stored::{NOTHING, Stored, bounds_of, joined};
use super::{AT_ONCE, Cells, Error, Field, SLICE, Sizes, Transferred, cells_of, interpolate_to, measure};
use crate::mesh::box_tree::Bounds;
use crate::mesh::io::slices::MeshReader;
use crate::mesh::locate::Size;
use crate::mesh::ranges::{Bins, Scratch, Table};
use crate::mesh::vector::{Vec3, add, scale};
use crate::tasks::{GRAIN, Team, stage};
use crate::transfer::balance::balance;
use crate::transfer::mass::{is_inverted, volume_of};
use crate::transfer::pieces::{INSIDE, OUTSIDE, OnTet, Pieces};
use crate::transfer::{Error as Unfit, Keep, Which};
use std::ops::Range;

/// How far the meshes cover each other, and what was corrected: as [`crate::transfer::Conserved`] has it.
#[derive(Clone, Debug, Default)]
pub struct Overlap {
    /// Volume that both cover.
    pub common: f64,
    /// New tetrahedra of which a part lies outside the old mesh.
    pub partly: usize,
    /// New tetrahedra outside the old mesh.
    pub outside: usize,
    /// By how much the last correction changed the integral of each component.
    pub corrected: Vec<f64>,
}

/// Fields of the old mesh on the new one, each with its integral or mean kept.
///
/// # Errors
/// When a file cannot be read or is wrong, or the scratch folder not be written; [`Error::Mesh`] when a tetrahedron of either mesh is inverted, or
/// one of the meshes has no volume.
pub fn conservative<'m>(
    team: Team<'_>,
    [old, new]: [&'m MeshReader; 2],
    (field, keep): (&impl Field, Keep),
    (sizes, scratch): (&Sizes, &Scratch),
) -> Result<(Transferred<'m>, Overlap), Error> {
    let mut found = interpolate_to(team, [old, new], field, (sizes, scratch), |[old, new]| {
        check(team, old, Which::Old)?;
        check(team, new, Which::New)
    })?;
    let [old, new] = &found.meshes;
    let width = field.width();
    let on_tets = Table::new(scratch, OF_TET + VALUES * width)?;
    Work { team, old, new, from: &found.rows[0], nearest: &found.rows[1], to: &on_tets, sizes }.run(scratch)?;
    stage("pieces");
    let mut overlap = covered(team, new, &on_tets)?;
    let gathered = gather(team, new, (&on_tets, &found.rows[1]), (sizes, scratch))?;
    stage("gathered");
    let (old_volume, before) = measure::measure(team, old, &found.rows[0])?;
    let new_volume = measure::volume(team, new)?;
    for (component, of_old) in before.iter().enumerate() {
        let target = keep.target(of_old.mass, [old_volume, new_volume]);
        let mut values = gathered.component(team, new.counts().vertices, component);
        overlap.corrected.push(balance(&mut values, [of_old.least, of_old.greatest], target)?);
    }
    stage("balanced");
    found.rows[1] = gathered.values;
    Ok((found, overlap))
}

/// Numbers of a row of a new tetrahedron: its volume, the share that the old mesh covers, and those of each component.
pub(super) const OF_TET: usize = 2;

/// Numbers of a component on a tetrahedron.
pub(super) const VALUES: usize = size_of::<OnTet>() / size_of::<f64>();

/// Refuses a mesh as [`crate::transfer::mass::check`] does.
fn check(team: Team<'_>, mesh: &Stored<'_>, which: Which) -> Result<(), Error> {
    let parts = team.chunks(GRAIN, mesh.counts().tets, |range| -> Result<_, Error> {
        let slice = mesh.slice(mesh.tets(range.clone())?)?;
        let first = (0..range.len()).find(|&tet| is_inverted(slice.corners(tet)));
        let most = (0..range.len()).map(|tet| volume_of(slice.corners(tet))).fold(0.0, f64::max);
        Ok((first.map(|tet| range.start + tet), most))
    });
    let mut most = 0.0f64;
    for part in parts {
        let (inverted, greatest) = part?;
        if let Some(tet) = inverted {
            return Err(Unfit::Inverted { mesh: which, tet }.into());
        }
        most = most.max(greatest);
    }
    if most > 0.0 { Ok(()) } else { Err(Unfit::NoVolume(which).into()) }
}

/// The sums of what both meshes cover.
fn covered(team: Team<'_>, new: &Stored<'_>, on_tets: &Table) -> Result<Overlap, Error> {
    let parts = team.chunks(GRAIN, new.counts().tets, |range| -> Result<Overlap, Error> {
        let mut found = Overlap::default();
        for row in on_tets.read(range)?.chunks_exact(on_tets.width()) {
            let [volume, covered] = [row[0], row[1]];
            if volume > 0.0 {
                found.outside += usize::from(covered < OUTSIDE);
                found.partly += usize::from((OUTSIDE..INSIDE).contains(&covered));
                found.common += covered * volume;
            }
        }
        Ok(found)
    });
    let parts = parts.into_iter().collect::<Result<Vec<_>, _>>()?;
    Ok(Overlap {
        common: parts.iter().map(|part| part.common).sum(),
        partly: parts.iter().map(|part| part.partly).sum(),
        outside: parts.iter().map(|part| part.outside).sum(),
        corrected: Vec::new(),
    })
}

/// A new tetrahedron.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct NewTet {
    x: [Vec3; 4],
    number: u32,
    padding: u32,
    nodes: [u32; 4],
}

impl NewTet {
    fn centroid(&self) -> Vec3 {
        scale(add(add(self.x[0], self.x[1]), add(self.x[2], self.x[3])), 0.25)
    }
}

/// What all cells need.
struct Work<'w> {
    team: Team<'w>,
    old: &'w Stored<'w>,
    new: &'w Stored<'w>,
    /// Rows of the old vertices.
    from: &'w Table,
    /// Those of the nearest points, of the new vertices.
    nearest: &'w Table,
    /// Rows of the new tetrahedra.
    to: &'w Table,
    sizes: &'w Sizes,
}

impl Work<'_> {
    fn run(&self, scratch: &Scratch) -> Result<(), Error> {
        let width = self.from.width();
        let cells = cells_of(self.old, self.new, |old_tets, points| {
            let tets = points as f64 * self.new.counts().tets as f64 / self.new.counts().vertices as f64;
            self.bytes(old_tets, tets as usize, width) <= self.sizes.task
        });
        let (tets, boxes) = self.deal(&cells, scratch)?;
        let old_tets = part::deal(self.team, self.old, &boxes, self.sizes.slice, scratch)?;
        let size = self.old.size();
        let done = self
            .team
            .chunks(1, tets.bins(), |cell| self.of_tets(tets.items(cell.start)?, (&old_tets, cell.start), &size));
        done.into_iter().collect()
    }

    /// Bytes of a part of the old mesh and of some new tetrahedra.
    fn bytes(&self, old: usize, new: usize, width: usize) -> usize {
        self.sizes.of_part(old, 0, width) + (size_of::<NewTet>() + 8 * (OF_TET + (VALUES + 4) * width) + 32) * new
    }

    /// The new tetrahedra in the cells of their centroids, and the boxes that old ones must touch to matter to them.
    fn deal(&self, cells: &Cells, scratch: &Scratch) -> Result<(Bins<NewTet>, Vec<Bounds>), Error> {
        let (mut bins, mut boxes) = (Bins::new(scratch, cells.count())?, vec![NOTHING; cells.count()]);
        let (tets, together) = (self.new.counts().tets, SLICE * AT_ONCE);
        for start in (0..tets).step_by(together) {
            let parts = self.team.chunks(SLICE, together.min(tets - start), |range| {
                self.with_cells(cells, start + range.start..start + range.end)
            });
            for part in parts {
                for (cell, tet) in part? {
                    bins.put(cell, tet)?;
                    boxes[cell] = joined(boxes[cell], bounds_of(tet.x));
                }
            }
        }
        let least = 2.0 * self.old.size().touch();
        Ok((bins, boxes.into_iter().map(|bounds| grown(bounds, least)).collect()))
    }

    /// Some new tetrahedra with their cells.
    fn with_cells(&self, cells: &Cells, range: Range<usize>) -> Result<Vec<(usize, NewTet)>, Error> {
        let all = self.new.tets(range.clone())?;
        let slice = self.new.slice(all.clone())?;
        let tet = |(t, nodes): (usize, [u32; 4])| {
            let tet = NewTet { x: slice.corners(t), number: (range.start + t) as u32, padding: 0, nodes };
            (cells.cell(tet.centroid()), tet)
        };
        Ok(all.into_iter().enumerate().map(tet).collect())
    }

    /// What some new tetrahedra of a cell get. Where they are too many for a task, they are halved.
    fn of_tets(&self, mut tets: Vec<NewTet>, cell: (&Bins<Tet>, usize), size: &Size) -> Result<(), Error> {
        if tets.is_empty() {
            return Ok(());
        }
        let width = self.from.width();
        let within = grown(bounds_of(tets.iter().flat_map(|tet| tet.x)), 2.0 * size.touch());
        let fits = |old| tets.len() == 1 || self.bytes(old, tets.len(), width) <= self.sizes.task;
        let part = match Part::read(self.old, cell, &within, fits)? {
            Read::Part(part) => Some(part),
            Read::Nothing => None,
            Read::TooMany => {
                let (_, axis) = longest(&bounds_of(tets.iter().map(NewTet::centroid)));
                let above = split(&mut tets, axis, NewTet::centroid);
                self.of_tets(tets, cell, size)?;
                return self.of_tets(above, cell, size);
            }
        };
        tets.sort_unstable_by_key(|tet| tet.number);
        let mut numbers: Vec<u32> = tets.iter().flat_map(|tet| tet.nodes).collect();
        numbers.sort_unstable();
        numbers.dedup();
        let nearest = self.nearest.at(&numbers)?;
        let values = part.as_ref().map_or(Ok(Vec::new()), |part| self.from.at(&part.vertices))?;
        let mut pieces = part.as_ref().map(|part| Pieces::new(&part.locator, size, width, &values));
        let (mut rows, mut found) = (Vec::with_capacity(self.to.width() * tets.len()), vec![OnTet::default(); width]);
        for tet in &tets {
            let volume = volume_of(tet.x);
            found.fill(OnTet::default());
            let mut covered = 0.0;
            if volume > 0.0 {
                let place = |v: u32| numbers.partition_point(|&known| known < v);
                let nearest = tet.nodes.map(|v| &nearest[place(v) * width..][..width]);
                match &mut pieces {
                    Some(pieces) => covered = pieces.of(&tet.x, nearest, &mut found),
                    None => Pieces::outside(nearest, &mut found),
                }
            }
            rows.extend([volume, covered]);
            rows.extend_from_slice(bytemuck::cast_slice(&found));
        }
        Ok(self.to.put(&tets.iter().map(|tet| tet.number).collect::<Vec<u32>>(), &rows)?)
    }
}
