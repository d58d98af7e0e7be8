//! Ids of the store's vertices and tetrahedra.
use bytemuck::Zeroable;

/// A vertex of the [`super::store::Store`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Zeroable)]
pub struct VertexId(pub u32);

/// A tetrahedron of the [`super::store::Store`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Zeroable)]
pub struct TetId(pub u32);

impl VertexId {
    /// No vertex.
    pub const NONE: Self = Self(u32::MAX);

    /// As an array index.
    #[inline(always)]
    pub fn index(self) -> usize {
        self.0 as usize
    }

    /// Whether it is a vertex.
    #[inline(always)]
    pub fn is_some(self) -> bool {
        self.0 != u32::MAX
    }
}

impl TetId {
    /// No tetrahedron: what lies beyond the boundary.
    pub const NONE: Self = Self(u32::MAX);

    /// As an array index.
    #[inline(always)]
    pub fn index(self) -> usize {
        self.0 as usize
    }

    /// Whether it is a tetrahedron.
    #[inline(always)]
    pub fn is_some(self) -> bool {
        self.0 != u32::MAX
    }
}

/// Local vertices of the face opposite to local vertex i, in the order that makes (face, vertex i) a
/// positive tetrahedron; reversed, the face's normal points out of the tetrahedron.
pub const FACE: [[usize; 3]; 4] = [[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]];

/// Local vertices of the six edges.
pub const EDGE: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// For an edge from local vertex i to j: the other two, k and l, such that (i, j, k, l) is a positive order.
pub const ACROSS: [[[usize; 2]; 4]; 4] = [
    [[0, 0], [2, 3], [3, 1], [1, 2]],
    [[3, 2], [0, 0], [0, 3], [2, 0]],
    [[1, 3], [3, 0], [0, 0], [0, 1]],
    [[2, 1], [0, 2], [1, 0], [0, 0]],
];

/// Which of a tetrahedron's four vertices or neighbours one is; 0 where it is none of them. There is no branch, since which it is cannot be
/// foreseen.
#[inline(always)]
pub fn place_of<T: Copy + PartialEq>(wanted: T, of: [T; 4]) -> usize {
    usize::from(of[1] == wanted) | usize::from(of[2] == wanted) << 1 | (usize::from(of[3] == wanted) * 3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::vector::volume6;

    const CORNERS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    #[test]
    fn faces_see_their_vertex_on_the_positive_side() {
        for (i, [a, b, c]) in FACE.into_iter().enumerate() {
            assert!(volume6(CORNERS[a], CORNERS[b], CORNERS[c], CORNERS[i]) > 0.0, "face {i}");
        }
    }

    #[test]
    fn each_of_four_has_its_place() {
        assert_eq!([5, 2, 9, 7].map(|x| place_of(x, [5, 2, 9, 7])), [0, 1, 2, 3]);
        assert_eq!(place_of(4, [5, 2, 9, 7]), 0);
    }

    #[test]
    fn edges_have_their_opposite_edge_in_positive_order() {
        for i in 0..4 {
            for j in (0..4).filter(|&j| j != i) {
                let [k, l] = ACROSS[i][j];
                assert!(volume6(CORNERS[i], CORNERS[j], CORNERS[k], CORNERS[l]) > 0.0, "edge {i}{j}");
            }
        }
    }
}
