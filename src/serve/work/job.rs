//! A job is brought to its end: its folder, its process, what that says meanwhile, and what it has made.
use super::endings::{Ended, end_of};
use super::events::{Events, tail};
use super::folder::Folder;
use super::protocol::{Answer, EVENTS, LOG, Run, SOLVERS};
use super::running::{CANCELLED, Running, SERVICE_ENDS};
use super::worker::Shop;
use crate::serve::catalogue::{Claim, End, State};
use crate::serve::commands::{Checked, Request};
use std::io;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How often the progress of a run is looked at.
const PROGRESS: Duration = Duration::from_millis(100);

/// How often it goes to the database.
const NOTED: Duration = Duration::from_secs(1);

/// How long a run may take to end when it is asked to.
const PATIENCE: Duration = Duration::from_secs(60);

/// How often the end of a job is told to a database that does not answer, and how long it has in between.
const MOST_TRIES: u32 = 10;
const PAUSE: Duration = Duration::from_secs(2);

/// How often a job is begun anew whose process has vanished.
const MOST_ATTEMPTS: i64 = 5;

/// The progress of a run.
struct Watched {
    events: Events,
    noted: Option<Instant>,
    said: Option<String>,
}

impl Shop {
    /// Brings a job to its end.
    pub(super) async fn work(self: Arc<Self>, claim: Claim, job: Arc<Running>) {
        let began = Instant::now();
        let end = self.brought_to_end(&claim, &job).await;
        let name = (claim.id.as_str(), claim.attempt);
        let catalogue = &self.service.catalogue;
        let mut tries = 0;
        let kept = loop {
            let kept = match &end {
                Ok(end) => catalogue.end_job(name, &self.name, end).await,
                Err(needs) => catalogue.put_back(name, &self.name, *needs).await,
            };
            tries += 1;
            if kept.is_ok() || tries == MOST_TRIES {
                break kept;
            }
            tokio::time::sleep(PAUSE).await;
        };
        self.lock().retain(|other| !Arc::ptr_eq(other, &job));
        match (kept, &end) {
            (Err(error), _) => tracing::error!(job = claim.id, %error, "its end cannot be kept"),
            (Ok(false), _) => tracing::warn!(job = claim.id, "another worker has it"),
            (Ok(true), Err(_)) => tracing::info!(job = claim.id, "waits again"),
            (Ok(true), Ok(end)) => {
                let seconds = began.elapsed().as_secs_f64();
                let (state, reason) = (end.state.name(), end.reason.as_deref().unwrap_or_default());
                tracing::info!(job = claim.id, owner = claim.owner, state, seconds, reason, "job ended");
                self.service.figures.ended(end.state, seconds);
                self.service.hub.tell(&claim.id, |seen| seen.has_ended = true);
            }
        }
        self.wake();
    }

    /// How a job ended; or how much memory it is to wait for.
    async fn brought_to_end(&self, claim: &Claim, job: &Running) -> Result<End, u64> {
        let failed =
            |reason: String| End { state: State::Failed, exit_code: None, reason: Some(reason), results: Vec::new() };
        let request = serde_json::from_str::<Request>(&claim.request).map_err(|error| error.to_string());
        let checked = request.and_then(|request| {
            let checked = self.service.commands.check(&request).map_err(|error| error.to_string());
            Ok((checked?, request))
        });
        let (checked, request) = match checked {
            Ok(known) => known,
            Err(error) => return Ok(failed(error)),
        };
        // Where it is not known the renewal of the lease will tell.
        if matches!(self.service.catalogue.is_cancelled(&claim.id).await, Ok(true)) {
            return Ok(End { state: State::Cancelled, exit_code: None, reason: None, results: Vec::new() });
        }
        let path = self.service.settings.folder("jobs").join(format!("{}.{}", claim.id, claim.attempt));
        let folder = match Folder::make(path, &self.service.blobs, &request.files).await {
            Ok(folder) => folder,
            Err(error) => return Ok(failed(format!("its files: {error}"))),
        };
        let ended = match self.run(&request, &checked, &folder, job).await {
            Ok(ended) => ended,
            Err(error) => return Ok(failed(format!("no process: {error}"))),
        };
        let ends = job.ends();
        match ended {
            Ended::Later(needs) => return Err(needs),
            _ if ends == SERVICE_ENDS => return Err(claim.needs),
            Ended::Vanished if claim.attempt < MOST_ATTEMPTS => return Err(claim.needs),
            _ => {}
        }
        // What is collected goes: the log too.
        let log = tail(&folder.path().join(LOG), 4096);
        let (results, lost) = match folder.collect(&self.service.blobs).await {
            Ok(results) => (results, None),
            Err(error) => (Vec::new(), Some(format!("what it made cannot be kept: {error}"))),
        };
        Ok(end_of(ended, ends == CANCELLED, lost, results, &log))
    }

    async fn run(&self, request: &Request, checked: &Checked, folder: &Folder, job: &Running) -> io::Result<Ended> {
        let limits = self.service.settings.limits;
        let mut model = None;
        let mut process = None;
        if let Some(name) = &checked.model
            && let Some(id) = request.files.get(name)
        {
            process = self.pool.of_model(&self.service.blobs, id, name).await?;
            model = process.is_some().then(|| name.clone());
        }
        let process = process.map_or_else(|| self.pool.plain(), Ok)?;
        let solvers = &self.service.settings.solvers;
        if checked.is_loop {
            std::fs::write(folder.path().join(SOLVERS), &solvers.text)?;
        }
        let threads = (limits.threads / self.running().max(1)).max(1);
        let run = Run {
            number: 0,
            words: checked.words_with(threads, limits.vertices),
            folder: folder.path().to_owned(),
            model,
            memory: limits.job_memory,
            seconds: limits.job_time.as_secs(),
            file: limits.file,
            reads: if checked.is_loop { solvers.reads.clone() } else { Vec::new() },
        };
        let mut answers = process.run(run).await?;
        let mut watched = Watched { events: Events::of(folder.path().join(EVENTS)), noted: None, said: None };
        let (began, mut too_long, mut asked) = (Instant::now(), false, None);
        loop {
            let answer = tokio::select! {
                answer = answers.recv() => answer,
                () = tokio::time::sleep(PROGRESS) => {
                    if let Some(ended) = self.look(&mut watched, job).await {
                        job.kill();
                        while !matches!(answers.recv().await, None | Some(Answer::Ended { .. } | Answer::Refused { .. })) {}
                        return Ok(ended);
                    }
                    if began.elapsed() > limits.job_time {
                        job.kill();
                        too_long = true;
                    }
                    if job.ends() == CANCELLED && asked.get_or_insert_with(Instant::now).elapsed() > PATIENCE {
                        job.kill();
                    }
                    continue;
                }
            };
            match answer {
                Some(Answer::Started { process, .. }) => job.began(process),
                Some(Answer::Ended { code, signal, .. }) => {
                    self.look(&mut watched, job).await;
                    if too_long {
                        let most = limits.job_time.as_secs();
                        return Ok(Ended::TooMuch(format!("it took longer than a job may, {most} s")));
                    }
                    return Ok(Ended::Process { code, signal });
                }
                Some(Answer::Refused { why, .. }) => return Err(io::Error::other(why)),
                Some(_) => {}
                None => return Ok(Ended::Vanished),
            }
        }
    }

    /// Reads what a run says of its progress. A run that asks for too much is not let on.
    async fn look(&self, watched: &mut Watched, job: &Running) -> Option<Ended> {
        let limits = self.service.settings.limits;
        for event in watched.events.news() {
            if event["kind"] == "forecast" {
                let number = |name: &str| event[name].as_f64().unwrap_or(0.0);
                let (vertices, bytes) = (number("vertices"), number("bytes") as u64);
                if vertices > limits.vertices as f64 {
                    let most = limits.vertices;
                    return Some(Ended::TooMuch(format!(
                        "the metric asks for about {vertices:.0} vertices, and a job here may make {most}: lower the complexity, or raise the sizes"
                    )));
                }
                if bytes > limits.job_memory {
                    return Some(Ended::TooMuch(format!(
                        "it would take about {:.0} MB of memory, and a job here may have {:.0}: lower the complexity, or raise the sizes",
                        bytes as f64 / 1e6,
                        limits.job_memory as f64 / 1e6
                    )));
                }
                // Others are at work: it waits until there is room.
                if bytes > job.memory.saturating_add(self.free()) && self.running() > 1 {
                    return Some(Ended::Later(bytes));
                }
            }
            watched.said = Some(event.to_string());
        }
        if watched.noted.is_none_or(|at| at.elapsed() > NOTED)
            && let Some(said) = watched.said.take()
        {
            self.service.hub.tell(&job.id, |seen| seen.progress = Some(said.clone()));
            watched.noted = Some(Instant::now());
            if let Err(error) = self.service.catalogue.note_progress(&job.id, &said).await {
                tracing::error!(%error, "progress cannot be kept");
            }
        }
        None
    }
}
