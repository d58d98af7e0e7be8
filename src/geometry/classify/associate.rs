//! Writing a classification into a mesh.
use super::Classification;
use crate::geometry::Entity;
use crate::mesh::{Association, OnEdge, OnFace, OnVertex, TetMesh};
use std::collections::{HashMap, HashSet};

/// What changed besides the association.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Associated {
    /// Whether the triangles' references were replaced by the numbers of the faces, since one reference stood for several faces or several
    /// references for one.
    pub references_replaced: bool,
    /// How many listed edges were dropped, since they lie on no edge of the model.
    pub edges_dropped: usize,
}

/// Writes a classification into its mesh, numbers from 1: the association of each vertex with its entity of lowest
/// dimension; `edges` are the mesh edges on model edges, all of them ridges; `corners` are the vertices on
/// model vertices. Triangles and listed edges keep their references where each stands for one face or edge, else they get
/// its number. Required edges stay, also where they lie on no edge of the
/// model: these come last, with their old references.
pub fn associate(mesh: &mut TetMesh, classification: &Classification) -> Associated {
    write_vertices(mesh, classification);
    let edges_dropped = write_edges(mesh, classification);
    let references_replaced = !keeps_references(mesh, classification);
    if references_replaced {
        mesh.triangles.refs = classification.faces.iter().map(|&face| face as i32 + 1).collect();
    }
    Associated { references_replaced, edges_dropped }
}

/// Whether the references of the triangles stand for one face each, so that [`associate`] keeps them.
pub fn keeps_references(mesh: &TetMesh, classification: &Classification) -> bool {
    is_one_to_one(&mesh.triangles.refs, &classification.faces)
}

fn write_vertices(mesh: &mut TetMesh, classification: &Classification) {
    mesh.association = Association::default();
    mesh.corners.clear();
    for (v, (entity, &[first, second])) in classification.entities.iter().zip(&classification.parameters).enumerate() {
        let vertex = v as u32;
        match *entity {
            Entity::Vertex(i) => {
                mesh.association.vertices.push(OnVertex { vertex, id: i as i32 + 1 });
                mesh.corners.push(vertex);
            }
            Entity::Edge(i) => {
                mesh.association.edges.push(OnEdge { vertex, id: i as i32 + 1, t: first, r: 0.0 });
            }
            Entity::Face(i) => {
                mesh.association.faces.push(OnFace { vertex, id: i as i32 + 1, uv: [first, second], r: 0.0 });
            }
            Entity::Interior => {}
        }
    }
}

/// Replaces the listed edges by the ridges. Returns how many of them were no ridges. Required edges stay in any case.
fn write_edges(mesh: &mut TetMesh, classification: &Classification) -> usize {
    let sorted = |nodes: [u32; 2]| [nodes[0].min(nodes[1]), nodes[0].max(nodes[1])];
    let listed: HashMap<[u32; 2], i32> = mesh.edges.iter().map(|(nodes, r)| (sorted(nodes), r)).collect();
    let ridges = classification.ridges.iter();
    let known = ridges.filter_map(|(nodes, edge)| listed.get(&sorted(*nodes)).map(|&reference| (reference, *edge)));
    let (refs, edges): (Vec<i32>, Vec<u32>) = known.unzip();
    let dropped = listed.len() - refs.len();
    let mut names: HashMap<u32, i32> = HashMap::new();
    if is_one_to_one(&refs, &edges) {
        names.extend(edges.into_iter().zip(refs));
    }
    // An edge that the file does not list gets its number, unless another edge has that as its reference.
    let all = classification.ridges.iter().map(|&(_, edge)| edge);
    let taken: HashSet<i32> = names.values().copied().collect();
    if all.clone().any(|edge| !names.contains_key(&edge) && taken.contains(&(edge as i32 + 1))) {
        names.clear();
    }
    let reference = |edge: u32| names.get(&edge).copied().unwrap_or(edge as i32 + 1);
    dropped - mesh.replace_edges(classification.ridges.iter().map(|&(nodes, edge)| (nodes, reference(edge))))
}

fn is_one_to_one(refs: &[i32], faces: &[u32]) -> bool {
    let (mut face_of, mut reference_of) = (HashMap::new(), HashMap::new());
    refs.iter().zip(faces).all(|(&reference, &face)| {
        *face_of.entry(reference).or_insert(face) == face && *reference_of.entry(face).or_insert(reference) == reference
    })
}
