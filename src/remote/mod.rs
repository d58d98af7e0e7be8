//! The client of a service ([`crate::serve`]): files go up, a job is asked for and followed, its results come down.
mod follow;
pub mod words;

use serde::Deserialize;
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::time::Duration;
use ureq::http::{Response, StatusCode};
use ureq::{Agent, Body};

pub use follow::Event;

/// A file that is larger goes up in pieces of so many bytes, each of which can be sent again.
const PIECE: u64 = 32 << 20;

/// How often a piece is sent again, and how long it waits before.
const TRIES: u32 = 6;
const PAUSE: Duration = Duration::from_secs(1);

/// How long a connection may take.
const CONNECTION: Duration = Duration::from_secs(20);

/// What goes wrong.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The service cannot be reached.
    #[error("{url}: {error}; is a `geo-adapt serve` at work there?")]
    Unreachable {
        /// The service.
        url: String,
        /// What the system says.
        error: ureq::Error,
    },
    /// It refuses, and says why.
    #[error("{url}: {detail}")]
    Refused {
        /// The service.
        url: String,
        /// Why.
        detail: String,
        /// The status of HTTP.
        status: u16,
    },
    /// A file here.
    #[error("{path}: {error}")]
    Disk {
        /// Which.
        path: String,
        /// What the system says.
        error: io::Error,
    },
}

/// A service.
pub struct Server {
    agent: Agent,
    url: String,
    token: Option<String>,
}

/// A file that a job has made.
#[derive(Debug, Deserialize)]
pub struct Produced {
    /// What it is called.
    pub name: String,
    /// SHA-256 of its contents.
    pub id: String,
}

impl Server {
    /// At an address, with the token of who asks.
    pub fn new(url: &str, token: Option<String>) -> Self {
        let config = Agent::config_builder().http_status_as_error(false).timeout_connect(Some(CONNECTION)).build();
        Self { agent: config.into(), url: url.trim_end_matches('/').to_owned(), token }
    }

    fn path(&self, path: &str) -> String {
        format!("{}/v1{path}", self.url)
    }

    fn bearer(&self) -> String {
        self.token.as_ref().map(|token| format!("Bearer {token}")).unwrap_or_default()
    }

    fn unreachable(&self, error: ureq::Error) -> Error {
        Error::Unreachable { url: self.url.clone(), error }
    }

    /// The answer, unless it is a refusal.
    fn checked(&self, answer: Result<Response<Body>, ureq::Error>) -> Result<Response<Body>, Error> {
        let mut answer = answer.map_err(|error| self.unreachable(error))?;
        let status = answer.status();
        if status.is_success() {
            return Ok(answer);
        }
        let text = answer.body_mut().read_to_string().unwrap_or_default();
        let told: Value = serde_json::from_str(&text).unwrap_or_default();
        let detail =
            told["detail"].as_str().map_or_else(|| format!("{status}: this is no service of geo-adapt"), str::to_owned);
        Err(Error::Refused { url: self.url.clone(), detail, status: status.as_u16() })
    }

    fn get(&self, path: &str) -> Result<Response<Body>, Error> {
        let mut request = self.agent.get(self.path(path));
        if self.token.is_some() {
            request = request.header("Authorization", self.bearer());
        }
        self.checked(request.call())
    }

    fn post(
        &self,
        path: &str,
        headers: &[(&str, String)],
        body: impl ureq::AsSendBody,
    ) -> Result<Response<Body>, Error> {
        let mut request = self.agent.post(self.path(path));
        for (name, value) in headers {
            request = request.header(*name, value);
        }
        if self.token.is_some() {
            request = request.header("Authorization", self.bearer());
        }
        self.checked(request.send(body))
    }

    fn json(&self, mut answer: Response<Body>) -> Result<Value, Error> {
        answer.body_mut().read_json().map_err(|error| self.unreachable(error))
    }

    /// The service has a file under this name: its id. What it has already does not go up again.
    ///
    /// # Errors
    /// When the file cannot be read, or the service refuses it.
    pub fn upload(&self, path: &Path, name: &str) -> Result<String, Error> {
        let on_disk = |error| Error::Disk { path: path.display().to_string(), error };
        let mut file = File::open(path).map_err(on_disk)?;
        let id = digest(&mut file).map_err(on_disk)?;
        match self.get(&format!("/files/{id}")) {
            Ok(_) => return Ok(id),
            Err(Error::Refused { status: 404, .. }) => {}
            Err(error) => return Err(error),
        }
        file.seek(SeekFrom::Start(0)).map_err(on_disk)?;
        let length = file.metadata().map_err(on_disk)?.len();
        let name: String = name.bytes().map(encoded).collect();
        let answer = if length <= PIECE {
            let kind = [("Content-Type", "application/octet-stream".to_owned())];
            self.post(&format!("/files?name={name}"), &kind, &file)?
        } else {
            let kind = [("Upload-Length", length.to_string())];
            let begun = self.post(&format!("/uploads?name={name}"), &kind, ())?;
            let place =
                begun.headers().get("location").and_then(|value| value.to_str().ok()).unwrap_or_default().to_owned();
            self.send_pieces(&mut file, &place, length, &on_disk)?
        };
        let told = self.json(answer)?;
        Ok(told["id"].as_str().unwrap_or(&id).to_owned())
    }

    /// A file goes up in pieces, from wherever the service is (tus 1.0.0).
    fn send_pieces(
        &self,
        file: &mut File,
        place: &str,
        length: u64,
        on_disk: &dyn Fn(io::Error) -> Error,
    ) -> Result<Response<Body>, Error> {
        let (mut offset, mut tries, url) = (0, 0, format!("{}{place}", self.url));
        loop {
            let mut piece = Vec::new();
            file.seek(SeekFrom::Start(offset)).map_err(on_disk)?;
            Read::by_ref(file).take(PIECE).read_to_end(&mut piece).map_err(on_disk)?;
            let request = self.agent.patch(&url).header("Upload-Offset", offset.to_string());
            let request = request.header("Content-Type", "application/offset+octet-stream");
            let request = if self.token.is_some() { request.header("Authorization", self.bearer()) } else { request };
            match self.checked(request.send(&piece[..])) {
                Ok(answer) if answer.status() == StatusCode::OK => return Ok(answer),
                Ok(_) => {
                    offset = (offset + piece.len() as u64).min(length);
                    tries = 0;
                }
                Err(Error::Refused { detail, url, status }) if status != 409 && status < 500 => {
                    return Err(Error::Refused { detail, url, status });
                }
                Err(error) => {
                    tries += 1;
                    if tries > TRIES {
                        return Err(error);
                    }
                    std::thread::sleep(PAUSE * tries);
                    offset = self.offset(&url).unwrap_or(offset);
                }
            }
        }
    }

    fn offset(&self, url: &str) -> Option<u64> {
        let request = self.agent.head(url);
        let request = if self.token.is_some() { request.header("Authorization", self.bearer()) } else { request };
        let answer = self.checked(request.call()).ok()?;
        answer.headers().get("upload-offset")?.to_str().ok()?.parse().ok()
    }

    /// Asks for a job: its id.
    ///
    /// # Errors
    /// When the service refuses it.
    pub fn ask(&self, request: &Value) -> Result<String, Error> {
        let kind = [("Content-Type", "application/json".to_owned())];
        let told = self.json(self.post("/jobs", &kind, request.to_string())?)?;
        Ok(told["id"].as_str().unwrap_or_default().to_owned())
    }

    /// A job shall end, with the last valid mesh where it has one.
    ///
    /// # Errors
    /// When the service does not answer.
    pub fn cancel(&self, job: &str) -> Result<(), Error> {
        self.post(&format!("/jobs/{job}/cancel"), &[], ()).map(drop)
    }

    /// What a job has made.
    ///
    /// # Errors
    /// When the service does not answer.
    pub fn results(&self, job: &str) -> Result<Vec<Produced>, Error> {
        let told = self.json(self.get(&format!("/jobs/{job}/results"))?)?;
        Ok(serde_json::from_value(told).unwrap_or_default())
    }

    /// Writes a result, and checks it.
    ///
    /// # Errors
    /// When the service does not answer, the contents are not what they should be, or the disk refuses.
    pub fn download(&self, job: &str, result: &Produced, to: &mut dyn Write) -> Result<(), Error> {
        let on_disk = |error| Error::Disk { path: result.name.clone(), error };
        let name: String = result.name.bytes().map(encoded).collect();
        let mut answer = self.get(&format!("/jobs/{job}/results/{name}"))?;
        let mut reader = answer.body_mut().with_config().limit(u64::MAX).reader();
        let (mut bytes, mut known) = (vec![0; 1 << 18], Sha256::new());
        loop {
            let read = reader.read(&mut bytes).map_err(on_disk)?;
            if read == 0 {
                break;
            }
            known.update(&bytes[..read]);
            to.write_all(&bytes[..read]).map_err(on_disk)?;
        }
        if hex(&known.finalize()) == result.id {
            return Ok(());
        }
        Err(on_disk(io::Error::new(io::ErrorKind::InvalidData, "what came is not what was sent; download it again")))
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn digest(file: &mut File) -> io::Result<String> {
    let mut known = Sha256::new();
    io::copy(file, &mut known)?;
    Ok(hex(&known.finalize()))
}

/// A byte in a query.
fn encoded(byte: u8) -> String {
    if byte.is_ascii_alphanumeric() || b"._-".contains(&byte) {
        return char::from(byte).to_string();
    }
    format!("%{byte:02X}")
}
