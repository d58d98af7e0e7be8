//! OpenMP: a parallel region whose first thread makes tasks and whose others run them.
use super::foreign::{Call, Foreign, Library, Run};
use crate::tasks::core::Core;
use crate::tasks::plan::Backend;
use std::ffi::{c_int, c_void};
use std::sync::Arc;

// See cpp/openmp.cpp.
unsafe extern "C" {
    fn geo_adapt_openmp_region(threads: c_int, body: *mut c_void, call: Call);
    fn geo_adapt_openmp_push(engine: *const c_void, job: *mut c_void, run: Run);
    fn geo_adapt_openmp_wait();
}

/// OpenMP, which keeps its threads itself.
pub struct OpenMp;

/// Threads of OpenMP, which it starts with the first region.
pub fn new(core: &Arc<Core>) -> Foreign<OpenMp> {
    Foreign::new(core, OpenMp)
}

// SAFETY: the barrier at the end of a parallel region waits for all its tasks, its threads are numbered, and tied tasks stay on theirs.
unsafe impl Library for OpenMp {
    const BACKEND: Backend = Backend::OpenMp;

    fn region(&self, threads: c_int, body: *mut c_void, call: Call) {
        // SAFETY: of the trait's promises nothing is wanted of who calls.
        unsafe { geo_adapt_openmp_region(threads, body, call) }
    }

    fn push(&self, engine: *const c_void, job: *mut c_void, run: Run) {
        // SAFETY: as above.
        unsafe { geo_adapt_openmp_push(engine, job, run) }
    }

    fn wait(&self) {
        // SAFETY: as above.
        unsafe { geo_adapt_openmp_wait() }
    }
}
