//! What must stay: the vertices, edges and triangles that the input says, the surfaces and regions that the user freezes.
//!
//! The ends of required edges and the corners of required triangles neither move nor go, so their ids last and an edge is known by
//! them. A surface triangle stays as long as its three edges do. Nothing replaces a tetrahedron of a frozen region. All this is looked after in the functions of the core that write.
use super::access::Access;
use super::ids::{EDGE, TetId, VertexId};
use super::refusal::Refusal;
use super::worker::Worker;
use crate::mesh::TetMesh;
use std::collections::HashSet;

/// What must not change in a run, by reference.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Freeze {
    /// References of triangles.
    pub surfaces: Vec<i32>,
    /// References of tetrahedra.
    pub regions: Vec<i32>,
}

/// Vertices, edges and regions that stay.
#[derive(Default)]
pub struct Required {
    /// By vertex id; ids beyond were given out later.
    frozen: Vec<bool>,
    edges: HashSet<[VertexId; 2]>,
    /// By the store's numbers.
    regions: Vec<u32>,
}

impl Required {
    /// What a mesh requires, and what is frozen of it; its vertices have their indices as ids.
    pub fn of(mesh: &TetMesh, freeze: &Freeze) -> Self {
        let regions = freeze.regions.iter().map(|&region| region as u32).collect();
        let mut required = Self { frozen: vec![false; mesh.vertices.len()], edges: HashSet::new(), regions };
        let edges = mesh.required_edges.iter().map(|&e| mesh.edges.nodes[e as usize]);
        let triangles = mesh.required_triangles.iter().map(|&t| mesh.triangles.nodes[t as usize]);
        let surfaces = mesh.triangles.iter().filter(|(_, reference)| freeze.surfaces.contains(reference));
        let triangles = triangles.chain(surfaces.map(|(nodes, _)| nodes));
        for [a, b] in edges.chain(triangles.flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]])) {
            required.frozen[a as usize] = true;
            required.frozen[b as usize] = true;
            required.edges.insert(key(VertexId(a), VertexId(b)));
        }
        mesh.required_vertices.iter().for_each(|&v| required.frozen[v as usize] = true);
        for (nodes, _) in mesh.tets.iter().filter(|(_, region)| freeze.regions.contains(region)) {
            nodes.iter().for_each(|&v| required.frozen[v as usize] = true);
        }
        if !required.frozen.contains(&true) {
            required.frozen.clear();
        }
        required
    }

    /// The same after the vertices got new ids.
    pub fn renumber(&mut self, number: &[VertexId]) {
        let mut frozen = vec![false; if self.frozen.is_empty() { 0 } else { number.len() }];
        for (old, _) in self.frozen.iter().enumerate().filter(|&(_, &frozen)| frozen) {
            frozen[number[old].index()] = true;
        }
        self.frozen = frozen;
        self.edges = self.edges.iter().map(|&[a, b]| key(number[a.index()], number[b.index()])).collect();
    }

    /// Whether a vertex must neither move nor go.
    #[inline(always)]
    pub fn is_frozen(&self, v: VertexId) -> bool {
        self.frozen.get(v.index()).copied().unwrap_or(false)
    }

    /// The vertices that must neither move nor go.
    pub fn frozen(&self) -> impl Iterator<Item = VertexId> + '_ {
        self.frozen.iter().zip(0..).filter(|&(&frozen, _)| frozen).map(|(_, v)| VertexId(v))
    }

    /// Whether the edge is required.
    #[inline]
    pub fn has_edge(&self, a: VertexId, b: VertexId) -> bool {
        self.is_frozen(a) && self.is_frozen(b) && self.edges.contains(&key(a, b))
    }

    /// Whether nothing in the region may change.
    #[inline(always)]
    pub fn holds_region(&self, region: u32) -> bool {
        self.regions.contains(&region)
    }

    /// Lists in the adapted mesh what `input` required; `number` gives each vertex id its index there. Required edges are listed
    /// as edges with their references, alone: the ridges are added when the mesh is put back on its model.
    pub fn list(input: &TetMesh, mesh: &mut TetMesh, number: impl Fn(VertexId) -> u32) {
        let renumber = |v: u32| number(VertexId(v));
        mesh.required_vertices = input.required_vertices.iter().map(|&v| renumber(v)).collect();
        for &edge in &input.required_edges {
            let edge = edge as usize;
            mesh.required_edges.push(mesh.edges.len() as u32);
            mesh.edges.push(input.edges.nodes[edge].map(renumber), input.edges.refs[edge]);
        }
        let sorted = |mut nodes: [u32; 3]| {
            nodes.sort_unstable();
            nodes
        };
        let wanted = input.required_triangles.iter().map(|&t| sorted(input.triangles.nodes[t as usize].map(renumber)));
        let wanted: HashSet<[u32; 3]> = wanted.collect();
        let triangles = mesh.triangles.nodes.iter().zip(0..);
        mesh.required_triangles =
            triangles.filter(|(nodes, _)| wanted.contains(&sorted(**nodes))).map(|(_, t)| t).collect();
    }
}

fn key(a: VertexId, b: VertexId) -> [VertexId; 2] {
    [a.min(b), a.max(b)]
}

impl<A: Access> Worker<'_, '_, A> {
    /// Refuses to take out these tetrahedra and vertices where one is required, or in a frozen region, or the edge between two vertices is
    /// required and does not stay. Every function of the core that writes topology asks.
    ///
    /// # Errors
    /// `Geometry`.
    pub fn check_required(
        &self,
        old: &[TetId],
        dead: &[VertexId],
        stays: impl Fn(VertexId, VertexId) -> bool,
    ) -> Result<(), Refusal> {
        let required = &self.context.required;
        if required.frozen.is_empty() {
            return Ok(());
        }
        if dead.iter().any(|&v| required.is_frozen(v)) {
            return Err(Refusal::Geometry);
        }
        for &t in old {
            if required.holds_region(self.store.region(t)) {
                return Err(Refusal::Geometry);
            }
            let v = self.store.vertices(t);
            for [a, b] in EDGE.map(|ends| ends.map(|i| v[i])) {
                if required.has_edge(a, b) && !stays(a, b) {
                    return Err(Refusal::Geometry);
                }
            }
        }
        Ok(())
    }
}
