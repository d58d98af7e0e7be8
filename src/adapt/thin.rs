//! Thinning: where vertices are far too many, each that has a short edge goes onto a neighbour, no two near each other in one sweep.
//!
//! Before the sizes are brought about edge by edge: it gathers one ball for a vertex and changes records where they are. That a
//! neighbourhood changes but once in a sweep makes the mesh coarser everywhere alike and lets no vertex get many neighbours.
use super::access::Access;
use super::ball::Ball;
use super::ids::{FACE, TetId, VertexId};
use super::outcome::Refusal;
use super::shape::is_shorter;
use super::worker::Worker;
use crate::geometry::Entity;
use crate::mesh::vector::sub;
use crate::metric::lanes::LANES;

/// Neighbours that a vertex is tried on, the nearest first.
const TARGETS: usize = 4;

/// A tetrahedron of the ball that stays, with a vertex replaced.
#[derive(Clone, Copy)]
struct Kept {
    tet: TetId,
    /// Which of its vertices is replaced.
    local: usize,
    quality: f64,
}

/// What becomes of the ball of a vertex that goes. Allocated once.
#[derive(Default)]
pub struct Thinning {
    kept: Vec<Kept>,
    /// Tetrahedra at the edge that goes, with the places in them of the vertex that goes and of the one that it goes onto.
    gone: Vec<(TetId, [usize; 2])>,
}

/// The nearest neighbours so far, with the fourth powers of their distances.
struct Nearest {
    found: [(f64, VertexId); TARGETS],
    count: usize,
}

impl Nearest {
    fn add(&mut self, fourth_power: f64, v: VertexId) {
        let mut at = self.count.min(TARGETS - 1);
        if self.count == TARGETS && self.found[at].0 <= fourth_power {
            return;
        }
        while at > 0 && self.found[at - 1].0 > fourth_power {
            self.found[at] = self.found[at - 1];
            at -= 1;
        }
        self.found[at] = (fourth_power, v);
        self.count = (self.count + 1).min(TARGETS);
    }
}

impl<A: Access> Worker<'_, '_, A> {
    /// Removes a vertex that has a short edge, if nothing near it has changed in this sweep.
    pub fn thin(&mut self, v: VertexId) -> Result<(), Refusal> {
        self.claim_live(v)?;
        if self.store.stamp(self.store.tet_of(v)) == self.store.clock() {
            return Err(Refusal::Stale);
        }
        if self.context.is_frozen(v) || self.store.dimension(v) == 0 {
            return Err(Refusal::Geometry);
        }
        let mut ball = std::mem::take(&mut self.state.ball);
        let result = self.gather_ball(v, &mut ball).and_then(|()| self.thin_ball(v, &ball));
        self.state.ball = ball;
        result
    }

    fn thin_ball(&mut self, v: VertexId, ball: &Ball) -> Result<(), Refusal> {
        let nearest = self.nearest(v, &ball.link);
        let mut result = Err(Refusal::Stale);
        for &(_, w) in &nearest.found[..nearest.count] {
            result = match self.store.entity(v) {
                Entity::Interior => self.thin_onto(v, w, ball),
                _ => self.try_collapse(v, w, ball, 0.0).and_then(|_| self.finish_collapse(v, w)),
            };
            if matches!(result, Ok(()) | Err(Refusal::Conflict)) {
                break;
            }
        }
        result
    }

    /// The ends of the shortest of the edges at v that are too short; of a boundary vertex those on the boundary.
    fn nearest(&self, v: VertexId, link: &[VertexId]) -> Nearest {
        let (p, metric, dimension) = (self.store.position(v), self.store.metric(v), self.store.dimension(v));
        let limit = self.context.limits.short;
        let mut nearest = Nearest { found: [(0.0, VertexId::NONE); TARGETS], count: 0 };
        for &x in link {
            let e = sub(self.store.position(x), p);
            let at_v = metric.quadratic(e);
            // Lengths in the metrics of both ends seldom differ by so much.
            if at_v > 4.0 * limit * limit || (dimension < 3 && self.store.dimension(x) > dimension) {
                continue;
            }
            let at_x = self.store.metric(x).quadratic(e);
            if is_shorter(at_v, at_x, limit) {
                nearest.add(at_v * at_x, x);
            }
        }
        nearest
    }

    /// Replaces an inner vertex by a neighbour. Where all tetrahedra that stay are positive the mesh is as good as it was: they fill
    /// the ball once.
    fn thin_onto(&mut self, v: VertexId, w: VertexId, ball: &Ball) -> Result<(), Refusal> {
        // An edge between other vertices is one of a tetrahedron that stays, too.
        self.context.required.check(self.store, &ball.tets, &[v], |x, y| x != v && y != v)?;
        self.check_new_lengths(v, w, &ball.link)?;
        let mut thinning = std::mem::take(&mut self.state.thinning);
        let result = self.sort_ball(v, w, ball, &mut thinning);
        if result.is_ok() {
            self.replace_vertex(v, w, &thinning);
        }
        self.state.thinning = thinning;
        result
    }

    /// Parts the ball of v into what goes with the edge v–w and what stays, with w in the place of v.
    fn sort_ball(&mut self, v: VertexId, w: VertexId, ball: &Ball, thinning: &mut Thinning) -> Result<(), Refusal> {
        thinning.kept.clear();
        thinning.gone.clear();
        for &tet in &ball.tets {
            let vertices = self.store.vertices(tet);
            let place = |x: VertexId| vertices.iter().position(|&y| y == x);
            match (place(v), place(w)) {
                (Some(of_v), Some(of_w)) => thinning.gone.push((tet, [of_v, of_w])),
                (Some(local), None) => thinning.kept.push(Kept { tet, local, quality: 0.0 }),
                (None, _) => return Err(Refusal::Topology),
            }
        }
        let floor = self.context.limits.collapse_floor.min(self.worst_of(&ball.tets));
        let (point, log) = (self.store.position(w), self.store.log(w));
        let (store, batch) = (self.store, &mut self.state.batch);
        for some in thinning.kept.chunks_mut(LANES) {
            for lane in 0..LANES {
                let Kept { tet, local, .. } = some[lane.min(some.len() - 1)];
                let vertices = store.vertices(tet);
                let face = FACE[local].map(|k| vertices[k]);
                let logs = face.map(|x| store.log(x));
                batch.set(lane, face.map(|x| store.position(x)), logs.each_ref());
            }
            batch.prepare();
            let qualities = batch.shapes(point, &log).mean_ratios();
            for (kept, quality) in some.iter_mut().zip(qualities) {
                if quality <= 0.0 {
                    return Err(Refusal::Inverted);
                }
                if quality < floor {
                    return Err(Refusal::Shape);
                }
                kept.quality = quality;
            }
        }
        Ok(())
    }

    /// Writes w in the place of v, joins what lay on both sides of the tetrahedra that go.
    fn replace_vertex(&mut self, v: VertexId, w: VertexId, thinning: &Thinning) {
        let store = self.store;
        for &Kept { tet, local, quality } in &thinning.kept {
            store.set_vertex(tet, local, w);
            store.set_quality(tet, quality);
            store.touch(tet);
            store.vertices(tet).iter().for_each(|&x| store.set_tet_of(x, tet));
        }
        let place = |at: TetId, of: TetId| store.neighbours(at).iter().position(|&n| n == of);
        for &(tet, [of_v, of_w]) in &thinning.gone {
            let (neighbours, tag) = (store.neighbours(tet), store.tags(tet)[of_v]);
            let (beyond, kept) = (neighbours[of_v], neighbours[of_w]);
            let side = place(kept, tet).expect("neighbours know each other");
            store.set_neighbour(kept, side, beyond);
            store.set_tag(kept, side, tag);
            if beyond.is_some() {
                store.set_neighbour(beyond, place(beyond, tet).expect("neighbours know each other"), kept);
            }
        }
        for &(tet, _) in &thinning.gone {
            store.kill_tet(tet);
            self.state.supply.free_tet(tet);
        }
        store.set_tet_of(v, TetId::NONE);
        self.state.supply.free_vertex(v);
    }
}
