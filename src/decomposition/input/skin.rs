//! The boundary of a mesh on its model, and what a slice of the tetrahedra has of it.
use super::super::Error;
use super::super::manifold::open_faces;
use super::super::piece::{Piece, SHARED};
use super::super::split::keep_ridges_of_tets;
use super::{Input, Vertices};
use crate::adapt::References;
use crate::geometry::classify::Classification;
use crate::geometry::discrete::outward_triangles;
use crate::geometry::{Entity, Model};
use crate::mesh::TetMesh;
use crate::mesh::adjacency::{MatchedFaces, Side, TriangleIndex};
use crate::mesh::ranges::renumbered;
use crate::mesh::vector::Vec3;
use crate::metric::{Rise, Sym3};
use crate::sizing::rises;
use crate::tasks::Team;
use std::ops::Range;

/// No number.
const NONE: u32 = u32::MAX;

/// The boundary of a mesh on its model, with the faces between regions, and all that is listed of vertices, edges and triangles.
pub struct Skin<'a> {
    /// A mesh that has all of it, with the tetrahedra at it.
    mesh: &'a TetMesh,
    place: &'a Classification,
    /// The numbers of its vertices in the whole mesh, ascending; none where it is the whole mesh.
    numbers: Option<&'a [u32]>,
    /// Its triangles, which look outwards, between regions out of the lesser one.
    outwards: Vec<[u32; 3]>,
    /// The triangles as faces of tetrahedra, in the order of these in the whole mesh.
    sides: Vec<Side>,
    /// For each triangle the first and the last tetrahedron that has it.
    ends: Vec<[u32; 2]>,
}

impl<'a> Skin<'a> {
    /// Of a whole mesh in memory.
    pub fn of(team: Team<'_>, mesh: &'a TetMesh, place: &'a Classification) -> Self {
        let index = TriangleIndex::new(team, &mesh.triangles.nodes, mesh.vertices.len());
        Self::new(team, (mesh, place), None, index.sides(team, &mesh.tets.nodes))
    }

    /// Of a part of the mesh that has all triangles and all tetrahedra at them; with the numbers of its vertices in the whole mesh, and
    /// the triangles as faces of the tetrahedra of the whole mesh, in their order.
    pub(super) fn new(
        team: Team<'_>,
        (mesh, place): (&'a TetMesh, &'a Classification),
        numbers: Option<&'a [u32]>,
        sides: Vec<Side>,
    ) -> Self {
        let mut ends = vec![[NONE; 2]; mesh.triangles.len()];
        for &Side { triangle, tet, .. } in &sides {
            let [first, last] = &mut ends[triangle as usize];
            *last = tet;
            if *first == NONE {
                *first = tet;
            }
        }
        Self { mesh, place, numbers, outwards: outward_triangles(team, mesh), sides, ends }
    }

    /// The references of the model's faces and edges.
    pub fn references(&self, team: Team<'_>, model: &Model) -> References {
        References::of(team, self.mesh, self.place, model)
    }

    /// The piece of a slice of the tetrahedra.
    pub fn piece(&self, input: &dyn Input, range: Range<usize>) -> Result<Piece, Error> {
        let is_whole = range.len() == input.size()[1];
        let mut tets = input.tets(range.clone())?;
        let numbers = renumbered(&mut [tets.nodes.as_flattened_mut()]);
        let Vertices { points, refs, logs } = input.vertices(&numbers)?;
        let here = self.here(&numbers);
        let mut piece = Piece { ids: numbers.iter().map(|&v| u64::from(v)).collect(), logs, ..Piece::default() };
        piece.mesh.vertex_refs = refs;
        piece.mesh.tets = tets;
        piece.marks = vec![0; numbers.len()];
        self.put_on_model(&mut piece, points, &here);
        let sides = self.sides_in(&range);
        self.put_triangles(&mut piece, sides, &range, &here);
        if !is_whole {
            mark_shared(&mut piece, sides, range.start);
        }
        self.put_lines(&mut piece, &here);
        if !is_whole {
            keep_ridges_of_tets(&mut piece);
        }
        Ok(piece)
    }

    /// The edges whose middles are away from the model, between vertices of a list: `numbers` are theirs in the whole mesh, ascending, `logs` is ln M at
    /// each. The nodes of the edges are places in that list.
    pub fn rises(&self, team: Team<'_>, (numbers, logs): (&[u32], &[Sym3]), model: &Model) -> Vec<Rise> {
        let here = self.here(numbers);
        let own: Vec<Sym3> = here.iter().map(|&v| logs.get(v as usize).copied().unwrap_or(Sym3::ZERO)).collect();
        let boundary = (&self.mesh.vertices[..], &self.mesh.triangles.nodes[..]);
        let rises = rises(team, boundary, (self.place, model), &own).into_iter();
        let rises = rises.map(|(nodes, rise)| (nodes.map(|v| here[v as usize]), rise));
        rises.filter(|(nodes, _)| !nodes.contains(&NONE)).collect()
    }

    /// For each vertex of the skin its number among these of the whole mesh, ascending, or none.
    fn here(&self, numbers: &[u32]) -> Vec<u32> {
        let mut next = 0;
        (0..self.mesh.vertices.len())
            .map(|v| {
                let whole = self.numbers.map_or(v as u32, |numbers| numbers[v]);
                while numbers.get(next).is_some_and(|&number| number < whole) {
                    next += 1;
                }
                if numbers.get(next) == Some(&whole) { next as u32 } else { NONE }
            })
            .collect()
    }

    fn put_on_model(&self, piece: &mut Piece, points: Vec<Vec3>, here: &[u32]) {
        let place = &mut piece.place;
        place.entities = vec![Entity::Interior; points.len()];
        place.parameters = vec![[0.0; 2]; points.len()];
        place.projected.clone_from(&points);
        piece.mesh.vertices = points;
        for (v, &at) in here.iter().enumerate().filter(|(_, at)| **at != NONE) {
            let at = at as usize;
            place.entities[at] = self.place.entities[v];
            place.parameters[at] = self.place.parameters[v];
            place.projected[at] = self.place.projected[v];
        }
    }

    /// The sides of the tetrahedra of a range.
    fn sides_in(&self, range: &Range<usize>) -> &[Side] {
        let first = |tet: usize| self.sides.partition_point(|side| (side.tet as usize) < tet);
        &self.sides[first(range.start)..first(range.end)]
    }

    fn put_triangles(&self, piece: &mut Piece, sides: &[Side], range: &Range<usize>, here: &[u32]) {
        let from = &self.mesh.triangles;
        let mut is_required = vec![false; from.len()];
        self.mesh.required_triangles.iter().for_each(|&t| is_required[t as usize] = true);
        let mut triangles: Vec<u32> = sides.iter().map(|side| side.triangle).collect();
        triangles.sort_unstable();
        triangles.dedup();
        for t in triangles.into_iter().map(|t| t as usize) {
            if is_required[t] {
                piece.mesh.required_triangles.push(piece.mesh.triangles.len() as u32);
            }
            piece.mesh.triangles.push(self.outwards[t].map(|v| here[v as usize]), from.refs[t]);
            piece.place.faces.push(self.place.faces[t]);
            piece.halves.push(self.ends[t].iter().any(|&tet| !range.contains(&(tet as usize))));
        }
    }

    /// Required vertices and edges, and ridges.
    fn put_lines(&self, piece: &mut Piece, here: &[u32]) {
        let numbered = |nodes: [u32; 2]| {
            let nodes = nodes.map(|v| here[v as usize]);
            (!nodes.contains(&NONE)).then_some(nodes)
        };
        let required = self.mesh.required_vertices.iter().map(|&v| here[v as usize]);
        piece.mesh.required_vertices = required.filter(|&v| v != NONE).collect();
        for &e in &self.mesh.required_edges {
            if let Some(nodes) = numbered(self.mesh.edges.nodes[e as usize]) {
                piece.mesh.required_edges.push(piece.mesh.edges.len() as u32);
                piece.mesh.edges.push(nodes, self.mesh.edges.refs[e as usize]);
            }
        }
        let ridges = self.place.ridges.iter().filter_map(|&(nodes, curve)| Some((numbered(nodes)?, curve)));
        piece.place.ridges = ridges.collect();
    }
}

/// Marks the vertices that other slices may have: those of faces with one tetrahedron here, and all on triangles, since a mesh may hang together
/// there in vertices alone.
fn mark_shared(piece: &mut Piece, sides: &[Side], first: usize) {
    let tets = &piece.mesh.tets.nodes;
    let mut has_triangle = vec![0u8; tets.len()];
    sides.iter().for_each(|side| has_triangle[side.tet as usize - first] |= 1 << side.face);
    let faces = MatchedFaces::of(Team::alone(), tets);
    let open = open_faces(tets, &faces.neighbours, |t, i| has_triangle[t] & (1 << i) != 0);
    let marks = &mut piece.marks;
    open.chain(piece.mesh.triangles.nodes.iter().copied()).flatten().for_each(|v| marks[v as usize] |= SHARED);
}
