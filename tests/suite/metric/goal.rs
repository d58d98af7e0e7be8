//! `geo-adapt metric goal`, and `geo-adapt adapt --goal`, as a user runs them.
use crate::common::adapting::{Workplace, complaint, stderr, text};
use crate::common::program;
use geo_adapt::mesh::samples::cube;
use geo_adapt::mesh::vector::Vec3;
use geo_adapt::mesh::{TetMesh, io};
use geo_adapt::metric::{Field, field};
use geo_adapt::tasks::Team;
use io::{FieldKind, Solution, SolutionField};
use serde_json::Value;
use std::process::Output;

/// Writes fields at the vertices: a row of scalars for each.
fn write<const N: usize>(work: &Workplace, name: &str, mesh: &TetMesh, row: impl Fn(Vec3) -> [f64; N]) -> String {
    let rows: Vec<[f64; N]> = mesh.vertices.iter().map(|&p| row(p)).collect();
    let field = |k: usize| SolutionField { kind: FieldKind::Scalar, values: rows.iter().map(|row| row[k]).collect() };
    let fields = (0..N).map(field).collect();
    io::write_solution(&work.path(name), &Solution { vertices: rows.len(), fields }).unwrap();
    text(&work.path(name))
}

fn terms(work: &Workplace, lines: &str) -> String {
    std::fs::write(work.path("terms.toml"), lines).unwrap();
    text(&work.path("terms.toml"))
}

fn run(work: &Workplace, mesh: &str, arguments: &[&str]) -> Output {
    let output = text(&work.path("made.solb"));
    program().args(["metric", "goal", mesh, "-o", &output]).args(arguments).output().unwrap()
}

fn made(work: &Workplace, mesh: &str, arguments: &[&str]) -> Field {
    let found = run(work, mesh, arguments);
    assert_eq!(found.status.code(), Some(0), "{}", stderr(&found));
    let vertices = io::read_mesh(mesh.as_ref()).unwrap().content.vertices.len();
    Field::read(&work.path("made.solb"), vertices).unwrap().content
}

const PAIR: &str = "[[terms]]\nfield = 'u.solb'\nweight = { file = 'weights.solb', component = 2 }\n";

/// A cube with a field that bends everywhere, and weights of which the second is zero but near the corner of the origin.
fn prepared() -> (Workplace, TetMesh, String) {
    let (work, mesh) = (Workplace::new(), cube(8));
    let path = text(&work.mesh(&mesh));
    write(&work, "u.solb", &mesh, |[x, y, z]| [(3.0 * x).sin() + (3.0 * y).sin() + (3.0 * z).sin()]);
    write(&work, "weights.solb", &mesh, |[x, y, z]| [1.0, (-8.0 * (x * x + y * y + z * z)).exp()]);
    (work, mesh, path)
}

#[test]
fn sizes_are_small_where_the_weight_is() {
    let (work, mesh, path) = prepared();
    let terms = terms(&work, PAIR);
    let report = text(&work.path("report.json"));
    let found = made(&work, &path, &["--terms", &terms, "--complexity", "2000", "--report", &report]);
    let complexity = field::complexity(Team::alone(), &mesh, &found.metrics);
    assert!((complexity / 2000.0 - 1.0).abs() < 0.01, "{complexity}");
    let least = |at: Vec3| {
        let vertex = mesh.vertices.iter().position(|&p| p == at).unwrap();
        found.metrics[vertex].sizes()[2]
    };
    assert!(3.0 * least([0.125; 3]) < least([0.875; 3]), "{} {}", least([0.125; 3]), least([0.875; 3]));
    let told: Value = serde_json::from_slice(&std::fs::read(&report).unwrap()).unwrap();
    assert_eq!((&told["goal"]["terms"], &told["goal"]["norm"]), (&1.into(), &1.0.into()));
    let table = run(&work, &path, &["--terms", &terms, "--vertices", "4000"]).stdout;
    let table = String::from_utf8(table).unwrap();
    for word in ["goal", "terms.toml (1 term)", "boundary inside", "L^1", "complexity reached"] {
        assert!(table.contains(word), "{word} is not in\n{table}");
    }
    // The mesh is adapted to the same in one command.
    let adapted = work.adapt(path.as_ref(), &["--goal", &terms, "--complexity", "500"]);
    assert_eq!(adapted.report["goal"]["terms"], 1);
    let near = |p: &&Vec3| p.iter().all(|&x| x < 0.5);
    let share = adapted.mesh.vertices.iter().filter(near).count() as f64 / adapted.mesh.vertices.len() as f64;
    assert!(share > 0.4, "{share}");
}

#[test]
fn an_adjoint_is_a_weight_by_its_derivatives() {
    let (work, mesh, path) = prepared();
    // |∂x| of it is the second weight, and |∂yy| is 2.
    write(&work, "adjoint.solb", &mesh, |[x, y, _]| [0.5 * x + y * y]);
    write(&work, "half.solb", &mesh, |_| [2.5]);
    let of = |weight: &str| {
        let terms = terms(&work, &format!("boundary = 'own'\n[[terms]]\nfield = 'u.solb'\n{weight}\n"));
        made(&work, &path, &["--terms", &terms, "--complexity", "1000", "--gradation", "off"]).metrics
    };
    let by_adjoint = of("adjoint = 'adjoint.solb'\nderivatives = { x = 1, yy = -1 }");
    for (a, b) in by_adjoint.iter().zip(of("weight = 'half.solb'")) {
        assert!((0..6).all(|i| (a.0[i] - b.0[i]).abs() < 1e-6 * a.trace()), "{a:?} {b:?}");
    }
}

#[test]
fn a_flow_is_its_fluxes() {
    let (work, mesh, path) = prepared();
    let bump = |[x, y, z]: Vec3| 0.2 * (-20.0 * ((x - 0.5).powi(2) + (y - 0.5).powi(2) + (z - 0.5).powi(2))).exp();
    let flow = write(&work, "flow.solb", &mesh, |p| [1.0 + bump(p), 0.5 - bump(p), 0.1, 0.0, 1.0 + 0.5 * bump(p)]);
    let adjoint = write(&work, "adjoint.solb", &mesh, |[x, y, z]| [x, y, z * z, x * y, x - y * y]);
    let euler = ["--euler", &flow, "--adjoint", &adjoint, "--variables", "primitive", "--complexity", "1000"];
    let inviscid = made(&work, &path, &euler).metrics;
    let viscous = ["--navier-stokes", &flow, "--adjoint", &adjoint, "--variables", "primitive", "--complexity", "1000"];
    let at = |re: &'static str| made(&work, &path, &[&viscous[..], &["--reynolds", re]].concat()).metrics;
    let by_mu = made(&work, &path, &[&viscous[..], &["--mu", "0.1"]].concat()).metrics;
    assert!(at("10").iter().zip(&by_mu).all(|(a, b)| (0..6).all(|i| (a.0[i] - b.0[i]).abs() < 1e-9 * a.trace())));
    let off = |other: &[geo_adapt::metric::Sym3]| {
        let far = inviscid.iter().zip(other).map(|(a, b)| (a.trace() / b.trace()).ln().abs());
        far.fold(0.0, f64::max)
    };
    assert!(off(&at("1e12")) < 1e-6 && off(&at("10")) > 0.01, "{} {}", off(&at("1e12")), off(&at("10")));
    // The same in a file of terms.
    let lines = "[flow]\nprimal = 'flow.solb'\nadjoint = 'adjoint.solb'\nvariables = 'primitive'\n";
    let same = made(&work, &path, &["--terms", &terms(&work, lines), "--complexity", "1000"]).metrics;
    assert_eq!(same, inviscid);
    let refused = |arguments: &[&str]| complaint(&run(&work, &path, arguments));
    // As conservative variables the energy 1.0 of the flow is less than it takes: not here, but a density below zero is.
    let wrong = write(&work, "wrong.solb", &mesh, |p| [p[0] - 0.5, 0.5, 0.1, 0.0, 1.0]);
    let said = refused(&["--euler", &wrong, "--adjoint", &adjoint, "--complexity", "1000"]);
    assert!(said.contains("wrong.solb: vertex") && said.contains("must be positive"), "{said}");
    let four = write(&work, "four.solb", &mesh, |p| [1.0, 0.5, p[0], 1.0]);
    let said = refused(&["--euler", &four, "--adjoint", &adjoint, "--complexity", "1000"]);
    assert!(said.contains("four.solb: 4 values a vertex, but a gas has five equations"), "{said}");
    let said = refused(&["--euler", &flow, "--adjoint", &adjoint, "--complexity", "1000", "--gamma", "0.9"]);
    assert!(said.contains("gamma is 0.9"), "{said}");
    for (arguments, said) in [
        (&["--euler", &flow, "--complexity", "9"][..], "--adjoint"),
        (&["--navier-stokes", &flow, "--adjoint", &adjoint, "--complexity", "9"], "--mu"),
        (&["--euler", &flow, "--adjoint", &adjoint, "--mu", "1", "--complexity", "9"], "--mu"),
        (&["--complexity", "9"], "--terms"),
    ] {
        let found = run(&work, &path, arguments);
        assert_eq!(found.status.code(), Some(2));
        assert!(stderr(&found).contains(said), "{}", stderr(&found));
    }
}

#[test]
fn a_flow_of_constant_density_has_four_equations() {
    let (work, mesh, path) = prepared();
    let bump = |[x, y, z]: Vec3| 0.2 * (-20.0 * ((x - 0.5).powi(2) + (y - 0.5).powi(2) + (z - 0.5).powi(2))).exp();
    let flow = write(&work, "flow.solb", &mesh, |p| [0.5 - bump(p), 0.1, 0.0, 2.0 + bump(p)]);
    let adjoint = write(&work, "adjoint.solb", &mesh, |[x, y, z]| [x * x + y * y, z * z, x * y, x - y * y]);
    let words = ["--incompressible", &flow, "--adjoint", &adjoint, "--complexity", "1000"];
    let of = |more: &[&str]| made(&work, &path, &[&words[..], more].concat()).metrics;
    let near = |a: &[geo_adapt::metric::Sym3], b: &[geo_adapt::metric::Sym3]| {
        a.iter().zip(b).all(|(a, b)| (0..6).all(|i| (a.0[i] - b.0[i]).abs() < 1e-9 * a.trace()))
    };
    let inviscid = of(&[]);
    assert!(near(&of(&["--reynolds", "1e14"]), &inviscid) && !near(&of(&["--reynolds", "5"]), &inviscid));
    // Dynamic viscosity over density is what counts, and pressure over density.
    let dense = of(&["--density", "2", "--mu", "0.4"]);
    assert!(near(&of(&["--density", "2", "--reynolds", "5"]), &dense) && !near(&of(&["--reynolds", "5"]), &dense));
    let lines =
        "[flow]\nequations = 'incompressible'\nprimal = 'flow.solb'\nadjoint = 'adjoint.solb'\ndensity = 2\nmu = 0.4\n";
    assert_eq!(made(&work, &path, &["--terms", &terms(&work, lines), "--complexity", "1000"]).metrics, dense);
    let five = write(&work, "five.solb", &mesh, |p| [1.0, 0.5, p[0], 1.0, 0.0]);
    let refused = run(&work, &path, &["--incompressible", &five, "--adjoint", &adjoint, "--complexity", "9"]);
    let said = complaint(&refused);
    assert!(said.contains("five.solb: 5 values a vertex, but an incompressible flow has four"), "{said}");
    let gas = run(&work, &path, &[&words[..], &["--gamma", "1.4"]].concat());
    assert_eq!(gas.status.code(), Some(2));
}

#[test]
fn terms_that_cannot_be_are_refused_by_name() {
    let (work, mesh, path) = prepared();
    let refused = |lines: &str| {
        let terms = terms(&work, lines);
        complaint(&run(&work, &path, &["--terms", &terms, "--complexity", "1000"]))
    };
    // No command writes what is no number.
    let rows: Vec<&str> = mesh.vertices.iter().map(|&p| if p == [1.0; 3] { "nan" } else { "1" }).collect();
    let head = format!("MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n{}\n1 1\n", rows.len());
    std::fs::write(work.path("nan.sol"), head + &rows.join("\n") + "\nEnd\n").unwrap();
    write(&work, "minus.solb", &mesh, |p| [p[0] - 0.25]);
    let other = cube(2);
    write(&work, "short.solb", &other, |p| [p[0]]);
    for (lines, said) in [
        ("", "no terms"),
        ("[[terms]]\nfield = 'u.solb'\n", "term 1: give a weight, or an adjoint with its derivatives"),
        ("[[terms]]\nfield = 'u.solb'\nadjoint = 'u.solb'\n", "the adjoint has no derivatives"),
        ("[[terms]]\nfield = 'u.solb'\nadjoint = 'u.solb'\nderivatives = { w = 1 }\n", "'w' is no derivative"),
        ("[[terms]]\nfield = 'u.solb'\nweight = 'weights.solb'\n", "weights.solb: 2 values a vertex; give the one"),
        (
            "[[terms]]\nfield = 'u.solb'\nweight = { file = 'weights.solb', component = 3 }\n",
            "weights.solb: 2 values a vertex",
        ),
        ("[[terms]]\nfield = 'none.solb'\nweight = 'u.solb'\n", "none.solb"),
        ("[[terms]]\nfield = 'short.solb'\nweight = 'u.solb'\n", "short.solb: values at 27 vertices"),
        ("[[terms]]\nfield = 'nan.sol'\nweight = 'u.solb'\n", "nan.sol"),
        ("[[terms]]\nfield = 'u.solb'\nweight = 'minus.solb'\n", "term 1: "),
        ("[[terms]]\nfield = 'u.solb'\nweights = 'u.solb'\n", "line 3: unknown field `weights`"),
        ("[[terms]]\nfield = 'minus.solb'\nweight = 'weights.solb:2'\n", "weights.solb:2"),
        ("[flow]\nprimal = 'u.solb'\nadjoint = 'u.solb'\nmu = 1\nreynolds = 1\n", "mu and reynolds say the same"),
    ] {
        let found = refused(lines);
        assert!(found.contains(said), "{lines}: {found}");
    }
    let flat = "[[terms]]\nfield = 'minus.solb'\nweight = { file = 'weights.solb', component = 1 }\n";
    assert!(refused(flat).contains("no size follows from these terms"));
    // No input is written over.
    let terms = terms(&work, PAIR);
    let over = program()
        .args(["metric", "goal", &path, "--terms", &terms, "--complexity", "9", "-o", &text(&work.path("u.solb"))])
        .output()
        .unwrap();
    assert!(complaint(&over).contains("u.solb"));
    // Options of fields have no meaning for a goal.
    let found = work.command(path.as_ref(), &["--goal", &terms, "--complexity", "100", "--component", "1"]).output();
    assert_eq!(found.unwrap().status.code(), Some(2));
}
