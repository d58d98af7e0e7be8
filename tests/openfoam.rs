//! OpenFOAM in the loop: the case that is prepared, what happens when a solve blows up, and the real solver where it is installed.
mod common;
use common::adapting::stderr;
use common::program;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Output;

/// A folder with a configuration, run on the unit cube. Its sides are 1 to 6: the least and the greatest x, y, z, or otherwise.
struct Place {
    folder: tempfile::TempDir,
}

/// A solver that leaves the flow as it is, and blows up where the Courant number is above 0.15.
const STAND_IN: &str = r#"#!/bin/bash
value() { sed -n "s/^$1 \(.*\);/\1/p" system/controlDict; }
echo "stand-in: $(value startTime) to $(value endTime)"
if [ "$(awk -v c="$(value maxCo)" 'BEGIN { print (c > 0.15) }')" = 1 ]; then echo "sigFpe: the temperature is negative"; exit 136; fi
cp -r "$(value startTime)" "$(value endTime)"
"#;

const CONFIG: &str = r#"
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

    fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&std::fs::read(self.path(name)).unwrap()).unwrap()
    }

    fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }
}

const SIDES: &str = "inflow = ['1']\noutflow = ['2']\nwalls = ['3', '4']\nsymmetry = ['5', '6']";

#[test]
fn a_solve_that_blows_up_is_repeated_with_smaller_steps() {
    let place = Place::new("./stand-in", SIDES);
    let run = place.run();
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    for cycle in ["cycle-01", "cycle-02"] {
        let result = place.json(&format!("out/{cycle}/solve/case/coefficients.json"));
        // 0.4 and 0.2 fail, 0.1 does not; nothing moves, so two blocks of second order are enough.
        assert_eq!(result["still"], true, "{result}");
        let first = cycle == "cycle-01";
        assert_eq!(result["steps"], if first { 80 } else { 40 }, "{result}");
        let log = place.text(&format!("out/{cycle}/solve/log.txt"));
        assert!(log.contains("blew up at Courant 0.4") && log.contains("Courant 0.1 VanAlbada"), "{log}");
        assert_eq!(log.contains("Upwind"), first, "first order goes before the first solve alone: {log}");
    }
    // The free stream through the second solve as it was.
    let folder = place.path("out/cycle-02/solve/case/40");
    let found =
        geo_adapt::formats::foam::read_cell_field(&folder.join("U"), cells(&place.path("out/cycle-02/solve/case")));
    let velocity = found.unwrap().unwrap().values;
    assert!(velocity.chunks(3).all(|u| (u[0] - 2.0).abs() < 1e-9 && u[1].abs() + u[2].abs() < 1e-9));
    let p = place.text("out/cycle-01/solve/case/0/p");
    assert!(p.contains("type fixedValue; value uniform 1.0;") && p.contains("type symmetry;"), "{p}");
    assert!(place.text("out/cycle-01/solve/case/0/U").contains("type slip;"));
    assert!(place.text("out/cycle-01/solve/case/constant/thermophysicalProperties").contains("mu 0.0;"));
}

fn cells(case: &Path) -> usize {
    geo_adapt::formats::foam::read_mesh(case).unwrap().0.tets.len()
}

#[test]
fn a_solve_that_blows_up_always_ends_with_its_log() {
    let place = Place::new("./stand-in", SIDES);
    let text = STAND_IN.replace("c > 0.15", "c > 0");
    std::fs::write(place.path("stand-in"), text).unwrap();
    let run = place.run();
    assert_eq!(run.status.code(), Some(2));
    let said = stderr(&run);
    assert!(said.contains("however small the time steps, ") && said.contains("the temperature is negative"), "{said}");
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
    // Which sides the stream goes along does not matter: it is that of all, and walls along it let it be.
    let place = Place::new("rhoCentralFoam", "farfield = ['1', '2', '3', '4', '5', '6']");
    let run = place.run();
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    let report = place.json("out/report.json");
    let last = &report["cycles"][1]["functionals"];
    assert!(last["change"].as_f64().unwrap() < 1e-9, "{last}");
    let solution = geo_adapt::mesh::io::read_solution(&place.path("out/cycle-02/solve/solution.solb")).unwrap().content;
    let mach = &solution.fields[4].values;
    assert!(mach.iter().all(|mach| (mach - 2.0).abs() < 1e-6), "{mach:?}");
}
