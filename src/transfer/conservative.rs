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
use super::balance::{InMemory, balance};
use super::error::{Error, Which};
use super::mass::{Component, check, measure, sums, volume};
use super::pieces::{INSIDE, NOTHING, OUTSIDE, OnTet, Pieces};
use super::{Places, interpolate};
use crate::mesh::TetMesh;
use crate::mesh::locate::{Locator, Size};
use crate::tasks::{GRAIN, Team};
use std::ops::Range;

/// What is kept where the volumes of the two meshes differ. Where they are equal, both choices are the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Keep {
    /// The integral divided by the volume of the mesh.
    #[default]
    Mean,
    /// The integral, as far as the bounds of the field let it: a constant stays as it is.
    Mass,
}

impl Keep {
    /// The integral on the new mesh, of that on the old one and the volumes of the old and the new one.
    pub(super) fn target(self, mass: f64, [old, new]: [f64; 2]) -> f64 {
        match self {
            Self::Mean => mass / old * new,
            Self::Mass => mass,
        }
    }
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
    let size = Size::of_vertices(locator.vertices());
    let parts = team.chunks(GRAIN, new.tets.len(), |range| {
        Part::of(Pieces::new(locator, &size, width, values), new, &nearest, width, range)
    });
    let Gathered { values: mut found, bounds, weights } = gather(team, &parts, width, &nearest);
    let new_volume = sums(team, new.tets.len(), 1, |tet, row| row[0] = volume(new, tet))[0];
    let mut corrected = Vec::with_capacity(width);
    for (component, of_old) in before.iter().enumerate() {
        let mut values = InMemory { team, width, component, values: &mut found, bounds: &bounds, weights: &weights };
        let target = keep.target(of_old.mass, [old_volume, new_volume]);
        let Ok(change) = balance(&mut values, [of_old.least, of_old.greatest], target);
        corrected.push(change);
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

impl Part {
    fn of(mut pieces: Pieces<'_>, new: &TetMesh, nearest: &[f64], width: usize, range: Range<usize>) -> Self {
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
        let mut found = vec![OnTet::default(); width];
        for tet in range {
            let volume = volume(new, tet);
            if volume > 0.0 {
                let nodes = new.tets.nodes[tet];
                let nearest = nodes.map(|v| &nearest[v as usize * width..][..width]);
                let covered = pieces.of(&nodes.map(|v| new.vertices[v as usize]), nearest, &mut found);
                part.add(nodes, (volume, covered), &found);
            }
        }
        part
    }

    /// What one new tetrahedron gives its vertices.
    fn add(&mut self, nodes: [u32; 4], (volume, covered): (f64, f64), found: &[OnTet]) {
        self.outside += usize::from(covered < OUTSIDE);
        self.partly += usize::from((OUTSIDE..INSIDE).contains(&covered));
        self.common += covered * volume;
        let slots = nodes.map(|v| self.vertices.partition_point(|&known| known < v));
        slots.iter().for_each(|&slot| self.weights[slot] += 0.25 * volume);
        for (c, component) in found.iter().enumerate() {
            for (slot, value) in slots.into_iter().zip(component.values) {
                let at = slot * found.len() + c;
                self.sums[at] += 0.25 * volume * value;
                self.bounds[at] = hull(self.bounds[at], component.bounds);
            }
        }
    }
}

/// The bounds that hold both.
#[inline]
pub fn hull(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// The value at a vertex, and its bounds, of the sum of those on its tetrahedra, each times a quarter of the volume, and the sum of these quarters.
pub fn mean(sum: f64, weight: f64, bounds: [f64; 2], nearest: f64) -> (f64, [f64; 2]) {
    match weight > 0.0 {
        true => ((sum / weight).max(bounds[0]).min(bounds[1]), bounds),
        false => (nearest, [nearest; 2]),
    }
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
            (*value, bounds[at]) = mean(*value, weights[at / width], bounds[at], nearest[range.start * width + at]);
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
