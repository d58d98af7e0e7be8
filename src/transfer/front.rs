//! The tetrahedra of a mesh that a tetrahedron of another one meets: a front goes from one that holds its centroid across the faces that
//! it pierces.
use super::clip::{Piece, Planes};
use crate::mesh::adjacency::{FACES, NONE};
use crate::mesh::box_tree::Bounds;
use crate::mesh::locate::{Locator, Searcher, Size};
use crate::mesh::stamped_set::StampedSet;
use crate::mesh::vector::{Vec3, add, scale};

/// When less than this share of a tetrahedron is not covered, that is rounding, and no other parts are looked for.
const COVERED: f64 = 1e-10;

/// A search, one for each thread or chunk. It keeps its memory, and the place where it was last. In which order it finds tetrahedra depends on both
/// meshes alone.
pub struct Front<'l> {
    locator: &'l Locator,
    searcher: Searcher<'l>,
    touch: f64,
    visited: StampedSet,
    open: Vec<u32>,
    seeds: Vec<u32>,
}

impl<'l> Front<'l> {
    /// Over a mesh of this size; that of the whole where the mesh is a part of one.
    pub fn new(locator: &'l Locator, size: &Size) -> Self {
        Self {
            locator,
            searcher: Searcher::new(locator, size),
            touch: size.touch(),
            visited: StampedSet::default(),
            open: Vec::new(),
            seeds: Vec::new(),
        }
    }

    /// Calls `take` with each tetrahedron of the mesh that `x` meets, its planes and the piece of `x` in it. Returns the share of
    /// `x` that the mesh covers.
    pub fn over(&mut self, x: &[Vec3; 4], mut take: impl FnMut(u32, &Planes, &Piece)) -> f64 {
        self.visited.clear();
        let centroid = scale(add(add(x[0], x[1]), add(x[2], x[3])), 0.25);
        let (found, within, mut covered) = (self.searcher.locate(centroid), bounds(x), 0.0);
        if found.distance <= self.touch {
            covered += self.spread(found.tet, x, &within, &mut take);
        }
        if covered < 1.0 - COVERED {
            // Where the mesh ends within x, there may be other parts of it: each has a face on the boundary in x.
            let (locator, mut seeds) = (self.locator, std::mem::take(&mut self.seeds));
            seeds.clear();
            locator.at_boundary(&within, |tet| seeds.push(tet));
            seeds.retain(|&tet| ends_within(locator, tet, &within));
            seeds.sort_unstable();
            for &tet in &seeds {
                covered += self.spread(tet, x, &within, &mut take);
            }
            self.seeds = seeds;
        }
        covered
    }

    /// The front from one tetrahedron on; the share of x, in this box, covered by those that were not visited before.
    fn spread(
        &mut self,
        seed: u32,
        x: &[Vec3; 4],
        within: &Bounds,
        take: &mut impl FnMut(u32, &Planes, &Piece),
    ) -> f64 {
        let mut covered = 0.0;
        if self.visited.insert(seed) {
            self.open.push(seed);
        }
        while let Some(tet) = self.open.pop() {
            let corners = self.locator.corners(tet);
            let beyond = match Planes::of(corners) {
                Some(planes) => {
                    let piece = planes.clip(x);
                    if piece.share > 0.0 {
                        covered += piece.share;
                        take(tet, &planes, &piece);
                    }
                    piece.beyond
                }
                // A flat one has no part of x, but may lie between two that have.
                None if touch(&bounds(&corners), within) => 0b1111,
                None => 0,
            };
            for (k, &next) in self.locator.faces().neighbours[tet as usize].iter().enumerate() {
                if beyond >> k & 1 == 1 && next != NONE && self.visited.insert(next) {
                    self.open.push(next);
                }
            }
        }
        covered
    }
}

/// Whether a tetrahedron has a face on the boundary whose box touches this one.
fn ends_within(locator: &Locator, tet: u32, within: &Bounds) -> bool {
    let corners = locator.corners(tet);
    let around = locator.faces().neighbours[tet as usize];
    (0..4).any(|k| around[k] == NONE && touch(&bounds(&FACES[k].map(|i| corners[i])), within))
}

/// The box of some points.
#[inline]
fn bounds<const N: usize>(x: &[Vec3; N]) -> Bounds {
    let corner = |f: fn(f64, f64) -> f64| std::array::from_fn(|i| x[1..].iter().fold(x[0][i], |a, p| f(a, p[i])));
    [corner(f64::min), corner(f64::max)]
}

/// Whether two boxes touch.
#[inline]
fn touch(a: &Bounds, b: &Bounds) -> bool {
    (0..3).all(|i| a[0][i] <= b[1][i] && b[0][i] <= a[1][i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;
    use crate::mesh::vector::volume6;

    /// The tetrahedra met, with their shares, by trying all.
    fn by_trying(locator: &Locator, x: &[Vec3; 4]) -> Vec<(u32, f64)> {
        let tets = 0..locator.tets().len() as u32;
        let share = |tet| Planes::of(locator.corners(tet)).map_or(0.0, |planes| planes.clip(x).share);
        tets.map(|tet| (tet, share(tet))).filter(|found| found.1 > 0.0).collect()
    }

    fn by_front(front: &mut Front, x: &[Vec3; 4]) -> (f64, Vec<(u32, f64)>) {
        let mut found = Vec::new();
        let covered = front.over(x, |tet, _, piece| found.push((tet, piece.share)));
        found.sort_by_key(|found| found.0);
        (covered, found)
    }

    #[test]
    fn a_front_finds_all_that_is_met() {
        // The second has a slit, so that a tetrahedron may meet two parts of it.
        let mut slit = cube(6);
        let middle = |nodes: &[u32; 4]| nodes.iter().map(|&v| slit.vertices[v as usize][0]).sum::<f64>() / 4.0;
        slit.tets.nodes =
            slit.tets.nodes.iter().copied().filter(|nodes| !(0.5..0.66).contains(&middle(nodes))).collect();
        let mut partly = 0;
        for mesh in [cube(5), slit] {
            let locator = Locator::new(mesh.vertices, mesh.tets.nodes);
            let mut front = Front::new(&locator, &Size::of_vertices(locator.vertices()));
            for other in [cube(3), cube(4), cube(5)] {
                for nodes in &other.tets.nodes {
                    let bent = |p: Vec3| [p[0], p[1] + 0.05 * p[0] * (1.0 - p[0]), 0.9 * p[2] + 0.1 * p[0] * p[2]];
                    let x = nodes.map(|v| bent(other.vertices[v as usize]));
                    assert!(volume6(x[0], x[1], x[2], x[3]) > 0.0);
                    let (covered, found) = by_front(&mut front, &x);
                    let expected = by_trying(&locator, &x);
                    // What rounding alone lets them meet may be missed.
                    let met = |list: &[(u32, f64)]| list.iter().copied().filter(|m| m.1 > 1e-12).collect::<Vec<_>>();
                    assert_eq!(met(&found), met(&expected));
                    let sum: f64 = expected.iter().map(|m| m.1).sum();
                    assert!((covered - sum).abs() < 1e-11);
                    partly += usize::from(covered < 1.0 - 1e-9);
                }
            }
        }
        assert!(partly > 100);
    }

    #[test]
    fn of_the_same_mesh_only_the_same_tetrahedron_is_met() {
        let mesh = cube(4);
        let locator = Locator::new(mesh.vertices.clone(), mesh.tets.nodes.clone());
        let mut front = Front::new(&locator, &Size::of_vertices(locator.vertices()));
        for (nodes, tet) in mesh.tets.nodes.iter().zip(0..) {
            let (covered, found) = by_front(&mut front, &nodes.map(|v| mesh.vertices[v as usize]));
            assert!((covered - 1.0).abs() < 1e-14 && found.len() == 1 && found[0].0 == tet, "{found:?}");
        }
    }
}
