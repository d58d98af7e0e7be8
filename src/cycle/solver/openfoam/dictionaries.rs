//! The dictionaries of a case (OpenFOAM v1912): what both programs read here, of each its own in `central` and `simple`.
pub mod adjoint;
pub mod central;
mod simple;

use super::flow::Flow;
use super::method::{Method, Stage};
use std::path::Path;

fn write(case: &Path, folder: &str, name: &str, body: &str) -> Result<(), String> {
    let path = case.join(folder).join(name);
    let named = |error: std::io::Error| format!("{}: {error}", path.display());
    std::fs::create_dir_all(case.join(folder)).map_err(named)?;
    let head =
        format!("FoamFile {{ version 2.0; format ascii; class dictionary; location \"{folder}\"; object {name}; }}\n");
    std::fs::write(&path, head + body).map_err(named)
}

/// What does not change in a solve: the gas, of constant viscosity and Prandtl number.
pub fn write_constant(case: &Path, flow: &Flow, method: Method) -> Result<(), String> {
    let heat = flow.gamma * flow.r() / (flow.gamma - 1.0);
    // J/(kmol K), the value that OpenFOAM divides by.
    let weight = 8_314.462_618 / flow.r();
    let energy = match method {
        Method::Central => "sensibleInternalEnergy",
        Method::Simple => "sensibleEnthalpy",
    };
    let gas = format!(
        "thermoType\n{{\n    type hePsiThermo;\n    mixture pureMixture;\n    transport const;\n    thermo hConst;\n    \
         equationOfState perfectGas;\n    specie specie;\n    energy {energy};\n}}\n\
         mixture\n{{\n    specie {{ molWeight {weight:.12}; }}\n    thermodynamics {{ Cp {heat:.12}; Hf 0; }}\n    \
         transport {{ mu {:?}; Pr {:?}; }}\n}}\n",
        flow.viscosity(),
        flow.prandtl
    );
    write(case, "constant", "thermophysicalProperties", &gas)?;
    if method == Method::Simple {
        write(case, "constant", "fvOptions", &simple::options(flow))?;
    }
    write(case, "constant", "turbulenceProperties", "simulationType laminar;\n")
}

/// Steps that a program makes at once.
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    /// The first one's number, less 1: that of the folder it begins with.
    pub start: usize,
    /// The last one's; its fields are written.
    pub end: usize,
    /// Whether the fields of each are written, and only the last ones kept: to see where it blows up.
    pub watched: bool,
    /// Whether some cells are solved to first order, of `central`.
    pub marked: bool,
}

/// What is done in some steps.
pub fn write_stage(case: &Path, flow: &Flow, stage: Stage, steps: Steps) -> Result<(), String> {
    let Steps { start, end, watched, marked } = steps;
    let program = stage.method.program();
    let (interval, kept) = if watched { (1, 1) } else { (end - start, 0) };
    let control = format!(
        "application {program};\nstartFrom startTime;\nstartTime {start};\nstopAt endTime;\nendTime {end};\ndeltaT 1;\n\
         adjustTimeStep no;\nwriteControl runTime;\nwriteInterval {interval};\npurgeWrite {kept};\nwriteFormat binary;\nwritePrecision 12;\n\
         writeCompression off;\ntimeFormat general;\ntimePrecision 12;\nrunTimeModifiable no;\n"
    );
    let (control, schemes, solution) = match stage.method {
        Method::Central => {
            let factors = if marked { central::factors() } else { String::new() };
            (control + &central::steps(stage) + &factors, central::schemes(stage.scheme, marked), central::solution())
        }
        Method::Simple => (control, simple::schemes(stage.scheme), simple::solution(flow, stage)),
    };
    write(case, "system", "controlDict", &control)?;
    write(case, "system", "fvSchemes", &schemes)?;
    write(case, "system", "fvSolution", &solution)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cycle::solver::openfoam::method::Scheme;

    /// The words of a dictionary as they stand in a folder, one space between two.
    fn words(case: &Path, name: &str) -> String {
        let text = std::fs::read_to_string(case.join(name)).unwrap();
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn the_gas_has_the_viscosity_of_the_reynolds_number() {
        let folder = tempfile::tempdir().unwrap();
        let flow: Flow = toml::from_str("mach = 0.3\nreynolds = 4000.0\nlength = 2.0\nprandtl = 0.71").unwrap();
        write_constant(folder.path(), &flow, Method::Simple).unwrap();
        let gas = words(folder.path(), "constant/thermophysicalProperties");
        // μ = ρ U L / Re = 1.4 · 0.3 · 2 / 4000.
        let of = |name: &str| -> f64 {
            let rest = gas.split_once(&format!("{name} ")).unwrap().1;
            rest.split(';').next().unwrap().parse().unwrap()
        };
        assert!((of("mu") - 2.1e-4).abs() < 1e-16 && of("Pr") == 0.71 && (of("Cp") - 2.5).abs() < 1e-12, "{gas}");
        assert!(gas.contains("transport const;") && gas.contains("energy sensibleEnthalpy;"), "{gas}");
        assert!(words(folder.path(), "constant/fvOptions").contains("min 0.5; max 2.036;"));
        assert!(words(folder.path(), "constant/turbulenceProperties").ends_with("simulationType laminar;"));
        write_constant(folder.path(), &flow, Method::Central).unwrap();
        assert!(words(folder.path(), "constant/thermophysicalProperties").contains("energy sensibleInternalEnergy;"));
    }

    #[test]
    fn each_program_has_what_it_reads() {
        let folder = tempfile::tempdir().unwrap();
        let flow: Flow = toml::from_str("mach = 0.3\nreynolds = 4000.0").unwrap();
        let stage =
            |method: Method| Stage { method, scheme: method.scheme(), courant: 0.4, smoothing: 0.3, relaxation: 0.7 };
        let steps = |start, end| Steps { start, end, watched: false, marked: false };
        write_stage(folder.path(), &flow, stage(Method::Simple), steps(50, 100)).unwrap();
        let control = words(folder.path(), "system/controlDict");
        assert!(control.contains("application rhoSimpleFoam; startFrom startTime; startTime 50;"), "{control}");
        assert!(control.contains("endTime 100;") && control.contains("writeInterval 50;"), "{control}");
        let schemes = words(folder.path(), "system/fvSchemes");
        assert!(schemes.contains("default steadyState;"), "{schemes}");
        assert!(schemes.contains("div(phi,U) bounded Gauss linearUpwind grad(U);"), "{schemes}");
        assert!(schemes.contains(r#""laplacian\(.*,U\)" Gauss linear corrected;"#), "{schemes}");
        assert!(words(folder.path(), "system/fvSolution").contains("equations { U 0.7; h 0.7; }"));
        let first = Stage { scheme: Scheme::Upwind, ..stage(Method::Simple) };
        write_stage(folder.path(), &flow, first, steps(0, 50)).unwrap();
        assert!(words(folder.path(), "system/fvSchemes").contains("div(phi,U) bounded Gauss upwind;"));
        write_stage(folder.path(), &flow, stage(Method::Central), steps(0, 100)).unwrap();
        let control = words(folder.path(), "system/controlDict");
        assert!(control.contains("application rhoCentralFoam;") && control.contains("maxCo 0.4;"), "{control}");
        let schemes = words(folder.path(), "system/fvSchemes");
        assert!(schemes.contains("default localEuler;") && schemes.contains("reconstruct(U) vanAlbadaV;"), "{schemes}");
        let marked = Steps { watched: true, marked: true, ..steps(0, 100) };
        write_stage(folder.path(), &flow, stage(Method::Central), marked).unwrap();
        let control = words(folder.path(), "system/controlDict");
        assert!(
            control.contains("writeInterval 1; purgeWrite 1;") && control.contains("rhoUBlendingFactor"),
            "{control}"
        );
        let schemes = words(folder.path(), "system/fvSchemes");
        assert!(schemes.contains("reconstruct(U) localBlended vanAlbadaV upwind;"), "{schemes}");
    }
}
