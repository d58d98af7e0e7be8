//! Edge collapse: a vertex goes, its ball becomes a star about a neighbour.
use super::access::Access;
use super::ids::{FACE, VertexId};
use super::insert::EdgeItem;
use super::outcome::Refusal;
use super::star::Seed;
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
        match (self.try_collapse(a, b), self.try_collapse(b, a)) {
            (Ok(first), Ok(second)) if first > second => self.try_collapse(a, b).and_then(|_| self.finish_collapse(a, b)),
            (_, Ok(_)) => self.finish_collapse(b, a),
            (Ok(_), Err(_)) => self.try_collapse(a, b).and_then(|_| self.finish_collapse(a, b)),
            (Err(Refusal::Geometry), Err(refusal)) | (Err(refusal), Err(_)) => Err(refusal),
        }
    }

    /// Prepares the removal of v onto its neighbour w; returns the worst mean ratio after it.
    pub fn try_collapse(&mut self, v: VertexId, w: VertexId) -> Result<f64, Refusal> {
        let limits = self.context.limits;
        self.check_entities(v, w)?;
        self.gather_ball(v)?;
        let ball = std::mem::take(&mut self.state.ball);
        let result = self.collapse_star(v, w, &ball);
        let longest_old = ball.iter().flat_map(|&t| self.store.vertices(t));
        let longest_old = longest_old.filter(|&x| x != v).map(|x| self.length(v, x)).fold(0.0, f64::max);
        self.state.ball = ball;
        let worst = result?;
        if self.star_lengths(w).1 > limits.longest_new.max(longest_old) {
            return Err(Refusal::Length);
        }
        if !self.state.star.surface.is_empty() {
            self.check_surface_link(v, w)?;
            self.check_normals(0.0)?;
        }
        Ok(worst)
    }

    fn collapse_star(&mut self, v: VertexId, w: VertexId, ball: &[super::ids::TetId]) -> Result<f64, Refusal> {
        let floor = self.context.limits.collapse_floor;
        let worst = self.build_star(Seed::Vertex(v), w, ball, 0.0)?;
        if worst >= floor.min(self.worst_old()) { Ok(worst) } else { Err(Refusal::Shape) }
    }

    /// Carries out what [`Worker::try_collapse`] prepared last.
    fn finish_collapse(&mut self, v: VertexId, w: VertexId) -> Result<(), Refusal> {
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
    fn check_entities(&mut self, v: VertexId, w: VertexId) -> Result<(), Refusal> {
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

    /// The link condition on the surface: who neighbours both v and w there must share a triangle with both.
    fn check_surface_link(&mut self, v: VertexId, w: VertexId) -> Result<(), Refusal> {
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
        let beside = |x: VertexId| surface.iter().any(|(face, _)| face.contains(&w) && face.contains(&x));
        let around = surface.iter().flat_map(|&(face, _)| face).filter(|&x| x != v && x != w);
        let mut pinched = false;
        for x in around {
            pinched |= near_w.contains(x.0) && !beside(x);
        }
        self.state.set = near_w;
        if pinched { Err(Refusal::Topology) } else { Ok(()) }
    }
}
