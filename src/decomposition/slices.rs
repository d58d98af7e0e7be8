//! The finished pieces as slices of the whole mesh: to be written, and measured.
use super::Error;
use super::bytes::{put, take};
use super::outline::Numbers;
use super::piece::{Piece, SHARED};
use crate::mesh::adjacency::sorted2;
use crate::mesh::vector::{Vec3, sub};
use crate::mesh::{Elements, TetMesh};
use crate::metric::Sym3;
use crate::metric::quality::edge_length;
use crate::metric::statistics::{Figures, Part, Statistics};
use crate::tasks::Team;
use std::sync::{Mutex, PoisonError};

/// Some of the whole mesh: vertices inside, and tetrahedra, each from a number on.
pub struct Slice {
    /// The number of the first vertex.
    pub first: usize,
    /// Coordinates.
    pub vertices: Vec<Vec3>,
    /// References.
    pub vertex_refs: Vec<i32>,
    /// M.
    pub metrics: Vec<Sym3>,
    /// The number of the first tetrahedron.
    pub first_tet: usize,
    /// Tetrahedra, by the numbers of the whole mesh.
    pub tets: Elements<4>,
    /// Edge lengths, mean ratios, complexity; of edges those that no other piece can have.
    pub figures: Figures,
    /// The other edges, by the numbers of the whole mesh, ascending, with their lengths in the metric.
    pub doubtful: Vec<([u32; 2], f64)>,
}

impl Slice {
    /// What a piece is of the whole mesh.
    pub fn of(piece: Piece, numbers: &Numbers) -> Self {
        let Numbers { numbers, written, first, first_tet } = numbers;
        let metrics: Vec<Sym3> = piece.logs.iter().map(Sym3::exp).collect();
        let Piece { mesh, marks, .. } = piece;
        let is_shared = |v: u32| marks[v as usize] & SHARED != 0;
        let doubtful = Mutex::new(Vec::new());
        let counts = |[a, b]: [u32; 2]| {
            if !is_shared(a) || !is_shared(b) {
                return true;
            }
            let [p, q] = [a, b].map(|v| mesh.vertices[v as usize]);
            let length = edge_length(sub(q, p), &metrics[a as usize], &metrics[b as usize]);
            let edge = sorted2([a, b].map(|v| numbers[v as usize]));
            doubtful.lock().unwrap_or_else(PoisonError::into_inner).push((edge, length));
            false
        };
        let (none, none_tagged) = (Elements::default(), Elements::default());
        let part = Part {
            vertices: &mesh.vertices,
            own_vertices: written.len(),
            tets: &mesh.tets,
            triangles: &none,
            edges: &none_tagged,
        };
        let figures = Figures::in_metric(Team::alone(), part, &metrics, counts);
        let doubtful = doubtful.into_inner().unwrap_or_else(PoisonError::into_inner);
        let mut tets = mesh.tets;
        tets.nodes.iter_mut().flatten().for_each(|v| *v = numbers[*v as usize]);
        let at = |v: &u32| *v as usize;
        Self {
            first: *first,
            vertices: written.iter().map(|v| mesh.vertices[at(v)]).collect(),
            vertex_refs: written.iter().map(|v| mesh.vertex_refs[at(v)]).collect(),
            metrics: written.iter().map(|v| metrics[at(v)]).collect(),
            first_tet: *first_tet,
            tets,
            figures,
            doubtful,
        }
    }
}

/// The figures of a whole mesh from those of its boundary and of its slices. Each rank has those of its slices, and rank 0 adds all.
#[derive(Default)]
pub struct Measured {
    figures: Vec<(usize, Figures)>,
    doubtful: Vec<([u32; 2], f64)>,
}

impl Measured {
    /// Of a boundary, whose vertices come first in the mesh.
    pub fn of(team: Team<'_>, skin: &TetMesh, metrics: &[Sym3]) -> Self {
        let none = Elements::default();
        let part = Part { tets: &none, ..Part::whole(skin) };
        Self { figures: vec![(0, Figures::in_metric(team, part, metrics, |_| false))], doubtful: Vec::new() }
    }

    /// Adds those of a slice.
    pub fn add(&mut self, slice: &mut Slice) {
        self.figures.push((1 + slice.first_tet, slice.figures.clone()));
        self.doubtful.append(&mut slice.doubtful);
    }

    /// As bytes.
    pub fn encoded(&self) -> Vec<u8> {
        let (edges, lengths): (Vec<_>, Vec<_>) = self.doubtful.iter().copied().unzip();
        let mut bytes = Vec::new();
        put(&mut bytes, &edges);
        put(&mut bytes, &lengths);
        for (at, figures) in &self.figures {
            put(&mut bytes, &[&[*at as u64], &figures.words()[..]].concat());
        }
        bytes
    }

    /// Adds those of another rank.
    ///
    /// # Errors
    /// Where the bytes are not those of another rank.
    pub fn add_encoded(&mut self, mut bytes: &[u8]) -> Result<(), Error> {
        let from = &mut bytes;
        let edges: Vec<[u32; 2]> = take(from).ok_or(Error::Message)?;
        self.doubtful.extend(edges.into_iter().zip(take(from).ok_or(Error::Message)?));
        while !from.is_empty() {
            let words: Vec<u64> = take(from).ok_or(Error::Message)?;
            let (&at, mut words) = words.split_first().ok_or(Error::Message)?;
            self.figures.push((at as usize, Figures::of_words(&mut words).ok_or(Error::Message)?));
        }
        Ok(())
    }

    /// The statistics.
    pub fn statistics(self) -> Statistics {
        let Self { mut figures, mut doubtful } = self;
        figures.sort_by_key(|(at, _)| *at);
        doubtful.sort_unstable_by_key(|edge| edge.0);
        doubtful.dedup_by_key(|(edge, _)| *edge);
        let mut all = figures.into_iter().map(|(_, figures)| figures);
        let Some(first) = all.next() else { return Statistics::default() };
        all.fold(first, Figures::and).with_lengths(doubtful.into_iter().map(|(_, length)| length)).statistics()
    }
}
