//! The orientation of tetrahedra.
use super::Dataset;
use crate::mesh::vector::Vec3;
use crate::mesh::vector::volume6;
use crate::tasks::{GRAIN, Team};

/// Reverses all tetrahedra that a mesh has of its own where most are negative, since programs number them either way. Returns a notice of that, or
/// that some stay negative.
pub(super) fn unify(team: Team<'_>, data: &mut Dataset) -> Option<String> {
    let own = data.own_tets();
    unify_all(team, &data.mesh.vertices, &mut data.mesh.tets.nodes[..own])
}

/// The same of these tetrahedra.
pub(super) fn unify_all(team: Team<'_>, points: &[Vec3], tets: &mut [[u32; 4]]) -> Option<String> {
    let is_negative = |nodes: &&[u32; 4]| {
        let [a, b, c, d] = nodes.map(|v| points[v as usize]);
        volume6(a, b, c, d) < 0.0
    };
    let all = tets.len();
    let parts = team.chunks(GRAIN, all, |range| tets[range].iter().filter(is_negative).count());
    let negative: usize = parts.into_iter().sum();
    let turned = 2 * negative > all;
    if turned {
        team.fill(GRAIN, tets, |_, tets| tets.iter_mut().for_each(|nodes| nodes.swap(0, 1)));
    }
    match (turned, if turned { all - negative } else { negative }) {
        (false, 0) => None,
        (true, 0) => Some("the tetrahedra were numbered the other way; all were turned".into()),
        (_, left) => Some(format!("{left} of {all} tetrahedra are negative or flat, against the others")),
    }
}
