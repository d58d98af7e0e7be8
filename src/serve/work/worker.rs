//! The worker of a service: takes jobs from the queue as there is room for them.
use super::events::tail;
use super::pool::Pool;
use super::protocol::LOG;
use super::running::{CANCELLED, Running, SERVICE_ENDS};
use crate::serve::Error;
use crate::serve::api::Service;
use crate::serve::catalogue::Claim;
use crate::serve::ids::{new_id, now};
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

/// Memory of a job that has said nothing of it yet, bytes.
const UNKNOWN: u64 = 256 << 20;

/// The worker.
pub struct Worker {
    stop: watch::Sender<bool>,
    task: tokio::task::JoinHandle<()>,
}

/// What its tasks share.
pub struct Shop {
    pub(super) service: Arc<Service>,
    pub(super) name: String,
    pub(super) pool: Pool,
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

impl Shop {
    pub(super) fn lock(&self) -> std::sync::MutexGuard<'_, Vec<Arc<Running>>> {
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
    pub(super) fn free(&self) -> u64 {
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
        let job = Arc::new(Running::new(claim.id.clone(), claim.needs.max(UNKNOWN)));
        self.lock().push(Arc::clone(&job));
        self.service.hub.tell(&claim.id, |seen| seen.progress = None);
        job
    }
}
