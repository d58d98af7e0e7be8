//! Whether the mesh covers the whole model.
use super::Error;
use super::fit::Fit;
use super::ridges::Ridges;
use crate::geometry::discrete::trace_chains;
use crate::geometry::{Entity, Evaluate, Geometry};

/// Every face has triangles, every ridge of the model one chain of mesh edges from its first vertex to its last.
///
/// # Errors
/// Names the first face or edge that is not covered so.
pub(super) fn check(fit: &Fit, faces: &[u32], ridges: &Ridges, entities: &[Entity]) -> Result<(), Error> {
    let mut covered = vec![false; fit.topology.faces.len()];
    faces.iter().for_each(|&face| covered[face as usize] = true);
    if let Some(face) = covered.iter().position(|c| !c) {
        return Err(Error::FaceNotCovered { face: face as u32, bounds: fit.topology.faces[face].bounds });
    }
    let mut on_edge = vec![Vec::new(); fit.topology.edges.len()];
    for &(nodes, edge) in &ridges.list {
        on_edge[edge as usize].push(nodes);
    }
    for edge in (0..fit.topology.edges.len() as u32).filter(|&e| fit.topology.is_ridge(e)) {
        check_edge(fit, edge, &on_edge[edge as usize], entities)?;
    }
    Ok(())
}

fn check_edge(fit: &Fit, edge: u32, nodes: &[[u32; 2]], entities: &[Entity]) -> Result<(), Error> {
    let entity = &fit.topology.edges[edge as usize];
    let corner = |v: u32| match entities[v as usize] {
        Entity::Vertex(vertex) => Some(vertex),
        _ => None,
    };
    let chains = trace_chains(nodes, |v| corner(v).is_some());
    let good = match &chains[..] {
        [chain] => {
            let ends = [chain.vertices[0], chain.vertices[chain.vertices.len() - 1]].map(corner);
            let [first, last] = entity.vertices;
            // The vertex of a closed edge may be missing in the mesh.
            let open_ring = first == last && ends == [None; 2] && chain.is_closed();
            open_ring || ends == [first, last] || ends == [last, first]
        }
        _ => false,
    };
    if good {
        return Ok(());
    }
    let middle = 0.5 * (entity.range[0] + entity.range[1]);
    let place = fit.model.evaluator().edge_frame(edge, middle).point;
    Err(Error::EdgeNotCovered { edge, place, chains: chains.len() })
}
