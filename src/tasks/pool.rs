//! A fixed set of threads.

/// Threads that live as long as the pool; with one thread none is made and work runs where it is asked for.
pub struct Pool {
    threads: Option<rayon::ThreadPool>,
}

/// The threads could not be started.
#[derive(Debug, thiserror::Error)]
#[error("cannot start {threads} threads: {reason}; ask for fewer with --threads")]
pub struct Error {
    threads: usize,
    reason: String,
}

impl Pool {
    /// A pool of so many threads, at least one.
    ///
    /// # Errors
    /// When the system refuses to start them.
    pub fn new(threads: usize) -> Result<Self, Error> {
        if threads <= 1 {
            return Ok(Self { threads: None });
        }
        let built = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        built.map(|pool| Self { threads: Some(pool) }).map_err(|e| Error { threads, reason: e.to_string() })
    }

    /// Number of threads.
    pub fn threads(&self) -> usize {
        self.threads.as_ref().map_or(1, rayon::ThreadPool::current_num_threads)
    }

    /// Runs `work(thread)` once on each thread, `thread` counted from 0; returns when all are done.
    pub fn on_each_thread(&self, work: &(dyn Fn(usize) + Sync)) {
        match &self.threads {
            None => work(0),
            Some(pool) => {
                pool.broadcast(|context| work(context.index()));
            }
        }
    }
}
