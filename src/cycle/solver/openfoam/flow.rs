//! The flow: its gas, its free stream, and what holds at which surface.
use serde::{Deserialize, Serialize};

/// `[solver.openfoam.flow]`: a steady compressible flow, inviscid, or laminar where there is a Reynolds number.
///
/// Without pressure and temperature all is in units of the free stream: pressure 1, temperature 1, speed of sound 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flow {
    /// Mach number of the free stream.
    pub mach: f64,
    /// Angle of attack, degrees: in the x-z plane.
    #[serde(default)]
    pub angle_of_attack: f64,
    /// Angle of sideslip, degrees: towards y.
    #[serde(default)]
    pub sideslip: f64,
    /// Static pressure of the free stream.
    #[serde(default = "one")]
    pub pressure: f64,
    /// Static temperature of the free stream.
    #[serde(default = "one")]
    pub temperature: f64,
    /// Ratio of specific heats.
    #[serde(default = "air")]
    pub gamma: f64,
    /// Gas constant R of p = ρ R T; by default 1/γ, and 287.05 where a pressure is given.
    pub gas_constant: Option<f64>,
    /// Reynolds number of the reference length; inviscid without.
    pub reynolds: Option<f64>,
    /// Prandtl number.
    #[serde(default = "prandtl")]
    pub prandtl: f64,
    /// Length of the Reynolds number, model units. In a loop the mean aerodynamic chord of the walls without; else 1.
    pub length: Option<f64>,
    /// Temperature of the walls, where a viscous flow has walls of a constant one; without, no heat goes through them.
    pub wall_temperature: Option<f64>,
    /// Area of the coefficients, model units². In a loop the walls' as seen along z without; else 1.
    pub area: Option<f64>,
    /// Names of the walls, or references where they have none: "3".
    #[serde(default)]
    pub walls: Vec<String>,
    /// Planes of symmetry.
    #[serde(default)]
    pub symmetry: Vec<String>,
    /// Free stream far away.
    #[serde(default)]
    pub farfield: Vec<String>,
    /// Supersonic inflow: all is that of the free stream.
    #[serde(default)]
    pub inflow: Vec<String>,
    /// Supersonic outflow: all comes from inside.
    #[serde(default)]
    pub outflow: Vec<String>,
}

fn one() -> f64 {
    1.0
}

fn air() -> f64 {
    1.4
}

fn prandtl() -> f64 {
    0.72
}

/// What holds at a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kind {
    /// No flow through it, and with viscosity none along it.
    Wall,
    /// A plane of symmetry.
    Symmetry,
    /// Free stream.
    Farfield,
    /// Supersonic inflow.
    Inflow,
    /// Supersonic outflow.
    Outflow,
}

impl Flow {
    /// Refuses what is no flow.
    ///
    /// # Errors
    /// Which value cannot be.
    pub fn check(&self) -> Result<(), String> {
        let positive = [
            ("mach", self.mach),
            ("pressure", self.pressure),
            ("temperature", self.temperature),
            ("gas_constant", self.r()),
            ("reynolds", self.reynolds.unwrap_or(1.0)),
            ("prandtl", self.prandtl),
            ("length", self.length.unwrap_or(1.0)),
            ("area", self.area.unwrap_or(1.0)),
            ("wall_temperature", self.wall_temperature.unwrap_or(1.0)),
        ];
        if let Some((name, value)) = positive.into_iter().find(|(_, value)| !(*value > 0.0 && value.is_finite())) {
            return Err(format!("[solver.openfoam.flow] {name} is {value}: give a positive number"));
        }
        if !(self.gamma > 1.0 && self.gamma.is_finite()) {
            return Err(format!("[solver.openfoam.flow] gamma is {}: give a number above 1", self.gamma));
        }
        if self.wall_temperature.is_some() && self.reynolds.is_none() {
            return Err(
                "[solver.openfoam.flow] wall_temperature: without viscosity no heat goes to a wall; give reynolds too"
                    .into(),
            );
        }
        if self.walls.len() + self.farfield.len() + self.inflow.len() == 0 {
            return Err(
                "[solver.openfoam.flow] names no surface: give walls, farfield, inflow, outflow, symmetry".into()
            );
        }
        Ok(())
    }

    /// The gas constant.
    pub fn r(&self) -> f64 {
        let normal = self.pressure == 1.0 && self.temperature == 1.0;
        self.gas_constant.unwrap_or(if normal { 1.0 / self.gamma } else { 287.05 })
    }

    /// Speed of sound of the free stream.
    pub fn sound(&self) -> f64 {
        (self.gamma * self.r() * self.temperature).sqrt()
    }

    /// Velocity of the free stream.
    pub fn velocity(&self) -> [f64; 3] {
        let speed = self.mach * self.sound();
        self.downstream().map(|part| speed * part)
    }

    /// Unit vector of the drag.
    pub fn downstream(&self) -> [f64; 3] {
        let (a, b) = (self.angle_of_attack.to_radians(), self.sideslip.to_radians());
        [a.cos() * b.cos(), b.sin(), a.sin() * b.cos()]
    }

    /// Unit vector of the lift.
    pub fn upwards(&self) -> [f64; 3] {
        let a = self.angle_of_attack.to_radians();
        [-a.sin(), 0.0, a.cos()]
    }

    /// Dynamic pressure of the free stream, ½ γ p M².
    pub fn dynamic_pressure(&self) -> f64 {
        0.5 * self.gamma * self.pressure * self.mach * self.mach
    }

    /// Density of the free stream.
    pub fn density(&self) -> f64 {
        self.pressure / (self.r() * self.temperature)
    }

    /// Dynamic viscosity, 0 without a Reynolds number.
    pub fn viscosity(&self) -> f64 {
        let density = self.density();
        self.reynolds.map_or(0.0, |reynolds| density * self.mach * self.sound() * self.length.unwrap_or(1.0) / reynolds)
    }

    /// What holds at the surface of that reference and name, if any list has it.
    pub fn kind(&self, reference: i32, name: Option<&str>) -> Option<Kind> {
        let number = reference.to_string();
        let has = |list: &[String]| list.iter().any(|word| Some(word.as_str()) == name || *word == number);
        let lists = [
            (Kind::Wall, &self.walls),
            (Kind::Symmetry, &self.symmetry),
            (Kind::Farfield, &self.farfield),
            (Kind::Inflow, &self.inflow),
            (Kind::Outflow, &self.outflow),
        ];
        lists.into_iter().find(|(_, list)| has(list)).map(|(kind, _)| kind)
    }

    /// The entries of the field `p`, `T` or `U` at a surface.
    pub fn entries(&self, field: &str, kind: Kind) -> String {
        let value = match field {
            "p" => format!("{:?}", self.pressure),
            "T" => format!("{:?}", self.temperature),
            _ => {
                let [x, y, z] = self.velocity();
                format!("({x:?} {y:?} {z:?})")
            }
        };
        match (kind, field) {
            (Kind::Symmetry, _) => "type symmetry;".into(),
            (Kind::Wall, "U") if self.reynolds.is_some() => "type noSlip;".into(),
            (Kind::Wall, "U") => "type slip;".into(),
            (Kind::Wall, "T") if self.wall_temperature.is_some() => {
                format!("type fixedValue; value uniform {:?};", self.wall_temperature.unwrap_or(self.temperature))
            }
            (Kind::Wall | Kind::Outflow, _) => "type zeroGradient;".into(),
            (Kind::Inflow, _) => format!("type fixedValue; value uniform {value};"),
            (Kind::Farfield, "p") => {
                let supersonic = self.mach > 1.0;
                format!(
                    "type freestreamPressure; freestreamValue uniform {value}; supersonic {supersonic}; value uniform {value};"
                )
            }
            (Kind::Farfield, "U") => {
                format!("type freestreamVelocity; freestreamValue uniform {value}; value uniform {value};")
            }
            (Kind::Farfield, _) => format!("type inletOutlet; inletValue uniform {value}; value uniform {value};"),
        }
    }
}

impl Kind {
    /// The type of its patch.
    pub fn patch(self) -> &'static str {
        match self {
            Self::Wall => "wall",
            Self::Symmetry => "symmetry",
            Self::Farfield | Self::Inflow | Self::Outflow => "patch",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flow(text: &str) -> Flow {
        toml::from_str(text).unwrap()
    }

    #[test]
    fn a_flow_in_units_of_its_free_stream() {
        let flow = flow("mach = 2.0\nangle_of_attack = 30.0\nwalls = ['wall', '7']\nreynolds = 4000.0");
        assert!((flow.sound() - 1.0).abs() < 1e-15);
        let [x, y, z] = flow.velocity();
        assert!((x - 3.0f64.sqrt()).abs() < 1e-15 && y == 0.0 && (z - 1.0).abs() < 1e-15);
        // ρ = γ p / a².
        assert!((flow.viscosity() - 1.4 * 2.0 / 4000.0).abs() < 1e-15);
        assert!((flow.dynamic_pressure() - 2.8).abs() < 1e-15);
        assert_eq!((flow.kind(3, Some("wall")), flow.kind(7, None)), (Some(Kind::Wall), Some(Kind::Wall)));
        assert_eq!(flow.kind(3, Some("other")), None);
        assert_eq!(flow.entries("U", Kind::Wall), "type noSlip;");
        assert!(flow.entries("U", Kind::Inflow).starts_with("type fixedValue; value uniform (1.73"));
        assert_eq!(flow.entries("T", Kind::Wall), "type zeroGradient;");
        let flow = Flow { wall_temperature: Some(1.25), ..flow };
        assert_eq!(flow.entries("T", Kind::Wall), "type fixedValue; value uniform 1.25;");
        assert_eq!(flow.entries("p", Kind::Wall), "type zeroGradient;");
    }

    #[test]
    fn air_where_a_pressure_is_given() {
        let flow = flow("mach = 0.5\npressure = 101325.0\ntemperature = 288.15\nfarfield = ['far']");
        assert!((flow.sound() - 340.3).abs() < 0.1);
        assert!(flow.check().is_ok());
        let message = |text: &str| self::flow(text).check().unwrap_err();
        assert!(message("mach = -1.0\nwalls = ['a']").contains("mach is -1"));
        assert!(message("mach = 1.0\ngamma = 1.0\nwalls = ['a']").contains("gamma is 1"));
        assert!(message("mach = 1.0").contains("names no surface"));
        let heated = "mach = 1.0\nwalls = ['a']\nwall_temperature = ";
        assert!(message(&format!("{heated}1.0")).contains("give reynolds too"));
        assert!(message(&format!("{heated}-1.0\nreynolds = 10.0")).contains("wall_temperature is -1"));
    }
}
