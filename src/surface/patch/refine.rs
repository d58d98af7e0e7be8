//! Which edges of a face are too long.
use super::super::edges::{STRETCH, angle};
use super::super::plane::NONE;
use super::super::{GoOn, Options, Wish};
use super::{Patch, sample};
use crate::geometry::OcctEvaluator;
use crate::mesh::adjacency::sorted2;
use crate::mesh::vector::{Vec3, distance, dot, lerp, norm, sub};
use std::cmp::Ordering;
use std::collections::{BTreeSet, HashSet};

/// Rounds of halving at most.
const ROUNDS: usize = 40;
/// Triangles of a face at most.
const TRIANGLES: usize = 400_000;
/// The curvature across an edge divides it only if it is longer than this share of its face.
const ACROSS: f64 = 1.0 / 24.0;

impl Patch {
    /// Makes it as fine as the options, the wishes and its own curvature want, or until `go_on` says no. Edges between the pairs of points that
    /// are `barred` are halved in any case.
    pub fn refine(
        &mut self,
        on: &mut OcctEvaluator,
        face: u32,
        options: &Options,
        (wishes, barred): (&[Wish], &BTreeSet<[u32; 2]>),
        go_on: GoOn<'_>,
    ) {
        let all: Vec<(u32, usize)> = (0..self.triangles.len() as u32).flat_map(|t| [(t, 0), (t, 1), (t, 2)]).collect();
        self.straighten(all);
        let mut short = HashSet::new();
        for _ in 0..ROUNDS {
            let mut wanted = self.wanted(on, face, options, (wishes, barred), &mut short);
            if wanted.is_empty() || self.triangles.len() > TRIANGLES || !go_on() {
                return;
            }
            wanted.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            let mut fresh = Vec::new();
            let mut poles: BTreeSet<[u32; 2]> = BTreeSet::new();
            for (_, [a, b], t) in wanted {
                let Some(i) = self.edge_in(t, a, b) else { continue };
                // Edges of a fan at a pole are one in space.
                let is_at_pole = self.is_pole[a as usize] || self.is_pole[b as usize];
                if is_at_pole && !poles.insert(sorted2([self.key(a), self.key(b)])) {
                    continue;
                }
                self.halve(on, face, t, i, options.growth, &mut fresh);
            }
            if fresh.is_empty() {
                return;
            }
            self.straighten(fresh);
        }
    }

    /// The place opposite to the edge of two corners in a triangle.
    pub(super) fn edge_in(&self, t: u32, a: u32, b: u32) -> Option<usize> {
        let [i, j] = [self.place(t, a)?, self.place(t, b)?];
        Some(3 - i - j)
    }

    /// Edges that are too long, with how much and a triangle. Edges in `short` are skipped; those found short enough are added to it.
    fn wanted(
        &self,
        on: &mut OcctEvaluator,
        face: u32,
        options: &Options,
        (wishes, barred): (&[Wish], &BTreeSet<[u32; 2]>),
        short: &mut HashSet<[u32; 2]>,
    ) -> Vec<(f64, [u32; 2], u32)> {
        let twice = self.edges_met_twice();
        let mut found = Vec::new();
        for t in 0..self.triangles.len() as u32 {
            for i in 0..3 {
                let u = self.beside[t as usize][i];
                if u == NONE || self.fixed[t as usize][i] != NONE || u < t {
                    continue;
                }
                let [a, b] = [1, 2].map(|k| self.triangles[t as usize][(i + k) % 3]);
                let pair = sorted2([self.key(a), self.key(b)]);
                let is_barred = barred.contains(&pair) || twice.contains(&pair);
                let edge = sorted2([a, b]);
                if !is_barred && short.contains(&edge) {
                    continue;
                }
                let ratio = if is_barred { f64::MAX } else { self.excess(on, face, [a, b], options, wishes) };
                if ratio > 1.0 {
                    found.push((ratio, edge, t));
                } else {
                    short.insert(edge);
                }
            }
        }
        found
    }

    /// What a corner is in space: the number of its point, or one that no point has.
    pub(super) fn key(&self, corner: u32) -> u32 {
        let point = self.points[corner as usize];
        if point == NONE { corner | 1 << 31 } else { point }
    }

    /// Edges, by what their ends are in space, that are there twice or go from a point to itself: not on both sides of a seam or in the fan
    /// at a pole, where they are one.
    pub(super) fn edges_met_twice(&self) -> BTreeSet<[u32; 2]> {
        let mut all: Vec<([u32; 2], [u32; 2], bool)> = Vec::with_capacity(3 * self.triangles.len());
        for (t, corners) in self.triangles.iter().enumerate() {
            for i in 0..3 {
                let ends = sorted2([corners[(i + 1) % 3], corners[(i + 2) % 3]]);
                all.push((sorted2(ends.map(|c| self.key(c))), ends, self.fixed[t][i] != NONE));
            }
        }
        all.sort_unstable();
        all.dedup();
        let mut twice = BTreeSet::new();
        for group in all.chunk_by(|a, b| a.0 == b.0) {
            let pair = group[0].0;
            if pair[0] == pair[1] {
                if group.iter().any(|(_, _, is_fixed)| !is_fixed) {
                    twice.insert(pair);
                }
            } else if group.len() > 1 && !self.are_one_or_fixed(group) {
                twice.insert(pair);
            }
        }
        twice
    }

    /// Whether edges between the same two points are one, or the sides of a seam: those of a fan at a pole are one.
    pub(super) fn are_one_or_fixed(&self, group: &[([u32; 2], [u32; 2], bool)]) -> bool {
        let is_fan = |a: &[u32; 2], b: &[u32; 2]| {
            let apart = || a.iter().chain(b).filter(|c| !(a.contains(c) && b.contains(c)));
            apart().count() == 2 && apart().all(|&c| self.is_pole[c as usize])
        };
        // Those that are reached from the fixed ones, or from the first where there is none.
        let mut reached: Vec<bool> = group.iter().map(|(_, _, is_fixed)| *is_fixed).collect();
        if !reached.contains(&true) {
            reached[0] = true;
        }
        loop {
            let next = (0..group.len())
                .find(|&i| !reached[i] && (0..group.len()).any(|j| reached[j] && is_fan(&group[i].1, &group[j].1)));
            match next {
                Some(i) => reached[i] = true,
                None => return !reached.contains(&false),
            }
        }
    }

    /// By how much an edge is too long.
    pub(super) fn excess(
        &self,
        on: &mut OcctEvaluator,
        face: u32,
        [a, b]: [u32; 2],
        options: &Options,
        wishes: &[Wish],
    ) -> f64 {
        let [p, q] = [a, b].map(|c| self.spot(c));
        let length = distance(p, q);
        if length.partial_cmp(&options.least) != Some(Ordering::Greater) {
            return 0.0;
        }
        let middle = self.middle(a, b);
        let here = sample(on, face, self.unscaled(middle));
        let mut size =
            options.greatest.min(self.grown(a, here.at, options.growth)).min(self.grown(b, here.at, options.growth));
        for wish in wishes {
            let far = (distance(wish.at, here.at) - wish.radius).max(0.0);
            size = size.min(wish.size.max(options.least) + options.growth * far);
        }
        let mut ratio = length / (1.4 * size);
        let off = sub(here.at, lerp(p, q, 0.5));
        if here.normal != [0.0; 3] {
            ratio = ratio.max(dot(off, here.normal).abs() / length * 8.0 * options.segments / 1.5);
            let [n, m] = [a, b].map(|c| self.normals[c as usize]);
            let is_regular = n != [0.0; 3] && m != [0.0; 3];
            let turned: f64 = [n, m].into_iter().filter(|n| *n != [0.0; 3]).map(|n| angle(n, here.normal)).sum();
            ratio = ratio.max(turned * options.segments / if is_regular { 1.5 } else { 0.8 });
            if is_regular && length > ACROSS * self.reach {
                ratio = ratio.max(length * options.segments * here.bend / STRETCH);
            }
        } else if norm(off) > 0.25 * length {
            ratio = ratio.max(2.0);
        }
        ratio
    }

    /// The size at a corner, grown up to a point.
    pub(super) fn grown(&self, corner: u32, at: Vec3, growth: f64) -> f64 {
        self.sizes[corner as usize] + growth * distance(self.spot(corner), at)
    }
}
