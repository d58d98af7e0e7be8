//! The user's bounds of the surface in the passes, and the count of triangles that are still beyond them at the end.
use super::Pipeline;
use crate::adapt::core::access::Exclusive;
use crate::adapt::core::context::Limits;
use crate::adapt::core::ids::TetId;
use crate::adapt::core::worker::Worker;
use crate::adapt::operations::insertion::deviating::SplitDeviating;
use crate::adapt::schedule::work::Kind;

/// Most sweeps in a row that split deviating triangles; each halves edges.
const SWEEPS: usize = 4;

impl Pipeline<'_, '_> {
    /// Sets the limits of a pass, with the user's bounds of the surface where they are stricter.
    pub(super) fn limit(&mut self, limits: Limits) {
        let surface = self.surface;
        let (cos_deviation, cos_variation) =
            (surface.cosine(limits.cos_deviation), surface.cosine(limits.cos_variation));
        let bounds_angle = surface.normal_deviation.is_some();
        self.context.limits = Limits { cos_deviation, bounds_angle, cos_variation, chord: surface.chord(), ..limits };
    }

    /// Tetrahedra with a triangle on a face that is no plane, or on a curved edge.
    fn on_curved_faces(&self) -> Vec<TetId> {
        let planes = &self.context.planes;
        self.tets(|store, t| store.tags(t).iter().any(|&tag| tag != 0 && planes[tag as usize - 1].is_none()))
    }

    /// Splits surface triangles that deviate farther from the model than the user allows, whatever their lengths in the metric.
    pub(super) fn split_deviating(&mut self) {
        if !self.surface.is_some() {
            return;
        }
        let limits = self.context.limits;
        // A stage has stricter angles, which the user did not ask for.
        let Limits { cos_deviation, cos_variation, .. } = Limits::default();
        let splits_all = Limits { long: 0.0, shortest_new: 0.0, insert_floor: 0.01, ..limits };
        self.limit(Limits { cos_deviation, cos_variation, ..splits_all });
        for _ in 0..SWEEPS {
            let mut items = self.on_curved_faces();
            items.truncate(self.max_vertices.saturating_sub(self.live()));
            if !self.may_grow() || self.observer.stop() || self.sweep(Kind::Split, &SplitDeviating, &items).done == 0 {
                break;
            }
            self.project();
        }
        self.context.limits = limits;
    }

    /// How many surface triangles deviate farther from the model than the user allows.
    pub fn deviating(&mut self) -> usize {
        if !self.surface.is_some() {
            return 0;
        }
        let items = self.on_curved_faces();
        let mut worker = Worker::new(self.context, &mut self.states[0], Exclusive);
        items.into_iter().map(|t| worker.count_deviating(t)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::super::shape_limits;
    use crate::adapt::surface::bounds::SurfaceBounds;
    use crate::adapt::tests::bench::{Bench, Shape, sample};
    use crate::geometry::Entity;

    #[test]
    fn a_vertex_without_room_on_the_model_goes_whatever_the_bound_of_the_chord() {
        let sample = sample(Shape::Round, 4, 0.5);
        let mut bench = Bench::new(&sample, 1, 3);
        let store = &bench.context.store;
        let v = store.live_vertices().find(|&v| matches!(store.entity(v), Entity::Face(_))).unwrap();
        bench.with_pipeline(|pipeline| {
            pipeline.unprojected = vec![v];
            pipeline.surface = SurfaceBounds { normal_deviation: Some(10.0), hausdorff: Some(1e-9) };
            pipeline.limit(shape_limits());
            pipeline.remove_unprojected(true);
            assert!(pipeline.unprojected.is_empty() && !pipeline.context.store.is_vertex(v));
            // What is left is still held to the bounds.
            assert_eq!(pipeline.context.limits.chord, 1e-9);
            assert!(pipeline.deviating() > 0);
        });
        bench.check("the removal of a vertex");
    }
}
