//! Parameters and closest point of every vertex on its entity, within the tolerance.
use super::fit::Fit;
use super::patches::{Faces, named};
use super::ridges::Ridges;
use super::{Classification, Error, Report};
use crate::geometry::{Entity, Evaluate, Evaluator, Geometry};
use crate::mesh::vector::{Vec3, distance};
use crate::tasks::GRAIN;

/// Where a vertex is on its entity.
#[derive(Clone, Copy)]
struct Settled {
    parameters: [f64; 2],
    point: Vec3,
    distance: f64,
}

/// Puts the vertices on their entities and collects the result.
///
/// # Errors
/// If one is farther from its entity than allowed.
pub(super) fn settle(
    fit: &Fit,
    faces: Faces,
    ridges: Ridges,
    entities: Vec<Entity>,
) -> Result<(Classification, Report), Error> {
    let settled = fit.team.collect(GRAIN, entities.len(), |range, settled| {
        let mut evaluator = fit.model.evaluator();
        settled.extend(range.map(|v| settle_vertex(fit, &mut evaluator, &faces, &ridges, v as u32, entities[v])));
    });
    let off = fit.team.collect(GRAIN, entities.len(), |range, off| {
        let is_on = |v: usize| settled[v].distance <= fit.allowed(entities[v]);
        let is_off = |&v: &usize| entities[v] != Entity::Interior && !is_on(v);
        off.extend(range.filter(is_off).map(|v| (v as u32, entities[v], settled[v].distance)));
    });
    if let Some(error) = fit.vertex_off(off) {
        return Err(error);
    }
    let result = Classification {
        entities,
        parameters: fit.team.map(GRAIN, settled.len(), |v| settled[v].parameters),
        projected: fit.team.map(GRAIN, settled.len(), |v| settled[v].point),
        ridges: ridges.list,
        faces: faces.of_triangle,
    };
    let distances: Vec<f64> = fit.team.map(GRAIN, settled.len(), |v| settled[v].distance);
    let report = report(fit, &result, &distances, faces.notices);
    Ok((result, report))
}

fn settle_vertex(
    fit: &Fit,
    evaluator: &mut Evaluator,
    faces: &Faces,
    ridges: &Ridges,
    v: u32,
    entity: Entity,
) -> Settled {
    let here = fit.point(v);
    match entity {
        Entity::Interior => Settled { parameters: [0.0; 2], point: here, distance: 0.0 },
        Entity::Vertex(vertex) => {
            let point = fit.topology.vertices[vertex as usize].point;
            Settled { parameters: [0.0; 2], point, distance: distance(here, point) }
        }
        Entity::Edge(edge) => {
            let landed = ridges.landings.get(&(v, edge)).copied();
            let on = landed.unwrap_or_else(|| evaluator.closest_on_edge(edge, here, None));
            Settled { parameters: [on.t, 0.0], point: on.point, distance: on.distance }
        }
        Entity::Face(face) => {
            let landed = faces.landings[v as usize].filter(|(f, _)| *f == face).map(|(_, on)| on);
            let on = landed.unwrap_or_else(|| evaluator.closest_on_face(face, here, None));
            Settled { parameters: on.uv, point: on.point, distance: on.distance }
        }
    }
}

fn report(fit: &Fit, result: &Classification, distances: &[f64], notices: Vec<String>) -> Report {
    let mut named_face = vec![false; result.entities.len()];
    let mut faces_from_file = 0;
    for ((nodes, reference), &face) in fit.mesh.triangles.iter().zip(&result.faces) {
        if named(fit, reference) == Some(face) {
            faces_from_file += 1;
            nodes.iter().for_each(|&v| named_face[v as usize] = true);
        }
    }
    let from_file = |v: usize| {
        let entity = result.entities[v];
        fit.hints.parameters(v as u32, entity).is_some() || entity.dimension() == 2 && named_face[v]
    };
    let mut report = Report::new(result, &fit.mesh.vertices, distances, from_file);
    (report.faces_from_file, report.tolerance) = (faces_from_file, fit.tolerance);
    report.notices = notices;
    report.notices.extend(fit.hints.notices(result));
    report
}
