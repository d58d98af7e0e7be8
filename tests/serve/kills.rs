//! Services that are killed at any moment lose nothing that they have acknowledged: every job ends, once, with the result of the program.
use crate::jobs::made;
use crate::postgres::Postgres;
use crate::service::{PATIENCE, Service, cube, send};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// The sizes of the meshes that are asked for.
const SIZES: [&str; 3] = ["0.25", "0.2", "0.15"];

/// Jobs that were accepted: which one, and of which size.
type Accepted = Arc<Mutex<Vec<(String, usize)>>>;

/// Asks for jobs of one service until it shall end; what is not acknowledged is nothing.
fn ask_on(address: &str, id: &str, accepted: &Accepted, ends: &AtomicBool) {
    let mut at = 0;
    while !ends.load(SeqCst) {
        at = (at + 1) % SIZES.len();
        let words = json!(["in.meshb", "-o", "out.meshb", "--size", SIZES[at]]);
        let body = json!({ "command": "adapt", "arguments": words, "files": { "in.meshb": id } }).to_string();
        let head = format!(
            "POST /v1/jobs HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\nContent-Type: application/json\r\nContent-Length: {}\r\n\r\n",
            body.len()
        );
        if let Some(answer) = send(address, (head + &body).as_bytes(), PATIENCE).filter(|answer| answer.status == 202) {
            let job: Value = answer.json();
            accepted.lock().unwrap().push((job["id"].as_str().unwrap().to_owned(), at));
        }
        std::thread::sleep(Duration::from_millis(120));
    }
}

/// Kills services that share what they have, one after the other, so many times.
fn lose_nothing(arguments: &[&str], services: usize, kills: u32) {
    let folders: Vec<_> = (0..services).map(|_| tempfile::tempdir().unwrap()).collect();
    let mesh = cube(2);
    let expected: Vec<Vec<u8>> = SIZES.iter().map(|size| made(&mesh, &["--size", size])).collect();
    let mut all: Vec<Option<Service>> =
        folders.iter().map(|folder| Some(Service::start(folder.path(), arguments))).collect();
    let addresses: Vec<String> = all.iter().flatten().map(|service| service.address().to_owned()).collect();
    let id = all[0].as_ref().unwrap().upload("in.meshb", &mesh);
    let (accepted, ends) = (Accepted::default(), AtomicBool::new(false));
    std::thread::scope(|scope| {
        for address in &addresses {
            scope.spawn(|| ask_on(address, &id, &accepted, &ends));
        }
        for kill in 0..kills {
            // A golden-ratio sequence spreads evenly, however long it is.
            std::thread::sleep(Duration::from_secs_f64(0.1 + (f64::from(kill) * 0.618_033_988_749) % 1.0));
            let at = kill as usize % services;
            all[at].take().unwrap().kill();
            all[at] = Some(Service::start_at(&addresses[at], folders[at].path(), arguments));
        }
        ends.store(true, SeqCst);
    });
    let accepted = accepted.lock().unwrap();
    assert!(accepted.len() >= kills as usize, "{} jobs", accepted.len());
    let service = all[0].as_ref().unwrap();
    let began = Instant::now();
    let mut attempts: BTreeMap<i64, usize> = BTreeMap::new();
    for (job, size) in accepted.iter() {
        let ended = service.ended(job);
        assert!(ended["state"] == "done" && began.elapsed() < Duration::from_secs(1200), "{ended}");
        assert!(service.result(job, "out.meshb") == expected[*size], "{ended}");
        *attempts.entry(ended["attempt"].as_i64().unwrap()).or_default() += 1;
    }
    // Nothing but what was accepted, or was on the way to it, is there.
    eprintln!("{} jobs of {kills} kills; how often each was begun: {attempts:?}", accepted.len());
    let waiting = service.get("/v1/jobs?state=running").json().as_array().unwrap().len();
    assert!(waiting <= services, "{waiting} run on");
}

fn kills(few: u32) -> u32 {
    if std::env::var_os("GEO_ADAPT_LONG").is_some() { 100 } else { few }
}

#[test]
fn with_sqlite() {
    lose_nothing(&[], 1, kills(5));
}

#[test]
fn two_services_that_share_a_queue_in_postgresql() {
    let Some(database) = Postgres::start() else { return };
    let store = tempfile::tempdir().unwrap();
    let (url, folder) = (database.url(), store.path().to_str().unwrap());
    lose_nothing(&["--database", &url, "--store", folder, "--jobs", "1"], 2, kills(4));
}
