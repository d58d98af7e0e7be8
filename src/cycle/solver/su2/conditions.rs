//! A configuration of SU2 from a few flow conditions.
use super::cfg::Cfg;
use serde::{Deserialize, Serialize};

/// Which equations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Model {
    /// Without viscosity.
    #[default]
    Euler,
    /// Laminar; needs a Reynolds number.
    Laminar,
    /// Spalart and Allmaras; needs a Reynolds number.
    Turbulent,
}

/// `[solver.su2.flow]`: a steady compressible flow of air about a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Conditions {
    /// Euler, laminar or turbulent.
    #[serde(default)]
    pub model: Model,
    /// Mach number of the free stream.
    pub mach: f64,
    /// Angle of attack, degrees: in the x-z plane.
    #[serde(default)]
    pub angle_of_attack: f64,
    /// Angle of sideslip, degrees.
    #[serde(default)]
    pub sideslip: f64,
    /// Reynolds number of the reference length.
    #[serde(default = "million")]
    pub reynolds: f64,
    /// Length of the Reynolds number and the moments, model units. In a loop the mean aerodynamic chord of the walls without.
    pub length: Option<f64>,
    /// Area of the coefficients, model units². In a loop the walls' as seen along z without.
    pub area: Option<f64>,
    /// Names of the surfaces of the body.
    pub walls: Vec<String>,
    /// Of the far field.
    pub farfield: Vec<String>,
    /// Of the symmetry.
    #[serde(default)]
    pub symmetry: Vec<String>,
}

fn million() -> f64 {
    1e6
}

/// The options that do not depend on the flow: implicit, second order, a limiter for shocks, a CFL number that finds itself.
const USUAL: [(&str, &str); 21] = [
    ("MATH_PROBLEM", "DIRECT"),
    ("FREESTREAM_PRESSURE", "101325.0"),
    ("FREESTREAM_TEMPERATURE", "288.15"),
    ("REF_DIMENSIONALIZATION", "FREESTREAM_PRESS_EQ_ONE"),
    ("NUM_METHOD_GRAD", "WEIGHTED_LEAST_SQUARES"),
    ("CONV_NUM_METHOD_FLOW", "ROE"),
    ("ENTROPY_FIX_COEFF", "0.05"),
    ("MUSCL_FLOW", "YES"),
    ("SLOPE_LIMITER_FLOW", "VENKATAKRISHNAN_WANG"),
    ("VENKAT_LIMITER_COEFF", "0.05"),
    ("TIME_DISCRE_FLOW", "EULER_IMPLICIT"),
    ("CFL_NUMBER", "2.0"),
    ("CFL_ADAPT", "YES"),
    ("CFL_ADAPT_PARAM", "( 0.5, 1.2, 1.0, 50.0 )"),
    ("LINEAR_SOLVER", "FGMRES"),
    ("LINEAR_SOLVER_PREC", "ILU"),
    ("LINEAR_SOLVER_ERROR", "1E-4"),
    ("LINEAR_SOLVER_ITER", "10"),
    ("CONV_FIELD", "RMS_DENSITY"),
    ("CONV_RESIDUAL_MINVAL", "-8"),
    ("ITER", "500"),
];

/// Names as SU2 lists them.
fn list(names: &[String]) -> String {
    format!("( {} )", names.join(", "))
}

impl Conditions {
    /// Refuses what SU2 would not bear: in lists of walls with a value it takes names that are numbers for values, and crashes.
    ///
    /// # Errors
    /// Which name, and the remedy.
    pub fn check(&self) -> Result<(), String> {
        let number = self.walls.iter().find(|name| name.parse::<f64>().is_ok());
        number.filter(|_| self.model != Model::Euler).map_or(Ok(()), |name| {
            Err(format!(
                "[solver.su2.flow] walls: SU2 takes the name {name} for a value where walls have viscosity: give the surface a name that is no \
                 number (geo-adapt model MODEL --name wing={name})"
            ))
        })
    }

    /// The configuration.
    pub fn cfg(&self) -> Cfg {
        let mut cfg = Cfg::default();
        let length = self.length.unwrap_or(1.0);
        let solver = match self.model {
            Model::Euler => "EULER",
            Model::Laminar => "NAVIER_STOKES",
            Model::Turbulent => "RANS",
        };
        cfg.set("SOLVER", solver);
        if self.model == Model::Turbulent {
            cfg.set("KIND_TURB_MODEL", "SA");
            cfg.set("CONV_NUM_METHOD_TURB", "SCALAR_UPWIND");
            cfg.set("TIME_DISCRE_TURB", "EULER_IMPLICIT");
        }
        for (key, value) in [
            ("MACH_NUMBER", self.mach),
            ("AOA", self.angle_of_attack),
            ("SIDESLIP_ANGLE", self.sideslip),
            ("REF_LENGTH", length),
            ("REF_AREA", self.area.unwrap_or(1.0)),
        ] {
            cfg.set(key, &value.to_string());
        }
        USUAL.iter().for_each(|(key, value)| cfg.set(key, value));
        if self.model == Model::Euler {
            cfg.set("MARKER_EULER", &list(&self.walls));
        } else {
            cfg.set("REYNOLDS_NUMBER", &self.reynolds.to_string());
            cfg.set("REYNOLDS_LENGTH", &length.to_string());
            // Adiabatic: no heat through any of them.
            let walls: Vec<String> = self.walls.iter().map(|wall| format!("{wall}, 0.0")).collect();
            cfg.set("MARKER_HEATFLUX", &list(&walls));
        }
        cfg.set("MARKER_FAR", &list(&self.farfield));
        if !self.symmetry.is_empty() {
            cfg.set("MARKER_SYM", &list(&self.symmetry));
        }
        cfg.set("MARKER_PLOTTING", &list(&self.walls));
        cfg.set("MARKER_MONITORING", &list(&self.walls));
        cfg
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_have_the_condition_of_their_equations() {
        let mut flow = Conditions {
            model: Model::Euler,
            mach: 0.84,
            angle_of_attack: 3.06,
            sideslip: 0.0,
            reynolds: 1e6,
            length: Some(0.64607),
            area: Some(0.7532),
            walls: vec!["wing".into(), "tip".into()],
            farfield: vec!["farfield".into()],
            symmetry: vec![],
        };
        let text = flow.cfg().text();
        assert!(
            text.contains("SOLVER= EULER\n")
                && text.contains("MARKER_EULER= ( wing, tip )\n")
                && text.contains("AOA= 3.06\n"),
            "{text}"
        );
        assert!(!text.contains("MARKER_SYM") && !text.contains("REYNOLDS"), "{text}");
        flow.model = Model::Turbulent;
        flow.symmetry = vec!["symmetry".into()];
        assert_eq!(flow.check(), Ok(()));
        let numbered = Conditions { walls: vec!["wing".into(), "7".into()], ..flow.clone() };
        assert!(numbered.check().unwrap_err().contains("takes the name 7 for a value"));
        assert_eq!(Conditions { model: Model::Euler, ..numbered }.check(), Ok(()));
        let text = flow.cfg().text();
        assert!(
            text.contains("KIND_TURB_MODEL= SA\n") && text.contains("MARKER_HEATFLUX= ( wing, 0.0, tip, 0.0 )\n"),
            "{text}"
        );
        assert!(text.contains("MARKER_SYM= ( symmetry )\n") && text.contains("REYNOLDS_NUMBER= 1000000\n"), "{text}");
        let mut keys: Vec<&str> = text.lines().map(|line| line.split('=').next().unwrap()).collect();
        let all = keys.len();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), all, "an option twice: {text}");
    }
}
