//! Our own threads, each with a queue of tasks. A thread takes the newest task of its own queue, else the oldest of another's. The thread
//! that opens a loop or scope is thread 0 while that lasts. Idle threads look for work for some microseconds, then they sleep.
use super::Engine;
use crate::tasks::core::Core;
use crate::tasks::group::Group;
use crate::tasks::job::{Job, Lane, Queue, Submit};
use crate::tasks::parking::For;
use crate::tasks::place::{self, Place};
use crate::tasks::plan::Backend;
use crossbeam_deque::{Injector, Steal, Stealer, Worker};
use crossbeam_utils::{Backoff, CachePadded};
use std::cell::Cell;
use std::io;
use std::iter;
use std::sync::atomic::{
    AtomicBool,
    Ordering::{Acquire, Relaxed, Release},
};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{Builder, JoinHandle};

/// The threads; all but the first, which is who calls.
pub struct Stealing {
    shared: Arc<Shared>,
    /// The first thread's own side, for who opens a region.
    first: Mutex<Local>,
    handles: Vec<JoinHandle<()>>,
}

/// What all threads see.
struct Shared {
    core: Arc<Core>,
    stealers: Vec<Stealer<Job>>,
    /// Calls for help.
    calls: Injector<Job>,
    /// For a thread alone.
    letters: Vec<CachePadded<Letter>>,
    over: AtomicBool,
}

/// A task that this very thread is to run.
#[derive(Default)]
struct Letter {
    here: AtomicBool,
    job: Mutex<Option<Job>>,
}

/// A thread's own side.
struct Local {
    shared: Arc<Shared>,
    thread: usize,
    queue: Worker<Job>,
    /// Whom it stole from last.
    victim: Cell<usize>,
}

impl Stealing {
    /// Starts all threads but the first.
    pub fn new(core: &Arc<Core>) -> io::Result<Self> {
        let queues: Vec<_> = iter::repeat_with(Worker::new_lifo).take(core.threads).collect();
        let shared = Arc::new(Shared {
            core: Arc::clone(core),
            stealers: queues.iter().map(Worker::stealer).collect(),
            calls: Injector::new(),
            letters: iter::repeat_with(CachePadded::default).take(core.threads).collect(),
            over: AtomicBool::new(false),
        });
        let mut locals = queues.into_iter().enumerate().map(|(thread, queue)| Local {
            shared: Arc::clone(&shared),
            thread,
            queue,
            victim: Cell::new(0),
        });
        let first = Mutex::new(locals.next().expect("a pool has a thread"));
        let mut engine = Self { shared: Arc::clone(&shared), first, handles: Vec::new() };
        for local in locals {
            // If one cannot be had, dropping the engine ends the others.
            let name = format!("geo-adapt {}", local.thread);
            engine.handles.push(Builder::new().name(name).spawn(move || local.live())?);
        }
        Ok(engine)
    }

    /// Has each thread run its own one of these tasks of the group, in the order of the threads.
    pub fn on_each_thread(&self, group: &Group, jobs: impl Iterator<Item = Job>) {
        self.as_first(|first| {
            let mut own = None;
            for (thread, job) in jobs.enumerate() {
                if thread == 0 {
                    own = Some(job);
                } else {
                    let letter = &self.shared.letters[thread];
                    *letter.job.lock().expect("nothing panics under this lock") = Some(job);
                    letter.here.store(true, Release);
                    self.shared.core.parking.unpark(self.shared.core.idler(thread));
                }
            }
            own.into_iter().for_each(|job| first.run(job));
            first.wait(group);
        });
    }

    /// Makes the caller the first thread.
    fn as_first(&self, work: impl FnOnce(&Local)) {
        let first = self.first.lock().unwrap_or_else(PoisonError::into_inner);
        let _here = first.enter();
        work(&first);
    }
}

impl Engine for Stealing {
    fn region(&self, group: &Group, body: &mut dyn FnMut(&dyn Queue)) {
        self.as_first(|first| {
            body(first);
            first.wait(group);
        });
    }
}

impl Submit for Stealing {
    fn submit(&self, job: Job) {
        self.shared.submit(job);
    }
}

impl Submit for Shared {
    fn submit(&self, job: Job) {
        self.calls.push(job);
        self.core.parking.unpark_one();
    }
}

impl Drop for Stealing {
    fn drop(&mut self) {
        self.shared.over.store(true, Release);
        for thread in 1..self.shared.core.threads {
            self.shared.core.parking.unpark(self.shared.core.idler(thread));
        }
        for handle in self.handles.drain(..) {
            // A thread runs tasks only, whose panics are caught.
            let _ = handle.join();
        }
    }
}

impl Local {
    fn enter(&self) -> place::Entered {
        place::enter(Place { pool: self.shared.core.id, backend: Backend::Stealing, thread: Some(self.thread) })
    }

    /// The life of a thread.
    fn live(self) {
        let _here = self.enter();
        self.work_until(|| self.shared.over.load(Acquire));
    }

    /// Runs tasks until it is over; sleeps where there is none.
    fn work_until(&self, over: impl Fn() -> bool) {
        let (backoff, mut slept) = (Backoff::new(), false);
        while !over() {
            if let Some(job) = self.find() {
                // A call may have found this thread just when it saw another task: pass it on.
                if slept && self.shared.has_work(self.thread) {
                    self.shared.core.parking.unpark_one();
                }
                self.run(job);
                backoff.reset();
                slept = false;
            } else if !backoff.is_completed() {
                backoff.snooze();
            } else {
                let core = &self.shared.core;
                core.parking.park(core.idler(self.thread), For::Work, || over() || self.shared.has_work(self.thread));
                backoff.reset();
                slept = true;
            }
        }
    }

    fn run(&self, job: Job) {
        let lane = Lane { thread: self.thread, core: &self.shared.core, queue: self, base: &*self.shared };
        job.run(&lane);
    }

    fn find(&self) -> Option<Job> {
        let letter = &self.shared.letters[self.thread];
        if letter.here.load(Relaxed) && letter.here.swap(false, Acquire) {
            return letter.job.lock().expect("nothing panics under this lock").take();
        }
        self.queue.pop().or_else(|| self.steal()).or_else(|| taken(|| self.shared.calls.steal()))
    }

    /// The oldest task of another thread, of the last victim first.
    fn steal(&self) -> Option<Job> {
        let threads = self.shared.stealers.len();
        let others =
            (0..threads).map(|step| (self.victim.get() + step) % threads).filter(|&other| other != self.thread);
        for other in others {
            if let Some(job) = taken(|| self.shared.stealers[other].steal()) {
                self.victim.set(other);
                return Some(job);
            }
        }
        None
    }
}

/// Takes again until it is there or known not to be.
fn taken(steal: impl Fn() -> Steal<Job>) -> Option<Job> {
    iter::repeat_with(steal).find(|steal| !steal.is_retry())?.success()
}

impl Shared {
    /// Whether there is something that this thread may run.
    fn has_work(&self, thread: usize) -> bool {
        let letter = self.letters[thread].here.load(Relaxed);
        letter || !self.calls.is_empty() || self.stealers.iter().any(|stealer| !stealer.is_empty())
    }
}

impl Queue for Local {
    fn push(&self, job: Job) {
        self.queue.push(job);
        self.shared.core.parking.unpark_one();
    }

    fn wait(&self, group: &Group) {
        self.work_until(|| group.is_done());
    }
}
