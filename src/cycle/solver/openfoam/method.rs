//! How a flow is solved: which of OpenFOAM's programs, its schemes, and how fast it may go.
use super::flow::Flow;
use serde::{Deserialize, Serialize};

/// Mach number up to which a viscous flow is solved by [`Method::Simple`].
const SLOW: f64 = 0.6;

/// Relaxation of the pressure over that of velocity and energy: 0.3 and 0.7 are the usual pair (Ferziger and Peric, Computational Methods
/// for Fluid Dynamics, section 7.3.4).
pub const OF_PRESSURE: f64 = 0.3 / 0.7;

/// Which program solves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// rhoCentralFoam: central-upwind fluxes of the conserved quantities, explicit with local time steps. For shocks. In slow flow its
    /// dissipation is of the speed of sound, and what moves with the flow takes thousands of steps.
    Central,
    /// rhoSimpleFoam: pressure correction, implicit and without time. For subsonic flow with viscosity: hundreds of iterations, and a
    /// dissipation of the speed of the flow. It leaves the heat that friction makes out of account.
    Simple,
}

impl Method {
    /// What suits a flow: with viscosity and without shocks the pressure correction.
    pub fn of(flow: &Flow) -> Self {
        if flow.reynolds.is_some() && flow.mach <= SLOW { Self::Simple } else { Self::Central }
    }

    /// The name of its program.
    pub fn program(self) -> &'static str {
        match self {
            Self::Central => "rhoCentralFoam",
            Self::Simple => "rhoSimpleFoam",
        }
    }

    /// The scheme that is the best which lasts on stretched tetrahedra.
    pub fn scheme(self) -> Scheme {
        match self {
            Self::Central => Scheme::VanAlbada,
            Self::Simple => Scheme::LinearUpwind,
        }
    }

    /// Steps of first order before those of the first solve.
    pub fn start_steps(self) -> usize {
        match self {
            Self::Central => 300,
            Self::Simple => 0,
        }
    }

    /// Steps between two looks.
    pub fn block(self) -> usize {
        match self {
            Self::Central => 100,
            Self::Simple => 50,
        }
    }
}

/// How values at the faces are found from those of the cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scheme {
    /// First order.
    Upwind,
    /// The most careful limiter of second order.
    Minmod,
    /// Between the others.
    VanAlbada,
    /// The sharpest limiter.
    VanLeer,
    /// From the cell upwind by its limited gradient; of `simple` alone.
    LinearUpwind,
}

/// Steps with the same settings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// Which program.
    pub method: Method,
    /// How values at the faces are found.
    pub scheme: Scheme,
    /// Greatest Courant number of the local time steps, of `central`.
    pub courant: f64,
    /// Greatest growth of the local time step from a cell to the next, less 1, of `central`.
    pub smoothing: f64,
    /// Relaxation of velocity and energy, of `simple`.
    pub relaxation: f64,
}

impl Stage {
    /// With steps halved so many times.
    pub fn slower(self, halvings: i32) -> Self {
        let share = 0.5f64.powi(halvings);
        Self { courant: self.courant * share, relaxation: self.relaxation * share, ..self }
    }

    /// Relaxation of the pressure, of `simple`.
    pub fn of_pressure(self) -> f64 {
        OF_PRESSURE * self.relaxation
    }

    /// What limits its steps, in words.
    pub fn pace(self) -> String {
        match self.method {
            Method::Central => format!("Courant {}", self.courant),
            Method::Simple => format!("relaxation {}", self.relaxation),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_viscous_flow_is_for_the_pressure_correction() {
        let method = |text: &str| Method::of(&toml::from_str(text).unwrap());
        assert_eq!(method("mach = 0.3\nreynolds = 4000.0"), Method::Simple);
        assert_eq!(method("mach = 2.0\nreynolds = 4000.0"), Method::Central);
        assert_eq!(method("mach = 0.3"), Method::Central);
    }

    #[test]
    fn what_blows_up_goes_on_more_slowly() {
        let of = |method| Stage { method, scheme: Scheme::Upwind, courant: 0.4, smoothing: 0.3, relaxation: 0.7 };
        assert_eq!(of(Method::Central).slower(2).pace(), "Courant 0.1");
        let slow = of(Method::Simple).slower(1);
        assert_eq!(slow.pace(), "relaxation 0.35");
        assert!((slow.of_pressure() - 0.15).abs() < 1e-15);
        assert_eq!(slow.smoothing, 0.3);
    }
}
