//! What can differ with OpenCASCADE and without it: tests/run runs these both ways, and all others once.
#![cfg(feature = "cli")]
mod adapt_sizes;
mod by_parts;
mod by_ranks;
#[path = "../common/mod.rs"]
mod common;
mod deterministic;
mod endless_inputs;
mod frozen;
mod growth;
mod inspect;
mod kill_points;
mod library;
mod loop_by_ranks;
mod memory_end;
#[cfg(feature = "mpi")]
mod mpirun;
mod narrow_voids;
mod no_backend;
#[cfg(feature = "mpi")]
mod rank_faults;
mod ranks;
