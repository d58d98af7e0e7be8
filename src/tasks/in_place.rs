//! One thread: tasks run at once and in order. A task spawned within another waits until that has ended.
use super::core::Core;
use super::group::Group;
use super::job::{Job, Lane, Queue, Submit};
use std::cell::RefCell;
use std::collections::VecDeque;

/// The queue of tasks that were spawned within a task.
pub struct InPlace<'a> {
    core: &'a Core,
    jobs: RefCell<VecDeque<Job>>,
}

impl<'a> InPlace<'a> {
    pub fn new(core: &'a Core) -> Self {
        Self { core, jobs: RefCell::default() }
    }

    /// The lane that tasks run on.
    pub fn lane(&self) -> Lane<'_> {
        Lane { thread: 0, core: self.core, queue: self, base: self }
    }
}

impl Submit for InPlace<'_> {
    fn submit(&self, job: Job) {
        self.push(job);
    }
}

impl Queue for InPlace<'_> {
    fn push(&self, job: Job) {
        self.jobs.borrow_mut().push_back(job);
    }

    fn wait(&self, _: &Group) {
        loop {
            let job = self.jobs.borrow_mut().pop_front();
            let Some(job) = job else { return };
            job.run(&self.lane());
        }
    }
}
