//! Searches whose answer depends on the mesh and the point alone, not on where they begin.
//!
//! A point on a face, an edge or a vertex is held by several tetrahedra, and one outside may be as near to several. Among the first the one of the
//! lowest number is taken; among the others the one that is nearest by the number that [`Locator::nearest_in`] has for it, and of equal ones
//! that of the lowest number. To have them all, a search goes on from the tetrahedron that it came to, across the faces that are within a tiny
//! distance of the point (or of its nearest place).
//!
//! ```text
//!       ╲ 7 │ 3 ╱      p is held by 7, 3, 5 and 9, and a walk ends in the first that it meets.
//!        ╲  │  ╱
//!     ────  p  ────    From there the others are found across the faces that p is on.
//!        ╱  │  ╲
//!       ╱ 5 │ 9 ╲
//! ```
use super::*;
use crate::mesh::stamped_set::StampedSet;
use std::cmp::Ordering;

/// Nearer to a face than this share of the size of the mesh may be on it. A point that a tetrahedron holds is no farther from it than about 3e-12 of
/// the tetrahedron's diameter ([`INSIDE`]).
const TOUCH: f64 = 1e-11;

/// The same, as a share of the coordinates: above [`SLACK`] and far above their rounding.
const TOUCH_OF_COORDINATES: f64 = 2e-12;

/// With a greater barycentric coordinate a point is not on that face, unless the tetrahedron's height there is below 2e-10 of the mesh.
const CLEAR: f64 = 0.05;

/// The box of a mesh, as far as it matters to searches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// The diagonal of the box, length.
    pub diagonal: f64,
    /// Greatest coordinate, without its sign.
    pub reach: f64,
}

impl Size {
    /// Of a mesh with this box of its vertices.
    pub fn of([low, high]: Bounds) -> Self {
        let reach = low.iter().chain(&high).fold(0.0, |reach: f64, x| reach.max(x.abs()));
        Self { diagonal: distance(low, high), reach }
    }

    /// Of a mesh with these vertices, shape (n, 3).
    pub fn of_vertices(vertices: &[Vec3]) -> Self {
        let corner = |f: fn(f64, f64) -> f64| {
            vertices.iter().copied().reduce(|a, b| std::array::from_fn(|i| f(a[i], b[i]))).unwrap_or_default()
        };
        Self::of([corner(f64::min), corner(f64::max)])
    }

    /// No farther from a face than this, a point may be on it; length.
    pub fn touch(&self) -> f64 {
        TOUCH * self.diagonal + TOUCH_OF_COORDINATES * self.reach
    }
}

/// Searches in a mesh, one for each thread or chunk. It keeps its memory, and the place where it was last.
pub struct Searcher<'l> {
    locator: &'l Locator,
    touch: f64,
    hint: u32,
    visited: StampedSet,
    open: Vec<u32>,
    /// Tetrahedra that may be near enough, with their distances.
    near: Vec<(u32, f64)>,
}

impl<'l> Searcher<'l> {
    /// In a mesh of this size; that of the whole where the mesh is a part of one.
    pub fn new(locator: &'l Locator, size: &Size) -> Self {
        let (open, near) = (Vec::new(), Vec::new());
        Self { locator, touch: size.touch(), hint: 0, visited: StampedSet::default(), open, near }
    }

    /// The tetrahedron of the lowest number that holds p; where none does, the nearest one, and of several the one of the lowest number. In a mesh
    /// without inverted tetrahedra that depends on nothing else. Where p is a vertex, to the bit, that has all the weight. Points that follow one
    /// another had best be near each other.
    pub fn locate(&mut self, p: Vec3) -> Location {
        let mut found = match self.locator.walk(p, self.hint) {
            Walk::Found(found) => self.lowest(p, found),
            Walk::Lost(tet) => self.beyond_walls(p, tet),
        };
        self.hint = found.tet;
        let nodes = self.locator.tets()[found.tet as usize];
        if let Some(at) = nodes.iter().position(|&v| self.locator.vertices()[v as usize] == p) {
            found.weights = std::array::from_fn(|i| f64::from(u8::from(i == at)));
        }
        found
    }

    /// Of all that hold p, one of which is known.
    fn lowest(&mut self, p: Vec3, found: Location) -> Location {
        if self.is_clear(&found) {
            return found;
        }
        self.near.clear();
        self.near.push((found.tet, 0.0));
        self.settled(p, 0.0)
    }

    /// Whether a point inside a tetrahedron is on no face of it.
    fn is_clear(&self, found: &Location) -> bool {
        if found.weights.iter().all(|&weight| weight > CLEAR) {
            return true;
        }
        let corners = self.locator.corners(found.tet);
        let total = volume6(corners[0], corners[1], corners[2], corners[3]);
        (0..4).all(|k| {
            let (height, least) = (found.weights[k] * total, self.touch * self.touch * face_square(&corners, k));
            found.weights[k] > CLEAR || height * height > least
        })
    }

    /// Distances from p up to this may be the least one, where one is known.
    fn radius(&self, least: f64, p: Vec3) -> f64 {
        self.touch.max(least + SLACK * (least + norm(p)))
    }

    /// Where a walk has come to a wall or given up, in this tetrahedron. Where p is on the outer side of all boundary faces that are nearest to it, p
    /// is outside, and nothing is nearer.
    fn beyond_walls(&mut self, p: Vec3, tet: u32) -> Location {
        let locator = self.locator;
        let (sides, tree) = locator.boundary();
        let bound = locator.nearest_in(tet, p);
        // The least distances of all faces, and of those that p is not on the outer side of.
        let (mut least, mut inner) = (bound.distance, f64::INFINITY);
        self.near.clear();
        tree.nearest(p, self.radius(least, p).powi(2), |item| {
            let (tet, face) = (sides[item as usize] / 4, sides[item as usize] as usize % 4);
            let corners = locator.corners(tet);
            let (_, away) = nearest_on_face(&corners, face, p);
            if away <= self.radius(least, p) {
                least = least.min(away);
                self.near.push((tet, away));
                if sub_volumes(&corners, p)[face] >= 0.0 {
                    inner = inner.min(away);
                }
            }
            self.radius(least, p).powi(2)
        });
        let nearest = self.near.iter().min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        if let Some(&(tet, _)) = nearest {
            if inner > self.radius(least, p) {
                return self.settled(p, least);
            }
            // p is inside, behind a wall that the walk came to. Between it and the nearest place on the boundary there is no wall.
            if let Walk::Found(found) = locator.walk(p, tet) {
                return self.lowest(p, found);
            }
        }
        self.by_trying(p, bound)
    }

    /// By the tree over all tetrahedra, given one that bounds the distance.
    fn by_trying(&mut self, p: Vec3, bound: Location) -> Location {
        let locator = self.locator;
        let tree = locator.tree();
        let mut held = None;
        // Most points are inside, and a test of that costs a small part of a distance.
        tree.nearest(p, f64::MIN_POSITIVE, |tet| {
            held = locator.holds(tet, p);
            if held.is_some() { 0.0 } else { f64::MIN_POSITIVE }
        });
        if let Some(found) = held {
            return self.lowest(p, found);
        }
        let mut least = bound.distance;
        self.near.clear();
        tree.nearest(p, self.radius(least, p).powi(2), |tet| {
            let away = locator.nearest_in(tet, p).distance;
            if away <= self.radius(least, p) {
                least = least.min(away);
                self.near.push((tet, away));
            }
            self.radius(least, p).powi(2)
        });
        if self.near.is_empty() {
            return bound;
        }
        self.settled(p, least)
    }

    /// The answer, given the least distance and what may be near enough: at least one tetrahedron of each part of the mesh that is within the
    /// radius of p.
    fn settled(&mut self, p: Vec3, least: f64) -> Location {
        let (locator, radius) = (self.locator, self.radius(least, p));
        self.visited.clear();
        self.open.clear();
        for &(tet, away) in &self.near {
            if away <= radius && self.visited.insert(tet) {
                self.open.push(tet);
            }
        }
        self.near.clear();
        let (mut held, mut walls) = (None::<Location>, false);
        while let Some(tet) = self.open.pop() {
            let corners = locator.corners(tet);
            let volumes = sub_volumes(&corners, p);
            // Six times a volume to the square, and that with the radius as the height: a face is nearer than the radius where the first is not greater.
            let reach = [0, 1, 2, 3].map(|k| radius * radius * face_square(&corners, k));
            let is_near = |k: usize| volumes[k] * volumes[k] <= reach[k];
            // Where p may be inside it is cheaper to ask how far beyond the planes it is: never farther than from the tetrahedron.
            let is_beyond = match least > self.touch {
                true => locator.nearest_in(tet, p).distance > radius,
                false => (0..4).any(|k| volumes[k] < 0.0 && !is_near(k)),
            };
            if is_beyond {
                continue;
            }
            self.near.push((tet, 0.0));
            if held.is_none_or(|held| tet < held.tet)
                && let Some(weights) = weights_inside(volumes)
            {
                held = Some(Location { tet, weights, distance: 0.0 });
            }
            for (k, &beyond) in locator.faces.neighbours[tet as usize].iter().enumerate() {
                if volumes[k] > 0.0 && !is_near(k) {
                    continue;
                }
                if beyond != NONE {
                    if self.visited.insert(beyond) {
                        self.open.push(beyond);
                    }
                } else if !walls && nearest_on_face(&corners, k, p).1 <= radius {
                    // Other parts of the mesh may touch this one here.
                    walls = true;
                    let (visited, open) = (&mut self.visited, &mut self.open);
                    locator.at_boundary(&[p.map(|x| x - radius), p.map(|x| x + radius)], |tet| {
                        if visited.insert(tet) {
                            open.push(tet);
                        }
                    });
                }
            }
        }
        if let Some(held) = held {
            return held;
        }
        let all = self.near.iter().map(|&(tet, _)| locator.nearest_in(tet, p));
        let nearest = all.min_by(by_distance);
        nearest.unwrap_or_else(|| locator.nearest_in(0, p))
    }
}

/// Nearer ones first, and of those that are equally near the ones of lower numbers.
fn by_distance(a: &Location, b: &Location) -> Ordering {
    a.distance.total_cmp(&b.distance).then(a.tet.cmp(&b.tet))
}

/// Puts the tetrahedron that [`Searcher::locate`] would take, where none holds p, in the place of one that is known, if it is among some that have
/// this tree. `of` gives the place in each of these that is nearest to p.
pub fn take_nearer(best: &mut Location, tree: &BoxTree, p: Vec3, of: impl Fn(u32) -> Location) {
    let bound = |best: &Location| (best.distance + SLACK * (best.distance + norm(p))).powi(2);
    tree.nearest(p, bound(best), |item| {
        let found = of(item);
        if by_distance(&found, best).is_lt() {
            *best = found;
        }
        bound(best)
    });
}

/// Twice the area of a face, to the square.
#[inline(always)]
fn face_square(corners: &[Vec3; 4], face: usize) -> f64 {
    let [a, b, c] = FACES[face].map(|i| corners[i]);
    let normal = cross(sub(b, a), sub(c, a));
    dot(normal, normal)
}

#[cfg(test)]
mod tests;
