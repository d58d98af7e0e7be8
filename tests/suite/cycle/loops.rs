//! `geo-adapt cycle`: the loop on its analytic solver and on programs; killed and resumed it ends with the same bytes.
use super::place::{Place, files};
use crate::common::adapting::stderr;
use crate::common::program;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const ANALYTIC: &str = r#"
threads = 1
[mesh]
cube = 3
[solver.analytic]
function = "sinfun3"
[metric]
fields = ["u"]
[schedule]
complexity = 100
max_complexity = 400
[output]
folder = "out"
"#;

/// What a file says up to its first space: of a step's `pid` the number of the process.
fn first_word(path: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap();
    text.split(' ').next().unwrap().to_owned()
}

/// The moment of the last change of each done.json.
fn finished(place: &Place) -> BTreeMap<PathBuf, std::time::SystemTime> {
    let mut found = BTreeMap::new();
    files(&place.path("out"), &mut |path| {
        if path.ends_with("done.json") {
            found.insert(path.to_owned(), std::fs::metadata(path).unwrap().modified().unwrap());
        }
    });
    found
}

#[test]
fn a_loop_refines_to_the_complexity_and_tells_the_error() {
    let place = Place::new(ANALYTIC);
    let table = place.run(&[]);
    assert!(table.contains("complexity 400 is reached"), "{table}");
    let report = place.report();
    let cycles = report["cycles"].as_array().unwrap();
    let complexities: Vec<Option<f64>> = cycles.iter().map(|cycle| cycle["complexity"].as_f64()).collect();
    assert_eq!(complexities, [None, Some(100.0), Some(200.0), Some(400.0)]);
    let errors: Vec<f64> = cycles.iter().map(|cycle| cycle["functionals"]["error"].as_f64().unwrap()).collect();
    assert!(errors.windows(2).all(|pair| pair[1] < pair[0]) && errors[3] < 0.3 * errors[0], "{errors:?}");
    // The result is at one place, which is told.
    let result = place.path("out/result");
    for (what, file) in [
        ("result", "result.vtu"),
        ("mesh", "mesh.meshb"),
        ("solution", "solution.solb"),
        ("functionals", "functionals.csv"),
        ("report", "report.html"),
    ] {
        let path = result.canonicalize().unwrap().join(file);
        assert!(path.is_file(), "{file}");
        let line = format!("{what:<14} {}", path.display());
        assert!(table.lines().any(|told| told == line), "{line}: {table}");
    }
    let same =
        |a: &str, b: &str| assert_eq!(std::fs::read(place.path(a)).unwrap(), std::fs::read(place.path(b)).unwrap());
    same("out/result/mesh.meshb", "out/cycle-03/adapt/mesh.meshb");
    same("out/result/solution.solb", "out/cycle-04/solve/solution.solb");
    let whole = geo_adapt::formats::read(&result.join("result.vtu")).unwrap().content;
    let solution = geo_adapt::mesh::io::read_solution(&result.join("solution.solb")).unwrap().content;
    assert_eq!((whole.fields[0].name.as_str(), &whole.fields[0].values), ("u", &solution.fields[0].values));
    let rows = std::fs::read_to_string(result.join("functionals.csv")).unwrap();
    let rows: Vec<Vec<&str>> = rows.lines().map(|row| row.split(',').collect()).collect();
    assert_eq!(rows[0], ["cycle", "complexity", "vertices", "tetrahedra", "error"]);
    assert_eq!(rows[1..].iter().map(|row| row[4].parse::<f64>().unwrap()).collect::<Vec<_>>(), errors);
    // What is in the folders is what is told, and each command can be typed again.
    let last = place.path("out/cycle-03/adapt/mesh.meshb");
    let mesh = geo_adapt::mesh::io::read_mesh(&last).unwrap().content;
    assert_eq!(cycles[3]["vertices"], mesh.vertices.len());
    let command = std::fs::read_to_string(place.path("out/cycle-03/adapt/command.txt")).unwrap();
    let before = std::fs::read(&last).unwrap();
    std::fs::remove_file(&last).unwrap();
    let again = Command::new("sh").args(["-c", &command]).output().unwrap();
    assert!(again.status.success(), "{}", stderr(&again));
    assert_eq!(std::fs::read(&last).unwrap(), before);
    // A loop that is at its end does nothing any more.
    let then = finished(&place);
    place.run(&["--quiet"]);
    assert_eq!(finished(&place), then);
}

#[test]
fn a_loop_killed_at_twenty_moments_ends_with_the_same_bytes() {
    let whole = Place::new(ANALYTIC);
    let start = Instant::now();
    whole.run(&[]);
    let duration = start.elapsed();
    let expected = whole.products();
    assert!(expected.len() > 12, "{:?}", expected.keys());

    // Each run is killed after another part of the time that the whole loop took; what it left is gone on with. The parts are spread as a
    // golden-ratio sequence, from almost none to a third, so that over twenty kills the loop is hit everywhere.
    let killed = Place::new(ANALYTIC);
    let mut ended = 0;
    for kill in 0..20 {
        let part = f64::from(kill) * 0.618_033_988_749 % 1.0 / 3.0;
        let mut child = killed.command(&["--quiet"]).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        std::thread::sleep(duration.mul_f64(part));
        let early = child.try_wait().unwrap();
        ended += usize::from(early.is_some());
        // SIGKILL, to the loop alone: what it started goes on and must not get in the way. Every second time that is killed too.
        child.kill().unwrap();
        let output = child.wait_with_output().unwrap();
        if kill % 2 == 1 {
            files(&killed.path("out"), &mut |path| {
                if path.ends_with("pid") {
                    let line = format!("kill -s KILL -- -{}", first_word(path));
                    let _ = Command::new("sh").args(["-c", &line]).stderr(Stdio::null()).status();
                }
            });
        }
        if early.is_some() {
            assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
            let _ = std::fs::remove_dir_all(killed.path("out/cycle-03"));
        }
    }
    assert!(ended < 10, "{ended} of the runs ended before they were killed");
    killed.run(&[]);
    let found = killed.products();
    assert!(found.keys().eq(expected.keys()), "{:?} {:?}", found.keys(), expected.keys());
    for (path, bytes) in &expected {
        assert!(found[path] == *bytes, "{} differs", path.display());
    }
}

#[test]
fn what_a_killed_run_left_working_is_ended() {
    let config = |run: &str| {
        format!(
            "[mesh]\ncube = 1\n[solver.command]\nrun = '{run}'\n[metric]\n[schedule]\ncomplexity = 10\ncycles = 1\n[output]\nfolder = \"out\"\n"
        )
    };
    let place = Place::new(&config("echo here >> {config}/began; sleep 600"));
    let mut child = place.command(&[]).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let patience = Instant::now();
    while !place.path("began").exists() || !place.path("out/cycle-01/solve/pid").exists() {
        assert!(patience.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(20));
    }
    // Nobody else may work there.
    assert!(place.refusal(&[]).contains("another run of geo-adapt cycle works in this folder"));
    child.kill().unwrap();
    child.wait().unwrap();
    let left = first_word(&place.path("out/cycle-01/solve/pid"));
    let alive = || {
        let state = std::fs::read_to_string(format!("/proc/{left}/stat")).unwrap_or_default();
        state.rsplit(')').next().is_some_and(|rest| !rest.trim_start().starts_with('Z') && !rest.is_empty())
    };
    assert!(alive() || !cfg!(target_os = "linux"));
    place.write("loop.toml", &config("echo no solution").replace("cube = 1", "cube = 2"));
    let refused = place.refusal(&[]);
    assert!(refused.contains("mesh.cube was"), "{refused}");
    assert!(alive() || !cfg!(target_os = "linux"), "a refusal leaves all as it is");
    // The same command goes on, and meets nobody: another solver in its place, which is taken, for no solve is done.
    place.write("loop.toml", &config("echo no solution"));
    let refused = place.refusal(&[]);
    assert!(refused.contains("cycle-01/solve: ") && refused.contains("did not write this"), "{refused}");
    assert!(!alive(), "the program of the killed run is still there");
}

#[test]
fn a_changed_configuration_is_told_and_more_cycles_are_not() {
    let place = Place::new(&ANALYTIC.replace("max_complexity = 400", "cycles = 1"));
    place.run(&["--quiet"]);
    let then = finished(&place);
    place.write("loop.toml", &ANALYTIC.replace("sinfun3", "tanh3"));
    let refused = place.refusal(&[]);
    assert!(refused.contains("solver.analytic.function was \"sinfun3\" and is \"tanh3\""), "{refused}");
    assert!(refused.contains("--restart"), "{refused}");
    assert_eq!(finished(&place), then);
    // What only says when to end may change.
    place.write("loop.toml", &ANALYTIC.replace("max_complexity = 400", "cycles = 2"));
    place.run(&["--quiet"]);
    let now = finished(&place);
    assert!(then.iter().all(|(path, time)| now[path] == *time));
    assert_eq!(place.report()["cycles"].as_array().unwrap().len(), 3);
    // And --restart throws all away.
    place.write("loop.toml", &ANALYTIC.replace("sinfun3", "tanh3").replace("max_complexity = 400", "cycles = 1"));
    place.run(&["--quiet", "--restart"]);
    assert_eq!(place.report()["cycles"].as_array().unwrap().len(), 2);
    assert!(!place.path("out/cycle-03").exists());
}

#[test]
fn a_functional_that_changes_no_more_ends_the_loop() {
    let config = ANALYTIC.replace(
        "max_complexity = 400",
        "factor = 1.0\ncycles = 30\nconverged = { functional = \"error\", change = 0.5, cycles = 2 }",
    );
    let place = Place::new(&config);
    let table = place.run(&[]);
    assert!(table.contains("error changed by less than 0.5 over 2 cycles"), "{table}");
    let report = place.report();
    let errors: Vec<f64> = report["cycles"]
        .as_array()
        .unwrap()
        .iter()
        .map(|cycle| cycle["functionals"]["error"].as_f64().unwrap())
        .collect();
    let small = |pair: &[f64]| (pair[1] - pair[0]).abs() <= 0.5 * pair[1];
    let last = errors.len() - 1;
    assert!(small(&errors[last - 1..]) && small(&errors[last - 2..last]) && last < 30, "{errors:?}");
    assert!(
        (2..last).all(|at| !(small(&errors[at - 2..at]) && small(&errors[at - 1..=at]))),
        "it could have ended before: {errors:?}"
    );
    let place = Place::new(&config.replace("\"error\"", "\"drag\""));
    assert!(place.refusal(&[]).contains("the solver tells no 'drag'; it tells error"));
}

#[test]
fn any_program_can_solve() {
    // A solver of the shell: x + 10 y at the vertices of a text file, and a functional on the terminal and in a file.
    let script = r#"
awk -v out="$2" '
    $1 == "Vertices" { getline; n = $1; print "MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n" n "\n1 1" > out
        for (i = 0; i < n; i++) { getline; print $1 * $1 + 10 * $2 * $2 > out } print "End" > out; exit }' "$1"
echo "step 1 CD = 3.0"; echo "step 2 CD = 2.5e-1"
echo '{"lift": 4}' > forces.json
"#;
    let config = r#"
[mesh]
cube = 2
[solver.command]
run = "sh {config}/solve.sh {mesh} {solution_out}"
mesh = "mesh.mesh"
solution_out = "out.sol"
fields = ["T"]
functionals = "forces.json"
printed = { drag = 'CD = (\S+)' }
[probes]
middle = { field = "T", at = [0.5, 0.5, 0.5] }
[metric]
fields = ["T"]
[schedule]
complexity = 60
cycles = 1
[output]
folder = "out"
pictures = false
"#;
    let place = Place::new(config);
    place.write("solve.sh", script);
    place.run(&[]);
    let report = place.report();
    // A vertex of the cube is in the middle.
    assert_eq!(report["cycles"][0]["functionals"], serde_json::json!({ "drag": 0.25, "lift": 4.0, "middle": 2.75 }));
    let mesh = geo_adapt::mesh::io::read_mesh(&place.path("out/cycle-01/adapt/mesh.meshb")).unwrap().content;
    let field = geo_adapt::mesh::io::read_solution(&place.path("out/cycle-02/solve/solution.solb")).unwrap().content;
    for (p, value) in mesh.vertices.iter().zip(&field.fields[0].values) {
        assert!((p[0] * p[0] + 10.0 * p[1] * p[1] - value).abs() < 1e-4, "{p:?} {value}");
    }

    // A crash is told with the log.
    let place = Place::new(config);
    place.write("solve.sh", "echo reading the mesh; echo 'no licence' >&2; exit 7");
    let refused = place.refusal(&[]);
    assert!(refused.contains("cycle-01/solve: sh -c ended with exit code 7"), "{refused}");
    assert!(refused.contains("no licence") && refused.contains("cycle-01/solve/log.txt"), "{refused}");
    // What was wrong is mended, and the same command goes on.
    place.write("solve.sh", script);
    place.run(&["--quiet"]);
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_the_loop_after_the_child() {
    let config = "[mesh]\ncube = 1\n[solver.command]\nrun = 'touch {config}/began; sleep 2; echo done; cp {config}/u.sol {solution_out}'\n\
        solution_out = 'u.sol'\n[metric]\n[schedule]\ncomplexity = 10\ncycles = 1\n[transfer]\nmethod = 'none'\n[output]\nfolder = 'out'\npictures = false\n";
    let place = Place::new(config);
    let values: String = (0..8).map(|v| format!("{}\n", v * v)).collect();
    place.write("u.sol", &format!("MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n8\n1 1\n{values}End\n"));
    let child = place.command(&[]).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    while !place.path("began").exists() {
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(Command::new("sh").args(["-c", &format!("kill -s INT {}", child.id())]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    assert!(stderr(&output).contains("the same command goes on"), "{}", stderr(&output));
    assert_eq!(stderr(&output).matches("interrupted").count(), 1, "{}", stderr(&output));
    assert!(place.path("out/cycle-01/solve/done.json").exists(), "the child has ended");
    assert!(!place.path("out/cycle-01/metric").exists());
}

#[test]
fn a_configuration_that_cannot_be_is_refused_before_anything() {
    let cases = [
        (ANALYTIC.replace("cube = 3", "cube = 3\nfile = 'a.meshb'"), "give one of file (a mesh), bootstrap"),
        (ANALYTIC.replace("cube = 3", "file = 'a.meshb'"), "there is no file"),
        (ANALYTIC.replace("max_complexity = 400", ""), "nothing ends this loop"),
        (ANALYTIC.replace("sinfun3", "sinfun"), "line 6: unknown variant `sinfun`"),
        (ANALYTIC.replace("complexity = 100", "complexity = -1"), "[schedule] complexity = -1: give a positive number"),
        (ANALYTIC.replace("[output]", "[ouput]"), "unknown field `ouput`"),
        (ANALYTIC.replace("[output]", "[output]\ncut = 'w=1'"), "[output] cut: 'w=1' is no plane"),
        (ANALYTIC.replace("fields = [\"u\"]", "geometry = true"), "[metric] geometry = true needs a model"),
        (
            ANALYTIC.replace("[solver.analytic]\nfunction = \"sinfun3\"", "[solver.command]\nrun = 's {msh}'"),
            "{msh} is not known",
        ),
        (ANALYTIC.replace("\"u\"", "\"v\""), "[metric] fields: the solver has no field 'v'; there are u"),
        (ANALYTIC.replace("\"u\"", "\"u:x\""), "[metric] fields: 'u:x'"),
        (
            ANALYTIC.replace("[metric]", "[probes]\nmiddle = { field = 'w', at = [0, 0, 0] }\n[metric]"),
            "[probes] middle",
        ),
        (
            ANALYTIC.replace("[output]", "converged = { functional = 'eror', change = 0.1 }\n[output]"),
            "[schedule.converged] functional: the solver tells no 'eror'; it tells error",
        ),
        (
            ANALYTIC.replace("[output]", "[adapt]\noptions = ['--frezze', '1']\n[output]"),
            "unexpected argument '--frezze'",
        ),
        (ANALYTIC.replace("[\"u\"]", "[\"u\"]\nlocal = ['1:0.1']"), "write 3:h=0.01"),
    ];
    for (config, expected) in cases {
        let place = Place::new(&config);
        let message = place.refusal(&[]);
        assert!(message.contains(expected) && message.contains("loop.toml"), "{message}");
        assert!(!place.path("out").exists(), "{message}");
    }
}

#[test]
fn a_field_that_only_the_solve_tells_is_mended_without_another_solve() {
    let config = format!(
        "threads = 1\n[mesh]\ncube = 2\n[solver.command]\nrun = '{} field evaluate {{mesh}} --function sinfun3 -o {{solution_out}} -q && \
         echo solved >> {{config}}/solves'\nfields = ['u']\n[metric]\nfields = ['v']\n[schedule]\ncomplexity = 20\ncycles = 1\n\
         [output]\nfolder = 'out'\n",
        env!("CARGO_BIN_EXE_geo-adapt")
    );
    let place = Place::new(&config);
    assert!(place.refusal(&["-q"]).contains("the solver has no field 'v'; there are u"));
    let solves = || std::fs::read_to_string(place.path("solves")).unwrap().lines().count();
    assert_eq!(solves(), 1);
    place.write("loop.toml", &config.replace("['v']", "['u']"));
    let planned = place.run(&["--dry-run"]);
    assert!(planned.contains("metric.fields was [\"v\"] and is [\"u\"]"), "{planned}");
    assert!(planned.contains("2 steps are done, the last is cycle-01/solve"), "{planned}");
    assert!(planned.lines().any(|line| line.starts_with("next") && line.ends_with("cycle-01/metric")), "{planned}");
    let run = place.command(&[]).output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    assert!(stderr(&run).contains("taken, for nothing that depends on it is done"), "{}", stderr(&run));
    // The second solve is that of the second mesh.
    assert_eq!(solves(), 2);
    assert!(place.run(&["--dry-run"]).contains("nothing, the loop has ended"));
    // Now steps depend on it.
    place.write("loop.toml", &config.replace("['v']", "['u']\nhmax = 0.5"));
    assert!(place.refusal(&["--dry-run"]).contains("metric.hmax was null and is 0.5"));
}

#[test]
fn a_dry_run_does_nothing_and_refuses_what_a_run_would() {
    let place = Place::new(ANALYTIC);
    let planned = place.run(&["--dry-run"]);
    assert!(planned.contains("no step is done") && planned.contains("after 3 adaptations and 4 solves"), "{planned}");
    for row in ["1 100.0 200", "2 200.0 400", "3 400.0 800"] {
        let words = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(planned.lines().any(|line| words(line) == row), "{row}: {planned}");
    }
    assert!(!place.path("out").exists());
    place.write("out", "a file");
    assert!(place.refusal(&["--dry-run"]).contains("out is no folder"));
}

#[test]
fn examples_are_printed_and_the_analytic_one_runs() {
    let example = |kind: &str| program().args(["cycle", "--example", kind]).output().unwrap();
    for kind in ["analytic", "command"] {
        let output = example(kind);
        assert!(output.status.success() && !output.stdout.is_empty(), "{kind}");
    }
    let text = String::from_utf8(example("analytic").stdout).unwrap();
    let short = text.replace("max_complexity = 4000", "max_complexity = 1000").replace("every = 2", "every = 1");
    assert_ne!(short, text);
    let place = Place::new(&short.replace("folder = \"analytic\"", "folder = \"out\""));
    place.run(&[]);
}

#[test]
fn vtu_goes_to_the_program_and_comes_back() {
    // The program hands the file back: its fields are those of the last solve, and in the first cycle it takes those of a file that it has.
    let config = r#"
[mesh]
file = "cube.vtu"
[solver.command]
run = 'if [ {solution_in} = none ]; then cp {config}/cube.vtu {solution_out}; else cp {mesh} {solution_out}; fi'
mesh = "mesh.vtu"
solution_in = "before.csv"
solution_out = "solution.vtu"
[metric]
fields = ["U:norm"]
[schedule]
complexity = 50
cycles = 1
[output]
folder = "out"
pictures = false
"#;
    let place = Place::new(config);
    let mesh = crate::common::adapting::cube(3, |_| 1);
    let values = mesh.vertices.iter().flat_map(|p| [p[0] * p[0], p[1], 1.0]).collect();
    let field =
        geo_adapt::formats::NamedField { name: "U".into(), kind: geo_adapt::mesh::io::FieldKind::Vector, values };
    let data = geo_adapt::formats::Dataset { mesh, fields: vec![field], ..Default::default() };
    geo_adapt::formats::write(&place.path("cube.vtu"), &data).unwrap();
    place.run(&[]);
    let last = geo_adapt::mesh::io::read_solution(&place.path("out/cycle-02/solve/solution.solb")).unwrap().content;
    let mesh = geo_adapt::mesh::io::read_mesh(&place.path("out/cycle-01/adapt/mesh.meshb")).unwrap().content;
    assert_eq!(last.fields[0].kind, geo_adapt::mesh::io::FieldKind::Vector);
    for (p, u) in mesh.vertices.iter().zip(last.fields[0].values.chunks(3)) {
        assert!((u[1] - p[1]).abs() < 1e-6 && (u[2] - 1.0).abs() < 1e-6, "{p:?} {u:?}");
    }
}

#[test]
fn a_loop_of_another_version_is_not_gone_on_with() {
    let place = Place::new(&ANALYTIC.replace("max_complexity = 400", "cycles = 1"));
    place.run(&["--quiet"]);
    let (state, then) = (place.path("out/loop.json"), finished(&place));
    let text = std::fs::read_to_string(&state).unwrap();
    let own = format!("\"version\": \"{}\"", env!("CARGO_PKG_VERSION"));
    assert!(text.contains(&own), "{text}");
    std::fs::write(&state, text.replace(&own, "\"version\": \"0.0.7\"")).unwrap();
    let refused = place.refusal(&[]);
    assert!(refused.contains("begun by geo-adapt 0.0.7") && refused.contains(env!("CARGO_PKG_VERSION")), "{refused}");
    assert!(refused.contains("--restart") && finished(&place) == then, "{refused}");
    // One that says what this version cannot read is told by its version too.
    std::fs::write(&state, "{\"version\": \"9.0\", \"loops\": []}").unwrap();
    assert!(place.refusal(&[]).contains("begun by geo-adapt 9.0"));
    place.run(&["--quiet", "--restart"]);
}

#[test]
fn what_follows_from_an_unreadable_step_is_done_again() {
    let place = Place::new(&ANALYTIC.replace("max_complexity = 400", "cycles = 2"));
    place.run(&["--quiet"]);
    let (then, products) = (finished(&place), place.products());
    std::fs::write(place.path("out/cycle-01/metric/done.json"), "{ \"seconds\": ").unwrap();
    let run = place.command(&[]).output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    assert!(stderr(&run).contains("cycle-01/metric/done.json: cannot be read"), "{}", stderr(&run));
    let now = finished(&place);
    assert!(now.keys().eq(then.keys()), "{now:?} {then:?}");
    for (path, time) in &then {
        let stays =
            ["start/", "cycle-01/solve/", "cycle-01/picture/"].iter().any(|step| path.to_string_lossy().contains(step));
        assert_eq!(now[path] == *time, stays, "{}", path.display());
    }
    assert!(place.products() == products);
}

#[test]
fn an_input_that_was_changed_in_place_is_told() {
    let place =
        Place::new(&ANALYTIC.replace("cube = 3", "file = 'first.meshb'").replace("max_complexity = 400", "cycles = 1"));
    let write = |cells| {
        geo_adapt::mesh::io::write_mesh(&place.path("first.meshb"), &geo_adapt::mesh::samples::cube(cells)).unwrap()
    };
    write(3);
    place.run(&["--quiet"]);
    let then = finished(&place);
    write(2);
    let refused = place.refusal(&[]);
    assert!(refused.contains("first.meshb has changed") && refused.contains("--restart"), "{refused}");
    assert_eq!(finished(&place), then);
    // The names of its references are read too.
    write(3);
    place.write("first.names.json", "{\"triangles\": {\"1\": {\"name\": \"wall\"}}}");
    assert!(place.refusal(&[]).contains("first.names.json was not there"));
    std::fs::remove_file(place.path("first.names.json")).unwrap();
    place.run(&["--quiet"]);
    assert_eq!(finished(&place), then);
    write(2);
    place.run(&["--quiet", "--restart"]);
    assert_eq!(place.report()["cycles"][0]["vertices"], 27);
}

#[test]
fn files_that_a_killed_loop_was_writing_go_with_the_next_run() {
    let place = Place::new(&ANALYTIC.replace("max_complexity = 400", "cycles = 1"));
    place.run(&["--quiet"]);
    let left = ["out/.report.html.4711-0.tmp", "out/.report.json.4711-1.tmp", "out/.loop.json.1-0.tmp"];
    left.iter().for_each(|name| place.write(name, "half"));
    let others = ["out/.notes.tmp", "out/.report.html"];
    others.iter().for_each(|name| place.write(name, "mine"));
    place.run(&["--quiet"]);
    assert!(left.iter().all(|name| !place.path(name).exists()));
    assert!(others.iter().all(|name| place.path(name).exists()));
}

#[test]
fn braces_in_the_name_of_a_folder_are_no_template() {
    let config = "[mesh]\ncube = 1\n[solver.command]\nrun = 'cp {config}/u.sol {solution_out}; echo ${{HOME:-}}'\nsolution_out = 'u.sol'\n\
        [metric]\n[schedule]\ncomplexity = 10\ncycles = 1\n[transfer]\nmethod = 'none'\n[output]\nfolder = 'out'\npictures = false\n";
    let place = Place::new("");
    let folder = place.path("a}}b{{title}}");
    std::fs::create_dir(&folder).unwrap();
    std::fs::write(folder.join("loop.toml"), config).unwrap();
    let values: String = (0..8).map(|v| format!("{}\n", v * v)).collect();
    std::fs::write(
        folder.join("u.sol"),
        format!("MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n8\n1 1\n{values}End\n"),
    )
    .unwrap();
    // The second solve has another mesh: what matters is how far it comes.
    let run = program().arg("cycle").arg(folder.join("loop.toml")).output().unwrap();
    assert!(folder.join("out/cycle-01/adapt/done.json").is_file(), "{}", stderr(&run));
    let page = std::fs::read_to_string(folder.join("out/report.html")).unwrap();
    assert!(page.contains("<title>"), "{page}");
}

#[cfg(target_os = "linux")]
#[test]
fn the_number_of_a_leftover_is_no_licence_to_kill_and_a_wait_is_told() {
    use std::os::unix::process::CommandExt;
    let place = Place::new(
        "[mesh]\ncube = 1\n[solver.command]\nrun = 'exit 5'\n[metric]\n[schedule]\ncomplexity = 10\ncycles = 1\n[output]\nfolder = 'out'\n",
    );
    assert!(place.refusal(&[]).contains("exit code 5"));
    // A process that has the number of a leftover by chance: it was started at another time.
    let mut innocent = Command::new("sleep").arg("600").process_group(0).spawn().unwrap();
    for text in [innocent.id().to_string(), format!("{} 1 of-another-start", innocent.id())] {
        place.write("out/cycle-01/solve/pid", &text);
        // And somebody who holds the lock: this test.
        let lock = std::fs::File::open(place.path("out/cycle-01/solve/log.txt")).unwrap();
        lock.lock().unwrap();
        let said = place.path("said");
        let mut child =
            place.command(&[]).stdout(Stdio::null()).stderr(std::fs::File::create(&said).unwrap()).spawn().unwrap();
        let began = Instant::now();
        while !std::fs::read_to_string(&said).unwrap().contains("cycle-01/solve: waits for process") {
            assert!(
                began.elapsed() < Duration::from_secs(60) && child.try_wait().unwrap().is_none(),
                "it does not wait, or says nothing"
            );
            std::thread::sleep(Duration::from_millis(20));
        }
        let told = std::fs::read_to_string(&said).unwrap();
        assert!(told.contains(&format!("process {}", std::process::id())) && told.contains("log.txt"), "{told}");
        assert!(innocent.try_wait().unwrap().is_none(), "somebody else's process was killed");
        drop(lock);
        assert_eq!(child.wait().unwrap().code(), Some(2));
    }
    innocent.kill().unwrap();
    innocent.wait().unwrap();
}
