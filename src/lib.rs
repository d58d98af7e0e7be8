//! geo-adapt: anisotropic adaptation of tetrahedral meshes to a metric, on the real CAD model.
//!
//! The way of the data: a [`mesh::TetMesh`] is classified on a [`geometry::Model`], given a
//! [`metric::Field`], adapted by [`adapt`], and comes out as a [`mesh::TetMesh`] again.
//! [`sizing`] makes the metric that the model itself asks for, [`image`] makes a first mesh of a 3D image,
//! [`transfer`] brings fields from one mesh to another, [`view`] shows one.
//! [`Adapter`] is all of it in memory, for a solver; [`cycle`] is the loop with one that is a program.
//! Imports go one way: `{ cli → cycle, api } → { adapt, image } → sizing → { metric, geometry } → transfer → mesh → tasks`; `view` stands on metric and below.
pub mod adapt;
pub mod api;
pub mod cli;
pub mod cycle;
pub mod formats;
pub mod geometry;
pub mod image;
pub mod memory;
pub mod mesh;
pub mod metric;
pub mod sizing;
pub mod tasks;
pub mod transfer;
pub mod view;

pub use api::Adapter;
