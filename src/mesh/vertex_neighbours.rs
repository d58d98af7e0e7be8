//! The vertices at the other ends of the edges of each vertex.
use super::TetMesh;
use super::stamped_set::StampedSet;
use crate::tasks::{GRAIN, Rows, Team};

/// For each vertex the vertices that it has an edge with, ascending; 60 bytes a vertex.
pub struct VertexNeighbours(Rows);

impl VertexNeighbours {
    /// By the edges of a mesh's tetrahedra, or of its triangles where it has no tetrahedron.
    pub fn of_mesh(team: Team<'_>, mesh: &TetMesh) -> Self {
        let vertices = mesh.vertices.len();
        if mesh.tets.is_empty() {
            Self::of(team, &mesh.triangles.nodes, vertices)
        } else {
            Self::of(team, &mesh.tets.nodes, vertices)
        }
    }

    /// In a mesh of so many vertices, with elements that have fewer than 2³² corners in all.
    pub fn of<const N: usize>(team: Team<'_>, elements: &[[u32; N]], vertices: usize) -> Self {
        Self::at_corners(team, elements, &Rows::by_key(team, vertices, elements.len(), |e| elements[e]))
    }

    /// As [`VertexNeighbours::of`], with the corners at each vertex, N·element + corner.
    pub fn at_corners<const N: usize>(team: Team<'_>, elements: &[[u32; N]], corners: &Rows) -> Self {
        let vertices = corners.len();
        let parts = team.chunks(GRAIN, vertices, |range| {
            let (mut seen, mut ends) = (StampedSet::default(), Vec::with_capacity(range.len()));
            // Half as many and two for a vertex inside a mesh of tetrahedra, by Euler's formula; a few more where it is not.
            let at: usize = range.clone().map(|vertex| corners.row(vertex).len()).sum();
            let mut found: Vec<u32> = Vec::with_capacity(at / 2 + 3 * range.len());
            for vertex in range {
                let start = found.len();
                seen.clear();
                seen.insert(vertex as u32);
                let nodes = corners.row(vertex).iter().flat_map(|&corner| elements[corner as usize / N]);
                found.extend(nodes.filter(|&node| seen.insert(node)));
                found[start..].sort_unstable();
                ends.push(found.len() as u32);
            }
            (ends, found)
        });
        Self(Rows::of_parts(team, &parts))
    }

    /// Of rows that are known, each ascending.
    pub fn of_rows(rows: Rows) -> Self {
        Self(rows)
    }

    /// The neighbours of a vertex.
    #[inline]
    pub fn of_vertex(&self, vertex: u32) -> &[u32] {
        self.0.row(vertex as usize)
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there is no vertex.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

#[cfg(test)]
mod tests {
    use super::super::adjacency::unique_edges;
    use super::super::samples::cube;
    use super::*;

    #[test]
    fn a_surface_has_the_edges_of_its_triangles() {
        let mut mesh = cube(2);
        mesh.tets = Default::default();
        let around = VertexNeighbours::of_mesh(Team::alone(), &mesh);
        let mut edges: Vec<[u32; 2]> = Vec::new();
        for &[a, b, c] in &mesh.triangles.nodes {
            edges.extend([[a, b], [b, a], [b, c], [c, b], [c, a], [a, c]]);
        }
        edges.sort_unstable();
        edges.dedup();
        let rows = (0..mesh.vertices.len() as u32).flat_map(|v| around.of_vertex(v).iter().map(move |&w| [v, w]));
        assert_eq!(rows.collect::<Vec<_>>(), edges);
    }

    #[test]
    fn each_edge_is_seen_from_both_ends() {
        let mesh = cube(3);
        // One vertex more, which no tetrahedron has.
        let around = VertexNeighbours::of(Team::alone(), &mesh.tets.nodes, mesh.vertices.len() + 1);
        assert_eq!(around.len(), mesh.vertices.len() + 1);
        assert!(around.of_vertex(mesh.vertices.len() as u32).is_empty());
        let mut edges = Vec::new();
        for vertex in 0..mesh.vertices.len() as u32 {
            let row = around.of_vertex(vertex);
            assert!(row.is_sorted());
            edges.extend(row.iter().map(|&other| [vertex, other]));
        }
        let unique = unique_edges(&mesh.tets.nodes);
        assert_eq!(edges.len(), 2 * unique.len());
        let lower: Vec<_> = edges.into_iter().filter(|[a, b]| a < b).collect();
        assert_eq!(lower, unique);
    }
}
