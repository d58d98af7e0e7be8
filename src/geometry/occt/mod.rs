//! The OpenCASCADE backend: OCCT loads, lists and evaluates (cpp/); projections are here. Analytic surfaces and curves
//! are copied once and evaluated in Rust; what is left goes over the bridge.
mod bridge;
mod cells;
mod curve;
mod entities;
mod evaluator;
mod load;
mod newton;
mod project;
mod range;
mod surface;

use super::{Error, FarField, Geometry, Names, Topology};
use bridge::ffi;
use cells::Cell;
use curve::Curve;
pub use evaluator::OcctEvaluator;
use std::sync::OnceLock;
use surface::Surface;

/// A closed form, and the cells for the global search, made when first asked for.
struct Shape<T> {
    form: T,
    counts: [usize; 2],
    cells: OnceLock<Vec<Cell>>,
}

impl<T> Shape<T> {
    fn new(form: T, u: usize, v: usize) -> Self {
        Self { form, counts: [u, v], cells: OnceLock::new() }
    }
}

/// A B-rep model read by OpenCASCADE. Coordinates are the numbers that the file states, whatever their unit.
pub struct OcctModel {
    topology: Topology,
    names: Names,
    occt: cxx::SharedPtr<ffi::Model>,
    surfaces: Vec<Shape<Surface>>,
    curves: Vec<Shape<Curve>>,
    /// Whether a face has edges whose chords may leave it.
    rounded: Vec<bool>,
    /// The greater of the box's diagonal and the largest coordinate: what rounding is measured by.
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
        load::domain(&self.occt, far)
    }

    /// Area of a face, in the square of the model's unit; none where OCCT finds none.
    pub fn face_area(&self, face: u32) -> Option<f64> {
        (face < self.topology.faces.len() as u32).then(|| self.occt.face_area(face).ok()).flatten()
    }

    /// Length of an edge; none where OCCT finds none.
    pub fn edge_length(&self, edge: u32) -> Option<f64> {
        (edge < self.topology.edges.len() as u32).then(|| self.occt.edge_length(edge).ok()).flatten()
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
