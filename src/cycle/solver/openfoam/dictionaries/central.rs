//! What rhoCentralFoam reads.
use crate::cycle::solver::openfoam::method::{Scheme, Stage};

/// Its limits of the local time steps, in `controlDict`.
pub fn steps(stage: Stage) -> String {
    let Stage { courant, smoothing, .. } = stage;
    format!("maxCo {courant};\nmaxDeltaT 1e30;\nrDeltaTSmoothingCoeff {smoothing};\n")
}

/// `fvSchemes`.
pub fn schemes(scheme: Scheme) -> String {
    let name = match scheme {
        Scheme::Upwind => "upwind",
        Scheme::Minmod => "Minmod",
        // The configuration refuses the last here.
        Scheme::VanAlbada | Scheme::LinearUpwind => "vanAlbada",
        Scheme::VanLeer => "vanLeer",
    };
    let of_vectors = if scheme == Scheme::Upwind { "" } else { "V" };
    format!(
        "fluxScheme Kurganov;\nddtSchemes {{ default localEuler; }}\ngradSchemes {{ default Gauss linear; }}\n\
         divSchemes {{ default none; div(tauMC) Gauss linear; }}\nlaplacianSchemes {{ default Gauss linear limited 0.5; }}\n\
         interpolationSchemes\n{{\n    default linear;\n    reconstruct(rho) {name};\n    reconstruct(U) {name}{of_vectors};\n    \
         reconstruct(T) {name};\n}}\nsnGradSchemes {{ default limited 0.5; }}\n"
    )
}

/// `fvSolution`.
pub fn solution() -> String {
    "solvers\n{\n    \"(rho|rhoU|rhoE)\" { solver diagonal; }\n    \
     \"(U|e|h)\" { solver smoothSolver; smoother GaussSeidel; nSweeps 2; tolerance 1e-12; relTol 0.01; }\n}\n"
        .into()
}
