//! What is the same with OpenCASCADE and without it, one folder a subject. What differs is in tests/either, what needs it in tests/cad: tests/run holds it.
//! One program, so that the library is linked once and the runner of the tests fills all cores.
//! A test that sets what a whole process shares (environment, signals, limits, the allocator) sets it in a child, or is in a program of its own.
#![cfg(feature = "cli")]
mod adapt;
mod bootstrap;
mod browser;
#[path = "../common/mod.rs"]
mod common;
mod cycle;
mod files;
mod image;
mod metric;
mod project;
mod view;
