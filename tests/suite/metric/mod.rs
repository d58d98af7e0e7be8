//! Metrics, fields, and fields from mesh to mesh.
mod commands;
mod field;
mod multiscale;
mod transfer;
