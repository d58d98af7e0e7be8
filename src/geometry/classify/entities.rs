//! The entity of every vertex, from those of triangles, ridges and corners.
use super::Error;
use super::error::numbers;
use super::fit::Fit;
use super::ridges::Ridges;
use crate::geometry::Entity;
use std::collections::HashMap;

/// Gives every mesh vertex its entity of lowest dimension.
///
/// # Errors
/// If ridges end, branch or change their edge off the model's vertices, or faces meet at a vertex without a ridge.
pub(super) fn assemble(
    fit: &Fit,
    faces: &[u32],
    ridges: &Ridges,
    corners: &[Option<u32>],
) -> Result<Vec<Entity>, Error> {
    let mut entities = vec![Entity::Interior; fit.mesh.vertices.len()];
    let mut pinched = Vec::new();
    for (nodes, &face) in fit.mesh.triangles.nodes.iter().zip(faces) {
        for &v in nodes {
            let entity = &mut entities[v as usize];
            if !matches!(*entity, Entity::Interior | Entity::Face(_)) || *entity == Entity::Face(face) {
                continue;
            }
            if *entity != Entity::Interior {
                pinched.push(v);
            }
            *entity = Entity::Face(face);
        }
    }
    let mut at: HashMap<u32, Vec<u32>> = HashMap::new();
    for &(nodes, edge) in &ridges.list {
        nodes.iter().for_each(|&v| at.entry(v).or_default().push(edge));
    }
    for (&v, edges) in &at {
        entities[v as usize] = Entity::Edge(edges[0]);
    }
    for (model, corner) in corners.iter().enumerate() {
        if let Some(v) = corner {
            entities[*v as usize] = Entity::Vertex(model as u32);
        }
    }
    check_chains(fit, &at, &entities)?;
    match pinched.into_iter().find(|&v| entities[v as usize].dimension() == 2) {
        Some(vertex) => Err(Error::Pinched { vertex, point: fit.point(vertex) }),
        None => Ok(entities),
    }
}

/// At a vertex inside a model edge exactly two ridges of that edge meet.
fn check_chains(fit: &Fit, at: &HashMap<u32, Vec<u32>>, entities: &[Entity]) -> Result<(), Error> {
    let loose = |(v, edges): &(&u32, &Vec<u32>)| {
        let inside = entities[**v as usize].dimension() == 1;
        inside && (edges.len() != 2 || edges[0] != edges[1])
    };
    let Some((&vertex, edges)) = at.iter().filter(loose).min_by_key(|(v, _)| **v) else { return Ok(()) };
    let mut edges = edges.clone();
    edges.sort_unstable();
    edges.dedup();
    let noun = if edges.len() == 1 { "edge" } else { "edges" };
    Err(Error::LooseEnd { vertex, point: fit.point(vertex), edges: format!("{noun} {}", numbers(&edges)) })
}
