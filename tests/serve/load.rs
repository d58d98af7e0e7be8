//! Many who listen and much that is sent take little memory; who says nothing does not stay.
use crate::service::{PATIENCE, Service, cube};
use serde_json::json;
use std::fs;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Most memory that the service ever had, bytes.
fn peak(process: u32) -> u64 {
    let text = fs::read_to_string(format!("/proc/{process}/status")).unwrap();
    let line = text.lines().find(|line| line.starts_with("VmHWM:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap() * 1024
}

#[test]
fn many_streams_and_a_large_upload_take_little_memory() {
    let (streams, megabytes) = if std::env::var_os("GEO_ADAPT_LONG").is_some() { (500, 2048_u64) } else { (200, 64) };
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &["--jobs", "1"]);
    let id = service.upload("in.meshb", &cube(4));
    let words = json!(["in.meshb", "-o", "out.meshb", "--analytic", "polar-2", "--complexity", "200000"]);
    let job = service.accepted("adapt", words.clone(), json!({ "in.meshb": id }));
    let waits = service.accepted("adapt", words, json!({ "in.meshb": id }));
    let address = service.address().to_owned();
    let listen = |_| {
        let mut stream = TcpStream::connect(&address).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        write!(stream, "GET /v1/jobs/{waits}/events HTTP/1.1\r\nHost: {address}\r\n\r\n").unwrap();
        let mut first = [0; 12];
        stream.read_exact(&mut first).unwrap();
        assert_eq!(&first, b"HTTP/1.1 200");
        stream
    };
    let mut listeners: Vec<TcpStream> = (0..streams).map(listen).collect();
    let mut upload = TcpStream::connect(&address).unwrap();
    let length = megabytes << 20;
    write!(upload, "POST /v1/files?name=large.meshb HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\nContent-Length: {length}\r\n\r\n").unwrap();
    let piece: Vec<u8> = (0..1 << 20).map(|i: u32| (i % 249) as u8).collect();
    for _ in 0..megabytes {
        upload.write_all(&piece).unwrap();
    }
    let mut answer = String::new();
    upload.read_to_string(&mut answer).unwrap();
    assert!(answer.starts_with("HTTP/1.1 201"), "{answer}");
    let began = Instant::now();
    assert_eq!(service.get(&format!("/v1/jobs/{waits}")).json()["state"], "queued");
    assert!(began.elapsed() < Duration::from_secs(20));
    for job in [&waits, &job] {
        service.ask("POST", &format!("/v1/jobs/{job}/cancel"), &[], b"");
    }
    // All of them hear of the end.
    for listener in &mut listeners {
        let (mut text, mut bytes) = (String::new(), [0; 4096]);
        while !text.contains("event: end") {
            let read = listener.read(&mut bytes).unwrap();
            assert!(read > 0, "{text}");
            text.push_str(&String::from_utf8_lossy(&bytes[..read]));
        }
    }
    let most = peak(service.process());
    assert!(most < 500 << 20, "{most} bytes");
}

#[test]
fn who_says_nothing_does_not_stay() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &[]);
    let mut stream = TcpStream::connect(service.address()).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    stream.write_all(b"GET /v1/me HTTP/1.1\r\nHost:").unwrap();
    let began = Instant::now();
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);
    assert!(began.elapsed() < Duration::from_secs(60), "{:?}", began.elapsed());
}
