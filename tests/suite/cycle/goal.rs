//! `geo-adapt cycle` with a [goal]: the adjoint of a program's own, the error of the functional, and the end by its estimate.
use crate::common::adapting::{complaint, stderr};
use crate::common::program;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Output;

/// A solver of the shell on a text mesh: u = sin 3x, whose adjoint is exp(-9 |p|²); the functional is 2 - 1/n, its estimate 0.8/n, n the vertices.
const SOLVE: &str = r#"
awk -v out="$2" -v told="$(dirname "$2")/told.json" '
    $1 == "Vertices" { getline; n = $1; print "MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n" n "\n1 1" > out
        for (i = 0; i < n; i++) { getline; print sin(3 * $1) + sin(3 * $2) > out }
        print "End" > out; printf "{\"J\": %.12f, \"J estimate\": %.12f}\n", 2 - 1 / n, 0.8 / n > told; exit }' "$1"
"#;
const ADJOINT: &str = r#"
test -s "$2" || exit 9
awk -v out="$3" '
    $1 == "Vertices" { getline; n = $1; print "MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n" n "\n1 1" > out
        for (i = 0; i < n; i++) { getline; print exp(-9 * ($1 * $1 + $2 * $2 + $3 * $3)) > out } print "End" > out; exit }' "$1"
"#;

const CONFIG: &str = r#"
threads = 1
[mesh]
cube = 4
[solver.command]
run = "sh {config}/solve.sh {mesh} {solution_out}"
mesh = "mesh.mesh"
solution_out = "out.sol"
fields = ["u"]
functionals = "told.json"
adjoint = "sh {config}/adjoint.sh {mesh} {solution_out} {adjoint_out}"
adjoint_out = "adjoint.sol"
adjoint_fields = ["lambda"]
[goal]
functional = "J"
estimate = "J estimate"
reference = 2.0
terms = [{ field = "u", adjoint = "lambda", derivatives = { x = 1.0, y = 1.0, zz = 0.1 } }]
[metric]
[schedule]
complexity = 200
cycles = 6
until = "error(J) < 1e-3"
[output]
folder = "out"
pictures = false
"#;

struct Place(tempfile::TempDir);

impl Place {
    fn new(config: &str) -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        for (name, text) in [("loop.toml", config), ("solve.sh", SOLVE), ("adjoint.sh", ADJOINT)] {
            std::fs::write(place.path(name), text).unwrap();
        }
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, words: &[&str]) -> Output {
        program().arg("cycle").arg(self.path("loop.toml")).args(words).output().unwrap()
    }

    fn refusal(&self) -> String {
        complaint(&self.run(&[]))
    }
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn the_loop_makes_the_mesh_of_the_goal_and_ends_by_its_estimate() {
    let place = Place::new(CONFIG);
    let run = place.run(&[]);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    let report: Value = serde_json::from_str(&read(&place.path("out/report.json"))).unwrap();
    let cycles = report["cycles"].as_array().unwrap();
    let last = &cycles[cycles.len() - 1];
    let told = |name: &str| last["functionals"][name].as_f64().unwrap();
    assert!((told("J effectivity") - 0.8).abs() < 1e-6 && told("J estimate") < 1e-3, "{last}");
    assert!((told("J error") * last["vertices"].as_f64().unwrap() - 1.0).abs() < 1e-6);
    assert!(cycles.len() < 7, "{}", cycles.len());
    assert!(report["ended"].as_str().unwrap().starts_with("the error in J is estimated as"), "{}", report["ended"]);
    let page = read(&place.path("out/report.html"));
    assert!(page.contains("J effectivity") && page.contains("J error"));
    // Each step can be typed again.
    let step = place.path("out/cycle-01");
    assert!(read(&step.join("adapt/command.txt")).contains("--goal"));
    let terms = read(&step.join("metric/terms.toml"));
    assert!(terms.contains("component = 2") && terms.contains("zz = 0.1"), "{terms}");
    // The goal lies at the origin.
    let mesh = geo_adapt::mesh::io::read_mesh(&place.path("out/cycle-01/adapt/mesh.meshb")).unwrap().content;
    let near = mesh.vertices.iter().filter(|p| p.iter().all(|&x| x < 0.5)).count();
    assert!(10 * near > 3 * mesh.vertices.len(), "{near} of {}", mesh.vertices.len());

    // Another end may be asked for at any time; other terms may not.
    std::fs::write(place.path("loop.toml"), CONFIG.replace("< 1e-3", "< 1e-2")).unwrap();
    assert_eq!(place.run(&["--dry-run"]).status.code(), Some(0));
    std::fs::write(place.path("loop.toml"), CONFIG.replace("zz = 0.1", "zz = 0.2")).unwrap();
    assert!(place.refusal().contains("goal.terms"));
}

#[test]
fn a_goal_that_cannot_be_is_refused() {
    for (from, to, said) in [
        ("functional = \"J\"", "functional = \"K\"", "[schedule] until: the goal is K, not J"),
        ("estimate = \"J estimate\"\n", "", "[schedule] until needs an estimate"),
        ("reference = 2.0", "reference = inf", "[goal] reference: give a finite number"),
        ("zz = 0.1", "zw = 0.1", "[goal] terms, 1: 'zw' is no derivative"),
        ("[metric]", "[metric]\nfields = [\"u\"]", "[metric] fields: the metric is that of the [goal]"),
        ("error(J) < 1e-3", "J < 1e-3", "error(NAME) < NUMBER"),
        ("{adjoint_out}\"", "{adjoint}\"", "[solver.command] adjoint: {adjoint} is not known"),
        ("adjoint_out = \"adjoint.sol\"", "adjoint_out = \"adjoint.xyz\"", "adjoint.xyz"),
    ] {
        let refused = Place::new(&CONFIG.replace(from, to)).refusal();
        assert!(refused.contains(said), "{to}: {refused}");
    }
    // What only a solve tells.
    let refused = Place::new(&CONFIG.replace("\"J estimate\"", "\"guess\"")).refusal();
    assert!(refused.contains("[goal] estimate: the solver tells no 'guess'; it tells J, J estimate"), "{refused}");
    let run = Place::new(&CONFIG.replace("adjoint = \"lambda\"", "adjoint = \"mu\"")).run(&["--quiet"]);
    let refused = stderr(&run);
    assert_eq!(run.status.code(), Some(2), "{refused}");
    assert!(refused.contains("[goal] terms, 1: the solver has no field 'mu'; there are u, lambda"), "{refused}");
}
