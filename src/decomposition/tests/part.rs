//! Parts are adapted, and what they share with others stays.
use super::{centroids, picture, sample};
use crate::adapt::{Freeze, Options, References, Scheduler, Silent};
use crate::decomposition::join::join;
use crate::decomposition::outline::{Numbering, Outline};
use crate::decomposition::part::{Round, Tools, adapt_piece};
use crate::decomposition::piece::{Piece, SHARED, WAITING};
use crate::decomposition::split::split;
use crate::decomposition::zones::divide;
use crate::geometry::Model;
use crate::mesh::adjacency::{FACES, MatchedFaces, NONE, sorted2, sorted3};
use crate::mesh::predicate::is_positive;
use crate::mesh::vector::volume6;
use crate::metric::Source;
use crate::tasks::{Pool, Team};
use std::collections::{BTreeMap, BTreeSet};

const FIRST: Round = Round { is_zone: false, is_alone: false };
const ZONE: Round = Round { is_zone: true, is_alone: false };
const ALONE: Round = Round { is_zone: true, is_alone: true };

fn adapted(model: &Model, source: &Source, piece: Piece, round: Round, part: u64) -> Piece {
    frozen(model, source, piece, round, part, Freeze::default())
}

fn frozen(model: &Model, source: &Source, piece: Piece, round: Round, part: u64, freeze: Freeze) -> Piece {
    let options = Options { scheduler: Scheduler::Sequential, freeze, ..Options::default() };
    let pool = Pool::new(1).unwrap();
    let refs = References::of(Team::alone(), &piece.mesh, &piece.place, model).outwards();
    let tools = Tools { model, source, refs: &refs, options: &options, pool: &pool, observer: &Silent };
    adapt_piece(tools, piece, round, part << 40).unwrap().0
}

/// Splits a piece by planes across an axis.
fn sliced(piece: &Piece, axis: usize, at: &[f64], is_cut: bool) -> Vec<Piece> {
    let of = |centre: [f64; 3]| at.iter().filter(|at| centre[axis] > **at).count() as u32;
    let owner: Vec<u32> = centroids(piece).into_iter().map(of).collect();
    split(piece, &owner, at.len() + 1, |_, _| is_cut)
}

/// What lies where other parts are: the vertices by their ids, with all that is known of them, and the faces.
fn shared(piece: &Piece) -> (BTreeMap<u64, String>, BTreeSet<[u64; 3]>) {
    let Piece { mesh, place, logs, ids, marks, .. } = piece;
    let at = |v: usize| {
        let place = (place.entities[v], place.parameters[v], place.projected[v].map(f64::to_bits));
        format!("{:?} {} {place:?} {:?} {}", mesh.vertices[v].map(f64::to_bits), mesh.vertex_refs[v], logs[v], marks[v])
    };
    let vertices = (0..ids.len()).filter(|&v| marks[v] & SHARED != 0).map(|v| (ids[v], at(v))).collect();
    let faces = MatchedFaces::of(Team::alone(), &mesh.tets.nodes);
    let own = mesh.triangles.nodes.iter().zip(&piece.halves).filter(|(_, half)| !**half);
    let own: BTreeSet<[u32; 3]> = own.map(|(nodes, _)| sorted3(*nodes)).collect();
    let mut open = BTreeSet::new();
    for (nodes, around) in mesh.tets.nodes.iter().zip(&faces.neighbours) {
        for face in (0..4).filter(|&i| around[i] == NONE).map(|i| FACES[i].map(|k| nodes[k])) {
            if !own.contains(&sorted3(face)) {
                assert!(face.iter().all(|&v| marks[v as usize] & SHARED != 0));
                let mut face = face.map(|v| ids[v as usize]);
                face.sort_unstable();
                open.insert(face);
            }
        }
    }
    (vertices, open)
}

/// The piece is a mesh of the cube, whole where nothing is missing: positive, matched, on its model, and with all that was required.
fn check_whole(piece: &Piece) {
    let Piece { mesh, place, halves, ids, .. } = piece;
    assert!(!halves.contains(&true));
    assert_eq!(ids.iter().collect::<BTreeSet<_>>().len(), ids.len(), "an id comes twice");
    let faces = MatchedFaces::of(Team::alone(), &mesh.tets.nodes);
    assert_eq!(faces.crowded, None);
    let triangles: BTreeMap<[u32; 3], usize> = mesh.triangles.nodes.iter().map(|t| sorted3(*t)).zip(0..).collect();
    assert_eq!(triangles.len(), mesh.triangles.len(), "a triangle comes twice");
    let mut found = BTreeSet::new();
    let mut volumes = BTreeMap::new();
    for (t, (nodes, region)) in mesh.tets.iter().enumerate() {
        let at = nodes.map(|v| mesh.vertices[v as usize]);
        assert!(is_positive(at));
        *volumes.entry(region).or_insert(0.0) += volume6(at[0], at[1], at[2], at[3]) / 6.0;
        for (face, &n) in FACES.iter().zip(&faces.neighbours[t]) {
            let other = if n == NONE { None } else { Some(mesh.tets.refs[n as usize]) };
            if other == Some(region) {
                continue;
            }
            let face = face.map(|k| nodes[k]);
            let triangle = triangles.get(&sorted3(face)).expect("a triangle lies between regions and on the boundary");
            found.insert(*triangle);
            let given = mesh.triangles.nodes[*triangle];
            let turned = [given, [given[1], given[2], given[0]], [given[2], given[0], given[1]]].contains(&face);
            assert_eq!(turned, other.is_none_or(|other| region < other), "triangles look out of the lesser region");
        }
    }
    assert_eq!(found.len(), triangles.len(), "a triangle lies inside a region");
    assert!(volumes.values().all(|volume| (volume - 0.5_f64).abs() < 1e-9), "{volumes:?}");
    // Four edges of the cube are cut in two by the interface, whose four edges are ridges too.
    let length = |nodes: &[u32; 2]| {
        crate::mesh::vector::distance(mesh.vertices[nodes[0] as usize], mesh.vertices[nodes[1] as usize])
    };
    let all: f64 = place.ridges.iter().map(|(nodes, _)| length(nodes)).sum();
    assert!((all - 16.0).abs() < 1e-9, "the ridges have a length of {all}");
    let ridges: BTreeSet<[u32; 2]> = place.ridges.iter().map(|(nodes, _)| sorted2(*nodes)).collect();
    assert_eq!(ridges.len(), place.ridges.len(), "a ridge comes twice");
}

/// What is required, by places, and the references of triangles.
fn required(piece: &Piece) -> BTreeSet<String> {
    let mesh = &piece.mesh;
    let at = |v: u32| mesh.vertices[v as usize].map(f64::to_bits);
    let places = |nodes: &[u32]| nodes.iter().map(|&v| at(v)).collect::<BTreeSet<_>>();
    let vertices = mesh.required_vertices.iter().map(|&v| format!("{:?}", at(v)));
    let edges = mesh.edges.iter().map(|(nodes, reference)| format!("{:?} {reference}", places(&nodes)));
    let triangles = mesh.required_triangles.iter().map(|&t| format!("{:?}", places(&mesh.triangles.nodes[t as usize])));
    assert_eq!(mesh.required_edges.len(), mesh.edges.len());
    vertices.chain(edges).chain(triangles).collect()
}

/// Adapts slices of a cube, moves the cuts, and does what they have left. `size` is that of the mesh that is wanted, where n cells are.
fn in_rounds(n: u32, size: f64) -> (Piece, Piece) {
    let (model, source, mut whole) = sample(n, size);
    // So that the volumes are those of the cube.
    whole.place.projected.clone_from(&whole.mesh.vertices);
    let mut part = 1;
    let mut round = |pieces: Vec<Piece>, round: Round| -> Vec<Piece> {
        let mut adapt = |piece: Piece| {
            part += 1;
            let before = shared(&piece);
            let piece = adapted(&model, &source, piece, round, part);
            // Vertices of cuts that were closed before are not shared any more.
            let (vertices, faces) = shared(&piece);
            assert!(faces == before.1);
            assert!(vertices.iter().all(|(id, at)| before.0.get(id).is_some_and(|before| is_same(before, at))));
            piece
        };
        pieces.into_iter().map(&mut adapt).collect()
    };
    let first = round(sliced(&whole, 2, &[0.3, 0.6], true), FIRST);
    let joined = join(first.clone());
    check_whole(&joined);
    // Across the interface.
    let mut dealt = vec![Vec::new(); 2];
    for piece in first {
        dealt.iter_mut().zip(sliced(&piece, 0, &[0.45], true)).for_each(|(part, share)| part.push(share));
    }
    let second = round(dealt.into_iter().map(join).collect(), FIRST);
    check_whole(&join(second.clone()));
    let (active, mut finished): (Vec<Piece>, Vec<Piece>) =
        second.iter().map(divide).map(|[active, finished]| (active, finished)).unzip();
    assert!(active.iter().all(|piece| piece.len() > 0));
    let third = round(vec![join(active)], ZONE);
    finished.extend(third);
    // The skin is that of the mesh that is joined.
    let numbering = Numbering::of(finished.iter().map(Outline::of).collect());
    let last = join(finished);
    check_whole(&last);
    assert_eq!([numbering.vertices(), numbering.tets()], [last.ids.len(), last.len()]);
    let triangles =
        |piece: &Piece| picture(piece).into_iter().filter(|line| line.starts_with("triangle")).collect::<Vec<_>>();
    assert!(triangles(&numbering.skin) == triangles(&last));
    (whole, last)
}

/// Whether a shared vertex is as it was, but that it need not wait any more.
fn is_same(before: &str, after: &str) -> bool {
    let [(before, was), (after, is)] = [before, after].map(|line| line.rsplit_once(' ').unwrap());
    let [was, is] = [was, is].map(|marks| marks.parse::<u8>().unwrap());
    before == after && is & !WAITING == SHARED && is & !was == 0
}

#[test]
fn a_cube_is_refined_in_parts() {
    let (whole, last) = in_rounds(6, 0.12);
    assert!(last.len() > 3 * whole.len(), "{}", last.len());
    assert!(required(&last) == required(&whole));
    // References of faces are as they were.
    let of_face = |piece: &Piece| {
        piece.place.faces.iter().copied().zip(piece.mesh.triangles.refs.iter().copied()).collect::<BTreeSet<_>>()
    };
    assert!(of_face(&last) == of_face(&whole));
}

#[test]
fn a_cube_is_coarsened_in_parts() {
    let (whole, last) = in_rounds(12, 0.3);
    assert!(3 * last.len() < whole.len(), "{}", last.len());
    assert!(required(&last) == required(&whole));
}

#[test]
fn what_is_frozen_stays_in_all_rounds() {
    let (model, source, mut whole) = sample(6, 0.12);
    whole.place.projected.clone_from(&whole.mesh.vertices);
    let on_top = |piece: &Piece| {
        let top = piece.mesh.triangles.iter().filter(|(_, reference)| *reference == 6);
        top.map(|(nodes, _)| sorted_places(piece, nodes)).collect::<BTreeSet<_>>()
    };
    let freeze = Freeze { surfaces: vec![6], regions: Vec::new() };
    let once = frozen(&model, &source, whole.clone(), ALONE, 1, freeze.clone());
    assert!(once.len() > 2 * whole.len() && on_top(&once) == on_top(&whole));
    let twice = frozen(&model, &source, once.clone(), ALONE, 2, freeze);
    assert!(on_top(&twice) == on_top(&whole));
    check_whole(&twice);
}

fn sorted_places(piece: &Piece, nodes: [u32; 3]) -> [[u64; 3]; 3] {
    let mut places = nodes.map(|v| piece.mesh.vertices[v as usize].map(f64::to_bits));
    places.sort_unstable();
    places
}

#[test]
fn a_held_vertex_keeps_its_way_to_the_model() {
    let (model, source, mut whole) = sample(6, 0.1);
    let on_face = |v: &usize| {
        let at = whole.mesh.vertices[*v];
        at[0] == 1.0 && at[1] == 0.5 && (at[2] - 0.5).abs() < 1e-9
    };
    let v = (0..whole.ids.len()).find(on_face).unwrap();
    whole.place.projected[v] = [1.01, 0.5, 0.5];
    let pieces = sliced(&whole, 2, &[0.5], true);
    for piece in pieces {
        let id = v as u64;
        let piece = adapted(&model, &source, piece, FIRST, 1);
        let at = piece.ids.iter().position(|other| *other == id).unwrap();
        assert_eq!(piece.place.projected[at], [1.01, 0.5, 0.5]);
        assert_eq!(piece.mesh.vertices[at], whole.mesh.vertices[v]);
        assert_eq!(piece.marks[at], SHARED | WAITING);
    }
}

#[test]
fn what_touches_in_vertices_and_edges_rests() {
    let (model, source, mut whole) = sample(6, 0.08);
    whole.place.projected.clone_from(&whole.mesh.vertices);
    // Two octants that touch in the middle, and two that touch them in edges.
    let is_dark = |centre: [f64; 3]| centre.iter().filter(|x| **x > 0.5).count() % 2 == 0;
    let owner: Vec<u32> = centroids(&whole).into_iter().map(|centre| u32::from(is_dark(centre))).collect();
    let pieces = split(&whole, &owner, 2, |_, _| true);
    let pieces: Vec<Piece> =
        pieces.into_iter().zip(1..).map(|(piece, part)| adapted(&model, &source, piece, FIRST, part)).collect();
    assert!(pieces.iter().map(Piece::len).sum::<usize>() > 2 * whole.len());
    let joined = join(pieces);
    check_whole(&joined);
    assert!(required(&joined) == required(&whole));
}

#[test]
fn what_rests_on_the_other_side_of_the_interface_keeps_its_triangles() {
    // A tetrahedron of the greater region hangs at the lesser one by an edge and at its own one by a face.
    let (model, source, mut whole) = sample(4, 0.2);
    whole.place.projected.clone_from(&whole.mesh.vertices);
    let mut random = super::Random(8);
    for part in 1..5 {
        let owner: Vec<u32> = (0..whole.len()).map(|_| u32::from(random.below(4) == 0)).collect();
        let pieces = split(&whole, &owner, 2, |_, _| true);
        let pieces =
            pieces.into_iter().zip(2 * part..).map(|(piece, part)| adapted(&model, &source, piece, FIRST, part));
        check_whole(&join(pieces));
    }
}

#[test]
fn nothing_comes_of_nothing() {
    let (model, source, _) = sample(2, 0.5);
    assert!(adapted(&model, &source, Piece::default(), FIRST, 1) == Piece::default());
}
