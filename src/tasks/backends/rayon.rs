//! The threads of rayon. Only its `spawn` is used: when rayon itself waits in a task, it runs any other task on top of it.
use super::Engine;
use crate::tasks::core::Core;
use crate::tasks::group::Group;
use crate::tasks::job::{Job, Lane, Queue, Submit};
use crate::tasks::place::{self, Place};
use crate::tasks::plan::Backend;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::cell::OnceCell;
use std::io;
use std::sync::Arc;
use std::thread::{Builder, JoinHandle};

/// A pool of rayon; who opens a region waits outside of it.
pub struct Rayon {
    core: Arc<Core>,
    /// Gone only while it is dropped.
    pool: Option<ThreadPool>,
    handles: Vec<JoinHandle<()>>,
}

thread_local! {
    /// On rayon's threads, what they belong to.
    static CORE: OnceCell<Arc<Core>> = const { OnceCell::new() };
}

impl Rayon {
    /// Starts the threads.
    pub fn new(core: &Arc<Core>) -> io::Result<Self> {
        let mut handles = Vec::new();
        let pool = ThreadPoolBuilder::new()
            .num_threads(core.threads)
            .spawn_handler(|thread| {
                let core = Arc::clone(core);
                let live = move || {
                    let place = Place { pool: core.id, backend: Backend::Rayon, thread: Some(thread.index()) };
                    let _here = place::enter(place);
                    // It is empty: the thread is new.
                    CORE.with(|cell| drop(cell.set(core)));
                    thread.run();
                };
                handles.push(Builder::new().spawn(live)?);
                Ok(())
            })
            .build();
        let pool = Some(pool.map_err(io::Error::other)?);
        Ok(Self { core: Arc::clone(core), pool, handles })
    }
}

/// Runs the task on the current thread, one of rayon's.
fn run(job: Job) {
    CORE.with(|core| {
        let core = core.get().expect("set when the thread began");
        let thread = rayon::current_thread_index().expect("a thread of rayon");
        job.run(&Lane { thread, core, queue: &Inside, base: &Inside });
    });
}

/// The pool seen from its own threads.
struct Inside;

impl Submit for Inside {
    fn submit(&self, job: Job) {
        rayon::spawn(|| run(job));
    }
}

impl Queue for Inside {
    fn push(&self, job: Job) {
        self.submit(job);
    }

    fn wait(&self, _: &Group) {
        unreachable!("the outermost group is waited for outside, others have their own queues");
    }
}

impl Submit for Rayon {
    fn submit(&self, job: Job) {
        self.pool.as_ref().expect("there until dropped").spawn(|| run(job));
    }
}

impl Queue for Rayon {
    fn push(&self, job: Job) {
        self.submit(job);
    }

    fn wait(&self, group: &Group) {
        group.sleep(&self.core);
    }
}

impl Engine for Rayon {
    fn region(&self, group: &Group, body: &mut dyn FnMut(&dyn Queue)) {
        let _here = place::enter(Place { pool: self.core.id, backend: Backend::Rayon, thread: None });
        body(self);
        self.wait(group);
    }
}

impl Drop for Rayon {
    fn drop(&mut self) {
        // Its threads end when they have run all that was spawned.
        self.pool = None;
        for handle in self.handles.drain(..) {
            // A thread runs tasks only, whose panics are caught.
            let _ = handle.join();
        }
    }
}
