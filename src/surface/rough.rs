//! Triangles between the corners of a border that bounds nothing in the plane of the parameters: the surface is closed all the same.
use super::outline::{Outline, Scale};
use super::patch::Patch;
use super::points::Points;
use crate::geometry::OcctEvaluator;
use crate::mesh::vector::{Vec3, add, cross, distance, dot, norm, sub, unit};
use std::collections::BTreeMap;

/// Most corners of a border that are cut off one after another, each after a look at all.
const CORNERS: usize = 5_000;

/// The triangles of a border without points inside: by the plane that fits it best, else by cutting off corners in space. None where the
/// border is not closed, or has too many corners for that.
pub fn patch(on: &mut OcctEvaluator, face: u32, outline: &Outline, points: &Points) -> Option<Patch> {
    let is_short = outline.corners.len() <= CORNERS;
    in_its_plane(on, face, outline, points).or_else(|| if is_short { cut_off(outline, points) } else { None })
}

/// By the plane across the mean normal.
fn in_its_plane(on: &mut OcctEvaluator, face: u32, outline: &Outline, points: &Points) -> Option<Patch> {
    let at = |c: u32| points.at[outline.points[c as usize] as usize];
    let mut normal = [0.0; 3];
    let first = at(outline.segments.first()?.ends[0]);
    for segment in outline.segments.iter().filter(|s| s.counts) {
        let [p, q] = segment.along().map(|c| sub(at(c), first));
        normal = add(normal, cross(p, q));
    }
    let normal = unit(normal);
    if !normal.iter().all(|x| x.is_finite()) {
        return None;
    }
    let least = (0..3).min_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs()))?;
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let x = unit(cross(axis, normal));
    let y = cross(normal, x);
    let mut flat = outline.clone();
    flat.scale = Scale::default();
    flat.corners =
        (0..outline.corners.len() as u32).map(|c| [dot(sub(at(c), first), x), dot(sub(at(c), first), y)]).collect();
    let mut patch = Patch::new(on, face, &flat, points).ok()?;
    patch.forget_plane();
    (!patch.triangles.is_empty()).then_some(patch)
}

/// Loops of corners, the first segment's direction kept.
fn loops(outline: &Outline) -> Option<Vec<Vec<u32>>> {
    let mut next: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (i, segment) in outline.segments.iter().enumerate().filter(|(_, s)| s.counts) {
        segment.ends.iter().for_each(|&c| next.entry(c).or_default().push(i));
    }
    let mut used = vec![false; outline.segments.len()];
    let mut all = Vec::new();
    for start in 0..outline.segments.len() {
        if used[start] || !outline.segments[start].counts {
            continue;
        }
        let [first, mut at] = outline.segments[start].along();
        used[start] = true;
        let mut corners = vec![first];
        while at != first {
            corners.push(at);
            let i = *next.get(&at)?.iter().find(|&&i| !used[i])?;
            used[i] = true;
            let [a, b] = outline.segments[i].ends;
            at = if a == at { b } else { a };
        }
        all.push(corners);
    }
    Some(all)
}

/// Cuts corners off one after another, those with the best triangles first.
pub fn cut_off(outline: &Outline, points: &Points) -> Option<Patch> {
    let mut all = loops(outline)?;
    all.retain(|corners| corners.len() > 1);
    let mut rest = all.pop()?;
    let at = |c: u32| points.at[outline.points[c as usize] as usize];
    // Holes by a bridge between their nearest corners.
    while !all.is_empty() {
        let mut best = (f64::INFINITY, 0, 0, 0);
        for (k, hole) in all.iter().enumerate() {
            for (i, &p) in rest.iter().enumerate() {
                for (j, &q) in hole.iter().enumerate() {
                    let far = distance(at(p), at(q));
                    if far < best.0 {
                        best = (far, k, i, j);
                    }
                }
            }
        }
        let (_, k, i, j) = best;
        let hole = all.swap_remove(k);
        let bridge: Vec<u32> = hole[j..].iter().chain(&hole[..=j]).copied().chain([rest[i]]).collect();
        rest.splice(i + 1..i + 1, bridge);
    }
    let mut triangles = Vec::new();
    while rest.len() > 2 {
        let count = rest.len();
        let corners = |k: usize| [rest[(k + count - 1) % count], rest[k], rest[(k + 1) % count]];
        let cost = |k: usize| {
            let [a, b, c] = corners(k);
            let [p, q, r] = [a, b, c].map(at);
            let area = norm(cross(sub(q, p), sub(r, p)));
            let longest = distance(p, q).max(distance(q, r)).max(distance(r, p));
            // A round of the smallest way: the new edge is short.
            distance(p, r) + 1e-3 * longest + if area == 0.0 { longest } else { 0.0 }
        };
        let k = (0..count).min_by(|&i, &j| cost(i).total_cmp(&cost(j)))?;
        triangles.push(corners(k));
        rest.remove(k);
    }
    let spots: Vec<Vec3> = (0..outline.corners.len() as u32).map(at).collect();
    Some(Patch::of_triangles(spots, outline.points.clone(), triangles))
}
