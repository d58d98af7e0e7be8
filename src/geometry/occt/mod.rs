//! The OpenCASCADE backend.
use super::{CurveFrame, Error, Evaluate, Geometry, OnCurve, OnSurface, SurfaceFrame, Topology};
use crate::mesh::vector::Vec3;

/// A B-rep model read by OpenCASCADE.
pub struct OcctModel {
    topology: Topology,
}

/// Evaluator of one thread: its own adaptors.
pub struct OcctEvaluator<'a>(&'a OcctModel);

impl OcctModel {
    /// Reads a model file.
    pub fn read(path: &std::path::Path) -> Result<Self, Error> {
        Err(Error::Model { path: path.into(), message: "not there yet".into() })
    }
}

impl Geometry for OcctModel {
    type Evaluator<'a> = OcctEvaluator<'a>;

    fn topology(&self) -> &Topology {
        &self.topology
    }

    fn evaluator(&self) -> OcctEvaluator<'_> {
        OcctEvaluator(self)
    }
}

impl Evaluate for OcctEvaluator<'_> {
    fn edge_frame(&mut self, _edge: u32, _t: f64) -> CurveFrame {
        let _ = self.0;
        unimplemented!()
    }
    fn face_frame(&mut self, _face: u32, _uv: [f64; 2]) -> SurfaceFrame {
        unimplemented!()
    }
    fn face_normal(&mut self, _face: u32, _uv: [f64; 2]) -> Vec3 {
        unimplemented!()
    }
    fn edge_on_face(&mut self, _edge: u32, _t: f64, _face: u32) -> Option<[f64; 2]> {
        unimplemented!()
    }
    fn closest_on_edge(&mut self, _edge: u32, _point: Vec3, _guess: Option<f64>) -> OnCurve {
        unimplemented!()
    }
    fn closest_on_face(&mut self, _face: u32, _point: Vec3, _guess: Option<[f64; 2]>) -> OnSurface {
        unimplemented!()
    }
    fn closest_on_surface(&mut self, _face: u32, _point: Vec3, _guess: [f64; 2]) -> OnSurface {
        unimplemented!()
    }
}
