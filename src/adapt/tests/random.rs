//! Random operations one by one: what is done leaves a valid mesh, what is refused leaves the mesh as it was.
use super::bench::{Bench, Shape, sample};
use crate::adapt::core::access::{Access, Speculative};
use crate::adapt::core::ids::{TetId, VertexId};
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::store::Store;
use crate::adapt::core::worker::Worker;
use crate::adapt::operations::collapse::onto_end::Collapse;
use crate::adapt::operations::collapse::thinning::Thin;
use crate::adapt::operations::insertion::edge_split::Split;
use crate::adapt::operations::projection::RemoveUnprojected;
use crate::adapt::operations::reconnection::criteria::Criterion;
use crate::adapt::operations::reconnection::sweep::Reconnect;
use crate::adapt::operations::repair::Repair;
use crate::adapt::operations::smoothing::patch::SmoothingPatch;
use crate::adapt::operations::smoothing::vertex::Smooth;
use crate::adapt::schedule::Operation;
use crate::geometry::Entity;
use crate::mesh::vector::Vec3;
use proptest::prelude::*;

pub type Tet = (TetId, [VertexId; 4], [TetId; 4], [u32; 4]);
pub type Vertex = (VertexId, Vec3, Entity, [f64; 2], [f64; 6]);

/// All that an operation may change.
pub fn picture(store: &Store) -> (Vec<Tet>, Vec<Vertex>) {
    let tet = |t| (t, store.vertices(t), store.neighbours(t), store.tags(t));
    let vertex = |v| (v, store.position(v), store.entity(v), store.parameters(v), store.metric(v).0);
    (store.live_tets().map(tet).collect(), store.live_vertices().map(vertex).collect())
}

fn attempt_once<O: Operation>(
    operation: &O,
    worker: &mut Worker<'_, '_, Speculative>,
    item: O::Item,
) -> Result<(), Refusal> {
    operation.attempt(worker, &mut O::Scratch::default(), item)
}

/// Does the operation that the number names to the item that it names.
fn attempt(bench: &mut Bench<'_>, kind: u8, pick: usize) -> Result<(), Refusal> {
    let edges = bench.edges();
    let edge = edges[pick % edges.len()];
    let vertices: Vec<VertexId> = bench.context.store.live_vertices().collect();
    let vertex = vertices[pick % vertices.len()];
    let mut worker = Worker::new(&bench.context, &mut bench.states[0], Speculative::new(0));
    let result = match kind {
        0 => attempt_once(&Split, &mut worker, edge),
        1 => attempt_once(&Collapse, &mut worker, edge),
        2 => attempt_once(&Reconnect(Criterion::Delaunay), &mut worker, edge.tet),
        3 => attempt_once(&Reconnect(Criterion::EdgeWeight), &mut worker, edge.tet),
        4 => attempt_once(&Reconnect(Criterion::MeanRatio), &mut worker, edge.tet),
        5 => attempt_once(&Smooth, &mut worker, vertex),
        6 => attempt_once(&Repair, &mut worker, edge.tet),
        7 => {
            // What was done before counts as another sweep.
            worker.store.tick();
            attempt_once(&Thin, &mut worker, vertex)
        }
        8 => worker
            .claim_current_tet(edge.tet)
            .and_then(|_| worker.move_for_worst(&mut SmoothingPatch::default(), edge.tet)),
        _ => attempt_once(&RemoveUnprojected { or_neighbour: false }, &mut worker, vertex),
    };
    worker.access.release(worker.store);
    result
}

fn run(shape: Shape, long: f64, operations: Vec<(u8, usize)>) {
    let sample = sample(shape, 2, 0.6);
    let mut bench = Bench::new(&sample, 1, 1);
    bench.context.limits.long = long;
    bench.context.limits.short = 3.0 * long;
    for (kind, pick) in operations {
        let before = picture(&bench.context.store);
        match attempt(&mut bench, kind, pick) {
            Ok(()) => bench.check(&format!("operation {kind} at {pick}")),
            Err(refusal) => {
                assert_ne!(refusal, Refusal::Conflict, "there is one thread");
                assert!(before == picture(&bench.context.store), "operation {kind} at {pick}: {refusal:?}, and yet");
            }
        }
    }
}

fn operations() -> impl Strategy<Value = Vec<(u8, usize)>> {
    proptest::collection::vec((0..10u8, any::<usize>()), 1..60)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn a_cube_stays_valid(operations in operations(), long in 0.3..2.0) {
        run(Shape::Cube, long, operations);
    }

    #[test]
    fn two_regions_stay_valid(operations in operations(), long in 0.3..2.0) {
        run(Shape::TwoRegions, long, operations);
    }

    #[test]
    fn a_round_body_stays_valid(operations in operations(), long in 0.3..2.0) {
        run(Shape::Round, long, operations);
    }
}
