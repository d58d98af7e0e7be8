//! Q = Σ g |H(u)|, term by term, and the metric that is made of it.
use super::weights::Weight;
use super::{Boundary, Error};
use crate::mesh::TetMesh;
use crate::metric::Sym3;
use crate::metric::multiscale::{self, Norm, Options, Summary, of_absolute, sensor};
use crate::metric::recovery::{Recovery, Rings};
use crate::tasks::{GRAIN, Team};

/// p of the metric of a goal: the error of a functional is an integral.
pub const NORM: Norm = Norm::ONE;

/// A goal on a mesh of n vertices, as far as its terms were added.
pub struct Goal<'m> {
    pub(super) team: Team<'m>,
    pub(super) mesh: &'m TetMesh,
    pub(super) rings: Rings,
    pub(super) recovery: Recovery,
    boundary: Boundary,
    /// Q at the vertices.
    sum: Vec<Sym3>,
    /// Eigenvalues of Q below this are rounding.
    floor: f64,
    diameter: f64,
    unfitted: usize,
    terms: usize,
}

impl<'m> Goal<'m> {
    /// Without terms.
    pub fn new(team: Team<'m>, mesh: &'m TetMesh, recovery: Recovery, boundary: Boundary) -> Self {
        let (rings, diameter) = (Rings::of(team, mesh), multiscale::diameter(team, mesh));
        let sum = vec![Sym3::ZERO; mesh.vertices.len()];
        Self { team, mesh, rings, recovery, boundary, sum, floor: 0.0, diameter, unfitted: 0, terms: 0 }
    }

    /// Adds a term with a field, shape (n,). A field that is linear adds nothing.
    ///
    /// # Errors
    /// [`Error::NotFinite`] and [`Error::Weight`].
    ///
    /// # Panics
    /// When there is not one value a vertex.
    pub fn add(&mut self, weight: Weight<'_>, field: &[f64]) -> Result<(), Error> {
        let weights = weight.values(self.team, self.mesh, &self.rings, self.recovery)?;
        self.add_weighted(weights, field)
    }

    /// The same with the weights, shape (n,), that were checked.
    pub(super) fn add_weighted(&mut self, mut weights: Vec<f64>, field: &[f64]) -> Result<(), Error> {
        let (team, rings) = (self.team, &self.rings);
        assert_eq!(weights.len(), self.sum.len(), "one weight a vertex");
        self.terms += 1;
        let found = match sensor::absolute(team, self.mesh, rings, self.recovery, (0, &[field]), self.diameter) {
            Ok(found) => found,
            Err(multiscale::Error::Flat { .. }) => return Ok(()),
            Err(multiscale::Error::NotFinite { vertex, .. }) => return Err(Error::NotFinite { vertex }),
            Err(error) => return Err(error.into()),
        };
        self.boundary.limit(team, rings, &mut weights);
        let mut hessians = found.hessians;
        self.boundary.carry(team, rings, &mut hessians);
        team.fill(GRAIN, &mut self.sum, |start, sums| {
            for (sum, v) in sums.iter_mut().zip(start..) {
                *sum = sum.plus(hessians[v].times(weights[v]));
            }
        });
        self.floor += found.floor * weights.iter().copied().fold(0.0, f64::max);
        self.unfitted = self.unfitted.max(found.unfitted);
        Ok(())
    }

    /// The terms that were added.
    pub fn terms(&self) -> usize {
        self.terms
    }

    /// Q at the vertices, shape (n,).
    pub fn sum(&self) -> &[Sym3] {
        &self.sum
    }

    /// ln M at the vertices, shape (n,), of the complexity wanted, and what was done. [`NORM`] is the usual norm.
    ///
    /// # Errors
    /// [`Error::Nothing`], [`Error::Flat`], and [`Error::Metric`] where bounds leave no such metric.
    pub fn metric(self, options: &Options<'_>) -> Result<(Vec<Sym3>, Summary), Error> {
        if self.terms == 0 {
            return Err(Error::Nothing);
        }
        if self.sum.iter().all(|q| q.trace() <= 3.0 * self.floor) {
            return Err(Error::Flat);
        }
        let found = sensor::Absolute { hessians: self.sum, floor: self.floor, unfitted: self.unfitted };
        Ok(of_absolute(self.team, self.mesh, self.rings, &found, options)?)
    }
}
