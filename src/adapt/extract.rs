//! From the store back to the plain mesh.
use crate::adapt::core::context::Context;
use crate::adapt::core::ids::{FACE, TetId, VertexId};
use crate::adapt::core::numbering::inverse;
use crate::adapt::core::required::Required;
use crate::adapt::core::store::{Store, Torn};
use crate::adapt::references::References;
use crate::geometry::classify::Classification;
use crate::geometry::{Entity, Evaluate, Geometry, Model};
use crate::mesh::crossing::{self, Crossings};
use crate::mesh::vector::Vec3;
use crate::mesh::{Elements, TetMesh};
use crate::metric::Sym3;
use crate::tasks::{GRAIN, Team};
use std::collections::HashMap;
use std::ops::Range;

/// The store as a plain mesh with its classification, and the metric at its vertices.
pub struct Extracted {
    /// The mesh, without association; of its edges those that are required.
    pub mesh: TetMesh,
    /// Where its boundary lies.
    pub classification: Classification,
    /// M at its vertices.
    pub metrics: Vec<Sym3>,
    /// Boundary vertices without room on the model: at their closest points tetrahedra would be inverted.
    pub off_model: Vec<u32>,
    /// Boundary vertices that must not move: they are as far from the model as they were in the input.
    pub held: Vec<u32>,
    /// Where its boundary passes through itself.
    pub crossings: Crossings,
    /// Of a part of a larger mesh, what joins it to the others.
    pub part: Option<Joint>,
}

/// What joins an adapted part to the parts beside it.
pub struct Joint {
    /// ln M at the vertices.
    pub logs: Vec<Sym3>,
    /// The vertices that were held, in the order in which they were given, by their numbers now.
    pub held: Vec<u32>,
}

/// What joins a part to the others, whose vertices `held` were to stay.
pub fn part(team: Team<'_>, context: &Context, held: &[u32]) -> Joint {
    let store = &context.store;
    let vertices = live_vertices(team, store);
    let number = inverse(team, &vertices, store.vertex_bound(), |place| place);
    let logs = at(team, &vertices, |v| store.log(v));
    Joint { logs, held: held.iter().map(|&v| number[context.ids[v as usize].index()]).collect() }
}

/// The vertices in the order of their ids.
fn live_vertices(team: Team<'_>, store: &Store) -> Vec<u32> {
    team.collect(GRAIN, store.vertex_bound(), |range, live| live.extend(store.live_vertices_in(range).map(|v| v.0)))
}

/// How many pairs of crossing triangles are told.
const TOLD: usize = 3;

/// A surface triangle.
#[derive(Clone, Copy)]
struct Triangle {
    nodes: [u32; 3],
    face: u32,
    /// On the boundary its nodes, in the order in which the normal points outwards.
    outward: Option<[u32; 3]>,
}

/// Takes the mesh out of the store, in the order of its ids, with what `input` required; `refs` gives each model
/// entity its reference, and `unprojected` are the vertices that are not on the model.
///
/// # Errors
/// [`Torn`] where a tetrahedron has a dead vertex.
pub fn extract(
    team: Team<'_>,
    context: &Context,
    input: &TetMesh,
    refs: &References,
    unprojected: &[VertexId],
) -> Result<Extracted, Torn> {
    let store = &context.store;
    let vertices = live_vertices(team, store);
    let number = inverse(team, &vertices, store.vertex_bound(), |place| place);
    let renumber = |v: VertexId| number[v.index()];
    let tets = tets(team, store, &renumber);
    let is_whole = |range: Range<usize>| tets.nodes[range].iter().all(|nodes| !nodes.contains(&VertexId::NONE.0));
    if !team.chunks(GRAIN, tets.len(), is_whole).into_iter().all(|is_whole| is_whole) {
        return Err(Torn);
    }
    let mut mesh = TetMesh {
        vertices: at(team, &vertices, |v| store.position(v)),
        vertex_refs: vertex_refs(team, context, &vertices, input),
        tets,
        ..TetMesh::default()
    };
    let triangles = team.collect(GRAIN, store.tet_bound(), |range, found| {
        store.live_tets_in(range).for_each(|t| triangles_of(store, t, refs, &renumber, found));
    });
    mesh.triangles.nodes = triangles.iter().map(|triangle| triangle.nodes).collect();
    mesh.triangles.refs = triangles.iter().map(|triangle| refs.faces[triangle.face as usize]).collect();
    let crossings = crossings(team, &mesh.vertices, &triangles);
    let mut classification = Classification {
        entities: at(team, &vertices, |v| store.entity(v)),
        parameters: at(team, &vertices, |v| store.parameters(v)),
        projected: at(team, &vertices, |v| store.position(v)),
        ridges: ridges(team, store, renumber),
        faces: triangles.iter().map(|triangle| triangle.face).collect(),
    };
    debug_assert!(classification.ridges.iter().all(|&(_, edge)| (edge as usize) < refs.edges.len()));
    for &(nodes, edge) in &classification.ridges {
        mesh.edges.push(nodes, refs.edges[edge as usize]);
    }
    let is_there = |v: VertexId| v.is_some() && store.is_vertex(v);
    Required::list(input, &mut mesh, |v| Some(context.ids[v as usize]).filter(|&v| is_there(v)).map(renumber));
    let mut off_model: Vec<u32> = unprojected.iter().filter(|v| store.is_vertex(**v)).map(|v| renumber(*v)).collect();
    off_model.sort_unstable();
    settle(&mut classification, &off_model, context.model);
    let held = context.required.frozen().filter(|&v| store.dimension(v) < 3).map(renumber);
    let mut held: Vec<u32> = held.collect();
    held.sort_unstable();
    let metrics = at(team, &vertices, |v| store.metric(v));
    Ok(Extracted { mesh, classification, metrics, off_model, held, crossings, part: None })
}

/// Sets the projected places of the vertices without room on the model to their closest points there, so that the next
/// run tries again.
fn settle(place: &mut Classification, off_model: &[u32], model: &Model) {
    let mut evaluator = model.evaluator();
    for v in off_model.iter().map(|&v| v as usize) {
        let (point, parameters) = (place.projected[v], &mut place.parameters[v]);
        match place.entities[v] {
            Entity::Edge(edge) => {
                let on = evaluator.closest_on_edge(edge, point, Some(parameters[0]));
                (place.projected[v], *parameters) = (on.point, [on.t, 0.0]);
            }
            Entity::Face(face) => {
                let on = evaluator.closest_on_face(face, point, Some(*parameters));
                (place.projected[v], *parameters) = (on.point, on.uv);
            }
            Entity::Vertex(corner) => place.projected[v] = model.topology().vertices[corner as usize].point,
            Entity::Interior => {}
        }
    }
}

/// Where the boundary passes through itself, by the numbers of the triangles.
fn crossings(team: Team<'_>, vertices: &[Vec3], triangles: &[Triangle]) -> Crossings {
    let boundary = triangles.iter().zip(0..).filter_map(|(triangle, i)| Some((triangle.outward?, i)));
    let (nodes, numbers): (Vec<[u32; 3]>, Vec<usize>) = boundary.unzip();
    let mut found = crossing::crossings(team, &nodes, |v| vertices[v as usize], TOLD);
    for told in &mut found.first {
        told.triangles = told.triangles.map(|i| numbers[i]);
    }
    found
}

/// A value for each vertex.
fn at<T: Copy + Send>(team: Team<'_>, vertices: &[u32], of: impl Fn(VertexId) -> T + Sync) -> Vec<T> {
    team.map(GRAIN, vertices.len(), |i| of(VertexId(vertices[i])))
}

/// References that the vertices had in the input, for corners and frozen vertices. The id of any other may have been used again for a new
/// vertex.
fn vertex_refs(team: Team<'_>, context: &Context, vertices: &[u32], input: &TetMesh) -> Vec<i32> {
    let is_old = |v: VertexId| matches!(context.store.entity(v), Entity::Vertex(_)) || context.is_frozen(v);
    let is_there = |v: VertexId| v.is_some() && context.store.is_vertex(v);
    let known = team.collect(GRAIN, context.ids.len(), |range, known| {
        let old = range.map(|v| (context.ids[v], input.vertex_refs[v]));
        known.extend(old.filter(|&(id, reference)| reference != 0 && is_there(id) && is_old(id)));
    });
    let known: HashMap<VertexId, i32> = known.into_iter().collect();
    if known.is_empty() {
        return vec![0; vertices.len()];
    }
    at(team, vertices, |v| if is_old(v) { known.get(&v).copied().unwrap_or(0) } else { 0 })
}

fn tets(team: Team<'_>, store: &Store, number: &(impl Fn(VertexId) -> u32 + Sync)) -> Elements<4> {
    let live = team.collect(GRAIN, store.tet_bound(), |range, live| live.extend(store.live_tets_in(range)));
    Elements {
        nodes: team.map(GRAIN, live.len(), |i| store.vertices(live[i]).map(number)),
        refs: team.map(GRAIN, live.len(), |i| store.region(live[i]) as i32),
    }
}

/// The triangles of a tetrahedron with their faces of the model. Between two regions a triangle belongs to the lesser one.
fn triangles_of(
    store: &Store,
    t: TetId,
    refs: &References,
    number: &impl Fn(VertexId) -> u32,
    found: &mut Vec<Triangle>,
) {
    let tags = store.tags(t);
    if tags == [0; 4] {
        return;
    }
    let (v, n) = (store.vertices(t), store.neighbours(t));
    let region = |t: TetId| (store.region(t) as i32, t);
    for i in (0..4).filter(|&i| tags[i] != 0 && (!n[i].is_some() || region(t) < region(n[i]))) {
        let [a, b, c] = FACE[i].map(|k| number(v[k]));
        let face = tags[i] - 1;
        let nodes = if refs.inward[face as usize] { [a, b, c] } else { [a, c, b] };
        found.push(Triangle { nodes, face, outward: (!n[i].is_some()).then_some([a, c, b]) });
    }
}

/// Each ridge edge once with its model edge, in the order of its lower vertex.
fn ridges(team: Team<'_>, store: &Store, number: impl Fn(VertexId) -> u32 + Sync) -> Vec<([u32; 2], u32)> {
    team.collect(GRAIN, store.vertex_bound(), |range, edges| {
        for v in store.live_vertices_in(range) {
            match store.entity(v) {
                Entity::Edge(curve) => {
                    for other in store.ridge(v).into_iter().filter(|w| w.is_some()) {
                        if store.dimension(other) == 0 || v < other {
                            edges.push(([number(v), number(other)], curve));
                        }
                    }
                }
                Entity::Vertex(_) => {
                    for (other, curve) in store.corner_ridges(v) {
                        if store.dimension(other) == 0 && v < other {
                            edges.push(([number(v), number(other)], curve));
                        }
                    }
                }
                _ => {}
            }
        }
    })
}
