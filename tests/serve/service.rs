//! A service for a test, and requests to it.
use crate::common::program;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// How long anything may take: what hangs, hangs for ever.
pub const PATIENCE: Duration = Duration::from_secs(120);

/// A service that ends with this.
pub struct Service {
    child: Child,
    address: String,
}

/// An answer.
pub struct Answer {
    pub status: u16,
    pub head: String,
    pub body: Vec<u8>,
}

impl Answer {
    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&self.body)))
    }

    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    /// What a header says.
    pub fn header(&self, name: &str) -> Option<&str> {
        self.head.lines().find_map(|line| {
            let (known, value) = line.split_once(':')?;
            known.eq_ignore_ascii_case(name).then_some(value.trim())
        })
    }
}

impl Service {
    /// Starts one on this folder, with these arguments beside.
    pub fn start(data: &Path, arguments: &[&str]) -> Self {
        Self::start_at("127.0.0.1:0", data, arguments)
    }

    /// The same, at an address.
    pub fn start_at(address: &str, data: &Path, arguments: &[&str]) -> Self {
        Self::start_of(program(), address, data, arguments)
    }

    /// The same, of a copy of the program.
    pub fn start_of(mut command: Command, address: &str, data: &Path, arguments: &[&str]) -> Self {
        command.args(["serve", "--listen", address, "--data"]).arg(data).args(arguments);
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let mut said = String::new();
        let address = loop {
            let line = lines.next().unwrap_or_else(|| panic!("it does not start: {said}")).unwrap();
            if let Some((_, rest)) = line.split_once("listens at http://") {
                break rest.split(';').next().unwrap().to_owned();
            }
            said.push_str(&line);
        };
        // It goes on writing: nobody else reads it.
        std::thread::spawn(move || lines.for_each(drop));
        Self { child, address }
    }

    pub fn url(&self) -> String {
        format!("http://{}", self.address)
    }

    pub fn process(&self) -> u32 {
        self.child.id()
    }

    pub fn address(&self) -> &str {
        &self.address
    }

    /// Kills it, as a power failure would.
    pub fn kill(mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }

    /// Bytes as they are, and the answer to them.
    pub fn send(&self, request: &[u8]) -> Answer {
        send(&self.address, request, PATIENCE).expect("the service is there")
    }

    /// A request with headers, each a line of its own.
    pub fn ask(&self, method: &str, path: &str, headers: &[&str], body: &[u8]) -> Answer {
        let more: String = headers.iter().map(|header| format!("{header}\r\n")).collect();
        let head = format!(
            "{method} {path} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\nContent-Length: {}\r\n{more}\r\n",
            self.address,
            body.len()
        );
        self.send(&[head.as_bytes(), body].concat())
    }

    pub fn get(&self, path: &str) -> Answer {
        self.ask("GET", path, &[], b"")
    }

    /// Uploads contents under a name: the id.
    pub fn upload(&self, name: &str, contents: &[u8]) -> String {
        let answer = self.ask("POST", &format!("/v1/files?name={name}"), &[], contents);
        assert_eq!(answer.status, 201, "{}", answer.text());
        answer.json()["id"].as_str().unwrap().to_owned()
    }

    /// Asks for a job.
    pub fn job(&self, command: &str, arguments: Value, files: Value) -> Answer {
        let request = json!({ "command": command, "arguments": arguments, "files": files }).to_string();
        self.ask("POST", "/v1/jobs", &["Content-Type: application/json"], request.as_bytes())
    }

    /// Asks for a job that is accepted: its id.
    pub fn accepted(&self, command: &str, arguments: Value, files: Value) -> String {
        let answer = self.job(command, arguments, files);
        assert_eq!(answer.status, 202, "{}", answer.text());
        answer.json()["id"].as_str().unwrap().to_owned()
    }

    /// Waits for the end of a job.
    pub fn ended(&self, id: &str) -> Value {
        let began = Instant::now();
        loop {
            let job = self.get(&format!("/v1/jobs/{id}")).json();
            if !["queued", "running"].contains(&job["state"].as_str().unwrap()) {
                return job;
            }
            assert!(began.elapsed() < PATIENCE, "{job}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// What a job has made.
    pub fn result(&self, id: &str, name: &str) -> Vec<u8> {
        let answer = self.get(&format!("/v1/jobs/{id}/results/{name}"));
        assert_eq!(answer.status, 200, "{name}: {}", answer.text());
        answer.body
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Sends bytes as they are; none where nobody answers for so long.
pub fn send(address: &str, request: &[u8], patience: Duration) -> Option<Answer> {
    let mut stream = TcpStream::connect(address).ok()?;
    stream.set_read_timeout(Some(patience)).ok()?;
    // What is refused early need not be read to its end.
    let _ = stream.write_all(request);
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);
    let split = answer.windows(4).position(|at| at == b"\r\n\r\n")?;
    let head = String::from_utf8_lossy(&answer[..split]).into_owned();
    let status = head.split(' ').nth(1).and_then(|status| status.parse().ok())?;
    let mut body = answer[split + 4..].to_vec();
    if head.to_ascii_lowercase().contains("transfer-encoding: chunked") {
        body = unchunked(&body);
    }
    Some(Answer { status, head, body })
}

fn unchunked(mut body: &[u8]) -> Vec<u8> {
    let mut all = Vec::new();
    while let Some(end) = body.windows(2).position(|at| at == b"\r\n") {
        let length = std::str::from_utf8(&body[..end]).ok().and_then(|text| usize::from_str_radix(text, 16).ok());
        let Some(length) = length.filter(|&length| length > 0) else { break };
        all.extend_from_slice(&body[end + 2..end + 2 + length]);
        body = &body[end + 4 + length..];
    }
    all
}

/// A mesh of a cube of n³ cells, as .meshb.
pub fn cube(n: u32) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cube.meshb");
    geo_adapt::mesh::io::write_mesh(&path, &crate::common::adapting::cube(n, |_| 1)).unwrap();
    std::fs::read(path).unwrap()
}
