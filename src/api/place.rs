//! Whether a place that a caller gives is one of this mesh on this model: the kernel takes it as it is.
use super::error::Error;
use super::view::{fits, in_range};
use crate::geometry::classify::Classification;
use crate::geometry::{Entity, Geometry, Model};
use crate::mesh::TetMesh;
use crate::mesh::adjacency::{Side, TriangleIndex, sorted3};
use crate::tasks::Team;
use std::collections::BTreeMap;

/// Refuses a place that is not of this mesh on this model.
pub fn check(team: Team<'_>, place: &Classification, mesh: &TetMesh, model: &Model) -> Result<(), Error> {
    check_ranges(place, mesh, model)?;
    let faces = surface(team, place, mesh);
    check_vertices(place, mesh, &faces)?;
    check_ridges(place)?;
    check_edges(place, model, &faces)
}

/// Numbers of this mesh and of this model, and finite.
fn check_ranges(place: &Classification, mesh: &TetMesh, model: &Model) -> Result<(), Error> {
    let (vertices, topology) = (mesh.vertices.len(), model.topology());
    fits("entities", place.entities.len(), vertices)?;
    fits("parameters", place.parameters.len(), vertices)?;
    fits("points on the model", place.projected.len(), vertices)?;
    fits("model faces of triangles", place.faces.len(), mesh.triangles.len())?;
    in_range("the face of triangle", place.faces.iter().map(|&face| [face]), topology.faces.len())?;
    in_range("ridge", place.ridges.iter().map(|&(nodes, _)| nodes), vertices)?;
    in_range("the edge of ridge", place.ridges.iter().map(|&(_, edge)| [edge]), topology.edges.len())?;
    let is_finite = |numbers: &[f64]| numbers.iter().all(|x| x.is_finite());
    for (v, entity) in place.entities.iter().enumerate() {
        let (index, count) = match *entity {
            Entity::Vertex(i) => (i, topology.vertices.len()),
            Entity::Edge(i) => (i, topology.edges.len()),
            Entity::Face(i) => (i, topology.faces.len()),
            Entity::Interior => (0, 1),
        };
        if index as usize >= count {
            return Err(Error::OutOfRange { what: "the entity of vertex", element: v, index, count });
        }
        if !is_finite(&place.parameters[v]) || !is_finite(&place.projected[v]) {
            return Err(Error::place(format!("the parameters of vertex {v} are not finite")));
        }
    }
    Ok(())
}

/// A face of the tetrahedra on the surface: its nodes, ascending, its face of the model, and the first triangle that says so.
type Face = ([u32; 3], u32, u32);

/// The surface, each face once.
fn surface(team: Team<'_>, place: &Classification, mesh: &TetMesh) -> Vec<Face> {
    let triangles = TriangleIndex::new(team, &mesh.triangles.nodes, mesh.vertices.len());
    let sides = triangles.sides(team, &mesh.tets.nodes);
    let of = |Side { triangle, .. }: Side| {
        let at = triangle as usize;
        (sorted3(mesh.triangles.nodes[at]), place.faces[at], triangle)
    };
    let mut faces: Vec<Face> = sides.into_iter().map(of).collect();
    team.sort(&mut faces);
    faces.dedup_by_key(|face| face.0);
    faces
}

/// The vertices of triangles lie on their faces or on what bounds them, each corner of the model has one, all others are inside.
fn check_vertices(place: &Classification, mesh: &TetMesh, faces: &[Face]) -> Result<(), Error> {
    let mut on_surface = vec![false; mesh.vertices.len()];
    for &(nodes, face, triangle) in faces {
        for v in nodes {
            on_surface[v as usize] = true;
            match place.entities[v as usize] {
                Entity::Face(own) if own != face => {
                    return Err(Error::place(format!(
                        "vertex {v} lies on face {own}, and is in triangle {triangle} of face {face}"
                    )));
                }
                Entity::Interior => {
                    return Err(Error::place(format!(
                        "vertex {v} lies inside, and is in triangle {triangle} of face {face}"
                    )));
                }
                _ => {}
            }
        }
    }
    let mut corners: BTreeMap<u32, usize> = BTreeMap::new();
    for (v, &entity) in place.entities.iter().enumerate() {
        if entity != Entity::Interior && !on_surface[v] {
            return Err(Error::place(format!("vertex {v} lies on the model, and is in no triangle of the surface")));
        }
        if let Entity::Vertex(corner) = entity
            && let Some(other) = corners.insert(corner, v)
        {
            return Err(Error::place(format!("the vertices {other} and {v} both lie on vertex {corner} of the model")));
        }
    }
    Ok(())
}

/// A vertex on a model edge has one or two ridges, of that edge; others only corners have.
fn check_ridges(place: &Classification) -> Result<(), Error> {
    let mut count = vec![0u8; place.entities.len()];
    for (ridge, &([a, b], edge)) in place.ridges.iter().enumerate() {
        for v in [a, b] {
            match place.entities[v as usize] {
                Entity::Vertex(_) => {}
                Entity::Edge(own) if own == edge => {
                    let count = &mut count[v as usize];
                    *count = count.saturating_add(1);
                    if *count > 2 {
                        return Err(Error::place(format!(
                            "vertex {v} lies on edge {edge}, and has more than two ridges: ridge {ridge} is one too many"
                        )));
                    }
                }
                _ => {
                    return Err(Error::place(format!(
                        "vertex {v} is an end of ridge {ridge} on edge {edge}, and does not lie there"
                    )));
                }
            }
        }
    }
    let bare = |(v, entity): (usize, &Entity)| (matches!(entity, Entity::Edge(_)) && count[v] == 0).then_some(v);
    match place.entities.iter().enumerate().find_map(bare) {
        Some(v) => Err(Error::place(format!("vertex {v} lies on an edge, and has no ridge"))),
        None => Ok(()),
    }
}

/// Each ridge is an edge of the surface, once, and bounds the faces beside it; where faces meet there is one.
fn check_edges(place: &Classification, model: &Model, faces: &[Face]) -> Result<(), Error> {
    let key = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let mut ridges: BTreeMap<[u32; 2], (usize, u32)> = BTreeMap::new();
    for (ridge, &(nodes, edge)) in place.ridges.iter().enumerate() {
        if let Some((other, _)) = ridges.insert(key(nodes), (ridge, edge)) {
            return Err(Error::place(format!("the ridges {other} and {ridge} are the same")));
        }
    }
    let sides = |&([a, b, c], face, _): &Face| [([a, b], face), ([b, c], face), ([a, c], face)];
    let mut edges: Vec<([u32; 2], u32)> = faces.iter().flat_map(sides).collect();
    edges.sort_unstable();
    for same in edges.chunk_by(|x, y| x.0 == y.0) {
        let [a, b] = same[0].0;
        match ridges.remove(&[a, b]) {
            Some((ridge, edge)) => {
                let beside = &model.topology().edges[edge as usize].faces;
                if let Some((_, face)) = same.iter().find(|(_, face)| !beside.contains(face)) {
                    return Err(Error::place(format!(
                        "ridge {ridge} lies on edge {edge}, which does not bound face {face} beside it"
                    )));
                }
            }
            None if same.len() == 2 && same[0].1 == same[1].1 => {}
            None => {
                let face = same[0].1;
                return Err(Error::place(format!(
                    "face {face} ends between the vertices {a} and {b}, where there is no ridge"
                )));
            }
        }
    }
    match ridges.into_values().min() {
        Some((ridge, _)) => Err(Error::place(format!("ridge {ridge} is no edge of the surface"))),
        None => Ok(()),
    }
}
