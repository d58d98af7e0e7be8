//! SU2 in the loop, by a program that stands for it; by SU2 itself where it is on the PATH.
#![cfg(unix)]
use super::place::Place;
use std::os::unix::fs::PermissionsExt;

/// Stands for SU2_CFD: reads its configuration and mesh, writes restart and history as SU2 documents them. The density is 1 + x / 10, of
/// which a transferred one must be found again; CL is the number of points, CD how far that is off.
pub const SU2: &str = r#"#!/bin/sh
value() { sed -n "s/^$1= *//p" "$2" | tail -1; }
mesh=$(value MESH_FILENAME "$1")
for tag in $(value MARKER_EULER "$1" | tr -d '(),') $(value MARKER_FAR "$1" | tr -d '(),'); do
    grep -q "MARKER_TAG= *$tag" "$mesh" || { echo "no marker $tag in $mesh"; exit 1; }
done
[ "$(value MACH_NUMBER "$1")" = 0.5 ] || exit 1
points="$(value RESTART_FILENAME "$1").csv"
awk -v out="$points" '/^NPOIN=/ { n = $2; print "\"PointID\",\"x\",\"y\",\"z\",\"Density\",\"Momentum_x\",\"Momentum_y\",\"Momentum_z\",\"Energy\",\"Mach\"" > out
    for (i = 0; i < n; i++) { getline; printf "%d, %.15e, %.15e, %.15e, %.15e, %e, %e, %e, %e, %.15e\n", i, $1, $2, $3, 1 + $1 / 10, $1, $2, $3, 2.5, $1 * $1 + $2 * $2 > out } }' "$mesh"
off=9
if [ "$(value RESTART_SOL "$1")" = YES ]; then
    columns=$(head -1 "$(value SOLUTION_FILENAME "$1").csv" | tr -d '" ')
    [ "$columns" = PointID,x,y,z,Density,Momentum_x,Momentum_y,Momentum_z,Energy,Mach ] || { echo "columns $columns"; exit 1; }
    off=$(awk -F, 'NR > 1 { d = $5 - 1 - $2 / 10; if (d < 0) d = -d; if (d > m) m = d } END { printf "%e", m }' "$(value SOLUTION_FILENAME "$1").csv")
fi
printf '"Time_Iter","Inner_Iter",     "rms[Rho]"    ,       "CL"       ,       "CD"       \n0, 0, -1.0, 0.0, 0.0\n0, 1, -8.0, %d, %s\n' \
    "$(($(wc -l < "$points") - 1))" "$off" > "$(value CONV_FILENAME "$1").csv"
"#;

pub const CONFIG: &str = r#"
[mesh]
file = "cube.meshb"
[solver.su2]
program = "./SU2_CFD"
binary = false
flow = { mach = 0.5, walls = ["wall"], farfield = ["inlet", "far"] }
[metric]
fields = ["Mach"]
[schedule]
complexity = 60
factor = 1.0
cycles = 2
[output]
folder = "out"
"#;

/// A loop on the unit cube with this program for SU2.
fn place(config: &str, program: &str) -> Place {
    let place = Place::new(config);
    place.write("SU2_CFD", program);
    std::fs::set_permissions(place.path("SU2_CFD"), std::fs::Permissions::from_mode(0o755)).unwrap();
    geo_adapt::mesh::io::write_mesh(&place.path("cube.meshb"), &crate::common::adapting::cube(3, |_| 1)).unwrap();
    let label = |name: &str| serde_json::json!({ "name": name });
    let names = serde_json::json!({ "triangles": { "1": label("far"), "2": label("inlet"), "3": label("far"), "4": label("far"), "5": label("wall"), "6": label("wall") } });
    place.write("cube.names.json", &names.to_string());
    place
}

#[test]
fn su2_restarts_from_the_transferred_solution() {
    let place = place(CONFIG, SU2);
    place.run(&[]);
    let report = place.report();
    let cycles = report["cycles"].as_array().unwrap();
    let told = |cycle: usize, name: &str| cycles[cycle]["functionals"][name].as_f64().unwrap();
    assert_eq!((told(0, "CD"), told(0, "CL")), (9.0, 64.0), "the first solve has nothing to go on from");
    assert_eq!(told(2, "CL"), cycles[2]["vertices"].as_f64().unwrap());
    assert!(told(1, "CD") < 1e-12 && told(2, "CD") < 1e-12, "{report}");
    let written = std::fs::read_to_string(place.path("out/cycle-02/solve/su2.cfg")).unwrap();
    assert!(written.contains("RESTART_SOL= YES") && written.contains("MARKER_FAR= ( inlet, far )"), "{written}");

    // Reference values that are not given are those of the walls, and said once.
    let log = std::fs::read_to_string(place.path("out/start/log.txt")).unwrap();
    let said = "reference area 1.000000 (the planform of the walls of the first mesh), reference length 1.000000";
    assert_eq!(log.matches(said).count(), 1, "{log}");
    // The result is there as SU2 reads it.
    let data = geo_adapt::formats::read(&place.path("out/result/mesh.su2")).unwrap().content;
    assert_eq!(data.mesh.vertices.len() as f64, told(2, "CL"));
    let rows = std::fs::read_to_string(place.path("out/result/restart.csv")).unwrap();
    assert_eq!(rows.lines().count(), 1 + data.mesh.vertices.len());

    let place = Place::new(&CONFIG.replace("./SU2_CFD", "./none"));
    place.write("cube.meshb", "");
    assert!(place.refusal(&[]).contains("./none is not there: install SU2"));
}

#[test]
fn functionals_are_means_of_the_last_iterations() {
    let place = place(&CONFIG.replace("binary = false", "binary = false\nmean = 2"), SU2);
    place.run(&[]);
    let report = place.report();
    let first = &report["cycles"][0]["functionals"];
    // The history has 0 and then the number of points.
    assert_eq!((first["CL"].as_f64(), first["CD"].as_f64()), (Some(32.0), Some(4.5)));
    let none = Place::new(&CONFIG.replace("binary = false", "mean = 0"));
    none.write("cube.meshb", "");
    assert!(none.refusal(&[]).contains("mean: give 1 for the last iteration alone"));
}

/// The same, but it diverges to second order with a Courant number above 0.5, unless it begins where first order has ended.
fn diverging() -> String {
    let check = r#"
if [ "$(value MUSCL_FLOW "$1")" = YES ] && [ "$(value SOLUTION_FILENAME "$1")" != first ]; then
    echo "Error in CSolver: SU2 has diverged (NaN detected)."; exit 1
fi
"#;
    let at = "mesh=$(value MESH_FILENAME";
    SU2.replacen(at, &format!("{check}{at}"), 1)
}

#[test]
fn what_diverges_is_run_again_slower_after_first_order() {
    let place = place(CONFIG, &diverging());
    place.run(&[]);
    let solve = place.path("out/cycle-02/solve");
    let read = |name: &str| std::fs::read_to_string(solve.join(name)).unwrap();
    let outcome: serde_json::Value = serde_json::from_str(&read("outcome.json")).unwrap();
    assert_eq!((outcome["diverged"].as_u64(), outcome["iterations"].as_u64()), (Some(1), Some(2)));
    assert!(read("log.txt").contains(
        "diverged: again from the same start, with a Courant number of 0.5, 200 iterations of first order before"
    ));
    // What is asked for stays, and the last run is of second order.
    assert!(read("su2.cfg").contains("CFL_NUMBER= 2.0\n") && read("run.cfg").contains("CFL_NUMBER= 0.5\n"));
    assert!(read("run.cfg").contains("MUSCL_FLOW= YES\n") && read("run.cfg").contains("SOLUTION_FILENAME= first\n"));
}

#[test]
fn what_always_diverges_and_what_is_refused_is_told() {
    let always = SU2.replacen("mesh=$(", "echo 'SU2 has diverged (NaN detected).'; exit 1\nmesh=$(", 1);
    let place = place(CONFIG, &always);
    // The end of the log of the step, which is an error of ours, is in the error of the loop.
    let refusal = |words: &[&str]| {
        let output = place.command(words).output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8(output.stderr).unwrap()
    };
    let said = refusal(&[]);
    assert!(said.contains("however slow it is") && said.contains("SU2 has diverged"), "{said}");
    let refused =
        SU2.replacen("mesh=$(", "echo 'Error in CConfig: MARKER_FOO: invalid option name.'; exit 1\nmesh=$(", 1);
    place.write("SU2_CFD", &refused);
    let said = refusal(&["--restart"]);
    assert!(said.contains("invalid option name") && !said.contains("however slow"), "{said}");
    // A crash before the first iteration is no divergence.
    place.write("SU2_CFD", &SU2.replacen("mesh=$(", "kill -SEGV $$\nmesh=$(", 1));
    let said = refusal(&["--restart"]);
    assert!(said.contains("signal 11") && !said.contains("however slow"), "{said}");
    assert!(!place.path("out/cycle-01/solve/first.csv").exists());
}

/// SU2 goes on to its last iteration with residuals that grow: it is ended, and run again.
#[test]
fn what_grows_without_end_is_not_waited_for() {
    let grows = r#"
if [ "$(value SOLUTION_FILENAME "$1")" != first ] && [ "$(value MUSCL_FLOW "$1")" = YES ]; then
    printf '"Inner_Iter", "rms[Rho]", "CL", "CD"\n0, -5.0, 0, 0\n1, 2.0, 9, 9\n' > "$(value CONV_FILENAME "$1").csv"
    exec sleep 600
fi
"#;
    let at = "mesh=$(value MESH_FILENAME";
    let place = place(CONFIG, &SU2.replacen(at, &format!("{grows}{at}"), 1));
    place.run(&[]);
    let log = std::fs::read_to_string(place.path("out/cycle-01/solve/log.txt")).unwrap();
    assert!(log.contains("diverged: again from the same start, with a Courant number of 0.5"), "{log}");
}

/// SU2 8 itself, where it is on the PATH: Euler about a cube's corner, its binary files both ways, an end by functionals.
#[test]
fn su2_itself_goes_round_where_it_is_there() {
    let has = std::env::var_os("PATH")
        .is_some_and(|path| std::env::split_paths(&path).any(|folder| folder.join("SU2_CFD").is_file()));
    if !has {
        eprintln!("skipped: no SU2_CFD on the PATH");
        return;
    }
    let config = CONFIG
        .replace("./SU2_CFD", "SU2_CFD")
        .replace("binary = false", "iterations = 400\nchange = 1e-4")
        .replace("mach = 0.5", "mach = 0.5, angle_of_attack = 8.0");
    let place = place(&config, "");
    place.run(&[]);
    let report = place.report();
    let cycles = report["cycles"].as_array().unwrap();
    assert_eq!(cycles.len(), 3);
    for cycle in cycles {
        let iterations = cycle["functionals"]["iterations"].as_f64().unwrap();
        assert!((100.0..400.0).contains(&iterations), "{cycle}");
    }
    let data = geo_adapt::formats::read(&place.path("out/result/result.vtu")).unwrap().content;
    assert!(
        data.fields
            .iter()
            .any(|field| field.name == "Mach" && field.values.iter().all(|mach| (0.0..1.0).contains(mach)))
    );
}
