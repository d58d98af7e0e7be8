//! Multi-face removal, the inverse of edge removal: several faces side by side, all between the same two vertices, go, and the edge
//! between these two vertices comes.
//!
//! With m faces, 2m tetrahedra are replaced by m + 2 about the new edge. One face is the 2-3 flip, two are the 4-4 flip. From three on no
//! single flip does the same, and the steps between are often worse. The faces make a tree that grows from one of them, its root; dynamic
//! programming finds the best part of the tree with that root (Shewchuk 2002, Two discrete optimization algorithms for the topological
//! improvement of tetrahedral meshes).
//!
//! The two ends cannot be joined already: where all new tetrahedra are positive they fill the cavity, and the segment between the ends
//! runs inside it, where there are only old faces. Tagged faces are never crossed, so all is in one region.
use super::criteria::{Criterion, mean_ratio_score, wanted_score};
use crate::adapt::core::access::Access;
use crate::adapt::core::commit::NewTet;
use crate::adapt::core::ids::{TetId, VertexId};
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::worker::Worker;
use crate::mesh::vector::volume6;
use crate::metric::lanes::LANES;

/// Most faces in a tree: more are hardly ever taken.
const MOST_FACES: usize = 4;

/// Least faces in a tree: edge removal does all that two can do.
const LEAST_FACES: usize = 3;

/// The mean of 1/Q − 1 of the tetrahedra of a tree below which it is left as it is.
const LEAST_COST: f64 = 0.15;

/// Stands for a score of −∞, so that sums stay numbers.
const FLAT: f64 = -1e9;

/// A face between the two ends of the edge that would come.
#[derive(Clone, Copy)]
struct Sandwiched {
    /// In positive order with the upper end after them. All faces but the root were reached over the edge from 0 to 1.
    vertices: [VertexId; 3],
    /// Its tetrahedra, the one with the upper end first.
    tets: [TetId; 2],
    /// Place in the tree of the face beyond each edge k to k + 1; 0 where there is none.
    beyond: [usize; 3],
    /// Whether each edge and both ends make a positive tetrahedron (in floating point), and its mean ratio.
    fits: [bool; 3],
    quality: [f64; 3],
    /// Whether it is better removed.
    goes: bool,
}

/// An edge of a face in a tree: places of the face and of the edge in it.
type FaceEdge = (usize, usize);

/// A tree of faces between the same two vertices; the first is its root.
struct Tree {
    /// The upper and the lower end of the edge that would come.
    ends: [VertexId; 2],
    faces: [Sandwiched; MOST_FACES],
    count: usize,
}

impl Tree {
    /// The edges of a face but the one over which it was reached.
    fn edges(face: usize) -> std::ops::Range<usize> {
        if face == 0 { 0..3 } else { 1..3 }
    }

    /// The tetrahedron of an edge of a face and both ends.
    fn tet(&self, (face, k): FaceEdge) -> [VertexId; 4] {
        let v = self.faces[face].vertices;
        let [upper, lower] = self.ends;
        [v[k], v[(k + 1) % 3], lower, upper]
    }

    /// All vertices, and how many.
    fn cavity(&self) -> ([VertexId; MOST_FACES + 4], usize) {
        let mut cavity = [VertexId::NONE; MOST_FACES + 4];
        cavity[..2].copy_from_slice(&self.ends);
        cavity[2..5].copy_from_slice(&self.faces[0].vertices);
        for face in 1..self.count {
            cavity[face + 4] = self.faces[face].vertices[2];
        }
        (cavity, self.count + 4)
    }

    /// Whether some part of the tree with its root leaves positive tetrahedra only.
    fn has_room(&self) -> bool {
        let mut fits = [true; MOST_FACES];
        // A face comes after the one that it was reached from.
        for at in (0..self.count).rev() {
            let Sandwiched { beyond, fits: alone, .. } = self.faces[at];
            fits[at] = Self::edges(at).all(|k| alone[k] || (beyond[k] > 0 && fits[beyond[k]]));
        }
        fits[0]
    }

    /// Visits the faces that go and the edges about them, from the root.
    fn each_gone(&self, mut face: impl FnMut(usize), mut edge: impl FnMut(FaceEdge)) {
        let mut open = [0; MOST_FACES];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let at = open[depth];
            face(at);
            for k in Self::edges(at) {
                match self.faces[at].beyond[k] {
                    next if next > 0 && self.faces[next].goes => {
                        open[depth] = next;
                        depth += 1;
                    }
                    _ => edge((at, k)),
                }
            }
        }
    }
}

impl<A: Access> Worker<'_, '_, A> {
    /// Removes the face between two claimed tetrahedra, together with faces beside it that lie between the same two ends, when the
    /// criterion gains by it. The first tetrahedron has the upper end, with which the face is in positive order.
    pub fn remove_faces(
        &mut self,
        face: [VertexId; 3],
        tets: [TetId; 2],
        ends: [VertexId; 2],
        criterion: Criterion,
    ) -> Result<(), Refusal> {
        let root = Sandwiched { vertices: face, tets, beyond: [0; 3], fits: [false; 3], quality: [0.0; 3], goes: true };
        let mut tree = Tree { ends, faces: [root; MOST_FACES], count: 1 };
        self.grow_tree(&mut tree)?;
        if tree.count < LEAST_FACES || !tree.has_room() {
            return Err(Refusal::Shape);
        }
        let tets = || tree.faces[..tree.count].iter().flat_map(|face| face.tets);
        let cost: f64 = tets().map(|t| -mean_ratio_score(self.store.quality(t))).sum();
        if cost < LEAST_COST * (2 * tree.count) as f64 {
            return Err(Refusal::Shape);
        }
        self.measure_tree(&mut tree);
        self.prune_tree(&mut tree, criterion)?;
        let region = self.store.region(tree.faces[0].tets[0]);
        let replacement = &mut self.state.replacement;
        replacement.clear();
        let (old, new) = (&mut replacement.old, &mut replacement.new);
        tree.each_gone(
            |at| old.extend(tree.faces[at].tets),
            |(at, k)| {
                let (vertices, quality) = (tree.tet((at, k)), tree.faces[at].quality[k]);
                new.push(NewTet { vertices, region, quality });
            },
        );
        self.commit()
    }

    /// Adds the faces that lie between the same ends, the nearest first, and claims their vertices.
    fn grow_tree(&mut self, tree: &mut Tree) -> Result<(), Refusal> {
        self.find_fits(tree, 0);
        // The root goes in any case. Where no tetrahedron fits on an edge of it, there must be another face beyond; mostly there is none.
        let fits = tree.faces[0].fits;
        for must in [true, false] {
            for k in (0..3).filter(|&k| fits[k] != must) {
                if !self.step_over(tree, (0, k))? && must {
                    return Err(Refusal::Shape);
                }
            }
        }
        let mut at = 1;
        while at < tree.count {
            self.find_fits(tree, at);
            for k in Tree::edges(at) {
                self.step_over(tree, (at, k))?;
            }
            at += 1;
        }
        Ok(())
    }

    /// Finds the edges of a face on which a new tetrahedron would be positive.
    fn find_fits(&self, tree: &mut Tree, at: usize) {
        for k in Tree::edges(at) {
            let [a, b, c, d] = tree.tet((at, k)).map(|v| self.store.position(v));
            tree.faces[at].fits[k] = volume6(a, b, c, d) > 0.0;
        }
    }

    /// Adds the face beyond an edge, if it lies between the same ends and there is room in the tree. Returns whether it did.
    fn step_over(&mut self, tree: &mut Tree, (at, k): FaceEdge) -> Result<bool, Refusal> {
        if tree.count == MOST_FACES {
            return Ok(false);
        }
        let Some(next) = self.sandwiched_beyond(&tree.faces[at], k, tree.ends) else { return Ok(false) };
        if tree.faces[..tree.count].iter().any(|face| face.tets == next.tets) {
            return Ok(false);
        }
        self.claim(next.vertices[2])?;
        tree.faces[at].beyond[k] = tree.count;
        tree.faces[tree.count] = next;
        tree.count += 1;
        Ok(true)
    }

    /// The face beyond an edge of a face between two ends, when it lies between the same.
    fn sandwiched_beyond(&self, face: &Sandwiched, k: usize, ends: [VertexId; 2]) -> Option<Sandwiched> {
        let [x, y, across] = [0, 1, 2].map(|i| face.vertices[(k + i) % 3]);
        let step = |side: usize| {
            let t = face.tets[side];
            let i = self.store.vertices(t).iter().position(|&v| v == across)?;
            let next = self.store.neighbour(t, i);
            if !next.is_some() || self.store.tags(t)[i] != 0 {
                return None;
            }
            let third = self.store.vertices(next).into_iter().find(|v| ![x, y, ends[side]].contains(v))?;
            Some((next, third))
        };
        let ((upper, third), (lower, other)) = (step(0)?, step(1)?);
        if third != other {
            return None;
        }
        // The same three vertices are the same face.
        let i = self.store.vertices(upper).iter().position(|&v| v == ends[0])?;
        (self.store.neighbour(upper, i) == lower && self.store.tags(upper)[i] == 0).then_some(Sandwiched {
            vertices: [y, x, third],
            tets: [upper, lower],
            beyond: [0; 3],
            fits: [false; 3],
            quality: [0.0; 3],
            goes: false,
        })
    }

    /// Finds the mean ratios of all tetrahedra that may come.
    fn measure_tree(&mut self, tree: &mut Tree) {
        let [upper, lower] = tree.ends;
        let (apex, log) = (self.store.position(upper), self.store.log(upper));
        let mut fitting = [(0, 0); 2 * MOST_FACES + 1];
        let mut count = 0;
        for at in 0..tree.count {
            for k in Tree::edges(at).filter(|&k| tree.faces[at].fits[k]) {
                fitting[count] = (at, k);
                count += 1;
            }
        }
        for some in fitting[..count].chunks(LANES) {
            for lane in 0..LANES {
                let [x, y, ..] = tree.tet(some[lane.min(some.len() - 1)]);
                let base = [x, y, lower];
                self.state.batch.set_with_sum(lane, base.map(|v| self.store.position(v)), &self.store.log_sum(base));
            }
            self.state.batch.prepare();
            let qualities = self.state.batch.shapes(apex, &log).mean_ratios();
            some.iter().zip(qualities).for_each(|(&(at, k), quality)| tree.faces[at].quality[k] = quality);
        }
    }

    /// Finds which faces are better removed.
    ///
    /// # Errors
    /// `Shape` when the criterion does not gain.
    fn prune_tree(&self, tree: &mut Tree, criterion: Criterion) -> Result<(), Refusal> {
        let (cavity, count) = tree.cavity();
        let cavity = &cavity[..count];
        let mut old = [0.0; MOST_FACES];
        for (old, face) in old.iter_mut().zip(&tree.faces[..tree.count]) {
            let [x, y] = face.tets.map(|t| self.present_score(criterion, t, cavity));
            *old = criterion.join(x, y);
        }
        let score = |tree: &Tree, (at, k): FaceEdge| match (tree.faces[at].quality[k], criterion) {
            (quality, Criterion::MeanRatio) => mean_ratio_score(quality),
            (quality, _) if quality <= 0.0 => f64::NEG_INFINITY,
            _ => self.score(criterion, tree.tet((at, k)), cavity),
        };
        // By mean ratio two ways are compared by their sums, without the terms that both have; else by the least score that would be there.
        // A face comes after the one that it was reached from.
        let mut gone = [0.0; MOST_FACES];
        for at in (0..tree.count).rev() {
            let mut joined = criterion.nothing();
            for k in Tree::edges(at) {
                let mut value = score(tree, (at, k));
                let next = tree.faces[at].beyond[k];
                if next > 0 {
                    let (goes, stays) = match criterion {
                        Criterion::MeanRatio => (gone[next] - old[next].max(FLAT), value),
                        _ => (gone[next], value.min(old[next])),
                    };
                    tree.faces[next].goes = goes > stays;
                    value = goes.max(stays);
                }
                joined = criterion.join(joined, value);
            }
            gone[at] = joined;
        }
        let (mut before, mut after) = (criterion.nothing(), criterion.nothing());
        tree.each_gone(
            |at| before = criterion.join(before, old[at]),
            |edge| after = criterion.join(after, score(tree, edge)),
        );
        if after > wanted_score(before) { Ok(()) } else { Err(Refusal::Shape) }
    }
}

#[cfg(test)]
mod tests;
