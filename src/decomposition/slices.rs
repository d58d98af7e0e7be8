//! The finished pieces as slices of the whole mesh: to be written, and measured.
use super::Error;
use super::bytes::{put, take};
use super::former::{AtCut, Felt, NearCuts, Where, figures_at_cuts};
use super::outline::Numbers;
use super::piece::{Piece, SHARED};
use crate::mesh::adjacency::sorted2;
use crate::mesh::vector::{Vec3, sub};
use crate::mesh::{Elements, TetMesh};
use crate::metric::Sym3;
use crate::metric::quality::edge_length;
use crate::metric::statistics::{Figures, Part, Statistics};
use crate::tasks::Team;
use std::cmp::Reverse;
use std::sync::{Mutex, PoisonError};

/// An edge that several pieces may have: by the numbers of the whole mesh, ascending, where it lies, and its length in the metric.
type Doubtful = ([u32; 2], Where, f64);

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
    /// Where it lies.
    place: Where,
    /// The same figures of what is at a cut.
    at_cuts: Option<Figures>,
    /// The other edges.
    doubtful: Vec<Doubtful>,
}

impl Slice {
    /// What a piece, which has felt these cuts, is of the whole mesh.
    pub fn of(piece: Piece, numbers: &Numbers, felt: Felt<'_>) -> Self {
        let Numbers { numbers, written, first, first_tet } = numbers;
        let metrics: Vec<Sym3> = piece.logs.iter().map(Sym3::exp).collect();
        let at_cuts = figures_at_cuts(&piece, felt, &metrics);
        let Piece { mesh, marks, .. } = piece;
        let near = AtCut::of(felt, &mesh.vertices, &metrics);
        let is_shared = |v: u32| marks[v as usize] & SHARED != 0;
        let doubtful = Mutex::new(Vec::new());
        let counts = |[a, b]: [u32; 2]| {
            if !is_shared(a) || !is_shared(b) {
                return true;
            }
            let [p, q] = [a, b].map(|v| mesh.vertices[v as usize]);
            let length = edge_length(sub(q, p), &metrics[a as usize], &metrics[b as usize]);
            let edge = sorted2([a, b].map(|v| numbers[v as usize]));
            doubtful.lock().unwrap_or_else(PoisonError::into_inner).push((edge, near.place([a, b]), length));
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
            place: felt.place(),
            at_cuts,
            doubtful,
        }
    }
}

/// The figures of a whole mesh from those of its boundary and of its slices. Each rank has those of its slices, and rank 0 adds all.
#[derive(Default)]
pub struct Measured {
    figures: Vec<(usize, Where, Figures)>,
    doubtful: Vec<Doubtful>,
}

impl Measured {
    /// Of a boundary, whose vertices come first in the mesh.
    pub fn of(team: Team<'_>, skin: &TetMesh, metrics: &[Sym3]) -> Self {
        let none = Elements::default();
        let part = Part { tets: &none, ..Part::whole(skin) };
        let figures = Figures::in_metric(team, part, metrics, |_| false);
        Self { figures: vec![(0, Where::Untouched, figures)], doubtful: Vec::new() }
    }

    /// Adds those of a slice.
    pub fn add(&mut self, slice: &mut Slice) {
        let at = 1 + slice.first_tet;
        self.figures.push((at, slice.place, slice.figures.clone()));
        self.figures.extend(slice.at_cuts.take().map(|figures| (at, Where::AtCut, figures)));
        self.doubtful.append(&mut slice.doubtful);
    }

    /// As bytes.
    pub fn encoded(&self) -> Vec<u8> {
        let (edges, lengths): (Vec<_>, Vec<_>) = self.doubtful.iter().map(|&(edge, _, length)| (edge, length)).unzip();
        let places: Vec<u8> = self.doubtful.iter().map(|&(_, place, _)| place as u8).collect();
        let mut bytes = Vec::new();
        put(&mut bytes, &edges);
        put(&mut bytes, &places);
        put(&mut bytes, &lengths);
        for (at, place, figures) in &self.figures {
            put(&mut bytes, &[&[*at as u64, *place as u64], &figures.words()[..]].concat());
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
        let places: Vec<u8> = take(from).ok_or(Error::Message)?;
        let lengths: Vec<f64> = take(from).ok_or(Error::Message)?;
        for ((edge, place), length) in edges.into_iter().zip(places).zip(lengths) {
            let place = Where::of_number(place.into()).ok_or(Error::Message)?;
            self.doubtful.push((edge, place, length));
        }
        while !from.is_empty() {
            let words: Vec<u64> = take(from).ok_or(Error::Message)?;
            let (&[at, place], mut words) = words.split_first_chunk().ok_or(Error::Message)?;
            let place = Where::of_number(place).ok_or(Error::Message)?;
            self.figures.push((at as usize, place, Figures::of_words(&mut words).ok_or(Error::Message)?));
        }
        Ok(())
    }

    /// The statistics, and apart from each other those of what is near cuts and far from them.
    pub fn statistics(self) -> (Statistics, NearCuts) {
        let Self { mut figures, mut doubtful } = self;
        figures.sort_by_key(|&(at, place, _)| (at, place));
        // Of an edge that pieces at different places share, the place nearest to a cut.
        doubtful.sort_unstable_by_key(|&(edge, place, _)| (edge, Reverse(place)));
        doubtful.dedup_by_key(|(edge, ..)| *edge);
        let joined = |is_meant: &dyn Fn(Where) -> bool, has_edge: &dyn Fn(Where) -> bool| {
            let of = figures.iter().filter(|(_, place, _)| is_meant(*place)).map(|(.., figures)| figures.clone());
            let lengths = doubtful.iter().filter(|(_, place, _)| has_edge(*place)).map(|&(.., length)| length);
            Some(of.reduce(Figures::and)?.with_lengths(lengths))
        };
        let is = |wanted: Where| move |place: Where| place == wanted;
        // What is at a cut is around it.
        let near = NearCuts::of([
            joined(&is(Where::Untouched), &is(Where::Untouched)),
            joined(&is(Where::Around), &|place| place >= Where::Around),
            joined(&is(Where::AtCut), &is(Where::AtCut)),
        ]);
        let whole = joined(&|place| place < Where::AtCut, &|_| true);
        (whole.map(Figures::statistics).unwrap_or_default(), near)
    }
}
