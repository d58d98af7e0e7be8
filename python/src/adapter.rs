//! The adapter that Python holds: a worker thread does the work, the caller's thread looks at signals and tells the progress.
use crate::arrays::{self, Arrays, Place};
use crate::errors;
use crate::model::Model;
use geo_adapt::adapt::forecast::{Forecast, most_in_memory};
use geo_adapt::adapt::meeting::{VERTICES_PER_COMPLEXITY, meet};
use geo_adapt::api::{ChordLimit, GrowthEnd, Limited, MeshView};
use geo_adapt::geometry::on_mesh;
use geo_adapt::{
    AdaptedMesh, Counts, DiscreteOptions, Freeze, Kind, Observer, Parents, Report, Settings, SurfaceBounds,
};
use numpy::{PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, OnceLock};
use std::thread;
use std::time::Duration;

/// How long the caller's thread sleeps between two looks at signals.
const LOOK: Duration = Duration::from_millis(50);

/// An adapter with its model and its threads.
#[pyclass(frozen, module = "geo_adapt._kernel")]
pub struct Adapter(Mutex<geo_adapt::Adapter>);

/// The options of a call.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Options {
    complexity: Option<f64>,
    vertices: Option<f64>,
    max_vertices: Option<usize>,
    /// A share of √(8 h R); 0 leaves sizes along curved walls as they are.
    limit_chords: Option<f64>,
    tolerance: Option<f64>,
    normal_deviation: Option<f64>,
    hausdorff: Option<f64>,
    surfaces: Vec<i32>,
    regions: Vec<i32>,
    report: bool,
}

/// What the worker does, for the caller's thread; and what that wants.
#[derive(Default)]
struct Watch {
    stop: AtomicBool,
    pass: AtomicUsize,
    kind: AtomicUsize,
    items: AtomicUsize,
    done: AtomicUsize,
    vertices: AtomicUsize,
    /// What the first run was expected to take.
    forecast: OnceLock<Forecast>,
}

impl Observer for Watch {
    fn vertices(&self, count: usize) {
        self.vertices.store(count, Relaxed);
    }

    fn forecast(&self, forecast: &Forecast) {
        self.forecast.get_or_init(|| *forecast);
    }

    fn begin(&self, kind: Kind, pass: usize, items: usize) {
        self.kind.store(kind as usize, Relaxed);
        self.pass.store(pass, Relaxed);
        self.items.store(items, Relaxed);
        self.done.store(0, Relaxed);
    }

    fn advance(&self, items: usize) {
        self.done.fetch_add(items, Relaxed);
    }

    fn end(&self, counts: &Counts) {
        let (now, done) = (self.vertices.load(Relaxed), counts.done as usize);
        match Kind::ALL[self.kind.load(Relaxed)] {
            Kind::Split => self.vertices.store(now + done, Relaxed),
            Kind::Collapse => self.vertices.store(now.saturating_sub(done), Relaxed),
            _ => {}
        }
    }

    fn stop(&self) -> bool {
        self.stop.load(Relaxed)
    }
}

/// What is measured, and what the program's report says beside it about the mesh's growth.
#[derive(serde::Serialize)]
struct WithForecast {
    #[serde(flatten)]
    found: Report,
    chords: Option<Limited>,
    overgrown: bool,
    growth_end: Option<GrowthEnd>,
    forecast: Option<Forecast>,
}

/// What the worker hands back.
struct Done {
    adapted: AdaptedMesh,
    names: String,
    report: Option<String>,
    complexity: Option<f64>,
}

#[pymethods]
impl Adapter {
    /// On a model, on the surface of a mesh, or on that of each mesh that comes.
    #[new]
    #[pyo3(signature = (model, surface, threads, ridge_angle, smooth))]
    fn new(
        py: Python<'_>,
        model: Option<Py<Model>>,
        surface: Option<Arrays<'_>>,
        threads: usize,
        ridge_angle: Option<f64>,
        smooth: bool,
    ) -> PyResult<Self> {
        let usual = DiscreteOptions::default();
        let surface_options = DiscreteOptions { ridge_angle_deg: ridge_angle.unwrap_or(usual.ridge_angle_deg), smooth };
        let settings = Settings { threads, surface: surface_options, ..Settings::default() };
        let made = match (model, surface) {
            (Some(model), _) => geo_adapt::Adapter::on_model(model.get().0.clone(), settings),
            (None, Some(surface)) => {
                let view = surface.view()?;
                py.detach(|| geo_adapt::Adapter::on_surface(&view, settings))
            }
            (None, None) => geo_adapt::Adapter::discrete(settings),
        };
        Ok(Self(Mutex::new(made.map_err(errors::of_adapter)?)))
    }

    /// Adapts: what came of it, and the exception that stopped it, if one did. `progress` is called with pass, operation, items done, items
    /// and vertices; it returns False to stop.
    #[pyo3(signature = (mesh, metric, place, options, progress))]
    fn adapt<'py>(
        &self,
        py: Python<'py>,
        mesh: Arrays<'py>,
        metric: PyReadonlyArray2<'py, f64>,
        place: Option<Py<Place>>,
        options: Options,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<(Bound<'py, PyDict>, Option<Py<PyAny>>)> {
        let Ok(mut adapter) = self.0.try_lock() else {
            return Err(errors::input("the adapter is at work in another thread: give each thread its own"));
        };
        let view = MeshView { place: place.as_ref().map(|place| &place.get().0), ..mesh.view()? };
        let metric = arrays::rows::<_, 6>("metric", &metric)?;
        let watch = Watch::default();
        let mut stopped_by = None;
        let caller = thread::current();
        let done = thread::scope(|scope| {
            let (adapter, options, view, watch) = (&mut *adapter, &options, &view, &watch);
            let worker = thread::Builder::new().name("geo-adapt".into()).spawn_scoped(scope, move || {
                // Also after a panic.
                let _wake = Wake(caller);
                options.run(adapter, view, metric, watch)
            });
            let worker = worker.map_err(|error| errors::of_file(format!("no thread can be had: {error}")))?;
            while !worker.is_finished() {
                py.detach(|| thread::park_timeout(LOOK));
                if let Err(error) = look(py, watch, progress.as_ref()) {
                    watch.stop.store(true, Relaxed);
                    // The first is the cause.
                    stopped_by.get_or_insert(error);
                }
            }
            worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        })?;
        let given = give(py, done, watch.stop.load(Relaxed))?;
        Ok((given, stopped_by.map(|error| error.into_value(py).into_any())))
    }
}

/// Wakes the caller at the end.
struct Wake(thread::Thread);

impl Drop for Wake {
    fn drop(&mut self) {
        self.0.unpark();
    }
}

/// Looks at signals and tells the progress; an exception of either stops the work.
fn look(py: Python<'_>, watch: &Watch, progress: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
    py.check_signals()?;
    let Some(progress) = progress.filter(|_| !watch.stop.load(Relaxed)) else { return Ok(()) };
    let of = |number: &AtomicUsize| number.load(Relaxed);
    let name = Kind::ALL[of(&watch.kind)].name();
    let items = of(&watch.items);
    let told = (of(&watch.pass), name, of(&watch.done).min(items), items, of(&watch.vertices));
    if progress.call1(told)?.is(pyo3::types::PyBool::new(py, false)) {
        watch.stop.store(true, Relaxed);
    }
    Ok(())
}

impl Options {
    /// Adapts, again for a number of vertices where that is needed.
    fn run(
        &self,
        adapter: &mut geo_adapt::Adapter,
        view: &MeshView<'_>,
        metric: &[[f64; 6]],
        watch: &Watch,
    ) -> PyResult<Done> {
        let first = self.complexity.or(self.vertices.map(|vertices| vertices / VERTICES_PER_COMPLEXITY));
        let settings = adapter.settings();
        settings.complexity = first;
        settings.chords = match self.limit_chords {
            None => ChordLimit::Auto,
            Some(0.0) => ChordLimit::Off,
            Some(share) => ChordLimit::Share(share),
        };
        settings.tolerance = self.tolerance;
        settings.options.max_vertices = self.max_vertices.or_else(most_in_memory);
        settings.options.freeze = Freeze { surfaces: self.surfaces.clone(), regions: self.regions.clone() };
        settings.options.surface = SurfaceBounds { normal_deviation: self.normal_deviation, hausdorff: self.hausdorff };
        let mut adapted = adapter.adapt_observed(view, metric, watch).map_err(errors::of_adapter)?;
        let mut complexity = first;
        if let Some((wanted, at)) = self.vertices.zip(first) {
            // Cut along walls as the first.
            adapter.settings().chords =
                adapted.chords.map_or(ChordLimit::Off, |limited| ChordLimit::Share(limited.share));
            let make = |next: f64, _: usize| {
                adapter.settings().complexity = Some(next);
                adapter.adapt_observed(view, metric, watch).map(Some).map_err(errors::of_adapter)
            };
            let count = |adapted: &AdaptedMesh| adapted.mesh.vertices.len();
            let met = meet(wanted, (adapted, at), count, make, || watch.stop())?;
            (adapted, complexity) = (met.best, Some(met.complexity));
        }
        let names = adapter.model().map(|model| on_mesh(&adapted.mesh, &adapted.place, model)).unwrap_or_default();
        let names = serde_json::to_string(&names).map_err(errors::of_file)?;
        let mut report = None;
        if self.report && !watch.stop() {
            let found = adapter.report(&adapted).map_err(errors::of_adapter)?;
            let end = adapted.growth_end;
            let whole = WithForecast {
                found,
                chords: adapted.chords,
                overgrown: end.is_some(),
                growth_end: end,
                forecast: watch.forecast.get().copied(),
            };
            report = Some(serde_json::to_string(&whole).map_err(errors::of_file)?);
        }
        Ok(Done { adapted, names, report, complexity })
    }
}

/// The result with its memory, by names.
fn give(py: Python<'_>, done: Done, stopped: bool) -> PyResult<Bound<'_, PyDict>> {
    let Done { adapted, names, report, complexity } = done;
    let crossings = adapted.crossings.count;
    let AdaptedMesh { mesh, metric, parents, place, off_model, held, doubled, growth_end, deviating, chords, .. } =
        adapted;
    let Parents { tets, weights, outside, farthest } = parents;
    let all = PyDict::new(py);
    all.set_item("mesh", arrays::give_mesh(py, mesh)?)?;
    all.set_item("metric", arrays::give_rows(py, metric)?)?;
    all.set_item("parent_tets", PyArray1::from_vec(py, tets))?;
    all.set_item("parent_weights", arrays::give_rows(py, weights)?)?;
    all.set_item("outside", outside)?;
    all.set_item("farthest", farthest)?;
    all.set_item("place", Py::new(py, Place(place))?)?;
    all.set_item("off_model", PyArray1::from_vec(py, off_model))?;
    all.set_item("held", PyArray1::from_vec(py, held))?;
    all.set_item("doubled", PyArray1::from_vec(py, doubled))?;
    // By the name that it has in reports.
    let end = serde_json::to_value(growth_end).map_err(errors::of_file)?;
    all.set_item("growth_end", end.as_str())?;
    all.set_item("deviating", deviating)?;
    all.set_item("chords", chords.map(|Limited { share, cut }| (share, cut.vertices, cut.greatest)))?;
    all.set_item("crossings", crossings)?;
    all.set_item("names", names)?;
    all.set_item("report", report)?;
    all.set_item("complexity", complexity)?;
    all.set_item("stopped", stopped)?;
    Ok(all)
}
