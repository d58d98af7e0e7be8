//! From the values of a field to |H|, and which fields cannot be adapted to.
use super::Error;
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, sub};
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
    let (mut unfitted, mut span) = (0, Span::default());
    for (step, values) in steps.iter().enumerate() {
        let not_finite = |vertex| Error::NotFinite { sensor: number, step, vertex };
        let parts = team.chunks(GRAIN, values.len(), |range| Bounds::of(range.start, &values[range]));
        let bounds = parts.into_iter().try_fold(Bounds::NONE, |bounds, part| part.map(|part| bounds.and(part)));
        span = span.and(bounds.map_err(not_finite)?);
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
    let curved = team.chunks(GRAIN, mean.len(), |mut range| {
        range.any(|v| span.is_curved(&mesh.vertices, (v, mean[v]), rings.neighbours(v as u32)))
    });
    if !curved.contains(&true) {
        return Err(Error::Flat { sensor: number });
    }
    Ok(Absolute { hessians: mean, floor: span.floor(diameter), unfitted })
}

/// Least and greatest of some values.
#[derive(Clone, Copy)]
pub(in crate::metric) struct Bounds([f64; 2]);

impl Bounds {
    /// Those of none.
    pub const NONE: Self = Self([f64::INFINITY, f64::NEG_INFINITY]);

    /// Those of the values of the vertices from `start` on, or the first vertex where the value is not finite.
    pub fn of(start: usize, values: &[f64]) -> Result<Self, usize> {
        (start..).zip(values).try_fold(Self::NONE, |bounds, (vertex, &value)| {
            if value.is_finite() { Ok(bounds.and(Self([value, value]))) } else { Err(vertex) }
        })
    }

    /// Those of others too.
    pub fn and(self, Self([low, high]): Self) -> Self {
        Self([self.0[0].min(low), self.0[1].max(high)])
    }
}

/// Below this eigenvalues of |H| are rounding, of a field of this range on a domain of this diameter: see [`Absolute::floor`].
pub(super) fn floor(range: f64, diameter: f64) -> f64 {
    1e-12 * range / (diameter * diameter)
}

/// What the values of a sensor span, over its steps.
#[derive(Clone, Copy, Default)]
pub(in crate::metric) struct Span {
    /// The greatest absolute value.
    greatest: f64,
    /// The greatest difference in a step.
    range: f64,
}

impl Span {
    /// With one step more.
    pub fn and(self, Bounds([low, high]): Bounds) -> Self {
        Self { greatest: self.greatest.max(low.abs()).max(high.abs()), range: self.range.max(high - low) }
    }

    /// See [`Absolute::floor`].
    pub fn floor(self, diameter: f64) -> f64 {
        floor(self.range, diameter)
    }

    /// Whether eᵀ|H|e, the second difference along an edge e from a vertex to one of its neighbours, is above rounding. A Hessian has the
    /// rounding divided by the square of the edges' lengths; measured along edges, these lengths do not matter.
    pub fn is_curved(self, points: &[Vec3], (vertex, hessian): (usize, Sym3), neighbours: &[u32]) -> bool {
        let edge = |&other: &u32| sub(points[other as usize], points[vertex]);
        neighbours.iter().any(|other| hessian.quadratic(edge(other)) > ROUNDING * self.greatest)
    }
}
