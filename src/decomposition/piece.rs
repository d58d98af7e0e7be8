//! Some of a mesh, with all that is known there.
use crate::geometry::classify::Classification;
use crate::mesh::TetMesh;
use crate::metric::Sym3;

/// What is known of a vertex of a piece.
pub type Marks = u8;

/// Another piece may have the vertex too.
pub const SHARED: Marks = 1;

/// A cut went through the vertex, and what is about it is to be looked at again.
pub const WAITING: Marks = 2;

/// Some of a mesh, with all that is known there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Piece {
    /// The mesh. Of its edges it has those that are required, of its triangles all that it has a tetrahedron of; these look outwards, between
    /// regions out of the lesser one.
    pub mesh: TetMesh,
    /// Where it lies on the model.
    pub place: Classification,
    /// ln M at the vertices.
    pub logs: Vec<Sym3>,
    /// What each vertex is called in all pieces, and in all rounds.
    pub ids: Vec<u64>,
    /// What is known of each vertex.
    pub marks: Vec<Marks>,
    /// For each triangle whether another piece has it too, since it lies between regions. Both have its nodes in the same order.
    pub halves: Vec<bool>,
    /// Faces that are cuts, by their nodes, ascending: behind each is a tetrahedron of another piece that is not finished either. There may be
    /// faces among them that have both of their tetrahedra here again.
    pub cuts: Vec<[u32; 3]>,
}

impl Piece {
    /// Tetrahedra.
    pub fn len(&self) -> usize {
        self.mesh.tets.len()
    }

    /// Multiplies M by e^`log_factor`.
    pub fn scale(&mut self, log_factor: f64) {
        self.logs.iter_mut().for_each(|log| *log = log.plus_identity(log_factor));
    }

    /// Whether a tetrahedron has a vertex that waits.
    pub fn waits(&self, t: usize) -> bool {
        self.mesh.tets.nodes[t].iter().any(|&v| self.marks[v as usize] & WAITING != 0)
    }
}
