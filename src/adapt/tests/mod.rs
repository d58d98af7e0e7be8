//! Tests of the kernel as a whole: operations one by one, in random order, and on many threads.
pub(super) mod bench;
mod deterministic;
mod parts;
mod random;
mod stress;
mod sweeps;
