//! Transfer that keeps the mean, or the integral, of each component.
//!
//! On each new tetrahedron the old field's integral and mean gradient, over its pieces in old tetrahedra, give a linear function. It is
//! brought within the bounds of the old field on the old tetrahedra met, with its mean kept. At a vertex the functions of its tetrahedra
//! are averaged by volume. That keeps the integral, since the integral of a linear function is the mean of its corners times the volume.
//! So where both meshes fill the same space the integral is kept, but for rounding; a linear field stays as it is, and there is no new
//! extremum.
//!
//! **Where the meshes differ in volume** (a curved boundary, meshed twice) no transfer keeps both the integral and a constant. By default
//! [`Keep::Mean`] is kept, the integral divided by the volume of the mesh. Then the zero of the field does not matter, a constant stays one,
//! and back on the first mesh the first integral is there again. New tetrahedra that reach out of the old mesh continue the function of
//! their inner part, within its bounds; those wholly outside have the values of the nearest points. What is then missing to the mean is
//! added by [`balance`]: each value goes the same share of the way to the bound at its vertex.
use super::balance::{Of, balance};
use super::corners::Corners;
use super::error::{Error, Which};
use super::front::Front;
use super::mass::{Component, check, measure, sums, volume};
use super::{Places, interpolate};
use crate::mesh::TetMesh;
use crate::mesh::locate::Locator;
use crate::tasks::{GRAIN, Team};
use std::ops::Range;

/// A tetrahedron of which less than this share lies in the old mesh is outside.
const OUTSIDE: f64 = 1e-6;

/// A tetrahedron of which this share or more lies there is inside.
const INSIDE: f64 = 1.0 - 1e-9;

/// What is kept where the volumes of the two meshes differ. Where they are equal, both choices are the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Keep {
    /// The integral divided by the volume of the mesh.
    #[default]
    Mean,
    /// The integral, as far as the bounds of the field let it: a constant stays as it is.
    Mass,
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct Conserved {
    /// Values at the vertices of the new mesh, in rows as the old ones.
    pub values: Vec<f64>,
    /// Volumes of the old and the new mesh.
    pub volumes: [f64; 2],
    /// Volume that both cover.
    pub common: f64,
    /// New tetrahedra of which a part lies outside the old mesh.
    pub partly: usize,
    /// New tetrahedra outside the old mesh.
    pub outside: usize,
    /// Each component on the old mesh.
    pub before: Vec<Component>,
    /// Each component on the new mesh.
    pub after: Vec<Component>,
    /// By how much the last correction changed the integral of each component: by what the meshes do not have in common, and rounding.
    pub corrected: Vec<f64>,
}

/// Brings rows of `width` values at the vertices of the located mesh to a new mesh, whose vertices have these places in the old one.
///
/// # Errors
/// [`Error`] when a tetrahedron of either mesh is inverted, or one of the meshes has no volume.
///
/// # Panics
/// When the numbers of values or places do not fit the meshes.
pub fn conservative(
    team: Team<'_>,
    locator: &Locator,
    new: &TetMesh,
    places: &Places,
    width: usize,
    values: &[f64],
    keep: Keep,
) -> Result<Conserved, Error> {
    assert_eq!(places.len(), new.vertices.len(), "a place a vertex");
    check(team, locator.mesh(), Which::Old)?;
    check(team, new, Which::New)?;
    let (old_volume, before) = measure(team, locator.mesh(), width, values);
    let nearest = interpolate(team, locator, places, width, values);
    let parts = team.chunks(GRAIN, new.tets.len(), |range| Part::of(locator, new, &nearest, width, values, range));
    let Gathered { values: mut found, bounds, weights } = gather(team, &parts, width, &nearest);
    let new_volume = sums(team, new.tets.len(), 1, |tet, row| row[0] = volume(new, tet))[0];
    let mut corrected = Vec::with_capacity(width);
    for (component, of_old) in before.iter().enumerate() {
        let target = match keep {
            Keep::Mean => of_old.mass / old_volume * new_volume,
            Keep::Mass => of_old.mass,
        };
        let overall = [of_old.least, of_old.greatest];
        let of = Of { width, component };
        corrected.push(balance(team, of, &mut found, &bounds, overall, &weights, target));
    }
    let (_, after) = measure(team, new, width, &found);
    Ok(Conserved {
        values: found,
        volumes: [old_volume, new_volume],
        common: parts.iter().map(|part| part.common).sum(),
        partly: parts.iter().map(|part| part.partly).sum(),
        outside: parts.iter().map(|part| part.outside).sum(),
        before,
        after,
        corrected,
    })
}

/// What a chunk of the new tetrahedra gives their vertices.
struct Part {
    /// Ascending.
    vertices: Vec<u32>,
    /// A quarter of the volume of the chunk's tetrahedra at each.
    weights: Vec<f64>,
    /// Sum of volume/4 times value, a row a vertex.
    sums: Vec<f64>,
    /// Bounds, a row a vertex.
    bounds: Vec<[f64; 2]>,
    common: f64,
    partly: usize,
    outside: usize,
}

const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

impl Part {
    fn of(
        locator: &Locator,
        new: &TetMesh,
        nearest: &[f64],
        width: usize,
        values: &[f64],
        range: Range<usize>,
    ) -> Self {
        let mut vertices: Vec<u32> = new.tets.nodes[range.clone()].as_flattened().to_vec();
        vertices.sort_unstable();
        vertices.dedup();
        let mut part = Self {
            weights: vec![0.0; vertices.len()],
            sums: vec![0.0; width * vertices.len()],
            bounds: vec![NOTHING; width * vertices.len()],
            vertices,
            common: 0.0,
            partly: 0,
            outside: 0,
        };
        let (mut front, mut corners) = (Front::new(locator), Corners::new(width));
        for tet in range {
            part.add(tet, (&mut front, &mut corners), (locator, values), (new, nearest), width);
        }
        part
    }

    /// What one new tetrahedron gives its vertices.
    fn add(
        &mut self,
        tet: usize,
        (front, corners): (&mut Front, &mut Corners),
        (locator, values): (&Locator, &[f64]),
        (new, nearest): (&TetMesh, &[f64]),
        width: usize,
    ) {
        let volume = volume(new, tet);
        if volume == 0.0 {
            return;
        }
        let nodes = new.tets.nodes[tet];
        let x = nodes.map(|v| new.vertices[v as usize]);
        corners.clear(x[0]);
        let covered = front.over(&x, |old, planes, piece| {
            let rows = locator.tets()[old as usize].map(|v| &values[v as usize * width..][..width]);
            corners.add(locator.corners(old), rows, planes, piece);
        });
        let is_outside = covered < OUTSIDE;
        self.outside += usize::from(is_outside);
        self.partly += usize::from(!is_outside && covered < INSIDE);
        self.common += covered * volume;
        let slots = nodes.map(|v| self.vertices.partition_point(|&known| known < v));
        slots.iter().for_each(|&slot| self.weights[slot] += 0.25 * volume);
        for c in 0..width {
            let (found, bounds) = if is_outside {
                let found = nodes.map(|v| nearest[v as usize * width + c]);
                (found, found.into_iter().fold(NOTHING, |b, x| [b[0].min(x), b[1].max(x)]))
            } else {
                corners.values(c, &x)
            };
            for (slot, value) in slots.into_iter().zip(found) {
                let at = slot * width + c;
                self.sums[at] += 0.25 * volume * value;
                self.bounds[at] = hull(self.bounds[at], bounds);
            }
        }
    }
}

#[inline]
fn hull(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// What all chunks together give the vertices.
struct Gathered {
    values: Vec<f64>,
    bounds: Vec<[f64; 2]>,
    weights: Vec<f64>,
}

/// Joins the parts in their order. A vertex of no tetrahedron, or of flat ones alone, has the value of the nearest point.
fn gather(team: Team<'_>, parts: &[Part], width: usize, nearest: &[f64]) -> Gathered {
    let vertices = nearest.len().checked_div(width).unwrap_or(0);
    let rows = team.chunks(GRAIN, vertices, |range| {
        let mut weights = vec![0.0; range.len()];
        let mut bounds = vec![NOTHING; width * range.len()];
        let mut values = vec![0.0; width * range.len()];
        for part in parts {
            let [first, last] =
                [range.start, range.end].map(|end| part.vertices.partition_point(|&v| (v as usize) < end));
            for from in first..last {
                let to = part.vertices[from] as usize - range.start;
                weights[to] += part.weights[from];
                for c in 0..width {
                    values[to * width + c] += part.sums[from * width + c];
                    bounds[to * width + c] = hull(bounds[to * width + c], part.bounds[from * width + c]);
                }
            }
        }
        for (at, value) in values.iter_mut().enumerate() {
            let [low, high] = bounds[at];
            let weight = weights[at / width];
            if weight > 0.0 {
                *value = (*value / weight).max(low).min(high);
            } else {
                *value = nearest[range.start * width + at];
                bounds[at] = [*value; 2];
            }
        }
        (values, bounds, weights)
    });
    Gathered {
        values: team.join_slices(rows.iter().map(|row| row.0.as_slice())),
        bounds: team.join_slices(rows.iter().map(|row| row.1.as_slice())),
        weights: team.join_slices(rows.iter().map(|row| row.2.as_slice())),
    }
}

#[cfg(test)]
mod tests;
