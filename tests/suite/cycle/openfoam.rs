//! OpenFOAM in the loop: the case that is prepared, what happens when a solve blows up, and the real solver where it is installed.
use crate::common::adapting::stderr;
use crate::common::program;
use geo_adapt::cycle::solver::openfoam::{self, drive::drive};
use geo_adapt::cycle::solver::{Before, FieldName, Job, Solved, Solver};
use geo_adapt::formats::foam::{CellField, write_cell_field};
use geo_adapt::mesh::io::{FieldKind, Solution, SolutionField, write_mesh, write_solution};
use geo_adapt::mesh::samples::cube;
use std::path::PathBuf;
use std::process::Output;

/// Nobody ends these solves.
static NEVER: std::sync::atomic::AtomicBool = std::sync::atomic::AtomicBool::new(false);

/// A folder with a configuration, run on the unit cube. Its sides are 1 to 6: the least and the greatest x, y, z, or otherwise.
struct Place {
    folder: tempfile::TempDir,
}

/// A solver that leaves the flow as it is, and blows up where the Courant number is above 0.15.
pub const STAND_IN: &str = r#"#!/bin/bash
value() { sed -n "s/^$1 \(.*\);/\1/p" system/controlDict; }
echo "stand-in: $(value startTime) to $(value endTime)"
if [ "$(awk -v c="$(value maxCo)" 'BEGIN { print (c > 0.15) }')" = 1 ]; then echo "sigFpe: the temperature is negative"; exit 136; fi
cp -r "$(value startTime)" "$(value endTime)"
"#;

/// A solver that fails to second order, with a cell of negative pressure in its last fields (those of the folder `fallen`) where it is to write
/// each step, unless some cells are of first order.
const FALLING: &str = r#"#!/bin/bash
value() { sed -n "s/^$1 \(.*\);/\1/p" system/controlDict; }
start=$(value startTime)
if grep -q localBlended system/fvSchemes; then
    for field in rho rhoU rPsi e c; do [ -f "$start/${field}BlendingFactor" ] || exit 1; done
    cp -r "$start/rhoBlendingFactor" ../factor
elif ! grep -q "reconstruct(T) upwind" system/fvSchemes; then
    if [ "$(value writeInterval)" = 1 ]; then cp -r ../../fallen "$((start + 1))"; fi
    echo "sigFpe: the pressure is negative"
    exit 136
fi
cp -r "$start" "$(value endTime)"
"#;

/// A solver whose pressure is now that of the folder `swing-0`, now that of `swing-1`.
const SWINGING: &str = r#"#!/bin/bash
value() { sed -n "s/^$1 \(.*\);/\1/p" system/controlDict; }
end=$(value endTime)
cp -r "$(value startTime)" "$end"
cp ../../swing-$((end / 20 % 2))/p "$end/p"
"#;

pub const CONFIG: &str = r#"
threads = 1
[mesh]
cube = 3
[solver.openfoam]
program = "PROGRAM"
steps = 300
start_steps = 40
block = 20
courant = 0.4
[solver.openfoam.flow]
mach = 2.0
WALLS
[metric]
fields = ["Mach"]
[schedule]
complexity = 150
cycles = 1
[output]
folder = "out"
pictures = false
"#;

impl Place {
    fn new(program: &str, surfaces: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let place = Self { folder };
        std::fs::write(place.path("stand-in"), STAND_IN).unwrap();
        #[cfg(unix)]
        std::fs::set_permissions(place.path("stand-in"), std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
        let config = CONFIG.replace("PROGRAM", program).replace("WALLS", surfaces);
        std::fs::write(place.path("loop.toml"), config).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn run(&self) -> Output {
        program().arg("cycle").arg(self.path("loop.toml")).output().unwrap()
    }

    fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }
}

const SIDES: &str = "inflow = ['1']\noutflow = ['2']\nwalls = ['3', '4']\nsymmetry = ['5', '6']";

/// Solves on the cube as the loop would, in this process; the solution before as its fields are.
fn solve(place: &Place, surfaces: &str, program: &str, before: Option<&Solved>) -> (Solved, Vec<String>) {
    let text = CONFIG.replace("PROGRAM", program).replace("WALLS", surfaces);
    let text = text.split("[metric]").next().unwrap().split("[solver.openfoam]").nth(1).unwrap();
    let config: openfoam::Config = toml::from_str(&text.replace("[solver.openfoam.flow]", "[flow]")).unwrap();
    config.check(place.folder.path()).unwrap();
    let mesh = place.path("mesh.meshb");
    let content = cube(3);
    write_mesh(&mesh, &content).unwrap();
    let (path, mut named) = (place.path("before.solb"), Vec::new());
    if let Some(solved) = before {
        named = solved.fields.iter().map(FieldName::of).collect();
        let fields = solved.fields.iter().map(|f| SolutionField { kind: f.kind, values: f.values.clone() }).collect();
        write_solution(&path, &Solution { vertices: content.vertices.len(), fields }).unwrap();
    }
    let folder = place.path(if before.is_some() { "second" } else { "first" });
    std::fs::create_dir(&folder).unwrap();
    let before = before.map(|_| Before { path: &path, fields: &named });
    let base = place.folder.path();
    let job = Job { folder: &folder, base, cycle: 1, mesh: &mesh, before, threads: 1, thread_words: &[] };
    let calls = config.prepare(&job).unwrap();
    assert_eq!(calls[0].words[1..], ["openfoam".to_owned(), folder.join("case").to_string_lossy().into_owned()]);
    let mut log = Vec::new();
    drive(&folder.join("case"), &NEVER, &mut |line| log.push(line.to_owned())).unwrap();
    (config.collect(&job).unwrap(), log)
}

#[test]
fn a_solve_that_blows_up_is_repeated_with_smaller_steps() {
    let place = Place::new("./stand-in", SIDES);
    let (first, log) = solve(&place, SIDES, "./stand-in", None);
    // 0.4 and 0.2 fail, 0.1 does not; nothing moves, so two blocks of second order are enough.
    assert!(log[0].contains("blew up at Courant 0.4") && log[1].contains("blew up at Courant 0.2"), "{log:?}");
    assert!(log[2].contains("Courant 0.1 Upwind") && log.last().unwrap().contains("VanAlbada"), "{log:?}");
    assert_eq!(first.functionals["steps"], 80.0);
    let (second, log) = solve(&place, SIDES, "./stand-in", Some(&first));
    assert_eq!(second.functionals["steps"], 40.0);
    assert!(!log.iter().any(|line| line.contains("Upwind")), "first order goes before the first solve alone: {log:?}");
    // The free stream, through both solves, as it was.
    let names: Vec<&str> = second.fields.iter().map(|field| &field.name[..]).collect();
    assert_eq!(names, ["p", "T", "U", "rho", "Mach"]);
    assert!(second.fields[2].values.chunks(3).all(|u| (u[0] - 2.0).abs() < 1e-9 && u[1].abs() + u[2].abs() < 1e-9));
    assert!(second.fields[3].values.iter().all(|rho| (rho - 1.4).abs() < 1e-9));
    assert!(second.fields[4].values.iter().all(|mach| (mach - 2.0).abs() < 1e-9));
    let p = place.text("first/case/0/p");
    assert!(p.contains("type fixedValue; value uniform 1.0;") && p.contains("type symmetry;"), "{p}");
    assert!(place.text("first/case/0/U").contains("type slip;"));
    assert!(place.text("first/case/constant/thermophysicalProperties").contains("mu 0.0;"));
}

#[test]
fn a_solve_that_blows_up_always_ends_with_its_log() {
    let place = Place::new("./stand-in", SIDES);
    let text = STAND_IN.replace("c > 0.15", "c > 0");
    std::fs::write(place.path("stand-in"), text).unwrap();
    let run = place.run();
    assert_eq!(run.status.code(), Some(2));
    let said = stderr(&run);
    assert!(said.contains("however small the steps, ") && said.contains("the temperature is negative"), "{said}");
}

#[test]
fn cells_where_a_solve_blows_up_again_are_solved_to_first_order() {
    let place = Place::new("./stand-in", SIDES);
    std::fs::write(place.path("stand-in"), FALLING).unwrap();
    let fallen = place.path("fallen");
    std::fs::create_dir(&fallen).unwrap();
    let cells = cube(3).tets.len();
    let write = |name: &str, values: Vec<f64>| {
        write_cell_field(&fallen.join(name), &CellField { kind: FieldKind::Scalar, values }, cells, &[], false)
            .unwrap();
    };
    write("p", (0..cells).map(|cell| if cell == 5 { -0.1 } else { 1.0 }).collect());
    write("T", vec![1.0; cells]);
    let (solved, log) = solve(&place, SIDES, "./stand-in", None);
    let second: Vec<_> = log.iter().filter(|line| !line.contains("Upwind")).map(|line| &line[..]).collect();
    assert!(second[0].contains("blew up at Courant 0.4: again from step 40, to see where"), "{log:?}");
    assert!(second[1].contains("blew up at Courant 0.4 in 1 cells: from step 40 with first order there"), "{log:?}");
    assert!(second[2].contains("Courant 0.4 VanAlbada") && second[3].contains("step     80"), "{log:?}");
    assert_eq!(solved.functionals["steps"], 80.0);
    let outcome: serde_json::Value = serde_json::from_str(&place.text("first/case/coefficients.json")).unwrap();
    assert!(outcome["first_order"].as_u64().unwrap() > 1 && outcome["repeated"] == 2, "{outcome}");
    // Factors 0 and 1, patches of symmetry as such.
    let factor = std::fs::read(place.path("first/factor")).unwrap();
    let text = String::from_utf8_lossy(&factor);
    assert!(text.contains("surfaceScalarField") && text.contains("type symmetry; value uniform 1;"), "{text}");
    let reals = |x: f64| factor.windows(8).filter(|bytes| *bytes == x.to_le_bytes()).count();
    assert!(reals(1.0) > 20 && reals(0.0) > 20, "{text}");
}

#[test]
fn of_a_flow_that_swings_about_the_mean_counts() {
    let place = Place::new("./stand-in", SIDES);
    std::fs::write(place.path("stand-in"), SWINGING).unwrap();
    let cells = cube(3).tets.len();
    for (folder, pressure) in [("swing-0", 1.25), ("swing-1", 0.75)] {
        std::fs::create_dir(place.path(folder)).unwrap();
        let field = CellField { kind: FieldKind::Scalar, values: vec![pressure; cells] };
        write_cell_field(&place.path(folder).join("p"), &field, cells, &[], false).unwrap();
    }
    let (solved, log) = solve(&place, SIDES, "./stand-in", None);
    // 40 steps of first order and 300 others, of which the last half: looks at 200, 220, ... 340, one in two at each pressure.
    assert!(log.last().unwrap().starts_with("step    340"), "{log:?}");
    let outcome: serde_json::Value = serde_json::from_str(&place.text("first/case/coefficients.json")).unwrap();
    assert!(outcome["averaged"] == 8 && outcome["still"] == false, "{outcome}");
    let of = |name: &str| &solved.fields.iter().find(|field| field.name == name).unwrap().values;
    assert!(of("p").iter().all(|p| (p - 1.0).abs() < 1e-12) && of("rho").iter().all(|rho| (rho - 1.4).abs() < 1e-12));
    // The wall below and that above are pressed alike.
    assert!(solved.functionals["CL"].abs() < 1e-12, "{:?}", solved.functionals);
}

#[test]
fn surfaces_must_be_those_of_the_mesh() {
    let message = |surfaces: &str| {
        let run = Place::new("./stand-in", surfaces).run();
        assert_eq!(run.status.code(), Some(2));
        stderr(&run)
    };
    assert!(message("walls = ['3', '4']\nfarfield = ['1', '2', '5']").contains("says nothing of the surfaces 6"));
    assert!(message(&format!("{SIDES}\nfarfield = ['sky']")).contains("names a surface sky, but the mesh has 1, 2"));
    let run = Place::new("no-such-foam", SIDES).run();
    assert!(stderr(&run).contains("no-such-foam is not there: install OpenFOAM"));
}

#[test]
fn a_slow_viscous_flow_is_solved_by_pressure_correction() {
    let place = Place::new("./stand-in", "walls = ['3']\nsymmetry = ['4', '5', '6']\nfarfield = ['1', '2']");
    let viscous = "mach = 0.3\nreynolds = 100\nlength = 2\nwall_temperature = 1.1";
    std::fs::write(place.path("loop.toml"), place.text("loop.toml").replace("mach = 2.0", viscous)).unwrap();
    let run = place.run();
    assert!(run.status.success(), "{}", stderr(&run));
    let case = |name: &str| place.text(&format!("out/cycle-01/solve/case/{name}"));
    assert!(case("system/controlDict").contains("application rhoSimpleFoam;"));
    assert!(case("0/U").contains("type noSlip;") && case("0/T").contains("type fixedValue; value uniform 1.1;"));
    // ρ U L / Re.
    assert!(case("constant/thermophysicalProperties").contains("mu 0.0084;"));
    let log = place.text("out/cycle-01/solve/log.txt");
    assert!(log.contains("relaxation 0.7 Upwind") && log.contains("relaxation 0.7 LinearUpwind"), "{log}");
    let scheme = place.text("loop.toml").replace("courant = 0.4", "method = \"central\"\nscheme = \"linearupwind\"");
    std::fs::write(place.path("loop.toml"), scheme).unwrap();
    let run = place.run();
    assert_eq!(run.status.code(), Some(2));
    assert!(stderr(&run).contains("scheme linearupwind is of method simple"), "{}", stderr(&run));
}

#[test]
fn a_free_stream_through_a_channel_stays() {
    let installed =
        std::env::split_paths(&std::env::var_os("PATH").unwrap()).any(|folder| folder.join("rhoCentralFoam").is_file());
    if !installed {
        assert!(
            std::env::var_os("GEO_ADAPT_OPENFOAM").is_none(),
            "OpenFOAM was set up, but rhoCentralFoam is not on the PATH"
        );
        eprintln!("skipped: rhoCentralFoam is not there (Debian's package openfoam)");
        return;
    }
    let sides = "farfield = ['1', '2', '3', '4', '5', '6']";
    let place = Place::new("rhoCentralFoam", sides);
    let (first, _) = solve(&place, sides, "rhoCentralFoam", None);
    let (second, log) = solve(&place, sides, "rhoCentralFoam", Some(&first));
    assert_eq!(second.functionals["steps"], 40.0, "{log:?}");
    assert!(second.fields[4].values.iter().all(|mach| (mach - 2.0).abs() < 1e-6), "{log:?}");
}

#[test]
fn an_example_is_printed_and_can_be_checked() {
    let run = program().args(["cycle", "--example", "openfoam"]).output().unwrap();
    let text = String::from_utf8(run.stdout).unwrap();
    assert!(text.contains("[solver.openfoam.flow]") && run.status.success());
}
