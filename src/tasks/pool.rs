//! A fixed number of threads, and what can be asked of them.
use super::backends::{self, Engine, Stealing};
use super::core::Core;
use super::each::Each;
use super::group::Group;
use super::in_place::InPlace;
use super::job::Queue;
use super::nested;
use super::place::{self, Place};
use super::plan::{Backend, Plan};
use super::scope::Scope;
use super::simulation;
use super::strategy::{Loop, OfChunk, chunk};
use std::io;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Threads that live as long as the pool. A pool of one thread makes none: work runs in place. The rules are at the head of the module.
pub struct Pool {
    core: Arc<Core>,
    /// Held during the outermost loop or scope.
    gate: Mutex<()>,
    /// The default back-end; none with one thread.
    stealing: Option<Stealing>,
    /// Others, by their number, made when first asked for.
    engines: [OnceLock<Box<dyn Engine>>; Backend::ALL.len()],
    /// Held while one is being made.
    making: Mutex<()>,
}

/// The threads cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The system refuses to start them.
    #[error("cannot start {threads} threads: {reason}; ask for fewer with --threads")]
    Threads {
        /// How many were wanted.
        threads: usize,
        /// What the system says.
        reason: io::Error,
    },
    /// The back-end is not part of this program.
    #[error("built without the task back-end {0}; build with --features {0}")]
    Missing(&'static str),
}

impl Pool {
    /// A pool of so many threads, at least one, with those of the default back-end started.
    ///
    /// # Errors
    /// When the system refuses to start them.
    pub fn new(threads: usize) -> Result<Self, Error> {
        let core = Arc::new(Core::new(threads.max(1), false));
        let stealing = (threads > 1).then(|| Stealing::new(&core)).transpose();
        let stealing = stealing.map_err(|reason| Error::Threads { threads, reason })?;
        Ok(Self { core, gate: Mutex::default(), stealing, engines: Default::default(), making: Mutex::default() })
    }

    /// So many threads that are not there ([`super::simulation`]).
    pub fn simulated(threads: usize) -> Self {
        super::simulation::begin(threads.max(1));
        let core = Arc::new(Core::new(threads.max(1), true));
        Self { core, gate: Mutex::default(), stealing: None, engines: Default::default(), making: Mutex::default() }
    }

    /// Whether everything runs in place.
    fn is_alone(&self) -> bool {
        self.core.threads == 1 || self.core.is_simulated
    }

    /// Number of threads.
    pub fn threads(&self) -> usize {
        self.core.threads
    }

    /// Starts the threads of the back-end, if they have not been started. Otherwise that happens at its first use.
    ///
    /// # Errors
    /// When the program was built without it, or the system refuses the threads.
    pub fn prepare(&self, backend: Backend) -> Result<(), Error> {
        if let Some(name) = (!backend.is_built()).then_some(backend.name()) {
            return Err(Error::Missing(name));
        }
        if !self.is_alone() { self.engine(backend).map(|_| ()) } else { Ok(()) }
    }

    /// Calls `f(thread, range)` for each chunk of `plan.grain` items, the last one shorter, in any order; returns when all is done.
    /// Chunks depend on items and grain only.
    ///
    /// # Panics
    /// When a call did, or when the back-end cannot be had: see [`Pool::prepare`].
    pub fn task_for<F>(&self, plan: Plan, items: usize, f: F)
    where
        F: Fn(usize, Range<usize>) + Sync,
    {
        self.run(plan, items, &f);
    }

    fn run(&self, plan: Plan, items: usize, f: OfChunk<'_>) {
        let grain = plan.grain.max(1);
        if self.is_alone() || items <= grain {
            let chunks = || (0..items.div_ceil(grain)).map(|index| chunk(index, grain, items));
            if self.core.is_simulated && place::find(self.core.id).is_none() {
                self.alone(|thread| simulation::each(chunks().map(|range| || f(thread, range))));
                return;
            }
            if self.alone(|thread| chunks().for_each(|range| f(thread, range))) {
                return;
            }
        }
        let work = Loop::new(plan, items, f, self.waiter());
        // SAFETY: `open` returns when the group is done.
        self.open(plan.backend, &work.group, &mut |queue| queue.push(unsafe { work.root() }));
        work.group.resume();
    }

    /// Calls `body` with a scope that it can spawn tasks in, and waits for them all.
    ///
    /// # Panics
    /// When the body or a task did, after all tasks have ended; or when the back-end cannot be had: see [`Pool::prepare`].
    pub fn scope<'scope, B, T>(&self, backend: Backend, body: B) -> T
    where
        B: FnOnce(&Scope<'_, 'scope>) -> T,
    {
        let group = Group::new(0, self.waiter());
        let (mut body, mut result) = (Some(body), None);
        let mut call = |queue: &dyn Queue, in_place: Option<&InPlace<'_>>| {
            let body = body.take().expect("called once");
            result = Some(catch_unwind(AssertUnwindSafe(|| body(&Scope::new(queue, &group, in_place)))));
        };
        if self.is_alone() {
            self.alone(|_| {
                let queue = InPlace::new(&self.core);
                call(&queue, Some(&queue));
            });
        } else {
            self.open(backend, &group, &mut |queue| call(queue, None));
        }
        let value = result.expect("it was called").unwrap_or_else(|panic| resume_unwind(panic));
        group.resume();
        value
    }

    /// Runs `work(thread)` once on each thread of the default back-end, `thread` counted from 0; returns when all are done.
    ///
    /// # Panics
    /// When one did, and when called within a task of the same pool, unless it has one thread.
    pub fn on_each_thread(&self, work: &(dyn Fn(usize) + Sync)) {
        let Some(stealing) = &self.stealing else {
            self.alone(|_| (0..self.threads()).for_each(work));
            return;
        };
        assert!(
            place::find(self.core.id).is_none(),
            "on_each_thread within a task of the same pool: its threads are taken"
        );
        let each = Each::new(self.threads(), work, self.core.opener());
        let _gate = self.gate.lock().unwrap_or_else(PoisonError::into_inner);
        let _in_task = place::mark(false);
        // SAFETY: the call returns when the group is done.
        stealing.on_each_thread(&each.group, (0..self.threads()).map(|_| unsafe { each.job() }));
        each.group.resume();
    }

    /// Runs `work(thread)` here as one task, if this thread has an id in this pool, or no other thread has one now.
    fn alone(&self, work: impl FnOnce(usize)) -> bool {
        let work = |thread| {
            let _in_task = place::mark(true);
            work(thread);
        };
        if let Some(place) = place::find(self.core.id) {
            return place.thread.map(work).is_some();
        }
        let _gate = self.gate.lock().unwrap_or_else(PoisonError::into_inner);
        // Of all back-ends it is our own whose first thread is the caller, for what is nested in this.
        let _here = place::enter(Place { pool: self.core.id, backend: Backend::Stealing, thread: Some(0) });
        work(0);
        true
    }

    /// Calls `body` with a queue for the tasks of the group and waits for them: within a task on the queue of a nested group, else
    /// as the one outermost.
    fn open(&self, backend: Backend, group: &Group, body: &mut dyn FnMut(&dyn Queue)) {
        let engine = |backend| self.engine(backend).unwrap_or_else(|error| panic!("{error}"));
        if let Some(place) = place::find(self.core.id) {
            return nested::run(&self.core, engine(place.backend), place, group, body);
        }
        let _gate = self.gate.lock().unwrap_or_else(PoisonError::into_inner);
        let engine = engine(backend);
        // The task of another pool that this may be in is not one of this pool.
        let _in_task = place::mark(false);
        engine.region(group, body);
    }

    /// Slot in which this thread waits for what it opens.
    fn waiter(&self) -> usize {
        place::find(self.core.id).and_then(|place| place.thread).unwrap_or(self.core.opener())
    }

    /// The threads of the back-end, of a pool of several.
    fn engine(&self, backend: Backend) -> Result<&dyn Engine, Error> {
        if let (Backend::Stealing, Some(engine)) = (backend, &self.stealing) {
            return Ok(engine);
        }
        let cell = &self.engines[backend as usize];
        if let Some(engine) = cell.get() {
            return Ok(&**engine);
        }
        let _making = self.making.lock().unwrap_or_else(PoisonError::into_inner);
        if cell.get().is_none() {
            let made = backends::engine(backend, &self.core);
            let made = made.map_err(|reason| Error::Threads { threads: self.threads(), reason })?;
            let made = made.ok_or(Error::Missing(backend.name()))?;
            // Nobody else makes one.
            let _ = cell.set(made);
        }
        Ok(&**cell.get().expect("just made"))
    }
}
