//! geo-adapt: anisotropic adaptation of tetrahedral meshes to a metric, on the real CAD model.
//!
//! A mesh, a metric at its vertices and, where there is one, a CAD model go in; out comes a mesh whose edges all have about length one in
//! the metric, and whose boundary vertices lie on the model.
//!
//! # The interface
//! What this page lists is the interface; releases say what changes in it. [`Adapter`] adapts, and the rest is what goes in and comes out:
//!
//! | | |
//! | --- | --- |
//! | in | [`MeshView`] (slices) or a [`TetMesh`]; metrics as [`Sym3`], `[f64; 6]` or nalgebra's `Matrix3<f64>`; [`Settings`] with [`Options`] |
//! | model | [`Adapter::on_cad`] reads a file, [`Adapter::on_model`] takes a [`Model`], [`Adapter::discrete`] takes the mesh's own surface, [`Adapter::on_surface`] that of another mesh, which stays |
//! | out | [`AdaptedMesh`]: the mesh, its metric, [`Parents`] to bring fields along, its place on the model; [`Report`] measures it |
//! | files | [`io`]: libMeshb's .meshb and .solb |
//! | wrong input | [`Error`], never a panic |
//!
//! The modules of the implementation are public only for the program `geo-adapt` and for our own tests. They are hidden, and they may
//! change with any release.
//!
//! # A first run
//! ```
//! use geo_adapt::{Adapter, MeshView, Settings, Sym3};
//!
//! // The unit tetrahedron, with edges of 1/2 wanted in x and y and of 1/4 in z.
//! let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let tets = [[0, 1, 2, 3]];
//! let metric = [Sym3::diagonal(4.0, 4.0, 16.0); 4];
//!
//! let mut adapter = Adapter::discrete(Settings { threads: 1, ..Settings::default() })?;
//! let adapted = adapter.adapt(&MeshView { vertices: &vertices, tets: &tets, ..MeshView::default() }, &metric)?;
//!
//! let report = adapter.report(&adapted)?;
//! assert!(report.statistics.edge_lengths.max < 2.0 && report.statistics.mean_ratios.min > 0.1);
//! # Ok::<(), geo_adapt::Error>(())
//! ```
//!
//! # On a CAD model, from files
//! ```no_run
//! use geo_adapt::{Adapter, MeshView, Settings, io};
//! use std::path::Path;
//!
//! let mesh = io::read_mesh(Path::new("wing.meshb"))?.content;
//! let metric = io::read_metric(Path::new("wing.solb"), mesh.vertices.len())?.content;
//! let settings = Settings { complexity: Some(50_000.0), ..Settings::default() };
//! let mut adapter = Adapter::on_cad(Path::new("wing.step"), settings)?;
//! let adapted = adapter.adapt(&MeshView::of(&mesh), &metric)?;
//! io::write_mesh(Path::new("adapted.meshb"), &adapted.mesh)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # nalgebra
//! Points and tensors of nalgebra go in without a copy of your own, and [`Sym3`] turns into a `Matrix3<f64>` and back.
//! ```
//! use geo_adapt::{Adapter, MeshView, Settings, Sym3};
//! use nalgebra::{Matrix3, Point3, Vector3};
//!
//! let points = [Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0), Point3::new(0.0, 0.0, 1.0)];
//! let metric = vec![Matrix3::from_diagonal(&Vector3::new(4.0, 4.0, 16.0)); points.len()];
//! let view = MeshView { vertices: geo_adapt::coordinates(&points), tets: &[[0, 1, 2, 3]], ..MeshView::default() };
//!
//! let adapted = Adapter::discrete(Settings::default())?.adapt(&view, &metric)?;
//! let first = Matrix3::from(Sym3(adapted.metric[0]));
//! assert!(first.symmetric_eigenvalues().min() > 0.0);
//! # Ok::<(), geo_adapt::Error>(())
//! ```
//!
//! # Features
//! `occt` (default) reads CAD models by OpenCASCADE. `cli` (default) is the program and all that only it needs; a library goes without:
//! `geo-adapt = { version = "0.1", default-features = false, features = ["occt"] }`. `tbb` and `openmp` are further task back-ends, and
//! `mpi` runs on several machines.
#[doc(hidden)]
pub mod adapt;
pub mod api;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cycle;
#[doc(hidden)]
pub mod decomposition;
#[doc(hidden)]
pub mod delaunay;
#[cfg(feature = "formats")]
#[doc(hidden)]
pub mod formats;
#[doc(hidden)]
pub mod geometry;
#[cfg(feature = "image")]
#[doc(hidden)]
pub mod image;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod inspection;
#[doc(hidden)]
pub mod memory;
#[doc(hidden)]
pub mod mesh;
#[doc(hidden)]
pub mod metric;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod process;
#[doc(hidden)]
pub mod ranks;
#[cfg(feature = "serve")]
#[doc(hidden)]
pub mod remote;
#[cfg(all(feature = "serve", target_os = "linux"))]
#[doc(hidden)]
pub mod serve;
#[doc(hidden)]
pub mod sizing;
#[cfg(feature = "occt")]
#[doc(hidden)]
pub mod surface;
#[doc(hidden)]
pub mod tasks;
#[doc(hidden)]
pub mod transfer;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod view;

#[doc(inline)]
pub use api::{
    AdaptedMesh, Adapter, Association, Backend, Classification, Counts, Criterion, Deviation, DiscreteOptions,
    Distribution, Eigen, Elements, Entity, Error, Farthest, Fidelity, Freeze, Geometry, Grains, Kind, MeshView, Model,
    Observer, OnEdge, OnFace, OnVertex, Options, Parents, Plan, PointCreation, Refusal, Report, Scheduler, Settings,
    Statistics, Strategy, SurfaceBounds, Sym3, TetMesh, Topology, Vec3, coordinates, io,
};
