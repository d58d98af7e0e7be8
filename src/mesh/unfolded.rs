//! Vertices whose triangles cannot pass through each other: most of a smooth surface, for a few operations each.
use super::vector::{Vec3, add, area2, cross, dot, norm, sub, unit};
use crate::tasks::{Rows, Team};

/// How far the triangles must look along the common direction: the cosine of the angle between.
const ALONG: f64 = 1e-3;

/// The least area of a triangle's shadow, as a share of the product of its sides: far above rounding.
const SHADOW: f64 = 1e-9;

/// Vertices a task.
const GRAIN: usize = 1 << 10;

/// Whether the triangles at each vertex are a disc that has no fold in the direction of their mean normal. Then no two of them have more
/// in common than the vertex and an edge at it: their shadows on a plane across that direction do not overlap. False if in doubt.
/// Degenerate triangles are in doubt.
pub fn are_unfolded(team: Team<'_>, triangles: &[[u32; 3]], at: impl Fn(u32) -> Vec3 + Sync) -> Vec<bool> {
    let vertices = triangles.iter().flatten().max().map_or(0, |v| *v as usize + 1);
    let incident = Rows::at_nodes(team, triangles, vertices);
    team.map(GRAIN, vertices, |v| {
        let star = incident.row(v);
        let corners = |t: u32| triangles[t as usize].map(&at);
        is_disc(v as u32, star, triangles) && is_unfolded(v as u32, star, triangles, corners)
    })
}

/// The two other nodes of a triangle, in its order.
fn others(v: u32, nodes: [u32; 3]) -> [usize; 2] {
    match nodes.iter().position(|&n| n == v) {
        Some(0) => [1, 2],
        Some(1) => [2, 0],
        _ => [0, 1],
    }
}

/// Whether each triangle is followed by exactly one across its edge at v. (The triangles are one or more closed fans.)
fn is_disc(v: u32, star: &[u32], nodes: &[[u32; 3]]) -> bool {
    let edge = |t: u32| others(v, nodes[t as usize]).map(|k| nodes[t as usize][k]);
    let follows = |a: u32| star.iter().filter(|&&t| edge(t)[0] == a).count();
    star.len() > 2 && star.iter().all(|&t| follows(edge(t)[1]) == 1)
}

/// Whether closed fans of triangles go round once, seen along their mean normal.
fn is_unfolded(v: u32, star: &[u32], nodes: &[[u32; 3]], corners: impl Fn(u32) -> [Vec3; 3]) -> bool {
    let normal = |t: u32| {
        let [a, b, c] = corners(t);
        unit(area2(a, b, c))
    };
    let mean = unit(star.iter().fold([0.0; 3], |sum, &t| add(sum, normal(t))));
    // Across the mean: along which a ray leaves the vertex. Every turn about it has one edge that comes up through the ray.
    let least = (0..3).min_by(|&i, &j| mean[i].abs().total_cmp(&mean[j].abs())).unwrap_or(0);
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let up = unit(cross(mean, axis));
    let mut turns = 0;
    for &t in star {
        let corners = corners(t);
        let of = others(v, nodes[t as usize]);
        let centre = corners[3 - of[0] - of[1]];
        let [from, to] = of.map(|k| sub(corners[k], centre));
        let area = cross(from, to);
        let shadow = dot(area, mean);
        // No number is in doubt too.
        let is_clear = shadow > SHADOW * norm(from) * norm(to) && shadow > ALONG * norm(area);
        if !is_clear {
            return false;
        }
        turns += usize::from(dot(from, up) < 0.0 && dot(to, up) >= 0.0);
    }
    turns == 1
}

#[cfg(test)]
mod tests {
    use super::super::triangle_pair::meeting;
    use super::super::vector::scale;
    use super::*;

    /// Fans about the origin, of so many triangles in so many turns, on a cone.
    fn fan(count: usize, turns: usize, height: f64) -> (Vec<[u32; 3]>, Vec<Vec3>) {
        let at = |i: usize| {
            let angle = std::f64::consts::TAU * (turns * i) as f64 / count as f64;
            [angle.cos(), angle.sin(), height * (1.0 + (i % 2) as f64)]
        };
        let points = std::iter::once([0.0; 3]).chain((0..count).map(at)).collect();
        let triangles = (0..count).map(|i| [0, 1 + i as u32, 1 + ((i + 1) % count) as u32]).collect();
        (triangles, points)
    }

    fn at_centre((triangles, points): &(Vec<[u32; 3]>, Vec<Vec3>)) -> bool {
        are_unfolded(Team::alone(), triangles, |v| points[v as usize])[0]
    }

    #[test]
    fn a_fan_is_unfolded_and_two_turns_are_not() {
        for (height, expected) in [(0.0, true), (1.0, true), (-2.0, true), (1e4, false)] {
            assert_eq!(at_centre(&fan(7, 1, height)), expected, "{height}");
        }
        assert!(!at_centre(&fan(7, 2, 0.1)));
        assert!(!at_centre(&fan(9, 4, 0.0)));
    }

    #[test]
    fn open_and_double_fans_are_in_doubt() {
        let (triangles, points) = fan(7, 1, 0.1);
        assert!(!at_centre(&(triangles[1..].to_vec(), points.clone())));
        let twice = [&triangles[..], &triangles[..1]].concat();
        assert!(!at_centre(&(twice, points.clone())));
        // Two discs that touch in the vertex.
        let more: Vec<[u32; 3]> = triangles.iter().map(|&[o, a, b]| [o, a + 7, b + 7]).collect();
        let points = [&points[..], &points[1..].iter().map(|&[x, y, z]| [x, y, z + 0.5]).collect::<Vec<_>>()].concat();
        assert!(!at_centre(&([triangles, more].concat(), points)));
    }

    #[test]
    fn what_is_unfolded_has_no_pair_that_meets() {
        let mut seed = 1u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 40) as f64 / f64::from(1 << 24) - 0.5
        };
        let (mut unfolded, mut folded) = (0, 0);
        for i in 0..4000 {
            let (triangles, mut points) = fan(4 + i % 5, 1, 0.2);
            let noise = [0.2, 1.0, 3.0][i % 3];
            points[1..].iter_mut().for_each(|p| *p = add(*p, scale([random(), random(), random()], noise)));
            let corners = |t: &[u32; 3]| t.map(|v| points[v as usize]);
            let mut pairs = triangles.iter().enumerate().flat_map(|(k, a)| triangles[..k].iter().map(move |b| (a, b)));
            let meets = pairs.any(|(a, b)| meeting(&corners(a), &corners(b)).is_some());
            let is_safe = at_centre(&(triangles.clone(), points.clone()));
            assert!(!(is_safe && meets), "{points:?}");
            unfolded += usize::from(is_safe);
            folded += usize::from(meets);
        }
        assert!(unfolded > 1000 && folded > 300, "{unfolded} {folded}");
    }
}
