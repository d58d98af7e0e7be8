//! Tasks: work handed to threads without a word of how, and the trace of a run; knows nothing of meshes.
//!
//! A [`Pool`] is a number of threads. [`Pool::task_for`] applies a function to chunks of items, [`Pool::scope`] lets tasks be spawned
//! one by one, also from tasks. A [`Team`] is a pool with the plan of a run: lists, sums, sorts whose results do not depend on the threads.
//! How the tasks are made ([`Strategy`], [`Plan::grain`]) and who runs them ([`Backend`]) is said at each call.
//!
//! # Rules
//! - **Thread ids.** A task is told the thread it runs on, in [0, n), for its whole length. Two tasks never have the same id at once,
//!   except that a task which *waits* (a `task_for` or `scope` of the same pool within it) may have its descendants run with its id
//!   meanwhile: those of the loop or scope it waits for, and nothing else. Who takes the state of a thread gives it back before
//!   waiting, or knows that what it waits for does not need it.
//! - **Spawning in a task runs nothing**: a task's [`Task::spawn`] only puts the new task in a queue. (That of the body,
//!   [`Scope::spawn`], may run the task at once; with one thread it does.)
//! - **One at a time.** A pool does one outermost loop or scope at a time; another thread that comes meanwhile waits for its turn. So ids stay
//!   unique whatever back-ends are mixed. Inside a task the pool's own calls are nested in the one that runs: on its back-end, whatever their
//!   plan says of that.
//! - **Panics** are caught; all other tasks of the loop or scope end, then the first panic goes on in who waits. With one thread a loop ends
//!   at its first panic.
//! - **One thread** makes no task: all runs in place, in order.
//! - In a task of the rayon back-end, rayon's own parallel calls must not be used: rayon would run other tasks while they wait.
mod backends;
pub mod claims;
mod core;
mod each;
mod gather;
mod group;
mod in_place;
mod job;
pub mod lock;
mod nested;
mod place;
mod plan;
mod pool;
mod rows;
mod scope;
mod seats;
mod sort;
mod stage;
mod strategy;
mod team;

pub use plan::{Backend, Plan, Strategy};
pub use pool::{Error, Pool};
pub use rows::Rows;
pub use scope::{Scope, Task};
pub use stage::stage;
pub use team::{GRAIN, Team};

// The locks of the seats; tests/sleep_protocol.rs has loom's in their place.
use std::sync;
