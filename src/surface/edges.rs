//! The edges of a model in pieces: once for all faces that share them, as long as curvature and the edges beside allow.
use super::Options;
use super::twins::Twins;
use crate::geometry::{Evaluate, Geometry, OcctEvaluator, OcctModel, Topology};
use crate::mesh::vector::{Vec3, cross, distance, dot, norm};
use std::cmp::Ordering;

/// How much longer than the size of a face's curvature an edge along it may be.
pub const STRETCH: f64 = 4.0;
/// Places that a size is asked at on an edge: at first, and at most.
const PLACES: [usize; 2] = [32, 4096];
/// Pieces of an edge at most for the curvature of the faces beside it.
const ALONG: f64 = 16.0;
/// Its own curvature makes no size below this many of the least ones, unless the edge is short: curves of intersection may end in a hook,
/// which bends without bound and is no longer than that.
const HOOK: f64 = 8.0;
/// Sweeps over all edges that hand sizes on, at most.
const SWEEPS: usize = 64;
/// Pieces of an edge at most.
const PIECES: f64 = 20_000.0;

/// Sizes along an edge.
struct Profile {
    t: Vec<f64>,
    /// Length from the start.
    way: Vec<f64>,
    size: Vec<f64>,
}

/// For each edge the parameters that it is divided at, its ends among them; of a degenerate edge none.
pub fn divided(model: &OcctModel, options: &Options, twins: &Twins) -> Vec<Vec<f64>> {
    let topology = model.topology();
    let mut on = model.evaluator();
    let mut profiles: Vec<Option<Profile>> =
        (0..topology.edges.len() as u32).map(|edge| profile(&mut on, topology, edge, options)).collect();
    // Twins are as fine as the finer of both; what that does to others is handed on in a second go.
    for _ in 0..2 {
        hand_on(topology, &mut profiles, options.growth);
        for edge in 0..profiles.len() {
            if let Some((other, is_against)) = twins.follows[edge]
                && let Some(own) = profiles[edge].take()
            {
                if let Some(leader) = &mut profiles[other as usize] {
                    leader.take_least(&own, is_against);
                }
                profiles[edge] = Some(own);
            }
        }
    }
    let least = least_pieces(topology);
    profiles
        .iter()
        .zip(least)
        .map(|(profile, least)| profile.as_ref().map_or_else(Vec::new, |p| p.divide(least)))
        .collect()
}

fn profile(on: &mut OcctEvaluator, topology: &Topology, edge: u32, options: &Options) -> Option<Profile> {
    let entity = &topology.edges[edge as usize];
    let [from, to] = entity.range;
    if entity.degenerate || to.partial_cmp(&from) != Some(Ordering::Greater) {
        return None;
    }
    let mut count = PLACES[0];
    loop {
        let place = |i: usize| from + (to - from) * (i as f64 / count as f64);
        let t: Vec<f64> = (0..=count).map(|i| if i == count { to } else { place(i) }).collect();
        let frames: Vec<(Vec3, f64, f64)> = t.iter().map(|&t| size_at(on, topology, edge, t, options)).collect();
        let mut way = vec![0.0; count + 1];
        let mut is_fine = true;
        for i in 1..=count {
            let step = distance(frames[i - 1].0, frames[i].0);
            way[i] = way[i - 1] + step;
            is_fine &= step <= 0.7 * frames[i - 1].1.min(frames[i].1);
        }
        if is_fine || count >= PLACES[1] {
            // The whole edge may be one piece; the curvature of faces beside it, which has no bound at an apex, may divide it into so many.
            let length = way[count];
            let shortest = length / ALONG;
            let straight = shortest.min(HOOK * options.least);
            let size = frames
                .iter()
                .map(|&(_, own, beside)| own.max(straight).min(beside.max(shortest)).min(length))
                .collect();
            return (length.is_finite() && length > 0.0).then_some(Profile { t, way, size });
        }
        count *= 4;
    }
}

/// Point, and the sizes at a parameter by the curve and by the faces beside it.
fn size_at(on: &mut OcctEvaluator, topology: &Topology, edge: u32, t: f64, options: &Options) -> (Vec3, f64, f64) {
    let frame = on.edge_frame(edge, t);
    let mut bend = 0.0_f64;
    for &face in &topology.edges[edge as usize].faces {
        if let Some(uv) = on.edge_on_face(edge, t, face) {
            bend = bend.max(on.face_frame(face, uv).curvatures[0].abs());
        }
    }
    let size = |bend: f64| {
        let size = 1.0 / (options.segments * bend);
        if size.is_finite() { size.clamp(options.least, options.greatest) } else { options.greatest }
    };
    (frame.point, size(frame.curvature()), size(bend / STRETCH))
}

/// Has sizes grow by no more than `growth` for a unit of length, from edge to edge over the vertices too.
fn hand_on(topology: &Topology, profiles: &mut [Option<Profile>], growth: f64) {
    let mut at_vertex = vec![f64::INFINITY; topology.vertices.len()];
    for _ in 0..SWEEPS {
        let mut has_changed = false;
        for (profile, entity) in profiles.iter_mut().zip(&topology.edges) {
            let Some(profile) = profile else { continue };
            let last = profile.size.len() - 1;
            for (end, vertex) in [0, last].into_iter().zip(entity.vertices) {
                if let Some(vertex) = vertex {
                    profile.size[end] = profile.size[end].min(at_vertex[vertex as usize]);
                }
            }
            for i in 1..=last {
                let step = growth * (profile.way[i] - profile.way[i - 1]);
                profile.size[i] = profile.size[i].min(profile.size[i - 1] + step);
            }
            for i in (0..last).rev() {
                let step = growth * (profile.way[i + 1] - profile.way[i]);
                profile.size[i] = profile.size[i].min(profile.size[i + 1] + step);
            }
            for (end, vertex) in [0, last].into_iter().zip(entity.vertices) {
                if let Some(vertex) = vertex {
                    let size = &mut at_vertex[vertex as usize];
                    if profile.size[end] < *size * (1.0 - 1e-9) {
                        *size = profile.size[end];
                        has_changed = true;
                    }
                }
            }
        }
        if !has_changed {
            return;
        }
    }
}

/// Pieces that an edge has at least: four where it is closed, two where another edge has the same ends.
fn least_pieces(topology: &Topology) -> Vec<usize> {
    topology
        .edges
        .iter()
        .enumerate()
        .map(|(i, edge)| match edge.vertices {
            [Some(a), Some(b)] if a != b => {
                let twin = |&other: &u32| {
                    let entity = &topology.edges[other as usize];
                    other as usize != i
                        && !entity.degenerate
                        && (entity.vertices == [Some(a), Some(b)] || entity.vertices == [Some(b), Some(a)])
                };
                1 + usize::from(topology.vertices[a as usize].edges.iter().any(twin))
            }
            _ => 4,
        })
        .collect()
}

impl Profile {
    /// Takes the sizes of another at the same places where they are less.
    fn take_least(&mut self, other: &Self, is_against: bool) {
        let length = |profile: &Self| profile.way.last().copied().unwrap_or(0.0);
        let (own, far) = (length(self), length(other));
        for i in 0..self.size.len() {
            let share = if is_against { 1.0 - self.way[i] / own } else { self.way[i] / own };
            let k = other.way.partition_point(|&way| way < share * far).min(other.size.len() - 1);
            self.size[i] = self.size[i].min(other.size[k]).min(other.size[k.saturating_sub(1)]);
        }
    }

    /// Divides it so that each piece has as much of the integral of 1/size, the size being linear from place to place: sizes may differ by
    /// orders of magnitude from one to the next.
    fn divide(&self, least: usize) -> Vec<f64> {
        let last = self.t.len() - 1;
        let mut sum = vec![0.0; last + 1];
        for i in 1..=last {
            let step = self.way[i] - self.way[i - 1];
            sum[i] = sum[i - 1] + step * mean_inverse(self.size[i - 1], self.size[i]);
        }
        let count = ((sum[last] - 0.1).ceil().clamp(1.0, PIECES) as usize).max(least);
        let mut t = vec![self.t[0]];
        let mut i = 0;
        for k in 1..count {
            let aim = sum[last] * k as f64 / count as f64;
            while i + 2 < sum.len() && sum[i + 1] < aim {
                i += 1;
            }
            let share = ((aim - sum[i]) / (sum[i + 1] - sum[i])).clamp(0.0, 1.0);
            let way = way_of(share, self.size[i + 1] / self.size[i]);
            t.push(self.t[i] + (self.t[i + 1] - self.t[i]) * if way.is_finite() { way } else { 0.5 });
        }
        t.push(self.t[last]);
        t
    }
}

/// The mean of 1/size between two places, the size being linear between them.
fn mean_inverse(from: f64, to: f64) -> f64 {
    let ratio = to / from;
    if (ratio - 1.0).abs() < LEVEL { 0.5 / from + 0.5 / to } else { ratio.ln() / (to - from) }
}

/// The share of the way between two places at which so large a share of the integral of 1/size is reached; `ratio` is that of the sizes
/// there.
fn way_of(share: f64, ratio: f64) -> f64 {
    if (ratio - 1.0).abs() < LEVEL { share } else { (ratio.powf(share) - 1.0) / (ratio - 1.0) }
}

/// Sizes that differ by less than this share are taken for equal.
const LEVEL: f64 = 1e-4;

/// The angle between two unit normals, in radians.
pub fn angle(a: Vec3, b: Vec3) -> f64 {
    norm(cross(a, b)).atan2(dot(a, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_size_at_one_end_makes_few_pieces() {
        // Sizes of 1e-5 at the start that grow by 0.5 for a unit of length, asked at two places only: each piece is longer by a constant
        // factor, not hundreds of equal ones.
        let profile = Profile { t: vec![0.0, 1.0], way: vec![0.0, 1.0], size: vec![1e-5, 0.50001] };
        let t = profile.divide(1);
        let wanted = (0.50001_f64 / 1e-5).ln() / 0.5;
        assert_eq!(t.len() - 1, (wanted - 0.1).ceil() as usize);
        let pieces: Vec<f64> = t.windows(2).map(|w| w[1] - w[0]).collect();
        let factor = pieces[1] / pieces[0];
        assert!(factor > 1.5 && pieces[0] < 2e-5, "{pieces:?}");
        assert!(pieces.windows(2).all(|w| (w[1] / w[0] / factor - 1.0).abs() < 1e-6), "{pieces:?}");
        // Equal sizes make equal pieces.
        let level = Profile { t: vec![0.0, 0.5, 1.0], way: vec![0.0, 0.5, 1.0], size: vec![0.25; 3] };
        assert_eq!(level.divide(1), [0.0, 0.25, 0.5, 0.75, 1.0]);
    }
}
