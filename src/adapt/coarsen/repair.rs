//! Measures what a round of coarsening would leave. Vertices whose way would leave something bad get another way, or stay.
use super::level::{Balls, INSIDE, Level, is_proper, squares};
use super::rounds::{self, Region};
use super::surface::Surface;
use super::vertex_map::{self, VertexMap};
use crate::mesh::predicate::is_positive;
use crate::mesh::vector::Vec3;
use crate::metric::quality::mean_ratio;
use crate::metric::{Sym3, mean_ratios};
use crate::tasks::{GRAIN, Team};
use std::sync::atomic::Ordering::Relaxed;

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

/// What keeps a map from being carried out.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Fault {
    /// A tetrahedron that would be bad.
    Tet(u32),
    /// A triangle that would turn.
    Triangle(u32),
}

/// A level with the map that is to be repaired.
pub struct MapRepair<'l, 'm> {
    team: Team<'l>,
    level: &'l Level<'m>,
    balls: &'l Balls,
    surface: &'l Surface,
    map: &'l VertexMap,
}

/// The tetrahedra at a vertex that one of its ways would leave.
type Left = Vec<[u32; 4]>;

impl<'l, 'm> MapRepair<'l, 'm> {
    /// Of a level, with the tetrahedra at its vertices and its triangles.
    pub fn of(
        team: Team<'l>,
        level: &'l Level<'m>,
        balls: &'l Balls,
        surface: &'l Surface,
        map: &'l VertexMap,
    ) -> Self {
        Self { team, level, balls, surface, map }
    }

    /// Sends vertices another way, or lets them stay where there is none, until nothing bad would be left.
    pub fn repair(&self) {
        let (team, level, balls, map) = (self.team, self.level, self.balls, self.map);
        let mut faults = self.bad_tets();
        let turned = team.collect(GRAIN, level.triangles.len(), |range, turned| {
            turned.extend((range.start as u32..range.end as u32).filter(|&t| self.is_turned(t)).map(Fault::Triangle));
        });
        faults.extend(turned);
        let vertex = |fault| match fault {
            Fault::Tet(t) => level.tets[t as usize][0],
            Fault::Triangle(t) => level.triangles[t as usize][0],
        };
        let kept = rounds::in_rounds(team, level, balls, faults, vertex, |part, faults, left| {
            self.repair_part(part, faults, left)
        });
        // A vertex that stays because of something bad about it may have a way now, unless others go onto it.
        let led = map.led(team);
        rounds::in_rounds(
            team,
            level,
            balls,
            kept.concat(),
            |v| v,
            |part, kept, waits| {
                let mut left = Left::new();
                for &v in kept.iter().filter(|&&v| map.target(v) == v && !led[v as usize].load(Relaxed)) {
                    if !part.holds_ball(v) {
                        waits.push(v);
                    } else if self.turn(v, &mut left) {
                        led[map.target(v) as usize].store(true, Relaxed);
                    }
                }
            },
        );
    }

    /// Repairs what is bad in one part, and what becomes bad by that; adds to `waits` what needs other parts. Returns the vertices that stay now.
    fn repair_part(&self, part: &Region, faults: &[Fault], waits: &mut Vec<Fault>) -> Vec<u32> {
        let (mut kept, mut left) = (Vec::new(), Left::new());
        let (mut bad, mut turned) = (Vec::new(), Vec::new());
        for fault in faults {
            match *fault {
                Fault::Tet(t) => bad.push(t),
                Fault::Triangle(t) => turned.push(t),
            }
        }
        loop {
            let stays = if let Some(t) = turned.pop() {
                let nodes = &self.level.triangles[t as usize];
                if !nodes.iter().all(|&v| part.holds_ball(v)) {
                    waits.push(Fault::Triangle(t));
                    continue;
                }
                if self.is_turned(t) { self.map.keep_one(nodes) } else { None }
            } else if let Some(t) = bad.pop() {
                let nodes = &self.level.tets[t as usize];
                let is_held = nodes.iter().all(|&v| part.holds(v));
                if is_held && (self.is_fair(t) || self.turn_one(part, nodes, &mut left)) {
                    continue;
                }
                if !nodes.iter().all(|&v| part.holds_ball(v)) {
                    waits.push(Fault::Tet(t));
                    continue;
                }
                self.map.keep_one(nodes)
            } else {
                return kept;
            };
            if let Some(v) = stays {
                kept.push(v);
                bad.extend(self.balls.at(v).iter().filter(|&&t| !self.is_fair(t)));
                turned.extend(self.surface.at(v).iter().filter(|&&t| self.is_turned(t)));
            }
        }
    }

    /// Whether a triangle would turn.
    fn is_turned(&self, t: u32) -> bool {
        !self.surface.is_fair(self.level, t, self.map)
    }

    /// The tetrahedra that would be bad; those with an edge that gets too long come last.
    fn bad_tets(&self) -> Vec<Fault> {
        let level = self.level;
        let (bad, too_long): (Vec<_>, Vec<_>) = self
            .team
            .chunks(GRAIN, level.tets.len(), |range| {
                let (mut bad, mut too_long) = (Vec::new(), Vec::new());
                let numbered = level.tets[range.clone()].iter().zip(range.start as u32..);
                let left = numbered.filter_map(|(nodes, t)| {
                    let mapped = self.map.map(nodes);
                    if mapped == *nodes || !is_proper(&mapped) {
                        return None;
                    }
                    if self.gets_long(nodes, &mapped) {
                        too_long.push(Fault::Tet(t));
                        return None;
                    }
                    Some((t, mapped))
                });
                let corners = |(_, nodes): (u32, [u32; 4])| self.corners(nodes);
                mean_ratios(left, corners, |(t, _), ratio| {
                    if ratio < FLOOR {
                        bad.push(Fault::Tet(t));
                    }
                });
                (bad, too_long)
            })
            .into_iter()
            .unzip();
        bad.into_iter().chain(too_long).flatten().collect()
    }

    /// Points of the vertices of a tetrahedron, and ln M there.
    fn corners(&self, nodes: [u32; 4]) -> ([Vec3; 4], [Sym3; 4]) {
        (nodes.map(|v| self.level.corners[v as usize].point), nodes.map(|v| self.level.logs[v as usize]))
    }

    /// What becomes of a tetrahedron. The cheapest test comes first, and the mean ratio is not among them.
    #[inline]
    fn outcome(&self, t: u32) -> Outcome {
        let nodes = &self.level.tets[t as usize];
        let mapped = self.map.map(nodes);
        if mapped == *nodes || !is_proper(&mapped) {
            return Outcome::Nothing;
        }
        let is_fair =
            is_positive(mapped.map(|v| self.level.corners[v as usize].point)) && !self.gets_long(nodes, &mapped);
        if is_fair { Outcome::New(mapped) } else { Outcome::Bad }
    }

    /// Whether a tetrahedron is no problem: it vanishes, stays as it is, or is good enough.
    fn is_fair(&self, t: u32) -> bool {
        match self.outcome(t) {
            Outcome::Nothing => true,
            Outcome::Bad => false,
            Outcome::New(nodes) => {
                let (points, logs) = self.corners(nodes);
                mean_ratio(points, logs.each_ref()) >= FLOOR
            }
        }
    }

    /// Whether none of the tetrahedra at a vertex is a problem.
    fn is_ball_fair(&self, v: u32, left: &mut Left) -> bool {
        left.clear();
        for &t in self.balls.at(v) {
            match self.outcome(t) {
                Outcome::Nothing => {}
                Outcome::Bad => return false,
                Outcome::New(nodes) => left.push(nodes),
            }
        }
        let mut is_fair = true;
        mean_ratios(left.iter(), |&nodes| self.corners(nodes), |_, ratio| is_fair &= ratio >= FLOOR);
        is_fair
    }

    /// Sends one of the vertices of a bad tetrahedron another way, so that nothing bad is left about it.
    fn turn_one(&self, part: &Region, nodes: &[u32; 4], left: &mut Left) -> bool {
        nodes.iter().any(|&v| self.map.target(v) != v && part.holds_ball(v) && self.turn(v, left))
    }

    /// Sends a vertex inside onto another one that stays, the nearest first, so that nothing bad is left about it.
    fn turn(&self, v: u32, left: &mut Left) -> bool {
        let (level, map) = (self.level, self.map);
        if level.faces[v as usize] != INSIDE {
            return false;
        }
        let before = (map.target(v), map.way(v));
        let mut found = Found::default();
        for &t in self.balls.at(v) {
            for x in map.map(&level.tets[t as usize]) {
                if x != v && x != before.0 {
                    found.add(x);
                }
            }
        }
        let mut ways = [(f32::INFINITY, v); WAYS];
        let ways = &mut ways[..found.count];
        ways.iter_mut().zip(found.vertices).for_each(|(way, x)| *way = (vertex_map::distance(level, v, x), x));
        ways.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        for &(distance, x) in ways.iter().take(TRIED).filter(|way| way.0.is_finite()) {
            map.send(v, x, distance);
            if self.is_ball_fair(v, left) {
                return true;
            }
        }
        map.send(v, before.0, before.1);
        false
    }

    /// Whether an edge gets too long.
    fn gets_long(&self, nodes: &[u32; 4], mapped: &[u32; 4]) -> bool {
        let at = mapped.map(|v| &self.level.corners[v as usize]);
        let least = |[x, y]: [f64; 2]| x.min(y);
        for i in 1..4 {
            for j in 0..i {
                let length = least(squares(at[i], at[j]));
                if length > LONG * LONG && length > least(self.level.squares(nodes[i], nodes[j])) {
                    return true;
                }
            }
        }
        false
    }
}

/// The first vertices that are met, each once.
struct Found {
    vertices: [u32; WAYS],
    count: usize,
    /// One bit a class of vertices; where it is not set none of the class is among them.
    classes: u64,
}

impl Default for Found {
    fn default() -> Self {
        Self { vertices: [0; WAYS], count: 0, classes: 0 }
    }
}

impl Found {
    /// Adds a vertex, if it is not there and there is room.
    #[inline(always)]
    fn add(&mut self, x: u32) {
        let class = 1 << (x % u64::BITS);
        let is_new = self.classes & class == 0 || !self.vertices[..self.count].contains(&x);
        if is_new && self.count < WAYS {
            self.classes |= class;
            self.vertices[self.count] = x;
            self.count += 1;
        }
    }
}
