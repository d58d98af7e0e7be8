//! What the programs of tests share.
#![allow(dead_code, reason = "each program of tests uses its own part")]
use std::path::{Path, PathBuf};

pub mod adapting;
pub mod damage;
pub mod models;
#[cfg(feature = "cli")]
pub mod viewing;

/// A file of the shared cases, such as `cube/cube-linear-00.meshb`, or None where they are not: then the test
/// says so on stderr, and its caller passes over it. They lie beside the project, or where GEO_ADAPT_SHARED says.
pub fn shared_case(name: &str) -> Option<PathBuf> {
    let shared = std::env::var_os("GEO_ADAPT_SHARED")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared"), PathBuf::from);
    let path = shared.join("cases").join(name);
    if path.is_file() {
        return Some(path);
    }
    eprintln!("skipped: {} is not there (GEO_ADAPT_SHARED names the folder)", path.display());
    None
}

/// The built program.
pub fn program() -> std::process::Command {
    std::process::Command::new(env!("CARGO_BIN_EXE_geo-adapt"))
}
