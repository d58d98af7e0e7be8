//! What needs OpenCASCADE: CAD models, and what is made of them.
#![cfg(all(feature = "cli", feature = "occt"))]
mod adapt;
mod apex;
mod book;
mod bootstrap;
mod bootstrap_heal;
mod bootstrap_own;
mod bounds;
mod chords;
mod classify;
mod closest_points;
#[path = "../common/mod.rs"]
mod common;
mod copies;
mod crossed;
mod damaged;
mod gaps;
mod geometry_scripts;
mod metric_geometry;
mod model;
mod model_names;
mod model_refused;
mod projections;
mod reading;
mod settled;
mod spline_faces;
mod view_model;
mod walls;
