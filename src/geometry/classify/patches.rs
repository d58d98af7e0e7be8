//! Finds the faces of the model on which patches of triangles lie.
use super::fit::Fit;
use super::landing::{box_reaches, land_patch, misfit};
use super::{Error, triangles};
use crate::geometry::{Entity, Evaluate, Evaluator, Geometry, OnSurface};
use std::collections::HashMap;

/// Not yet found.
pub(super) const NONE: u32 = u32::MAX;

/// Vertices of a patch that are tried on every face, and triangles that decide between faces.
const SAMPLES: usize = 8;

/// Most tasks for the patches. Each makes an evaluator.
const TASKS: usize = 64;

/// Triangles on their faces.
pub(super) struct Faces {
    /// Face of each triangle.
    pub of_triangle: Vec<u32>,
    /// For each vertex a face that it was put on, and where on it. For a vertex on the border of faces it is any of these.
    pub landings: Vec<Option<(u32, OnSurface)>>,
    /// What the user should know.
    pub notices: Vec<String>,
}

/// What became of a patch.
struct Match {
    face: u32,
    landings: Vec<(u32, OnSurface)>,
}

/// Finds the face of every triangle: by patch where one face holds the whole patch, else one by one.
pub(super) fn match_faces(fit: &Fit) -> Result<Faces, Error> {
    let members = fit.features.members();
    let on_ridge = ridge_vertices(fit);
    let matches = fit.team.chunks(members.len().div_ceil(TASKS), members.len(), |range| {
        let mut evaluator = fit.model.evaluator();
        let found = members[range].iter().map(|patch| match_patch(fit, &mut evaluator, patch, &on_ridge));
        found.collect::<Vec<_>>()
    });
    let mut faces = Faces {
        of_triangle: vec![NONE; fit.mesh.triangles.len()],
        landings: vec![None; fit.mesh.vertices.len()],
        notices: Vec::new(),
    };
    let mut rest = Vec::new();
    let matches: Vec<_> = matches.into_iter().flatten().collect();
    let face_of = faces_of_references(fit, &members, &matches, &on_ridge);
    let mut evaluator = fit.model.evaluator();
    for (patch, found) in members.into_iter().zip(matches) {
        let found = found.map(|found| with_its_reference(fit, &mut evaluator, &patch, found, &face_of));
        let Some(found) = found else {
            rest.push(patch);
            continue;
        };
        patch.iter().for_each(|&t| faces.of_triangle[t as usize] = found.face);
        for (vertex, on) in found.landings {
            faces.landings[vertex as usize] = Some((found.face, on));
        }
    }
    triangles::match_triangles(fit, &rest, &mut faces)?;
    note_references(fit, &mut faces);
    Ok(faces)
}

/// The face that a reference names.
pub(super) fn named(fit: &Fit, reference: i32) -> Option<u32> {
    let count = fit.topology.faces.len() as i64;
    (1..=count).contains(&i64::from(reference)).then(|| reference as u32 - 1)
}

/// The face of each reference all of whose patches with a vertex inside lie on one face.
fn faces_of_references(
    fit: &Fit,
    members: &[Vec<u32>],
    matches: &[Option<Match>],
    on_ridge: &[bool],
) -> HashMap<i32, Option<u32>> {
    let mut face_of = HashMap::new();
    for (patch, found) in members.iter().zip(matches) {
        let nodes = |&t: &u32| fit.mesh.triangles.nodes[t as usize];
        if patch.iter().flat_map(nodes).all(|v| on_ridge[v as usize]) {
            continue;
        }
        let face = found.as_ref().map(|found| found.face);
        let known = face_of.entry(fit.mesh.triangles.refs[patch[0] as usize]).or_insert(face);
        *known = known.filter(|_| *known == face);
    }
    face_of
}

/// A match, or that on the face of the patch's reference. An ear of three vertices on the border of two faces fits either, and may be turned from both.
fn with_its_reference(
    fit: &Fit,
    evaluator: &mut Evaluator,
    patch: &[u32],
    found: Match,
    face_of: &HashMap<i32, Option<u32>>,
) -> Match {
    let reference = fit.mesh.triangles.refs[patch[0] as usize];
    let nodes = patch.iter().flat_map(|&t| fit.mesh.triangles.nodes[t as usize]);
    let Some(&Some(face)) = face_of.get(&reference).filter(|face| **face != Some(found.face)) else { return found };
    if fit.hints.has_inside(found.face, nodes) {
        return found;
    }
    match land_patch(fit, evaluator, patch, face) {
        Ok(landings) if landings.iter().all(|(_, on)| on.distance <= fit.allowed(Entity::Face(face))) => {
            Match { face, landings }
        }
        _ => found,
    }
}

fn ridge_vertices(fit: &Fit) -> Vec<bool> {
    let mut on_ridge = vec![false; fit.mesh.vertices.len()];
    for (nodes, &ridge) in fit.features.edges.nodes.iter().zip(&fit.features.ridge) {
        nodes.iter().for_each(|&v| on_ridge[v as usize] |= ridge);
    }
    on_ridge
}

fn match_patch(fit: &Fit, evaluator: &mut Evaluator, patch: &[u32], on_ridge: &[bool]) -> Option<Match> {
    let nodes = || patch.iter().flat_map(|&t| fit.mesh.triangles.nodes[t as usize]);
    let mut inside: Vec<u32> = nodes().filter(|&v| !on_ridge[v as usize]).collect();
    inside.sort_unstable();
    inside.dedup();
    let hinted = named(fit, fit.mesh.triangles.refs[*patch.first()? as usize]).or_else(|| fit.hints.face_of(nodes()));
    // If a patch has no vertex inside, all of its vertices may lie on the border of another face. Only a vertex that is listed inside decides that.
    if let Some(face) = hinted
        && (!inside.is_empty() || fit.hints.has_inside(face, nodes()))
        && let Ok(landings) = land_patch(fit, evaluator, patch, face)
        && landings.iter().all(|(_, on)| on.distance <= fit.sure(Entity::Face(face)))
    {
        return Some(Match { face, landings });
    }
    let all: Vec<u32> = nodes().collect();
    let samples = spread(if inside.is_empty() { &all } else { &inside });
    let mut best: Option<(f64, Match)> = None;
    for face in 0..fit.topology.faces.len() as u32 {
        if !holds(fit, evaluator, face, &samples) {
            continue;
        }
        let Ok(landings) = land_patch(fit, evaluator, patch, face) else { continue };
        let bad: f64 = spread(patch).iter().map(|&t| misfit(fit, evaluator, t, face)).sum();
        // Of equal faces the hinted one.
        let bad = if hinted == Some(face) { bad - 1e-9 } else { bad };
        if best.as_ref().is_none_or(|(least, _)| bad < *least) {
            best = Some((bad, Match { face, landings }));
        }
    }
    best.map(|(_, found)| found)
}

/// Whether vertices are all within reach of a face.
fn holds(fit: &Fit, evaluator: &mut Evaluator, face: u32, vertices: &[u32]) -> bool {
    let reach = fit.reach(Entity::Face(face));
    vertices.iter().all(|&v| box_reaches(fit, face, fit.point(v), reach))
        && vertices.iter().all(|&v| evaluator.closest_on_face(face, fit.point(v), None).distance <= reach)
}

/// A few items from all over a list.
pub(super) fn spread(items: &[u32]) -> Vec<u32> {
    let n = items.len().min(SAMPLES);
    (0..n).map(|i| items[i * items.len() / n]).collect()
}

/// Notes for the user when references look like face numbers, but are not.
fn note_references(fit: &Fit, faces: &mut Faces) {
    let refs = &fit.mesh.triangles.refs;
    let wrong: Vec<usize> =
        (0..refs.len()).filter(|&t| named(fit, refs[t]).is_some_and(|face| face != faces.of_triangle[t])).collect();
    if let Some(&t) = wrong.first() {
        faces.notices.push(format!(
            "the references of {} of {} triangles are not the numbers of their faces, which were found by geometry instead: triangle \
             {} has reference {} but lies on face {}",
            wrong.len(),
            refs.len(),
            t + 1,
            refs[t],
            faces.of_triangle[t] + 1
        ));
    }
}
