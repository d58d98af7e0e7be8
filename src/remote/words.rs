//! What the arguments of a command mean to a service and to its clients.

/// Arguments that name what is written.
pub const WRITTEN: [&str; 3] = ["output", "report", "png"];

/// Options that are the service's to decide.
pub const DECIDED: [&str; 5] = ["threads", "scratch", "backend", "strategy", "confined"];
