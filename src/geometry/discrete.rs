//! The surface of a mesh as its own geometry.
use super::{CurveFrame, Evaluate, Geometry, OnCurve, OnSurface, SurfaceFrame, Topology};
use crate::mesh::vector::Vec3;

/// The surface of a mesh as a geometry: patches of triangles are faces, chains of ridges edges.
pub struct Discrete {
    topology: Topology,
}

/// Evaluator of [`Discrete`].
pub struct DiscreteEvaluator<'a>(&'a Discrete);

impl Geometry for Discrete {
    type Evaluator<'a> = DiscreteEvaluator<'a>;

    fn topology(&self) -> &Topology {
        &self.topology
    }

    fn evaluator(&self) -> DiscreteEvaluator<'_> {
        DiscreteEvaluator(self)
    }
}

impl Evaluate for DiscreteEvaluator<'_> {
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
