//! Shape queries on a discrete geometry.
use super::Discrete;
use crate::geometry::{CurveFrame, Evaluate, Geometry, OnCurve, OnSurface, SurfaceFrame, Topology};
use crate::mesh::vector::Vec3;

/// Evaluator of [`Discrete`]. It holds no cache.
pub struct DiscreteEvaluator<'a>(&'a Discrete);

impl Geometry for Discrete {
    type Evaluator<'a> = DiscreteEvaluator<'a>;

    fn topology(&self) -> &Topology {
        &self.topology
    }

    fn evaluator(&self) -> DiscreteEvaluator<'_> {
        DiscreteEvaluator(self)
    }

    fn is_plane(&self, face: u32) -> bool {
        self.patches[face as usize].is_plane()
    }
}

impl Evaluate for DiscreteEvaluator<'_> {
    fn edge_frame(&mut self, edge: u32, t: f64) -> CurveFrame {
        self.0.curves[edge as usize].frame(t)
    }

    fn face_frame(&mut self, face: u32, uv: [f64; 2]) -> SurfaceFrame {
        self.0.patches[face as usize].frame(uv)
    }

    fn face_normal(&mut self, face: u32, uv: [f64; 2]) -> Vec3 {
        self.0.patches[face as usize].normal(uv)
    }

    fn edge_on_face(&mut self, edge: u32, t: f64, face: u32) -> Option<[f64; 2]> {
        let (segment, s) = self.0.curves[edge as usize].locate(t);
        let beside = self.0.beside[edge as usize][segment].iter().find(|beside| beside.face == face)?;
        Some(
            self.0.patches[face as usize]
                .parameters_on_side(beside.side as usize, if beside.along { s } else { 1.0 - s }),
        )
    }

    fn closest_on_edge(&mut self, edge: u32, point: Vec3, guess: Option<f64>) -> OnCurve {
        self.0.curves[edge as usize].closest(point, guess)
    }

    fn edge_box(&self, edge: u32) -> Option<[Vec3; 2]> {
        Some(self.0.curves[edge as usize].bounds())
    }

    fn closest_on_face(&mut self, face: u32, point: Vec3, guess: Option<[f64; 2]>) -> OnSurface {
        self.0.patches[face as usize].closest(point, guess)
    }

    fn closest_on_surface(&mut self, face: u32, point: Vec3, guess: [f64; 2]) -> OnSurface {
        self.0.patches[face as usize].closest_untrimmed(point, guess)
    }
}
