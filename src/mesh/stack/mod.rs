//! Stacks: prisms, pyramids and hexahedra, as solvers want them in layers along walls, beside the tetrahedra of a mesh. They are kept as they
//! are. For all that knows tetrahedra alone they are cut into such, which stand at the end of the mesh's lists ([`Stack::join`]).
//!
//! Nodes are in the order of VTK, CGNS, SU2 and gmsh: the base and then the top, those of a pyramid's base and then its apex. Whether the base is
//! seen clockwise or not is as in the file: programs differ in it.
mod cell;
mod checks;
mod error;
mod outside;
mod sides;

pub use cell::{Cell, Kind};
pub use error::Error;
pub use outside::{Outside, Rejoined};

use super::{Elements, TetMesh};

/// The cells of a mesh that are no tetrahedra, and the quadrilaterals on its boundary.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Stack {
    /// Cells, in the order of their file.
    pub cells: Vec<Cell>,
    /// Quadrilaterals, each a face of a cell; the reference is the patch, as of triangles.
    pub quads: Elements<4>,
    /// How many of the mesh's first tetrahedra and triangles are its own; those behind are cut out of cells and quadrilaterals.
    own: [usize; 2],
}

impl Stack {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty() && self.quads.is_empty()
    }

    /// The number of cells of each kind, in the order of [`Kind::ALL`].
    pub fn counts(&self) -> [usize; 3] {
        Kind::ALL.map(|kind| self.cells_of(kind).count())
    }

    /// What there is, in words: `96 prisms, 4 pyramids`.
    pub fn told(&self) -> String {
        let counts = Kind::ALL.into_iter().zip(self.counts()).filter(|(_, count)| *count > 0);
        let told: Vec<String> = counts.map(|(kind, count)| format!("{count} {}", kind.name(count))).collect();
        told.join(", ")
    }

    /// The cells of a kind.
    pub fn cells_of(&self, kind: Kind) -> impl Iterator<Item = &Cell> {
        self.cells.iter().filter(move |cell| cell.kind == kind)
    }

    /// All nodes of the cells and quadrilaterals.
    pub fn nodes(&self) -> impl Iterator<Item = u32> + '_ {
        self.cells
            .iter()
            .flat_map(|cell| cell.nodes().iter().copied())
            .chain(self.quads.nodes.iter().flatten().copied())
    }

    /// The same to be changed.
    pub fn nodes_mut(&mut self) -> impl Iterator<Item = &mut u32> {
        self.cells.iter_mut().flat_map(|cell| cell.nodes_mut().iter_mut()).chain(self.quads.nodes.iter_mut().flatten())
    }

    /// Cuts the cells into tetrahedra and the quadrilaterals into triangles, which come behind those of the mesh: without new vertices, and such
    /// that they fit together. Each quadrilateral is cut at its lowest vertex, and each cell into the lowest vertex with the triangles of the faces
    /// opposite to it (Dompierre et al., IMR 1999). Returns what the user should know.
    ///
    /// # Errors
    /// What is wrong with the cells, alone or beside the tetrahedra.
    pub fn join(&mut self, mesh: &mut TetMesh) -> Result<Option<String>, Error> {
        if self.is_empty() {
            return Ok(None);
        }
        self.own = [mesh.tets.len(), mesh.triangles.len()];
        let turned = checks::check(self, mesh)?;
        let mut warped = 0;
        for (cell, &turned) in self.cells.iter().zip(&turned) {
            let tets = cell.tets(turned);
            warped += usize::from(tets.iter().any(|nodes| cell::volume(&mesh.vertices, *nodes) <= 0.0));
            tets.into_iter().for_each(|nodes| mesh.tets.push(nodes, cell.reference));
        }
        for (nodes, reference) in self.quads.iter() {
            cell::fan(&nodes).for_each(|triangle| mesh.triangles.push(triangle, reference));
        }
        let told = "cells are warped: cut into tetrahedra, which they are for all but their own file, some of these are negative";
        Ok((warped > 0).then(|| format!("{warped} of {} {told}", self.cells.len())))
    }

    /// The mesh as it was before [`Stack::join`].
    pub fn without(&self, mesh: &TetMesh) -> TetMesh {
        let mut mesh = mesh.clone();
        self.take_off(&mut mesh);
        mesh
    }

    /// Takes what was cut off a mesh.
    pub fn take_off(&self, mesh: &mut TetMesh) {
        let [tets, triangles] = self.own;
        mesh.tets.truncate(tets);
        mesh.triangles.truncate(triangles);
    }

    /// How many of the mesh's tetrahedra and triangles are its own.
    pub fn own(&self) -> [usize; 2] {
        self.own
    }

    /// The number of a mesh's tetrahedra that are its own, with a stack or without.
    pub fn own_tets(&self, mesh: &TetMesh) -> usize {
        if self.is_empty() { mesh.tets.len() } else { self.own[0] }
    }

    /// For each tetrahedron of the mesh the number of its cell: of those of its own, behind which those of the stack come.
    pub fn cells_of_tets(&self, mesh: &TetMesh) -> Vec<u32> {
        let own = self.own_tets(mesh) as u32;
        let pieces = (own..).zip(&self.cells).flat_map(|(number, cell)| (0..cell.kind.pieces()).map(move |_| number));
        (0..own).chain(pieces).collect()
    }

    /// Values of the mesh's own tetrahedra, shape (n, width), followed by those of the cells, as values of all its tetrahedra.
    pub fn spread(&self, mut values: Vec<f64>, width: usize) -> Vec<f64> {
        let of_cells = values.split_off(width * self.own[0]);
        for (cell, row) in self.cells.iter().zip(of_cells.chunks_exact(width)) {
            (0..cell.kind.pieces()).for_each(|_| values.extend_from_slice(row));
        }
        values
    }

    /// The other way: values of all tetrahedra as those of the mesh's own and, the mean of their pieces, of the cells.
    pub fn gather(&self, mut values: Vec<f64>, width: usize) -> Vec<f64> {
        let of_pieces = values.split_off(width * self.own[0]);
        let mut left = &of_pieces[..];
        for cell in &self.cells {
            let count = cell.kind.pieces();
            let (pieces, rest) = left.split_at(width * count);
            values.extend((0..width).map(|k| pieces.iter().skip(k).step_by(width).sum::<f64>() / count as f64));
            left = rest;
        }
        values
    }
}

#[cfg(test)]
mod tests;
