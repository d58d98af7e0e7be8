//! From the plain mesh to the store, and back.
use super::context::Context;
use super::ids::{FACE, TetId, VertexId};
use super::required::Required;
use super::store::Store;
use crate::geometry::classify::Classification;
use crate::geometry::{Entity, Geometry, Topology};
use crate::mesh::adjacency::sorted_faces;
use crate::mesh::predicate::is_positive;
use crate::mesh::{Elements, TetMesh};
use crate::metric::quality::mean_ratio;
use crate::metric::{Source, Sym3};

/// A mesh that cannot be adapted.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// No tetrahedra.
    #[error("the mesh has no tetrahedra; a surface mesh needs a volume mesh first (gmsh, netgen or TetGen make one)")]
    Empty,
    /// A tetrahedron is inverted or flat.
    #[error(
        "tetrahedron {tet} is inverted or flat (nodes {} {} {} {}) and {others} more; `geo-adapt inspect` lists what is \
         wrong with a mesh",
        nodes[0], nodes[1], nodes[2], nodes[3]
    )]
    Inverted {
        /// Number, from 1.
        tet: usize,
        /// Nodes, from 1.
        nodes: [u32; 4],
        /// How many more.
        others: usize,
    },
    /// A face of more than two tetrahedra.
    #[error("{tets} tetrahedra share the face of nodes {} {} {}; `geo-adapt inspect` lists what is wrong with a mesh", nodes[0], nodes[1], nodes[2])]
    Shared {
        /// Nodes, from 1.
        nodes: [u32; 3],
        /// How many share it.
        tets: usize,
    },
    /// A boundary face without a triangle.
    #[error("the boundary face of nodes {} {} {} has no triangle", nodes[0], nodes[1], nodes[2])]
    Open {
        /// Nodes, from 1.
        nodes: [u32; 3],
    },
}

/// Vertices and tetrahedra at least that there is room for beside those of the input.
const ROOM: usize = 1 << 16;

/// Fills a store: every vertex gets its place on the model and its metric, every face its neighbour or tag.
///
/// Vertices start at their projected points, save those where a tetrahedron would be inverted there; the second value lists them.
///
/// # Errors
/// When a tetrahedron is inverted, or the triangles do not close the boundary.
pub fn fill(mesh: &TetMesh, place: &Classification, source: &Source) -> Result<(Store, Vec<VertexId>), Error> {
    let (nv, nt) = (mesh.vertices.len(), mesh.tets.len());
    if nt == 0 {
        return Err(Error::Empty);
    }
    check_positive(mesh)?;
    let mut store = Store::with_capacity(2 * nv + ROOM, 2 * nt + 6 * ROOM);
    store.take_vertices(nv).expect("room was made");
    store.take_tets(nt).expect("room was made");
    for v in 0..nv {
        let id = VertexId(v as u32);
        store.set_position(id, mesh.vertices[v]);
        store.set_place(id, place.entities[v], place.parameters[v]);
    }
    for (t, (nodes, region)) in mesh.tets.iter().enumerate() {
        let id = TetId(t as u32);
        store.write_tet(id, nodes.map(VertexId), region as u32, 1.0);
        nodes.iter().for_each(|&v| store.set_tet_of(VertexId(v), id));
    }
    join_tets(mesh, place, &store)?;
    join_ridges(place, &mut store);
    let waiting = snap(mesh, place, &store);
    measure(&store, source);
    Ok((store, waiting))
}

fn check_positive(mesh: &TetMesh) -> Result<(), Error> {
    let inverted = |nodes: &[u32; 4]| !is_positive(nodes.map(|v| mesh.vertices[v as usize]));
    let mut bad = mesh.tets.nodes.iter().enumerate().filter(|(_, nodes)| inverted(nodes));
    match bad.next() {
        Some((tet, nodes)) => Err(Error::Inverted { tet: tet + 1, nodes: nodes.map(|v| v + 1), others: bad.count() }),
        None => Ok(()),
    }
}

/// Sets neighbours and face tags.
fn join_tets(mesh: &TetMesh, place: &Classification, store: &Store) -> Result<(), Error> {
    let mut triangles: Vec<([u32; 3], u32)> = Vec::with_capacity(mesh.triangles.len());
    for (nodes, &face) in mesh.triangles.nodes.iter().zip(&place.faces) {
        let mut key = *nodes;
        key.sort_unstable();
        triangles.push((key, face + 1));
    }
    triangles.sort_unstable();
    let mut next = triangles.iter().peekable();
    let local = |t: TetId, key: [u32; 3]| {
        store.vertices(t).iter().position(|v| !key.contains(&v.0)).expect("a face leaves one vertex out")
    };
    for same in sorted_faces(&mesh.tets.nodes).chunk_by(|a, b| a.nodes == b.nodes) {
        let key = same[0].nodes;
        while next.next_if(|triangle| triangle.0 < key).is_some() {}
        let tag = next.peek().filter(|triangle| triangle.0 == key).map_or(0, |triangle| triangle.1);
        let tets: Vec<TetId> = same.iter().map(|side| TetId(side.side / 4)).collect();
        match tets[..] {
            [t] if tag != 0 => store.set_tag(t, local(t, key), tag),
            [_] => return Err(Error::Open { nodes: key.map(|v| v + 1) }),
            [a, b] => {
                let (i, j) = (local(a, key), local(b, key));
                store.set_neighbour(a, i, b);
                store.set_neighbour(b, j, a);
                store.set_tag(a, i, tag);
                store.set_tag(b, j, tag);
            }
            _ => return Err(Error::Shared { nodes: key.map(|v| v + 1), tets: tets.len() }),
        }
    }
    Ok(())
}

/// Sets the ridge neighbours of vertices on model edges and of corners.
fn join_ridges(place: &Classification, store: &mut Store) {
    let mut ends: Vec<(u32, u32, u32)> = Vec::with_capacity(2 * place.ridges.len());
    for &([a, b], curve) in &place.ridges {
        ends.push((a, b, curve));
        ends.push((b, a, curve));
    }
    ends.sort_unstable();
    for at_vertex in ends.chunk_by(|x, y| x.0 == y.0) {
        let v = VertexId(at_vertex[0].0);
        match store.entity(v) {
            Entity::Edge(_) => {
                let other = |k: usize| at_vertex.get(k).map_or(VertexId::NONE, |&(_, b, _)| VertexId(b));
                store.set_ridge(v, [other(0), other(1)]);
            }
            _ => store.set_corner(v, at_vertex.iter().map(|&(_, b, curve)| (VertexId(b), curve)).collect()),
        }
    }
    // Corners without a ridge (a required vertex on a face) still need their empty list.
    let lonely: Vec<VertexId> = (0..place.entities.len() as u32)
        .filter(|&v| matches!(place.entities[v as usize], Entity::Vertex(_)))
        .filter(|&v| ends.binary_search_by_key(&v, |end| end.0).is_err())
        .map(VertexId)
        .collect();
    for v in lonely {
        store.set_corner(v, Vec::new());
    }
}

/// Moves the vertices to their projected points; where that inverts a tetrahedron its vertices stay, and are returned.
fn snap(mesh: &TetMesh, place: &Classification, store: &Store) -> Vec<VertexId> {
    for (v, &point) in place.projected.iter().enumerate() {
        store.set_position(VertexId(v as u32), point);
    }
    let mut waiting = Vec::new();
    loop {
        let before = waiting.len();
        for t in store.live_tets() {
            let vertices = store.vertices(t);
            if is_positive(vertices.map(|v| store.position(v))) {
                continue;
            }
            for v in vertices.into_iter().filter(|v| store.position(*v) != mesh.vertices[v.index()]) {
                store.set_position(v, mesh.vertices[v.index()]);
                waiting.push(v);
            }
        }
        if waiting.len() == before {
            return waiting;
        }
    }
}

/// Gives every vertex its metric and every tetrahedron its mean ratio.
pub fn measure(store: &Store, source: &Source) {
    let mut hint = 0;
    for v in store.live_vertices() {
        let log = source.log_at(store.position(v), &mut hint);
        store.set_metric(v, &log, &log.exp());
        store.set_hint(v, hint);
    }
    for t in store.live_tets() {
        let vertices = store.vertices(t);
        let logs = vertices.map(|v| store.log(v));
        let points = vertices.map(|v| store.position(v));
        store.set_quality(t, mean_ratio(points, [&logs[0], &logs[1], &logs[2], &logs[3]]));
    }
}

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
