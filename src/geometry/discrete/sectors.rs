//! The corners of triangles that meet in a vertex without a ridge between them: one sector has one normal.
use super::{EdgeTable, Features};
use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::stamped_set::StampedSet;
use crate::tasks::{Rows, Team};

/// Sectors of the vertices of a surface.
pub(crate) struct Sectors {
    /// Sector of each corner, 3·triangle + corner; shape (3·triangles,).
    pub of_corner: Vec<u32>,
    /// The corners of each sector, ascending.
    pub corners: Rows,
}

impl Sectors {
    /// Of triangles with their ridges.
    pub fn new(team: Team<'_>, triangles: &[[u32; 3]], features: &Features) -> Self {
        let mut sets = DisjointSets::new(3 * triangles.len());
        for edge in (0..features.edges.len()).filter(|&edge| !features.ridge[edge]) {
            if let &[first, second] = features.edges.sides(edge) {
                for v in features.edges.nodes[edge] {
                    let [a, b] = [first, second].map(|side| corner_at(triangles, side, v));
                    sets.join(a, b);
                }
            }
        }
        let mut number = vec![u32::MAX; 3 * triangles.len()];
        let mut count = 0;
        let of_corner: Vec<u32> = (0..3 * triangles.len() as u32)
            .map(|corner| {
                let first = sets.first(corner) as usize;
                if number[first] == u32::MAX {
                    number[first] = count;
                    count += 1;
                }
                number[first]
            })
            .collect();
        let corners = Rows::by_key(team, count as usize, of_corner.len(), |corner| [of_corner[corner]]);
        Self { of_corner, corners }
    }

    /// The sector, at a vertex of it, of an edge that is no ridge.
    pub fn at(&self, edges: &EdgeTable, triangles: &[[u32; 3]], edge: usize, vertex: u32) -> usize {
        self.of_corner[corner_at(triangles, edges.sides(edge)[0], vertex) as usize] as usize
    }

    /// Number of sectors.
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// The sectors around one, itself first, by rings of triangles, until there are `wanted` and at least two rings, or `rings` rings.
    /// Ridges are not crossed. `found` is overwritten.
    pub fn around(&self, sector: u32, wanted: usize, rings: usize, seen: &mut StampedSet, found: &mut Vec<u32>) {
        seen.clear();
        found.clear();
        seen.insert(sector);
        found.push(sector);
        let mut begin = 0;
        for ring in 0..rings {
            let end = found.len();
            if begin == end || (ring >= 2 && end > wanted) || end >= MOST {
                break;
            }
            for i in begin..end {
                for &corner in self.corners.row(found[i] as usize) {
                    let first = corner / 3 * 3;
                    for other in [first + (corner + 1 - first) % 3, first + (corner + 2 - first) % 3] {
                        let next = self.of_corner[other as usize];
                        if seen.insert(next) {
                            found.push(next);
                        }
                    }
                }
            }
            begin = end;
        }
        found.truncate(MOST);
    }
}

/// Most sectors around one: vertices of thousands of triangles are nothing to fit to.
const MOST: usize = 96;

/// The corner of the triangle of a side that is at a vertex.
pub(super) fn corner_at(triangles: &[[u32; 3]], side: u32, vertex: u32) -> u32 {
    let (t, k) = (side / 3, side % 3);
    if triangles[t as usize][k as usize] == vertex { side } else { 3 * t + (k + 1) % 3 }
}
