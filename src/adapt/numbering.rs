//! An order of the vertices and tetrahedra in which what is near in space is near in memory.
use super::ids::{TetId, VertexId};
use crate::mesh::hilbert;
use crate::mesh::vector::Vec3;

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
    pub fn along_curve(points: &[Vec3], tets: &[[u32; 4]]) -> Self {
        let vertices = hilbert::order(points);
        let mut vertex_ids = vec![VertexId::NONE; vertices.len()];
        vertices.iter().zip(0..).for_each(|(&old, new)| vertex_ids[old as usize] = VertexId(new));
        let first = |t: usize| tets[t].map(|v| vertex_ids[v as usize].0).into_iter().min().unwrap_or(0);
        let (tets, tet_ids) = by_first(tets.len(), vertices.len(), first);
        Self { vertices, vertex_ids, tets, tet_ids }
    }
}

/// Tetrahedra in the order of their first vertex, and their new numbers: a counting sort.
pub fn by_first(tets: usize, vertices: usize, first: impl Fn(usize) -> u32) -> (Vec<u32>, Vec<TetId>) {
    let mut starts = vec![0u32; vertices + 1];
    let mut ids: Vec<TetId> = (0..tets).map(|t| TetId(first(t))).collect();
    ids.iter().for_each(|first| starts[first.index() + 1] += 1);
    for v in 1..starts.len() {
        starts[v] += starts[v - 1];
    }
    let mut order = vec![0u32; tets];
    for (t, id) in ids.iter_mut().enumerate() {
        let start = &mut starts[id.index()];
        order[*start as usize] = t as u32;
        *id = TetId(*start);
        *start += 1;
    }
    (order, ids)
}

/// Brings records into an order, by swaps: what is at `order[i]` comes to i.
pub fn permute(mut order: Vec<u32>, mut swap: impl FnMut(usize, usize)) {
    for start in 0..order.len() {
        let mut at = start;
        loop {
            let from = std::mem::replace(&mut order[at], at as u32) as usize;
            if from == start {
                break;
            }
            swap(at, from);
            at = from;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    #[test]
    fn records_come_into_their_order() {
        for order in [vec![0, 1, 2], vec![3, 0, 1, 2, 4], vec![1, 0, 5, 2, 4, 3]] {
            let mut records: Vec<u32> = (0..order.len() as u32).collect();
            permute(order.clone(), |i, j| records.swap(i, j));
            assert_eq!(records, order);
        }
    }

    #[test]
    fn numbers_follow_the_curve_and_the_first_vertex() {
        let mesh = cube(3);
        let order = Numbering::along_curve(&mesh.vertices, &mesh.tets.nodes);
        assert!(order.vertices.iter().zip(0..).all(|(&old, new)| order.vertex_ids[old as usize] == VertexId(new)));
        assert!(order.tets.iter().zip(0..).all(|(&old, new)| order.tet_ids[old as usize] == TetId(new)));
        let first = |&t: &u32| mesh.tets.nodes[t as usize].map(|v| order.vertex_ids[v as usize]).into_iter().min();
        assert!(order.tets.is_sorted_by_key(|t| (first(t), *t)));
        // A second time there is nothing to do.
        let points: Vec<Vec3> = order.vertices.iter().map(|&v| mesh.vertices[v as usize]).collect();
        let same: Vec<u32> = (0..points.len() as u32).collect();
        assert_eq!(Numbering::along_curve(&points, &[]).vertices, same);
    }
}
