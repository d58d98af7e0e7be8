//! The terms of a goal as a file says them, TOML: `geo-adapt metric goal --terms`. Relative paths begin at its folder.
use super::{Boundary, Derivative, Fluid, Gas, Variables, Viscosity};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// γ of air.
pub const GAMMA: f64 = 1.4;
/// Prandtl's number of air.
pub const PRANDTL: f64 = 0.72;

/// The terms of a goal.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Terms {
    /// What vertices on the boundary get.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub boundary: Option<Boundary>,
    /// Pairs of a weight and a field.
    #[serde(default)]
    pub terms: Vec<Term>,
    /// A flow, whose fluxes are terms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flow: Option<Flow>,
}

/// A pair of a weight and a field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Term {
    /// The field.
    pub field: Values,
    /// The weight, from 0 on. Or give
    #[serde(skip_serializing_if = "Option::is_none")]
    pub weight: Option<Values>,
    /// an adjoint, whose derivatives count with these coefficients: { x = 1, yy = 0.01 }.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub adjoint: Option<Values>,
    /// Coefficients by derivative.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub derivatives: BTreeMap<String, f64>,
}

/// One value a vertex.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "give the name of a file, or { file = \"flow.solb\", component = 2 }")]
pub enum Values {
    /// The only value of the file, or of the field of the mesh that is called so.
    Only(PathBuf),
    /// One of several.
    Component(Component),
}

/// One of the values of a vertex in a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Component {
    /// The file, or the field of the mesh that is called so.
    pub file: PathBuf,
    /// Which of the values, from 1 through all fields.
    pub component: usize,
}

/// Which equations a flow obeys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Equations {
    /// Those of Euler, or of Navier and Stokes, for a gas.
    #[default]
    Compressible,
    /// Of constant density.
    Incompressible,
}

/// A flow: see [`super::Goal::add_flow`] and [`super::Goal::add_incompressible`]. Its values stand in files, or where `V` says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flow<V = PathBuf> {
    /// Its state, five values a vertex; of an incompressible flow velocity (3) and pressure.
    pub primal: V,
    /// The adjoints of mass, momentum and energy, five values a vertex; of an incompressible flow those of momentum (3) and mass.
    pub adjoint: V,
    /// Which equations.
    #[serde(default)]
    pub equations: Equations,
    /// Density of an incompressible flow, by which its pressure is divided.
    #[serde(default = "one")]
    pub density: f64,
    /// How the state of a gas is written.
    #[serde(default)]
    pub variables: Variables,
    /// Ratio of the specific heats.
    #[serde(default = "gamma")]
    pub gamma: f64,
    /// Dynamic viscosity; no friction without it and `reynolds`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mu: Option<f64>,
    /// Reynolds' number of ρ∞, |u∞| and the unit of length, which the state is divided by: μ = 1/Re, of an incompressible flow ν = 1/Re.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reynolds: Option<f64>,
    /// Prandtl's number.
    #[serde(default = "prandtl")]
    pub prandtl: f64,
}

fn one() -> f64 {
    1.0
}

fn gamma() -> f64 {
    GAMMA
}

fn prandtl() -> f64 {
    PRANDTL
}

impl Values {
    /// Its file.
    pub fn file(&self) -> &Path {
        match self {
            Self::Only(file) | Self::Component(Component { file, .. }) => file,
        }
    }

    /// Which value of a vertex, from 1, where it is one of several.
    pub fn component(&self) -> Option<usize> {
        match self {
            Self::Only(_) => None,
            Self::Component(Component { component, .. }) => Some(*component),
        }
    }
}

/// What flows.
#[derive(Clone, Copy, Debug)]
pub enum Medium {
    /// A gas.
    Gas(Gas),
    /// A fluid of constant density.
    Fluid(Fluid),
}

impl<V> Flow<V> {
    /// An incompressible flow of density 1 without friction.
    pub fn incompressible(primal: V, adjoint: V) -> Self {
        let (equations, variables) = (Equations::Incompressible, Variables::default());
        let (density, gamma, prandtl) = (1.0, GAMMA, PRANDTL);
        Self { primal, adjoint, equations, density, variables, gamma, mu: None, reynolds: None, prandtl }
    }

    /// The same with its values elsewhere.
    pub fn at<W>(&self, primal: W, adjoint: W) -> Flow<W> {
        let &Self { equations, density, variables, gamma, mu, reynolds, prandtl, .. } = self;
        Flow { primal, adjoint, equations, density, variables, gamma, mu, reynolds, prandtl }
    }

    /// What flows.
    ///
    /// # Errors
    /// What cannot be.
    pub fn medium(&self) -> Result<Medium, String> {
        let positive = |name: &str, value: f64| match value > 0.0 && value.is_finite() {
            true => Ok(value),
            false => Err(format!("{name} is {value}: give a positive number")),
        };
        if !(self.gamma > 1.0 && self.gamma.is_finite()) {
            return Err(format!("gamma is {}: give a number above 1, 1.4 for air", self.gamma));
        }
        let density = positive("density", self.density)?;
        let mu = match (self.mu, self.reynolds) {
            (Some(_), Some(_)) => return Err("mu and reynolds say the same: give one of them".into()),
            (Some(mu), None) => Some(positive("mu", mu)?),
            (None, Some(reynolds)) => Some(density / positive("reynolds", reynolds)?),
            (None, None) => None,
        };
        if self.equations == Equations::Incompressible {
            return Ok(Medium::Fluid(Fluid { density, viscosity: mu.unwrap_or(0.0) / density }));
        }
        let prandtl = positive("prandtl", self.prandtl)?;
        Ok(Medium::Gas(Gas { gamma: self.gamma, viscosity: mu.map(|mu| Viscosity { mu, prandtl }) }))
    }
}

impl Term {
    /// The coefficients of the adjoint's derivatives; none of a weight that is given.
    ///
    /// # Errors
    /// When there is not one weight.
    pub fn coefficients(&self) -> Result<Vec<(Derivative, f64)>, String> {
        match (&self.weight, &self.adjoint) {
            (Some(_), None) if self.derivatives.is_empty() => return Ok(Vec::new()),
            (None, Some(_)) if !self.derivatives.is_empty() => {}
            (None, Some(_)) => return Err("the adjoint has no derivatives: give some, as { x = 1, xx = 0.01 }".into()),
            (Some(_), None) => return Err("derivatives belong to an adjoint, not to a weight".into()),
            _ => return Err("give a weight, or an adjoint with its derivatives".into()),
        }
        let parsed = self.derivatives.iter().map(|(name, &coefficient)| match coefficient.is_finite() {
            true => Ok((name.parse::<Derivative>()?, coefficient)),
            false => Err(format!("the coefficient of {name} is {coefficient}")),
        });
        parsed.collect()
    }
}

impl Terms {
    /// All files.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        let terms = self.terms.iter().flat_map(|term| [Some(&term.field), term.weight.as_ref(), term.adjoint.as_ref()]);
        let flow = self.flow.iter().flat_map(|flow| [flow.primal.as_path(), flow.adjoint.as_path()]);
        terms.flatten().map(Values::file).chain(flow)
    }
}
