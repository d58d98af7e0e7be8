//! What must stay: the vertices, edges and triangles that the input requires, the surfaces and regions that the user freezes.
//!
//! The ends of required edges and the corners of required triangles neither move nor go, so their ids last, and an edge is known by
//! these ids. A surface triangle stays as long as its three edges do. Nothing replaces a tetrahedron of a frozen region. The functions of the
//! core that take tetrahedra out of the store ask [`Required::check`] first, those that move a vertex [`Required::check_move`].
//!
//! A vertex that must not move keeps its coordinates to the bit, even where it lies a little off the model: another mesh may share it.
use super::ids::{EDGE, TetId, VertexId};
use super::refusal::Refusal;
use super::store::Store;
use crate::geometry::classify::Classification;
use crate::mesh::TetMesh;
use std::borrow::Cow;
use std::collections::HashSet;

/// What must not change in a run, by reference.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Freeze {
    /// References of triangles.
    pub surfaces: Vec<i32>,
    /// References of tetrahedra.
    pub regions: Vec<i32>,
}

/// The vertices of a mesh that must neither move nor go, ascending: those that it requires, and of what is frozen. It may be the boundary of a
/// mesh alone, without tetrahedra.
pub fn held_vertices(mesh: &TetMesh, freeze: &Freeze) -> Vec<u32> {
    Required::listed(mesh, freeze).frozen().map(|v| v.0).collect()
}

/// Vertices, edges and regions that stay.
#[derive(Default)]
pub struct Required {
    /// By vertex id. Ids beyond the end are those of new vertices.
    frozen: Vec<bool>,
    edges: HashSet<[VertexId; 2]>,
    /// By the store's numbers.
    regions: Vec<u32>,
    /// Whether the mesh is a part of a larger one, with faces to other parts.
    is_part: bool,
}

impl Required {
    /// What a mesh requires, and what is frozen of it; its vertices have their indices as ids. Vertices of no tetrahedron do not count:
    /// they do not last.
    pub fn of(mesh: &TetMesh, freeze: &Freeze) -> Self {
        let mut required = Self::listed(mesh, freeze);
        if required.frozen.contains(&true) {
            required.forget_unused(&mesh.tets.nodes);
        }
        if !required.frozen.contains(&true) {
            required.frozen.clear();
        }
        required
    }

    /// The same with vertices of no tetrahedron.
    fn listed(mesh: &TetMesh, freeze: &Freeze) -> Self {
        let regions = freeze.regions.iter().map(|&region| region as u32).collect();
        let mut required =
            Self { frozen: vec![false; mesh.vertices.len()], edges: HashSet::new(), regions, is_part: false };
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
        required
    }

    /// Holds vertices, and the edges of triangles of held vertices, of a part that has so many vertices.
    pub fn hold(&mut self, vertices: usize, held: &[u32], triangles: impl Iterator<Item = [u32; 3]>) {
        self.is_part = !held.is_empty();
        self.frozen.resize(vertices, false);
        held.iter().for_each(|&v| self.frozen[v as usize] = true);
        for [a, b] in triangles.flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]) {
            self.edges.insert(key(VertexId(a), VertexId(b)));
        }
    }

    /// Forgets vertices that no tetrahedron has, and their edges.
    fn forget_unused(&mut self, tets: &[[u32; 4]]) {
        let mut hangs = self.frozen.clone();
        tets.iter().flatten().for_each(|&v| hangs[v as usize] = false);
        self.frozen.iter_mut().zip(&hangs).for_each(|(frozen, hangs)| *frozen &= !hangs);
        self.edges.retain(|edge| !edge.iter().any(|v| hangs[v.index()]));
    }

    /// The classification of a mesh whose vertices have their indices as ids, changed so that the projected place of a vertex that must not
    /// move is where it is, even off the model.
    pub fn held<'p>(&self, mesh: &TetMesh, place: &'p Classification) -> Cow<'p, Classification> {
        let mut place = Cow::Borrowed(place);
        for v in self.frozen().map(VertexId::index) {
            place.to_mut().projected[v] = mesh.vertices[v];
        }
        place
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

    /// Whether the mesh is a part of a larger one, with faces to other parts. Then another part may have, or make, the same faces of vertices
    /// that must not move.
    #[inline(always)]
    pub fn is_part(&self) -> bool {
        self.is_part
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

    /// Refuses to remove these tetrahedra and vertices if one of the vertices must stay, a tetrahedron is in a frozen region, or a
    /// required edge would go with them. `stays` tells whether an edge is still there afterwards.
    #[inline]
    pub fn check(
        &self,
        store: &Store,
        tets: &[TetId],
        vertices: &[VertexId],
        stays: impl Fn(VertexId, VertexId) -> bool,
    ) -> Result<(), Refusal> {
        if self.frozen.is_empty() || self.allows(store, tets, vertices, stays) {
            return Ok(());
        }
        Err(Refusal::Geometry)
    }

    fn allows(
        &self,
        store: &Store,
        tets: &[TetId],
        vertices: &[VertexId],
        stays: impl Fn(VertexId, VertexId) -> bool,
    ) -> bool {
        let may_go = |&t: &TetId| {
            let v = store.vertices(t);
            !self.regions.contains(&store.region(t))
                && EDGE.iter().all(|&[i, j]| !self.has_edge(v[i], v[j]) || stays(v[i], v[j]))
        };
        !vertices.iter().any(|&v| self.is_frozen(v)) && tets.iter().all(may_go)
    }

    /// Refuses to move a vertex that must not move.
    #[inline(always)]
    pub fn check_move(&self, v: VertexId) -> Result<(), Refusal> {
        if self.is_frozen(v) { Err(Refusal::Geometry) } else { Ok(()) }
    }

    /// Lists in the adapted mesh what `input` required. `number` gives the index of a vertex of the input that is still there. Of the edges
    /// only the required ones are listed, with their references: ridges are added when the mesh is put back on its model.
    pub fn list(input: &TetMesh, mesh: &mut TetMesh, number: impl Fn(u32) -> Option<u32>) {
        mesh.required_vertices = input.required_vertices.iter().filter_map(|&v| number(v)).collect();
        for &edge in &input.required_edges {
            let edge = edge as usize;
            if let Some(nodes) = all(input.edges.nodes[edge].map(&number)) {
                mesh.required_edges.push(mesh.edges.len() as u32);
                mesh.edges.push(nodes, input.edges.refs[edge]);
            }
        }
        let sorted = |mut nodes: [u32; 3]| {
            nodes.sort_unstable();
            nodes
        };
        let wanted =
            input.required_triangles.iter().filter_map(|&t| all(input.triangles.nodes[t as usize].map(&number)));
        let wanted: HashSet<[u32; 3]> = wanted.map(sorted).collect();
        let triangles = mesh.triangles.nodes.iter().zip(0..);
        mesh.required_triangles =
            triangles.filter(|(nodes, _)| wanted.contains(&sorted(**nodes))).map(|(_, t)| t).collect();
    }
}

/// All of the numbers, if none is missing.
fn all<const N: usize>(numbers: [Option<u32>; N]) -> Option<[u32; N]> {
    numbers.iter().all(Option::is_some).then(|| numbers.map(Option::unwrap_or_default))
}

fn key(a: VertexId, b: VertexId) -> [VertexId; 2] {
    [a.min(b), a.max(b)]
}
