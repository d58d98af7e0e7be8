//! Metrics, fields, and fields from mesh to mesh.
mod commands;
mod field;
mod goal;
mod larger_than_memory;
mod multiscale;
mod transfer;
mod transfer_larger_than_memory;
mod walls;
