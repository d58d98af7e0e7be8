//! The adapter in memory, for a solver that calls it between its steps: mesh and metric as slices in, mesh, metric and parents out. No
//! file is read or written but the CAD model, which is read once. Model and threads are kept between the calls.
//!
//! ```
//! use geo_adapt::api::{Adapter, MeshView, Settings};
//!
//! // A tetrahedron, with a metric that asks for edges of length 1/2.
//! let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let tets = [[0, 1, 2, 3]];
//! let metric = [[4.0, 0.0, 4.0, 0.0, 0.0, 4.0]; 4];
//!
//! let mut adapter = Adapter::discrete(Settings { threads: 1, ..Settings::default() })?;
//! let first = adapter.adapt(&MeshView { vertices: &vertices, tets: &tets, ..MeshView::default() }, &metric)?;
//! assert!(first.mesh.vertices.len() > 4);
//!
//! // A field of the caller's, brought to the new vertices.
//! let density = [1.0, 2.0, 3.0, 4.0];
//! let density = first.parents.interpolate(&tets, 1, &density);
//! assert_eq!(density.len(), first.mesh.vertices.len());
//!
//! // What came out goes in again, with its place on the surface: nothing is looked for anew.
//! let second = adapter.adapt(&first.view(), &first.metric)?;
//! assert_eq!(second.parents.tets.len(), second.mesh.vertices.len());
//! # Ok::<(), geo_adapt::api::Error>(())
//! ```
//!
//! **On a CAD model** take [`Adapter::on_cad`]. OpenCASCADE reads the file in the caller's own process, and on a damaged file it can crash,
//! which no error can tell. The program `geo-adapt` therefore reads each model in a child process first; a library starts no processes of
//! its own accord. Who takes models from strangers runs `geo-adapt model FILE` before: its exit code is 0 for a model that can be read. All else
//! that is wrong with model, mesh or metric is an [`Error`], never a panic.
//!
//! **The same mesh** as by `geo-adapt adapt` comes out, to the last bit and on any number of threads, when the same mesh, metric and settings
//! go in. The one difference is a [`MeshView`] with its `place`, which the program finds anew from its files.
mod error;
pub mod io;
mod output;
mod place;
mod report;
mod source;
#[cfg(test)]
mod surface_tests;
mod view;

pub use error::Error;
pub use output::{AdaptedMesh, Parents};
pub use report::Report;
pub use view::{MeshView, coordinates};

// What these are made of.
#[doc(inline)]
pub use crate::adapt::forecast::Forecast;
#[doc(inline)]
pub use crate::adapt::{
    Counts, Criterion, Freeze, Grains, GrowthEnd, Kind, Observer, Options, PointCreation, Refusal, Scheduler,
    SurfaceBounds,
};
#[doc(inline)]
pub use crate::geometry::classify::Classification;
#[doc(inline)]
pub use crate::geometry::discrete::DiscreteOptions;
#[doc(inline)]
pub use crate::geometry::fidelity::{Deviation, Farthest, Fidelity};
#[doc(inline)]
pub use crate::geometry::{Entity, Geometry, Model, Topology};
#[doc(inline)]
pub use crate::mesh::vector::Vec3;
#[doc(inline)]
pub use crate::mesh::{Association, Elements, OnEdge, OnFace, OnVertex, TetMesh};
#[doc(inline)]
pub use crate::metric::{Distribution, Eigen, Statistics, Sym3};
#[doc(inline)]
pub use crate::sizing::chords::{ChordLimit, Limited};
#[doc(inline)]
pub use crate::tasks::{Backend, Plan, Strategy};

use crate::adapt;
use crate::geometry::Discrete;
use crate::geometry::classify;
use crate::geometry::discrete::{complete_boundary, complete_matched};
use crate::mesh::adjacency::MatchedFaces;
use crate::mesh::split_nonmanifold::{copy_values, split_nonmanifold};
use crate::metric::Source;
use crate::tasks::{Pool, Team};
use std::path::Path;
use std::sync::Arc;

/// How to adapt: what the program's options say.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Threads; 0 stands for all cores.
    pub threads: usize,
    /// Scale the metric to this complexity, about half the number of vertices; without it the metric is taken as it is.
    pub complexity: Option<f64>,
    /// What is done with sizes along curved walls that are longer than straight edges can have.
    pub chords: ChordLimit,
    /// How far a vertex of the input may be from the CAD model, in its units. By default 1e-6 of the model's diagonal.
    pub tolerance: Option<f64>,
    /// How triangles become a model where there is none: the ridge angle, and whether it is smooth.
    pub surface: DiscreteOptions,
    /// All else: what is frozen, bounds of the surface, the scheduler.
    pub options: Options,
}

/// What the boundary lies on.
enum Ground {
    /// A model that was given: of CAD, read once, which other adapters may have too, or a surface.
    Cad(Arc<Model>),
    /// The surface of the mesh that came last without a place, once there was one.
    Surface(Option<Box<Model>>),
}

impl Ground {
    /// The model, if there is one by now.
    fn model(&self) -> Option<&Model> {
        match self {
            Ground::Cad(model) => Some(model),
            Ground::Surface(model) => model.as_deref(),
        }
    }
}

/// An adapter that keeps its model and its threads between the calls.
pub struct Adapter {
    ground: Ground,
    settings: Settings,
    pool: Pool,
}

impl Adapter {
    /// Without a CAD model: the surface of the mesh is the model. It is that of the last mesh that came without a
    /// [`place`](MeshView::place); as long as meshes come with theirs it stays the same, however often they are adapted.
    ///
    /// # Errors
    /// [`Error::Threads`] when the system refuses the threads.
    pub fn discrete(settings: Settings) -> Result<Self, Error> {
        Self::new(Ground::Surface(None), settings)
    }

    /// On a CAD model: .step, .stp, .iges, .igs, .brep or .egads. See the [module](self) for damaged files.
    ///
    /// # Errors
    /// [`Error::Model`] when the file is no readable model, or this build has no CAD backend; [`Error::Threads`] when the system refuses
    /// the threads.
    pub fn on_cad(path: &Path, settings: Settings) -> Result<Self, Error> {
        Self::on_model(Model::read(path)?, settings)
    }

    /// On the surface of a mesh, which stays the model of all meshes that come: their boundaries lie on it, and nothing drifts over a loop.
    /// It may be of triangles alone; then these look outward. `settings.surface` says how it becomes a model.
    ///
    /// # Errors
    /// [`Error`], by what is wrong with the surface; [`Error::Threads`] when the system refuses the threads.
    pub fn on_surface(view: &MeshView<'_>, settings: Settings) -> Result<Self, Error> {
        let mut mesh = view.mesh()?;
        complete_boundary(Team::alone(), &mut mesh);
        let (model, _) = Discrete::new(Team::alone(), &mesh, &settings.surface)?;
        Self::on_model(Model::Discrete(model), settings)
    }

    /// On a model that was read before. Several adapters may share one in an [`Arc`].
    ///
    /// # Errors
    /// [`Error::Threads`] when the system refuses the threads.
    pub fn on_model(model: impl Into<Arc<Model>>, settings: Settings) -> Result<Self, Error> {
        Self::new(Ground::Cad(model.into()), settings)
    }

    fn new(ground: Ground, settings: Settings) -> Result<Self, Error> {
        let cores = || std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let pool = Pool::new(if settings.threads == 0 { cores() } else { settings.threads })?;
        pool.prepare(settings.options.plan.backend)?;
        Ok(Self { ground, settings, pool })
    }

    /// The settings; all but the threads may be changed between calls.
    pub fn settings(&mut self) -> &mut Settings {
        &mut self.settings
    }

    /// The model, if there is one by now.
    pub fn model(&self) -> Option<&Model> {
        self.ground.model()
    }

    /// Measures a mesh that came out of this adapter, in its metric and on the model.
    ///
    /// # Errors
    /// [`Error::Place`], [`Error::Length`] or [`Error::OutOfRange`] when its place is not on the model as it is now.
    pub fn report(&self, adapted: &AdaptedMesh) -> Result<Report, Error> {
        let model = self.model().ok_or_else(|| Error::place("no mesh came before it".into()))?;
        view::fits("metrics", adapted.metric.len(), adapted.mesh.vertices.len())?;
        let team = Team::new(&self.pool, self.settings.options.plan);
        place::check(team, &adapted.place, &adapted.mesh, model)?;
        Ok(Report::of(team, adapted, model))
    }

    /// Adapts a mesh to a metric at its vertices, a tensor each, in 1/length²: [`Sym3`], its terms 11 12 22 13 23 33, or nalgebra's
    /// `Matrix3<f64>`. Triangles that are missing on the boundary or between regions are added. Where the mesh hangs together in edges or
    /// vertices alone it is taken apart: each side gets vertices of its own.
    ///
    /// # Errors
    /// [`Error`], by what is wrong with the input. The adapter can be used again.
    pub fn adapt<M: Copy + Into<Sym3>>(&mut self, view: &MeshView<'_>, metric: &[M]) -> Result<AdaptedMesh, Error> {
        self.adapt_observed(view, metric, &adapt::Silent)
    }

    /// As [`Adapter::adapt`], with an observer that is told what happens and may stop it: the mesh then is valid, but not done.
    ///
    /// # Errors
    /// As there.
    pub fn adapt_observed<M: Copy + Into<Sym3>>(
        &mut self,
        view: &MeshView<'_>,
        metric: &[M],
        observer: &dyn Observer,
    ) -> Result<AdaptedMesh, Error> {
        let Self { ground, settings, pool } = self;
        let team = Team::new(pool, settings.options.plan);
        let mut logs = source::logs(team, view, metric)?;
        let mut mesh = view.mesh()?;
        if mesh.tets.is_empty() {
            return Err(Error::Mesh(adapt::Error::Empty));
        }
        let faces = MatchedFaces::of(team, &mesh.tets.nodes);
        let added = complete_matched(team, &mut mesh, &faces);
        let copies = split_nonmanifold(team, &mut mesh, &faces).map_err(adapt::Error::from)?;
        copy_values(&mut logs, &copies);
        let mesh = Arc::new(mesh);
        let place = match view.place {
            Some(_) if added > 0 => return Err(Error::place(format!("{added} triangles of the boundary are missing"))),
            Some(_) if !copies.is_empty() => {
                return Err(Error::place(format!(
                    "the mesh hangs together in edges or vertices alone, as in vertex {}",
                    copies[0]
                )));
            }
            Some(place) => {
                let model = ground.model().ok_or_else(|| Error::place("no mesh came before it".into()))?;
                place::check(team, place, &mesh, model)?;
                place.clone()
            }
            None => placed(team, ground, &mesh, settings)?,
        };
        let model = ground.model().ok_or_else(|| Error::place("no mesh came before it".into()))?;
        let (source, limited) = source::of(team, (&mesh, faces), (&place, model), logs, settings)?;
        let adapted = adapt::adapt(&mesh, &place, model, &source, &settings.options, pool, observer)?;
        let Source::Background(background) = &source else { unreachable!("made above") };
        Ok(output::AdaptedMesh::of(team, adapted, model, (background, limited), copies))
    }
}

/// Puts a mesh on its model; without a CAD model its surface becomes the model.
fn placed(team: Team<'_>, ground: &mut Ground, mesh: &TetMesh, settings: &Settings) -> Result<Classification, Error> {
    match ground {
        Ground::Cad(model) => {
            let options = classify::Options { tolerance: settings.tolerance, ..classify::Options::default() };
            let place = classify::classify(team, mesh, model, &options).map_err(crate::geometry::Error::from)?.0;
            // A CAD model, which alone is shared, has none to adopt.
            if let Some(model) = Arc::get_mut(model) {
                model.adopt_references(mesh, &place);
            }
            Ok(place)
        }
        Ground::Surface(kept) => {
            let (model, place) = Discrete::new(team, mesh, &settings.surface)?;
            *kept = Some(Box::new(Model::Discrete(model)));
            Ok(place)
        }
    }
}
