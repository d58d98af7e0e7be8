//! The processes of a run: one, or those that `mpirun -n 4 geo-adapt …` starts. They share nothing, and send each other bytes.
//!
//! [`start`] says who takes part. All that ranks say to each other goes through two calls, which every rank makes in the same order:
//! [`Ranks::exchange`] and [`Ranks::gather`]. [`agree`], [`sum`], [`sum_reals`] and [`broadcast`] are made of them. No reduction of MPI is
//! used: its order, and so the last bits of a sum, would be MPI's to choose.
//!
//! # How a run ends
//! MPI waits for ever for a rank that does not come. So that none does:
//!
//! - What can fail on one rank alone (a file, memory, bad input) goes through [`agree`] before the next call: then all ranks return the error.
//! - A rank that drops its [`Ranks`] while others wait for it (an error that was not agreed on) is missed by them: they wait until it has
//!   said what was wrong and its exit ends the run, and after some seconds end it themselves.
//! - A rank that panics ends the run when its [`Ranks`] is dropped, and so does one that exits or is killed: mpirun sees it.
//! - Whoever must end the run at once, from a hook or a thread, calls [`abort`] and not `std::process::exit`.
//!
//! Keep the box that [`start`] gave on the thread that called it, and drop it when all files are written: after that mpirun ends all ranks
//! as soon as one has an exit code that is not 0.
mod abort;
mod alone;
mod start;
mod together;
#[cfg(feature = "mpi")]
mod world;

pub use abort::abort;
pub use alone::Alone;
#[cfg(any(test, feature = "internals"))]
pub use start::start_in_pieces;
pub use start::{check, is_one_of_several, start};
pub use together::{agree, broadcast, sum, sum_reals};

/// The processes of a run. What is said of one rank holds for all: they make the same calls in the same order.
pub trait Ranks: Sync {
    /// The number of this one, from 0.
    fn rank(&self) -> usize;

    /// How many there are, at least 1.
    fn count(&self) -> usize;

    /// Sends each message to its rank (its own is allowed) and returns those for this one with the ranks that sent them: in the order of
    /// these ranks and, of one rank, in the order in which it gave them. Messages may have any length, 0 too. Collective.
    ///
    /// # Panics
    /// Where a rank is not below [`Self::count`], where ranks make different calls, and on another thread than that of [`start`].
    fn exchange(&self, messages: Vec<(usize, Vec<u8>)>) -> Vec<(usize, Vec<u8>)>;

    /// The bytes of every rank, in the order of ranks. They may differ in length. Collective.
    ///
    /// # Panics
    /// As [`Self::exchange`].
    fn gather(&self, own: &[u8]) -> Vec<Vec<u8>>;

    /// What this rank has sent so far, and how long it has waited. Not collective.
    fn traffic(&self) -> Traffic;
}

/// What a rank has said to others.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Traffic {
    /// Bytes sent to other ranks. What a rank sends to itself is not counted.
    pub sent: u64,
    /// Seconds spent in calls: waiting for others, and sending.
    pub waited: f64,
}
