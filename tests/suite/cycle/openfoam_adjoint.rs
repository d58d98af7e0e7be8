//! The adjoint of OpenFOAM, where it is installed: a loop whose mesh is made for the drag of a plate.
use crate::common::adapting::{complaint, stderr};
use crate::common::program;
use geo_adapt::cycle::launch::find_program;
use geo_adapt::mesh::io::{read_mesh, read_solution};
use serde_json::Value;
use std::path::Path;
use std::process::Output;

/// A flow over the side z = 0 of the unit cube.
const CONFIG: &str = r#"
threads = 1
[mesh]
cube = 5
[solver.openfoam]
steps = 300
adjoint = "CD"
[solver.openfoam.flow]
mach = 0.2
reynolds = 50
length = 1
area = 0.5
walls = ["5"]
symmetry = ["3", "4"]
farfield = ["1", "2", "6"]
[goal]
functional = "CD"
[metric]
[schedule]
complexity = 150
cycles = 1
[output]
folder = "out"
pictures = false
"#;

fn run(folder: &Path, config: &str) -> Output {
    std::fs::write(folder.join("loop.toml"), config).unwrap();
    program().arg("cycle").arg(folder.join("loop.toml")).output().unwrap()
}

/// Whether the programs are there; says so where they are not, and fails where they were set up.
fn is_installed() -> bool {
    let names = ["rhoSimpleFoam", "adjointOptimisationFoam"];
    let Some(missing) = names.iter().find(|name| find_program(name, Path::new("/")).is_none()) else { return true };
    let set_up = std::env::var_os("GEO_ADAPT_OPENFOAM").is_some();
    assert!(!set_up, "OpenFOAM was set up, but {missing} is not on the PATH");
    eprintln!("skipped: {missing} is not there (Debian's package openfoam)");
    false
}

#[test]
fn the_mesh_is_made_for_the_drag() {
    if !is_installed() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let ran = run(folder.path(), CONFIG);
    assert!(ran.status.success(), "{}", stderr(&ran));
    let path = |name: &str| folder.path().join("out").join(name);
    let text = |name: &str| std::fs::read_to_string(path(name)).unwrap();
    // The fields of the flow, and those of its adjoint.
    let done: Value = serde_json::from_str(&text("cycle-01/solve/done.json")).unwrap();
    let names: Vec<&str> =
        done["result"]["fields"].as_array().unwrap().iter().map(|field| field["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["p", "T", "U", "rho", "Mach", "Ua", "pa"]);
    assert!(done["result"]["functionals"]["adjoint steps"].as_f64().unwrap() > 20.0, "{done}");
    // At the wall the adjoint of a force has its direction, in the units of the coefficient: here against x, 1 / (½ U² A) with ρ left out.
    let mesh = read_mesh(&path("start/mesh.meshb")).unwrap().content;
    let solution = read_solution(&path("cycle-01/solve/solution.solb")).unwrap().content;
    let adjoint = &solution.fields[5].values;
    let at = |p: [f64; 3]| mesh.vertices.iter().position(|&q| q == p).unwrap();
    let wall = at([0.4, 0.4, 0.0]);
    let unit = 1.0 / (0.5 * 0.2 * 0.2 * 0.5);
    let [x, y, z]: [f64; 3] = adjoint[3 * wall..][..3].try_into().unwrap();
    // What stands there is of the cells about it.
    assert!((-1.1 * unit..-0.5 * unit).contains(&x) && y.abs() + z.abs() < 0.3 * unit, "{x} {y} {z} for {unit}");
    let far = at([0.4, 0.4, 1.0]);
    assert!(adjoint[3 * far].abs() < 0.3 * x.abs(), "{} {x}", adjoint[3 * far]);
    // The terms are those of the solver's flow, and the next mesh is fine at the plate.
    let terms = text("cycle-01/metric/terms.toml");
    assert!(terms.contains("incompressible") && terms.contains("density = 1.4"), "{terms}");
    let mesh = read_mesh(&path("cycle-01/adapt/mesh.meshb")).unwrap().content;
    let near = mesh.vertices.iter().filter(|p| p[2] < 0.4).count() as f64 / mesh.vertices.len() as f64;
    assert!(near > 0.5, "{near}");
    // The next solve begins with it.
    let begun = std::fs::read(path("cycle-02/solve/case/adjoint/0/Ua")).unwrap();
    assert!(String::from_utf8_lossy(&begun).contains("nonuniform"));
}

#[test]
fn an_adjoint_that_openfoam_has_not_is_refused() {
    if !is_installed() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let refusal = |from: &str, to: &str| complaint(&run(folder.path(), &CONFIG.replace(from, to)));
    assert!(refusal("mach = 0.2", "mach = 0.5").contains("mach is 0.5: give 0.3 at most"));
    assert!(refusal("adjoint = \"CD\"\n", "").contains("[goal] has neither terms nor flow"));
    assert!(refusal("adjoint = \"CD\"", "adjoint = \"CM\"").contains("CL"));
    let named =
        refusal("functional = \"CD\"", "functional = \"CD\"\nflow = { primal = [\"V\"], adjoint = [\"Ua\", \"pa\"] }");
    assert!(named.contains("[goal] flow") && named.contains("no field 'V'"), "{named}");
}
