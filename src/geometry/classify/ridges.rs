//! Mesh edges on edges of the model.
use super::Error;
use super::error::numbers;
use super::fit::Fit;
use crate::geometry::{Entity, Evaluate, Evaluator, Geometry, OnCurve};
use crate::mesh::box_tree::BoxTree;
use crate::mesh::vector::{Vec3, lerp};
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
        let Some(within) = Within::new(self.fit, faces, &inner) else { return };
        for edge in inner {
            let (face, reach) = (topology.edges[edge as usize].faces[0], self.fit.reach(Entity::Edge(edge)));
            let mut found = within.near(face, self.evaluator.edge_box(edge), reach);
            found.retain(|nodes| nodes.iter().all(|&v| self.is_near(v, edge, reach)));
            self.keep_neighbours(edge, &mut found);
            list.extend(found.into_iter().map(|nodes| (nodes, edge)));
        }
    }

    /// Keeps the mesh edges whose ends follow each other along the model edge. One that leaves out a vertex between is a chord over a bend.
    fn keep_neighbours(&mut self, edge: u32, found: &mut Vec<[u32; 2]>) {
        let mut along: Vec<(f64, u32)> = found.iter().flatten().map(|&v| (self.land(v, edge).t, v)).collect();
        along.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        along.dedup();
        let rank: HashMap<u32, usize> = along.iter().zip(0..).map(|(&(_, v), rank)| (v, rank)).collect();
        let [first, last] = self.fit.topology.edges[edge as usize].vertices;
        found.retain(|nodes| {
            let apart = rank[&nodes[0]].abs_diff(rank[&nodes[1]]);
            apart == 1 || first == last && apart + 1 == along.len()
        });
    }

    /// Whether a vertex is within reach of a model edge. Landings out of reach are not kept: there is one for each vertex and edge.
    fn is_near(&mut self, vertex: u32, edge: u32, reach: f64) -> bool {
        if let Some(on) = self.landings.get(&(vertex, edge)) {
            return on.distance <= reach;
        }
        let (fit, evaluator) = (self.fit, &mut self.evaluator);
        if fit.hints.parameters(vertex, Entity::Edge(edge)).is_none()
            && evaluator.closest_on_edge_within(edge, fit.point(vertex), reach.next_up()).is_none()
        {
            return false;
        }
        self.land(vertex, edge).distance <= reach
    }
}

/// Mesh edges within faces.
struct Within<'a> {
    fit: &'a Fit<'a>,
    /// Face and mesh edge, sorted.
    edges: Vec<(u32, u32)>,
    tree: BoxTree,
}

impl<'a> Within<'a> {
    /// Those of the faces that model edges lie in; none if there are none.
    fn new(fit: &'a Fit, faces: &[u32], inner: &[u32]) -> Option<Self> {
        let mut wanted = vec![false; fit.topology.faces.len()];
        inner.iter().for_each(|&edge| wanted[fit.topology.edges[edge as usize].faces[0] as usize] = true);
        let mut edges: Vec<(u32, u32)> = (0..fit.features.edges.len())
            .filter_map(|edge| {
                let mut beside = fit.features.edges.triangles(edge).map(|t| faces[t]);
                let face = beside.next()?;
                (wanted[face as usize] && beside.all(|other| other == face)).then_some((face, edge as u32))
            })
            .collect();
        edges.sort_unstable();
        let bounds = |&(_, edge): &(u32, u32)| {
            let [a, b] = fit.features.edges.nodes[edge as usize].map(|v| fit.point(v));
            [[0, 1, 2].map(|i| a[i].min(b[i])), [0, 1, 2].map(|i| a[i].max(b[i]))]
        };
        (!edges.is_empty()).then(|| Self {
            fit,
            tree: BoxTree::new(edges.len(), |i| bounds(&edges[i as usize])),
            edges,
        })
    }

    /// The nodes of those of a face that come within reach of a box; all of the face where there is no box. In the mesh's order.
    fn near(&self, face: u32, about: Option<[Vec3; 2]>, reach: f64) -> Vec<[u32; 2]> {
        let mut found = Vec::new();
        match about {
            Some([low, high]) => {
                let about = [low.map(|x| x - reach), high.map(|x| x + reach)];
                self.tree.overlapping(&about, |i| found.push(self.edges[i as usize]));
                found.retain(|edge| edge.0 == face);
                found.sort_unstable();
            }
            None => {
                let begin = self.edges.partition_point(|edge| edge.0 < face);
                found.extend(self.edges[begin..].iter().take_while(|edge| edge.0 == face));
            }
        }
        found.iter().map(|edge| self.fit.features.edges.nodes[edge.1 as usize]).collect()
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
