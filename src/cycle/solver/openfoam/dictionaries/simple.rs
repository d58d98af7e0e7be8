//! What rhoSimpleFoam reads.
use crate::cycle::solver::openfoam::flow::Flow;
use crate::cycle::solver::openfoam::method::{Scheme, Stage};

/// `fvSchemes`. Faces of stretched tetrahedra lie askew of the lines between centroids, most by more than 60°, so that most of a gradient
/// across them is the explicit correction. That of the velocity is whole: held to what is implicit (`limited 0.5`) friction was 3 % too small
/// on the delta wing and the lift 3 % too large, whatever the mesh. Those of pressure and heat are held: whole they blow up, and they
/// matter little, the first since it acts against the checkerboard alone, the second since the temperature hardly varies.
pub fn schemes(scheme: Scheme) -> String {
    let (of_vectors, of_scalars) = match scheme {
        Scheme::Upwind => ("upwind", "upwind"),
        Scheme::Minmod => ("MinmodV", "Minmod"),
        Scheme::VanAlbada => ("vanAlbadaV", "vanAlbada"),
        Scheme::VanLeer => ("vanLeerV", "vanLeer"),
        Scheme::LinearUpwind => ("linearUpwind grad(U)", "linearUpwind grad(h)"),
    };
    format!(
        "ddtSchemes {{ default steadyState; }}\ngradSchemes\n{{\n    default Gauss linear;\n    \
         grad(U) cellLimited Gauss linear 1;\n    grad(h) cellLimited Gauss linear 1;\n}}\n\
         divSchemes\n{{\n    default none;\n    div(phi,U) bounded Gauss {of_vectors};\n    \
         div(phi,h) bounded Gauss {of_scalars};\n    div(phi,K) bounded Gauss linear;\n    \
         div(((rho*nuEff)*dev2(T(grad(U))))) Gauss linear;\n}}\n\
         laplacianSchemes\n{{\n    default Gauss linear limited 0.5;\n    \"laplacian\\(.*,U\\)\" Gauss linear corrected;\n}}\n\
         interpolationSchemes {{ default linear; }}\n\
         snGradSchemes {{ default limited 0.5; }}\n"
    )
}

/// `fvSolution`. The limits of pressure and density are far from what a flow without shocks has; they hold the first iterations.
pub fn solution(flow: &Flow, stage: Stage) -> String {
    let (least, greatest) = (0.1 * flow.pressure, 10.0 * flow.pressure);
    let (of_pressure, relaxation, outside) = (stage.of_pressure(), stage.relaxation, flow.pressure);
    format!(
        "solvers\n{{\n    p {{ solver PCG; preconditioner DIC; tolerance 1e-12; relTol 0.05; minIter 1; maxIter 200; }}\n    \
         \"(U|h)\" {{ solver smoothSolver; smoother symGaussSeidel; tolerance 1e-12; relTol 0.1; minIter 1; maxIter 20; }}\n}}\n\
         SIMPLE\n{{\n    consistent no;\n    transonic no;\n    nNonOrthogonalCorrectors 0;\n    pMin {least:?};\n    \
         pMax {greatest:?};\n    pRefCell 0;\n    pRefValue {outside:?};\n}}\n\
         relaxationFactors\n{{\n    fields {{ p {of_pressure}; rho 1; }}\n    equations {{ U {relaxation}; h {relaxation}; }}\n}}\n"
    )
}

/// `fvOptions`: bounds of the temperature, half the least and twice the greatest that an adiabatic or isothermal flow has. The first
/// iterations of a solve, far from any flow, would go below zero.
pub fn options(flow: &Flow) -> String {
    let wall = flow.wall_temperature.unwrap_or(flow.temperature);
    let stagnation = flow.temperature * (1.0 + 0.5 * (flow.gamma - 1.0) * flow.mach * flow.mach);
    let (least, greatest) = (0.5 * flow.temperature.min(wall), 2.0 * stagnation.max(wall));
    format!("limit {{ type limitTemperature; active yes; selectionMode all; min {least:?}; max {greatest:?}; }}\n")
}
