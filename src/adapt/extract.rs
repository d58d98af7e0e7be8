//! From the store back to the plain mesh.
use super::context::Context;
use super::ids::{FACE, TetId, VertexId};
use super::required::Required;
use super::store::Store;
use crate::geometry::classify::Classification;
use crate::geometry::{Entity, Geometry, Topology};
use crate::mesh::{Elements, TetMesh};
use crate::metric::Sym3;

/// What the mesh calls each face and each edge of the model, and how it turns a face's triangles.
pub struct References {
    /// By face.
    pub faces: Vec<i32>,
    /// Whether the triangles of a face look into the domain (between regions: into the lesser one).
    pub inward: Vec<bool>,
    /// By edge.
    pub edges: Vec<i32>,
}

/// The store as a plain mesh with its classification, and the metric at its vertices.
pub struct Extracted {
    /// The mesh, without association; of its edges those that are required.
    pub mesh: TetMesh,
    /// Where its boundary lies.
    pub classification: Classification,
    /// M at its vertices.
    pub metrics: Vec<Sym3>,
}

/// Takes the mesh out of the store, in the order of its ids, with what `input` required. `face_refs` gives each model
/// face its reference.
pub fn extract(context: &Context, input: &TetMesh, refs: &References) -> Extracted {
    let store = &context.store;
    let mut number = vec![u32::MAX; store.vertex_bound()];
    let mut mesh = TetMesh::default();
    let mut classification = Classification::default();
    let mut metrics = Vec::new();
    let mut original = vec![VertexId::NONE; store.vertex_bound()];
    for (v, id) in context.ids.iter().enumerate().filter(|(_, id)| id.is_some()) {
        original[id.index()] = VertexId(v as u32);
    }
    for v in store.live_vertices() {
        number[v.index()] = mesh.vertices.len() as u32;
        mesh.vertices.push(store.position(v));
        // Only corners and frozen vertices surely are what they were: other ids may have been used again.
        let is_old = matches!(store.entity(v), Entity::Vertex(_)) || context.is_frozen(v);
        let kept = is_old.then(|| original[v.index()]).filter(|v| v.is_some());
        mesh.vertex_refs.push(kept.map_or(0, |v| input.vertex_refs[v.index()]));
        classification.entities.push(store.entity(v));
        classification.parameters.push(store.parameters(v));
        classification.projected.push(store.position(v));
        metrics.push(store.metric(v));
    }
    let renumber = |v: VertexId| number[v.index()];
    for t in store.live_tets() {
        let (v, n, tags) = (store.vertices(t), store.neighbours(t), store.tags(t));
        mesh.tets.push(v.map(renumber), store.region(t) as i32);
        // Between two regions a triangle belongs to the lesser one.
        let region = |t: TetId| (store.region(t) as i32, t);
        for i in (0..4).filter(|&i| tags[i] != 0 && (!n[i].is_some() || region(t) < region(n[i]))) {
            let [a, b, c] = FACE[i].map(|k| renumber(v[k]));
            let face = tags[i] - 1;
            let outward = !refs.inward[face as usize];
            mesh.triangles.push(if outward { [a, c, b] } else { [a, b, c] }, refs.faces[face as usize]);
            classification.faces.push(face);
        }
    }
    classification.ridges = ridges(store, context.model.topology(), renumber);
    for &(nodes, edge) in &classification.ridges {
        mesh.edges.push(nodes, refs.edges[edge as usize]);
    }
    Required::list(input, &mut mesh, |v| renumber(context.ids[v.index()]));
    Extracted { mesh, classification, metrics }
}

/// Each ridge edge once, in the order of its lower vertex.
fn ridges(store: &Store, topology: &Topology, number: impl Fn(VertexId) -> u32) -> Vec<([u32; 2], u32)> {
    let mut edges = Elements::<2>::default();
    for v in store.live_vertices() {
        match store.entity(v) {
            Entity::Edge(curve) => {
                for other in store.ridge(v).into_iter().filter(|w| w.is_some()) {
                    if store.dimension(other) == 0 || v < other {
                        edges.push([number(v), number(other)], curve as i32);
                    }
                }
            }
            Entity::Vertex(_) => {
                for (other, curve) in store.corner_ridges(v) {
                    if store.dimension(other) == 0 && v < other {
                        edges.push([number(v), number(other)], curve as i32);
                    }
                }
            }
            _ => {}
        }
    }
    debug_assert!(edges.refs.iter().all(|&curve| (curve as usize) < topology.edges.len()));
    edges.iter().map(|(nodes, curve)| (nodes, curve as u32)).collect()
}
