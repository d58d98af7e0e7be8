//! Follows a job: server-sent events, taken up again where the connection breaks off.
use super::{Error, PAUSE, Server, TRIES};
use serde_json::Value;
use std::io::{BufRead, BufReader};

/// What is heard of a job.
pub enum Event {
    /// It goes on; the job as JSON.
    Progress(Value),
    /// It has ended.
    End(Value),
}

impl Server {
    /// Calls `told` with all that is heard of a job, until its end: the job as JSON.
    ///
    /// # Errors
    /// When the service does not answer any more.
    pub fn follow(&self, job: &str, told: &mut dyn FnMut(&Value)) -> Result<Value, Error> {
        let mut tries = 0;
        loop {
            let broke = match self.get(&format!("/jobs/{job}/events")) {
                Ok(mut answer) => {
                    let reader = answer.body_mut().with_config().limit(u64::MAX).reader();
                    let mut events = Events { lines: BufReader::new(reader), kind: String::new() };
                    while let Some(event) = events.next() {
                        tries = 0;
                        match event {
                            Event::Progress(job) => told(&job),
                            Event::End(job) => return Ok(job),
                        }
                    }
                    None
                }
                Err(Error::Refused { url, detail, status }) if status != 429 && status < 500 => {
                    return Err(Error::Refused { url, detail, status });
                }
                Err(error) => Some(error),
            };
            tries += 1;
            if let Some(error) = broke.filter(|_| tries > TRIES) {
                return Err(error);
            }
            std::thread::sleep(PAUSE * tries.min(TRIES));
        }
    }
}

/// Events as they come (the HTML standard, 9.2).
struct Events<R> {
    lines: BufReader<R>,
    kind: String,
}

impl<R: std::io::Read> Events<R> {
    fn next(&mut self) -> Option<Event> {
        loop {
            let mut line = String::new();
            if self.lines.read_line(&mut line).ok()? == 0 {
                return None;
            }
            let line = line.trim_end_matches(['\n', '\r']);
            if let Some(kind) = line.strip_prefix("event:") {
                kind.trim().clone_into(&mut self.kind);
            } else if let Some(data) = line.strip_prefix("data:") {
                let job = serde_json::from_str(data.trim()).unwrap_or_default();
                return Some(if self.kind == "end" { Event::End(job) } else { Event::Progress(job) });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_are_read_as_they_come() {
        let text = "event: progress\ndata: {\"a\":1}\n\n:\n\nevent: end\r\ndata: {\"a\":2}\r\n\r\n";
        let mut events = Events { lines: BufReader::new(text.as_bytes()), kind: String::new() };
        assert!(matches!(events.next(), Some(Event::Progress(job)) if job["a"] == 1));
        assert!(matches!(events.next(), Some(Event::End(job)) if job["a"] == 2));
        assert!(events.next().is_none());
    }
}
