//! Jobs: what they make is what the program makes, and they end however they must.
use crate::common::program;
use crate::service::{Service, cube};
use serde_json::json;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

/// What the program itself makes of a mesh.
pub fn made(mesh: &[u8], arguments: &[&str]) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.meshb"), mesh).unwrap();
    let mut command = program();
    command.current_dir(&folder).args(["adapt", "in.meshb", "-o", "out.meshb", "--threads", "1", "--deterministic"]);
    assert!(command.args(arguments).output().unwrap().status.success());
    fs::read(folder.path().join("out.meshb")).unwrap()
}

#[test]
fn a_job_makes_what_the_program_makes() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &[]);
    let mesh = cube(3);
    let id = service.upload("in.meshb", &mesh);
    let words = json!(["in.meshb", "-o", "out.meshb", "--size", "0.15", "--report", "r.json"]);
    let named = json!({ "mesh": "in.meshb", "output": "out.meshb", "size": 0.15, "report": "r.json" });
    let expected = made(&mesh, &["--size", "0.15"]);
    for arguments in [words, named] {
        let job = service.accepted("adapt", arguments, json!({ "in.meshb": id }));
        let ended = service.ended(&job);
        assert_eq!((ended["state"].as_str(), ended["exit_code"].as_i64()), (Some("done"), Some(0)), "{ended}");
        assert!(service.result(&job, "out.meshb") == expected);
        let report: serde_json::Value = serde_json::from_slice(&service.result(&job, "r.json")).unwrap();
        assert!(report["statistics"].is_object());
        let names: Vec<String> = service
            .get(&format!("/v1/jobs/{job}/results"))
            .json()
            .as_array()
            .unwrap()
            .iter()
            .map(|of| of["name"].as_str().unwrap().to_owned())
            .collect();
        assert!(
            ["out.meshb", "out.solb", "printed.txt", "r.json"].iter().all(|name| names.contains(&(*name).to_owned())),
            "{names:?}"
        );
        assert!(!names.contains(&"in.meshb".to_owned()));
    }
    // The result of one is the input of the next, without going down and up.
    let contents = service.get("/v1/jobs").json()[0]["id"].as_str().unwrap().to_owned();
    let results = service.get(&format!("/v1/jobs/{contents}/results")).json();
    let out = results.as_array().unwrap().iter().find(|of| of["name"] == "out.meshb").unwrap()["id"].clone();
    let job = service.accepted("inspect", json!(["a.meshb", "--json"]), json!({ "a.meshb": out }));
    assert_eq!(service.ended(&job)["state"], "done");
    assert!(String::from_utf8(service.result(&job, "printed.txt")).unwrap().contains("\"valid\": true"));
}

#[test]
fn a_job_that_fails_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &[]);
    let id = service.upload("in.meshb", b"this is no mesh");
    let job =
        service.accepted("adapt", json!(["in.meshb", "-o", "out.meshb", "--size", "0.1"]), json!({ "in.meshb": id }));
    let ended = service.ended(&job);
    assert_eq!((ended["state"].as_str(), ended["exit_code"].as_i64()), (Some("failed"), Some(2)), "{ended}");
    assert!(ended["reason"].as_str().unwrap().contains("in.meshb"), "{ended}");
    assert!(service.get(&format!("/v1/jobs/{job}/log")).text().contains("geo-adapt: error:"));
}

#[test]
fn what_leads_elsewhere_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &[]);
    let id = service.upload("in.meshb", &cube(1));
    let files = json!({ "in.meshb": id });
    for (command, words) in [
        ("adapt", vec!["/etc/passwd", "-o", "out.meshb", "--size", "0.1"]),
        ("adapt", vec!["in.meshb", "-o", "../out.meshb", "--size", "0.1"]),
        ("adapt", vec!["in.meshb", "-o", "/tmp/out.meshb", "--size", "0.1"]),
        ("adapt", vec!["in.meshb", "-o", "out.meshb", "--metric", "a/b.solb"]),
        ("adapt", vec!["in.meshb", "-o", "out.meshb", "--size", "0.1", "--threads", "64"]),
        ("adapt", vec!["in.meshb", "-o", "out.meshb", "--size", "0.1", "--scratch", "x", "--memory", "1MB"]),
        ("adapt", vec!["in.meshb", "-o", "out.meshb", "--size", "0.1", "--server", "http://localhost:1"]),
        ("adapt", vec!["in.meshb", "-o", "out.meshb", "--size", "tiny"]),
        ("adapt", vec!["in.meshb", "-o", "in.meshb", "--size", "0.1"]),
        ("serve", vec![]),
        ("serve token add", vec!["me"]),
        ("cycle", vec!["../loop.toml"]),
        ("tune", vec![]),
        ("su2", vec!["x"]),
        ("completions", vec!["bash"]),
        ("adapt --help", vec![]),
        ("", vec![]),
    ] {
        let answer = service.job(command, json!(words), files.clone());
        assert_eq!(answer.status, 400, "{command} {words:?}: {}", answer.text());
        assert!(
            answer.header("content-type").unwrap().contains("problem+json")
                && !answer.json()["detail"].as_str().unwrap().is_empty()
        );
    }
    for name in ["../in.meshb", "/in.meshb", ".in.meshb", "-o", "a\nb"] {
        let answer = service.job("inspect", json!(["x.meshb"]), json!({ name: id }));
        assert_eq!(answer.status, 400, "{name}: {}", answer.text());
    }
    let nobody = "0".repeat(64);
    assert_eq!(service.job("inspect", json!(["a.meshb"]), json!({ "a.meshb": nobody })).status, 400);
}

/// A mesh that takes a while.
const LONG: [&str; 7] = ["in.meshb", "-o", "out.meshb", "--analytic", "polar-2", "--complexity", "60000"];

fn running(service: &Service, job: &str) {
    let began = Instant::now();
    while service.get(&format!("/v1/jobs/{job}")).json()["progress"]["kind"] != "pass" {
        assert!(began.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_job_that_is_cancelled_keeps_its_last_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &["--jobs", "1"]);
    let id = service.upload("in.meshb", &cube(4));
    let job = service.accepted("adapt", json!(LONG), json!({ "in.meshb": id }));
    let waits = service.accepted("adapt", json!(LONG), json!({ "in.meshb": id }));
    running(&service, &job);
    assert_eq!(service.ask("DELETE", &format!("/v1/jobs/{job}"), &[], b"").status, 409);
    for job in [&waits, &job] {
        assert_eq!(service.ask("POST", &format!("/v1/jobs/{job}/cancel"), &[], b"").status, 202);
        assert_eq!(service.ended(job)["state"], "cancelled");
    }
    let mesh = service.result(&job, "out.meshb");
    let path = folder.path().join("out.meshb");
    fs::write(&path, mesh).unwrap();
    let read = geo_adapt::mesh::io::read_mesh(&path).unwrap().content;
    assert!(geo_adapt::mesh::validity::check(&read).is_valid());
    assert_eq!(service.ask("DELETE", &format!("/v1/jobs/{job}"), &[], b"").status, 204);
    assert_eq!(service.get(&format!("/v1/jobs/{job}/results/out.meshb")).status, 404);
}

#[test]
fn a_job_that_is_cancelled_again_keeps_its_last_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &[]);
    let id = service.upload("in.meshb", &cube(4));
    let job = service.accepted("adapt", json!(LONG), json!({ "in.meshb": id }));
    running(&service, &job);
    for _ in 0..3 {
        assert_eq!(service.ask("POST", &format!("/v1/jobs/{job}/cancel"), &[], b"").status, 202);
    }
    assert_eq!(service.ended(&job)["state"], "cancelled");
    assert!(!service.result(&job, "out.meshb").is_empty());
}

#[test]
fn no_more_jobs_are_at_work_than_may_be() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &["--jobs", "2"]);
    let id = service.upload("in.meshb", &cube(4));
    let jobs: Vec<String> = (0..5).map(|_| service.accepted("adapt", json!(LONG), json!({ "in.meshb": id }))).collect();
    running(&service, &jobs[1]);
    for _ in 0..20 {
        let at_work = service.get("/v1/jobs?state=running").json();
        assert!(at_work.as_array().unwrap().len() <= 2, "{at_work}");
        std::thread::sleep(Duration::from_millis(20));
    }
    for job in jobs.iter().rev() {
        service.ask("POST", &format!("/v1/jobs/{job}/cancel"), &[], b"");
    }
}

#[test]
fn what_is_for_a_terminal_is_no_command() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &[]);
    let listed = service.get("/v1/commands").json();
    let names: Vec<&str> = listed.as_array().unwrap().iter().map(|of| of["command"].as_str().unwrap()).collect();
    assert!(names.contains(&"metric scale") && !names.iter().any(|name| name.contains("help")), "{names:?}");
    assert_eq!(service.job("metric help scale", json!([]), json!({})).status, 400);
}

#[test]
fn the_stream_of_events_tells_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &[]);
    let id = service.upload("in.meshb", &cube(2));
    let job =
        service.accepted("adapt", json!(["in.meshb", "-o", "out.meshb", "--size", "0.1"]), json!({ "in.meshb": id }));
    let text = service.get(&format!("/v1/jobs/{job}/events")).text();
    let events: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("event: ")).collect();
    assert_eq!(events.last(), Some(&"end"), "{text}");
    assert!(text.lines().rev().find_map(|line| line.strip_prefix("data: ")).unwrap().contains("\"done\""));
}

#[test]
fn a_service_that_is_killed_loses_no_job() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = cube(3);
    let expected = made(&mesh, &["--size", "0.1"]);
    let service = Service::start(folder.path(), &[]);
    let id = service.upload("in.meshb", &mesh);
    let ask = |service: &Service| {
        service.accepted("adapt", json!(["in.meshb", "-o", "out.meshb", "--size", "0.1"]), json!({ "in.meshb": id }))
    };
    let mut jobs: Vec<String> = (0..4).map(|_| ask(&service)).collect();
    std::thread::sleep(Duration::from_millis(300));
    service.kill();
    let service = Service::start(folder.path(), &[]);
    jobs.push(ask(&service));
    for job in &jobs {
        let ended = service.ended(job);
        assert_eq!(ended["state"], "done", "{ended}");
        assert!(service.result(job, "out.meshb") == expected);
    }
}

#[test]
fn what_asks_for_too_much_is_ended_with_its_reason() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &["--max-vertices", "5000"]);
    let id = service.upload("in.meshb", &cube(3));
    let job =
        service.accepted("adapt", json!(["in.meshb", "-o", "out.meshb", "--size", "0.01"]), json!({ "in.meshb": id }));
    let ended = service.ended(&job);
    assert_eq!(ended["state"], "failed", "{ended}");
    assert!(ended["reason"].as_str().unwrap().contains("a job here may make 5000"), "{ended}");
}

#[test]
fn a_service_goes_on_when_its_file_is_replaced() {
    let (folder, place) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let own = place.path().join("geo-adapt");
    fs::copy(env!("CARGO_BIN_EXE_geo-adapt"), &own).unwrap();
    let service = Service::start_of(std::process::Command::new(&own), "127.0.0.1:0", folder.path(), &[]);
    fs::remove_file(&own).unwrap();
    fs::write(&own, "another version").unwrap();
    let model = fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("geometry/cube.step")).unwrap();
    let id = service.upload("cube.step", &model);
    // A warm process for the model, in a process that reads it apart.
    let job = service.accepted("model", json!(["cube.step", "--json"]), json!({ "cube.step": id }));
    let ended = service.ended(&job);
    assert_eq!(ended["state"], "done", "{ended}");
}
