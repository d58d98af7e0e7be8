//! Edge removal: the ring about an edge is triangulated and each triangle joined to both ends of the edge.
//!
//! Rings of three and four are the 3-2 and 4-4 flips; an open ring on a model face is the surface's 2-2 flip. The best triangulation
//! is found by dynamic programming over the polygon (Klincsek 1980; Shewchuk 2002).
use super::access::Access;
use super::cavity::NewTet;
use super::criteria::{Criterion, mean_ratio_score, wanted_score};
use super::ids::{TetId, VertexId};
use super::outcome::Refusal;
use super::ring::{LONGEST_RING, Ring};
use super::shell::Shell;
use super::worker::Worker;

/// Tetrahedra below this mean ratio are worth the longest rings, which cost most and seldom gain.
const LONG_RINGS_BELOW: f64 = 0.5;

/// Tetrahedra below this mean ratio try rings of five: of 30 that are measured one gains.
const RINGS_OF_FIVE_BELOW: f64 = 0.75;

impl<A: Access> Worker<'_, '_, A> {
    /// Removes the edge a–b of a tetrahedron that holds still, when the criterion gains by it.
    pub fn remove_edge(&mut self, a: VertexId, b: VertexId, t: TetId, criterion: Criterion) -> Result<(), Refusal> {
        self.claim(a)?;
        self.claim(b)?;
        let longest = match self.store.quality(t) {
            quality if quality < LONG_RINGS_BELOW => LONGEST_RING,
            quality if quality < RINGS_OF_FIVE_BELOW => 5,
            _ => 4,
        };
        self.gather_shell_while(a, b, t, longest, |worker, other| worker.goes_first(t, other))?;
        if let [only] = self.state.shell.tets[..] {
            return self.shed(only, a, b);
        }
        let shell = std::mem::take(&mut self.state.shell);
        let result = self.remove_shell(a, b, &shell, criterion);
        self.state.shell = shell;
        result
    }

    fn remove_shell(&mut self, a: VertexId, b: VertexId, shell: &Shell, criterion: Criterion) -> Result<(), Refusal> {
        let n = shell.ring.len();
        if !(3..=LONGEST_RING).contains(&n) {
            return Err(Refusal::Topology);
        }
        let cost: f64 = shell.tets.iter().map(|&t| -mean_ratio_score(self.store.quality(t))).sum();
        if cost < self.context.limits.flip_cost * n as f64 {
            return Err(Refusal::Shape);
        }
        let surface = self.surface_flip(a, b, shell)?;
        // Model edges have surface triangles.
        if surface.is_some() && self.store.ridge_curve(a, b).is_some() {
            return Err(Refusal::Geometry);
        }
        let mut ring = self.state.ring.take().unwrap_or_default();
        ring.fill(self.store, [a, b], &shell.ring);
        let old = shell.tets.iter().map(|&t| self.present_score(criterion, t, ring.cavity()));
        let old = old.fold(criterion.nothing(), |x, y| criterion.join(x, y));
        let wanted = wanted_score(old);
        let gains = ring.is_feasible() && {
            match criterion {
                Criterion::MeanRatio => ring.score_mean_ratios(),
                _ => ring.score_each(criterion, |tet, cavity| self.score(criterion, tet, cavity)),
            }
            ring.triangulate(criterion, wanted)
        };
        if gains {
            self.write_triangulation([a, b], shell, &ring);
        }
        self.state.ring = Some(ring);
        if !gains {
            return Err(Refusal::Shape);
        }
        if let Some((old, new)) = surface {
            let facing = self.facing(&old);
            self.compare_normals(facing, &new, 0.0)?;
            self.refuse_joined(shell.ring[0], shell.ring[n - 1])?;
            self.state.replacement.faces.extend(new);
        }
        self.commit()
    }

    /// The two surface triangles at the edge and the two that would replace them; none inside.
    #[allow(clippy::type_complexity)]
    fn surface_flip(
        &self,
        a: VertexId,
        b: VertexId,
        shell: &Shell,
    ) -> Result<Option<([([VertexId; 3], u32); 2], [([VertexId; 3], u32); 2])>, Refusal> {
        let count = shell.surface_tags().count();
        if shell.closed {
            return if count == 0 { Ok(None) } else { Err(Refusal::Geometry) };
        }
        let (first, last) = (shell.ring[0], shell.ring[shell.ring.len() - 1]);
        let tag = shell.tags[0];
        if count != 2 || shell.tags[shell.tags.len() - 1] != tag {
            return Err(Refusal::Geometry);
        }
        let old = [([a, first, b], tag), ([a, b, last], tag)];
        let new = [([a, first, last], tag), ([first, b, last], tag)];
        Ok(Some((old, new)))
    }

    /// Refuses when the two claimed vertices are joined by an edge already.
    fn refuse_joined(&mut self, x: VertexId, y: VertexId) -> Result<(), Refusal> {
        let joined = self.with_passing_ball(x, |ball| ball.link.contains(&y));
        if joined { Err(Refusal::Topology) } else { Ok(()) }
    }

    fn write_triangulation(&mut self, [a, b]: [VertexId; 2], shell: &Shell, ring: &Ring) {
        let region = self.store.region(shell.tets[0]);
        self.state.replacement.clear();
        self.state.replacement.old.extend(&shell.tets);
        ring.each_triangle(|[x, y, z]| {
            for vertices in [[x, y, z, b], [x, z, y, a]] {
                let quality = self.shape(vertices);
                self.state.replacement.new.push(NewTet { vertices, region, quality });
            }
        });
    }
}
