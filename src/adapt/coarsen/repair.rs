//! Measures what a round of coarsening would leave. Vertices whose way would leave something bad get another way, or stay.
use super::level::{Balls, INSIDE, Level, is_proper};
use super::surface::Surface;
use super::vertex_map::{self, VertexMap};
use crate::mesh::predicate::is_positive;
use crate::mesh::vector::Vec3;
use crate::metric::quality::mean_ratio;
use crate::metric::{Sym3, mean_ratios};

/// Least mean ratio of a new tetrahedron.
const FLOOR: f64 = 0.1;

/// Greatest length of a new edge, unless the edge that it comes from was longer.
const LONG: f64 = 2.0;

/// How many vertices near another are looked at; mostly there are no more.
const WAYS: usize = 24;

/// How many of these are tried, the nearest first.
const TRIED: usize = 8;

/// What becomes of a tetrahedron.
enum Outcome {
    /// It vanishes, or stays as it is.
    Nothing,
    /// One that is not positive, or has an edge that gets too long.
    Bad,
    /// One of other vertices.
    New([u32; 4]),
}

/// A level with the map that is to be repaired.
pub struct MapRepair<'l, 'm> {
    level: &'l Level<'m>,
    balls: &'l Balls,
    surface: &'l Surface,
    /// The tetrahedra at a vertex that one of its ways would leave.
    left: Vec<[u32; 4]>,
}

impl<'l, 'm> MapRepair<'l, 'm> {
    /// Of a level, with the tetrahedra at its vertices and its triangles.
    pub fn of(level: &'l Level<'m>, balls: &'l Balls, surface: &'l Surface) -> Self {
        Self { level, balls, surface, left: Vec::new() }
    }

    /// Sends vertices another way, or lets them stay where there is none, until nothing bad would be left.
    pub fn repair(&mut self, map: &mut VertexMap) {
        let (level, surface) = (self.level, self.surface);
        let is_turned = |t: &u32, map: &VertexMap| !surface.is_fair(level, *t, map);
        let mut bad = self.bad_tets(map);
        let mut turned: Vec<u32> = (0..level.triangles.len() as u32).filter(|t| is_turned(t, map)).collect();
        let mut kept = Vec::new();
        loop {
            let stays = if let Some(t) = turned.pop() {
                if is_turned(&t, map) { map.keep_one(&level.triangles[t as usize]) } else { None }
            } else if let Some(t) = bad.pop() {
                let repaired = self.is_fair(t, map) || self.turn_one(t, map);
                if repaired { None } else { map.keep_one(&level.tets[t as usize]) }
            } else {
                break;
            };
            if let Some(v) = stays {
                kept.push(v);
                bad.extend(self.balls.at(v).iter().filter(|&&t| !self.is_fair(t, map)));
                turned.extend(surface.at(v).iter().filter(|&t| is_turned(t, map)));
            }
        }
        // A vertex that stays because of something bad about it may have a way now, unless others go onto it.
        let mut led = map.led();
        for v in kept {
            if map.target(v) == v && !led[v as usize] && self.turn(v, map) {
                led[map.target(v) as usize] = true;
            }
        }
    }

    /// The tetrahedra that would be bad.
    fn bad_tets(&self, map: &VertexMap) -> Vec<u32> {
        let level = self.level;
        let (mut bad, mut too_long) = (Vec::new(), Vec::new());
        let left = level.tets.iter().zip(0..).filter_map(|(nodes, t)| {
            let mapped = map.map(nodes);
            if mapped == *nodes || !is_proper(&mapped) {
                return None;
            }
            if self.gets_long(nodes, &mapped) {
                too_long.push(t);
                return None;
            }
            Some((t, mapped))
        });
        let corners = |(_, nodes): (u32, [u32; 4])| self.corners(nodes);
        mean_ratios(left, corners, |(t, _), ratio| {
            if ratio < FLOOR {
                bad.push(t);
            }
        });
        bad.append(&mut too_long);
        bad
    }

    /// Points of the vertices of a tetrahedron, and ln M there.
    fn corners(&self, nodes: [u32; 4]) -> ([Vec3; 4], [Sym3; 4]) {
        (nodes.map(|v| self.level.points[v as usize]), nodes.map(|v| self.level.logs[v as usize]))
    }

    /// What becomes of a tetrahedron. The cheapest test comes first, and the mean ratio is not among them.
    #[inline]
    fn outcome(&self, t: u32, map: &VertexMap) -> Outcome {
        let nodes = &self.level.tets[t as usize];
        let mapped = map.map(nodes);
        if mapped == *nodes || !is_proper(&mapped) {
            return Outcome::Nothing;
        }
        let is_fair = is_positive(mapped.map(|v| self.level.points[v as usize])) && !self.gets_long(nodes, &mapped);
        if is_fair { Outcome::New(mapped) } else { Outcome::Bad }
    }

    /// Whether a tetrahedron is no problem: it vanishes, stays as it is, or is good enough.
    fn is_fair(&self, t: u32, map: &VertexMap) -> bool {
        match self.outcome(t, map) {
            Outcome::Nothing => true,
            Outcome::Bad => false,
            Outcome::New(nodes) => {
                let (points, logs) = self.corners(nodes);
                mean_ratio(points, logs.each_ref()) >= FLOOR
            }
        }
    }

    /// Whether none of the tetrahedra at a vertex is a problem.
    fn is_ball_fair(&mut self, v: u32, map: &VertexMap) -> bool {
        self.left.clear();
        for &t in self.balls.at(v) {
            match self.outcome(t, map) {
                Outcome::Nothing => {}
                Outcome::Bad => return false,
                Outcome::New(nodes) => self.left.push(nodes),
            }
        }
        let mut is_fair = true;
        mean_ratios(self.left.iter(), |&nodes| self.corners(nodes), |_, ratio| is_fair &= ratio >= FLOOR);
        is_fair
    }

    /// Sends one of the vertices of a bad tetrahedron another way, so that nothing bad is left about it.
    fn turn_one(&mut self, t: u32, map: &mut VertexMap) -> bool {
        let nodes = self.level.tets[t as usize];
        nodes.into_iter().any(|v| map.target(v) != v && self.turn(v, map))
    }

    /// Sends a vertex inside onto another one that stays, the nearest first, so that nothing bad is left about it.
    fn turn(&mut self, v: u32, map: &mut VertexMap) -> bool {
        if self.level.faces[v as usize] != INSIDE {
            return false;
        }
        let before = map.target(v);
        let mut found = [(f32::INFINITY, v); WAYS];
        let mut count = 0;
        map.look_around();
        for &t in self.balls.at(v) {
            for x in map.map(&self.level.tets[t as usize]) {
                if x != v && x != before && count < WAYS && map.is_new(x) {
                    found[count] = (vertex_map::distance(self.level, v, x), x);
                    count += 1;
                }
            }
        }
        found[..count].sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        for &(distance, x) in found[..count].iter().take(TRIED).filter(|way| way.0.is_finite()) {
            let before = map.send(v, x, distance);
            if self.is_ball_fair(v, map) {
                return true;
            }
            map.send(v, before.0, before.1);
        }
        false
    }

    /// Whether an edge gets too long.
    fn gets_long(&self, nodes: &[u32; 4], mapped: &[u32; 4]) -> bool {
        let least = |a: u32, b: u32| {
            let [x, y] = self.level.squares(a, b);
            x.min(y)
        };
        for i in 1..4 {
            for j in 0..i {
                let length = least(mapped[i], mapped[j]);
                if length > LONG * LONG && length > least(nodes[i], nodes[j]) {
                    return true;
                }
            }
        }
        false
    }
}
