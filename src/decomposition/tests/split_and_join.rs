//! What is split and joined again is the same mesh.
use super::{Random, centroids, picture, sample};
use crate::decomposition::join::join;
use crate::decomposition::piece::{Piece, SHARED, WAITING};
use crate::decomposition::split::split;
use crate::decomposition::zones::divide;
use crate::mesh::adjacency::{FACES, MatchedFaces, NONE, sorted2, sorted3};
use std::collections::{BTreeMap, BTreeSet};

/// Owners of tetrahedra: by planes, which cross the interface between the regions, or any.
fn owners(piece: &Piece, random: &mut Random, parts: usize, is_planar: bool) -> Vec<u32> {
    let of = |centre: [f64; 3]| ((0.4 * centre[0] + 0.7 * centre[1]) / 1.1 * parts as f64) as u32;
    match is_planar {
        true => centroids(piece).into_iter().map(of).collect(),
        false => (0..piece.len()).map(|_| random.below(parts) as u32).collect(),
    }
}

#[test]
fn pieces_join_to_the_mesh_that_was_split() {
    let (_, _, whole) = sample(4, 0.3);
    let (before, mut random) = (picture(&whole), Random(1));
    for round in 0..12 {
        let parts = 1 + round;
        let owner = owners(&whole, &mut random, parts, round % 2 == 0);
        let mut pieces = split(&whole, &owner, parts, |_, _| false);
        assert_eq!(pieces.iter().map(Piece::len).sum::<usize>(), whole.len());
        assert!(pieces.iter().all(|piece| piece.halves.contains(&true) == (parts > 1) || round % 2 == 0));
        let turn = random.below(parts);
        pieces.rotate_left(turn);
        assert!(picture(&join(pieces)) == before, "{parts} parts");
    }
}

#[test]
fn pieces_of_pieces_are_dealt_to_other_parts_and_joined() {
    let (_, _, whole) = sample(4, 0.3);
    let (before, mut random) = (picture(&whole), Random(2));
    for _ in 0..4 {
        let mut parts: Vec<Piece> = vec![whole.clone()];
        for round in 0..3 {
            let count = 2 + random.below(4);
            let mut dealt = vec![Vec::new(); count];
            for piece in parts {
                let owner = owners(&piece, &mut random, count, round == 1);
                let shares = split(&piece, &owner, count, |_, _| false);
                dealt.iter_mut().zip(shares).for_each(|(part, share)| part.push(share));
            }
            parts = dealt.into_iter().map(join).collect();
        }
        assert!(picture(&join(parts)) == before);
    }
}

/// The triangles between the regions, by the ids of their nodes in order, with whether another piece has them.
fn interface(piece: &Piece) -> BTreeMap<[u64; 3], bool> {
    let mesh = &piece.mesh;
    let inner = mesh
        .triangles
        .nodes
        .iter()
        .zip(&piece.halves)
        .filter(|(nodes, _)| nodes.iter().all(|&v| mesh.vertices[v as usize][0] == 0.5));
    inner.map(|(nodes, half)| (nodes.map(|v| piece.ids[v as usize]), *half)).collect()
}

#[test]
fn a_triangle_between_regions_is_in_both_pieces_and_one_again() {
    let (_, _, whole) = sample(4, 0.3);
    assert_eq!(interface(&whole).len(), 32);
    let owner: Vec<u32> = whole.mesh.tets.refs.iter().map(|&region| u32::from(region == 7)).collect();
    let pieces = split(&whole, &owner, 2, |_, _| false);
    let [below, above] = [&pieces[0], &pieces[1]].map(interface);
    assert!(below == above && below.len() == 32 && below.values().all(|half| *half));
    let joined = join(pieces);
    assert!(interface(&joined) == interface(&whole) && !joined.halves.contains(&true));
}

#[test]
fn ridges_come_to_the_pieces_that_have_the_edge() {
    let (_, _, whole) = sample(3, 0.3);
    let mut random = Random(5);
    let owner = owners(&whole, &mut random, 4, false);
    for piece in split(&whole, &owner, 4, |_, _| false) {
        let edge = |nodes: [u32; 2]| piece.mesh.tets.nodes.iter().any(|tet| nodes.iter().all(|v| tet.contains(v)));
        let known: BTreeSet<[u32; 2]> = piece.place.ridges.iter().map(|(nodes, _)| sorted2(*nodes)).collect();
        assert_eq!(known.len(), piece.place.ridges.len());
        let ids = |nodes: [u32; 2]| nodes.map(|v| piece.ids[v as usize] as u32);
        for &(nodes, curve) in &piece.place.ridges {
            assert!(
                edge(nodes)
                    && whole
                        .place
                        .ridges
                        .iter()
                        .any(|ridge| sorted2(ridge.0) == sorted2(ids(nodes)) && ridge.1 == curve)
            );
        }
        let number = |id: u32| piece.ids.iter().position(|&other| other == u64::from(id)).map(|v| v as u32);
        for (nodes, _) in &whole.place.ridges {
            if let [Some(a), Some(b)] = nodes.map(number) {
                assert_eq!(edge([a, b]), known.contains(&sorted2([a, b])));
            }
        }
    }
}

/// The cuts of a piece by ids, and its faces of one tetrahedron.
fn cuts_and_open(piece: &Piece) -> [BTreeSet<[u64; 3]>; 2] {
    let ids = |nodes: [u32; 3]| {
        let mut ids = nodes.map(|v| piece.ids[v as usize]);
        ids.sort_unstable();
        ids
    };
    let tets = &piece.mesh.tets.nodes;
    let faces = MatchedFaces::of(crate::tasks::Team::alone(), tets);
    let sides = (0..tets.len()).flat_map(|t| (0..4).map(move |i| (t, i)));
    let open = sides.filter(|&(t, i)| faces.neighbours[t][i] == NONE).map(|(t, i)| ids(FACES[i].map(|k| tets[t][k])));
    [piece.cuts.iter().map(|&nodes| ids(nodes)).collect(), open.collect()]
}

#[test]
fn cuts_are_known_on_both_sides_until_they_are_closed() {
    let (_, _, whole) = sample(4, 0.3);
    let owner = owners(&whole, &mut Random(3), 3, true);
    let [_, outside] = cuts_and_open(&whole);
    let pieces = split(&whole, &owner, 3, |_, _| true);
    let mut times = BTreeMap::new();
    for piece in &pieces {
        let [cuts, open] = cuts_and_open(piece);
        assert_eq!(cuts.len(), piece.cuts.len());
        assert!(piece.cuts.iter().all(|&nodes| nodes == sorted3(nodes)));
        assert!(cuts == open.difference(&outside).copied().collect());
        cuts.into_iter().for_each(|cut| *times.entry(cut).or_insert(0) += 1);
        let at_cut: BTreeSet<u32> = piece.cuts.iter().flatten().copied().collect();
        for (v, mark) in (0..).zip(&piece.marks) {
            assert_eq!(mark & WAITING != 0, at_cut.contains(&v));
            assert!(mark & WAITING == 0 || mark & SHARED != 0);
        }
    }
    assert!(!times.is_empty() && times.values().all(|&times| times == 2));
    // Two of them together: between these two nothing is cut any more, and to the third it is.
    let mut pieces = pieces;
    let third = pieces.pop().unwrap();
    let both = join(pieces);
    let again = split(&both, &vec![0; both.len()], 1, |_, _| true).swap_remove(0);
    assert!(again.len() == both.len() && again.cuts.len() < both.cuts.len());
    assert!(
        cuts_and_open(&again)[0] == cuts_and_open(&third)[0].intersection(&cuts_and_open(&both)[1]).copied().collect()
    );
    assert!(!again.cuts.is_empty());
}

#[test]
fn what_is_not_a_cut_leaves_nothing_to_wait() {
    let (_, _, whole) = sample(3, 0.3);
    let owner = owners(&whole, &mut Random(3), 2, true);
    for piece in split(&whole, &owner, 2, |_, _| false) {
        assert!(piece.cuts.is_empty() && piece.marks.iter().all(|mark| mark & WAITING == 0));
        assert!(piece.marks.iter().any(|mark| mark & SHARED != 0));
    }
}

#[test]
fn rings_about_a_cut_are_left_and_the_rest_is_finished() {
    let (_, _, whole) = sample(12, 0.3);
    let is_above = |centre: [f64; 3]| u32::from(centre[2] > 0.75);
    let owner: Vec<u32> = centroids(&whole).into_iter().map(is_above).collect();
    let pieces = split(&whole, &owner, 2, |_, _| true);
    let [active, finished] = divide(&pieces[0]);
    assert_eq!(active.len() + finished.len(), pieces[0].len());
    // Four rings, of a cell each.
    assert!(centroids(&active).iter().all(|centre| centre[2] > 5.0 / 12.0));
    assert!(centroids(&finished).iter().all(|centre| centre[2] < 5.0 / 12.0));
    assert!(active.cuts.len() == pieces[0].cuts.len() && finished.cuts.is_empty());
    assert!(picture(&join([finished.clone(), active])) == picture(&pieces[0]));
    // Without a cut all is finished.
    let [active, rest] = divide(&finished);
    assert!(active.len() == 0 && picture(&rest) == picture(&finished));
}
