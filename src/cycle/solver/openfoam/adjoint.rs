//! The adjoint of a force by adjointOptimisationFoam, which is of incompressible flow: it begins with the flow that was found, makes it that of constant
//! density, and solves its adjoint (Papoutsis-Kiachagias & Giannakoglou 2016). What blows up is run again with half of the relaxation.
//!
//! The case is a folder in that of the flow: the same mesh, U, p/ρ∞, Ua and pa.
use super::dictionaries::adjoint as dictionaries;
use super::drive::last_time;
use super::flow::{Flow, Kind};
use super::method::Scheme;
use super::programs::{Failure, Program, solve};
use crate::formats::foam::{self, CellField};
use crate::mesh::io::FieldKind;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// The program.
pub const PROGRAM: &str = "adjointOptimisationFoam";

/// The adjoints of momentum and mass.
pub const FIELDS: [(&str, FieldKind); 2] = [("Ua", FieldKind::Vector), ("pa", FieldKind::Scalar)];

/// The folder of its case in that of the flow.
const CASE: &str = "adjoint";

/// How often it is run again after it has blown up.
const TRIALS: i32 = 3;

/// Up to this Mach number a gas is taken for incompressible.
const SLOW: f64 = 0.3;

/// A force whose adjoint is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Force {
    /// Lift.
    #[serde(rename = "CL")]
    Lift,
    /// Drag.
    #[serde(rename = "CD")]
    Drag,
}

impl Force {
    /// Its direction, a unit vector.
    pub fn direction(self, flow: &Flow) -> [f64; 3] {
        match self {
            Self::Lift => flow.upwards(),
            Self::Drag => flow.downstream(),
        }
    }
}

/// What is to be done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// The force.
    pub force: Force,
    /// The program, and its processes.
    pub program: Program,
    /// The patches of the mesh and what holds there.
    pub patches: Vec<(String, Kind)>,
    /// Iterations of the flow, and of its adjoint, at most.
    pub iterations: usize,
    /// How values at faces are found.
    pub scheme: Scheme,
    /// Relaxation of the velocities.
    pub relaxation: f64,
}

/// The case of the adjoint, in that of the flow.
pub fn folder(case: &Path) -> PathBuf {
    case.join(CASE)
}

/// Refuses flows whose adjoint it does not solve.
///
/// # Errors
/// What it cannot be, with the remedy.
pub fn check(flow: &Flow) -> Result<(), String> {
    let named = |what: &str| {
        Err(format!("[solver.openfoam] adjoint: OpenFOAM's is of viscous incompressible flow, and {what}"))
    };
    if flow.reynolds.is_none() {
        return named("this has no reynolds: give one, or leave adjoint out");
    }
    if flow.mach > SLOW {
        return named(&format!("mach is {}: give {SLOW} at most, or leave adjoint out", flow.mach));
    }
    if !flow.inflow.is_empty() || !flow.outflow.is_empty() {
        return named("inflow and outflow are supersonic: put their surfaces in farfield, or leave adjoint out");
    }
    if flow.walls.is_empty() {
        return named("a force needs walls: name them");
    }
    Ok(())
}

/// Writes a field of the adjoint to begin with, of cells; zero without.
///
/// # Errors
/// When it cannot be written.
pub fn begin(
    case: &Path,
    cells: usize,
    patches: &[(String, Kind)],
    (name, kind): (&str, FieldKind),
    values: Option<Vec<f64>>,
) -> Result<(), String> {
    let values = values.unwrap_or_else(|| vec![0.0; kind.values()]);
    write(&folder(case).join("0").join(name), cells, patches, CellField { kind, values }, |of| {
        let zero = if kind == FieldKind::Vector { "(0 0 0)" } else { "0" };
        match (of, kind) {
            (Kind::Symmetry, _) => "type symmetry;".into(),
            (Kind::Wall, FieldKind::Vector) => format!("type adjointWallVelocity; value uniform {zero};"),
            (Kind::Wall, _) => "type zeroGradient;".into(),
            (_, FieldKind::Vector) => format!("type adjointFarFieldVelocity; value uniform {zero};"),
            _ => format!("type adjointFarFieldPressure; value uniform {zero};"),
        }
    })
}

/// Solves it, begun with the flow in a folder of the case; `tell` is given a line. The iterations that were made, of the flow and its adjoint.
///
/// # Errors
/// When a file cannot be read or written, or it blows up however small the relaxation is: with the last lines of its log.
pub fn run(
    case: &Path,
    (flow, plan): (&Flow, &Plan),
    (time, cells): (&Path, usize),
    stop: &AtomicBool,
    tell: &mut dyn FnMut(&str),
) -> Result<usize, String> {
    let (folder, density) = (folder(case), flow.density());
    let incompressible = |name: &str, kind, scaled: &dyn Fn(f64) -> f64| {
        let values = super::state::field(time, name, cells)?.into_iter().map(scaled).collect();
        let outside = match kind {
            FieldKind::Vector => flow.entries("U", Kind::Farfield),
            _ => "type freestreamPressure; freestreamValue uniform 0; value uniform 0;".into(),
        };
        write(&folder.join("0").join(name), cells, &plan.patches, CellField { kind, values }, |of| match of {
            Kind::Farfield => outside.clone(),
            of => flow.entries(name, of),
        })
    };
    incompressible("U", FieldKind::Vector, &|u| u)?;
    incompressible("p", FieldKind::Scalar, &|p| (p - flow.pressure) / density)?;
    link_mesh(case, &folder)?;
    for trial in 0.. {
        let relaxation = plan.relaxation * 0.5f64.powi(trial);
        dictionaries::write(&folder, flow, plan, relaxation)?;
        match solve(&folder, &plan.program, &folder.join("log"), stop) {
            Ok(()) => break,
            Err(Failure::Stopped(error)) => return Err(error),
            Err(Failure::BlewUp(error)) if trial == TRIALS => {
                return Err(format!("however small the relaxation, {error}"));
            }
            Err(Failure::BlewUp(_)) => {
                tell(&format!("adjoint     blew up at relaxation {relaxation}: again with half of that"))
            }
        }
        while let Some(left) = foam::newest_time(&folder).filter(|left| *left != folder.join("0")) {
            std::fs::remove_dir_all(&left).map_err(|error| format!("{}: {error}", left.display()))?;
        }
    }
    let made = last_time(&folder)?;
    let iterations = made.file_name().and_then(|name| name.to_str()?.parse().ok()).unwrap_or(0);
    tell(&format!("adjoint     of {:?} after {iterations} iterations", plan.force));
    Ok(iterations)
}

/// The folder of the fields that it has left.
///
/// # Errors
/// When there is none.
pub fn fields(case: &Path) -> Result<PathBuf, String> {
    last_time(&folder(case))
}

/// Writes a vector, which is a velocity, or a pressure over the density, of cells, with what holds at each patch.
fn write(
    path: &Path,
    cells: usize,
    patches: &[(String, Kind)],
    field: CellField,
    entry: impl Fn(Kind) -> String,
) -> Result<(), String> {
    let folder = path.parent().unwrap_or(path);
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let entries: Vec<_> = patches.iter().map(|(patch, kind)| (patch.clone(), entry(*kind))).collect();
    let dimensions = if field.kind == FieldKind::Vector { foam::VELOCITY } else { foam::KINEMATIC_PRESSURE };
    let written = foam::write_cell_field_of(path, &field, cells, &entries, false, dimensions);
    written.map_err(|error| error.to_string())
}

/// Gives the case the mesh of the flow's.
fn link_mesh(case: &Path, folder: &Path) -> Result<(), String> {
    let (from, to) = (case.join("constant/polyMesh"), folder.join("constant/polyMesh"));
    let named = |path: &Path, error: std::io::Error| format!("{}: {error}", path.display());
    std::fs::create_dir_all(&to).map_err(|error| named(&to, error))?;
    for file in std::fs::read_dir(&from).map_err(|error| named(&from, error))? {
        let file = file.map_err(|error| named(&from, error))?;
        let target = to.join(file.file_name());
        let _ = std::fs::remove_file(&target); // of an earlier run
        // Where two names of a file cannot be it is copied.
        if std::fs::hard_link(file.path(), &target).is_err() {
            std::fs::copy(file.path(), &target).map_err(|error| named(&target, error))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_it_does_not_solve_is_refused() {
        let check = |text: &str| super::check(&toml::from_str(text).unwrap());
        let good = "mach = 0.3\nreynolds = 4000.0\nwalls = ['a']\nfarfield = ['b']\n";
        assert_eq!(check(good), Ok(()));
        for (text, said) in [
            ("mach = 0.3\nwalls = ['a']", "give one, or leave adjoint out"),
            ("mach = 0.8\nreynolds = 10.0\nwalls = ['a']", "mach is 0.8: give 0.3 at most"),
            ("mach = 0.3\nreynolds = 10.0\nwalls = ['a']\ninflow = ['b']", "supersonic"),
            ("mach = 0.3\nreynolds = 10.0\nfarfield = ['a']", "needs walls"),
        ] {
            assert!(check(text).unwrap_err().contains(said), "{text}");
        }
    }

    #[test]
    fn a_force_is_lift_or_drag() {
        let flow: Flow = toml::from_str("mach = 0.3\nangle_of_attack = 90.0").unwrap();
        let near = |a: [f64; 3], b: [f64; 3]| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-12);
        assert!(near(Force::Drag.direction(&flow), [0.0, 0.0, 1.0]));
        assert!(near(Force::Lift.direction(&flow), [-1.0, 0.0, 0.0]));
    }
}
