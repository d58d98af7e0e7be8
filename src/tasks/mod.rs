//! Tasks: loops and scopes whose work is done by threads, and the trace of a run. It knows nothing of meshes.
//!
//! A [`Pool`] is a number of threads. [`Pool::task_for`] applies a function to chunks of items, [`Pool::scope`] lets tasks be spawned
//! one by one, also from tasks. A [`Team`] is a pool with the plan of a run: lists, sums, sorts whose results do not depend on the threads.
//! How the tasks are made ([`Strategy`], [`Plan::grain`]) and who runs them ([`Backend`]) is said at each call.
//!
//! # Rules
//! - **Thread ids.** A task is told the thread it runs on, in [0, n), for its whole length. Two tasks never have the same id at once,
//!   with one exception: while a task *waits* (for a `task_for` or `scope` of the same pool within it), tasks of that loop or scope, and
//!   no others, may run with its id. So a task that uses the state of a thread gives it back before it waits, or knows that those
//!   tasks do not need it.
//! - **Spawning in a task runs nothing**: [`Task::spawn`] only puts the new task in a queue. ([`Scope::spawn`], called by the scope's
//!   body, may run the task at once; with one thread it does.)
//! - **One at a time.** A pool does one outermost loop or scope at a time; another thread that calls it meanwhile waits for its turn. So ids
//!   stay unique even when back-ends are mixed. Calls of a pool inside one of its tasks are nested: they run on the back-end of the outermost
//!   one, whatever their plan says.
//! - **Panics** are caught. All other tasks of the loop or scope end, then the first panic goes on in the thread that waits. With one thread
//!   a loop ends at its first panic.
//! - **One thread** makes no tasks: everything runs in place, in order.
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
mod parking;
mod place;
mod plan;
mod pool;
mod rows;
mod scope;
mod simulation;
mod sort;
mod stage;
mod strategy;
mod team;
mod words;

pub use plan::{Backend, Plan, Strategy};
pub use pool::{Error, Pool};
pub use rows::Rows;
pub use scope::{Scope, Task};
pub use simulation::{section, threads_to_simulate, told as simulation_told};
pub use stage::{stage, tell_stages};
pub use team::{GRAIN, Team};
pub use words::{plain, zeros};

// The locks of the slots; tests/parking_protocol.rs has loom's in their place.
use std::sync;
