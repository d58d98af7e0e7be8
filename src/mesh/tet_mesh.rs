//! The mesh as arrays.
use super::vector::Vec3;
use std::collections::BTreeMap;

/// Elements of N nodes each, with a reference (tag) each. Node indices count from 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Elements<const N: usize> {
    /// Node indices of each element, shape (n, N), from 0.
    pub nodes: Vec<[u32; N]>,
    /// Reference of each element, shape (n,).
    pub refs: Vec<i32>,
}

impl<const N: usize> Default for Elements<N> {
    fn default() -> Self {
        Self { nodes: Vec::new(), refs: Vec::new() }
    }
}

impl<const N: usize> Elements<N> {
    /// Number of elements.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there is no element.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Appends an element.
    pub fn push(&mut self, nodes: [u32; N], reference: i32) {
        self.nodes.push(nodes);
        self.refs.push(reference);
    }

    /// Keeps the first elements, so many.
    pub fn truncate(&mut self, count: usize) {
        self.nodes.truncate(count);
        self.refs.truncate(count);
    }

    /// Elements with their references.
    pub fn iter(&self) -> impl Iterator<Item = ([u32; N], i32)> + '_ {
        self.nodes.iter().copied().zip(self.refs.iter().copied())
    }
}

/// A mesh vertex on a vertex of the model (libMeshb keyword 40).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnVertex {
    /// Mesh vertex, from 0.
    pub vertex: u32,
    /// Vertex of the model, from 1 as in the file.
    pub id: i32,
}

/// A mesh vertex on an edge of the model (libMeshb keyword 41).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnEdge {
    /// Mesh vertex, from 0.
    pub vertex: u32,
    /// Edge of the model, from 1 as in the file.
    pub id: i32,
    /// Parameter on the edge's curve.
    pub t: f64,
    /// The file's fourth value: a distance by libMeshb, an id by refine. Carried, not used.
    pub r: f64,
}

/// A mesh vertex on a face of the model (libMeshb keyword 42).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnFace {
    /// Mesh vertex, from 0.
    pub vertex: u32,
    /// Face of the model, from 1 as in the file.
    pub id: i32,
    /// Parameters on the face's surface.
    pub uv: [f64; 2],
    /// The file's last value, carried, not used.
    pub r: f64,
}

/// Which vertices lie on which entities of a CAD model, as libMeshb files carry it. A vertex may be
/// listed several times (on an edge, and on the faces beside it).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Association {
    /// Vertices on model vertices.
    pub vertices: Vec<OnVertex>,
    /// Vertices on model edges.
    pub edges: Vec<OnEdge>,
    /// Vertices on model faces.
    pub faces: Vec<OnFace>,
}

impl Association {
    /// Whether nothing is associated.
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty() && self.edges.is_empty() && self.faces.is_empty()
    }
}

/// A tetrahedral mesh with tagged edges, triangles and regions. All indices count from 0; a
/// tetrahedron (a, b, c, d) is positive when d lies on the side that the right-hand normal of (a, b, c) points to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TetMesh {
    /// Coordinates, shape (n, 3), in the model's units.
    pub vertices: Vec<Vec3>,
    /// Reference of each vertex, shape (n,).
    pub vertex_refs: Vec<i32>,
    /// Tagged edges (ridges, CAD edges).
    pub edges: Elements<2>,
    /// Boundary and interface triangles; the reference is the patch or the number of the CAD face, from 1.
    pub triangles: Elements<3>,
    /// Tetrahedra; the reference is the region.
    pub tets: Elements<4>,
    /// Vertices that are corners.
    pub corners: Vec<u32>,
    /// Vertices that must not move or vanish.
    pub required_vertices: Vec<u32>,
    /// Indices into `edges` of ridges.
    pub ridges: Vec<u32>,
    /// Indices into `edges` of edges that must stay.
    pub required_edges: Vec<u32>,
    /// Indices into `triangles` of triangles that must stay.
    pub required_triangles: Vec<u32>,
    /// Association with a CAD model.
    pub association: Association,
}

impl TetMesh {
    /// Makes these the edges of the mesh, all of them ridges, followed by the required edges that are not among them, each
    /// with its reference. What was required stays required. Returns how many edges follow the ridges.
    pub fn replace_edges(&mut self, ridges: impl Iterator<Item = ([u32; 2], i32)>) -> usize {
        let sorted = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
        let old = std::mem::take(&mut self.edges);
        let required = std::mem::take(&mut self.required_edges);
        let mut open: BTreeMap<[u32; 2], i32> =
            required.iter().map(|&e| (sorted(old.nodes[e as usize]), old.refs[e as usize])).collect();
        for (nodes, reference) in ridges {
            if open.remove(&sorted(nodes)).is_some() {
                self.required_edges.push(self.edges.len() as u32);
            }
            self.edges.push(nodes, reference);
        }
        self.ridges = (0..self.edges.len() as u32).collect();
        for (&nodes, &reference) in &open {
            self.required_edges.push(self.edges.len() as u32);
            self.edges.push(nodes, reference);
        }
        open.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn required_edges_outlive_a_change_of_the_ridges() {
        let edges = Elements { nodes: vec![[0, 1], [3, 2], [1, 2], [0, 3]], refs: vec![5, 6, 7, 8] };
        let mut mesh = TetMesh { edges, required_edges: vec![1, 2], ..TetMesh::default() };
        assert_eq!(mesh.replace_edges([([4, 5], 1), ([2, 1], 2)].into_iter()), 1);
        assert_eq!(mesh.edges, Elements { nodes: vec![[4, 5], [2, 1], [2, 3]], refs: vec![1, 2, 6] });
        assert_eq!((mesh.ridges, mesh.required_edges), (vec![0, 1], vec![1, 2]));
    }
}
