//! Which entities of a model touch: they share a vertex or an edge. Where solids touch without a common face, each has its own edge or vertex there
//! (cpp/separate). These lie on each other and count as one.
use super::twins::Twins;
use crate::geometry::{Entity, Geometry, Model, Topology};

/// Entities and their vertices.
pub struct Touch<'a> {
    topology: &'a Topology,
    twins: Twins,
    /// First twins of the vertices of each face, sorted.
    vertices: Vec<Vec<u32>>,
    /// Faces at each vertex that is a first twin, sorted.
    faces: Vec<Vec<u32>>,
    /// Faces beside each edge that is a first twin.
    beside: Vec<Vec<u32>>,
}

impl<'a> Touch<'a> {
    /// Of a model. Vertices and edges within `tolerance` of each other count as one.
    pub fn new(model: &'a Model, tolerance: f64) -> Self {
        let topology = model.topology();
        let twins = Twins::new(model, tolerance);
        let mut faces = vec![Vec::new(); topology.vertices.len()];
        let mut beside = vec![Vec::new(); topology.edges.len()];
        let mut vertices = Vec::with_capacity(topology.faces.len());
        for (face, entity) in (0..).zip(&topology.faces) {
            let ends = |&edge: &u32| twins.ends(topology, edge);
            let mut own: Vec<u32> = entity.edges.iter().flat_map(ends).collect();
            own.sort_unstable();
            own.dedup();
            own.iter().for_each(|&vertex| faces[vertex as usize].push(face));
            vertices.push(own);
        }
        for (edge, entity) in topology.edges.iter().enumerate() {
            beside[twins.edges[edge] as usize].extend(&entity.faces);
        }
        Self { topology, twins, vertices, faces, beside }
    }

    /// Whether two entities share a vertex or an edge, or one lies on the other; an entity touches itself.
    pub fn touches(&self, a: Entity, b: Entity) -> bool {
        use Entity::{Edge, Face, Vertex};
        let Twins { edges, vertices } = &self.twins;
        let has = |edge: u32, vertex: u32| self.ends(edge).any(|end| end == vertices[vertex as usize]);
        match (a, b) {
            (Vertex(v), Vertex(w)) => vertices[v as usize] == vertices[w as usize],
            (Vertex(v), Edge(e)) | (Edge(e), Vertex(v)) => has(e, v),
            (Vertex(v), Face(f)) | (Face(f), Vertex(v)) => self.is_on(vertices[v as usize], f),
            (Edge(e), Edge(f)) => {
                edges[e as usize] == edges[f as usize] || self.ends(e).any(|v| self.ends(f).any(|w| v == w))
            }
            (Edge(e), Face(f)) | (Face(f), Edge(e)) => {
                self.beside(e).contains(&f) || self.ends(e).any(|v| self.is_on(v, f))
            }
            (Face(f), Face(g)) => {
                f == g
                    || self.vertices[f as usize].iter().any(|&v| self.is_on(v, g))
                    || self.topology.faces[f as usize].edges.iter().any(|&e| self.beside(e).contains(&g))
            }
            (Entity::Interior, _) | (_, Entity::Interior) => true,
        }
    }

    /// Whether an edge or a vertex and another edge have a face in common.
    pub fn share_face(&self, a: Entity, edge: u32) -> bool {
        let Some(beside) = self.twins.edges.get(edge as usize).map(|&edge| &self.beside[edge as usize]) else {
            return false;
        };
        match a {
            Entity::Edge(e) => self.beside(e).iter().any(|face| beside.contains(face)),
            Entity::Vertex(v) => {
                self.faces[self.twins.vertices[v as usize] as usize].iter().any(|face| beside.contains(face))
            }
            Entity::Face(f) => beside.contains(&f),
            Entity::Interior => false,
        }
    }

    /// Whether a vertex that is a first twin is one of the face.
    fn is_on(&self, vertex: u32, face: u32) -> bool {
        self.faces[vertex as usize].binary_search(&face).is_ok()
    }

    fn beside(&self, edge: u32) -> &[u32] {
        &self.beside[self.twins.edges[edge as usize] as usize]
    }

    fn ends(&self, edge: u32) -> impl Iterator<Item = u32> + '_ {
        self.twins.ends(self.topology, edge)
    }
}
