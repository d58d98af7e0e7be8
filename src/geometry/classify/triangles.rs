//! Finds the faces of triangles one by one, where a patch of the mesh spans several faces.
use super::Error;
use super::error::numbers;
use super::fit::Fit;
use super::landing::{box_reaches, centroid, misfit};
use super::patches::{Faces, spread};
use crate::geometry::{Entity, Evaluate, Evaluator, Geometry, OnSurface};
use std::collections::HashMap;

/// Vertices that one task puts on faces.
const CHUNK: usize = 256;

/// Faces within far reach of a vertex, and where it lands on them.
type Near = Vec<(u32, OnSurface)>;

/// Finds the faces of the triangles of the patches.
///
/// # Errors
/// If a vertex is out of reach of every face, or the vertices of a triangle have no face in common.
pub(super) fn match_triangles(fit: &Fit, patches: &[Vec<u32>], faces: &mut Faces) -> Result<(), Error> {
    let mut vertices: Vec<u32> = patches.iter().flatten().flat_map(|&t| fit.mesh.triangles.nodes[t as usize]).collect();
    vertices.sort_unstable();
    vertices.dedup();
    let near = fit.team.chunks(CHUNK, vertices.len(), |range| {
        let mut evaluator = fit.model.evaluator();
        vertices[range].iter().map(|&v| (v, near(fit, &mut evaluator, v))).collect::<Vec<_>>()
    });
    let near: HashMap<u32, Near> = near.into_iter().flatten().collect();
    if let Some(error) = off(fit, patches, &near) {
        return Err(error);
    }
    let mut evaluator = fit.model.evaluator();
    for &t in patches.iter().flatten() {
        let face = best_common(fit, &mut evaluator, t, &near).ok_or_else(|| straddles(fit, t, &near))?;
        faces.of_triangle[t as usize] = face;
        for v in fit.mesh.triangles.nodes[t as usize] {
            let on = near[&v].iter().find(|(f, _)| *f == face).map(|&(_, on)| (face, on));
            faces.landings[v as usize] = on;
        }
    }
    Ok(())
}

fn near(fit: &Fit, evaluator: &mut Evaluator, v: u32) -> Near {
    let point = fit.point(v);
    (0..fit.topology.faces.len() as u32)
        .filter(|&face| box_reaches(fit, face, point, fit.far_reach(face)))
        .map(|face| {
            let guess = fit.hints.parameters(v, Entity::Face(face));
            (face, evaluator.closest_on_face(face, point, guess))
        })
        .filter(|(face, on)| on.distance <= fit.far_reach(*face))
        .collect()
}

/// The face that holds all three vertices, the best fitting one if there are several; one in far reach if there is none within reach.
fn best_common(fit: &Fit, evaluator: &mut Evaluator, t: u32, near: &HashMap<u32, Near>) -> Option<u32> {
    let [a, b, c] = fit.mesh.triangles.nodes[t as usize];
    let held = |reach: &dyn Fn(u32) -> f64| -> Vec<u32> {
        let holds = |v: u32, face: u32| near[&v].iter().any(|&(f, on)| f == face && on.distance <= reach(face));
        near[&a].iter().map(|(f, _)| *f).filter(|&f| [a, b, c].into_iter().all(|v| holds(v, f))).collect()
    };
    let mut common = held(&|face| fit.reach(Entity::Face(face)));
    if common.is_empty() {
        common = held(&|face| fit.far_reach(face));
    }
    if common.len() < 2 {
        return common.first().copied();
    }
    let bad: Vec<(f64, u32)> = common.into_iter().map(|f| (misfit(fit, evaluator, t, f), f)).collect();
    bad.into_iter().min_by(|x, y| x.0.total_cmp(&y.0)).map(|(_, face)| face)
}

/// The error of the first patch of which most vertices are off every face, else that of the farthest such vertex.
fn off(fit: &Fit, patches: &[Vec<u32>], near: &HashMap<u32, Near>) -> Option<Error> {
    let mut evaluator = fit.model.evaluator();
    let mut all = Vec::new();
    for patch in patches {
        let mut vertices: Vec<u32> = patch.iter().flat_map(|&t| fit.mesh.triangles.nodes[t as usize]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let off: Vec<u32> = vertices.iter().copied().filter(|v| near[v].is_empty()).collect();
        if 2 * off.len() > vertices.len() {
            return patch_off(fit, &mut evaluator, patch, &off);
        }
        all.extend(off);
    }
    all.sort_unstable();
    all.dedup();
    let others = all.len().saturating_sub(1);
    let off = all.iter().take(1000).filter_map(|&v| {
        let (face, distance) = nearest_face(fit, &mut evaluator, &[v])?;
        Some((v, Entity::Face(face), distance))
    });
    let mut error = fit.vertex_off(off.collect())?;
    if let Error::VertexOff { others: count, .. } = &mut error {
        *count = others;
    }
    Some(error)
}

fn patch_off(fit: &Fit, evaluator: &mut Evaluator, patch: &[u32], off: &[u32]) -> Option<Error> {
    let samples = spread(off);
    let (face, _) = nearest_face(fit, evaluator, &samples)?;
    let mut distance = |v: u32| evaluator.closest_on_face(face, fit.point(v), None).distance;
    let farthest = samples.iter().map(|&v| (distance(v), v)).max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Error::PatchWithoutFace {
        reference: fit.mesh.triangles.refs[*patch.first()? as usize],
        triangles: patch.len(),
        place: fit.point(farthest.1),
        face,
        distance: farthest.0,
        tolerance: fit.allowed(Entity::Face(face)),
    })
}

/// The face with the least greatest distance from the vertices.
fn nearest_face(fit: &Fit, evaluator: &mut Evaluator, vertices: &[u32]) -> Option<(u32, f64)> {
    let mut farthest = |face: u32| {
        let distances = vertices.iter().map(|&v| evaluator.closest_on_face(face, fit.point(v), None).distance);
        (face, distances.fold(0.0, f64::max))
    };
    (0..fit.topology.faces.len() as u32).map(&mut farthest).min_by(|a, b| a.1.total_cmp(&b.1))
}

fn straddles(fit: &Fit, t: u32, near: &HashMap<u32, Near>) -> Error {
    let nodes = fit.mesh.triangles.nodes[t as usize];
    let faces = nodes.map(|v| numbers(&near[&v].iter().map(|(f, _)| *f).collect::<Vec<_>>()));
    Error::Straddles {
        triangle: t as usize,
        nodes,
        place: centroid(nodes.map(|v| fit.point(v))),
        faces: faces.join(" | "),
    }
}
