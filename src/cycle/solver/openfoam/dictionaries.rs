//! The dictionaries of rhoCentralFoam (OpenFOAM v1912).
use super::flow::Flow;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// How values at the faces are found from those of the cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scheme {
    /// First order.
    Upwind,
    /// The most careful of second order.
    Minmod,
    /// Between the others: what lasts on stretched tetrahedra.
    #[default]
    VanAlbada,
    /// The sharpest.
    VanLeer,
}

/// Steps with the same settings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// How values at the faces are found.
    pub scheme: Scheme,
    /// Greatest Courant number of the local time steps.
    pub courant: f64,
    /// Greatest growth of the local time step from a cell to the next, less 1.
    pub smoothing: f64,
}

fn write(case: &Path, folder: &str, name: &str, body: &str) -> Result<(), String> {
    let path = case.join(folder).join(name);
    let named = |error: std::io::Error| format!("{}: {error}", path.display());
    std::fs::create_dir_all(case.join(folder)).map_err(named)?;
    let head =
        format!("FoamFile {{ version 2.0; format ascii; class dictionary; location \"{folder}\"; object {name}; }}\n");
    std::fs::write(&path, head + body).map_err(named)
}

/// What does not change in a solve: gas and solvers of linear systems.
pub fn write_constant(case: &Path, flow: &Flow) -> Result<(), String> {
    let heat = flow.gamma * flow.r() / (flow.gamma - 1.0);
    // J/(kmol K), the value that OpenFOAM divides by.
    let weight = 8_314.462_618 / flow.r();
    let gas = format!(
        "thermoType\n{{\n    type hePsiThermo;\n    mixture pureMixture;\n    transport const;\n    thermo hConst;\n    \
         equationOfState perfectGas;\n    specie specie;\n    energy sensibleInternalEnergy;\n}}\n\
         mixture\n{{\n    specie {{ molWeight {weight:.12}; }}\n    thermodynamics {{ Cp {heat:.12}; Hf 0; }}\n    \
         transport {{ mu {:?}; Pr {:?}; }}\n}}\n",
        flow.viscosity(),
        flow.prandtl
    );
    write(case, "constant", "thermophysicalProperties", &gas)?;
    write(case, "constant", "turbulenceProperties", "simulationType laminar;\n")?;
    let solution = "solvers\n{\n    \"(rho|rhoU|rhoE)\" { solver diagonal; }\n    \
        \"(U|e|h)\" { solver smoothSolver; smoother GaussSeidel; nSweeps 2; tolerance 1e-12; relTol 0.01; }\n}\n";
    write(case, "system", "fvSolution", solution)
}

/// What is done from step `start` to step `end`, where it is written.
pub fn write_stage(case: &Path, stage: Stage, start: usize, end: usize) -> Result<(), String> {
    let Stage { scheme, courant, smoothing } = stage;
    let interval = end - start;
    let control = format!(
        "application rhoCentralFoam;\nstartFrom startTime;\nstartTime {start};\nstopAt endTime;\nendTime {end};\ndeltaT 1;\n\
         adjustTimeStep no;\nwriteControl runTime;\nwriteInterval {interval};\npurgeWrite 0;\nwriteFormat binary;\nwritePrecision 12;\n\
         writeCompression off;\ntimeFormat general;\ntimePrecision 12;\nrunTimeModifiable no;\n\
         maxCo {courant};\nmaxDeltaT 1e30;\nrDeltaTSmoothingCoeff {smoothing};\n"
    );
    write(case, "system", "controlDict", &control)?;
    let name = match scheme {
        Scheme::Upwind => "upwind",
        Scheme::Minmod => "Minmod",
        Scheme::VanAlbada => "vanAlbada",
        Scheme::VanLeer => "vanLeer",
    };
    let of_vectors = if scheme == Scheme::Upwind { "" } else { "V" };
    let schemes = format!(
        "fluxScheme Kurganov;\nddtSchemes {{ default localEuler; }}\ngradSchemes {{ default Gauss linear; }}\n\
         divSchemes {{ default none; div(tauMC) Gauss linear; }}\nlaplacianSchemes {{ default Gauss linear limited 0.5; }}\n\
         interpolationSchemes\n{{\n    default linear;\n    reconstruct(rho) {name};\n    reconstruct(U) {name}{of_vectors};\n    \
         reconstruct(T) {name};\n}}\nsnGradSchemes {{ default limited 0.5; }}\n"
    );
    write(case, "system", "fvSchemes", &schemes)
}
