//! Which entities lie on the same body: a connected part of the mesh.
use crate::geometry::classify::Classification;
use crate::geometry::{Entity, Topology};
use crate::mesh::TetMesh;
use crate::mesh::disjoint_sets::DisjointSets;

/// The bodies of a mesh, by the entities of its model.
pub struct Bodies<'a> {
    topology: &'a Topology,
    /// For each face a vertex that stands for its body; none where the mesh has no triangles of the face.
    of_face: Vec<Option<u32>>,
}

impl<'a> Bodies<'a> {
    /// Of a mesh. A mesh of triangles alone is one body: what lies between its surfaces is not known.
    pub fn new(topology: &'a Topology, mesh: &TetMesh, place: &Classification) -> Self {
        let mut of_face = vec![None; topology.faces.len()];
        if !mesh.tets.nodes.is_empty() {
            let mut parts = DisjointSets::new(mesh.vertices.len());
            for &[a, b, c, d] in &mesh.tets.nodes {
                [b, c, d].into_iter().for_each(|other| parts.join(a, other));
            }
            for (nodes, &face) in mesh.triangles.nodes.iter().zip(&place.faces) {
                let body = &mut of_face[face as usize];
                if body.is_none() {
                    *body = Some(parts.first(nodes[0]));
                }
            }
        }
        Self { topology, of_face }
    }

    /// Whether two entities lie on different bodies: then nothing is meshed between them.
    pub fn are_apart(&self, a: Entity, b: Entity) -> bool {
        matches!((self.of(a), self.of(b)), (Some(a), Some(b)) if a != b)
    }

    fn of(&self, entity: Entity) -> Option<u32> {
        let of_edge = |edge: u32| self.topology.edges[edge as usize].faces.first().copied();
        let face = match entity {
            Entity::Face(face) => Some(face),
            Entity::Edge(edge) => of_edge(edge),
            Entity::Vertex(vertex) => {
                self.topology.vertices[vertex as usize].edges.first().and_then(|&edge| of_edge(edge))
            }
            Entity::Interior => None,
        };
        face.and_then(|face| self.of_face[face as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Discrete, Geometry};
    use crate::mesh::samples::cube;
    use crate::tasks::Team;

    #[test]
    fn two_cubes_are_apart_and_one_is_not() {
        let mut mesh = cube(2);
        let count = mesh.vertices.len() as u32;
        let other = cube(2);
        mesh.vertices.extend(other.vertices.iter().map(|p| [p[0] + 3.0, p[1], p[2]]));
        mesh.vertex_refs.extend(&other.vertex_refs);
        other.tets.iter().for_each(|(nodes, reference)| mesh.tets.push(nodes.map(|v| v + count), reference));
        other
            .triangles
            .iter()
            .for_each(|(nodes, reference)| mesh.triangles.push(nodes.map(|v| v + count), reference + 6));
        let (model, place) = Discrete::from_mesh(Team::alone(), &mesh, 30.0).unwrap();
        let topology = model.topology();
        let is_first = |face: u32| {
            let triangle = place.faces.iter().position(|&f| f == face).unwrap();
            mesh.triangles.nodes[triangle][0] < count
        };
        let bodies = Bodies::new(topology, &mesh, &place);
        let faces = topology.faces.len() as u32;
        assert_eq!(faces, 12);
        for (a, b) in (0..faces).flat_map(|a| (0..faces).map(move |b| (a, b))) {
            assert_eq!(bodies.are_apart(Entity::Face(a), Entity::Face(b)), is_first(a) != is_first(b));
            let edge = topology.faces[a as usize].edges[0];
            assert_eq!(bodies.are_apart(Entity::Edge(edge), Entity::Face(b)), is_first(a) != is_first(b));
        }
        mesh.tets = Default::default();
        let bodies = Bodies::new(topology, &mesh, &place);
        assert!(!bodies.are_apart(Entity::Face(0), Entity::Face(11)), "triangles alone");
    }
}
