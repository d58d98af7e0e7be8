//! oneTBB: an arena with a place for each thread, and a task group.
use super::foreign::{Call, Foreign, Library, Run};
use crate::tasks::core::Core;
use crate::tasks::plan::Backend;
use std::ffi::{c_int, c_void};
use std::ptr::NonNull;
use std::sync::Arc;

/// See cpp/tbb.cpp.
#[repr(C)]
struct Arena {
    opaque: [u8; 0],
}

unsafe extern "C" {
    fn geo_adapt_tbb_new(threads: c_int) -> NonNull<Arena>;
    fn geo_adapt_tbb_delete(arena: NonNull<Arena>);
    fn geo_adapt_tbb_region(arena: NonNull<Arena>, body: *mut c_void, call: Call);
    fn geo_adapt_tbb_push(arena: NonNull<Arena>, engine: *const c_void, job: *mut c_void, run: Run);
    fn geo_adapt_tbb_wait(arena: NonNull<Arena>);
}

/// An arena.
pub struct Tbb(NonNull<Arena>);

/// Threads of oneTBB, which it starts when there are tasks.
pub fn new(core: &Arc<Core>) -> Foreign<Tbb> {
    let threads = c_int::try_from(core.threads).expect("so many threads could be started");
    // SAFETY: the number is at least two.
    Foreign::new(core, Tbb(unsafe { geo_adapt_tbb_new(threads) }))
}

// SAFETY: arena and group may be used by any thread.
unsafe impl Send for Tbb {}
// SAFETY: as above.
unsafe impl Sync for Tbb {}

// SAFETY: a thread of the arena has its own index there, a place is kept for who opens the region, and the group is waited for at its end.
unsafe impl Library for Tbb {
    const BACKEND: Backend = Backend::Tbb;

    fn region(&self, _: c_int, body: *mut c_void, call: Call) {
        // SAFETY: the arena is there until this is dropped.
        unsafe { geo_adapt_tbb_region(self.0, body, call) }
    }

    fn push(&self, engine: *const c_void, job: *mut c_void, run: Run) {
        // SAFETY: as above.
        unsafe { geo_adapt_tbb_push(self.0, engine, job, run) }
    }

    fn wait(&self) {
        // SAFETY: as above; the body is inside the arena.
        unsafe { geo_adapt_tbb_wait(self.0) }
    }
}

impl Drop for Tbb {
    fn drop(&mut self) {
        // SAFETY: made by geo_adapt_tbb_new, dropped once, and no region is open.
        unsafe { geo_adapt_tbb_delete(self.0) }
    }
}
