//! The mesh that goes in: slices of the caller's, checked.
use super::Error;
use crate::geometry::classify::Classification;
use crate::mesh::vector::Vec3;
use crate::mesh::{Association, Elements, TetMesh};
use nalgebra::Point3;

/// Tetrahedra are numbered with 30 bits, and their faces with 32.
const MOST_TETS: usize = 1 << 30;

/// A mesh as slices; what may be left out is empty. Nodes count from 0.
///
/// References may be left out: those of tetrahedra are 1 then, all others 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct MeshView<'a> {
    /// Coordinates, shape (n, 3), in the model's units.
    pub vertices: &'a [Vec3],
    /// References of the vertices, shape (n,), or empty.
    pub vertex_refs: &'a [i32],
    /// Tetrahedra, shape (t, 4), each positive: node 3 on the side that the right-hand normal of nodes 0, 1, 2 points to.
    pub tets: &'a [[u32; 4]],
    /// Regions, shape (t,), or empty.
    pub tet_refs: &'a [i32],
    /// Triangles on the boundary and between regions, shape (m, 3); missing ones are added.
    pub triangles: &'a [[u32; 3]],
    /// References of the triangles (surfaces), shape (m,), or empty.
    pub triangle_refs: &'a [i32],
    /// Tagged edges, shape (k, 2): they are ridges.
    pub edges: &'a [[u32; 2]],
    /// References of the edges, shape (k,), or empty.
    pub edge_refs: &'a [i32],
    /// Vertices that are corners of the surface; without a CAD model they stay corners.
    pub corners: &'a [u32],
    /// Vertices that must not move or vanish.
    pub required_vertices: &'a [u32],
    /// Edges that must stay, as indices into `edges`.
    pub required_edges: &'a [u32],
    /// Triangles that must stay, as indices into `triangles`.
    pub required_triangles: &'a [u32],
    /// Which mesh vertices lie on which vertices, edges and faces of a CAD model, as a file would list it. It helps to find the mesh's place.
    pub association: Option<&'a Association>,
    /// Where the boundary lies on the model, of a mesh that came out of the same adapter: then nothing is looked for.
    pub place: Option<&'a Classification>,
}

/// The coordinates of nalgebra's points, as slices have them: nothing is copied.
pub fn coordinates(points: &[Point3<f64>]) -> &[Vec3] {
    bytemuck::cast_slice(points)
}

impl<'a> MeshView<'a> {
    /// Of a mesh.
    pub fn of(mesh: &'a TetMesh) -> Self {
        Self {
            vertices: &mesh.vertices,
            vertex_refs: &mesh.vertex_refs,
            tets: &mesh.tets.nodes,
            tet_refs: &mesh.tets.refs,
            triangles: &mesh.triangles.nodes,
            triangle_refs: &mesh.triangles.refs,
            edges: &mesh.edges.nodes,
            edge_refs: &mesh.edges.refs,
            corners: &mesh.corners,
            required_vertices: &mesh.required_vertices,
            required_edges: &mesh.required_edges,
            required_triangles: &mesh.required_triangles,
            association: Some(&mesh.association),
            place: None,
        }
    }

    /// A copy of the mesh, its place aside: what writing it and the functions of the modules take.
    ///
    /// # Errors
    /// [`Error`], where something is not in range, not finite, or of another length.
    pub fn to_mesh(&self) -> Result<TetMesh, Error> {
        self.mesh()
    }

    /// A copy of the mesh, with everything in range.
    pub(super) fn mesh(&self) -> Result<TetMesh, Error> {
        let vertices = self.vertices.len();
        for (what, found, most) in
            [("vertices", vertices, u32::MAX as usize), ("tetrahedra", self.tets.len(), MOST_TETS - 1)]
        {
            if found > most {
                return Err(Error::TooMany { what, found, most });
            }
        }
        if let Some(vertex) = self.vertices.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            return Err(Error::NotFinite { vertex });
        }
        let each = |what, indices: &[u32], count| in_range(what, indices.iter().map(|&index| [index]), count);
        each("corner", self.corners, vertices)?;
        each("required vertex", self.required_vertices, vertices)?;
        each("required edge", self.required_edges, self.edges.len())?;
        each("required triangle", self.required_triangles, self.triangles.len())?;
        let association = self.association.cloned().unwrap_or_default();
        in_range("association with a vertex", association.vertices.iter().map(|on| [on.vertex]), vertices)?;
        in_range("association with an edge", association.edges.iter().map(|on| [on.vertex]), vertices)?;
        in_range("association with a face", association.faces.iter().map(|on| [on.vertex]), vertices)?;
        Ok(TetMesh {
            vertices: self.vertices.to_vec(),
            vertex_refs: refs("references of vertices", self.vertex_refs, vertices, 0)?,
            edges: elements("edge", "references of edges", self.edges, self.edge_refs, vertices, 0)?,
            triangles: elements(
                "triangle",
                "references of triangles",
                self.triangles,
                self.triangle_refs,
                vertices,
                0,
            )?,
            tets: elements("tetrahedron", "references of tetrahedra", self.tets, self.tet_refs, vertices, 1)?,
            corners: self.corners.to_vec(),
            required_vertices: self.required_vertices.to_vec(),
            ridges: (0..self.edges.len() as u32).collect(),
            required_edges: self.required_edges.to_vec(),
            required_triangles: self.required_triangles.to_vec(),
            association,
        })
    }
}

fn elements<const N: usize>(
    what: &'static str,
    what_refs: &'static str,
    nodes: &[[u32; N]],
    given: &[i32],
    vertices: usize,
    usual: i32,
) -> Result<Elements<N>, Error> {
    in_range(what, nodes.iter().copied(), vertices)?;
    Ok(Elements { nodes: nodes.to_vec(), refs: refs(what_refs, given, nodes.len(), usual)? })
}

fn refs(what: &'static str, given: &[i32], count: usize, usual: i32) -> Result<Vec<i32>, Error> {
    if given.is_empty() {
        return Ok(vec![usual; count]);
    }
    fits(what, given.len(), count)?;
    Ok(given.to_vec())
}

/// Refuses slices of different lengths.
pub fn fits(what: &'static str, found: usize, expected: usize) -> Result<(), Error> {
    if found == expected { Ok(()) } else { Err(Error::Length { what, found, expected }) }
}

/// Refuses elements that refer to what is not there.
pub fn in_range<const N: usize>(
    what: &'static str,
    elements: impl Iterator<Item = [u32; N]>,
    count: usize,
) -> Result<(), Error> {
    for (element, nodes) in elements.enumerate() {
        if let Some(index) = nodes.into_iter().find(|&index| index as usize >= count) {
            return Err(Error::OutOfRange { what, element, index, count });
        }
    }
    Ok(())
}
