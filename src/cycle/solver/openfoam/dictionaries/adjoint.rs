//! What adjointOptimisationFoam reads.
use super::write as write_dictionary;
use crate::cycle::solver::openfoam::adjoint::Plan;
use crate::cycle::solver::openfoam::flow::{Flow, Kind};
use crate::cycle::solver::openfoam::method::{OF_PRESSURE, Scheme};
use std::path::Path;

/// The residual at which the flow and its adjoint end.
const RESIDUAL: f64 = 1e-5;

/// All of a case but its mesh and its fields.
pub fn write(folder: &Path, flow: &Flow, plan: &Plan, relaxation: f64) -> Result<(), String> {
    let viscosity = flow.viscosity() / flow.density();
    let fluid = format!("transportModel Newtonian;\nnu [0 2 -1 0 0 0 0] {viscosity:?};\n");
    write_dictionary(folder, "constant", "transportProperties", &fluid)?;
    write_dictionary(folder, "constant", "turbulenceProperties", "simulationType laminar;\n")?;
    let adjoint = "adjointRASModel adjointLaminar;\nadjointTurbulence on;\nprintCoeffs off;\n";
    write_dictionary(folder, "constant", "adjointRASProperties", adjoint)?;
    write_dictionary(folder, "system", "controlDict", &control(2 * plan.iterations))?;
    write_dictionary(folder, "system", "fvSchemes", &schemes(plan.scheme))?;
    write_dictionary(folder, "system", "fvSolution", &solution(relaxation))?;
    write_dictionary(folder, "system", "optimisationDict", &optimisation(flow, plan))
}

/// `controlDict`: what is written at the end is all that is kept.
fn control(end: usize) -> String {
    format!(
        "application adjointOptimisationFoam;\nstartFrom startTime;\nstartTime 0;\nstopAt endTime;\nendTime {end};\ndeltaT 1;\n\
         writeControl timeStep;\nwriteInterval {end};\npurgeWrite 1;\nwriteFormat binary;\nwritePrecision 12;\nwriteCompression off;\n\
         timeFormat general;\ntimePrecision 12;\nrunTimeModifiable no;\n"
    )
}

/// `fvSchemes`, as those of rhoSimpleFoam (`simple`).
fn schemes(scheme: Scheme) -> String {
    let of = |field: &str| match scheme {
        Scheme::Upwind => "upwind".into(),
        Scheme::Minmod => "MinmodV".into(),
        Scheme::VanAlbada => "vanAlbadaV".into(),
        Scheme::VanLeer => "vanLeerV".into(),
        Scheme::LinearUpwind => format!("linearUpwind grad{field}Conv"),
    };
    let (of_flow, of_adjoint) = (of("U"), of("Ua"));
    format!(
        "ddtSchemes {{ default steadyState; }}\ngradSchemes\n{{\n    default Gauss linear;\n    gradUConv cellLimited Gauss linear 1;\n    \
         gradUaConv cellLimited Gauss linear 1;\n}}\ndivSchemes\n{{\n    default Gauss linear;\n    div(phi,U) bounded Gauss {of_flow};\n    \
         div(-phi,Ua) bounded Gauss {of_adjoint};\n}}\nlaplacianSchemes\n{{\n    default Gauss linear limited 0.5;\n    \
         \"laplacian\\(.*,Ua?\\)\" Gauss linear corrected;\n}}\ninterpolationSchemes {{ default linear; }}\n\
         snGradSchemes {{ default limited 0.5; }}\n"
    )
}

/// `fvSolution`.
fn solution(relaxation: f64) -> String {
    let of_pressure = OF_PRESSURE * relaxation;
    format!(
        "solvers\n{{\n    \"pa?\" {{ solver PCG; preconditioner DIC; tolerance 1e-12; relTol 0.05; minIter 1; maxIter 200; }}\n    \
         \"Ua?\" {{ solver smoothSolver; smoother symGaussSeidel; tolerance 1e-12; relTol 0.1; minIter 1; maxIter 20; }}\n}}\n\
         SIMPLE {{ consistent no; nNonOrthogonalCorrectors 0; }}\n\
         relaxationFactors\n{{\n    fields {{ p {of_pressure}; pa {of_pressure}; }}\n    equations {{ U {relaxation}; Ua {relaxation}; }}\n}}\n"
    )
}

/// `optimisationDict`: one flow, one force, no optimisation.
fn optimisation(flow: &Flow, plan: &Plan) -> String {
    let walls: Vec<&str> =
        plan.patches.iter().filter(|(_, kind)| *kind == Kind::Wall).map(|(name, _)| name.as_str()).collect();
    let walls = walls.join(" ");
    let [x, y, z] = plan.force.direction(flow);
    let (area, density, iterations) = (flow.area.unwrap_or(1.0), flow.density(), plan.iterations);
    let speed = flow.mach * flow.sound();
    format!(
        "optimisationManager singleRun;\nprimalSolvers\n{{\n    flow\n    {{\n        active true;\n        type incompressible;\n        solver simple;\n        \
         useSolverNameForFields false;\n        solutionControls {{ nIters {iterations}; residualControl {{ p {RESIDUAL:e}; U {RESIDUAL:e}; }} }}\n    \
         }}\n}}\nadjointManagers\n{{\n    manager\n    {{\n        primalSolver flow;\n        operatingPointWeight 1;\n        adjointSolvers\n        \
         {{\n            adjoint\n            {{\n                active true;\n                type incompressible;\n                solver adjointSimple;\n                \
         useSolverNameForFields false;\n                computeSensitivities false;\n                objectives\n                {{\n                    \
         type incompressible;\n                    objectiveNames\n                    {{\n                        force\n                        {{\n                            \
         weight 1;\n                            type force;\n                            patches ({walls});\n                            \
         direction ({x:?} {y:?} {z:?});\n                            Aref {area:?};\n                            rhoInf {density:?};\n                            \
         UInf {speed:?};\n                        }}\n                    }}\n                }}\n                \
         ATCModel {{ ATCModel standard; extraConvection 0; nSmooth 0; zeroATCPatchTypes (); maskType faceCells; }}\n                \
         solutionControls {{ nIters {iterations}; residualControl {{ pa {RESIDUAL:e}; Ua {RESIDUAL:e}; }} }}\n            }}\n        }}\n    }}\n}}\n\
         optimisation {{ sensitivities {{ type surfacePoints; patches ({walls}); }} }}\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cycle::solver::openfoam::adjoint::Force;
    use crate::cycle::solver::openfoam::programs::Program;

    #[test]
    fn the_force_is_that_of_the_flow_at_constant_density() {
        let folder = tempfile::tempdir().unwrap();
        let flow: Flow = toml::from_str("mach = 0.3\nreynolds = 4000.0\narea = 0.25").unwrap();
        let patches = [("far", Kind::Farfield), ("up", Kind::Wall), ("side", Kind::Symmetry), ("down", Kind::Wall)];
        let plan = Plan {
            force: Force::Drag,
            program: Program { path: "adjointOptimisationFoam".into(), processes: 1 },
            patches: patches.map(|(name, kind)| (name.into(), kind)).into(),
            iterations: 700,
            scheme: Scheme::LinearUpwind,
            relaxation: 0.7,
        };
        write(folder.path(), &flow, &plan, 0.35).unwrap();
        let words = |name: &str| {
            let text = std::fs::read_to_string(folder.path().join(name)).unwrap();
            text.split_whitespace().collect::<Vec<_>>().join(" ")
        };
        // ν = U L / Re.
        let fluid = words("constant/transportProperties");
        let nu: f64 = fluid.rsplit_once("] ").unwrap().1.trim_end_matches(';').parse().unwrap();
        assert!((nu - 7.5e-5).abs() < 1e-18, "{fluid}");
        let text = words("system/optimisationDict");
        for part in [
            "patches (up down); direction (1.0 0.0 0.0);",
            "Aref 0.25;",
            "UInf 0.3",
            "nIters 700; residualControl { pa 1e-5;",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        assert!(words("system/controlDict").contains("endTime 1400;"));
        assert!(words("system/fvSolution").contains("equations { U 0.35; Ua 0.35; }"));
        assert!(words("system/fvSchemes").contains("div(-phi,Ua) bounded Gauss linearUpwind gradUaConv;"));
    }
}
