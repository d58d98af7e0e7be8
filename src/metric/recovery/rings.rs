//! The neighbours of every vertex over an edge, and the tetrahedra at it.
use crate::mesh::TetMesh;
use crate::mesh::vertex_neighbours::VertexNeighbours;
use crate::tasks::{Rows, Team};

/// Which vertices and tetrahedra are at each vertex.
pub struct Rings {
    neighbours: VertexNeighbours,
    /// 4·tet + corner of the tetrahedra at each vertex.
    corners: Rows,
}

impl Rings {
    /// Of a mesh of fewer than 2³⁰ tetrahedra.
    pub fn of(team: Team<'_>, mesh: &TetMesh) -> Self {
        let tets = &mesh.tets.nodes;
        let corners = Rows::by_key(team, mesh.vertices.len(), tets.len(), |t| tets[t]);
        Self { neighbours: VertexNeighbours::at_corners(team, tets, &corners), corners }
    }

    /// The neighbours over an edge alone.
    pub fn into_neighbours(self) -> VertexNeighbours {
        self.neighbours
    }

    /// The neighbours of all vertices.
    pub fn around(&self) -> &VertexNeighbours {
        &self.neighbours
    }

    /// The vertices that share an edge with this one, ascending.
    #[inline]
    pub fn neighbours(&self, vertex: u32) -> &[u32] {
        self.neighbours.of_vertex(vertex)
    }

    /// The tetrahedra at a vertex.
    #[inline]
    pub fn tets(&self, vertex: u32) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.corners.row(vertex as usize).iter().map(|&corner| corner as usize / 4)
    }

    /// Whether tetrahedra lie all around a vertex. Their faces opposite to it are its link, which is a sphere exactly then. By Euler's formula
    /// a sphere of F triangles has (F + 4)/2 vertices; a link with a border, or in several pieces, has more.
    #[inline]
    pub fn is_inside(&self, vertex: u32) -> bool {
        2 * self.neighbours(vertex).len() == self.corners.row(vertex as usize).len() + 4
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    #[test]
    fn neighbours_and_inside_of_a_cube() {
        let mesh = cube(4);
        let rings = Rings::of(Team::alone(), &mesh);
        let edges = crate::mesh::adjacency::unique_edges(&mesh.tets.nodes);
        for (vertex, p) in (0..).zip(&mesh.vertices) {
            let mut found = rings.neighbours(vertex).to_vec();
            found.sort_unstable();
            let over = |&[a, b]: &[u32; 2]| (a == vertex).then_some(b).or((b == vertex).then_some(a));
            let mut expected: Vec<u32> = edges.iter().filter_map(over).collect();
            expected.sort_unstable();
            assert_eq!(found, expected);
            assert_eq!(rings.is_inside(vertex), p.iter().all(|&x| x > 0.0 && x < 1.0));
        }
    }

    #[test]
    fn a_vertex_where_two_cubes_touch_is_not_inside() {
        // The middle of a cube whose two opposite corner cells are all that is left.
        let mut mesh = cube(2);
        let cells: Vec<[u32; 4]> = mesh
            .tets
            .nodes
            .chunks(6)
            .enumerate()
            .filter(|(cell, _)| [0, 7].contains(cell))
            .flat_map(|(_, tets)| tets.to_vec())
            .collect();
        mesh.tets.refs.truncate(cells.len());
        mesh.tets.nodes = cells;
        let rings = Rings::of(Team::alone(), &mesh);
        assert!((0..27).all(|vertex| !rings.is_inside(vertex)));
    }
}
