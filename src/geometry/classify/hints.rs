//! What the file itself says about the model, which counts only where the model agrees.
use super::Classification;
use crate::geometry::{Entity, Topology};
use crate::mesh::TetMesh;
use std::collections::HashMap;

/// The file's association, entries of unknown entities left out.
pub(super) struct Hints {
    /// Entities that the file lists for each vertex, with parameters.
    listed: HashMap<(u32, Entity), [f64; 2]>,
    /// For each vertex the listed entity of lowest dimension.
    lowest: HashMap<u32, Entity>,
    /// Entries of entities that the model does not have.
    unknown: usize,
}

impl Hints {
    pub fn new(mesh: &TetMesh, topology: &Topology) -> Self {
        let mut hints = Self { listed: HashMap::new(), lowest: HashMap::new(), unknown: 0 };
        let index =
            |id: i32, count: usize| usize::try_from(id).ok().filter(|&i| i >= 1 && i <= count).map(|i| i as u32 - 1);
        for on in &mesh.association.vertices {
            let entity = index(on.id, topology.vertices.len()).map(Entity::Vertex);
            hints.add(on.vertex, entity, [0.0; 2]);
        }
        for on in &mesh.association.edges {
            let entity = index(on.id, topology.edges.len()).map(Entity::Edge);
            hints.add(on.vertex, entity, [on.t, 0.0]);
        }
        for on in &mesh.association.faces {
            let entity = index(on.id, topology.faces.len()).map(Entity::Face);
            hints.add(on.vertex, entity, on.uv);
        }
        hints
    }

    fn add(&mut self, vertex: u32, entity: Option<Entity>, parameters: [f64; 2]) {
        let Some(entity) = entity else {
            self.unknown += 1;
            return;
        };
        let parameters = if parameters.iter().all(|x| x.is_finite()) { parameters } else { [0.0; 2] };
        self.listed.insert((vertex, entity), parameters);
        let lowest = self.lowest.entry(vertex).or_insert(entity);
        *lowest = entity.min(*lowest);
    }

    /// Parameters that the file gives a vertex on an entity.
    pub fn parameters(&self, vertex: u32, entity: Entity) -> Option<[f64; 2]> {
        self.listed.get(&(vertex, entity)).copied()
    }

    /// The face that the file lists for most of the vertices.
    pub fn face_of(&self, vertices: impl Iterator<Item = u32>) -> Option<u32> {
        let mut votes: HashMap<u32, usize> = HashMap::new();
        for vertex in vertices {
            if let Some(Entity::Face(face)) = self.lowest.get(&vertex) {
                *votes.entry(*face).or_default() += 1;
            }
        }
        votes.into_iter().max_by_key(|&(face, n)| (n, std::cmp::Reverse(face))).map(|(face, _)| face)
    }

    /// Whether the file lists one of the vertices inside this face.
    pub fn has_inside(&self, face: u32, mut vertices: impl Iterator<Item = u32>) -> bool {
        vertices.any(|vertex| self.lowest.get(&vertex) == Some(&Entity::Face(face)))
    }

    /// Lines about entries that do not hold.
    pub fn notices(&self, result: &Classification) -> Vec<String> {
        let mut notices = Vec::new();
        if self.unknown > 0 {
            notices.push(format!(
                "{} entries of the file's association name entities that the model does not have",
                self.unknown
            ));
        }
        let mut wrong: Vec<(u32, Entity)> =
            self.lowest.iter().map(|(&v, &e)| (v, e)).filter(|&(v, e)| result.entities[v as usize] != e).collect();
        wrong.sort_unstable();
        if let Some(&(vertex, entity)) = wrong.first() {
            notices.push(format!(
                "the file's association does not hold for {} of {} vertices, which were classified by geometry instead: vertex {} is \
                 listed on {} but lies on {}",
                wrong.len(),
                self.lowest.len(),
                vertex + 1,
                entity,
                result.entities[vertex as usize]
            ));
        }
        notices
    }
}
