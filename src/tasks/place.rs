//! Where the current thread stands: in which pools, with which id. This tells whether a call is nested.
use super::plan::Backend;
use std::cell::{Cell, RefCell};

/// A thread's stand in a pool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Identity of the pool.
    pub pool: u64,
    /// Whose thread it is.
    pub backend: Backend,
    /// Its id; none for a thread that opened a scope and does not take part in the work.
    pub thread: Option<usize>,
}

thread_local! {
    /// More than one when a task of one pool uses another.
    static PLACES: RefCell<Vec<Place>> = const { RefCell::new(Vec::new()) };
    /// Whether this thread is in the midst of a task.
    static IN_TASK: Cell<bool> = const { Cell::new(false) };
}

/// Where this thread stands in the pool, if it does.
pub fn find(pool: u64) -> Option<Place> {
    PLACES.with_borrow(|places| places.iter().rev().find(|place| place.pool == pool).copied())
}

/// This thread stands there until the guard goes.
pub fn enter(place: Place) -> Entered {
    PLACES.with_borrow_mut(|places| places.push(place));
    Entered
}

/// Leaves the place when dropped.
pub struct Entered;

impl Drop for Entered {
    fn drop(&mut self) {
        PLACES.with_borrow_mut(Vec::pop);
    }
}

/// Whether this thread is in the midst of a task: nothing but what the task waits for may run on it.
#[cfg(any(feature = "tbb", feature = "openmp"))]
pub fn in_task() -> bool {
    IN_TASK.get()
}

/// Marks this thread as being in a task or not, until the guard goes.
pub fn mark(in_task: bool) -> Marked {
    Marked(IN_TASK.replace(in_task))
}

/// Sets the mark back when dropped.
pub struct Marked(bool);

impl Drop for Marked {
    fn drop(&mut self) {
        IN_TASK.set(self.0);
    }
}
