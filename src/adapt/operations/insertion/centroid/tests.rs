//! Encroachment, nearness, and whole meshes refined at centroids and along eigenvectors.
use super::*;
use crate::adapt::core::access::Exclusive;
use crate::adapt::core::check::check;
use crate::adapt::core::fill::{self, Filled};
use crate::adapt::core::worker::State;
use crate::adapt::operations::insertion::centroid::InsertCentroids;
use crate::adapt::operations::insertion::metric_orthogonal::InsertMetricOrthogonal;
use crate::adapt::operations::insertion::metric_orthogonal::active_vertices;
use crate::adapt::schedule::work::{Kind, Silent};
use crate::adapt::schedule::{self, Execution, Grains, Scheduler};
use crate::adapt::{Options, adapt, extract};
use crate::geometry::classify::Classification;
use crate::geometry::discrete::DEFAULT_RIDGE_ANGLE;
use crate::geometry::{Discrete, Geometry, Model};
use crate::mesh::vector::volume6;
use crate::mesh::{TetMesh, samples, validity};
use crate::metric::{Background, Source};
use crate::tasks::{Plan, Pool, Team};

/// Image of p under x ↦ Ax, A the upper triangle of which AᵀA is [`SKEW`].
fn skewed([x, y, z]: Vec3) -> Vec3 {
    [2.0 * x + 0.5 * y - z, 3.0 * y + z, 0.25 * z]
}

const SKEW: Sym3 = Sym3([4.0, 1.0, 9.25, -2.0, 2.5, 2.0625]);

/// The cube, its surface as the model, and a constant metric of these sizes along the axes.
fn cube(n: u32, sizes: Vec3) -> (TetMesh, Classification, Model, Source) {
    let mesh = samples::cube(n);
    let (model, place) =
        Discrete::from_mesh(Team::alone(), &mesh, DEFAULT_RIDGE_ANGLE).expect("the cube has a surface");
    let [x, y, z] = sizes.map(|h| -2.0 * h.ln());
    let logs = vec![Sym3([x, 0.0, y, 0.0, 0.0, z]); mesh.vertices.len()];
    let background = Background::new(mesh.vertices.clone(), mesh.tets.nodes.clone(), logs);
    (mesh, place, Model::Discrete(model), Source::Background(background))
}

fn volume(mesh: &TetMesh) -> f64 {
    let corners = mesh.tets.nodes.iter().map(|tet| tet.map(|v| mesh.vertices[v as usize]));
    corners.map(|x| volume6(x[0], x[1], x[2], x[3]) / 6.0).sum()
}

fn assert_valid_cube(mesh: &TetMesh) {
    let found = validity::check(mesh);
    assert!(found.is_valid(), "{found:?}");
    assert!((volume(mesh) - 1.0).abs() < 1e-12);
}

#[test]
fn the_metric_of_the_tests_is_that_of_their_map() {
    let p = [0.3, -0.7, 1.1];
    assert!((SKEW.quadratic(p) - dot(skewed(p), skewed(p))).abs() < 1e-12);
}

#[test]
fn a_point_encroaches_upon_a_triangle_inside_the_sphere_about_its_circumcentre() {
    // Circumcentre (1, 1, 0), radius √2; the right angle puts it on the longest edge.
    let face = [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
    let radius = 2.0_f64.sqrt();
    for direction in [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [-0.48, 0.64, -0.6]] {
        for (part, inside) in [(0.0, true), (0.999, true), (1.001, false), (5.0, false)] {
            let p = add([1.0, 1.0, 0.0], scale(direction, part * radius));
            assert_eq!(encroaches_face(&Sym3::IDENTITY, face, p), inside, "{direction:?} {part}");
        }
    }
}

#[test]
fn encroachment_is_measured_in_the_metric() {
    let face = [[0.1, 0.2, 0.3], [1.4, -0.3, 0.2], [0.2, 1.1, -0.5]];
    let image = face.map(skewed);
    let (mut faces, mut edges, total) = (0, 0, 9 * 9 * 9);
    for k in 0..total {
        let p = [k % 9, k / 9 % 9, k / 81].map(|i| -1.0 + 0.33 * f64::from(i));
        let on_face = encroaches_face(&SKEW, face, p);
        let on_edge = encroaches_edge(&SKEW, [face[0], face[1]], p);
        assert_eq!(on_face, encroaches_face(&Sym3::IDENTITY, image, skewed(p)));
        assert_eq!(on_edge, encroaches_edge(&Sym3::IDENTITY, [image[0], image[1]], skewed(p)));
        faces += usize::from(on_face);
        edges += usize::from(on_edge);
    }
    assert!(faces > 20 && edges > 20 && faces < 700, "the points lie on both sides: {faces}, {edges}");
}

/// Outcome for a tetrahedron inside a cube whose longest edge has this length.
fn refine_inner_tet(longest: f64) -> Result<(), Refusal> {
    let n = 4;
    let size = 3.0_f64.sqrt() / f64::from(n) / longest;
    let (mesh, place, model, source) = cube(n, [size; 3]);
    let Filled { store, .. } = fill::fill(Team::alone(), &mesh, &place, &source).expect("the cube is valid");
    let context = Context::new(store, &source, &model);
    let store = &context.store;
    store.tick();
    let inner = |v: &VertexId| store.dimension(*v) == 3;
    let t = store.live_tets().find(|&t| store.vertices(t).iter().all(inner)).expect("a tetrahedron inside");
    let mut state = State::new(&context);
    Worker::new(&context, &mut state, Exclusive).refine_tet(t)
}

#[test]
fn a_candidate_nearer_to_a_vertex_than_an_edge_may_be_short_is_dropped() {
    // The centroid is 0.354 of the longest edge from the nearest vertices: (1/4, 1/2, 1/4) against (1, 1, 1).
    assert_eq!(refine_inner_tet(1.3), Err(Refusal::Stale));
    assert_eq!(refine_inner_tet(1.95), Err(Refusal::Length));
    assert_eq!(refine_inner_tet(2.05), Ok(()));
}

#[test]
fn one_sweep_makes_points_inside_on_faces_and_on_ridges_and_leaves_a_valid_mesh() {
    for (threads, scheduler) in [
        (1, Scheduler::Sequential),
        (3, Scheduler::Speculative),
        (1, Scheduler::Deterministic),
        (3, Scheduler::Deterministic),
    ] {
        let (mesh, place, model, source) = cube(2, [0.15; 3]);
        let Filled { store, .. } = fill::fill(Team::alone(), &mesh, &place, &source).expect("the cube is valid");
        let context = Context::new(store, &source, &model);
        let pool = Pool::new(threads).expect("a pool");
        let mut states: Vec<_> = (0..threads).map(|_| State::new(&context)).collect();
        context.store.tick();
        let count =
            |dimension| context.store.live_vertices().filter(|&v| context.store.dimension(v) == dimension).count();
        let before = [1, 2, 3].map(count);
        let items = active_tets(Team::alone(), &context);
        assert_eq!(items.len(), mesh.tets.len());
        let execution = Execution { pool: &pool, scheduler, plan: Plan::default(), grains: Grains::default() };
        let counts =
            schedule::run(&InsertCentroids, &items, &context, &mut states, (execution, Kind::Split), &|_| true);
        assert!(counts.done > 0);
        let after = [1, 2, 3].map(count);
        assert!((0..3).all(|k| after[k] > before[k]), "{before:?} {after:?}");
        let topology = model.topology();
        let edges = vec![1; topology.edges.len()];
        let faces = vec![1; topology.faces.len()];
        let refs = crate::adapt::references::References { inward: vec![false; faces.len()], faces, edges };
        let extracted = extract::extract(Team::alone(), &context, &mesh, &refs, &[]).unwrap();
        assert_valid_cube(&extracted.mesh);
    }
}

/// What becomes of the vertex in the middle of a cube with cells of 1/4, and where it has new vertices then.
fn extend_middle(sizes: Vec3) -> (Result<(), Refusal>, Vec<Vec3>) {
    let (mesh, place, model, source) = cube(4, sizes);
    let Filled { store, .. } = fill::fill(Team::alone(), &mesh, &place, &source).expect("the cube is valid");
    let context = Context::new(store, &source, &model);
    let store = &context.store;
    let old = store.vertex_bound() as u32;
    let middle = store.live_vertices().find(|&v| store.position(v) == [0.5; 3]).expect("a vertex in the middle");
    let mut state = State::new(&context);
    let result = Worker::new(&context, &mut state, Exclusive).insert_about(middle);
    check(&context).unwrap();
    let new = store.live_vertices().filter(|v| v.0 >= old);
    (result, new.map(|v| sub(store.position(v), [0.5; 3])).collect())
}

#[test]
fn points_along_eigenvectors_lie_at_unit_distance_both_ways() {
    let (result, mut steps) = extend_middle([0.1, 0.11, 0.12]);
    assert_eq!(result, Ok(()));
    steps.sort_by(|p, q| p.partial_cmp(q).unwrap());
    let expected =
        [[-0.1, 0.0, 0.0], [0.0, -0.11, 0.0], [0.0, 0.0, -0.12], [0.0, 0.0, 0.12], [0.0, 0.11, 0.0], [0.1, 0.0, 0.0]];
    let rounded: Vec<_> = steps.iter().map(|p| p.map(|x| (1e6 * x).round() / 1e6 + 0.0)).collect();
    assert_eq!(rounded, expected);
}

#[test]
fn points_along_eigenvectors_near_to_vertices_or_beyond_them_are_dropped() {
    // The ends of the edges along the axes are at 1.47, and nearer than one.
    for size in [0.17, 0.3] {
        assert_eq!(extend_middle([size; 3]), (Err(Refusal::Length), Vec::new()));
    }
}

#[test]
fn a_sweep_along_eigenvectors_leaves_a_valid_mesh_with_more_vertices_inside() {
    for threads in [1, 3] {
        let (mesh, place, model, source) = cube(4, [0.13, 0.1, 0.12]);
        let Filled { store, .. } = fill::fill(Team::alone(), &mesh, &place, &source).expect("the cube is valid");
        let context = Context::new(store, &source, &model);
        let pool = Pool::new(threads).expect("a pool");
        let mut states: Vec<_> = (0..threads).map(|_| State::new(&context)).collect();
        let before = context.store.live_vertices().count();
        let items = active_vertices(Team::alone(), &context);
        assert_eq!(items.len(), before);
        let dimension = |&v: &VertexId| context.store.dimension(v);
        assert!(items.is_sorted_by_key(dimension));
        for _ in 0..3 {
            context.store.tick();
            let items = active_vertices(Team::alone(), &context);
            let execution = Execution {
                pool: &pool,
                scheduler: Scheduler::Speculative,
                plan: Plan::default(),
                grains: Grains::default(),
            };
            schedule::run(&InsertMetricOrthogonal, &items, &context, &mut states, (execution, Kind::Split), &|_| true);
            check(&context).unwrap();
        }
        let after = context.store.live_vertices().count();
        assert!(after > 2 * before, "{before} {after}");
    }
}

#[test]
fn a_cube_refined_in_any_way_is_a_valid_mesh_with_edges_of_unit_length() {
    let ways = [PointCreation::Centroid, PointCreation::Eigenvector];
    let runs = [([0.2; 3], 1), ([0.3, 0.3, 0.06], 1), ([0.3, 0.3, 0.06], 2)];
    for (points, (sizes, threads)) in ways.into_iter().flat_map(|points| runs.map(|run| (points, run))) {
        let (mesh, place, model, source) = cube(2, sizes);
        let options = Options { points, ..Options::default() };
        let pool = Pool::new(threads).expect("a pool");
        let adapted = adapt(&mesh, &place, &model, &source, &options, &pool, &Silent).expect("the cube is valid");
        let refined = &adapted.extracted.mesh;
        assert_valid_cube(refined);
        assert!(adapted.extracted.off_model.is_empty());
        let statistics =
            crate::metric::statistics::Statistics::in_metric(Team::alone(), refined, &adapted.extracted.metrics);
        let unit = statistics.metric.expect("there is a metric").unit_edges;
        assert!(unit > 0.85, "{unit}");
    }
}

#[test]
fn a_required_triangle_is_not_split() {
    let (mut mesh, place, model, source) = cube(1, [0.15; 3]);
    mesh.required_triangles = (0..mesh.triangles.len() as u32).collect();
    let options = Options { points: PointCreation::Centroid, ..Options::default() };
    let pool = Pool::new(1).expect("a pool");
    let adapted = adapt(&mesh, &place, &model, &source, &options, &pool, &Silent).expect("the cube is valid");
    let refined = &adapted.extracted.mesh;
    assert_valid_cube(refined);
    assert_eq!(refined.triangles.len(), mesh.triangles.len());
    assert!(refined.vertices.len() > mesh.vertices.len(), "points inside are free");
}
