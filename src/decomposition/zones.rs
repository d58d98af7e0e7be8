//! What cuts have left to be done: the tetrahedra around them.
use super::piece::{Piece, WAITING};
use super::split::split;

/// A cut is felt by so many rings of tetrahedra on each side.
const RINGS: usize = 4;

/// Takes a piece apart into what cuts have left to be done, and what is finished.
pub fn divide(piece: &Piece) -> [Piece; 2] {
    let owner = finished(piece);
    split(piece, &owner, 2, |_, _| false).try_into().unwrap_or_default()
}

/// For each tetrahedron 0 where a cut has left something to be done, else 1.
fn finished(piece: &Piece) -> Vec<u32> {
    let mut is_near: Vec<bool> = piece.marks.iter().map(|mark| mark & WAITING != 0).collect();
    let mut owner = vec![1; piece.len()];
    for ring in 0..RINGS {
        let mut reached = Vec::new();
        for (nodes, owner) in piece.mesh.tets.nodes.iter().zip(&mut owner) {
            if *owner == 1 && nodes.iter().any(|&v| is_near[v as usize]) {
                *owner = 0;
                reached.extend_from_slice(nodes);
            }
        }
        if ring + 1 < RINGS {
            reached.iter().for_each(|&v| is_near[v as usize] = true);
        }
    }
    owner
}
