//! The vertices at the other ends of the edges of each vertex.
use super::TetMesh;
use super::adjacency::Edges;
use crate::tasks::{Buckets, GRAIN, Team};

/// For each vertex those it has an edge with, ascending; 60 bytes a vertex.
pub struct VertexNeighbours {
    /// Where the row of each vertex begins, and the end of the last: shape (n + 1,).
    starts: Vec<u32>,
    neighbours: Vec<u32>,
}

impl VertexNeighbours {
    /// By the edges of a mesh's tetrahedra, or of its triangles where it has no tetrahedron.
    pub fn of_mesh(team: Team<'_>, mesh: &TetMesh) -> Self {
        if !mesh.tets.is_empty() {
            return Self::of(team, &mesh.tets.nodes, mesh.vertices.len());
        }
        let mut edges = team.collect(GRAIN, mesh.triangles.len(), |range, found| {
            for &[a, b, c] in &mesh.triangles.nodes[range] {
                found.extend([[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]));
            }
        });
        // Equal ones are beside each other then, whatever their order was.
        team.sort_by(&mut edges, Ord::cmp);
        edges.dedup();
        Self::of_edges(team, &edges, mesh.vertices.len())
    }

    /// In a mesh of so many vertices, with tetrahedra of fewer than 2³¹ edges in all.
    pub fn of(team: Team<'_>, tets: &[[u32; 4]], vertices: usize) -> Self {
        let edges = Edges::of(team, tets);
        let edges: Vec<[u32; 2]> =
            team.collect(GRAIN, edges.nodes(), |range, found| edges.for_each(range, |edge| found.push(edge)));
        Self::of_edges(team, &edges, vertices)
    }

    /// By these edges, each once, sorted.
    fn of_edges(team: Team<'_>, edges: &[[u32; 2]], vertices: usize) -> Self {
        // The edges are sorted by their lower ends, then by their upper ones: so an ascending row of edges is one of neighbours.
        let rows = Buckets::of(team, vertices, edges.len(), |edge| edges[edge]);
        let mut end = 0;
        let ends = (0..vertices).map(|vertex| {
            end += rows.of_key(vertex).len() as u32;
            end
        });
        let starts = std::iter::once(0).chain(ends).collect();
        let entries = rows.into_entries();
        let other = |place: usize| edges[entries[place] as usize / 2][1 - entries[place] as usize % 2];
        Self { starts, neighbours: team.map(GRAIN, entries.len(), other) }
    }

    /// The neighbours of a vertex.
    #[inline]
    pub fn of_vertex(&self, vertex: u32) -> &[u32] {
        let [start, end] = [0, 1].map(|i| self.starts[vertex as usize + i] as usize);
        &self.neighbours[start..end]
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
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
