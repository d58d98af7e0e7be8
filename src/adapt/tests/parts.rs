//! Parts of a larger mesh: what they share with other parts stays to the bit, whatever is done beside it.
use super::bench::{Bench, Sample, Shape, Task, sample};
use crate::adapt::core::access::{Access, Exclusive};
use crate::adapt::core::check::{check, check_part, open_faces};
use crate::adapt::core::fill::{self, Known};
use crate::adapt::core::ids::{EDGE, FACE, VertexId};
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::required::{Freeze, held_vertices};
use crate::adapt::core::worker::Worker;
use crate::adapt::operations::insertion::edge_split::Split;
use crate::adapt::operations::reconnection::criteria::Criterion;
use crate::adapt::operations::reconnection::ring::Ring;
use crate::adapt::schedule::{Operation, Scheduler};
use crate::tasks::Team;
use std::collections::BTreeSet;

/// Which of the cells along each axis, by their number along a side, a part has; by planes of the mesh, so that it hangs together by faces.
type Wanted = fn(u32, [u32; 3]) -> bool;

/// Stairs across the cube.
fn is_below(n: u32, [i, j, _]: [u32; 3]) -> bool {
    i + j < n
}

/// Between two planes; the interface of two regions is cut.
fn is_between(n: u32, [_, _, k]: [u32; 3]) -> bool {
    k > 0 && k + 1 < n
}

/// On one side of the interface: all of its triangles are another part's too.
fn is_left(n: u32, [i, ..]: [u32; 3]) -> bool {
    2 * i < n
}

fn part(shape: Shape, n: u32, size: f64, is_wanted: Wanted) -> Sample {
    sample(shape, n, size).part(|nodes| {
        // The vertices of the round body are those of the cube in the same order.
        let cell = [(n + 1) * (n + 1), n + 1, 1].map(|step| {
            let least = nodes.iter().map(|&v| v / step % (n + 1)).min();
            least.unwrap_or_default()
        });
        // The body of samples counts its first axis fastest.
        is_wanted(n, [cell[2], cell[1], cell[0]])
    })
}

/// The faces of which no vertex may move, by the coordinates of their vertices.
fn held_faces(bench: &Bench) -> BTreeSet<[[u64; 3]; 3]> {
    let (store, context) = (&bench.context.store, &bench.context);
    let faces = store.live_tets().flat_map(|t| FACE.map(|face| face.map(|k| store.vertices(t)[k])));
    let held = faces.filter(|face| face.iter().all(|&v| context.is_frozen(v)));
    let by_coordinates = |face: [VertexId; 3]| {
        let mut corners = face.map(|v| store.position(v).map(f64::to_bits));
        corners.sort_unstable();
        corners
    };
    held.map(by_coordinates).collect()
}

/// Rounds of all kinds of sweeps; each checks what is held. No face comes of which another part may have all vertices. Returns how often each
/// was carried out.
fn rounds(sample: &Sample, threads: usize, scheduler: Scheduler) -> [u64; 10] {
    let mut bench = Bench::new(sample, threads, 7);
    bench.scheduler = scheduler;
    let faces = held_faces(&bench);
    let mut done = [0; 10];
    for round in 0..4 {
        if round > 1 {
            bench.vary_sizes();
        }
        for (task, done) in Task::ALL.into_iter().zip(&mut done) {
            *done += bench.sweep(task).done;
        }
        let new = held_faces(&bench).difference(&faces).count();
        assert!(faces.len() > 4 && new == 0, "{new} new faces of vertices that are held");
    }
    done
}

#[test]
fn parts_stay_valid_and_keep_what_they_share() {
    let parts: [(Shape, Wanted); 6] = [
        (Shape::Cube, is_below),
        (Shape::Cube, is_between),
        (Shape::TwoRegions, is_between),
        (Shape::TwoRegions, is_below),
        (Shape::TwoRegions, is_left),
        (Shape::Round, is_below),
    ];
    for (shape, is_wanted) in parts {
        for (n, size) in [(4, 0.4), (6, 0.8)] {
            let part = part(shape, n, size, is_wanted);
            let [held, _] = part.held.as_ref().unwrap();
            assert!(held.len() > 8);
            let done = rounds(&part, 1, Scheduler::Sequential);
            // Of all but the removal of unprojected vertices there is something to do.
            let few = done.iter().filter(|done| **done < 3).count();
            assert!(few <= 1, "{shape:?}: {done:?}");
        }
    }
}

#[test]
fn threads_keep_what_parts_share() {
    for (shape, is_wanted) in [(Shape::Cube, is_below as Wanted), (Shape::TwoRegions, is_between)] {
        let part = part(shape, 4, 0.5, is_wanted);
        rounds(&part, 4, Scheduler::Speculative);
        rounds(&part, 4, Scheduler::Deterministic);
    }
}

#[test]
fn open_faces_are_faults_of_a_whole_mesh_alone() {
    let part = part(Shape::Cube, 3, 0.5, is_below);
    let Sample { mesh, place, source, .. } = &part;
    assert!(matches!(fill::fill(Team::alone(), mesh, place, source), Err(fill::Error::Open { .. })));
    let known = Known { is_part: true, ..Known::default() };
    assert!(fill::fill_known(Team::alone(), mesh, place, source, known).is_ok());
    let bench = Bench::new(&part, 1, 1);
    assert!(check_part(&bench.context).is_ok() && check(&bench.context).is_err());
}

#[test]
fn a_vertex_on_a_model_edge_may_have_its_ridges_elsewhere() {
    // One tetrahedron that has a single vertex on an edge of the cube, and none on a corner.
    let whole = sample(Shape::Cube, 4, 0.5);
    let on = |nodes: &[u32; 4], dimension: u32| {
        nodes.iter().filter(|v| whole.place.entities[**v as usize].dimension() == dimension).count()
    };
    let alone = whole.mesh.tets.nodes.iter().copied().find(|nodes| on(nodes, 1) == 1 && on(nodes, 0) == 0).unwrap();
    let part = whole.part(|nodes| *nodes == alone);
    assert!(part.mesh.tets.len() == 1 && part.place.ridges.is_empty());
    let bench = Bench::new(&part, 1, 1);
    let store = &bench.context.store;
    let v = store.live_vertices().find(|&v| store.dimension(v) == 1).unwrap();
    assert_eq!(store.ridge(v), [VertexId::NONE; 2]);
}

/// Whether an edge of the store is one of an open face.
fn open_edges(bench: &Bench) -> Vec<[VertexId; 2]> {
    let store = &bench.context.store;
    let mut edges: Vec<[VertexId; 2]> = Vec::new();
    for (t, i) in open_faces(store) {
        let v = store.vertices(t);
        let at = |[j, k]: [usize; 2]| (j != i && k != i).then(|| [v[j].min(v[k]), v[j].max(v[k])]);
        edges.extend(EDGE.into_iter().filter_map(at));
    }
    edges.sort_unstable();
    edges.dedup();
    edges
}

#[test]
fn edges_of_open_faces_are_shared_and_neither_split_nor_removed() {
    let part = part(Shape::TwoRegions, 4, 0.2, is_between);
    let mut bench = Bench::new(&part, 1, 1);
    let (edges, open) = (bench.edges(), open_edges(&bench));
    let mut shared = 0;
    for edge in edges {
        let mut worker = Worker::new(&bench.context, &mut bench.states[0], Exclusive);
        worker.gather_shell(edge.a, edge.b, edge.tet).unwrap();
        let is_shared = worker.state.shell.is_shared();
        assert_eq!(is_shared, open.contains(&[edge.a, edge.b]));
        if is_shared {
            shared += 1;
            assert_eq!(worker.split_at(edge, [0.5; 3]), Err(Refusal::Geometry));
            let removed = worker.remove_edge(&mut Ring::default(), [edge.a, edge.b], edge.tet, Criterion::MeanRatio);
            assert!(removed.is_err());
            assert!(Split.attempt(&mut worker, &mut (), edge).is_err());
        }
        worker.access.release(worker.store);
    }
    assert!(shared > 50);
    bench.check("refusals");
}

#[test]
fn a_tetrahedron_at_a_face_to_another_part_stays() {
    // Of the tetrahedra at the boundary some have two faces on it: at an edge of the cube those are ridges, at a cut one of them is open.
    let part = part(Shape::Cube, 4, 0.5, is_below);
    let mut bench = Bench::new(&part, 1, 1);
    let tets: Vec<_> = open_faces(&bench.context.store).map(|(t, _)| t).collect();
    for t in tets {
        let mut worker = Worker::new(&bench.context, &mut bench.states[0], Exclusive);
        let v = worker.store.vertices(t);
        for [i, j] in EDGE {
            assert!(worker.remove_boundary_tet(t, v[i], v[j]).is_err());
        }
        worker.access.release(worker.store);
    }
    bench.check("refusals");
}

#[test]
fn what_is_held_of_a_boundary_alone_is_held() {
    let mut mesh = sample(Shape::Cube, 2, 0.5).mesh;
    mesh.required_vertices = vec![3];
    let freeze = Freeze { surfaces: vec![mesh.triangles.refs[0]], regions: Vec::new() };
    let held = held_vertices(&mesh, &freeze);
    assert!(held.len() >= 9 && held.contains(&3) && held.is_sorted());
    mesh.tets = Default::default();
    assert_eq!(held_vertices(&mesh, &freeze), held);
}
