//! Point location in a tetrahedral mesh: a walk from a hint. Where a walk cannot go there are two trees of boxes: a small one of the faces
//! on the boundary, for points outside, and one of all tetrahedra.
use super::adjacency::{FACES, MatchedFaces, NONE};
use super::box_tree::{Bounds, BoxTree};
use super::starts::Starts;
use super::vector::{Vec3, add, cross, distance, dot, norm, scale, sub, volume6};
use super::{Elements, TetMesh};
use crate::tasks::{GRAIN, Team};
use std::ops::Range;
use std::sync::{Arc, OnceLock};

mod searcher;

pub use searcher::{Searcher, Size, take_nearer};

/// A barycentric coordinate down to this counts as inside.
const INSIDE: f64 = -1e-12;

/// Distances that differ by no more than this share are equal.
const SLACK: f64 = 1e-12;

/// After so many steps a walk gives up. A search in the tree costs about as much.
const STEPS: u32 = 200;

/// Where a point is.
#[derive(Clone, Copy, Debug)]
pub struct Location {
    /// The tetrahedron that contains the point, or the nearest one.
    pub tet: u32,
    /// Barycentric coordinates, ≥ 0, sum 1; of the nearest point of the tetrahedron when the point lies outside the mesh.
    pub weights: [f64; 4],
    /// Distance from the point to the tetrahedron, 0 inside; model units.
    pub distance: f64,
}

/// A mesh to search. Shared by threads; a query allocates nothing.
pub struct Locator {
    mesh: Arc<TetMesh>,
    faces: MatchedFaces,
    /// The faces on the boundary, as 4·tet + face, and the tree over them.
    boundary: OnceLock<Box<(Vec<u32>, BoxTree)>>,
    tree: OnceLock<Box<BoxTree>>,
    /// Better starts for long walks.
    starts: OnceLock<Box<Starts>>,
}

/// Steps of a walk before it looks for a better start.
const PATIENCE: u32 = 6;

/// How a walk ended.
enum Walk {
    Found(Location),
    /// Stopped at the boundary or given up, in this tetrahedron.
    Lost(u32),
}

impl Locator {
    /// From vertices (n, 3) and tetrahedra (m, 4).
    ///
    /// # Panics
    /// When there is no tetrahedron or an index is out of range.
    pub fn new(vertices: Vec<Vec3>, tets: Vec<[u32; 4]>) -> Self {
        let faces = MatchedFaces::of(Team::alone(), &tets);
        let tets = Elements { nodes: tets, refs: Vec::new() };
        Self::on(Team::alone(), Arc::new(TetMesh { vertices, tets, ..TetMesh::default() }), faces)
    }

    /// On a mesh that others use too, with its [`MatchedFaces`].
    ///
    /// # Panics
    /// When there is no tetrahedron, an index is out of range, or the faces are those of fewer tetrahedra.
    pub fn on(team: Team<'_>, mesh: Arc<TetMesh>, faces: MatchedFaces) -> Self {
        assert!(!mesh.tets.is_empty(), "a mesh without tetrahedra cannot be searched");
        assert_eq!(mesh.tets.len(), faces.neighbours.len(), "one row of neighbours a tetrahedron");
        let is_inside =
            |range: Range<usize>| mesh.tets.nodes[range].iter().flatten().all(|&v| (v as usize) < mesh.vertices.len());
        assert!(!team.chunks(GRAIN, mesh.tets.len(), is_inside).contains(&false), "node out of range");
        Self { mesh, faces, boundary: OnceLock::new(), tree: OnceLock::new(), starts: OnceLock::new() }
    }

    /// What lies across the faces of the tetrahedra.
    pub fn faces(&self) -> &MatchedFaces {
        &self.faces
    }

    /// The mesh.
    pub fn mesh(&self) -> &TetMesh {
        &self.mesh
    }

    /// The vertices.
    pub fn vertices(&self) -> &[Vec3] {
        &self.mesh.vertices
    }

    /// The tetrahedra.
    pub fn tets(&self) -> &[[u32; 4]] {
        &self.mesh.tets.nodes
    }

    /// The tetrahedron that contains p, else the nearest one. `hint` is where the walk starts (any number will do: one
    /// out of range starts with the tree) and becomes the tetrahedron found.
    pub fn locate(&self, p: Vec3, hint: &mut u32) -> Location {
        let found = if (*hint as usize) < self.tets().len() {
            match self.walk(p, *hint) {
                Walk::Found(found) => found,
                Walk::Lost(tet) => self.search_boundary(p, self.nearest_in(tet, p)),
            }
        } else {
            self.search(p, self.nearest_in(0, p))
        };
        *hint = found.tet;
        found
    }

    /// Visits tetrahedra with a face on the boundary, at least all whose face's box touches this box. One with two such faces comes twice.
    pub fn at_boundary(&self, within: &Bounds, mut visit: impl FnMut(u32)) {
        let (sides, tree) = self.boundary();
        tree.overlapping(within, |item| visit(sides[item as usize] / 4));
    }

    /// Corners of a tetrahedron.
    #[inline]
    pub fn corners(&self, tet: u32) -> [Vec3; 4] {
        self.mesh.tets.nodes[tet as usize].map(|v| self.mesh.vertices[v as usize])
    }

    /// Visibility walk that remembers where it came from: always through the face that p lies farthest behind, in
    /// barycentric terms. Meshes that are not Delaunay can make it run in circles: it gives up after a number of steps.
    fn walk(&self, p: Vec3, start: u32) -> Walk {
        let (mut tet, mut previous) = (start, NONE);
        for step in 0..STEPS {
            if step == PATIENCE
                && let Some(nearer) = self.nearer_start(p, tet)
            {
                (tet, previous) = (nearer, NONE);
            }
            let volumes = sub_volumes(&self.corners(tet), p);
            if let Some(weights) = weights_inside(volumes) {
                return Walk::Found(Location { tet, weights, distance: 0.0 });
            }
            let mut next = NONE;
            let mut least = 0.0;
            for (face, &volume) in volumes.iter().enumerate() {
                let beyond = self.faces.neighbours[tet as usize][face];
                if volume < least && beyond != NONE && beyond != previous {
                    (next, least) = (beyond, volume);
                }
            }
            if next == NONE {
                return Walk::Lost(tet);
            }
            (previous, tet) = (tet, next);
        }
        Walk::Lost(tet)
    }

    /// A tetrahedron that is likely nearer to p than a given one.
    fn nearer_start(&self, p: Vec3, tet: u32) -> Option<u32> {
        let starts = self.starts.get_or_init(|| Box::new(Starts::of(self.vertices(), self.tets())));
        let away = |tet: u32| distance(self.vertices()[self.tets()[tet as usize][0] as usize], p);
        starts.near(p).filter(|&start| away(start) < away(tet))
    }

    /// The nearest tetrahedron, given one that bounds the distance. Where p is on the outer side of all boundary faces that are nearest to
    /// it, p is outside, and nothing is nearer.
    fn search_boundary(&self, p: Vec3, bound: Location) -> Location {
        let (sides, tree) = self.boundary();
        // Faces that meet where the nearest point is are equally near but for rounding.
        let slack = |distance: f64| distance + SLACK * (distance + norm(p));
        let (mut nearest, mut least, mut outer) = (None, slack(bound.distance), true);
        tree.nearest(p, slack(least).powi(2), |item| {
            let (tet, face) = (sides[item as usize] / 4, sides[item as usize] as usize % 4);
            let corners = self.corners(tet);
            let (_, away) = nearest_on_face(&corners, face, p);
            if away <= slack(least) {
                let is_outer = sub_volumes(&corners, p)[face] < 0.0;
                // This face is clearly nearer than all before, which no longer count.
                outer = is_outer && (outer || slack(away) < least);
                if away < least {
                    (nearest, least) = (Some(tet), away);
                }
            }
            slack(least).powi(2)
        });
        match nearest {
            Some(tet) if outer => return self.nearest_in(tet, p),
            // p is inside, behind a wall that the walk came to. Between it and the nearest place on the boundary there is no wall.
            Some(tet) => {
                if let Walk::Found(found) = self.walk(p, tet) {
                    return found;
                }
            }
            None => {}
        }
        self.search(p, bound)
    }

    fn boundary(&self) -> &(Vec<u32>, BoxTree) {
        self.boundary.get_or_init(|| Box::new(self.boundary_tree()))
    }

    fn boundary_tree(&self) -> (Vec<u32>, BoxTree) {
        let open = |(t, around): (usize, &[u32; 4])| {
            let around = *around;
            (0..4).filter(move |&face| around[face] == NONE).map(move |face| (4 * t + face) as u32)
        };
        let sides: Vec<u32> = self.faces.neighbours.iter().enumerate().flat_map(open).collect();
        let tree = BoxTree::new(sides.len(), |item| {
            let side = sides[item as usize];
            let corners = self.corners(side / 4);
            let [a, b, c] = FACES[side as usize % 4].map(|i| corners[i]);
            let corner = |f: fn(f64, f64) -> f64| -> Vec3 { std::array::from_fn(|i| f(f(a[i], b[i]), c[i])) };
            [corner(f64::min), corner(f64::max)]
        });
        (sides, tree)
    }

    fn tree(&self) -> &BoxTree {
        self.tree.get_or_init(|| {
            let tree = BoxTree::new(self.tets().len(), |tet| {
                let c = self.corners(tet);
                let corner = |f: fn(f64, f64) -> f64| -> Vec3 {
                    std::array::from_fn(|i| f(f(c[0][i], c[1][i]), f(c[2][i], c[3][i])))
                };
                [corner(f64::min), corner(f64::max)]
            });
            Box::new(tree)
        })
    }

    /// The nearest tetrahedron of all, given one that bounds the distance.
    fn search(&self, p: Vec3, bound: Location) -> Location {
        let (mut best, tree) = (bound, self.tree());
        // First those whose boxes contain p: most points are inside, and a test of that costs a small part of a distance.
        tree.nearest(p, f64::MIN_POSITIVE.min(best.distance), |tet| {
            let Some(found) = self.holds(tet, p) else { return f64::MIN_POSITIVE };
            best = found;
            0.0
        });
        tree.nearest(p, best.distance * best.distance, |tet| {
            let found = self.nearest_in(tet, p);
            if found.distance < best.distance {
                best = found;
            }
            best.distance * best.distance
        });
        best
    }

    /// Where p is in a tetrahedron, if that holds it.
    fn holds(&self, tet: u32, p: Vec3) -> Option<Location> {
        let weights = weights_inside(sub_volumes(&self.corners(tet), p))?;
        Some(Location { tet, weights, distance: 0.0 })
    }

    /// The point of a tetrahedron nearest to p.
    fn nearest_in(&self, tet: u32, p: Vec3) -> Location {
        nearest_in(tet, &self.corners(tet), p)
    }
}

/// The point of a tetrahedron with these corners nearest to p.
pub fn nearest_in(tet: u32, corners: &[Vec3; 4], p: Vec3) -> Location {
    let volumes = sub_volumes(corners, p);
    let total: f64 = volumes.iter().sum();
    if total > 0.0 && volumes.iter().all(|&v| v >= 0.0) {
        return Location { tet, weights: volumes.map(|v| v / total), distance: 0.0 };
    }
    let mut best = Location { tet, weights: [0.25; 4], distance: f64::INFINITY };
    for (face, nodes) in FACES.iter().enumerate() {
        // The nearest point of a convex body lies on a face that p sees. For a flat or inverted one all faces are tried.
        if total > 0.0 && volumes[face] >= 0.0 {
            continue;
        }
        let (weights, away) = nearest_on_face(corners, face, p);
        if away < best.distance {
            best.distance = away;
            best.weights = [0.0; 4];
            for (&i, w) in nodes.iter().zip(weights) {
                best.weights[i] = w;
            }
        }
    }
    best
}

/// Barycentric coordinates on a face of the point there nearest to p, and its distance.
fn nearest_on_face(corners: &[Vec3; 4], face: usize, p: Vec3) -> ([f64; 3], f64) {
    let points = FACES[face].map(|i| corners[i]);
    let weights = nearest_on_triangle(p, points);
    let foot = points.iter().zip(weights).fold([0.0; 3], |q, (&x, w)| add(q, scale(x, w)));
    (weights, distance(p, foot))
}

/// Barycentric coordinates from [`sub_volumes`], where the point is inside.
#[inline(always)]
fn weights_inside(volumes: [f64; 4]) -> Option<[f64; 4]> {
    let total = volumes[0] + volumes[1] + volumes[2] + volumes[3];
    let is_inside = total > 0.0 && volumes.iter().all(|&v| v >= INSIDE * total);
    is_inside.then(|| {
        let weights = volumes.map(|v| v.max(0.0));
        let sum: f64 = weights.iter().sum();
        weights.map(|w| w / sum)
    })
}

/// Six times the volumes with p in place of each corner: p's barycentric coordinates times six times the volume.
#[inline(always)]
fn sub_volumes(c: &[Vec3; 4], p: Vec3) -> [f64; 4] {
    [
        volume6(p, c[1], c[2], c[3]),
        volume6(c[0], p, c[2], c[3]),
        volume6(c[0], c[1], p, c[3]),
        volume6(c[0], c[1], c[2], p),
    ]
}

/// Barycentric coordinates of the point of a triangle nearest to p: inside, else on the nearest of its edges.
pub(crate) fn nearest_on_triangle(p: Vec3, t: [Vec3; 3]) -> [f64; 3] {
    let normal = cross(sub(t[1], t[0]), sub(t[2], t[0]));
    let square = dot(normal, normal);
    if square > 0.0 {
        let part = |a: Vec3, b: Vec3| dot(cross(sub(a, p), sub(b, p)), normal) / square;
        let weights = [part(t[1], t[2]), part(t[2], t[0]), part(t[0], t[1])];
        if weights.iter().all(|&w| w >= 0.0) {
            let sum: f64 = weights.iter().sum();
            return weights.map(|w| w / sum);
        }
    }
    let mut best = ([1.0, 0.0, 0.0], f64::INFINITY);
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let edge = sub(t[j], t[i]);
        let length = dot(edge, edge);
        let s = if length > 0.0 { (dot(sub(p, t[i]), edge) / length).clamp(0.0, 1.0) } else { 0.0 };
        let away = distance(p, add(t[i], scale(edge, s)));
        if away < best.1 {
            let mut weights = [0.0; 3];
            weights[i] = 1.0 - s;
            weights[j] = s;
            best = (weights, away);
        }
    }
    best.0
}

#[cfg(test)]
mod tests {
    use super::super::samples::cube;
    use super::super::validity::check;
    use super::*;
    use proptest::prelude::*;

    fn locator(n: u32) -> Locator {
        let mesh = cube(n);
        assert!(check(&mesh).is_valid());
        Locator::new(mesh.vertices, mesh.tets.nodes)
    }

    /// The cube with a hole: the middle cells are missing, so walks run into walls.
    fn hollow() -> Locator {
        let mut mesh = cube(5);
        let inside = |p: Vec3| p.iter().all(|&x| (0.2..0.8).contains(&x));
        let middle = |tet: &[u32; 4]| tet.iter().fold([0.0; 3], |s, &v| add(s, scale(mesh.vertices[v as usize], 0.25)));
        mesh.tets.nodes = mesh.tets.nodes.iter().copied().filter(|tet| !inside(middle(tet))).collect();
        Locator::new(mesh.vertices, mesh.tets.nodes)
    }

    fn point(locator: &Locator, found: &Location) -> Vec3 {
        let nodes = locator.tets()[found.tet as usize];
        nodes.iter().zip(found.weights).fold([0.0; 3], |s, (&v, w)| add(s, scale(locator.vertices()[v as usize], w)))
    }

    /// Distance by trying all.
    fn least_distance(locator: &Locator, p: Vec3) -> f64 {
        (0..locator.tets().len() as u32).map(|t| locator.nearest_in(t, p).distance).fold(f64::INFINITY, f64::min)
    }

    fn check_location(locator: &Locator, p: Vec3, hint: u32) -> Result<(), TestCaseError> {
        let mut hint = hint;
        let found = locator.locate(p, &mut hint);
        prop_assert_eq!(hint, found.tet);
        prop_assert!(found.weights.iter().all(|&w| w >= 0.0));
        prop_assert!((found.weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        prop_assert!((distance(point(locator, &found), p) - found.distance).abs() < 1e-12);
        prop_assert!((found.distance - least_distance(locator, p)).abs() < 1e-12);
        Ok(())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn finds_the_nearest_from_any_hint(p in prop::array::uniform3(-0.3..1.3f64), hint in 0..2000u32) {
            check_location(&locator(4), p, hint)?;
            check_location(&hollow(), p, hint)?;
        }

        #[test]
        fn nearest_on_a_triangle(p in prop::array::uniform3(-1.0..1.0f64), t in prop::array::uniform9(-1.0..1.0f64)) {
            let t = [[t[0], t[1], t[2]], [t[3], t[4], t[5]], [t[6], t[7], t[8]]];
            let at = |w: [f64; 3]| (0..3).fold([0.0; 3], |s, i| add(s, scale(t[i], w[i])));
            let least = distance(p, at(nearest_on_triangle(p, t)));
            for i in 0..=20 {
                for j in 0..=20 - i {
                    let (u, v) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
                    prop_assert!(least <= distance(p, at([u, v, 1.0 - u - v])) + 1e-12);
                }
            }
        }
    }

    #[test]
    fn outside_the_faces_of_the_boundary_suffice() {
        for (locator, outside) in [
            (locator(3), vec![[0.4, 0.7, -0.1], [-0.2, 1.1, 0.5], [1.3; 3]]),
            (hollow(), vec![[0.5; 3], [0.7, 0.5, 0.4]]),
        ] {
            for p in outside {
                let found = locator.locate(p, &mut 5);
                assert!(found.distance > 0.0 && (found.distance - least_distance(&locator, p)).abs() < 1e-12);
            }
            assert!(locator.tree.get().is_none() && locator.boundary.get().is_some());
        }
    }

    #[test]
    fn long_walks_take_a_short_cut() {
        let locator = locator(16);
        let near = |p: Vec3, hint: u32| {
            let found = locator.locate(p, &mut hint.clone());
            assert!(found.distance == 0.0 && distance(point(&locator, &found), p) < 1e-12);
        };
        near([0.01, 0.012, 0.014], 0);
        assert!(locator.starts.get().is_none());
        near([0.97, 0.98, 0.91], 0);
        near([0.02, 0.98, 0.5], locator.tets().len() as u32 - 1);
        assert!(locator.starts.get().is_some());
    }

    #[test]
    fn vertices_and_flat_tets() {
        let locator = locator(3);
        for (v, &p) in locator.vertices().iter().enumerate() {
            let found = locator.locate(p, &mut 7);
            let at = locator.tets()[found.tet as usize].iter().position(|&node| node as usize == v).unwrap();
            assert!(found.weights[at] > 1.0 - 1e-12);
        }
        let square = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let flat = Locator::new(square, vec![[0, 1, 2, 3]]);
        assert!((flat.locate([0.5, 0.25, 2.0], &mut 0).distance - 2.0).abs() < 1e-14);
        assert_eq!(flat.locate([f64::NAN; 3], &mut 0).tet, 0);
    }
}
