//! From the values of a field to |H|, and which fields cannot be adapted to.
use super::Error;
use crate::mesh::TetMesh;
use crate::mesh::vector::sub;
use crate::metric::Sym3;
use crate::metric::recovery::{Recovery, Rings};
use crate::tasks::{GRAIN, Team};

/// Second differences below this share of the greatest value are rounding, which a one-sided fit multiplies.
const ROUNDING: f64 = 1e-12;

/// What is found of a sensor.
pub struct Absolute {
    /// |H| at the vertices; the mean over the steps.
    pub hessians: Vec<Sym3>,
    /// Eigenvalues below this are rounding: a second difference across the domain by 1e-12 of the field's range.
    pub floor: f64,
    /// Vertices that took the Hessian of their neighbours, the most in a step.
    pub unfitted: usize,
}

/// |H| of a sensor with these steps, each with a value a vertex. `number` is for errors; `diameter` the domain's.
pub fn absolute(
    team: Team<'_>,
    mesh: &TetMesh,
    rings: &Rings,
    recovery: Recovery,
    (number, steps): (usize, &[&[f64]]),
    diameter: f64,
) -> Result<Absolute, Error> {
    let mut mean: Vec<Sym3> = Vec::new();
    let (mut unfitted, mut greatest, mut range) = (0, 0.0f64, 0.0f64);
    for (step, values) in steps.iter().enumerate() {
        let (low, high) = bounds(team, values).map_err(|vertex| Error::NotFinite { sensor: number, step, vertex })?;
        greatest = greatest.max(low.abs()).max(high.abs());
        range = range.max(high - low);
        let (mut hessians, count) = recovery.hessians(team, mesh, rings, values);
        unfitted = unfitted.max(count);
        team.fill(GRAIN, &mut hessians, |_, hessians| hessians.iter_mut().for_each(|h| *h = h.magnitude()));
        if mean.is_empty() {
            mean = hessians;
        } else {
            team.fill(GRAIN, &mut mean, |start, sums| {
                sums.iter_mut().zip(&hessians[start..]).for_each(|(sum, h)| *sum = sum.plus(*h));
            });
        }
    }
    let share = 1.0 / steps.len().max(1) as f64;
    team.fill(GRAIN, &mut mean, |_, sums| sums.iter_mut().for_each(|sum| *sum = sum.times(share)));
    if !is_curved(team, mesh, rings, &mean, ROUNDING * greatest) {
        return Err(Error::Flat { sensor: number });
    }
    Ok(Absolute { hessians: mean, floor: 1e-12 * range / (diameter * diameter), unfitted })
}

/// Least and greatest value, or the first vertex where it is none.
fn bounds(team: Team<'_>, values: &[f64]) -> Result<(f64, f64), usize> {
    let parts = team.chunks(GRAIN, values.len(), |range| {
        let mut bounds = (f64::INFINITY, f64::NEG_INFINITY);
        for vertex in range {
            let value = values[vertex];
            if !value.is_finite() {
                return Err(vertex);
            }
            bounds = (bounds.0.min(value), bounds.1.max(value));
        }
        Ok(bounds)
    });
    parts
        .into_iter()
        .try_fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), part| part.map(|(l, h)| (low.min(l), high.max(h))))
}

/// Whether eᵀ|H|e, the second difference along an edge e, is above rounding anywhere. A Hessian has the rounding divided by the square of
/// the edges' lengths; measured along edges, these lengths do not matter.
fn is_curved(team: Team<'_>, mesh: &TetMesh, rings: &Rings, hessians: &[Sym3], rounding: f64) -> bool {
    let curved = team.chunks(GRAIN, hessians.len(), |mut range| {
        range.any(|v| {
            let edge = |&other: &u32| sub(mesh.vertices[other as usize], mesh.vertices[v]);
            rings.neighbours(v as u32).iter().any(|other| hessians[v].quadratic(edge(other)) > rounding)
        })
    });
    curved.contains(&true)
}
