//! Numbers of the vertices of all pieces.
use super::{Random, picture, sample};
use crate::decomposition::outline::{Numbering, Outline};
use crate::decomposition::piece::Piece;
use crate::decomposition::split::split;
use crate::geometry::Entity;
use crate::mesh::adjacency::TriangleIndex;
use crate::tasks::Team;
use std::collections::{BTreeMap, BTreeSet};

/// The outlines, there and back as bytes.
fn numbering(pieces: &[Piece]) -> Numbering {
    let mut bytes = Vec::new();
    pieces.iter().for_each(|piece| bytes.append(&mut Outline::of(piece).encoded()));
    let mut from = &bytes[..];
    let outlines = pieces.iter().map(|_| Outline::decoded(&mut from).unwrap()).collect();
    assert!(from.is_empty() && Outline::decoded(&mut &bytes[..100]).is_none());
    Numbering::of(outlines)
}

/// Checks the numbers of pieces that together are `whole`.
fn check(whole: &Piece, pieces: &[Piece]) {
    let numbering = numbering(pieces);
    assert_eq!([numbering.vertices(), numbering.tets()], [whole.ids.len(), whole.len()]);
    let listed = numbering.skin.ids.len();
    let mut number: BTreeMap<u64, u32> = (0..).zip(&numbering.skin.ids).map(|(number, id)| (*id, number)).collect();
    let (mut next, mut next_tet) = (listed, 0);
    for (index, piece) in pieces.iter().enumerate() {
        let numbers = numbering.of_piece(index, piece);
        assert_eq!([numbers.first, numbers.first_tet], [next, next_tet]);
        next_tet += piece.len();
        for &v in &numbers.written {
            assert_eq!(numbers.numbers[v as usize] as usize, next, "those that are written follow each other");
            next += 1;
        }
        for (id, &of_vertex) in piece.ids.iter().zip(&numbers.numbers) {
            assert_eq!(*number.entry(*id).or_insert(of_vertex), of_vertex, "{id} has two numbers");
        }
    }
    assert_eq!(next, whole.ids.len());
    let mut all: Vec<u32> = number.into_values().collect();
    all.sort_unstable();
    assert!(all.into_iter().eq(0..whole.ids.len() as u32), "the numbers are a permutation");
    let on_model = whole.place.entities.iter().filter(|entity| **entity != Entity::Interior).count();
    assert!(listed >= on_model);
    // The skin has all lists of the whole. Its cuts are the triangles between regions.
    let lists = |piece: &Piece| {
        let is_list = |line: &String| !["vertex", "tet", "cut"].iter().any(|kind| line.starts_with(kind));
        picture(piece).into_iter().filter(is_list).collect::<Vec<_>>()
    };
    assert!(lists(&numbering.skin) == lists(whole) && numbering.skin.len() == 0);
    let named = |piece: &Piece, nodes: [u32; 3]| sorted(nodes.map(|v| piece.ids[v as usize]));
    let inner: BTreeSet<[u64; 3]> = numbering.skin.cuts.iter().map(|&nodes| named(&numbering.skin, nodes)).collect();
    let index = TriangleIndex::new(Team::alone(), &whole.mesh.triangles.nodes, whole.ids.len());
    let mut sides = vec![0; whole.mesh.triangles.len()];
    index.sides(Team::alone(), &whole.mesh.tets.nodes).iter().for_each(|side| sides[side.triangle as usize] += 1);
    let of_two = whole.mesh.triangles.nodes.iter().zip(sides).filter(|(_, sides)| *sides == 2);
    let of_two: BTreeSet<[u64; 3]> = of_two.map(|(&nodes, _)| named(whole, nodes)).collect();
    assert!(!of_two.is_empty() && inner == of_two);
}

fn sorted(mut ids: [u64; 3]) -> [u64; 3] {
    ids.sort_unstable();
    ids
}

#[test]
fn numbers_are_a_permutation_and_the_listed_come_first() {
    let (_, _, whole) = sample(4, 0.3);
    let mut random = Random(4);
    for parts in [1, 2, 3, 7] {
        let owner: Vec<u32> = (0..whole.len()).map(|_| random.below(parts) as u32).collect();
        check(&whole, &split(&whole, &owner, parts, |_, _| true));
        let owner: Vec<u32> = (0..whole.len()).map(|t| (t * parts / whole.len()) as u32).collect();
        check(&whole, &split(&whole, &owner, parts, |_, _| true));
    }
}

#[test]
fn an_end_of_a_required_edge_has_one_number_in_pieces_without_the_edge() {
    let (_, _, whole) = sample(4, 0.3);
    let [a, b] = whole.mesh.edges.nodes[1];
    assert!([a, b].iter().all(|&v| whole.place.entities[v as usize] == Entity::Interior));
    let has_one = |nodes: &[u32; 4]| nodes.contains(&a) && !nodes.contains(&b);
    for first in [0, 1] {
        let owner: Vec<u32> = whole.mesh.tets.nodes.iter().map(|nodes| first ^ u32::from(has_one(nodes))).collect();
        check(&whole, &split(&whole, &owner, 2, |_, _| true));
    }
}
