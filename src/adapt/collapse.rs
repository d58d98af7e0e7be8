//! Edge collapse: a vertex goes, its ball becomes a star about a neighbour.
use super::access::Access;
use super::ids::{FACE, TetId, VertexId};
use super::insert::EdgeItem;
use super::outcome::Refusal;
use super::star::{Bounds, Seed};
use super::worker::Worker;
use crate::geometry::Entity;

impl<A: Access> Worker<'_, '_, A> {
    /// Collapses an edge that is too short: of its two ends the one whose removal leaves the better elements.
    pub fn collapse_edge(&mut self, item: EdgeItem) -> Result<(), Refusal> {
        let EdgeItem { a, b, tet } = item;
        self.claim_live(a)?;
        self.claim_live(b)?;
        self.tet_with_edge(a, b, tet)?;
        if self.length(a, b) >= self.context.limits.short {
            return Err(Refusal::Stale);
        }
        let onto_a = self.try_collapse(b, a, 0.0);
        match (onto_a, self.try_collapse(a, b, onto_a.unwrap_or(0.0))) {
            (_, Ok(_)) => self.finish_collapse(a, b),
            (Ok(_), Err(_)) => self.try_collapse(b, a, 0.0).and_then(|_| self.finish_collapse(b, a)),
            (Err(Refusal::Conflict), _) | (_, Err(Refusal::Conflict)) => Err(Refusal::Conflict),
            (Err(_), Err(_)) => self.merge(a, b),
        }
    }

    /// Prepares the removal of v onto its neighbour w; returns the worst mean ratio after it, which is at least `better`.
    pub fn try_collapse(&mut self, v: VertexId, w: VertexId, better: f64) -> Result<f64, Refusal> {
        self.check_entities(v, w)?;
        self.check_bend(v, w)?;
        self.gather_ball(v)?;
        let ball = std::mem::take(&mut self.state.ball);
        let result = self.check_new_lengths(v, w, &ball).and_then(|()| self.collapse_star(v, w, &ball, better));
        self.state.ball = ball;
        let worst = result?;
        if !self.state.star.surface.is_empty() {
            self.check_surface_link(v, w)?;
            self.check_normals(0.0)?;
        }
        Ok(worst)
    }

    /// No new edge may be longer than the limit and than the longest one that goes.
    fn check_new_lengths(&mut self, v: VertexId, w: VertexId, ball: &[TetId]) -> Result<(), Refusal> {
        self.list_link(v, ball);
        let link = &self.state.star.link;
        let limit = self.context.limits.longest_new;
        let longest = |x: VertexId| link.iter().map(|&y| self.length(x, y)).fold(0.0, f64::max);
        let too_long = link.iter().any(|&x| x != w && self.length(w, x) > limit);
        if too_long && longest(w) > longest(v) { Err(Refusal::Length) } else { Ok(()) }
    }

    fn collapse_star(&mut self, v: VertexId, w: VertexId, ball: &[TetId], better: f64) -> Result<f64, Refusal> {
        let worst_old = ball.iter().map(|&t| self.store.quality(t)).fold(f64::INFINITY, f64::min);
        let floor = self.context.limits.collapse_floor.min(worst_old).max(better);
        self.build_star(Seed::Vertex(v), w, ball, Bounds { wanted: 0.0, floor })
    }

    /// Carries out what [`Worker::try_collapse`] prepared last.
    pub fn finish_collapse(&mut self, v: VertexId, w: VertexId) -> Result<(), Refusal> {
        let ends = (self.store.dimension(v) == 1).then(|| self.store.ridge(v));
        self.commit()?;
        if let Some([x, y]) = ends {
            let other = if x == w { y } else { x };
            self.store.redirect_ridge(other, v, w);
            self.store.redirect_ridge(w, v, other);
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
                    // The input's ridge ends here.
                    return Err(Refusal::Geometry);
                }
                self.claim(other)?;
                // A closed edge keeps at least three mesh edges; two corners may be joined once only.
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

    /// Least spread of the two ridge edges at a vertex on a model edge, 1 elsewhere.
    pub fn spread_at(&mut self, v: VertexId) -> f64 {
        let Entity::Edge(curve) = self.store.entity(v) else { return 1.0 };
        let ends = self.store.ridge(v).into_iter().filter(|x| x.is_some());
        ends.fold(1.0, |least, x| self.ridge_spread(curve, v, x).min(least))
    }

    /// The ridge edge that comes with a collapse may not span more of a bend than is good enough, or than one that goes.
    fn check_bend(&mut self, v: VertexId, w: VertexId) -> Result<(), Refusal> {
        let Entity::Edge(curve) = self.store.entity(v) else { return Ok(()) };
        let limit = self.spread_at(v).min(self.context.limits.spread);
        let [x, y] = self.store.ridge(v);
        let other = if x == w { y } else { x };
        if self.ridge_spread(curve, other, w) < limit { Err(Refusal::Normal) } else { Ok(()) }
    }

    /// The link condition on the surface: who neighbours both v and w there must share a triangle with both.
    pub fn check_surface_link(&mut self, v: VertexId, w: VertexId) -> Result<(), Refusal> {
        self.collect_ball(w);
        let mut near_w = std::mem::take(&mut self.state.set);
        near_w.clear();
        for &t in &self.state.ball {
            let (vertices, tags) = (self.store.vertices(t), self.store.tags(t));
            for i in (0..4).filter(|&i| tags[i] != 0) {
                let face = FACE[i].map(|k| vertices[k]);
                if face.contains(&w) && !face.contains(&v) {
                    face.iter().for_each(|x| {
                        near_w.insert(x.0);
                    });
                }
            }
        }
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
        self.state.set = near_w;
        if pinched { Err(Refusal::Topology) } else { Ok(()) }
    }
}
