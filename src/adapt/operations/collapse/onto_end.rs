//! Edge collapse: a vertex goes, its ball becomes a star about a neighbour.
use crate::adapt::core::access::Access;
use crate::adapt::core::ball::Ball;
use crate::adapt::core::edge_list::EdgeItem;
use crate::adapt::core::ids::{FACE, TetId, VertexId};
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::star::{Bounds, Seed};
use crate::adapt::core::worker::Worker;
use crate::adapt::schedule::Operation;
use crate::geometry::Entity;
use crate::mesh::stamped_set::StampedSet;

/// An edge shorter than this share of what is too short may be collapsed at the price of a bad tetrahedron, which later operations repair. In no other
/// way can the fine ring about the apex of a cone go (docs/decisions/surface.md).
const MUCH: f64 = 0.3;

/// What a collapse needs at hand. Allocated once.
#[derive(Default)]
pub struct CollapseScratch {
    /// The ball of the second end.
    pub other_ball: Ball,
    /// The tetrahedra at either end.
    pub union: Vec<TetId>,
    /// Vertices on the surface beside one end.
    beside: StampedSet,
}

/// Collapses edges that are too short.
pub struct Collapse;

impl Operation for Collapse {
    type Item = EdgeItem;
    type Scratch = CollapseScratch;
    const WHOLE_BALLS: bool = true;
    const EFFORT: usize = 4;

    fn attempt<A: Access>(
        &self,
        worker: &mut Worker<'_, '_, A>,
        scratch: &mut CollapseScratch,
        item: EdgeItem,
    ) -> Result<(), Refusal> {
        worker.collapse_edge(scratch, item)
    }
}

impl<A: Access> Worker<'_, '_, A> {
    /// Collapses an edge that is too short: of its two ends the one whose removal leaves the better elements.
    pub fn collapse_edge(&mut self, scratch: &mut CollapseScratch, item: EdgeItem) -> Result<(), Refusal> {
        let EdgeItem { a, b, .. } = item;
        self.claim_live(a)?;
        self.claim_live(b)?;
        if !self.is_shorter(a, b, self.context.limits.short) {
            return Err(Refusal::Stale);
        }
        let mut balls = [std::mem::take(&mut self.state.ball), std::mem::take(&mut scratch.other_ball)];
        let gathered = self.gather_ball(a, &mut balls[0]).and_then(|()| match balls[0].link.contains(&b) {
            true => self.gather_ball(b, &mut balls[1]),
            false => Err(Refusal::Stale),
        });
        let result = gathered.and_then(|()| self.collapse_between(scratch, [a, b], [&balls[0], &balls[1]]));
        [self.state.ball, scratch.other_ball] = balls;
        result
    }

    fn collapse_between(
        &mut self,
        scratch: &mut CollapseScratch,
        [a, b]: [VertexId; 2],
        [of_a, of_b]: [&Ball; 2],
    ) -> Result<(), Refusal> {
        let onto_a = self.try_collapse(scratch, b, a, of_b, 0.0);
        match (onto_a, self.try_collapse(scratch, a, b, of_a, onto_a.unwrap_or(0.0))) {
            (_, Ok(_)) => self.finish_collapse(a, b),
            (Ok(_), Err(_)) => self.try_collapse(scratch, b, a, of_b, 0.0).and_then(|_| self.finish_collapse(b, a)),
            (Err(Refusal::Conflict), _) | (_, Err(Refusal::Conflict)) => Err(Refusal::Conflict),
            (Err(_), Err(_)) => self.merge(scratch, a, b, [of_a, of_b]),
        }
    }

    /// Prepares the removal of v onto its neighbour w; returns the worst mean ratio after it, which is at least `better`.
    pub fn try_collapse(
        &mut self,
        scratch: &mut CollapseScratch,
        v: VertexId,
        w: VertexId,
        ball: &Ball,
        better: f64,
    ) -> Result<f64, Refusal> {
        self.check_new_lengths(v, w, &ball.link)?;
        self.check_entities(v, w)?;
        self.check_ridge_variation(v, w)?;
        let worst = self.collapse_star(v, w, &ball.tets, better)?;
        if !self.state.star.surface.is_empty() {
            self.check_surface_link(scratch, v, w)?;
            self.check_normals(0.0)?;
        }
        Ok(worst)
    }

    /// No new edge may be longer than the limit and than the longest one that goes.
    pub fn check_new_lengths(&self, v: VertexId, w: VertexId, link: &[VertexId]) -> Result<(), Refusal> {
        let limit = self.context.limits.longest_new;
        if !link.iter().any(|&x| x != w && self.is_longer(w, x, limit)) {
            return Ok(());
        }
        if !link.iter().any(|&x| self.is_longer(v, x, limit)) {
            return Err(Refusal::Length);
        }
        let longest = |x: VertexId| link.iter().filter(|&&y| y != x).map(|&y| self.length(x, y)).fold(0.0, f64::max);
        if longest(w) > longest(v) { Err(Refusal::Length) } else { Ok(()) }
    }

    fn collapse_star(&mut self, v: VertexId, w: VertexId, ball: &[TetId], better: f64) -> Result<f64, Refusal> {
        let limits = &self.context.limits;
        let share = (self.length(v, w) / (MUCH * limits.short)).min(1.0);
        let floor = (share * limits.collapse_floor.min(self.worst_of(ball))).max(better);
        self.build_star(Seed::Vertex(v), w, ball, Bounds { wanted: 0.0, floor })
    }

    /// Carries out what [`Worker::try_collapse`] prepared last.
    pub fn finish_collapse(&mut self, v: VertexId, w: VertexId) -> Result<(), Refusal> {
        let ends = (self.store.dimension(v) == 1).then(|| self.store.ridge(v));
        self.commit()?;
        if let Some([x, y]) = ends {
            let other = if x == w { y } else { x };
            self.join_ridge(other, v, w);
        }
        Ok(())
    }

    /// A vertex may only be removed along the entity that it lies on.
    pub fn check_entities(&mut self, v: VertexId, w: VertexId) -> Result<(), Refusal> {
        if self.context.is_frozen(v) {
            return Err(Refusal::Geometry);
        }
        match self.store.entity(v) {
            Entity::Vertex(_) => Err(Refusal::Geometry),
            Entity::Edge(curve) => {
                if self.store.ridge_curve(v, w) != Some(curve) {
                    return Err(Refusal::Geometry);
                }
                let [x, y] = self.store.ridge(v);
                let other = if x == w { y } else { x };
                if !other.is_some() {
                    // A ridge of the input ends here.
                    return Err(Refusal::Geometry);
                }
                self.claim(other)?;
                // A closed model edge keeps at least three mesh edges, and two corners may be joined by one mesh edge only.
                match self.store.ridge_curve(other, w) {
                    Some(_) => Err(Refusal::Topology),
                    None => Ok(()),
                }
            }
            Entity::Face(face) => {
                let tet = self.tet_with_edge(v, w, self.store.tet_of(v))?;
                self.gather_shell(v, w, tet)?;
                match self.state.shell.surface_tags().any(|tag| tag == face + 1) {
                    true => Ok(()),
                    false => Err(Refusal::Geometry),
                }
            }
            Entity::Interior => Ok(()),
        }
    }

    /// The lesser cosine of variation of the two ridge edges at a vertex on a model edge; 1 elsewhere.
    pub fn ridge_variation_at(&mut self, v: VertexId) -> f64 {
        let Entity::Edge(curve) = self.store.entity(v) else { return 1.0 };
        let ends = self.store.ridge(v).into_iter().filter(|x| x.is_some());
        ends.fold(1.0, |least, x| self.ridge_variation(curve, v, x).min(least))
    }

    /// Along the new ridge edge the model's tangent may not vary more than the limit, or than along the ridge edges that go.
    fn check_ridge_variation(&mut self, v: VertexId, w: VertexId) -> Result<(), Refusal> {
        let Entity::Edge(curve) = self.store.entity(v) else { return Ok(()) };
        let limit = self.ridge_variation_at(v).min(self.context.limits.cos_variation);
        let [x, y] = self.store.ridge(v);
        let other = if x == w { y } else { x };
        if self.ridge_variation(curve, other, w) < limit { Err(Refusal::Normal) } else { Ok(()) }
    }

    /// The link condition on the surface: a vertex that neighbours both v and w there must be in a triangle with both.
    pub fn check_surface_link(
        &mut self,
        scratch: &mut CollapseScratch,
        v: VertexId,
        w: VertexId,
    ) -> Result<(), Refusal> {
        let near_w = &mut scratch.beside;
        near_w.clear();
        let store = self.store;
        self.with_passing_ball(w, |ball| {
            for &t in &ball.tets {
                let (vertices, tags) = (store.vertices(t), store.tags(t));
                for i in (0..4).filter(|&i| tags[i] != 0) {
                    let face = FACE[i].map(|k| vertices[k]);
                    if face.contains(&w) && !face.contains(&v) {
                        face.iter().for_each(|x| {
                            near_w.insert(x.0);
                        });
                    }
                }
            }
        });
        let surface = &self.state.star.surface;
        let beside = |x: VertexId| surface.iter().any(|(face, _)| [v, w, x].iter().all(|y| face.contains(y)));
        let around = surface
            .iter()
            .filter(|(face, _)| face.contains(&v))
            .flat_map(|&(face, _)| face)
            .filter(|&x| x != v && x != w);
        let mut pinched = false;
        for x in around {
            pinched |= near_w.contains(x.0) && !beside(x);
        }
        if pinched { Err(Refusal::Topology) } else { Ok(()) }
    }
}
