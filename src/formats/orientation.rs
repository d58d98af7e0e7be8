//! The orientation of tetrahedra.
use crate::mesh::TetMesh;
use crate::mesh::vector::volume6;
use crate::tasks::{GRAIN, Team};

/// Reverses all tetrahedra where most are negative, since programs number them either way. Returns a notice of that, or that some stay
/// negative.
pub(super) fn unify(team: Team<'_>, mesh: &mut TetMesh) -> Option<String> {
    let points = &mesh.vertices;
    let is_negative = |nodes: &&[u32; 4]| {
        let [a, b, c, d] = nodes.map(|v| points[v as usize]);
        volume6(a, b, c, d) < 0.0
    };
    let all = mesh.tets.len();
    let parts = team.chunks(GRAIN, all, |range| mesh.tets.nodes[range].iter().filter(is_negative).count());
    let negative: usize = parts.into_iter().sum();
    let turned = 2 * negative > all;
    if turned {
        team.fill(GRAIN, &mut mesh.tets.nodes, |_, tets| tets.iter_mut().for_each(|nodes| nodes.swap(0, 1)));
    }
    match (turned, if turned { all - negative } else { negative }) {
        (false, 0) => None,
        (true, 0) => Some("the tetrahedra were numbered the other way; all were turned".into()),
        (_, left) => Some(format!("{left} of {all} tetrahedra are negative or flat, against the others")),
    }
}
