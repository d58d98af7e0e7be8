//! Pieces as bytes.
use super::{Random, sample};
use crate::decomposition::bytes::{decoded, encoded};
use crate::decomposition::piece::Piece;
use crate::decomposition::split::split;

/// Pieces with everything in them.
fn pieces() -> Vec<Piece> {
    let (_, _, whole) = sample(3, 0.3);
    let owner: Vec<u32> = (0..whole.len() as u32).map(|t| t % 3).collect();
    let mut pieces = split(&whole, &owner, 3, |_, _| true);
    pieces.push(whole);
    pieces
}

#[test]
fn a_piece_comes_back_as_it_was() {
    for piece in pieces() {
        assert!(piece.len() > 0 && !piece.place.ridges.is_empty() && !piece.mesh.required_vertices.is_empty());
        assert!(decoded(&encoded(&piece)) == Some(piece));
    }
    assert!(decoded(&encoded(&Piece::default())) == Some(Piece::default()));
}

#[test]
fn damaged_bytes_are_no_piece() {
    let bytes = encoded(&pieces()[0]);
    let mut random = Random(3);
    let mut places: Vec<usize> = (0..200).map(|_| random.below(bytes.len())).collect();
    places.extend([0, 7, 8, bytes.len() - 1]);
    for at in places {
        assert!(decoded(&bytes[..at]).is_none(), "cut off at {at}");
        let mut changed = bytes.clone();
        changed[at] ^= 1 << random.below(8);
        assert!(decoded(&changed).is_none(), "changed at {at}");
        changed.remove(at);
        assert!(decoded(&changed).is_none(), "without {at}");
    }
    let more = [&bytes[..], &[0]].concat();
    assert!(decoded(&more).is_none() && decoded(&[]).is_none() && decoded(&[0; 4096]).is_none());
}

#[test]
fn a_piece_whose_lists_do_not_fit_is_none() {
    let spoils: [fn(&mut Piece); 9] = [
        |piece| piece.mesh.tets.nodes[0][1] = piece.ids.len() as u32,
        |piece| piece.mesh.triangles.nodes[0][1] = u32::MAX,
        |piece| piece.mesh.required_triangles.push(1 << 20),
        |piece| piece.mesh.required_edges.push(1 << 20),
        |piece| piece.place.ridges[0].0[1] = 1 << 20,
        |piece| piece.cuts[0][2] = 1 << 20,
        |piece| piece.logs.truncate(1),
        |piece| piece.halves.push(true),
        |piece| piece.mesh.tets.refs.push(1),
    ];
    for (which, spoil) in spoils.into_iter().enumerate() {
        let mut piece = pieces().swap_remove(0);
        spoil(&mut piece);
        assert!(decoded(&encoded(&piece)).is_none(), "{which}");
    }
}
