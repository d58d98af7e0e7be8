//! How a run ends at once.

/// Ends all ranks at once, and mpirun with this code; with one process, ends it. It may be called on any thread, before
/// [`start`](super::start) and after the end too. What is wrong is to be said before: nothing is said here, and other ranks have no time
/// to write anything.
pub fn abort(code: i32) -> ! {
    // On another thread MPI must not be called: mpirun ends the others when it sees that this process exits.
    #[cfg(feature = "mpi")]
    if caller::is_this_thread() && !mpi::environment::is_finalized() {
        use mpi::traits::Communicator;
        mpi::topology::SimpleCommunicator::world().abort(code);
    }
    std::process::exit(code)
}

/// The thread that started MPI. It alone may call it (`mpi::Threading::Funneled`).
#[cfg(feature = "mpi")]
pub mod caller {
    use std::sync::OnceLock;
    use std::thread::{self, ThreadId};

    static THREAD: OnceLock<ThreadId> = OnceLock::new();

    /// From now on this thread calls MPI.
    pub fn set() {
        THREAD.get_or_init(|| thread::current().id());
    }

    /// Whether MPI was started, by this thread.
    pub fn is_this_thread() -> bool {
        THREAD.get() == Some(&thread::current().id())
    }
}
