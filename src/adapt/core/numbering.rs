//! An order of the vertices and tetrahedra in which what is near in space is near in memory.
use super::ids::{TetId, VertexId};
use crate::mesh::hilbert;
use crate::mesh::vector::Vec3;
use crate::tasks::{GRAIN, Rows, Team};
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// New numbers along the Hilbert curve.
pub struct Numbering {
    /// For each new number the old one.
    pub vertices: Vec<u32>,
    /// For each old number the new one.
    pub vertex_ids: Vec<VertexId>,
    /// For each new number the old one.
    pub tets: Vec<u32>,
    /// For each old number the new one.
    pub tet_ids: Vec<TetId>,
}

impl Numbering {
    /// Vertices along the curve, tetrahedra by their first vertex; what is equal keeps its order.
    pub fn along_curve(team: Team<'_>, points: &[Vec3], tets: &[[u32; 4]]) -> Self {
        let vertices = hilbert::order(team, points.len(), |v| points[v]);
        let vertex_ids = inverse(team, &vertices, points.len(), VertexId);
        let first = |t: usize| tets[t].map(|v| vertex_ids[v as usize].0).into_iter().min().unwrap_or(0);
        let tets = by_first(team, tets.len(), vertices.len(), first);
        let tet_ids = inverse(team, &tets, tets.len(), TetId);
        Self { vertices, vertex_ids, tets, tet_ids }
    }
}

/// Tetrahedra in the order of their first vertex; those without one (`u32::MAX`) are left out.
pub fn by_first(team: Team<'_>, tets: usize, vertices: usize, first: impl Fn(usize) -> u32 + Sync) -> Vec<u32> {
    Rows::by_key(team, vertices, tets, |t| [first(t)]).into_entries()
}

/// For each old number below `bound` its place in an order, as an id; `NONE` for numbers that are not in the order.
pub fn inverse<I: Copy + Send>(team: Team<'_>, order: &[u32], bound: usize, id: impl Fn(u32) -> I + Sync) -> Vec<I> {
    // From 1, and 0 where there is none: zeroed memory costs nothing until it is used.
    let places: Vec<AtomicU32> = bytemuck::allocation::zeroed_vec(bound);
    team.for_each(GRAIN, order.len(), |range| {
        for new in range {
            places[order[new] as usize].store(new as u32 + 1, Relaxed);
        }
    });
    team.map(GRAIN, bound, |old| id(places[old].load(Relaxed).wrapping_sub(1)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    #[test]
    fn numbers_follow_the_curve_and_the_first_vertex() {
        let mesh = cube(3);
        let order = Numbering::along_curve(Team::alone(), &mesh.vertices, &mesh.tets.nodes);
        assert!(order.vertices.iter().zip(0..).all(|(&old, new)| order.vertex_ids[old as usize] == VertexId(new)));
        assert!(order.tets.iter().zip(0..).all(|(&old, new)| order.tet_ids[old as usize] == TetId(new)));
        let first = |&t: &u32| mesh.tets.nodes[t as usize].map(|v| order.vertex_ids[v as usize]).into_iter().min();
        assert!(order.tets.is_sorted_by_key(|t| (first(t), *t)));
        // A second time there is nothing to do.
        let points: Vec<Vec3> = order.vertices.iter().map(|&v| mesh.vertices[v as usize]).collect();
        let same: Vec<u32> = (0..points.len() as u32).collect();
        assert_eq!(Numbering::along_curve(Team::alone(), &points, &[]).vertices, same);
        // Without a first vertex a tetrahedron has no place.
        let kept = by_first(Team::alone(), 5, 3, |t| [2, u32::MAX, 0, 2, 0][t]);
        assert_eq!(kept, [2, 4, 0, 3]);
        assert_eq!(inverse(Team::alone(), &kept, 5, TetId), [2, u32::MAX, 0, 3, 1].map(TetId));
    }
}
