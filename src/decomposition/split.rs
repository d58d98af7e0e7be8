//! From a piece to smaller ones.
use super::piece::{Piece, SHARED, WAITING};
use crate::geometry::Entity;
use crate::mesh::adjacency::{EDGES, FACES, TriangleIndex, sorted2, sorted3};
use crate::tasks::{Rows, Team};

/// A vertex of several owners.
const SEVERAL: u32 = u32::MAX - 1;

/// A vertex without a number in the present piece, or without an owner.
const NONE: u32 = u32::MAX;

/// Gives each tetrahedron to its owner, of `owners`: the pieces in the order of their owners, some of them empty. Vertices that come to
/// several are marked as shared. `is_cut` tells whether the face between two tetrahedra of different owners is a cut: its vertices wait then.
pub fn split(piece: &Piece, owner: &[u32], owners: usize, is_cut: impl Fn(usize, usize) -> bool) -> Vec<Piece> {
    let mut marks = piece.marks.clone();
    let mut of_vertex = vec![NONE; marks.len()];
    for (nodes, &owner) in piece.mesh.tets.nodes.iter().zip(owner) {
        for &v in nodes {
            let known = &mut of_vertex[v as usize];
            *known = if *known == NONE || *known == owner { owner } else { SEVERAL };
        }
    }
    marks.iter_mut().zip(&of_vertex).filter(|(_, owner)| **owner == SEVERAL).for_each(|(mark, _)| *mark |= SHARED);
    let tets = Rows::by_key::<1>(Team::alone(), owners, owner.len(), |t| [owner[t]]);
    let triangles = triangles_of(piece, owner, owners);
    let cuts = cuts_of(piece, owner, owners, &of_vertex, is_cut);
    cuts.iter().flatten().flatten().for_each(|&v| marks[v as usize] |= WAITING);
    let mut number = vec![NONE; marks.len()];
    let cut = Cut::new(piece, &marks, &of_vertex);
    (0..owners).map(|own| cut.take(tets.row(own), &triangles[own], &cuts[own], &mut number)).collect()
}

/// Of a piece some vertices, among them all that lie on lines and triangles, with these and without tetrahedra.
pub fn split_vertices(piece: &Piece, wanted: &[bool]) -> Piece {
    let vertices: Vec<u32> = (0..).zip(wanted).filter(|(_, wanted)| **wanted).map(|(v, _)| v).collect();
    let mut number = vec![NONE; piece.ids.len()];
    vertices.iter().zip(0..).for_each(|(&v, new)| number[v as usize] = new);
    let cut = Cut::new(piece, &piece.marks, &[]);
    let triangles: Vec<(u32, bool)> = (0..).zip(piece.halves.iter().copied()).collect();
    let mut part = Piece::default();
    cut.take_vertices(&mut part, &vertices);
    cut.take_triangles(&mut part, &triangles, &number);
    cut.take_lines(&mut part, &number);
    part
}

/// The tetrahedra of these numbers with their vertices, and nothing else of the piece.
pub fn split_tets(piece: &Piece, tets: &[u32]) -> Piece {
    Cut::new(piece, &piece.marks, &[]).take(tets, &[], &[], &mut vec![NONE; piece.ids.len()])
}

/// For each owner its triangles, and whether another has each too.
fn triangles_of(piece: &Piece, owner: &[u32], owners: usize) -> Vec<Vec<(u32, bool)>> {
    let mesh = &piece.mesh;
    let index = TriangleIndex::new(Team::alone(), &mesh.triangles.nodes, mesh.vertices.len());
    let mut sides: Vec<(u32, u32)> = index
        .sides(Team::alone(), &mesh.tets.nodes)
        .into_iter()
        .map(|side| (side.triangle, owner[side.tet as usize]))
        .collect();
    sides.sort_unstable();
    sides.dedup();
    let mut of = vec![Vec::new(); owners];
    for same in sides.chunk_by(|a, b| a.0 == b.0) {
        for &(triangle, own) in same {
            of[own as usize].push((triangle, same.len() > 1 || piece.halves[triangle as usize]));
        }
    }
    of
}

/// For each owner the faces that are cuts: those that were cuts before and are open still, and those between owners.
fn cuts_of(
    piece: &Piece,
    owner: &[u32],
    owners: usize,
    of_vertex: &[u32],
    is_cut: impl Fn(usize, usize) -> bool,
) -> Vec<Vec<[u32; 3]>> {
    let mut known = piece.cuts.clone();
    known.sort_unstable();
    // A face between owners has vertices of several, one that was a cut has vertices that wait: most faces are neither.
    let waits = |v: u32| !known.is_empty() && piece.marks[v as usize] & WAITING != 0;
    let mut faces: Vec<([u32; 3], u32)> = Vec::new();
    for (t, nodes) in piece.mesh.tets.nodes.iter().enumerate() {
        let [several, waiting] = [nodes.map(|v| of_vertex[v as usize] == SEVERAL), nodes.map(waits)];
        let may_be = |face: &&[usize; 3]| face.iter().all(|&k| several[k]) || face.iter().all(|&k| waiting[k]);
        faces.extend(FACES.iter().filter(may_be).map(|face| (sorted3(face.map(|k| nodes[k])), t as u32)));
    }
    faces.sort_unstable();
    let mut of = vec![Vec::new(); owners];
    for same in faces.chunk_by(|a, b| a.0 == b.0) {
        match *same {
            [(nodes, t)] if known.binary_search(&nodes).is_ok() => of[owner[t as usize] as usize].push(nodes),
            [(nodes, t), (_, n)] => {
                let [t, n] = [t, n].map(|t| t as usize);
                if owner[t] != owner[n] && is_cut(t, n) {
                    of[owner[t] as usize].push(nodes);
                    of[owner[n] as usize].push(nodes);
                }
            }
            _ => {}
        }
    }
    of
}

/// A piece that is being cut.
struct Cut<'p> {
    piece: &'p Piece,
    marks: &'p [u8],
    /// The owner of each vertex; empty where there is one owner.
    of_vertex: &'p [u32],
    /// For each triangle whether it is required; empty where none is.
    is_required: Vec<bool>,
}

impl<'p> Cut<'p> {
    fn new(piece: &'p Piece, marks: &'p [u8], of_vertex: &'p [u32]) -> Self {
        let required = &piece.mesh.required_triangles;
        let mut is_required = vec![false; if required.is_empty() { 0 } else { piece.mesh.triangles.len() }];
        required.iter().for_each(|&t| is_required[t as usize] = true);
        Self { piece, marks, of_vertex, is_required }
    }

    /// The piece of these tetrahedra, triangles and cuts. `number` has a place for each vertex, and is left as it was.
    fn take(&self, tets: &[u32], triangles: &[(u32, bool)], cuts: &[[u32; 3]], number: &mut [u32]) -> Piece {
        let from = &self.piece.mesh;
        let mut piece = Piece::default();
        if tets.is_empty() {
            return piece;
        }
        let mut vertices = Vec::new();
        piece.mesh.tets.nodes.reserve_exact(tets.len());
        piece.mesh.tets.refs.reserve_exact(tets.len());
        for &t in tets {
            let nodes = from.tets.nodes[t as usize].map(|v| {
                if number[v as usize] == NONE {
                    number[v as usize] = vertices.len() as u32;
                    vertices.push(v);
                }
                number[v as usize]
            });
            piece.mesh.tets.push(nodes, from.tets.refs[t as usize]);
        }
        self.take_vertices(&mut piece, &vertices);
        self.take_triangles(&mut piece, triangles, number);
        piece.cuts = cuts.iter().map(|nodes| sorted3(nodes.map(|v| number[v as usize]))).collect();
        self.take_lines(&mut piece, number);
        vertices.iter().for_each(|&v| number[v as usize] = NONE);
        piece
    }

    fn take_vertices(&self, piece: &mut Piece, vertices: &[u32]) {
        let (from, place) = (&self.piece.mesh, &self.piece.place);
        let at = |v: &u32| *v as usize;
        piece.mesh.vertices = vertices.iter().map(|v| from.vertices[at(v)]).collect();
        piece.mesh.vertex_refs = vertices.iter().map(|v| from.vertex_refs[at(v)]).collect();
        piece.place.entities = vertices.iter().map(|v| place.entities[at(v)]).collect();
        piece.place.parameters = vertices.iter().map(|v| place.parameters[at(v)]).collect();
        piece.place.projected = vertices.iter().map(|v| place.projected[at(v)]).collect();
        piece.logs = vertices.iter().map(|v| self.piece.logs[at(v)]).collect();
        piece.ids = vertices.iter().map(|v| self.piece.ids[at(v)]).collect();
        piece.marks = vertices.iter().map(|v| self.marks[at(v)]).collect();
    }

    fn take_triangles(&self, piece: &mut Piece, triangles: &[(u32, bool)], number: &[u32]) {
        let from = &self.piece.mesh;
        for &(triangle, is_half) in triangles {
            let old = triangle as usize;
            if self.is_required.get(old) == Some(&true) {
                piece.mesh.required_triangles.push(piece.mesh.triangles.len() as u32);
            }
            let nodes = from.triangles.nodes[old].map(|v| number[v as usize]);
            piece.mesh.triangles.push(nodes, from.triangles.refs[old]);
            piece.place.faces.push(self.piece.place.faces[old]);
            piece.halves.push(is_half);
        }
    }

    /// Required vertices and edges, and ridges.
    fn take_lines(&self, piece: &mut Piece, number: &[u32]) {
        let from = &self.piece.mesh;
        let numbered = |nodes: [u32; 2]| {
            let nodes = nodes.map(|v| number[v as usize]);
            (!nodes.contains(&NONE)).then_some(nodes)
        };
        let required = from.required_vertices.iter().map(|&v| number[v as usize]);
        piece.mesh.required_vertices = required.filter(|&v| v != NONE).collect();
        for &e in &from.required_edges {
            if let Some(nodes) = numbered(from.edges.nodes[e as usize]) {
                piece.mesh.required_edges.push(piece.mesh.edges.len() as u32);
                piece.mesh.edges.push(nodes, from.edges.refs[e as usize]);
            }
        }
        // Where both ends are shared, the edge itself may be another piece's.
        let is_doubtful = |nodes: [u32; 2]| nodes.iter().all(|&v| self.of_vertex.get(v as usize) == Some(&SEVERAL));
        let mut doubtful = Vec::new();
        for &(nodes, curve) in &self.piece.place.ridges {
            match numbered(nodes) {
                Some(new) if is_doubtful(nodes) => doubtful.push((new, curve)),
                Some(new) => piece.place.ridges.push((new, curve)),
                None => {}
            }
        }
        if !doubtful.is_empty() {
            let edges = edges_on_lines(piece);
            let is_edge = |nodes: [u32; 2]| edges.binary_search(&sorted2(nodes)).is_ok();
            piece.place.ridges.extend(doubtful.into_iter().filter(|(nodes, _)| is_edge(*nodes)));
        }
    }
}

/// Drops the ridges between shared vertices that no tetrahedron of the piece has.
pub fn keep_ridges_of_tets(piece: &mut Piece) {
    let edges = edges_on_lines(piece);
    let marks = &piece.marks;
    piece.place.ridges.retain(|(nodes, _)| {
        let is_doubtful = nodes.iter().all(|&v| marks[v as usize] & SHARED != 0);
        !is_doubtful || edges.binary_search(&sorted2(*nodes)).is_ok()
    });
}

/// The edges of tetrahedra whose ends both lie on edges or vertices of the model and are shared, ascending; some come twice.
fn edges_on_lines(piece: &Piece) -> Vec<[u32; 2]> {
    let may_end = |v: u32| {
        piece.marks[v as usize] & SHARED != 0
            && matches!(piece.place.entities[v as usize], Entity::Edge(_) | Entity::Vertex(_))
    };
    let mut edges = Vec::new();
    for nodes in &piece.mesh.tets.nodes {
        let ends = nodes.map(may_end);
        let among = EDGES.iter().filter(|[i, j]| ends[*i] && ends[*j]);
        edges.extend(among.map(|&[i, j]| sorted2([nodes[i], nodes[j]])));
    }
    edges.sort_unstable();
    edges
}
