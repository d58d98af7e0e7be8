//! Mesh edges on edges of the model.
use super::Error;
use super::error::numbers;
use super::fit::Fit;
use crate::geometry::{Entity, Evaluate, Evaluator, Geometry, OnCurve};
use crate::mesh::vector::lerp;
use std::collections::HashMap;

/// Mesh edges on model edges.
pub(super) struct Ridges {
    /// Nodes and model edge.
    pub list: Vec<([u32; 2], u32)>,
    /// For a vertex and a model edge the vertex' closest point on the edge.
    pub landings: HashMap<(u32, u32), OnCurve>,
}

/// Finds the ridges: mesh edges between triangles of different faces, and borders, each on a model edge that those
/// faces share; and mesh edges on model edges inside a face.
///
/// # Errors
/// If faces meet in the mesh but not in the model, or too far from where they do.
pub(super) fn find(fit: &Fit, faces: &[u32]) -> Result<Ridges, Error> {
    let mut search = Search { fit, evaluator: fit.model.evaluator(), landings: HashMap::new() };
    let mut list = Vec::new();
    let mut off = Vec::new();
    for edge in 0..fit.features.edges.len() {
        let Some(beside) = faces_beside(fit, faces, edge) else { continue };
        let nodes = fit.features.edges.nodes[edge];
        let candidates = shared_edges(fit, &beside);
        if candidates.is_empty() {
            return Err(no_edge(fit, nodes, &beside));
        }
        match search.nearest(nodes, &candidates) {
            Ok(found) => list.push((nodes, found)),
            Err(miss) => off.push(miss),
        }
    }
    if let Some(error) = fit.vertex_off(off) {
        return Err(error);
    }
    search.find_inner(faces, &mut list);
    Ok(Ridges { list, landings: search.landings })
}

/// Faces around a mesh edge that must be a ridge; none where it need not be one.
fn faces_beside(fit: &Fit, faces: &[u32], edge: usize) -> Option<Vec<u32>> {
    let sides = fit.features.edges.sides(edge);
    let face = |side: &u32| faces[*side as usize / 3];
    if sides.len() == 2 && face(&sides[0]) == face(&sides[1]) {
        return None;
    }
    let mut beside: Vec<u32> = sides.iter().map(face).collect();
    beside.sort_unstable();
    beside.dedup();
    Some(beside)
}

/// Edges of the model beside all of the faces.
fn shared_edges(fit: &Fit, faces: &[u32]) -> Vec<u32> {
    let edges = &fit.topology.faces[faces[0] as usize].edges;
    let shared = |&edge: &u32| {
        fit.topology.is_ridge(edge) && faces.iter().all(|f| fit.topology.edges[edge as usize].faces.contains(f))
    };
    edges.iter().copied().filter(shared).collect()
}

struct Search<'a> {
    fit: &'a Fit<'a>,
    evaluator: Evaluator<'a>,
    landings: HashMap<(u32, u32), OnCurve>,
}

impl Search<'_> {
    fn land(&mut self, vertex: u32, edge: u32) -> OnCurve {
        let (fit, evaluator) = (self.fit, &mut self.evaluator);
        *self.landings.entry((vertex, edge)).or_insert_with(|| {
            let guess = fit.hints.parameters(vertex, Entity::Edge(edge)).map(|parameters| parameters[0]);
            evaluator.closest_on_edge(edge, fit.point(vertex), guess)
        })
    }

    /// The model edge that a mesh edge lies on: the only one with both ends in reach, or that with the closest
    /// midpoint. Else the farther vertex and its distance from the nearest candidate.
    fn nearest(&mut self, nodes: [u32; 2], candidates: &[u32]) -> Result<u32, (u32, Entity, f64)> {
        let mut within = Vec::new();
        let mut miss: Option<(u32, Entity, f64)> = None;
        for &edge in candidates {
            let entity = Entity::Edge(edge);
            let [a, b] = nodes.map(|v| (v, entity, self.land(v, edge).distance));
            let farther = if b.2 > a.2 { b } else { a };
            if farther.2 <= self.fit.reach(entity) {
                within.push(edge);
            } else if miss.is_none_or(|least| farther.2 < least.2) {
                miss = Some(farther);
            }
        }
        let [a, b] = nodes.map(|v| self.fit.point(v));
        let mut from_middle = |&edge: &u32| self.evaluator.closest_on_edge(edge, lerp(a, b, 0.5), None).distance;
        match within[..] {
            [] => Err(miss.unwrap_or((nodes[0], Entity::Interior, f64::INFINITY))),
            [only] => Ok(only),
            _ => {
                let mut best = (within[0], f64::INFINITY);
                for edge in within {
                    let distance = from_middle(&edge);
                    if distance < best.1 {
                        best = (edge, distance);
                    }
                }
                Ok(best.0)
            }
        }
    }

    /// Model edges with the same face on both sides (a wire drawn into a face): mesh edges of that face along them.
    fn find_inner(&mut self, faces: &[u32], list: &mut Vec<([u32; 2], u32)>) {
        let topology = self.fit.topology;
        let covered: std::collections::HashSet<u32> = list.iter().map(|&(_, edge)| edge).collect();
        let inner: Vec<u32> = (0..topology.edges.len() as u32)
            .filter(|e| topology.is_ridge(*e) && !covered.contains(e) && topology.edges[*e as usize].faces.len() == 1)
            .collect();
        for edge in inner {
            let (face, reach) = (topology.edges[edge as usize].faces[0], self.fit.reach(Entity::Edge(edge)));
            for mesh_edge in 0..self.fit.features.edges.len() {
                let nodes = self.fit.features.edges.nodes[mesh_edge];
                if self.fit.features.edges.triangles(mesh_edge).all(|t| faces[t] == face)
                    && nodes.iter().all(|&v| self.land(v, edge).distance <= reach)
                {
                    list.push((nodes, edge));
                }
            }
        }
    }
}

fn no_edge(fit: &Fit, nodes: [u32; 2], beside: &[u32]) -> Error {
    let [a, b] = nodes.map(|v| fit.point(v));
    let faces = match beside {
        [only] => format!("face {} and nothing", only + 1),
        _ => format!("faces {}", numbers(beside)),
    };
    Error::NoEdge { nodes, place: lerp(a, b, 0.5), faces }
}
