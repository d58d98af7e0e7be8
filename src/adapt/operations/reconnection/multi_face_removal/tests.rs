//! Two pyramids on the same polygon, cut into triangles: all of its triangles lie between the two tips.
use super::super::ring::Ring;
use super::*;
use crate::adapt::core::access::{Exclusive, Speculative};
use crate::adapt::core::check::check;
use crate::adapt::core::context::Context;
use crate::adapt::core::fill::{self, Filled};
use crate::adapt::core::ids::{EDGE, FACE};
use crate::adapt::core::worker::State;
use crate::geometry::discrete::DEFAULT_RIDGE_ANGLE;
use crate::geometry::{Discrete, Model};
use crate::mesh::samples::with_boundary;
use crate::mesh::vector::{Vec3, add, norm};
use crate::metric::{Background, Source, Sym3};
use crate::tasks::Team;
use proptest::prelude::*;

/// A polygon about the axis: angle in degrees and radius of each corner, in the order of the angles.
type Polygon = [(f64, f64)];

/// Carries out a test on the two pyramids over the polygon, which is cut into these triangles, with tips at these heights on the axis.
fn on_pyramids<T>(
    polygon: &Polygon,
    cut: &[[u32; 3]],
    [up, down]: [f64; 2],
    test: impl FnOnce(&Context, &mut Worker<'_, '_, Exclusive>, [VertexId; 2]) -> T,
) -> T {
    let corner =
        |&(angle, radius): &(f64, f64)| [radius * angle.to_radians().cos(), radius * angle.to_radians().sin(), 0.0];
    let mut vertices: Vec<Vec3> = polygon.iter().map(corner).collect();
    let tip = vertices.len() as u32;
    vertices.extend([[0.0, 0.0, up], [0.0, 0.0, -down]]);
    let tets = cut.iter().flat_map(|&[x, y, z]| [[x, y, z, tip], [x, z, y, tip + 1]]).collect();
    let mesh = with_boundary(vertices, tets);
    let (model, place) =
        Discrete::from_mesh(Team::alone(), &mesh, DEFAULT_RIDGE_ANGLE).expect("the pyramids have a surface");
    let logs = vec![Sym3::ZERO; mesh.vertices.len()];
    let background = Background::new(mesh.vertices.clone(), mesh.tets.nodes.clone(), logs);
    let (source, model) = (Source::Background(background), Model::Discrete(model));
    let Filled { store, ids, .. } = fill::fill(Team::alone(), &mesh, &place, &source).expect("the pyramids are a mesh");
    let context = Context::new(store, &source, &model);
    check(&context).unwrap();
    let mut state = State::new(&context);
    let mut worker = Worker::new(&context, &mut state, Exclusive);
    test(&context, &mut worker, [0, 1].map(|k| ids[tip as usize + k]))
}

/// Σ (1/Q − 1).
fn cost(context: &Context) -> f64 {
    let store = &context.store;
    store.live_tets().map(|t| -mean_ratio_score(store.quality(t))).sum()
}

/// Mean-ratio cost of a tetrahedron, infinite when it is not positive.
fn cost_of(worker: &Worker<'_, '_, Exclusive>, tet: [VertexId; 4]) -> f64 {
    -mean_ratio_score(worker.shape(tet))
}

/// The faces between the tips, with their tetrahedra.
fn faces_between(
    worker: &Worker<'_, '_, Exclusive>,
    [upper, _]: [VertexId; 2],
) -> Vec<([VertexId; 3], [TetId; 2], usize)> {
    let store = worker.store;
    let at = |t: TetId| {
        let v = store.vertices(t);
        let i = v.iter().position(|&x| x == upper)?;
        store.neighbour(t, i).is_some().then(|| (FACE[i].map(|k| v[k]), [t, store.neighbour(t, i)], i))
    };
    store.live_tets().filter_map(at).collect()
}

/// Whether a flip gains somewhere: it is carried out then.
fn flip_any(worker: &mut Worker<'_, '_, Exclusive>, ends: [VertexId; 2]) -> bool {
    let mut ring = Ring::default();
    let tets: Vec<TetId> = worker.store.live_tets().collect();
    let faces = faces_between(worker, ends);
    tets.into_iter().any(|t| {
        let v = worker.store.vertices(t);
        EDGE.iter().any(|&[i, j]| worker.remove_edge(&mut ring, [v[i], v[j]], t, Criterion::MeanRatio).is_ok())
    }) || faces.into_iter().any(|(face, tets, _)| worker.flip_face(tets, face, ends, Criterion::MeanRatio).is_ok())
}

/// All tetrahedra have both tips.
fn all_about_the_axis(worker: &Worker<'_, '_, Exclusive>, ends: [VertexId; 2]) -> bool {
    worker.store.live_tets().all(|t| ends.iter().all(|end| worker.store.vertices(t).contains(end)))
}

#[test]
fn three_faces_go_where_no_flip_gains() {
    let polygon = [(0.0, 1.3), (90.0, 1.0), (165.0, 1.0), (195.0, 1.0), (270.0, 1.0)];
    let cut = [[0, 1, 2], [0, 2, 3], [0, 3, 4]];
    for start in 0..3 {
        on_pyramids(&polygon, &cut, [1.1, 1.3], |context, worker, ends| {
            assert!(!flip_any(worker, ends));
            let before = cost(context);
            let (_, [t, _], i) = faces_between(worker, ends)[start];
            assert_eq!(worker.remove_face(t, i, Criterion::MeanRatio), Ok(()));
            check(context).unwrap();
            assert_eq!(worker.store.live_tets().count(), 5);
            assert!(all_about_the_axis(worker, ends));
            assert!(cost(context) < before - 1.0);
        });
    }
}

#[test]
fn four_faces_go_together() {
    let polygon = [(0.0, 1.0), (60.0, 1.0), (120.0, 1.0), (180.0, 1.0), (240.0, 1.0), (300.0, 1.0)];
    let cut = [[0, 2, 4], [0, 1, 2], [2, 3, 4], [4, 5, 0]];
    on_pyramids(&polygon, &cut, [0.5, 0.5], |context, worker, ends| {
        let before = cost(context);
        // The segment between the tips misses all faces but the one in the middle.
        let at_the_side = |(face, ..): &([VertexId; 3], [TetId; 2], usize)| {
            norm(face.iter().fold([0.0; 3], |sum, &v| add(sum, worker.store.position(v)))) > 0.1
        };
        let faces = faces_between(worker, ends);
        let (face, tets, _) = faces.into_iter().find(at_the_side).expect("there are four faces");
        assert_eq!(worker.flip_face(tets, face, ends, Criterion::MeanRatio), Err(Refusal::Shape));
        assert_eq!(worker.remove_faces(face, tets, ends, Criterion::MeanRatio), Ok(()));
        check(context).unwrap();
        assert!(all_about_the_axis(worker, ends) && worker.store.live_tets().count() == 6);
        assert!(cost(context) < before);
    });
}

#[test]
fn two_faces_are_left_to_the_flip_of_their_edge() {
    let polygon = [(0.0, 1.0), (90.0, 1.0), (180.0, 1.0), (270.0, 1.0)];
    on_pyramids(&polygon, &[[0, 1, 2], [0, 2, 3]], [0.4, 0.4], |context, worker, ends| {
        for (face, tets, _) in faces_between(worker, ends) {
            assert_eq!(worker.remove_faces(face, tets, ends, Criterion::MeanRatio), Err(Refusal::Shape));
        }
        assert!(flip_any(worker, ends));
        check(context).unwrap();
        assert!(all_about_the_axis(worker, ends));
    });
}

#[test]
fn a_tagged_face_stays() {
    // Between two of the faces a surface rises: beyond it no face goes, and two are left at most.
    let polygon = [(0.0, 1.3), (90.0, 1.0), (165.0, 1.0), (195.0, 1.0), (270.0, 1.0)];
    let cut = [[0, 1, 2], [0, 2, 3], [0, 3, 4]];
    on_pyramids(&polygon, &cut, [1.1, 1.3], |_, worker, ends| {
        let store = worker.store;
        let upper: Vec<TetId> = faces_between(worker, ends).iter().map(|(_, tets, _)| tets[0]).collect();
        let place = |&t: &TetId| store.neighbours(t).iter().position(|n| upper.contains(n)).map(|i| (t, i));
        let (t, i) = upper.iter().find_map(place).expect("the faces lie side by side");
        let n = store.neighbour(t, i);
        let back = store.neighbours(n).iter().position(|&x| x == t).expect("neighbours know each other");
        store.tag_face(t, i, 1);
        store.tag_face(n, back, 1);
        for (face, tets, _) in faces_between(worker, ends) {
            assert_eq!(worker.remove_faces(face, tets, ends, Criterion::MeanRatio), Err(Refusal::Shape));
        }
    });
}

/// The least cost of all ways to remove some of the faces, the first with them: what is tried one by one.
fn best_by_trial(
    worker: &Worker<'_, '_, Exclusive>,
    faces: &[([VertexId; 3], [TetId; 2], usize)],
    [upper, lower]: [VertexId; 2],
) -> f64 {
    let gain = |set: usize| {
        let taken = || (0..faces.len()).filter(move |k| set >> k & 1 == 1).map(|k| faces[k]);
        let edges = || taken().flat_map(|([x, y, z], ..)| [[x, y], [y, z], [z, x]]);
        let old: f64 = taken().flat_map(|(_, tets, _)| tets).map(|t| -mean_ratio_score(worker.store.quality(t))).sum();
        let outer = edges().filter(|&[x, y]| !edges().any(|edge| edge == [y, x]));
        old - outer.map(|[x, y]| cost_of(worker, [x, y, lower, upper])).sum::<f64>()
    };
    (0..1 << faces.len()).filter(|set| set & 1 == 1).map(gain).fold(f64::NEG_INFINITY, f64::max)
}

/// Removes as a thread beside others does: what is touched without its lock is found.
fn under_locks(
    worker: &mut Worker<'_, '_, Exclusive>,
    face: [VertexId; 3],
    tets: [TetId; 2],
    ends: [VertexId; 2],
    criterion: Criterion,
) -> Result<(), Refusal> {
    let mut locked = Worker::new(worker.context, worker.state, Speculative::new(0));
    for t in tets {
        locked.claim_current_tet(t)?;
    }
    let result = locked.remove_faces(face, tets, ends, criterion);
    locked.access.release(locked.store);
    result
}

const PENTAGON: [[u32; 3]; 3] = [[0, 1, 2], [0, 2, 3], [0, 3, 4]];
const FAN: [[u32; 3]; 4] = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]];
const STAR: [[u32; 3]; 4] = [[0, 2, 4], [0, 1, 2], [2, 3, 4], [4, 5, 0]];

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn the_best_part_of_the_faces_goes_or_none(
        shift in proptest::collection::vec((-20.0..20.0, 0.6..1.4), 6),
        cut in 0..3usize,
        heights in [0.2..1.5, 0.2..1.5],
        root in 0..3usize,
        criterion in prop_oneof![Just(Criterion::MeanRatio), Just(Criterion::Delaunay), Just(Criterion::EdgeWeight)],
    ) {
        let cut = [&PENTAGON[..], &FAN, &STAR][cut];
        let corners = cut.len() + 2;
        let place = |(k, &(turn, radius)): (usize, &(f64, f64))| (k as f64 * 360.0 / corners as f64 + turn, radius);
        let polygon: Vec<(f64, f64)> = shift[..corners].iter().enumerate().map(place).collect();
        let points = |&k: &u32| {
            let (angle, radius) = polygon[k as usize];
            [radius * angle.to_radians().cos(), radius * angle.to_radians().sin(), 0.0]
        };
        let turns = |face: &[u32; 3]| {
            let [a, b, c] = [0, 1, 2].map(|k| points(&face[k]));
            volume6(a, b, c, [0.0, 0.0, 1.0]) > 0.05
        };
        prop_assume!(cut.iter().all(turns));
        on_pyramids(&polygon, cut, heights, |context, worker, ends| {
            let mut faces = faces_between(worker, ends);
            faces.swap(0, root);
            let (before, best) = (cost(context), best_by_trial(worker, &faces, ends));
            let (face, tets, _) = faces[0];
            let result = under_locks(worker, face, tets, ends, criterion);
            check(context).unwrap();
            let gain = before - cost(context);
            match (result, criterion) {
                (Ok(()), Criterion::MeanRatio) => prop_assert!((gain - best).abs() < 1e-4 * before, "{gain} {best}"),
                (Ok(()), _) => {}
                (Err(refusal), _) => {
                    prop_assert_eq!(refusal, Refusal::Shape);
                    prop_assert_eq!(gain, 0.0);
                    if criterion == Criterion::MeanRatio {
                        prop_assert!(best < 2e-3 * before.max(1.0), "{}", best);
                    }
                }
            }
            Ok(())
        })?;
    }
}
