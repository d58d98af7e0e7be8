//! Stages: where a metric asks for cells many times flatter than those of the mesh, the mesh comes to it step by step.
//!
//! What that saves, and how the limits were chosen: docs/decisions/stages.md.
use super::{OUT_OF_ORDER, Pipeline, size_limits};
use crate::adapt::core::context::Limits;
use crate::adapt::core::stages::Stage;

/// Stages bring the mesh to sizes so many times those of the source, as long as they can; the passes that follow refine it alike in all
/// directions. So stages insert little in vain. A mesh whose domain is too small for that comes to the sizes themselves in stages.
pub(super) const COARSER: f64 = 3.0;

/// A stage makes cells flatter by no more than this factor.
const FACTOR: f64 = 4.0;

/// There are stages at all where the source's complexity is the first of these times that of a stage with the second as its factor.
const ENTRY: (f64, f64) = (1.1, 16.0);

/// Where sizes are to shrink by more than the factor of [`ENTRY`], there is an edge longer than this in the metric: the six edges e of a unit
/// tetrahedron have Σ (e·d)² = 2 along each unit vector d, so one of them has a part of 1/√3 along it at the least.
const LONG: f64 = ENTRY.1 * 0.57;

/// There is another stage where the source's complexity is so many times that of the stage.
const MUCH: f64 = 1.3;

/// A stage must have so many times the complexity of the one before: what is frozen stays coarse, whatever is asked.
const FINER: f64 = 1.1;

/// Most stages. More than doubles have room for: each makes cells four times flatter.
const STAGES: usize = 600;

/// Most passes in a stage.
const PASSES: usize = 3;

/// Least cosine of the normal deviation and of the normal variation in a stage, unless it is less already: 1.8°. A coarser surface would be
/// farther from the model than the layers that come later are thick, and its new vertices would find no way through them.
const COSINE: f64 = 0.9995;

/// In a stage no insertion makes an edge shorter than this.
const SHORTEST_NEW: f64 = 0.8;

/// Limits of the passes in a stage.
pub(super) fn stage_limits() -> Limits {
    Limits { shortest_new: SHORTEST_NEW, cos_deviation: COSINE, cos_variation: COSINE, ..size_limits() }
}

impl Pipeline<'_, '_> {
    /// Brings the mesh near to its metric, in stages.
    pub(super) fn come_near(&mut self) {
        // Where no edge is long there is no need for the metric that the mesh implies, which takes longer.
        if !self.context.has_edge_longer(self.team(), LONG) || self.asked_for(ENTRY, 1.0).is_none() {
            return;
        }
        self.limit(stage_limits());
        for coarser in [COARSER, 1.0] {
            self.stages_to(coarser);
        }
        self.limit(size_limits());
    }

    /// The stage to sizes `coarser` times the source's, if its metric is much coarser than that.
    fn asked_for(&self, (much, factor): (f64, f64), coarser: f64) -> Option<Stage> {
        let stage = self.context.stage(self.team(), factor, coarser);
        stage.filter(|stage| stage.wanted > much * stage.complexity)
    }

    /// Stages to sizes `coarser` times the source's, as long as each brings the mesh nearer to them.
    fn stages_to(&mut self, coarser: f64) {
        let mut before = 0.0;
        for _ in 0..STAGES {
            if self.growth_end.is_some() || self.observer.stop() {
                return;
            }
            let stage = self.asked_for((MUCH, FACTOR), coarser).filter(|stage| stage.complexity > FINER * before);
            let Some(stage) = stage else { return };
            before = stage.complexity;
            self.context.begin_stage(self.team(), stage);
            self.collapse();
            for _ in 0..PASSES {
                let is_settled = self.size_pass();
                self.smooth();
                self.pass += 1;
                self.tell_share_of_sizes();
                if is_settled || self.growth_end.is_some() || self.observer.stop() {
                    break;
                }
            }
            self.context.end_stage(self.team());
            self.keep_order(OUT_OF_ORDER);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapt::core::ids::{EDGE, VertexId};
    use crate::adapt::schedule::work::Kind;
    use crate::adapt::tests::bench::{Bench, Sample, Shape, sample};
    use crate::mesh::vector::sub;
    use crate::metric::{Background, Source, Sym3};

    /// A cube of 216 vertices, with sizes of 0.5 along a wall and from `first` to 0.5 away from it.
    fn layer(first: f64) -> Sample {
        let mut sample = sample(Shape::Cube, 5, 1.0);
        let size = |z: f64| (first + z).min(0.5);
        let log = |z: f64| Sym3::diagonal(4.0, 4.0, size(z).powi(-2)).ln();
        let logs = sample.mesh.vertices.iter().map(|p| log(p[2])).collect();
        let background = Background::new(sample.mesh.vertices.clone(), sample.mesh.tets.nodes.clone(), logs);
        sample.source = Source::Background(background);
        sample
    }

    #[test]
    fn a_stage_shrinks_sizes_by_its_factor_at_most_and_ends_with_the_metric_of_the_source() {
        let sample = layer(1e-4);
        let mut bench = Bench::new(&sample, 1, 3);
        let logs = |pipeline: &Pipeline<'_, '_>| -> Vec<Sym3> {
            let store = &pipeline.context.store;
            store.live_vertices().map(|v: VertexId| store.log(v)).collect()
        };
        bench.with_pipeline(|pipeline| {
            let source = logs(pipeline);
            let stage = pipeline.context.stage(pipeline.team(), FACTOR, 1.0).unwrap();
            assert!(stage.wanted > 4.0 * stage.complexity, "{} {}", stage.wanted, stage.complexity);
            pipeline.context.begin_stage(pipeline.team(), stage);
            // The cells have edges of 0.2 to 0.35.
            for log in logs(pipeline) {
                let [least, _, greatest] = log.exp().sizes();
                let (least, greatest) = (least.min(greatest), least.max(greatest));
                assert!(least > 0.2 / FACTOR / 2.0 && greatest < 0.51, "{least} {greatest}");
            }
            pipeline.context.end_stage(pipeline.team());
            for (before, after) in source.iter().zip(logs(pipeline)) {
                assert!(before.0.iter().zip(after.0).all(|(before, after)| (before - after).abs() < 1e-9));
            }
        });
        bench.check("a stage without passes");
    }

    #[test]
    fn long_edges_tell_whether_there_are_stages() {
        // Two metrics of much smaller cells of nearly the same shape, and three layers.
        for (sample, has_stages) in [
            (sample(Shape::Cube, 5, 0.05), false),
            (sample(Shape::Cube, 5, 0.025), false),
            (layer(2e-2), false),
            (layer(3e-3), true),
            (layer(1e-4), true),
        ] {
            let mut bench = Bench::new(&sample, 1, 3);
            bench.with_pipeline(|pipeline| {
                let is_asked = pipeline.asked_for(ENTRY, 1.0).is_some();
                assert_eq!(is_asked, has_stages);
                assert!(pipeline.context.has_edge_longer(pipeline.team(), LONG) || !is_asked);
            });
        }
        let sample = sample(Shape::Cube, 5, 0.05);
        let mut bench = Bench::new(&sample, 1, 3);
        let store = &bench.context.store;
        let lengths = store.live_tets().flat_map(|t| {
            let vertices = store.vertices(t);
            EDGE.map(|[i, j]| {
                let way = sub(store.position(vertices[j]), store.position(vertices[i]));
                [i, j].map(|k| store.metric(vertices[k]).quadratic(way)).into_iter().fold(0.0, f64::max).sqrt()
            })
        });
        let longest = lengths.fold(0.0, f64::max);
        bench.with_pipeline(|pipeline| {
            let has = |limit: f64| pipeline.context.has_edge_longer(pipeline.team(), limit);
            assert!(has(0.999 * longest) && !has(1.001 * longest));
        });
    }

    #[test]
    fn few_of_the_vertices_of_a_thin_layer_are_inserted_in_vain() {
        // The second has less than two thirds of its complexity in cells much flatter than those of the mesh.
        for (first, least) in [(1e-4, 140.0), (3e-3, 100.0)] {
            let sample = layer(first);
            let mut bench = Bench::new(&sample, 1, 3);
            bench.with_pipeline(|pipeline| {
                pipeline.run();
                let inserted = pipeline.work[Kind::Split as usize].counts.done as f64;
                let left = pipeline.live() as f64;
                assert!(left > least && inserted < 1.8 * left, "{first}: {inserted} {left}");
            });
            bench.check("a thin layer");
        }
    }
}
