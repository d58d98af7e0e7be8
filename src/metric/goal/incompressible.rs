//! The terms of an incompressible flow: the fluxes of mass and momentum, and viscosity, weighted by an adjoint.
//!
//! Four equations, ∂_d u_d = 0 and ∂_d (u_d u_k + p/ρ δ_dk − ν ∂_d u_k) = 0, with four adjoints: of momentum λ_1 … λ_3, as adjointOptimisationFoam's Ua,
//! and of mass λ_0, its pa. As for a gas (`flow`) the error in the functional is bounded flux by flux,
//! Q = Σ_d |∂_d λ_0| |H(u_d)| + Σ_k Σ_d |∂_d λ_k| |H(u_d u_k + p/ρ δ_dk)| + ν Σ_k Σ_d |∂_dd λ_k| |H(u_k)|,
//! each derivative in absolute value (Loseille, Dervieux & Alauzet 2010; Belme, Dervieux & Alauzet 2012).
use super::{Error, Goal};
use crate::mesh::vector::Vec3;
use crate::metric::recovery::gradients_of;
use crate::tasks::GRAIN;

/// A fluid of constant density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fluid {
    /// Density ρ, by which the pressure is divided.
    pub density: f64,
    /// Kinematic viscosity ν; 0 without friction.
    pub viscosity: f64,
}

impl Goal<'_> {
    /// Adds the terms of an incompressible flow: velocity (3) and pressure at the vertices, shape (n, 4), and the adjoints of momentum (3) and mass,
    /// shape (n, 4).
    ///
    /// # Errors
    /// [`Error::NotFinite`].
    ///
    /// # Panics
    /// When there are not as many rows as vertices.
    pub fn add_incompressible(&mut self, fluid: Fluid, primal: &[[f64; 4]], adjoint: &[[f64; 4]]) -> Result<(), Error> {
        let (team, count) = (self.team, self.mesh.vertices.len());
        assert!(primal.len() == count && adjoint.len() == count, "a row a vertex");
        let is_finite = |row: &[f64; 4]| row.iter().all(|x| x.is_finite());
        if let Some(vertex) = team.first(GRAIN, count, |v| !(is_finite(&primal[v]) && is_finite(&adjoint[v]))) {
            return Err(Error::NotFinite { vertex });
        }
        let slopes: Vec<[Vec3; 4]> = gradients_of(team, self.mesh, &self.rings, count, |v| adjoint[v as usize]);
        let mut add = |weight: &(dyn Fn(usize) -> f64 + Sync), flux: &(dyn Fn(&[f64; 4]) -> f64 + Sync)| {
            let weights = team.map(GRAIN, count, weight);
            let fluxes = team.map(GRAIN, count, |v| flux(&primal[v]));
            self.add_weighted(weights, &fluxes)
        };
        for d in 0..3 {
            add(&|v| slopes[v][3][d].abs(), &|state| state[d])?;
            add(&|v| slopes[v][d][d].abs(), &|state| state[d] * state[d] + state[3] / fluid.density)?;
            // The flux of momentum is symmetric: both of its sides at once.
            let k = (d + 1) % 3;
            add(&|v| slopes[v][k][d].abs() + slopes[v][d][k].abs(), &|state| state[d] * state[k])?;
        }
        if fluid.viscosity == 0.0 {
            return Ok(());
        }
        for k in 0..3 {
            let values = team.map(GRAIN, count, |v| adjoint[v][k]);
            let bends = self.recovery.hessians(team, self.mesh, &self.rings, &values).0;
            let weights =
                team.map(GRAIN, count, |v| fluid.viscosity * (0..3).map(|d| bends[v].at(d, d).abs()).sum::<f64>());
            let velocity = team.map(GRAIN, count, |v| primal[v][k]);
            self.add_weighted(weights, &velocity)?;
        }
        Ok(())
    }
}
