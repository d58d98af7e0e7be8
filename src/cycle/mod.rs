//! The loop: mesh → solver → metric → adaptation → transfer → solver, until it is fine enough or a functional does not change any more.
//!
//! Every step has a folder of its own and is a command that the user can type again (`step`). What is there on the disk is the
//! whole state: a loop that was killed goes on after its last finished step.
mod adaptation;
mod changes;
mod config;
mod data;
mod done;
mod error;
pub mod example;
mod field_value;
mod goal;
mod history;
mod inputs;
pub mod launch;
mod layout;
pub mod left;
mod leftovers;
mod observer;
mod pipeline;
mod plan;
mod probe;
mod report;
mod result;
mod run;
mod schedule;
pub mod solver;
mod step;

pub use adaptation::made_of;
pub use config::{Config, FIRST, Loaded, Schedule, Solvers, parse};
pub use error::Error;
pub use history::{Cycle, History, Seconds};
pub use layout::Layout;
pub use observer::{Observer, Options};
pub use plan::{Plan, plan};
pub use result::Files;
pub use run::{Ended, run};
