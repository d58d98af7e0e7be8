//! Mesh vertices on vertices of the model.
use super::Error;
use super::fit::Fit;
use super::ridges::Ridges;
use crate::geometry::discrete::{BoxTree, box_of};
use crate::geometry::{Entity, Evaluate, Evaluator, Geometry};
use crate::mesh::vector::{Vec3, add, cross, distance, dot, lerp, norm, sub};
use std::collections::HashMap;

/// Whether a mesh must have a vertex on a vertex of the model.
#[derive(PartialEq)]
enum Need {
    /// A corner of the shape.
    Corner,
    /// It only closes one smooth edge. It is used where the mesh has a vertex there.
    Ring,
    /// A smooth pole or the end of a seam: no feature of the shape.
    None,
}

/// Mesh vertex of each model vertex, where there is one.
///
/// # Errors
/// If a corner of the model has no mesh vertex of its own.
pub(super) fn find(fit: &Fit, ridges: &Ridges) -> Result<Vec<Option<u32>>, Error> {
    let mut evaluator = fit.model.evaluator();
    let on_ridges = Points::new(fit, ridges.list.iter().flat_map(|(nodes, _)| *nodes).collect());
    let on_edges = OnEdges::new(ridges);
    let mut on_surface = None;
    let mut taken: HashMap<u32, u32> = HashMap::new();
    let mut found = vec![None; fit.topology.vertices.len()];
    for (i, vertex) in fit.topology.vertices.iter().enumerate() {
        let model = i as u32;
        let need = need(fit, &mut evaluator, model);
        if need == Need::None {
            continue;
        }
        let points = if vertex.edges.iter().any(|&e| fit.topology.is_ridge(e)) {
            &on_ridges
        } else {
            on_surface
                .get_or_insert_with(|| Points::new(fit, fit.mesh.triangles.nodes.iter().flatten().copied().collect()))
        };
        let tolerance = fit.allowed(Entity::Vertex(model));
        let (mut nearest, mut away) = points.nearest(fit, vertex.point);
        // Where solids touch, vertices of several solids lie at one place. Each goes with its edges.
        if nearest.is_some_and(|mesh| !on_edges.has(mesh, &vertex.edges))
            && let Some((own, at)) = on_edges.nearest(fit, &vertex.edges, vertex.point)
            && at <= tolerance
        {
            (nearest, away) = (Some(own), at);
        }
        match nearest.filter(|_| away <= tolerance) {
            Some(mesh) => {
                if let Some(other) = taken.insert(mesh, model) {
                    return Err(Error::SharedVertex { models: [other, model], vertex: mesh });
                }
                found[i] = Some(mesh);
            }
            None if need == Need::Ring => {}
            None => {
                let (point, distance) = (vertex.point, away);
                return Err(Error::NoMeshVertex { vertex: model, point, nearest, distance, tolerance });
            }
        }
    }
    Ok(found)
}

/// Mesh vertices among which the nearest is looked for.
struct Points {
    vertices: Vec<u32>,
    tree: BoxTree,
}

impl Points {
    fn new(fit: &Fit, mut vertices: Vec<u32>) -> Self {
        vertices.sort_unstable();
        vertices.dedup();
        let boxes: Vec<_> = vertices.iter().map(|&v| box_of([fit.point(v)])).collect();
        Self { tree: BoxTree::new(&boxes), vertices }
    }

    fn nearest(&self, fit: &Fit, point: Vec3) -> (Option<u32>, f64) {
        let away = |i: u32| distance(fit.point(self.vertices[i as usize]), point);
        match self.tree.nearest(point, f64::INFINITY, |i| away(i).powi(2)) {
            Some(i) => (Some(self.vertices[i as usize]), away(i)),
            None => (None, f64::INFINITY),
        }
    }
}

/// Mesh vertices by the model edges that their ridges lie on.
struct OnEdges {
    /// Model edge and vertex, sorted.
    list: Vec<(u32, u32)>,
}

impl OnEdges {
    fn new(ridges: &Ridges) -> Self {
        let mut list: Vec<_> = ridges.list.iter().flat_map(|&(nodes, edge)| nodes.map(|v| (edge, v))).collect();
        list.sort_unstable();
        list.dedup();
        Self { list }
    }

    /// Whether a vertex lies on one of these edges.
    fn has(&self, vertex: u32, edges: &[u32]) -> bool {
        edges.iter().any(|&edge| self.list.binary_search(&(edge, vertex)).is_ok())
    }

    /// The vertex on these edges that is nearest to a point, and how far it is.
    fn nearest(&self, fit: &Fit, edges: &[u32], point: Vec3) -> Option<(u32, f64)> {
        let on = |edge: u32| {
            let begin = self.list.partition_point(|entry| entry.0 < edge);
            self.list[begin..].iter().take_while(move |entry| entry.0 == edge)
        };
        let all = edges.iter().flat_map(|&edge| on(edge)).map(|&(_, v)| (v, distance(fit.point(v), point)));
        all.min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)))
    }
}

fn need(fit: &Fit, evaluator: &mut Evaluator, vertex: u32) -> Need {
    let edges = &fit.topology.vertices[vertex as usize].edges;
    let ridges: Vec<u32> = edges.iter().copied().filter(|&e| fit.topology.is_ridge(e)).collect();
    match ridges[..] {
        [] if edges.is_empty() => Need::Corner,
        [] if is_apex(fit, evaluator, edges) => Need::Corner,
        [] => Need::None,
        [only] if is_smooth_ring(fit, evaluator, only) => Need::Ring,
        _ => Need::Corner,
    }
}

/// Whether an edge closes on itself without a kink.
fn is_smooth_ring(fit: &Fit, evaluator: &mut Evaluator, edge: u32) -> bool {
    let entity = &fit.topology.edges[edge as usize];
    let [first, last] = entity.range.map(|t| evaluator.edge_frame(edge, t).d1);
    entity.vertices[0] == entity.vertices[1] && dot(first, last) > (1.0 - 1e-6) * norm(first) * norm(last)
}

/// Whether a face has an apex at one of its degenerate edges: its normal differs around it. A cone's apex is one, a sphere's pole is
/// not.
fn is_apex(fit: &Fit, evaluator: &mut Evaluator, edges: &[u32]) -> bool {
    let poles = edges.iter().copied().filter(|&e| fit.topology.edges[e as usize].degenerate);
    poles.into_iter().any(|edge| {
        let entity = &fit.topology.edges[edge as usize];
        entity.faces.iter().any(|&face| {
            let normals: Vec<Vec3> = (0..8)
                .filter_map(|i| {
                    let [first, last] = entity.range;
                    let t = first + (last - first) * (f64::from(i) + 0.5) / 8.0;
                    let uv = evaluator.edge_on_face(edge, t, face)?;
                    Some(evaluator.face_normal(face, inward(fit, face, uv)))
                })
                .collect();
            let mean = normals.iter().fold([0.0; 3], |sum, &n| add(sum, n));
            normals.iter().any(|&n| norm(cross(n, mean)) > 0.05 * norm(mean) || dot(n, mean) <= 0.0)
        })
    })
}

/// Parameters a little towards the middle of a face.
fn inward(fit: &Fit, face: u32, uv: [f64; 2]) -> [f64; 2] {
    let [[u0, u1], [v0, v1]] = fit.topology.faces[face as usize].range;
    let (from, to) = ([uv[0], uv[1], 0.0], [0.5 * (u0 + u1), 0.5 * (v0 + v1), 0.0]);
    // Only across the degenerate edge: along it the samples must stay apart.
    let spans = sub([u1, v1, 0.0], [u0, v0, 0.0]);
    let at_end = |i: usize| {
        let low = [u0, v0][i];
        let fraction = if spans[i] > 0.0 { (uv[i] - low) / spans[i] } else { 0.5 };
        !(1e-6..=1.0 - 1e-6).contains(&fraction)
    };
    let moved = lerp(from, to, 1e-3);
    std::array::from_fn(|i| if at_end(i) { moved[i] } else { uv[i] })
}
