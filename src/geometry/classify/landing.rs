//! Putting vertices of triangles on a face.
use super::fit::Fit;
use crate::geometry::{Entity, Evaluate, Evaluator, OnSurface};
use crate::mesh::vector::{Vec3, add, area2, dot, norm, scale, unit};
use std::collections::{HashMap, VecDeque};

/// A vertex too far from a face.
pub(super) struct Miss;

/// Puts the vertices of a connected patch on a face, each with its neighbour's parameters as the guess; gives up
/// at the first vertex that is out of reach.
pub(super) fn land_patch(
    fit: &Fit,
    evaluator: &mut Evaluator,
    patch: &[u32],
    face: u32,
) -> Result<Vec<(u32, OnSurface)>, Miss> {
    let reach = fit.reach(Entity::Face(face));
    let mut landed: HashMap<u32, [f64; 2]> = HashMap::new();
    let mut list = Vec::new();
    let mut seen: std::collections::HashSet<u32> = patch.first().copied().into_iter().collect();
    let mut queue: VecDeque<(u32, Option<[f64; 2]>)> = patch.first().map(|&t| (t, None)).into_iter().collect();
    while let Some((t, mut guess)) = queue.pop_front() {
        for v in fit.mesh.triangles.nodes[t as usize] {
            if let Some(&uv) = landed.get(&v) {
                guess = Some(uv);
                continue;
            }
            let listed = fit.hints.parameters(v, Entity::Face(face));
            let on = evaluator.closest_on_face(face, fit.point(v), listed.or(guess));
            if on.distance.is_nan() || on.distance > reach {
                return Err(Miss);
            }
            guess = Some(on.uv);
            landed.insert(v, on.uv);
            list.push((v, on));
        }
        for &edge in &fit.features.edges.of_side[3 * t as usize..3 * t as usize + 3] {
            if fit.features.ridge[edge as usize] {
                continue;
            }
            for s in fit.features.edges.triangles(edge as usize) {
                if seen.insert(s as u32) {
                    queue.push_back((s as u32, guess));
                }
            }
        }
    }
    Ok(list)
}

/// How badly a triangle fits a face, 0 best: the distance of its centroid over its size, and the angle of its normal.
/// Decides between faces that hold all its vertices.
pub(super) fn misfit(fit: &Fit, evaluator: &mut Evaluator, t: u32, face: u32) -> f64 {
    let [a, b, c] = fit.mesh.triangles.nodes[t as usize].map(|v| fit.point(v));
    let twice = area2(a, b, c);
    let size = norm(twice).sqrt().max(f64::MIN_POSITIVE);
    let on = evaluator.closest_on_face(face, centroid([a, b, c]), None);
    let cosine = dot(unit(twice), evaluator.face_normal(face, on.uv)).abs();
    on.distance / size + (1.0 - cosine)
}

/// Mean of the corners.
pub(super) fn centroid([a, b, c]: [Vec3; 3]) -> Vec3 {
    scale(add(add(a, b), c), 1.0 / 3.0)
}

/// Whether a point is within a distance of a face's box.
pub(super) fn box_reaches(fit: &Fit, face: u32, point: Vec3, reach: f64) -> bool {
    let [low, high] = fit.topology.faces[face as usize].bounds;
    (0..3).all(|i| low[i] - reach <= point[i] && point[i] <= high[i] + reach)
}
