//! What the back-ends in C++ have in common: tasks go over as pointers and come back with the id of the thread.
use super::Engine;
use crate::tasks::core::Core;
use crate::tasks::group::Group;
use crate::tasks::job::{Job, Lane, Queue, Submit};
use crate::tasks::place::{self, Place};
use crate::tasks::plan::Backend;
use std::cell::RefCell;
use std::ffi::{c_int, c_void};
use std::sync::Arc;

/// Runs a task of an engine on the thread of this id.
pub type Run = extern "C" fn(engine: *const c_void, job: *mut c_void, thread: c_int);

/// Calls the body of a region on the thread of this id.
pub type Call = extern "C" fn(body: *mut c_void, thread: c_int);

/// A library that runs tasks.
///
/// # Safety
/// `region` calls `call(body, _)` once, on this thread, and returns after all that was pushed meanwhile has been run, once, with an
/// id that no other thread has then. Tasks are run while the region lasts, and end on the thread on which they began.
pub unsafe trait Library: Send + Sync {
    /// Which one.
    const BACKEND: Backend;

    /// As said above.
    fn region(&self, threads: c_int, body: *mut c_void, call: Call);

    /// Takes `run(engine, job, _)` as a task, from a thread that is in the region. It may run it at once.
    fn push(&self, engine: *const c_void, job: *mut c_void, run: Run);

    /// Waits for tasks from the body, at least for those that it pushed itself.
    fn wait(&self);
}

/// The threads of such a library.
pub struct Foreign<L> {
    core: Arc<Core>,
    library: L,
}

impl<L: Library> Foreign<L> {
    pub fn new(core: &Arc<Core>, library: L) -> Self {
        Self { core: Arc::clone(core), library }
    }

    fn enter(&self, thread: usize) -> place::Entered {
        place::enter(Place { pool: self.core.id, backend: L::BACKEND, thread: Some(thread) })
    }
}

thread_local! {
    /// Tasks, by their pool, that the library wanted to run in the midst of another, for when that has ended.
    static LATER: RefCell<Vec<(u64, Job)>> = const { RefCell::new(Vec::new()) };
}

extern "C" fn run<L: Library>(engine: *const c_void, job: *mut c_void, thread: c_int) {
    // SAFETY: both come from `push` below: the engine is there while its region lasts, and the job is run once.
    let (engine, job) = unsafe { (&*engine.cast::<Foreign<L>>(), *Box::from_raw(job.cast::<Job>())) };
    let pool = engine.core.id;
    if place::in_task() {
        return LATER.with_borrow_mut(|later| later.push((pool, job)));
    }
    let thread = usize::try_from(thread).expect("a thread of the region");
    let _here = engine.enter(thread);
    let lane = Lane { thread, core: &engine.core, queue: engine, base: engine };
    let mut next = Some(job);
    while let Some(job) = next {
        job.run(&lane);
        next = LATER.with_borrow_mut(|later| {
            let at = later.iter().position(|&(other, _)| other == pool);
            at.map(|at| later.remove(at).1)
        });
    }
}

extern "C" fn call(body: *mut c_void, thread: c_int) {
    // SAFETY: it comes from `region` below, which waits for this.
    let body = unsafe { &mut *body.cast::<&mut dyn FnMut(usize)>() };
    body(usize::try_from(thread).expect("a thread of the region"));
}

impl<L: Library> Submit for Foreign<L> {
    fn submit(&self, job: Job) {
        let job = Box::into_raw(Box::new(job));
        self.library.push(std::ptr::from_ref(self).cast(), job.cast(), run::<L>);
    }
}

impl<L: Library> Queue for Foreign<L> {
    fn push(&self, job: Job) {
        self.submit(job);
    }

    fn wait(&self, group: &Group) {
        self.library.wait();
        // Tasks of tasks may be left; then other threads have them.
        group.sleep(&self.core);
    }
}

impl<L: Library> Engine for Foreign<L> {
    fn region(&self, group: &Group, body: &mut dyn FnMut(&dyn Queue)) {
        let mut inside = |thread| {
            let _here = self.enter(thread);
            body(self);
        };
        let mut inside: &mut dyn FnMut(usize) = &mut inside;
        let threads = c_int::try_from(self.core.threads).expect("so many threads could be started");
        self.library.region(threads, std::ptr::from_mut(&mut inside).cast(), call);
        // All is done, if the library keeps its promise; to go on without it would be no better than a crash.
        group.sleep(&self.core);
    }
}
