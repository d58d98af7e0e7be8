//! Edge removal: the ring about an edge is triangulated and each triangle joined to both ends of the edge.
//! On an interface between regions that is done on both sides at once.
//!
//! Rings of three and four are the 3-2 and 4-4 flips; an open ring on a model face is the surface's 2-2 flip. The best triangulation
//! is found by dynamic programming over the polygon (Klincsek 1980; Shewchuk 2002).
use super::criteria::{Criterion, mean_ratio_score, wanted_score};
use super::ring::{Filling, LONGEST_RING, Ring};
use crate::adapt::core::access::Access;
use crate::adapt::core::commit::NewTet;
use crate::adapt::core::ids::{TetId, VertexId};
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::shell::Shell;
use crate::adapt::core::worker::Worker;

/// Tetrahedra below this mean ratio try the longest rings, which cost most and seldom gain.
const LONG_RINGS_BELOW: f64 = 0.65;

/// A ring of n tetrahedra is tried only where the mean of their 1/Q − 1 is at least the n-th of these: below, few would gain, and little
/// (docs/decisions/kernel-speed.md).
const LEAST_COST: [f64; LONGEST_RING + 1] = [0.0, 0.0, 0.0, 0.15, 0.17, 0.26, 0.44, 0.56];

/// A 2-2 flip of surface triangles, with their tags.
struct SurfaceFlip {
    /// Where in the ring the second of the triangles is; the first is at its beginning.
    across: usize,
    old: [([VertexId; 3], u32); 2],
    new: [([VertexId; 3], u32); 2],
}

impl<A: Access> Worker<'_, '_, A> {
    /// Removes the edge a–b of a tetrahedron that holds still, when the criterion gains by it.
    pub fn remove_edge(
        &mut self,
        ring: &mut Ring,
        [a, b]: [VertexId; 2],
        t: TetId,
        criterion: Criterion,
    ) -> Result<(), Refusal> {
        self.claim(a)?;
        self.claim(b)?;
        let longest = if self.store.quality(t) < LONG_RINGS_BELOW { LONGEST_RING } else { 5 };
        self.gather_shell_while(a, b, t, longest, |worker, other| worker.goes_first(t, other))?;
        if let [only] = self.state.shell.tets[..] {
            return self.remove_boundary_tet(only, a, b);
        }
        let mut shell = std::mem::take(&mut self.state.shell);
        let result = self.remove_shell(ring, [a, b], &mut shell, criterion);
        self.state.shell = shell;
        result
    }

    fn remove_shell(
        &mut self,
        ring: &mut Ring,
        [a, b]: [VertexId; 2],
        shell: &mut Shell,
        criterion: Criterion,
    ) -> Result<(), Refusal> {
        let n = shell.ring.len();
        if !(3..=LONGEST_RING).contains(&n) {
            return Err(Refusal::Topology);
        }
        let cost: f64 = shell.tets.iter().map(|&t| -mean_ratio_score(self.store.quality(t))).sum();
        if criterion == Criterion::MeanRatio && cost < LEAST_COST[n] * n as f64 {
            return Err(Refusal::Shape);
        }
        let surface = self.surface_flip(a, b, shell)?;
        // Model edges have surface triangles.
        if surface.is_some() && self.store.ridge_curve(a, b).is_some() {
            return Err(Refusal::Geometry);
        }
        let across = surface.as_ref().map(|flip| flip.across).filter(|_| shell.closed);
        ring.fill(self.store, [a, b], &shell.ring, across);
        let old = match criterion {
            Criterion::MeanRatio => -cost,
            _ => {
                let old = shell.tets.iter().map(|&t| self.present_score(criterion, t, ring.cavity()));
                old.fold(criterion.nothing(), |x, y| criterion.join(x, y))
            }
        };
        let wanted = wanted_score(old);
        let gains = ring.is_feasible()
            && match criterion {
                Criterion::MeanRatio => ring.is_promising(self.store, old, wanted) && ring.measure(self.store) > wanted,
                _ => {
                    let found = ring.score_each(criterion, |tet, cavity| self.score(criterion, tet, cavity));
                    // What it becomes is kept by its mean ratios.
                    found > wanted && ring.measure(self.store).is_finite()
                }
            };
        if !gains {
            return Err(Refusal::Shape);
        }
        self.write_triangulation([a, b], shell, ring, across.unwrap_or(0));
        if let Some(SurfaceFlip { across, old, new }) = surface {
            self.compare_normals(&old, &new, 0.0)?;
            self.refuse_joined(shell.ring[0], shell.ring[across])?;
            self.state.replacement.faces.extend(new);
        }
        self.commit()
    }

    /// What becomes of the two surface triangles at an edge on the boundary or on an interface; none for an edge inside. The shell is turned
    /// so that it begins at one of them.
    fn surface_flip(&self, a: VertexId, b: VertexId, shell: &mut Shell) -> Result<Option<SurfaceFlip>, Refusal> {
        let count = shell.surface_tags().count();
        if shell.closed && count == 0 {
            return Ok(None);
        }
        if count != 2 {
            return Err(Refusal::Geometry);
        }
        let n = shell.ring.len();
        let mut across = n - 1;
        if shell.closed {
            shell.begin_at_tag();
            across = shell.tags[1..].iter().position(|&tag| tag != 0).map_or(0, |at| at + 1);
            // A side with a single tetrahedron would lose it, and the interface would move into other tetrahedra.
            if n >= LONGEST_RING || across < 2 || n - across < 2 {
                return Err(Refusal::Topology);
            }
        }
        let (first, last, tag) = (shell.ring[0], shell.ring[across], shell.tags[0]);
        // Without a tag it is a face to another part of a larger mesh.
        if tag == 0 || shell.tags[across] != tag {
            return Err(Refusal::Geometry);
        }
        let old = [([a, first, b], tag), ([a, b, last], tag)];
        let new = [([a, first, last], tag), ([first, b, last], tag)];
        Ok(Some(SurfaceFlip { across, old, new }))
    }

    /// Refuses when the two claimed vertices are joined by an edge already.
    fn refuse_joined(&mut self, x: VertexId, y: VertexId) -> Result<(), Refusal> {
        if self.find_tet_with(x, y).is_some() { Err(Refusal::Topology) } else { Ok(()) }
    }

    /// Writes the triangulation as a replacement. On an interface its second side begins at the tetrahedron `second`.
    fn write_triangulation(&mut self, [a, b]: [VertexId; 2], shell: &Shell, ring: &Ring, second: usize) {
        let regions = [0, second].map(|side| self.store.region(shell.tets[side]));
        self.state.replacement.clear();
        self.state.replacement.old.extend(&shell.tets);
        for &Filling { vertices: [x, y, z], side, ratios } in ring.best() {
            let region = regions[side];
            for (vertices, quality) in [[x, y, z, b], [x, z, y, a]].into_iter().zip(ratios) {
                self.state.replacement.new.push(NewTet { vertices, region, quality });
            }
        }
    }
}
