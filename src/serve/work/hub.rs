//! Who watches a job hears what becomes of it.
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};
use tokio::sync::watch;

/// What is known of a job that is at work here.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// The last that it said of its progress, as JSON.
    pub progress: Option<String>,
    /// Whether it has ended.
    pub has_ended: bool,
}

/// The jobs that are watched.
#[derive(Default)]
pub struct Hub {
    jobs: Mutex<HashMap<String, watch::Sender<Seen>>>,
}

impl Hub {
    /// What becomes of a job from now on. Whoever watches asks the database first.
    pub fn watch(&self, id: &str) -> watch::Receiver<Seen> {
        let mut jobs = self.jobs.lock().unwrap_or_else(PoisonError::into_inner);
        jobs.retain(|_, sender| sender.receiver_count() > 0);
        jobs.entry(id.to_owned()).or_insert_with(|| watch::channel(Seen::default()).0).subscribe()
    }

    /// A job has said something, or ended.
    pub fn tell(&self, id: &str, seen: impl FnOnce(&mut Seen)) {
        if let Some(sender) = self.jobs.lock().unwrap_or_else(PoisonError::into_inner).get(id) {
            sender.send_modify(seen);
        }
    }
}
