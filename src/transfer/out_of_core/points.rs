//! New vertices, cell by cell, with the part of the old mesh that is about each cell.
use super::cells::{grown, longest, split};
use super::far::Far;
use super::part::{self, Part, Read, Tet};
use super::stored::{NOTHING, Stored, bounds_of, joined};
use super::{AT_ONCE, Error, Field, Found, SLICE, Sizes, cells_of};
use crate::mesh::locate::{Location, Searcher, Size};
use crate::mesh::ranges::{Bins, Scratch, Table};
use crate::mesh::vector::Vec3;
use crate::tasks::{GRAIN, Team, stage};
use crate::transfer::Places;
use crate::transfer::places::tolerance;
use std::sync::{Mutex, PoisonError};

/// A new vertex.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Point {
    x: Vec3,
    number: u64,
}

/// Gives the new vertices of each cell their values. Returns how far outside they are, and those whose nearest tetrahedra may be elsewhere.
pub(super) fn settle<F: Field>(
    team: Team<'_>,
    [old, new]: [&Stored<'_>; 2],
    (field, from, to): (&F, &Table, &Table),
    (sizes, scratch): (&Sizes, &Scratch),
) -> Result<(Found, Bins<Far>), Error> {
    let (points, boxes) = deal(team, old, new, (sizes, field.width()), scratch)?;
    let tets = part::deal(team, old, &boxes, sizes.slice, scratch)?;
    stage("dealt");
    let far = Mutex::new(Bins::new(scratch, 1)?);
    let work = Work { old, size: old.size(), tets: &tets, field, from, to, sizes, far };
    let parts = team.chunks(1, points.bins(), |cell| work.of_points(points.items(cell.start)?, cell.start));
    let mut found = Found::default();
    for part in parts {
        found = found.and(part?);
    }
    Ok((found, work.far.into_inner().unwrap_or_else(PoisonError::into_inner)))
}

/// The new vertices in the cells that they are in, and the boxes that the old tetrahedra of each cell touch.
fn deal(
    team: Team<'_>,
    old: &Stored<'_>,
    new: &Stored<'_>,
    (sizes, width): (&Sizes, usize),
    scratch: &Scratch,
) -> Result<(Bins<Point>, Vec<[Vec3; 2]>), Error> {
    let cells = cells_of(old, new, |tets, points| sizes.of_part(tets, points, width) <= sizes.task);
    let (mut bins, mut boxes) = (Bins::new(scratch, cells.count())?, vec![NOTHING; cells.count()]);
    let (vertices, together) = (new.counts().vertices, SLICE * AT_ONCE);
    for start in (0..vertices).step_by(together) {
        let points = new.points.read(start..vertices.min(start + together))?;
        let found = team.map(GRAIN, points.len(), |i| cells.cell(points[i]) as u32);
        for ((&x, cell), number) in points.iter().zip(found).zip(start as u64..) {
            bins.put(cell as usize, Point { x, number })?;
            boxes[cell as usize] = joined(boxes[cell as usize], [x; 2]);
        }
    }
    // Twice the distance at which a point may be on a face.
    let least = 2.0 * old.size().touch();
    Ok((bins, boxes.into_iter().map(|bounds| grown(bounds, least)).collect()))
}

/// What all cells need.
struct Work<'w, F> {
    old: &'w Stored<'w>,
    size: Size,
    tets: &'w Bins<Tet>,
    field: &'w F,
    from: &'w Table,
    to: &'w Table,
    sizes: &'w Sizes,
    /// Vertices that are too far from the part of the old mesh about their cell.
    far: Mutex<Bins<Far>>,
}

impl<F: Field> Work<'_, F> {
    /// Gives some vertices of a cell their values. Where they are too many for a task, they are halved.
    fn of_points(&self, mut points: Vec<Point>, cell: usize) -> Result<Found, Error> {
        if points.is_empty() {
            return Ok(Found::default());
        }
        let own = bounds_of(points.iter().map(|point| point.x));
        let within = grown(own, 2.0 * self.size.touch());
        let width = self.field.width();
        let fits = |tets| points.len() == 1 || self.sizes.of_part(tets, points.len(), width) <= self.sizes.task;
        let part = match Part::read(self.old, (self.tets, cell), &within, fits)? {
            Read::Part(part) => part,
            Read::Nothing => {
                let mut far = self.far.lock().unwrap_or_else(PoisonError::into_inner);
                points.iter().try_for_each(|point| far.put(0, Far::new(point.x, point.number as u32, None)))?;
                return Ok(Found::default());
            }
            Read::TooMany => {
                let above = split(&mut points, longest(&own).1, |point| point.x);
                return Ok(self.of_points(points, cell)?.and(self.of_points(above, cell)?));
            }
        };
        points.sort_unstable_by_key(|point| point.number);
        let places = self.locate(&mut points, &part, &within)?;
        let found = Found { outside: places.outside, farthest: places.farthest };
        let rows = self.from.at(&part.vertices)?;
        let rows = self.field.interpolate(part.locator.tets(), &places, &rows);
        self.to.put(&points.iter().map(|point| point.number as u32).collect::<Vec<_>>(), &rows)?;
        Ok(found)
    }

    /// The places of the points in a part that has all tetrahedra in a box. Takes away those that are nearer to the end of the part than to any of
    /// its tetrahedra.
    fn locate(&self, points: &mut Vec<Point>, part: &Part, within: &[Vec3; 2]) -> Result<Places, Error> {
        let (mut searcher, touch) = (Searcher::new(&part.locator, &self.size), self.size.touch());
        let (mut places, mut far, mut distances) = (Places::default(), Vec::new(), Vec::new());
        points.retain(|&Point { x, number }| {
            let found = searcher.locate(x);
            let reach = (0..3).map(|k| (x[k] - within[0][k]).min(within[1][k] - x[k])).fold(f64::INFINITY, f64::min);
            if found.distance > 0.0 && found.distance + 1e-9 * found.distance + touch > reach {
                let nodes = part.locator.tets()[found.tet as usize].map(|v| part.vertices[v as usize]);
                let nearest = Location { tet: part.tets[found.tet as usize], ..found };
                far.push(Far::new(x, number as u32, Some((nearest, nodes))));
                return false;
            }
            places.tets.push(found.tet);
            places.weights.push(found.weights);
            distances.push(found.distance);
            true
        });
        if !far.is_empty() {
            let mut all = self.far.lock().unwrap_or_else(PoisonError::into_inner);
            far.into_iter().try_for_each(|far| all.put(0, far))?;
        }
        let found = Found::of(distances.into_iter(), tolerance(&self.size));
        (places.outside, places.farthest) = (found.outside, found.farthest);
        Ok(places)
    }
}
