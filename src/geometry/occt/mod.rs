//! The OpenCASCADE backend: OCCT loads and lists (cpp/). Surfaces and curves are copied once and evaluated in Rust, where
//! projections are too; what has no copy (offset surfaces, for one) is evaluated over the bridge.
mod basis;
mod bridge;
mod chord;
mod copy;
mod curve;
mod entities;
mod evaluator;
mod hull;
mod load;
mod newton;
mod outline;
mod pieces;
mod project;
mod project_edges;
mod range;
mod side;
mod spline;
mod surface;
mod swept;
mod tree;
mod trim;

use super::{ClosedGap, DoubleWall, Error, FarField, Geometry, Healed, Names, Topology};
use bridge::ffi;
use copy::PCurve;
use curve::Curve;
pub use evaluator::OcctEvaluator;
pub use outline::{EdgeUse, Side, Use};
use std::sync::{Mutex, OnceLock};
use surface::Surface;
use tree::Tree;
use trim::Trim;

unsafe extern "C" {
    fn geo_adapt_on_memory_end(leave: extern "C" fn());
}

/// See [`super::on_memory_end`].
pub fn on_memory_end(leave: extern "C" fn()) {
    // SAFETY: cpp/memory.cpp keeps the function, which is there as long as the program, and calls it as what it is.
    unsafe { geo_adapt_on_memory_end(leave) };
}

/// A copy, and the pieces for the global search, made when first asked for.
struct Shape<T> {
    form: T,
    /// Smooth spans in u and v, as OCCT counts them.
    spans: [u32; 2],
    tree: OnceLock<Tree>,
}

impl<T> Shape<T> {
    fn new(form: T, spans: [u32; 2]) -> Self {
        Self { form, spans, tree: OnceLock::new() }
    }
}

/// A B-rep model read by OpenCASCADE. Coordinates are the numbers that the file states, whatever their unit.
pub struct OcctModel {
    topology: Topology,
    names: Names,
    occt: cxx::SharedPtr<ffi::Model>,
    surfaces: Vec<Shape<Surface>>,
    curves: Vec<Shape<Curve>>,
    /// For each edge its curves in the parameters of its faces.
    pcurves: Vec<Vec<PCurve>>,
    /// For each face, where its parameters are known to be inside it; made on first use.
    trims: Vec<OnceLock<Trim>>,
    /// Whether a face has edges whose chords may leave it.
    rounded: Vec<bool>,
    /// Evaluators that no thread uses now. They are kept since their classifiers are dear to make (40 µs a face); their answers do not depend
    /// on earlier calls.
    idle: Mutex<Vec<cxx::UniquePtr<ffi::Evaluator>>>,
    /// The greater of the box's diagonal and the largest coordinate. Rounding is measured by it.
    size: f64,
}

impl OcctModel {
    /// Reads a model file; the format follows from the extension (.step .stp .iges .igs .brep .egads).
    ///
    /// # Errors
    /// [`Error::Open`] when there is no such file; [`Error::Model`] when it is of another kind, damaged, or without faces.
    pub fn read(path: &std::path::Path) -> Result<Self, Error> {
        load::read(path)
    }

    /// The names and colours of its edges, faces and solids.
    pub fn names(&self) -> &Names {
        &self.names
    }

    /// Gives it other names.
    pub fn rename(&mut self, names: Names) {
        self.names = names;
    }

    /// The far field without this body. Faces of the body that have no name are called wall, those of the far field farfield, that in
    /// the plane of symmetry symmetry, the solid fluid.
    ///
    /// # Errors
    /// [`Error::Model`] when OpenCASCADE cannot subtract the body.
    pub fn domain(&self, far: &FarField) -> Result<Self, Error> {
        load::domain(&self.occt, &self.names, far)
    }

    /// The model without what is smaller than a length (model units): shorter edges are collapsed, narrower faces merged into their neighbours,
    /// and where there is no solid faces are sewn across gaps as wide as that. With what was done.
    ///
    /// # Errors
    /// [`Error::Model`] when OpenCASCADE makes no valid shape of it.
    pub fn healed(&self, length: f64) -> Result<(Self, Vec<Healed>), Error> {
        load::healed(&self.occt, &self.names, length)
    }

    /// The model multiplied by a factor about the origin, then moved (model units after the factor). Its entities keep their numbers and names.
    ///
    /// # Errors
    /// [`Error::Model`] when OpenCASCADE cannot transform it.
    pub fn placed(&self, factor: f64, by: [f64; 3]) -> Result<Self, Error> {
        load::placed(&self.occt, &self.names, factor, &by)
    }

    /// The solids that were divided when the file was read.
    pub fn double_walls(&self) -> Vec<DoubleWall> {
        let found = self.occt.double_walls().unwrap_or_default();
        found.into_iter().map(|wall| DoubleWall { at: wall.at, solids: wall.solids }).collect()
    }

    /// The edges that were moved onto their faces when the model's file was read.
    pub fn closed_gaps(&self) -> Vec<ClosedGap> {
        let found = self.occt.gaps_closed().unwrap_or_default();
        found.into_iter().map(|gap| ClosedGap { edge: gap.edge as u32, before: gap.before, after: gap.after }).collect()
    }

    /// Area of a face, in the square of the model's unit; none where OCCT finds none.
    pub fn face_area(&self, face: u32) -> Option<f64> {
        (face < self.topology.faces.len() as u32).then(|| self.occt.face_area(face).ok()).flatten()
    }

    /// Centre of a face's area; none where OCCT finds none.
    pub fn face_centre(&self, face: u32) -> Option<[f64; 3]> {
        let centre = (face < self.topology.faces.len() as u32).then(|| self.occt.face_centre(face).ok()).flatten();
        centre.filter(|centre| centre.iter().all(|x| x.is_finite()))
    }

    /// Whether a face has no copy, so that OCCT evaluates it point by point.
    pub fn is_on_bridge(&self, face: u32) -> bool {
        matches!(self.surfaces[face as usize].form, Surface::General)
    }

    /// Widths in u and v of the smooth span about parameters of a face, over its degree: derivatives are differences of
    /// points over them.
    #[doc(hidden)]
    pub fn face_span(&self, face: u32, uv: [f64; 2]) -> [f64; 2] {
        let (form, range) = (&self.surfaces[face as usize].form, self.topology.faces[face as usize].range);
        [0, 1].map(|k: usize| range::span_about(form.breaks(k), range[k], uv[k]) / form.degree(k) as f64)
    }

    /// The same of an edge.
    #[doc(hidden)]
    pub fn edge_span(&self, edge: u32, t: f64) -> f64 {
        let (form, range) = (&self.curves[edge as usize].form, self.topology.edges[edge as usize].range);
        range::span_about(form.breaks(), range, t) / form.degree() as f64
    }

    /// The same model with its splines and swept surfaces evaluated by OCCT. Tests compare the copies with it.
    #[doc(hidden)]
    pub fn without_copies(mut self) -> Self {
        for shape in &mut self.surfaces {
            if matches!(shape.form, Surface::Spline(_) | Surface::Swept(_)) {
                *shape = Shape::new(Surface::General, shape.spans);
            }
        }
        for shape in &mut self.curves {
            if matches!(shape.form, Curve::Spline(_) | Curve::Conic(_)) {
                *shape = Shape::new(Curve::General, shape.spans);
            }
        }
        self.pcurves.iter_mut().flatten().for_each(|pcurve| pcurve.curve = Curve::General);
        self
    }

    /// Length of an edge; none where OCCT finds none.
    pub fn edge_length(&self, edge: u32) -> Option<f64> {
        (edge < self.topology.edges.len() as u32).then(|| self.occt.edge_length(edge).ok()).flatten()
    }

    /// Writes the model in binary form with its names, for [`Self::read_saved`] in another process of this program.
    ///
    /// # Errors
    /// [`Error::Model`] when the file cannot be written.
    pub fn save(&self, path: &std::path::Path) -> Result<(), Error> {
        load::save(&self.occt, path)
    }

    /// Reads what [`Self::save`] has written: the same entities in the same order.
    ///
    /// # Errors
    /// [`Error::Model`] when the file cannot be read.
    pub fn read_saved(path: &std::path::Path) -> Result<Self, Error> {
        load::read_saved(path)
    }

    /// Prepares the trimming of all faces. OpenCASCADE crashes at that on some damaged models, so a child process does it first.
    pub fn try_trimming(&self) {
        let mut evaluator = self.evaluator();
        for (number, face) in self.topology.faces.iter().enumerate() {
            evaluator.inside_by_occt(number as u32, face.range.map(|[low, high]| 0.5 * (low + high)));
        }
    }

    /// What OpenCASCADE's own check finds wrong with faces, in words; nothing where the check itself fails.
    pub fn flaws(&self) -> Vec<(u32, String)> {
        let found = self.occt.flaws().unwrap_or_default();
        found.into_iter().map(|flaw| (flaw.face, flaw.what)).collect()
    }

    /// Writes the model as OpenCASCADE's BREP text, for another program: faces, edges and vertices in our order.
    ///
    /// # Errors
    /// [`Error::Model`] when the file cannot be written.
    pub fn write_brep(&self, path: &std::path::Path) -> Result<(), Error> {
        load::write(&self.occt, path)
    }
}

impl Geometry for OcctModel {
    type Evaluator<'a> = OcctEvaluator<'a>;

    fn topology(&self) -> &Topology {
        &self.topology
    }

    fn evaluator(&self) -> OcctEvaluator<'_> {
        OcctEvaluator::new(self)
    }
}
