//! The operations: each finds what it would change, and has it changed by the core.
pub mod collapse;
pub mod insertion;
pub mod projection;
pub mod reconnection;
pub mod repair;
pub mod smoothing;
