//! From several pieces to one.
use super::maps::{Map, Set};
use super::piece::{Piece, SHARED};
use crate::mesh::adjacency::{sorted2, sorted3};

/// Joins pieces where they share vertices. Of what several have, the first piece's counts.
pub fn join(pieces: impl IntoIterator<Item = Piece>) -> Piece {
    let mut pieces = pieces.into_iter().filter(|piece| piece.len() > 0);
    let Some(first) = pieces.next() else { return Piece::default() };
    let Some(second) = pieces.next() else { return first };
    let mut joined = Joined::of(first);
    joined.add(&second);
    drop(second);
    pieces.for_each(|piece| drop(joined.add(&piece)));
    joined.finish().0
}

/// What has been joined so far.
#[derive(Default)]
pub struct Joined {
    whole: Piece,
    /// The shared vertices by their ids.
    vertices: Map<u64, u32>,
    /// Triangles that another piece has too, by their nodes.
    halves: Map<[u32; 3], u32>,
    /// Ridges and required edges between shared vertices.
    ridges: Set<[u32; 2]>,
    edges: Set<[u32; 2]>,
}

impl Joined {
    fn of(whole: Piece) -> Self {
        let is_shared = |v: u32| whole.marks[v as usize] & SHARED != 0;
        let shared = (0..whole.ids.len() as u32).filter(|&v| is_shared(v));
        let vertices = shared.map(|v| (whole.ids[v as usize], v)).collect();
        let halves = (0..).zip(&whole.halves).filter(|(_, half)| **half);
        let halves = halves.map(|(t, _)| (sorted3(whole.mesh.triangles.nodes[t as usize]), t)).collect();
        let between = |nodes: &[u32; 2]| nodes.iter().all(|&v| is_shared(v));
        let ridges = whole.place.ridges.iter().map(|(nodes, _)| sorted2(*nodes)).filter(between).collect();
        let edges = whole.mesh.edges.nodes.iter().map(|nodes| sorted2(*nodes)).filter(between).collect();
        Self { whole, vertices, halves, ridges, edges }
    }

    /// As one piece, and the shared vertices by their ids.
    pub fn finish(self) -> (Piece, Map<u64, u32>) {
        let Self { mut whole, vertices, .. } = self;
        for required in [&mut whole.mesh.required_vertices, &mut whole.mesh.required_triangles] {
            required.sort_unstable();
            required.dedup();
        }
        (whole, vertices)
    }

    /// Adds a piece. Returns the numbers of its vertices in the whole.
    pub fn add(&mut self, piece: &Piece) -> Vec<u32> {
        let numbers = self.add_vertices(piece);
        let number = |v: u32| numbers[v as usize];
        let tets = &mut self.whole.mesh.tets;
        tets.nodes.extend(piece.mesh.tets.nodes.iter().map(|nodes| nodes.map(number)));
        tets.refs.extend_from_slice(&piece.mesh.tets.refs);
        self.add_triangles(piece, number);
        self.add_lines(piece, number);
        let whole = &mut self.whole;
        whole.cuts.extend(piece.cuts.iter().map(|&nodes| sorted3(nodes.map(number))));
        whole.mesh.required_vertices.extend(piece.mesh.required_vertices.iter().map(|&v| number(v)));
        numbers
    }

    fn add_triangles(&mut self, piece: &Piece, number: impl Fn(u32) -> u32) {
        let Self { whole, halves, .. } = self;
        let mut new_triangle = Vec::with_capacity(piece.halves.len());
        for (t, (nodes, reference)) in piece.mesh.triangles.iter().enumerate() {
            let (nodes, is_half) = (nodes.map(&number), piece.halves[t]);
            if is_half && let Some(known) = halves.remove(&sorted3(nodes)) {
                whole.halves[known as usize] = false;
                new_triangle.push(known);
                continue;
            }
            let next = whole.mesh.triangles.len() as u32;
            if is_half {
                halves.insert(sorted3(nodes), next);
            }
            new_triangle.push(next);
            whole.mesh.triangles.push(nodes, reference);
            whole.place.faces.push(piece.place.faces[t]);
            whole.halves.push(is_half);
        }
        whole.mesh.required_triangles.extend(piece.mesh.required_triangles.iter().map(|&t| new_triangle[t as usize]));
    }

    /// Adds ridges and required edges.
    fn add_lines(&mut self, piece: &Piece, number: impl Fn(u32) -> u32) {
        let Self { whole, ridges, edges, .. } = self;
        let marks = &whole.marks;
        let is_new = |known: &mut Set<[u32; 2]>, nodes: [u32; 2]| {
            let is_shared = nodes.iter().all(|&v| marks[v as usize] & SHARED != 0);
            !is_shared || known.insert(sorted2(nodes))
        };
        for &(nodes, curve) in &piece.place.ridges {
            let nodes = nodes.map(&number);
            if is_new(ridges, nodes) {
                whole.place.ridges.push((nodes, curve));
            }
        }
        for (nodes, reference) in piece.mesh.edges.iter() {
            let nodes = nodes.map(&number);
            if is_new(edges, nodes) {
                whole.mesh.required_edges.push(whole.mesh.edges.len() as u32);
                whole.mesh.edges.push(nodes, reference);
            }
        }
    }

    /// The vertices' numbers in the whole.
    fn add_vertices(&mut self, piece: &Piece) -> Vec<u32> {
        let Self { whole, vertices, .. } = self;
        let mut number = Vec::with_capacity(piece.ids.len());
        for (v, (&id, &mark)) in piece.ids.iter().zip(&piece.marks).enumerate() {
            let next = whole.ids.len() as u32;
            let at = if mark & SHARED != 0 { *vertices.entry(id).or_insert(next) } else { next };
            number.push(at);
            if at < next {
                whole.marks[at as usize] |= mark;
                continue;
            }
            whole.mesh.vertices.push(piece.mesh.vertices[v]);
            whole.mesh.vertex_refs.push(piece.mesh.vertex_refs[v]);
            whole.place.entities.push(piece.place.entities[v]);
            whole.place.parameters.push(piece.place.parameters[v]);
            whole.place.projected.push(piece.place.projected[v]);
            whole.logs.push(piece.logs[v]);
            whole.ids.push(id);
            whole.marks.push(mark);
        }
        number
    }
}
