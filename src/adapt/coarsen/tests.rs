use super::*;
use crate::adapt::Freeze;
use crate::adapt::core::fill;
use crate::geometry::Discrete;
use crate::geometry::discrete::DEFAULT_RIDGE_ANGLE;
use crate::mesh::samples::cube;
use crate::mesh::validity::check;
use crate::mesh::vector::Vec3;
use crate::metric::Background;
use crate::tasks::{Plan, Pool, Team};
use proptest::prelude::*;

/// The same size everywhere.
fn of_size(mesh: &TetMesh, size: f64) -> Source {
    let logs = vec![Sym3::ZERO.plus_identity(-2.0 * size.ln()); mesh.vertices.len()];
    Source::Background(Background::new(mesh.vertices.clone(), mesh.tets.nodes.clone(), logs))
}

fn placed(mesh: &TetMesh) -> Classification {
    Discrete::from_mesh(Team::alone(), mesh, DEFAULT_RIDGE_ANGLE).expect("its surface is closed").1
}

fn volume(mesh: &TetMesh) -> f64 {
    mesh.tets.nodes.iter().map(|t| t.map(|v| mesh.vertices[v as usize])).map(|[a, b, c, d]| volume6(a, b, c, d)).sum()
}

/// The cube, shaken: no vertex leaves its side.
fn shaken(n: u32, seed: u64) -> TetMesh {
    let mut mesh = cube(n);
    let mut state = seed;
    let mut shake = |x: f64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let inside = x > 0.0 && x < 1.0;
        let part = (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
        if inside { x + 0.25 * part / f64::from(n) } else { x }
    };
    mesh.vertices.iter_mut().for_each(|p| *p = p.map(&mut shake));
    mesh
}

/// The cube made a ball, but for ridges that stay sharp.
fn rounded(mut mesh: TetMesh) -> TetMesh {
    let round = |p: Vec3| {
        let q = p.map(|x| 2.0 * x - 1.0);
        let bulge = |i: usize| q[i] * (1.0 + 0.15 * (1.0 - q[(i + 1) % 3].powi(2)) * (1.0 - q[(i + 2) % 3].powi(2)));
        [bulge(0), bulge(1), bulge(2)]
    };
    mesh.vertices.iter_mut().for_each(|p| *p = round(*p));
    mesh
}

#[test]
fn crowded_is_what_has_several_times_the_tetrahedra_asked_for() {
    let mesh = cube(4);
    let place = placed(&mesh);
    // Edges of 0.25 to 0.43: about right for a size of 0.3. A size is a factor of eight in the number.
    for (size, crowded) in [(0.1, false), (0.3, false), (0.7, true), (2.0, true)] {
        let coarse = coarsened(Team::alone(), &mesh, &place, &of_size(&mesh, size), &Required::default(), None);
        assert_eq!(coarse.is_some(), crowded, "size {size}");
    }
}

#[test]
fn an_inverted_mesh_is_left_to_who_tells_of_it() {
    let mut mesh = cube(4);
    mesh.tets.nodes[17].swap(0, 1);
    let place = placed(&cube(4));
    assert!(coarsened(Team::alone(), &mesh, &place, &of_size(&cube(4), 2.0), &Required::default(), None).is_none());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn what_is_left_is_the_same_domain(seed: u64, size in 0.25..1.0f64, round: bool) {
        let mesh = if round { rounded(shaken(12, seed)) } else { shaken(12, seed) };
        prop_assert!(check(&mesh).is_valid());
        // The ball is twice as wide.
        let source = of_size(&mesh, if round { 2.0 * size } else { size });
        let place = placed(&mesh);
        let coarse = coarsened(Team::alone(), &mesh, &place, &source, &Required::default(), None).expect("it is crowded");
        prop_assert!(check(&coarse.mesh).is_valid());
        let (before, after) = (volume(&mesh), volume(&coarse.mesh));
        prop_assert!((before - after).abs() < if round { 0.05 * before } else { 1e-12 }, "{} {}", before, after);
        // Far fewer inside and on the faces; all of the edges.
        let of_dimension = |place: &Classification, d: u32| place.entities.iter().filter(|e| e.dimension() == d).count();
        prop_assert!(3 * of_dimension(&coarse.place, 3) < of_dimension(&place, 3));
        prop_assert!(2 * of_dimension(&coarse.place, 2) < of_dimension(&place, 2));
        prop_assert_eq!(of_dimension(&coarse.place, 1), of_dimension(&place, 1));
        prop_assert_eq!(coarse.place.ridges.len(), place.ridges.len());
        // The vertices know who they are, and the store takes them.
        for (v, &old) in coarse.origin.iter().enumerate() {
            prop_assert_eq!(coarse.mesh.vertices[v], mesh.vertices[old as usize]);
            prop_assert!(mesh.tets.nodes[coarse.hints[v] as usize].contains(&old));
        }
        prop_assert!(fill::fill_known(Team::alone(), &coarse.mesh, &coarse.place, &source, coarse.known()).is_ok());
    }
}

#[test]
fn coarse_is_the_same_whatever_the_number_of_threads() {
    // Rounded, so that triangles turn too.
    for mesh in [shaken(14, 3), rounded(shaken(14, 4)), cube(14)] {
        let (place, source) = (placed(&mesh), of_size(&mesh, 0.9));
        let of_threads = |threads: usize| {
            let pool = Pool::new(threads).unwrap();
            let team = Team::new(&pool, Plan::default());
            let coarse = coarsened(team, &mesh, &place, &source, &Required::default(), None).expect("it is crowded");
            (coarse.mesh, coarse.origin, coarse.hints)
        };
        let of_one = of_threads(1);
        for threads in [2, 3, 8] {
            assert!(of_threads(threads) == of_one, "{threads} threads");
        }
    }
}

#[test]
fn what_is_required_stays() {
    let mut mesh = shaken(8, 1);
    let inside = |v: u32| mesh.vertices[v as usize].iter().all(|x| (0.2..0.8).contains(x));
    let edge = mesh.tets.nodes.iter().find(|nodes| nodes.iter().all(|&v| inside(v))).map(|nodes| [nodes[0], nodes[2]]);
    let edge = edge.expect("it has an inside");
    let alone = (0..mesh.vertices.len() as u32).rfind(|&v| inside(v) && !edge.contains(&v)).expect("it has an inside");
    mesh.edges.push(edge, 7);
    mesh.required_edges = vec![mesh.edges.len() as u32 - 1];
    mesh.required_vertices = vec![alone];
    let coarse = coarsened(
        Team::alone(),
        &mesh,
        &placed(&mesh),
        &of_size(&mesh, 2.0),
        &Required::of(&mesh, &Freeze::default()),
        None,
    )
    .expect("it is crowded");
    let number = |v: u32| coarse.origin.iter().position(|&old| old == v).expect("it stays") as u32;
    number(alone);
    let ends = edge.map(number);
    assert!(coarse.mesh.tets.nodes.iter().any(|nodes| ends.iter().all(|v| nodes.contains(v))));
    assert!(2 * coarse.mesh.vertices.len() < mesh.vertices.len());
}
