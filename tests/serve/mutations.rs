//! Requests that are wrong in any way: the service answers or closes, has no fault of its own, grows no memory, and shows nothing of others.
use crate::common::damage::Random;
use crate::owners::token;
use crate::service::{Service, cube, send};
use serde_json::json;
use std::fs;
use std::time::Duration;

/// What is put somewhere into a request.
const PIECES: [&[u8]; 24] = [
    b"/../",
    b"%2e%2e%2f",
    b"%00",
    b"\0",
    b"\r\n",
    b"\r\n\r\n",
    b"\xff\xfe",
    b"9999999999999999999999",
    b"-1",
    b"{",
    b"}",
    b"[[[[[[[[[[",
    b"\"",
    b"null",
    b"bytes=0-0,1-1,2-2",
    b"bytes=--",
    b"Transfer-Encoding: chunked\r\n",
    b"Content-Length: 5\r\n",
    b"Expect: 100-continue\r\n",
    b"';DROP TABLE jobs;--",
    b"{\"a\":{\"a\":{\"a\":",
    b"$(id)",
    b"<script>",
    b"Bearer ",
];

/// Changes a request in some places.
fn mutated(request: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = request.to_vec();
    for _ in 0..=random.below(3) {
        let at = random.below(bytes.len());
        match random.below(7) {
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes.truncate(at.max(1)),
            2 => drop(bytes.splice(at..at, random.of(&PIECES).iter().copied())),
            3 => {
                let end = (at + random.below(40)).min(bytes.len());
                bytes.drain(at..end);
            }
            4 => {
                let end = (at + random.below(60)).min(bytes.len());
                let again = bytes[at..end].to_vec();
                drop(bytes.splice(at..at, again));
            }
            5 => drop(bytes.splice(at..at, std::iter::repeat_n(b'A', 1 << random.below(15)))),
            _ => bytes[at] = random.below(256) as u8,
        }
        if bytes.is_empty() {
            bytes.push(b'G');
        }
    }
    bytes
}

/// Bytes of memory of a process.
pub fn memory(process: u32) -> u64 {
    let text = fs::read_to_string(format!("/proc/{process}/statm")).unwrap();
    text.split(' ').nth(1).unwrap().parse::<u64>().unwrap() * 4096
}

#[test]
fn nothing_that_is_sent_does_harm() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &["--tokens-only", "--rate", "1000000", "--owner-jobs", "20"]);
    let (ann, bob) = (token(folder.path(), "ann", "read,write"), token(folder.path(), "bob", "read,write"));
    // What is another one's, with a word in it that nobody else may see.
    let secret = "only-for-ann-5f2e";
    let of_ann = service.ask("POST", &format!("/v1/files?name={secret}.txt"), &[&ann], secret.as_bytes()).json();
    let of_ann = of_ann["id"].as_str().unwrap();
    let mesh = service.ask("POST", "/v1/files?name=a.meshb", &[&bob], &cube(1)).json();
    let mesh = mesh["id"].as_str().unwrap();
    let job =
        json!({ "command": "inspect", "arguments": ["a.meshb", "--json"], "files": { "a.meshb": mesh }, "label": "a" })
            .to_string();
    let made = service.ask("POST", "/v1/jobs", &[&bob, "Content-Type: application/json"], job.as_bytes()).json();
    let made = made["id"].as_str().unwrap();
    let begun = service.ask("POST", "/v1/uploads?name=b.meshb", &[&bob, "Upload-Length: 1000000"], b"");
    let upload = begun.header("location").unwrap();
    let template = |method: &str, path: &str, headers: &str, body: &[u8]| {
        let length = body.len();
        let head = format!(
            "{method} {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n{bob}\r\n{headers}Content-Length: {length}\r\n\r\n"
        );
        [head.as_bytes(), body].concat()
    };
    let json_kind = "Content-Type: application/json\r\n";
    let requests = [
        template("GET", "/v1/me", "", b""),
        template("GET", "/v1/files?kind=mesh", "", b""),
        template("POST", "/v1/files?name=x.step", "", b"some bytes"),
        template("GET", &format!("/v1/files/{mesh}/content"), "Range: bytes=10-20\r\n", b""),
        template("GET", &format!("/v1/files/{of_ann}/content"), "", b""),
        template("DELETE", &format!("/v1/files/{of_ann}"), "", b""),
        template("POST", "/v1/jobs", json_kind, job.as_bytes()),
        template("POST", "/v1/jobs", json_kind, job.replace(mesh, of_ann).as_bytes()),
        template(
            "GET",
            &format!("/v1/jobs/{made}/results/printed.txt"),
            "If-None-Match: \"a\"\r\nRange: bytes=-5\r\n",
            b"",
        ),
        template("GET", "/v1/jobs?state=done&limit=5&before=0", "", b""),
        template("POST", &format!("/v1/jobs/{made}/cancel"), "", b""),
        template("PATCH", upload, "Upload-Offset: 0\r\nContent-Type: application/offset+octet-stream\r\n", b"abc"),
        template("POST", "/v1/uploads?name=c.meshb", "Upload-Length: 10\r\n", b""),
        template("HEAD", upload, "", b""),
        template("POST", "/v1/session", json_kind, br#"{"token":"ga_0"}"#),
        template("GET", "/v1/commands", "", b""),
    ];
    let count = if std::env::var_os("GEO_ADAPT_LONG").is_some() { 100_000 } else { 3_000 };
    let mut random = Random(20_261_126);
    let mut before = 0;
    for i in 0..count {
        if i == count / 3 {
            before = memory(service.process());
        }
        let chosen: &Vec<u8> = random.of(&requests);
        let request = mutated(chosen, &mut random);
        if let Some(answer) = send_and_leave(service.address(), &request) {
            let shown = || format!("{}\n{}", String::from_utf8_lossy(&request), answer.text());
            assert!((100..500).contains(&answer.status) || answer.status == 507, "{}", shown());
            assert!(!answer.text().contains(secret) && !answer.head.contains(secret), "{}", shown());
        }
    }
    assert_eq!(service.get("/healthz").status, 200);
    let grown = memory(service.process()).saturating_sub(before);
    assert!(grown < 64 << 20, "{grown} bytes more");
    let still = service.ask("GET", &format!("/v1/files/{of_ann}/content"), &[&ann], b"");
    assert_eq!(still.text(), secret);
    // Nothing of a client's lies outside of its place.
    let names: Vec<String> =
        fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    assert!(
        names.iter().all(|name| ["uploads", "jobs", "blobs", "lock"].contains(&name.as_str())
            || name.starts_with("catalogue.sqlite")),
        "{names:?}"
    );
}

/// As a client that has no more to say, and leaves soon.
fn send_and_leave(address: &str, request: &[u8]) -> Option<crate::service::Answer> {
    // A blank line ends a head that was cut off; a body that is too short ends with the connection.
    let ended = [request, b"\r\n\r\n"].concat();
    send(address, &ended, Duration::from_millis(150))
}
