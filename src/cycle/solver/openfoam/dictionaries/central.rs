//! What rhoCentralFoam reads.
use crate::cycle::solver::openfoam::method::{Scheme, Stage};

/// The fields that are taken to the faces: where some cells are marked, OpenFOAM asks for a blending factor of each.
pub const AT_FACES: [&str; 5] = ["rho", "rhoU", "rPsi", "e", "c"];

/// The name of the blending factor of a field: 1 at a face for the scheme, 0 for first order.
pub fn factor(field: &str) -> String {
    format!("{field}BlendingFactor")
}

/// Reads the blending factors before the first step, in `controlDict`.
pub fn factors() -> String {
    let names = AT_FACES.map(factor).join(" ");
    format!("functions {{ marks {{ type readFields; libs (\"libfieldFunctionObjects.so\"); fields ({names}); }} }}\n")
}

/// Its limits of the local time steps, in `controlDict`.
pub fn steps(stage: Stage) -> String {
    let Stage { courant, smoothing, .. } = stage;
    format!("maxCo {courant};\nmaxDeltaT 1e30;\nrDeltaTSmoothingCoeff {smoothing};\n")
}

/// `fvSchemes`; `marked`: of first order where the blending factors are 0.
pub fn schemes(scheme: Scheme, marked: bool) -> String {
    let name = match scheme {
        Scheme::Upwind => "upwind",
        Scheme::Minmod => "Minmod",
        // The configuration refuses the last here.
        Scheme::VanAlbada | Scheme::LinearUpwind => "vanAlbada",
        Scheme::VanLeer => "vanLeer",
    };
    let of_vectors = if scheme == Scheme::Upwind { "" } else { "V" };
    let (before, after) = if marked { ("localBlended ", " upwind") } else { ("", "") };
    format!(
        "fluxScheme Kurganov;\nddtSchemes {{ default localEuler; }}\ngradSchemes {{ default Gauss linear; }}\n\
         divSchemes {{ default none; div(tauMC) Gauss linear; }}\nlaplacianSchemes {{ default Gauss linear limited 0.5; }}\n\
         interpolationSchemes\n{{\n    default linear;\n    reconstruct(rho) {before}{name}{after};\n    \
         reconstruct(U) {before}{name}{of_vectors}{after};\n    reconstruct(T) {before}{name}{after};\n}}\nsnGradSchemes {{ default limited 0.5; }}\n"
    )
}

/// `fvSolution`.
pub fn solution() -> String {
    "solvers\n{\n    \"(rho|rhoU|rhoE)\" { solver diagonal; }\n    \
     \"(U|e|h)\" { solver smoothSolver; smoother GaussSeidel; nSweeps 2; tolerance 1e-12; relTol 0.01; }\n}\n"
        .into()
}
