//! From several pieces to one.
use super::piece::{Piece, SHARED};
use crate::mesh::adjacency::{sorted2, sorted3};
use std::collections::{HashMap, HashSet};

/// Joins pieces where they share vertices. Of what several have, the first piece's counts; of a triangle between regions the one of the
/// lesser reference.
pub fn join(pieces: impl IntoIterator<Item = Piece>) -> Piece {
    let mut pieces = pieces.into_iter().filter(|piece| piece.len() > 0);
    let Some(first) = pieces.next() else { return Piece::default() };
    let Some(second) = pieces.next() else { return first };
    let mut joined = Joined::of(first);
    joined.add(&second);
    drop(second);
    pieces.for_each(|piece| drop(joined.add(&piece)));
    joined.whole
}

/// What has been joined so far.
#[derive(Default)]
pub struct Joined {
    /// As one piece.
    pub whole: Piece,
    /// The shared vertices by their ids.
    vertices: HashMap<u64, u32>,
    /// Triangles that another piece has too, by their nodes.
    halves: HashMap<[u32; 3], u32>,
    /// Ridges and required edges between shared vertices.
    ridges: HashSet<[u32; 2]>,
    edges: HashSet<[u32; 2]>,
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

    /// Adds a piece. Returns the numbers of its vertices in the whole.
    pub fn add(&mut self, piece: &Piece) -> Vec<u32> {
        let numbers = self.add_vertices(piece);
        let number = |v: u32| numbers[v as usize];
        let Self { whole, halves, ridges, edges, .. } = self;
        for (nodes, region) in piece.mesh.tets.iter() {
            whole.mesh.tets.push(nodes.map(number), region);
        }
        let mut new_triangle = Vec::with_capacity(piece.halves.len());
        for (t, (nodes, reference)) in piece.mesh.triangles.iter().enumerate() {
            let (nodes, is_half) = (nodes.map(number), piece.halves[t]);
            let known = if is_half { halves.remove(&sorted3(nodes)) } else { None };
            new_triangle.push(known.unwrap_or(whole.mesh.triangles.len() as u32));
            if let Some(known) = known.map(|known| known as usize) {
                whole.halves[known] = false;
                if reference < whole.mesh.triangles.refs[known] {
                    (whole.mesh.triangles.nodes[known], whole.mesh.triangles.refs[known]) = (nodes, reference);
                }
                continue;
            }
            if is_half {
                halves.insert(sorted3(nodes), whole.mesh.triangles.len() as u32);
            }
            whole.mesh.triangles.push(nodes, reference);
            whole.place.faces.push(piece.place.faces[t]);
            whole.halves.push(is_half);
        }
        whole.mesh.required_triangles.extend(piece.mesh.required_triangles.iter().map(|&t| new_triangle[t as usize]));
        whole.mesh.required_triangles.sort_unstable();
        whole.mesh.required_triangles.dedup();
        let marks = &whole.marks;
        let is_new = |known: &mut HashSet<[u32; 2]>, nodes: [u32; 2]| {
            let is_shared = nodes.iter().all(|&v| marks[v as usize] & SHARED != 0);
            !is_shared || known.insert(sorted2(nodes))
        };
        for &(nodes, curve) in &piece.place.ridges {
            let nodes = nodes.map(number);
            if is_new(ridges, nodes) {
                whole.place.ridges.push((nodes, curve));
            }
        }
        for (nodes, reference) in piece.mesh.edges.iter() {
            let nodes = nodes.map(number);
            if is_new(edges, nodes) {
                whole.mesh.required_edges.push(whole.mesh.edges.len() as u32);
                whole.mesh.edges.push(nodes, reference);
            }
        }
        whole.cuts.extend(piece.cuts.iter().map(|&nodes| sorted3(nodes.map(number))));
        whole.mesh.required_vertices.extend(piece.mesh.required_vertices.iter().map(|&v| number(v)));
        whole.mesh.required_vertices.sort_unstable();
        whole.mesh.required_vertices.dedup();
        numbers
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
