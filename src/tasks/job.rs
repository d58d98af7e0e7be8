//! A task as the queues hold it, without its lifetime.
use super::core::Core;
use super::group::Group;
use super::nested::{self, Nested};
use super::plan::Strategy;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// Where a task runs, and where it puts the tasks that it makes.
pub struct Lane<'a> {
    /// Id of the thread.
    pub thread: usize,
    pub core: &'a Core,
    /// For tasks of the group that the running one belongs to.
    pub queue: &'a dyn Queue,
    /// For tasks that any thread of the back-end may take.
    pub base: &'a dyn Submit,
}

/// The queue of a group, seen from one thread.
pub trait Queue {
    /// Puts a task where some thread finds it. Never runs a client's task on top of another.
    fn push(&self, job: Job);

    /// Waits until all tasks of the group have ended, running some meanwhile.
    fn wait(&self, group: &Group);
}

/// The way to a back-end's threads from any of them.
pub trait Submit {
    /// Puts a task where some thread finds it, sooner or later.
    fn submit(&self, job: Job);
}

/// A loop that is cut into parts.
pub trait Work: Sync {
    /// Does one step of the range, and puts the rest into the lane's queue in the strategy's way.
    fn run(&self, strategy: Strategy, range: Range<usize>, lane: &Lane<'_>);
}

/// What [`Job::once`] calls.
pub type Call<'a> = Box<dyn FnOnce(&Lane<'_>) + Send + 'a>;

/// A task.
pub struct Job(Kind);

enum Kind {
    /// Part of a loop.
    Part { work: *const dyn Work, group: *const Group, strategy: Strategy, range: Range<usize> },
    /// A closure.
    Once { call: Call<'static>, group: *const Group },
    /// Runs tasks of a nested group until its queue is empty; no task itself.
    Help(Arc<Nested>),
}

// SAFETY: Work and Group are Sync, the closure is Send, and who makes a job answers for their lifetime.
unsafe impl Send for Job {}

impl Job {
    /// Part of a loop.
    ///
    /// # Safety
    /// `work` and `group` stay until the group is done, and the group counts this job.
    pub unsafe fn part<'a>(work: &'a (dyn Work + 'a), group: &Group, strategy: Strategy, range: Range<usize>) -> Self {
        // SAFETY: only the lifetime changes; the caller answers for it.
        let work = unsafe { std::mem::transmute::<*const (dyn Work + 'a), *const (dyn Work + 'static)>(work) };
        Self(Kind::Part { work, group, strategy, range })
    }

    /// A closure.
    ///
    /// # Safety
    /// What the closure borrows and `group` stay until the group is done, and the group counts this job.
    pub unsafe fn once<'a>(call: Call<'a>, group: &Group) -> Self {
        // SAFETY: only the lifetime changes; the caller answers for it.
        let call = unsafe { std::mem::transmute::<Call<'a>, Call<'static>>(call) };
        Self(Kind::Once { call, group })
    }

    /// A call for help with a nested group.
    pub fn help(nested: Arc<Nested>) -> Self {
        Self(Kind::Help(nested))
    }

    /// Runs it; a panic goes to its group.
    pub fn run(self, lane: &Lane<'_>) {
        let (result, group) = match self.0 {
            Kind::Part { work, group, strategy, range } => {
                // SAFETY: by the contract of `part` the work is there: this job is not counted yet.
                let result = catch_unwind(AssertUnwindSafe(|| unsafe { (*work).run(strategy, range, lane) }));
                (result, group)
            }
            // What the closure holds is dropped before the job is counted.
            Kind::Once { call, group } => (catch_unwind(AssertUnwindSafe(|| call(lane))), group),
            Kind::Help(nested) => return nested::help(&nested, lane),
        };
        // SAFETY: by the contracts of `part` and `once` the group is there until this job is counted, which `finish` does.
        unsafe {
            if let Err(panic) = result {
                (*group).fail(panic);
            }
            Group::finish(group, lane.core);
        }
    }
}
