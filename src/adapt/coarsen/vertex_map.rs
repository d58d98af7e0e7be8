//! Which vertices stay, and onto which of them the others go.
use super::level::{Balls, FIXED, INSIDE, Level, is_proper};
use super::rounds;
use super::surface::Surface;
use crate::tasks::{GRAIN, Team};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

/// Edges shorter than this in the metrics of both ends may vanish.
const SHORT: f64 = 0.85;

const OPEN: u32 = u32::MAX;

/// What becomes of the vertices: some stay, the others go onto them. Several threads may change it at once, each for vertices of its own.
pub struct VertexMap {
    /// For each vertex the one that it goes onto; itself where it stays; [`OPEN`] where that is not decided.
    targets: Vec<AtomicU32>,
    /// Fourth powers of the distances to these, as the bits of an `f32`.
    ways: Vec<AtomicU32>,
}

/// A word a vertex.
fn words(count: usize, word: u32) -> Vec<AtomicU32> {
    (0..count).map(|_| AtomicU32::new(word)).collect()
}

impl VertexMap {
    /// Vertices on edges of the model come first, then those on its faces, then those inside, part by part. A vertex stays when no vertex that
    /// stays is near it; else it goes onto the nearest of these.
    pub fn of(team: Team<'_>, level: &Level, balls: &Balls, surface: &Surface) -> Self {
        let count = level.points.len();
        let map = Self { targets: words(count, OPEN), ways: words(count, f32::INFINITY.to_bits()) };
        let those = |wanted: fn(u32) -> bool| {
            team.collect(GRAIN, count, |range, found| {
                found.extend((range.start as u32..range.end as u32).filter(|&v| wanted(level.faces[v as usize])));
            })
        };
        let boundary = [those(|face| face == FIXED), those(|face| face < FIXED)].concat();
        for &v in &boundary {
            if map.stays(v) {
                surface.neighbours(level, v, |x| map.offer_target(level, v, x));
            }
        }
        // Who offered itself last to a vertex.
        let seen = words(count, OPEN);
        let attract = |v: u32| {
            for &t in balls.at(v) {
                for x in level.tets[t as usize] {
                    let seen = &seen[x as usize];
                    if x != v && seen.load(Relaxed) != v && level.faces[x as usize] == INSIDE {
                        seen.store(v, Relaxed);
                        map.offer_target(level, v, x);
                    }
                }
            }
        };
        boundary.into_iter().filter(|&v| map.target(v) == v).for_each(attract);
        rounds::in_rounds(
            team,
            level,
            balls,
            those(|face| face == INSIDE),
            |v| v,
            |part, vertices, left| {
                for &v in vertices.iter().filter(|&&v| map.target(v) == OPEN) {
                    if part.holds_ball(v) {
                        map.send(v, v, 0.0);
                        attract(v);
                    } else {
                        left.push(v);
                    }
                }
            },
        );
        map
    }

    /// Lets a vertex stay, unless it goes already.
    fn stays(&self, v: u32) -> bool {
        if self.target(v) == OPEN {
            self.send(v, v, 0.0);
        }
        self.target(v) == v
    }

    /// Offers v, which stays, as a target to a vertex that is joined to it.
    #[inline]
    fn offer_target(&self, level: &Level, v: u32, x: u32) {
        let distance = distance(level, v, x);
        if distance < self.way(x) {
            self.send(x, v, distance);
        }
    }

    /// The vertex that a vertex goes onto: itself where it stays.
    #[inline(always)]
    pub fn target(&self, v: u32) -> u32 {
        self.targets[v as usize].load(Relaxed)
    }

    /// Fourth power of the distance of a vertex to its target.
    #[inline(always)]
    pub fn way(&self, v: u32) -> f32 {
        f32::from_bits(self.ways[v as usize].load(Relaxed))
    }

    /// An element with its vertices replaced by their targets.
    #[inline(always)]
    pub fn map<const N: usize>(&self, nodes: &[u32; N]) -> [u32; N] {
        nodes.map(|v| self.target(v))
    }

    /// Sends a vertex onto another.
    #[inline]
    pub fn send(&self, v: u32, target: u32, distance: f32) {
        self.targets[v as usize].store(target, Relaxed);
        self.ways[v as usize].store(distance.to_bits(), Relaxed);
    }

    /// The numbers of the elements of which no two vertices meet.
    pub fn left<const N: usize>(&self, team: Team<'_>, elements: &[[u32; N]]) -> Vec<u32> {
        team.collect(GRAIN, elements.len(), |range, left| {
            let numbered = elements[range.clone()].iter().zip(range.start as u32..);
            left.extend(numbered.filter(|(nodes, _)| is_proper(&self.map(nodes))).map(|(_, element)| element));
        })
    }

    /// For each vertex whether others go onto it.
    pub fn led(&self, team: Team<'_>) -> Vec<AtomicBool> {
        let led: Vec<AtomicBool> = bytemuck::allocation::zeroed_vec(self.targets.len());
        team.for_each(GRAIN, led.len(), |range| {
            for v in range.start as u32..range.end as u32 {
                let target = self.target(v);
                if target != v {
                    led[target as usize].store(true, Relaxed);
                }
            }
        });
        led
    }

    /// Of the vertices of an element, lets the one with the longest way stay. None where all stay already.
    pub fn keep_one(&self, nodes: &[u32]) -> Option<u32> {
        let goes = nodes.iter().copied().filter(|&v| self.target(v) != v);
        let v = goes.max_by(|&a, &b| self.way(a).total_cmp(&self.way(b)))?;
        self.send(v, v, 0.0);
        Some(v)
    }
}

/// Fourth power of the length of an edge, infinite where it is not short in the metrics of both ends. Single precision is enough to
/// choose by.
#[inline(always)]
pub fn distance(level: &Level, a: u32, b: u32) -> f32 {
    let [at_a, at_b] = level.squares(a, b);
    if at_a < SHORT * SHORT && at_b < SHORT * SHORT { (at_a * at_b).max(0.0) as f32 } else { f32::INFINITY }
}
