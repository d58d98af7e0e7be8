//! What a file of another program carries: a mesh, the names of its references, and fields at its vertices.
use crate::geometry::Names;
use crate::mesh::TetMesh;
use crate::mesh::io::{FieldKind, Solution, SolutionField};
use crate::mesh::stack::Stack;
use std::borrow::Cow;

/// A field with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedField {
    /// As the file calls it: `Mach`, `p`.
    pub name: String,
    /// What it holds.
    pub kind: FieldKind,
    /// Values at the vertices, shape (vertices, values of the kind), row by row; symmetric tensors 11 12 22 13 23 33.
    pub values: Vec<f64>,
}

/// A mesh with the names of its references, and the fields at its vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dataset {
    /// The mesh. What was cut out of the stack stands at the end of its tetrahedra and triangles.
    pub mesh: TetMesh,
    /// Its cells that are no tetrahedra, joined to it.
    pub stack: Stack,
    /// What its references are called.
    pub names: Names,
    /// Fields, in the order of the file.
    pub fields: Vec<NamedField>,
}

impl Dataset {
    /// The same without what was cut out of the stack, as a file has it.
    pub fn as_written(&self) -> Cow<'_, Self> {
        if self.stack.is_empty() {
            return Cow::Borrowed(self);
        }
        let mut bare = self.clone();
        bare.stack.take_off(&mut bare.mesh);
        Cow::Owned(bare)
    }

    /// The number of the mesh's tetrahedra that are its own.
    pub(super) fn own_tets(&self) -> usize {
        self.stack.own_tets(&self.mesh)
    }

    /// The fields without their names, as .sol and .solb carry them.
    pub fn solution(&self) -> Solution {
        let fields = self.fields.iter();
        let fields = fields.map(|field| SolutionField { kind: field.kind, values: field.values.clone() }).collect();
        Solution { vertices: self.mesh.vertices.len(), fields }
    }
}
