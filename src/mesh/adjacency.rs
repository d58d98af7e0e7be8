//! Neighbours of tetrahedra, triangles among their faces, and unique edges of a plain mesh.
pub use super::matched_faces::{MatchedFaces, OverSharedFace};
use crate::tasks::{GRAIN, Rows, Team};
use std::ops::Range;

/// No neighbour: the face is on the boundary.
pub const NONE: u32 = u32::MAX;

/// The nodes of face i of a tetrahedron, which is opposite to node i; ordered so that the normal points outwards.
pub const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// The nodes of the six edges of a tetrahedron.
pub const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// A face of a tetrahedron, by its sorted nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FaceKey {
    /// Nodes, ascending.
    pub nodes: [u32; 3],
    /// 4·tet + face.
    pub side: u32,
}

/// Two node numbers, ascending.
#[inline(always)]
pub fn sorted2([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Three node numbers, ascending.
#[inline(always)]
pub fn sorted3([a, b, c]: [u32; 3]) -> [u32; 3] {
    let (a, b) = if a < b { (a, b) } else { (b, a) };
    let (b, c) = if b < c { (b, c) } else { (c, b) };
    if a < b { [a, b, c] } else { [b, a, c] }
}

/// All faces of the tetrahedra, sorted by their nodes: equal faces are next to each other.
pub fn sorted_faces(tets: &[[u32; 4]]) -> Vec<FaceKey> {
    let mut keys = Vec::with_capacity(4 * tets.len());
    for (t, nodes) in tets.iter().enumerate() {
        for (f, face) in FACES.iter().enumerate() {
            keys.push(FaceKey { nodes: sorted3(face.map(|i| nodes[i])), side: (4 * t + f) as u32 });
        }
    }
    keys.sort_unstable();
    keys
}

/// The neighbour across each face, shape (n, 4); [`NONE`] on the boundary. Of a face of more than two tetrahedra the
/// first two are neighbours.
pub fn neighbours(tets: &[[u32; 4]]) -> Vec<[u32; 4]> {
    MatchedFaces::of(Team::alone(), tets).neighbours
}

/// The triangles of a mesh by their nodes.
pub struct TriangleIndex {
    /// Sorted nodes and triangle, in increasing order.
    triangles: Vec<([u32; 3], u32)>,
    /// Whether a vertex is one of a triangle's.
    on_surface: Vec<bool>,
}

impl TriangleIndex {
    /// Of triangles on so many vertices.
    pub fn new(team: Team<'_>, triangles: &[[u32; 3]], vertices: usize) -> Self {
        let mut index = Self {
            triangles: triangles.iter().map(|&nodes| sorted3(nodes)).zip(0..).collect(),
            on_surface: vec![false; vertices],
        };
        team.sort(&mut index.triangles);
        triangles.iter().flatten().for_each(|&v| index.on_surface[v as usize] = true);
        index
    }

    /// The triangles of these nodes, in any order.
    pub fn find(&self, nodes: [u32; 3]) -> impl Iterator<Item = u32> + '_ {
        let key = sorted3(nodes);
        let first = self.triangles.partition_point(|triangle| triangle.0 < key);
        self.triangles[first..].iter().take_while(move |triangle| triangle.0 == key).map(|triangle| triangle.1)
    }

    /// The faces of tetrahedra that are triangles, in the order of the tetrahedra.
    pub fn sides(&self, team: Team<'_>, tets: &[[u32; 4]]) -> Vec<Side> {
        team.collect(GRAIN, tets.len(), |range, sides| {
            for tet in range {
                let nodes = tets[tet];
                let on = nodes.map(|v| self.on_surface[v as usize]);
                // Most tetrahedra are far from the surface.
                if on.into_iter().map(u8::from).sum::<u8>() < 3 {
                    continue;
                }
                for (k, face) in FACES.iter().enumerate().filter(|(_, face)| face.iter().all(|&i| on[i])) {
                    let side = |triangle| Side { triangle, tet: tet as u32, face: k as u32 };
                    sides.extend(self.find(face.map(|i| nodes[i])).map(side));
                }
            }
        })
    }
}

/// A triangle as a face of a tetrahedron.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Side {
    /// The triangle.
    pub triangle: u32,
    /// The tetrahedron.
    pub tet: u32,
    /// Number of the face there.
    pub face: u32,
}

/// The edges of the tetrahedra, each once, lower node first, sorted.
pub fn unique_edges(tets: &[[u32; 4]]) -> Vec<[u32; 2]> {
    let edges = Edges::of(Team::alone(), tets);
    let mut found = Vec::new();
    edges.for_each(0..edges.nodes(), |edge| found.push(edge));
    found
}

/// Edges that were met last are kept to be known again.
const MET: usize = 1 << 10;

/// The edges of tetrahedra, known by their lower nodes.
pub struct Edges<'t> {
    tets: &'t [[u32; 4]],
    /// For each node the tetrahedra in which it is not the greatest: 12 bytes a tetrahedron.
    at: Rows,
    nodes: usize,
}

impl<'t> Edges<'t> {
    /// Of tetrahedra, fewer than 2³⁰.
    pub fn of(team: Team<'_>, tets: &'t [[u32; 4]]) -> Self {
        let greatest = |range: Range<usize>| tets[range].iter().flatten().max().copied();
        let greatest = team.chunks(GRAIN, tets.len(), greatest).into_iter().max().flatten();
        let nodes = greatest.map_or(0, |greatest| greatest as usize + 1);
        let at = Rows::by_key(team, nodes, tets.len(), |t| {
            let greatest = tets[t].into_iter().max().unwrap_or(0);
            tets[t].map(|v| if v < greatest { v } else { Rows::NOWHERE })
        });
        Self { tets, at, nodes }
    }

    /// The nodes are less than this.
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// Calls `f` with the edges whose lower node is in the range, each once, in the order of their nodes.
    pub fn for_each(&self, range: Range<usize>, mut f: impl FnMut([u32; 2])) {
        let mut upper: Vec<u32> = Vec::new();
        let mut met = [u64::MAX; MET];
        for low in range {
            let row = self.at.row(low);
            upper.clear();
            upper.resize(4 * row.len(), 0);
            // What is greater and what is met again comes in no order: all is written, and the place taken back if it is not new.
            let mut count = 0;
            for &entry in row {
                for high in self.tets[entry as usize / 4] {
                    let (edge, known) = ((low as u64) << 32 | u64::from(high), &mut met[high as usize % MET]);
                    upper[count] = high;
                    count += usize::from((high as usize > low) & (*known != edge));
                    *known = edge;
                }
            }
            let upper = &mut upper[..count];
            upper.sort_unstable();
            // Two nodes with one place among those that were met last come again.
            for (at, &high) in upper.iter().enumerate() {
                if at == 0 || upper[at - 1] != high {
                    f([low as u32, high]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples::cube;
    use super::*;

    #[test]
    fn faces_point_outwards() {
        use crate::mesh::vector::volume6;
        let p = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for (opposite, face) in FACES.iter().enumerate() {
            assert!(volume6(p[face[0]], p[face[1]], p[face[2]], p[opposite]) < 0.0);
        }
    }

    #[test]
    fn neighbours_of_a_cube() {
        let mesh = cube(3);
        let around = neighbours(&mesh.tets.nodes);
        let open = around.iter().flatten().filter(|&&t| t == NONE).count();
        assert_eq!(open, 6 * 9 * 2);
        for (t, faces) in around.iter().enumerate() {
            for (f, &other) in faces.iter().enumerate().filter(|(_, other)| **other != NONE) {
                let face = sorted3(FACES[f].map(|i| mesh.tets.nodes[t][i]));
                let back = around[other as usize].iter().position(|&back| back == t as u32).unwrap();
                assert_eq!(face, sorted3(FACES[back].map(|i| mesh.tets.nodes[other as usize][i])));
            }
        }
    }

    #[test]
    fn edges_of_a_cube() {
        // Euler: V − E + F − T = 1; F = (4T + boundary)/2.
        let mesh = cube(3);
        let (v, t) = (mesh.vertices.len(), mesh.tets.len());
        let f = (4 * t + mesh.triangles.len()) / 2;
        let edges = unique_edges(&mesh.tets.nodes);
        assert_eq!(edges.len(), v + f - t - 1);
        assert!(edges.is_sorted() && edges.iter().all(|[low, high]| low < high));
        let ends = |nodes: &[u32; 4]| EDGES.map(|[i, j]| [nodes[i].min(nodes[j]), nodes[i].max(nodes[j])]);
        let all: std::collections::BTreeSet<[u32; 2]> = mesh.tets.nodes.iter().flat_map(ends).collect();
        assert!(edges.into_iter().eq(all));
        assert!(unique_edges(&[]).is_empty());
        for nodes in [[1, 2, 3], [3, 2, 1], [2, 3, 1], [2, 1, 3], [3, 1, 2], [1, 3, 2]] {
            assert_eq!(sorted3(nodes), [1, 2, 3]);
        }
    }
}
