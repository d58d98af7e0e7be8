//! Work for each thread once.
use super::group::Group;
use super::job::{Job, Lane, Work};
use super::place;
use super::plan::Strategy;
use std::ops::Range;

/// Work that each thread does once.
pub struct Each<'w> {
    work: &'w (dyn Fn(usize) + Sync),
    pub group: Group,
}

impl<'w> Each<'w> {
    pub fn new(threads: usize, work: &'w (dyn Fn(usize) + Sync), waiter: usize) -> Self {
        Self { work, group: Group::new(threads, waiter) }
    }

    /// The task of a thread.
    ///
    /// # Safety
    /// This stays until its group is done. To be called once a thread.
    pub unsafe fn job(&self) -> Job {
        // SAFETY: the caller's promise.
        unsafe { Job::part(self, &self.group, Strategy::Flat, 0..1) }
    }
}

impl Work for Each<'_> {
    fn run(&self, _: Strategy, _: Range<usize>, lane: &Lane<'_>) {
        let _in_task = place::mark(true);
        (self.work)(lane.thread);
    }
}
