//! What can be wrong with a stack.
use super::Kind;

/// A stack that cannot be. Cells and quadrilaterals count from 1, nodes from 1.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// A node that is not there.
    #[error("it has a vertex that is not there: there are {vertices}")]
    Index {
        /// Which element.
        of: Of,
        /// So many there are.
        vertices: usize,
    },
    /// A node twice.
    #[error("it has vertex {vertex} twice; leave it out, or split it into cells without")]
    Twice {
        /// Which element.
        of: Of,
        /// The vertex.
        vertex: u32,
    },
    /// No volume.
    #[error("it has no volume: its vertices are in another order than this format has, or it is inside out in part")]
    Flat {
        /// Which cell.
        of: Of,
    },
    /// Three cells with the same face.
    #[error("its face of the vertices {} is that of two other cells too; leave one of them out", listed(nodes))]
    Crowded {
        /// Which cell.
        of: Of,
        /// Of the face, from 0.
        nodes: Vec<u32>,
    },
    /// A quadrilateral of no cell.
    #[error("it is the face of no prism, pyramid or hexahedron; leave it out, or split it into triangles")]
    Loose {
        /// Which quadrilateral.
        of: Of,
    },
    /// A quadrilateral against tetrahedra.
    #[error(
        "its quadrilateral of the vertices {} lies against tetrahedra, which share no whole face with it; put a pyramid between",
        listed(nodes)
    )]
    Unmatched {
        /// Which cell.
        of: Of,
        /// Of the face, from 0.
        nodes: Vec<u32>,
    },
}

/// A cell by its kind and its number among all cells, or a quadrilateral, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// A cell.
    Cell(Kind, usize),
    /// A quadrilateral.
    Quad(usize),
}

impl Error {
    /// Which element it is about.
    pub fn place(&self) -> String {
        let (Self::Index { of, .. }
        | Self::Twice { of, .. }
        | Self::Flat { of }
        | Self::Crowded { of, .. }
        | Self::Loose { of }
        | Self::Unmatched { of, .. }) = self;
        match of {
            Of::Cell(kind, at) => format!("cell {} of those that are no tetrahedra, a {}", at + 1, kind.name(1)),
            Of::Quad(at) => format!("quadrilateral {}", at + 1),
        }
    }
}

/// Nodes, from 1.
fn listed(nodes: &[u32]) -> String {
    let nodes: Vec<String> = nodes.iter().map(|v| (v + 1).to_string()).collect();
    nodes.join(" ")
}
