//! The worker of a service: takes jobs from the queue as there is room for them, and brings each to its end.
use super::events::{Events, tail};
use super::folder::Folder;
use super::pool::Pool;
use super::protocol::{Answer, EVENTS, LOG, Run};
use crate::serve::Error;
use crate::serve::api::Service;
use crate::serve::catalogue::{Claim, End, Produced, State};
use crate::serve::commands::{Checked, Request};
use crate::serve::ids::{new_id, now};
use std::io;
use std::sync::atomic::{AtomicBool, AtomicI32, AtomicU8, Ordering::SeqCst};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::{Notify, watch};
use tokio::task::JoinSet;

/// How long a job is a worker's that says nothing.
const LEASE: Duration = Duration::from_secs(10);

/// How often it says that it is there.
const RENEWAL: Duration = Duration::from_secs(2);

/// How often the queue is looked at where others may put jobs into it.
const LOOK: Duration = Duration::from_millis(500);

/// How often the progress of a run is looked at.
const PROGRESS: Duration = Duration::from_millis(100);

/// How often it goes to the database.
const NOTED: Duration = Duration::from_secs(1);

/// How long a run may take to end when it is asked to.
const PATIENCE: Duration = Duration::from_secs(60);

/// Memory of a job that has said nothing of it yet, bytes.
const UNKNOWN: u64 = 256 << 20;

/// How often a job is begun anew whose process has vanished.
const MOST_ATTEMPTS: i64 = 5;

/// Why a run shall end.
const GOES_ON: u8 = 0;
const CANCELLED: u8 = 1;
const SERVICE_ENDS: u8 = 2;

/// A job that is at work here.
struct Running {
    id: String,
    group: AtomicI32,
    ends: AtomicU8,
    /// Whether its process was interrupted: a second time it would end at once, without its last valid mesh.
    is_interrupted: AtomicBool,
    memory: u64,
}

impl Running {
    fn end(&self, why: u8) {
        // What was asked first counts.
        let _ = self.ends.compare_exchange(GOES_ON, why, SeqCst, SeqCst);
        self.tell(why);
    }

    /// Has its process end, once there is one.
    fn tell(&self, why: u8) {
        if why != CANCELLED {
            self.signal(libc::SIGKILL);
        } else if self.group.load(SeqCst) > 1 && !self.is_interrupted.swap(true, SeqCst) {
            self.signal(libc::SIGINT);
        }
    }

    fn signal(&self, signal: i32) {
        let group = self.group.load(SeqCst);
        if group > 1 {
            // SAFETY: a system call. The group is that of a run that has not been waited for.
            unsafe { libc::kill(-group, signal) };
        }
    }
}

/// The worker.
pub struct Worker {
    stop: watch::Sender<bool>,
    task: tokio::task::JoinHandle<()>,
}

/// What its tasks share.
pub struct Shop {
    service: Arc<Service>,
    name: String,
    pool: Pool,
    running: Mutex<Vec<Arc<Running>>>,
    /// Something may have changed.
    wake: Notify,
}

/// Starts the worker of a service.
///
/// # Errors
/// When the database refuses.
pub async fn start(service: Arc<Service>) -> Result<Worker, Error> {
    let catalogue = &service.catalogue;
    let before = catalogue.take_back(!catalogue.is_shared()).await?;
    if before > 0 {
        tracing::info!(jobs = before, "jobs of a service that has ended wait again");
    }
    let limits = service.settings.limits;
    let pool = Pool::new(service.settings.folder("jobs").join("models"), limits.memory / 4);
    let name = new_id().map_err(Error::disk("a name"))?;
    let shop = Arc::new(Shop { service, name, pool, running: Mutex::default(), wake: Notify::new() });
    shop.service.set_shop(Arc::downgrade(&shop));
    drop(shop.pool.plain().map_err(Error::disk("a process of this program"))?);
    let (stop, stopped) = watch::channel(false);
    let task = tokio::spawn(run(shop, stopped));
    Ok(Worker { stop, task })
}

impl Worker {
    /// Ends it. Jobs that are at work wait again.
    pub async fn end(self) {
        let _ = self.stop.send(true);
        let _ = self.task.await;
    }
}

async fn run(shop: Arc<Shop>, mut stopped: watch::Receiver<bool>) {
    let mut jobs = JoinSet::new();
    let (mut renewed, mut looked) = (Instant::now(), Instant::now());
    while !*stopped.borrow() {
        if renewed.elapsed() >= RENEWAL {
            renewed = Instant::now();
            shop.renew().await;
        }
        while jobs.try_join_next().is_some() {}
        let has_room = shop.lock().len() < shop.service.settings.limits.jobs;
        match if has_room { shop.claim().await } else { Ok(None) } {
            Ok(Some(claim)) => {
                // It counts from now on, and not once its task is at work.
                let (shop, job) = (Arc::clone(&shop), shop.takes(&claim));
                jobs.spawn(async move { shop.work(claim, job).await });
                continue;
            }
            Ok(None) => {}
            Err(error) => tracing::error!(%error, "the queue"),
        }
        if looked.elapsed() > Duration::from_secs(30) {
            looked = Instant::now();
            shop.service.sweep().await;
        }
        let look = if shop.service.catalogue.is_shared() { LOOK } else { RENEWAL };
        tokio::select! {
            () = shop.wake.notified() => {}
            () = tokio::time::sleep(look) => {}
            _ = stopped.changed() => {}
        }
    }
    shop.lock().iter().for_each(|job| job.end(SERVICE_ENDS));
    while jobs.join_next().await.is_some() {}
}

/// How a run has ended.
enum Ended {
    /// By itself, or by a signal.
    Process { code: Option<i32>, signal: Option<i32> },
    /// It asks for more than there is.
    TooMuch(String),
    /// For more memory than there is now.
    Later(u64),
    /// Nobody knows.
    Vanished,
}

impl Shop {
    fn lock(&self) -> std::sync::MutexGuard<'_, Vec<Arc<Running>>> {
        self.running.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Something may have changed: a job was asked for.
    pub fn wake(&self) {
        self.wake.notify_one();
    }

    /// How many jobs are at work here.
    pub fn running(&self) -> usize {
        self.lock().len()
    }

    /// How many models are in memory here, and their bytes.
    pub fn models(&self) -> (usize, u64) {
        self.pool.kept()
    }

    /// A job that is at work here shall end.
    pub fn cancel(&self, id: &str) {
        self.lock().iter().filter(|job| job.id == id).for_each(|job| job.end(CANCELLED));
    }

    /// What a job that is at work here has printed so far.
    pub fn log(&self, id: &str, most: u64) -> Option<String> {
        let attempt = self.lock().iter().any(|job| job.id == id);
        let folder = self.service.settings.folder("jobs");
        let path = std::fs::read_dir(&folder)
            .ok()?
            .flatten()
            .map(|entry| entry.path())
            .find(|path| path.file_stem().is_some_and(|stem| stem.to_str() == Some(id)))?;
        attempt.then(|| tail(&path.join(LOG), most))
    }

    async fn renew(&self) {
        let catalogue = &self.service.catalogue;
        match catalogue.renew(&self.name, now() + LEASE.as_millis() as i64).await {
            Ok(cancelled) => cancelled.iter().for_each(|id| self.cancel(id)),
            Err(error) => tracing::error!(%error, "jobs cannot be renewed"),
        }
        if !catalogue.is_shared() {
            return;
        }
        match catalogue.take_back(false).await {
            Ok(0) => {}
            Ok(jobs) => tracing::warn!(jobs, "jobs of a worker that is gone wait again"),
            Err(error) => tracing::error!(%error, "jobs cannot be taken back"),
        }
    }

    /// Memory that no job here has, bytes.
    fn free(&self) -> u64 {
        let taken: u64 = self.lock().iter().map(|job| job.memory).sum();
        self.service.settings.limits.memory.saturating_sub(taken)
    }

    async fn claim(&self) -> Result<Option<Claim>, sqlx::Error> {
        let (free, is_first) = (self.free(), self.lock().is_empty());
        if free < UNKNOWN && !is_first {
            return Ok(None);
        }
        let lease = now() + LEASE.as_millis() as i64;
        self.service.catalogue.claim(&self.name, lease, if is_first { i64::MAX as u64 } else { free }).await
    }

    /// A job is at work here.
    fn takes(&self, claim: &Claim) -> Arc<Running> {
        let job = Arc::new(Running {
            id: claim.id.clone(),
            group: AtomicI32::new(0),
            ends: AtomicU8::new(GOES_ON),
            is_interrupted: AtomicBool::new(false),
            memory: claim.needs.max(UNKNOWN),
        });
        self.lock().push(Arc::clone(&job));
        self.service.hub.tell(&claim.id, |seen| seen.progress = None);
        job
    }

    /// Brings a job to its end.
    async fn work(self: Arc<Self>, claim: Claim, job: Arc<Running>) {
        let began = Instant::now();
        let end = self.brought_to_end(&claim, &job).await;
        let name = (claim.id.as_str(), claim.attempt);
        let catalogue = &self.service.catalogue;
        let kept = match &end {
            Ok(end) => catalogue.end_job(name, &self.name, end).await,
            Err(needs) => catalogue.put_back(name, &self.name, *needs).await,
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
        match self.service.catalogue.is_cancelled(&claim.id).await {
            Ok(true) => return Ok(End { state: State::Cancelled, exit_code: None, reason: None, results: Vec::new() }),
            Ok(false) => {}
            Err(error) => return Ok(failed(error.to_string())),
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
        let ends = job.ends.load(SeqCst);
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
        let threads = (limits.threads / self.running().max(1)).max(1);
        let run = Run {
            number: 0,
            words: checked.words_with(threads, limits.vertices),
            folder: folder.path().to_owned(),
            model,
            memory: limits.job_memory,
            seconds: limits.job_time.as_secs(),
            file: limits.file,
        };
        let mut answers = process.run(run).await?;
        let mut watched = Watched { events: Events::of(folder.path().join(EVENTS)), noted: None, said: None };
        let mut asked = None;
        loop {
            let answer = tokio::select! {
                answer = answers.recv() => answer,
                () = tokio::time::sleep(PROGRESS) => {
                    if let Some(ended) = self.look(&mut watched, job).await {
                        job.signal(libc::SIGKILL);
                        while !matches!(answers.recv().await, None | Some(Answer::Ended { .. } | Answer::Refused { .. })) {}
                        return Ok(ended);
                    }
                    if job.ends.load(SeqCst) == CANCELLED && asked.get_or_insert_with(Instant::now).elapsed() > PATIENCE {
                        job.signal(libc::SIGKILL);
                    }
                    continue;
                }
            };
            match answer {
                Some(Answer::Started { process, .. }) => {
                    job.group.store(process, SeqCst);
                    match job.ends.load(SeqCst) {
                        GOES_ON => {}
                        why => job.tell(why),
                    }
                }
                Some(Answer::Ended { code, signal, .. }) => {
                    self.look(&mut watched, job).await;
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

/// The progress of a run.
struct Watched {
    events: Events,
    noted: Option<Instant>,
    said: Option<String>,
}

/// What an end means to who asked.
fn end_of(ended: Ended, is_cancelled: bool, lost: Option<String>, results: Vec<Produced>, log: &str) -> End {
    let (code, reason) = match ended {
        Ended::Process { code: Some(0), .. } => (Some(0), None),
        Ended::Process { code: Some(code), .. } => (Some(code), Some(why(code, log))),
        Ended::Process { signal, .. } => (None, Some(why_killed(signal.unwrap_or(0)))),
        Ended::TooMuch(why) => (None, Some(why)),
        Ended::Later(_) | Ended::Vanished => {
            (None, Some("its process vanished again and again: memory may have ended".into()))
        }
    };
    let reason = lost.or(reason);
    let state = match &reason {
        _ if is_cancelled && code != Some(0) => State::Cancelled,
        None => State::Done,
        Some(_) => State::Failed,
    };
    End { state, exit_code: code.map(i64::from), reason: reason.filter(|_| state == State::Failed), results }
}

/// What an exit code means, in the words of the program where it has said some.
fn why(code: i32, log: &str) -> String {
    let said = log.rsplit_once("geo-adapt: error: ").map(|(_, said)| said.trim());
    match (said, code) {
        (Some(said), _) => said.to_owned(),
        (None, 1) => "the mesh is not valid, or not on its model: see the report".into(),
        (None, 3) => "memory, or the vertices that it may make, ended: the mesh is the last valid one, and does not meet the metric".into(),
        (None, code) => format!("exit code {code}"),
    }
}

fn why_killed(signal: i32) -> String {
    match signal {
        libc::SIGXCPU => "it took more processor time than a job may have".into(),
        libc::SIGXFSZ => "it wrote a file larger than a job may write".into(),
        libc::SIGKILL => "it was killed: its time was over, or the machine's memory".into(),
        signal => format!("it crashed (signal {signal})"),
    }
}
