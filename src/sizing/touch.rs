//! Which entities of a model touch: they share a vertex or an edge.
use crate::geometry::{Entity, Topology};

/// Entities and their vertices.
pub struct Touch<'a> {
    topology: &'a Topology,
    /// Vertices of each face, sorted.
    vertices: Vec<Vec<u32>>,
    /// Faces at each vertex, sorted.
    faces: Vec<Vec<u32>>,
}

impl<'a> Touch<'a> {
    /// Of a model.
    pub fn new(topology: &'a Topology) -> Self {
        let ends = |edge: u32| topology.edges[edge as usize].vertices.into_iter().flatten();
        let mut faces = vec![Vec::new(); topology.vertices.len()];
        let mut vertices = Vec::with_capacity(topology.faces.len());
        for (face, entity) in (0..).zip(&topology.faces) {
            let mut own: Vec<u32> = entity.edges.iter().flat_map(|&edge| ends(edge)).collect();
            own.sort_unstable();
            own.dedup();
            own.iter().for_each(|&vertex| faces[vertex as usize].push(face));
            vertices.push(own);
        }
        Self { topology, vertices, faces }
    }

    /// Whether two entities share a vertex or an edge, or one lies on the other; an entity touches itself.
    pub fn touches(&self, a: Entity, b: Entity) -> bool {
        use Entity::{Edge, Face, Vertex};
        let has = |edge: u32, vertex: u32| self.topology.edges[edge as usize].vertices.contains(&Some(vertex));
        match (a, b) {
            (Vertex(v), Vertex(w)) => v == w,
            (Vertex(v), Edge(e)) | (Edge(e), Vertex(v)) => has(e, v),
            (Vertex(v), Face(f)) | (Face(f), Vertex(v)) => self.faces[v as usize].binary_search(&f).is_ok(),
            (Edge(e), Edge(f)) => e == f || self.ends(e).any(|v| has(f, v)),
            (Edge(e), Face(f)) | (Face(f), Edge(e)) => {
                self.topology.edges[e as usize].faces.contains(&f)
                    || self.ends(e).any(|v| self.faces[v as usize].binary_search(&f).is_ok())
            }
            (Face(f), Face(g)) => {
                f == g
                    || self.vertices[f as usize].iter().any(|&v| self.faces[v as usize].binary_search(&g).is_ok())
                    || self.topology.faces[f as usize]
                        .edges
                        .iter()
                        .any(|&e| self.topology.edges[e as usize].faces.contains(&g))
            }
            (Entity::Interior, _) | (_, Entity::Interior) => true,
        }
    }

    /// Whether an edge or a vertex and another edge have a face in common.
    pub fn share_face(&self, a: Entity, edge: u32) -> bool {
        let beside = &self.topology.edges[edge as usize].faces;
        match a {
            Entity::Edge(e) => self.topology.edges[e as usize].faces.iter().any(|face| beside.contains(face)),
            Entity::Vertex(v) => self.faces[v as usize].iter().any(|face| beside.contains(face)),
            Entity::Face(f) => beside.contains(&f),
            Entity::Interior => false,
        }
    }

    fn ends(&self, edge: u32) -> impl Iterator<Item = u32> + '_ {
        self.topology.edges[edge as usize].vertices.into_iter().flatten()
    }
}
