//! Loops as jobs: of the analytic solver, and of those that the operator has set up; nothing else of a configuration is run.
use crate::common::program;
use crate::service::{Service, cube};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

const ANALYTIC: &str = "[mesh]\nfile = 'a.meshb'\n[solver.analytic]\nfunction = 'tanh3'\n[metric]\n[schedule]\ncomplexity = 300\ncycles = 2\n[output]\npictures = false\n";

fn with_solver(table: &str) -> String {
    ANALYTIC.replace("[solver.analytic]\nfunction = 'tanh3'", table)
}

fn ask(service: &Service, text: &str) -> String {
    let files = json!({ "loop.toml": service.upload("loop.toml", text.as_bytes()), "a.meshb": service.upload("a.meshb", &cube(4)) });
    service.accepted("cycle", json!(["loop.toml"]), files)
}

/// How a job of a configuration ends.
fn ended(service: &Service, text: &str) -> (String, Value) {
    let job = ask(service, text);
    let ended = service.ended(&job);
    (job, ended)
}

/// What `geo-adapt cycle` itself makes.
fn made(folder: &Path, text: &str) -> Vec<u8> {
    fs::write(folder.join("loop.toml"), text).unwrap();
    fs::write(folder.join("a.meshb"), cube(4)).unwrap();
    let output = program().current_dir(folder).args(["cycle", "loop.toml", "--threads", "1"]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    fs::read(folder.join("loop.cycle/result/mesh.meshb")).unwrap()
}

#[test]
fn a_loop_makes_what_the_program_makes() {
    let (folder, own) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let service = Service::start(folder.path(), &["--threads", "1"]);
    let (job, end) = ended(&service, ANALYTIC);
    assert_eq!(end["state"], "done", "{end}");
    assert!(service.result(&job, "mesh.meshb") == made(own.path(), ANALYTIC));
    for name in ["solution.solb", "result.vtu", "report.html", "report.json", "functionals.csv"] {
        assert!(!service.result(&job, name).is_empty());
    }
    // The same by the client: the configuration lies elsewhere, and so does what it names.
    let there = tempfile::tempdir().unwrap();
    fs::create_dir(there.path().join("meshes")).unwrap();
    fs::write(there.path().join("meshes/a.meshb"), cube(4)).unwrap();
    fs::write(there.path().join("loop.toml"), ANALYTIC.replace("a.meshb", "meshes/a.meshb")).unwrap();
    let mut command = program();
    let output =
        command.current_dir(there.path()).args(["cycle", "loop.toml", "--server", &service.url()]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    // Results are called by their places here, not by those of the service.
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(
        said.contains(" loop.cycle/result/mesh.meshb") && !said.contains(folder.path().to_str().unwrap()),
        "{said}"
    );
    for name in ["mesh.meshb", "solution.solb", "functionals.csv"] {
        let of = |folder: &Path| fs::read(folder.join("loop.cycle/result").join(name)).unwrap();
        assert!(of(there.path()) == of(own.path()), "{name}");
    }
}

#[test]
fn only_what_the_operator_has_set_up_is_run() {
    let folder = tempfile::tempdir().unwrap();
    let tools = tempfile::tempdir().unwrap();
    let tool = tools.path().join("solve.sh");
    // It solves with this program, in a process that outlives the shell if nobody ends it.
    let own = env!("CARGO_BIN_EXE_geo-adapt");
    fs::write(&tool, format!("sleep 12345 & '{own}' field evaluate \"$1\" --function sinfun3 -o \"$2\"\n")).unwrap();
    let solvers = tools.path().join("solvers.toml");
    let reads = format!("reads = ['{}']", tools.path().display());
    let text = format!(
        "[own]\n{reads}\n[own.command]\nrun = \"sh {} {{mesh}} {{solution_out}}\"\nfields = ['u']\n",
        tool.display()
    );
    fs::write(&solvers, text).unwrap();
    let service = Service::start(folder.path(), &["--solvers", solvers.to_str().unwrap()]);
    assert_eq!(service.get("/v1/me").json()["solvers"], json!(["own"]));
    let (_, end) = ended(&service, &with_solver("[solver.named]\nname = 'own'"));
    assert_eq!(end["state"], "done", "{end}");
    assert!(is_gone_soon(), "what a solver has left behind goes on");
    for (table, why) in [
        ("[solver.command]\nrun = 'touch stolen'", "only [solver.analytic]"),
        ("[solver.named]\nname = 'other'", "there are own"),
        ("[solver.su2]\nconfig = '/etc/passwd'", "no folders here"),
    ] {
        let (job, end) = ended(&service, &with_solver(table));
        let reason = end["reason"].as_str().unwrap_or_default();
        assert!(end["exit_code"] == 2 && reason.contains(why), "{end}");
        assert_ne!(service.get(&format!("/v1/jobs/{job}/results/stolen")).status, 200);
    }
    for word in ["--confined=/etc/passwd", "--threads=64"] {
        let answer = service.job("cycle", json!(["loop.toml", word]), json!({}));
        assert!(answer.status == 400 && answer.text().contains("the service's to decide"), "{}", answer.text());
    }
}

/// Whether the solver's `sleep` is not there any more.
fn is_gone_soon() -> bool {
    let began = Instant::now();
    loop {
        let all = fs::read_dir("/proc").unwrap().flatten();
        let left = all.filter(|process| {
            fs::read(process.path().join("cmdline")).is_ok_and(|words| words.starts_with(b"sleep\x0012345\0"))
        });
        if left.count() == 0 {
            return true;
        }
        if began.elapsed() > Duration::from_secs(10) {
            return false;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn a_loop_that_is_cancelled_leaves_its_last_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &[]);
    let job = ask(&service, &ANALYTIC.replace("cycles = 2", "cycles = 1000\nfactor = 1.0"));
    let began = Instant::now();
    while service.get(&format!("/v1/jobs/{job}")).json()["progress"].is_null()
        && began.elapsed() < Duration::from_secs(60)
    {
        std::thread::sleep(Duration::from_millis(50));
    }
    service.ask("POST", &format!("/v1/jobs/{job}/cancel"), &[], b"");
    assert_eq!(service.ended(&job)["state"], "cancelled");
    assert!(!service.result(&job, "mesh.meshb").is_empty() && !service.result(&job, "solution.solb").is_empty());
}
