//! A group of tasks to be waited for, with the first panic among them.
use super::core::Core;
use super::parking::For;
use std::any::Any;
use std::panic::resume_unwind;
use std::sync::Mutex;
use std::sync::atomic::{
    AtomicUsize,
    Ordering::{AcqRel, Acquire, Relaxed},
};

type Panic = Box<dyn Any + Send>;

/// Tasks that are waited for together.
pub struct Group {
    pending: AtomicUsize,
    /// Slot of who waits.
    waiter: usize,
    panic: Mutex<Option<Panic>>,
}

impl Group {
    /// A group of so many tasks, waited for in this slot.
    pub fn new(pending: usize, waiter: usize) -> Self {
        Self { pending: AtomicUsize::new(pending), waiter, panic: Mutex::new(None) }
    }

    /// Adds a task. Only the waiting thread or a task of the group may call this: then the count is not zero, or nobody waits yet.
    pub fn add(&self) {
        self.pending.fetch_add(1, Relaxed);
    }

    /// Whether all tasks have ended; what they did is seen then.
    pub fn is_done(&self) -> bool {
        self.pending.load(Acquire) == 0
    }

    /// Keeps the first panic.
    pub fn fail(&self, panic: Panic) {
        self.panic.lock().expect("nothing panics under this lock").get_or_insert(panic);
    }

    /// Goes on with the first panic, if any; to be called when all is done.
    pub fn resume(&self) {
        let panic = self.panic.lock().expect("nothing panics under this lock").take();
        if let Some(panic) = panic {
            resume_unwind(panic);
        }
    }

    /// Parks in the waiter's slot until all is done.
    pub fn sleep(&self, core: &Core) {
        while !self.is_done() {
            core.parking.park(self.waiter, For::Call, || self.is_done());
        }
    }

    /// Slot of who waits.
    pub fn waiter(&self) -> usize {
        self.waiter
    }

    /// Counts one task as ended.
    ///
    /// # Safety
    /// The group is there, and a task of it that has not been counted yet keeps it there; it may be gone when this returns.
    pub unsafe fn finish(group: *const Self, core: &Core) {
        // SAFETY: the task counted below keeps the group. The references end with each statement; the last is that of the count
        // itself, as when an Arc is given back.
        let last = unsafe {
            let waiter = (*group).waiter;
            ((*group).pending.fetch_sub(1, AcqRel) == 1).then_some(waiter)
        };
        if let Some(waiter) = last {
            core.parking.unpark(waiter);
        }
    }
}
