//! The curvature of the model's faces in the metric.
use super::Pipeline;
use crate::adapt::core::ids::VertexId;
use crate::geometry::{Entity, Evaluate, Geometry, SurfaceFrame};
use crate::mesh::vector::dot;
use crate::metric::Sym3;

/// About so many vertices are asked at most.
const ASKED: usize = 10_000;

/// Where edges of unit length rise by more than one across the face on a greater share of the vertices, no mesh meets the metric.
const TOO_CURVED: f64 = 0.02;

/// How far the middle of an edge of unit length is from a face, in the metric (METHOD.md §7): the greatest sagitta, κ(e) |e|² / 8, of the edges e
/// along the face, times the length of its normal. Not a number where the
/// face has no directions, as at an apex.
fn rise(frame: &SurfaceFrame, metric: &Sym3) -> f64 {
    let of = |x, y| dot(x, metric.apply(y));
    let ([a, b], [k, l]) = (frame.directions, frame.curvatures);
    let (aa, ab, bb) = (of(a, a), of(a, b), of(b, b));
    // The greatest λ of det(II − λ M) = 0, of the second fundamental form and the metric along the face.
    let (square, linear, constant) = ((aa * bb - ab * ab).max(0.0), k * bb + l * aa, k * l);
    let root = (linear * linear - 4.0 * square * constant).max(0.0).sqrt();
    (linear.abs() + root) / (2.0 * square) / 8.0 * of(frame.normal, frame.normal).sqrt()
}

impl Pipeline<'_, '_> {
    /// Whether faces are too curved for the metric, so that no mesh has edges of unit length there.
    pub(super) fn is_too_curved(&self) -> bool {
        let (store, planes) = (&self.context.store, &self.context.planes);
        let curved = |v: VertexId| match store.entity(v) {
            Entity::Face(face) => planes[face as usize].is_none().then_some(face),
            _ => None,
        };
        let all = self.vertices(|_, v| curved(v).is_some());
        let asked: Vec<_> = all.iter().step_by(all.len().div_ceil(ASKED).max(1)).collect();
        let mut evaluator = self.context.model.evaluator();
        let mut is_met = |v: VertexId| {
            let frame = curved(v).map(|face| evaluator.face_frame(face, store.parameters(v)));
            frame.is_none_or(|frame| rise(&frame, &store.metric(v)) <= 1.0)
        };
        let beyond = asked.iter().filter(|&&&v| !is_met(v)).count();
        beyond as f64 > TOO_CURVED * asked.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapt::tests::bench::{Bench, Shape, sample};
    use crate::mesh::vector::unit;
    use crate::metric::{Background, Source};

    /// Whether the faces of a shape are too curved for sizes `across` its radii and 0.5 along its surface.
    fn is_too_curved(shape: Shape, across: f64) -> bool {
        let mut sample = sample(shape, 4, 1.0);
        let vertices = &sample.mesh.vertices;
        let log = |p: &[f64; 3]| {
            let radius = unit(p.map(|x| x - 0.501));
            Sym3::diagonal(4.0, 4.0, 4.0).plus(Sym3::outer(radius, across.powi(-2) - 4.0)).ln()
        };
        let logs = vertices.iter().map(log).collect();
        sample.source = Source::Background(Background::new(vertices.clone(), sample.mesh.tets.nodes.clone(), logs));
        let mut bench = Bench::new(&sample, 1, 3);
        bench.with_pipeline(|pipeline| pipeline.is_too_curved())
    }

    #[test]
    fn curved_faces_are_too_curved_for_thin_cells_as_wide_as_coarse_ones() {
        assert!(!is_too_curved(Shape::Round, 0.5));
        assert!(is_too_curved(Shape::Round, 1e-4));
        assert!(!is_too_curved(Shape::Cube, 1e-4));
    }

    #[test]
    fn the_rise_is_that_of_the_arc_over_an_edge_of_unit_length() {
        // On a cylinder of the radius 2 about z, at (2, 0, 0): an edge of 0.4 about the axis has the sagitta 0.4² / 16.
        let y = [0.0, 1.0, 0.0];
        let z = [0.0, 0.0, 1.0];
        let mut frame = SurfaceFrame {
            point: [2.0, 0.0, 0.0],
            du: y,
            dv: z,
            normal: [1.0, 0.0, 0.0],
            curvatures: [-0.5, 0.0],
            directions: [y, z],
        };
        let metric = Sym3::diagonal(1e-3_f64.powi(-2), 0.4_f64.powi(-2), 9.0_f64.powi(-2));
        assert!((rise(&frame, &metric) - 10.0).abs() < 1e-9);
        // A saddle: the greater of the two, whatever the sign.
        frame.curvatures = [0.5, -0.25];
        assert!((rise(&frame, &metric) - 81.0 / 32.0 * 1e3).abs() < 1e-6);
        // An edge between the directions is the longest.
        frame.curvatures = [0.5, 0.5];
        let along = [0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt()];
        let tilted = Sym3::diagonal(1e6, 25.0, 25.0).plus(Sym3::outer(along, 1.0 - 25.0));
        assert!((rise(&frame, &tilted) - 1e3 / 16.0).abs() < 1e-6);
        // No normal: not a number, or nothing that bends.
        frame.directions = [[0.0; 3]; 2];
        assert!(rise(&frame, &metric).is_nan());
    }
}
