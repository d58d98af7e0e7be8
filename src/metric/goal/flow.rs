//! The terms of a flow of gas: fluxes of Euler's equations, and the viscous terms of Navier and Stokes, weighted by an adjoint.
//!
//! Five equations, of mass, momentum (x, y, z) and total energy; five adjoints, in this order, λ_0 … λ_4, the multipliers of the equations in
//! conservative form. Units are free, as long as they are of one system: p = (γ - 1)(E - ρ|u|²/2).
//!
//! - Euler: Q = Σ_k Σ_d |∂_d λ_k| |H(F_dk)|, F_d = (ρ u_d, ρ u_k u_d + p δ_kd, (E + p) u_d) (Loseille, Dervieux & Alauzet 2010, eq. 22).
//! - Viscous: ∫ ∂_d λ_k τ_dk(δu), τ = μ(∇u + ∇uᵀ - ⅔ ∇·u I), integrated by parts: δu_j stands with
//!   μ(Σ_d ∂_dd λ_j + ⅓ Σ_k ∂_jk λ_k), each term of which counts in absolute value. In the equation of energy the work τ·u is the same with
//!   u_k λ_4 for λ_k, u held; heat is μγ/((γ - 1) Pr) Σ_d |∂_dd λ_4| |H(p/ρ)| (Belme, Dervieux & Alauzet 2012, section 3.3).
use super::{Error, Goal};
use crate::mesh::vector::Vec3;
use crate::metric::recovery::gradients_of;
use crate::tasks::GRAIN;

/// How the state of a gas is written, five values a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Variables {
    /// ρ, ρu, ρv, ρw, E: densities of mass, momentum and total energy.
    #[default]
    Conservative,
    /// ρ, u, v, w, p.
    Primitive,
}

impl Variables {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Conservative, Self::Primitive];

    /// As the command line spells it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Conservative => "conservative",
            Self::Primitive => "primitive",
        }
    }
}

/// A calorically perfect gas.
#[derive(Clone, Copy, Debug)]
pub struct Gas {
    /// Ratio of the specific heats γ, above 1.
    pub gamma: f64,
    /// None for Euler's equations.
    pub viscosity: Option<Viscosity>,
}

/// Constant viscosity.
#[derive(Clone, Copy, Debug)]
pub struct Viscosity {
    /// Dynamic viscosity μ, in the units of ρ |u| length.
    pub mu: f64,
    /// Prandtl's number.
    pub prandtl: f64,
}

/// Density, velocity and pressure at a vertex.
#[derive(Clone, Copy)]
struct State {
    density: f64,
    velocity: Vec3,
    pressure: f64,
}

impl State {
    fn of([density, a, b, c, last]: [f64; 5], variables: Variables, gamma: f64) -> Self {
        if variables == Variables::Primitive {
            return Self { density, velocity: [a, b, c], pressure: last };
        }
        let velocity = [a, b, c].map(|momentum| momentum / density);
        let kinetic = 0.5 * (a * velocity[0] + b * velocity[1] + c * velocity[2]);
        Self { density, velocity, pressure: (gamma - 1.0) * (last - kinetic) }
    }

    fn is_gas(&self) -> bool {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        positive(self.density) && positive(self.pressure)
    }

    /// Total enthalpy times density, E + p.
    fn enthalpy(&self, gamma: f64) -> f64 {
        let [u, v, w] = self.velocity;
        gamma / (gamma - 1.0) * self.pressure + 0.5 * self.density * (u * u + v * v + w * w)
    }
}

impl Goal<'_> {
    /// Adds the terms of a flow: its state at the vertices, shape (n, 5), and the adjoints of the equations, shape (n, 5).
    ///
    /// # Errors
    /// [`Error::NotFinite`] and [`Error::State`].
    ///
    /// # Panics
    /// When there are not as many rows as vertices.
    pub fn add_flow(
        &mut self,
        gas: &Gas,
        variables: Variables,
        primal: &[[f64; 5]],
        adjoint: &[[f64; 5]],
    ) -> Result<(), Error> {
        let (team, count) = (self.team, self.mesh.vertices.len());
        assert!(primal.len() == count && adjoint.len() == count, "a row a vertex");
        let is_finite = |row: &[f64; 5]| row.iter().all(|x| x.is_finite());
        if let Some(vertex) = team.first(GRAIN, count, |v| !(is_finite(&primal[v]) && is_finite(&adjoint[v]))) {
            return Err(Error::NotFinite { vertex });
        }
        let states = team.map(GRAIN, count, |v| State::of(primal[v], variables, gas.gamma));
        if let Some(vertex) = team.first(GRAIN, count, |v| !states[v].is_gas()) {
            let State { density, pressure, .. } = states[vertex];
            return Err(Error::State { vertex, density, pressure });
        }
        self.add_fluxes(gas.gamma, &states, adjoint)?;
        gas.viscosity.map_or(Ok(()), |viscosity| self.add_viscous(gas.gamma, viscosity, &states, adjoint))
    }

    fn add_fluxes(&mut self, gamma: f64, states: &[State], adjoint: &[[f64; 5]]) -> Result<(), Error> {
        let (team, count) = (self.team, states.len());
        let slopes: Vec<[Vec3; 5]> = gradients_of(team, self.mesh, &self.rings, count, |v| adjoint[v as usize]);
        let mut add = |weight: &(dyn Fn(usize) -> f64 + Sync), flux: &(dyn Fn(&State) -> f64 + Sync)| {
            let weights = team.map(GRAIN, count, weight);
            let fluxes = team.map(GRAIN, count, |v| flux(&states[v]));
            self.add_weighted(weights, &fluxes)
        };
        for d in 0..3 {
            add(&|v| slopes[v][0][d].abs(), &|s| s.density * s.velocity[d])?;
            add(&|v| slopes[v][4][d].abs(), &|s| s.enthalpy(gamma) * s.velocity[d])?;
            add(&|v| slopes[v][d + 1][d].abs(), &|s| s.density * s.velocity[d] * s.velocity[d] + s.pressure)?;
            // The flux of momentum is symmetric: both of its sides at once.
            let k = (d + 1) % 3;
            let weight = |v: usize| slopes[v][k + 1][d].abs() + slopes[v][d + 1][k].abs();
            add(&weight, &|s| s.density * s.velocity[d] * s.velocity[k])?;
        }
        Ok(())
    }

    fn add_viscous(
        &mut self,
        gamma: f64,
        Viscosity { mu, prandtl }: Viscosity,
        states: &[State],
        adjoint: &[[f64; 5]],
    ) -> Result<(), Error> {
        let (team, count) = (self.team, states.len());
        let component = |k: usize| team.map(GRAIN, count, |v| adjoint[v][k]);
        let bends: Vec<_> =
            (1..5).map(|k| self.recovery.hessians(team, self.mesh, &self.rings, &component(k)).0).collect();
        let energy = &bends[3];
        for j in 0..3 {
            let weights = team.map(GRAIN, count, |v| {
                let u = states[v].velocity;
                let of = |k: usize, a: usize, b: usize| bends[k][v].at(a, b).abs();
                let of_energy = |k: usize, a: usize, b: usize| (u[k] * energy[v].at(a, b)).abs();
                (0..3)
                    .map(|d| {
                        // δu_j with ∂_dd λ_j, and with ∂_jd λ_d.
                        let (own, other) = if d == j { (4.0 / 3.0, 0.0) } else { (1.0, 1.0 / 3.0) };
                        own * (of(j, d, d) + of_energy(j, d, d)) + other * (of(d, j, d) + of_energy(d, j, d))
                    })
                    .sum::<f64>()
                    * mu
            });
            let velocity = team.map(GRAIN, count, |v| states[v].velocity[j]);
            self.add_weighted(weights, &velocity)?;
        }
        let conductivity = mu * gamma / ((gamma - 1.0) * prandtl);
        let weights = team.map(GRAIN, count, |v| conductivity * (0..3).map(|d| energy[v].at(d, d).abs()).sum::<f64>());
        let temperature = team.map(GRAIN, count, |v| states[v].pressure / states[v].density);
        self.add_weighted(weights, &temperature)
    }
}
