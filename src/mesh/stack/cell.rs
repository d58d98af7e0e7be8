//! A cell, and how it is cut.
use crate::mesh::vector::{Vec3, volume6};

/// What a cell is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// A quadrilateral and an apex.
    Pyramid,
    /// A triangle and another above it.
    Prism,
    /// A quadrilateral and another above it.
    Hexahedron,
}

/// Most nodes of a cell.
const MOST: usize = 8;

impl Kind {
    /// All of them, as UGRID has them.
    pub const ALL: [Self; 3] = [Self::Pyramid, Self::Prism, Self::Hexahedron];

    /// Number of nodes.
    pub fn corners(self) -> usize {
        match self {
            Self::Pyramid => 5,
            Self::Prism => 6,
            Self::Hexahedron => 8,
        }
    }

    /// Number of the tetrahedra that a cell is cut into.
    pub fn pieces(self) -> usize {
        match self {
            Self::Pyramid => 2,
            Self::Prism => 3,
            Self::Hexahedron => 6,
        }
    }

    /// What one or several are called.
    pub fn name(self, count: usize) -> &'static str {
        match (self, count) {
            (Self::Pyramid, 1) => "pyramid",
            (Self::Pyramid, _) => "pyramids",
            (Self::Prism, 1) => "prism",
            (Self::Prism, _) => "prisms",
            (Self::Hexahedron, 1) => "hexahedron",
            (Self::Hexahedron, _) => "hexahedra",
        }
    }

    /// The places of the nodes of its faces, normals outwards where the base is seen counterclockwise from the top.
    pub fn faces(self) -> &'static [&'static [usize]] {
        match self {
            Self::Pyramid => &[&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
            Self::Prism => &[&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]],
            Self::Hexahedron => {
                &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]]
            }
        }
    }
}

/// A cell with its reference, the region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// What it is.
    pub kind: Kind,
    /// The region.
    pub reference: i32,
    /// Behind its last node there is none.
    nodes: [u32; MOST],
}

impl Cell {
    /// A cell of as many nodes as its kind has.
    ///
    /// # Panics
    /// When there are others.
    pub fn new(kind: Kind, nodes: &[u32], reference: i32) -> Self {
        assert_eq!(nodes.len(), kind.corners(), "nodes of a {}", kind.name(1));
        let mut all = [u32::MAX; MOST];
        all[..nodes.len()].copy_from_slice(nodes);
        Self { kind, reference, nodes: all }
    }

    /// Its nodes, from 0.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes[..self.kind.corners()]
    }

    /// The same to be changed.
    pub fn nodes_mut(&mut self) -> &mut [u32] {
        &mut self.nodes[..self.kind.corners()]
    }

    /// The nodes of its faces.
    pub fn faces(&self) -> impl Iterator<Item = Vec<u32>> + '_ {
        self.kind.faces().iter().map(|face| face.iter().map(|&i| self.nodes[i]).collect())
    }

    /// The same, normals outwards.
    pub fn outward_faces(&self, points: &[Vec3]) -> impl Iterator<Item = Vec<u32>> + '_ {
        let turned = self.volume(points) < 0.0;
        self.faces().map(move |mut face| {
            if turned {
                face.reverse();
            }
            face
        })
    }

    /// Six times its volume, negative where its base is seen clockwise from the top.
    pub(super) fn volume(&self, points: &[Vec3]) -> f64 {
        self.tets(false).into_iter().map(|nodes| volume(points, nodes)).sum()
    }

    /// The tetrahedra that it is cut into, negative where its base is seen clockwise from the top, but for `turned`.
    pub fn tets(&self, turned: bool) -> Vec<[u32; 4]> {
        let lowest = self.nodes().iter().copied().min().unwrap_or_default();
        let opposite = self.faces().filter(|face| !face.contains(&lowest));
        let tets = opposite.flat_map(|face| fan(&face).collect::<Vec<_>>());
        tets.map(|[a, b, c]| if turned { [a, b, c, lowest] } else { [a, c, b, lowest] }).collect()
    }
}

/// The triangles that a face is cut into, all with its lowest node.
pub(super) fn fan(face: &[u32]) -> impl Iterator<Item = [u32; 3]> + use<> {
    let count = face.len();
    let first = (1..count).fold(0, |least, i| if face[i] < face[least] { i } else { least });
    let rotated: Vec<u32> = (0..count).map(|i| face[(first + i) % count]).collect();
    (1..count - 1).map(move |i| [rotated[0], rotated[i], rotated[i + 1]])
}

/// Six times the volume of a tetrahedron.
pub(super) fn volume(points: &[Vec3], nodes: [u32; 4]) -> f64 {
    let [a, b, c, d] = nodes.map(|v| points[v as usize]);
    volume6(a, b, c, d)
}
