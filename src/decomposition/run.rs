//! A run by parts, and what it gives back.
use super::Error;
use super::outline::{Numbering, Numbers};
use super::part::Done;
use super::piece::{Piece, SHARED};
use super::rounds::{Common, Rounds};
use super::sizes::wanted_vertices;
use super::times::{Numbered, Told, lap};
use crate::adapt::forecast::Forecast;
use crate::adapt::{Extracted, References, held_vertices};
use crate::geometry::Entity;
use crate::geometry::classify::Classification;
use crate::mesh::adjacency::{sorted2, sorted3};
use crate::mesh::crossing::{self, Crossings};
use crate::mesh::vector::{Vec3, sub};
use crate::mesh::{Elements, TetMesh};
use crate::metric::quality::edge_length;
use crate::metric::statistics::{Figures, Part, Statistics};
use crate::metric::{Source, Sym3};
use crate::tasks::{GRAIN, Team, stage};
use std::collections::HashSet;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// How many pairs of crossing triangles are told.
const TOLD: usize = 3;

/// An adapted mesh in pieces.
pub struct Adapted<'a> {
    rounds: Rounds<'a>,
    numbering: Numbering,
    /// The boundary of the mesh with all that is listed of it, and no tetrahedra: its vertices are the first ones of the mesh.
    skin: Extracted,
    numbered: Numbered,
}

/// Adapts a mesh by parts. `source` is as it was afterwards. `run` names what is adapted and how. If the scratch folder has a journal of that name,
/// the run goes on from there, and `told` is called with the number of rounds that were done.
///
/// # Errors
/// Those of [`crate::adapt::adapt`], and where pieces cannot be kept.
pub fn adapt<'a>(
    common: Common<'a>,
    (mesh, place): (&TetMesh, &Classification),
    source: &mut Source,
    run: u64,
    told: impl FnOnce(usize),
) -> Result<Adapted<'a>, Error> {
    let team = Team::new(common.pool, common.options.plan);
    source.check(team, mesh).map_err(crate::adapt::Error::from)?;
    let complexity = source.complexity(team, mesh);
    let refs = References::of(team, mesh, place, common.model);
    let mut rounds = Rounds::new(common, run, refs.outwards(), || {
        let logs = match source.logs_on(mesh) {
            Some(logs) => logs.to_vec(),
            None => team.map(GRAIN, mesh.vertices.len(), |v| source.log_at(mesh.vertices[v], &mut 0)),
        };
        Piece::whole(team, mesh, place, logs)
    })?;
    if rounds.rounds_before() > 0 {
        told(rounds.rounds_before());
    }
    common.observer.forecast(&forecast(&common, complexity, mesh.vertices.len()));
    rounds.run(source, team, complexity, mesh.vertices.len())?;
    stage("rounds");
    let mut since = Instant::now();
    let found = rounds.outlines()?;
    let outlines = lap(&mut since);
    let mut numbering = Numbering::of(found);
    let numbers = lap(&mut since);
    let skin = skin(team, &mut numbering, &refs, &common);
    stage("vertices numbered");
    let numbered = Numbered { outlines, numbers, boundary: lap(&mut since) };
    Ok(Adapted { rounds, numbering, skin, numbered })
}

/// What the run will take; of memory as much as it may.
fn forecast(common: &Common<'_>, complexity: f64, given: usize) -> Forecast {
    let ranks = common.ranks.count();
    let whole = Forecast::of(wanted_vertices(complexity), given, common.pool.threads() * ranks);
    // Cuts cost about half as much again.
    let bytes = common.memory.map_or(whole.bytes / ranks as f64, |memory| whole.bytes.min(memory as f64));
    Forecast { seconds: 1.5 * whole.seconds, bytes, ..whole }
}

/// The boundary as the kernel gives it, with the references of the input.
fn skin(team: Team<'_>, numbering: &mut Numbering, refs: &References, common: &Common<'_>) -> Extracted {
    let Piece { mut mesh, place: classification, logs, cuts: inner, .. } = std::mem::take(&mut numbering.skin);
    let crossings = crossings(team, &mesh, inner);
    for (t, &face) in classification.faces.iter().enumerate() {
        mesh.triangles.refs[t] = refs.faces[face as usize];
        if refs.inward[face as usize] {
            mesh.triangles.nodes[t].swap(1, 2);
        }
    }
    for &(nodes, edge) in &classification.ridges {
        mesh.edges.push(nodes, refs.edges[edge as usize]);
    }
    let is_on_model = |v: u32| classification.entities[v as usize] != Entity::Interior;
    let mut held = held_vertices(&mesh, &common.options.freeze);
    held.retain(|&v| is_on_model(v));
    let is_off = |v: &u32| {
        let moves = mesh.vertices[*v as usize] != classification.projected[*v as usize];
        is_on_model(*v) && moves && held.binary_search(v).is_err()
    };
    let off_model = (0..mesh.vertices.len() as u32).filter(is_off).collect();
    let metrics = logs.iter().map(Sym3::exp).collect();
    Extracted { mesh, classification, metrics, off_model, held, crossings, part: None }
}

/// Where the boundary, of triangles that look outwards, passes through itself; `inner` ones do not belong to it.
fn crossings(team: Team<'_>, mesh: &TetMesh, inner: Vec<[u32; 3]>) -> Crossings {
    let inner: HashSet<[u32; 3]> = inner.into_iter().collect();
    let outer = mesh.triangles.nodes.iter().zip(0..).filter(|(nodes, _)| !inner.contains(&sorted3(**nodes)));
    let (outer, numbers): (Vec<[u32; 3]>, Vec<usize>) = outer.unzip();
    let mut found = crossing::crossings(team, &outer, |v| mesh.vertices[v as usize], TOLD);
    for told in &mut found.first {
        told.triangles = told.triangles.map(|i| numbers[i]);
    }
    found
}

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
    fn of(piece: Piece, numbers: &Numbers) -> Self {
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

/// The figures of a whole mesh from those of its boundary and of its slices.
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

    /// The statistics.
    pub fn statistics(self) -> Statistics {
        let Self { mut figures, mut doubtful } = self;
        figures.sort_by_key(|(at, _)| *at);
        doubtful.sort_unstable_by_key(|edge| edge.0);
        doubtful.dedup_by_key(|(edge, _)| *edge);
        let mut all = figures.into_iter().map(|(_, figures)| figures);
        let first = all.next().expect("the boundary is there");
        all.fold(first, Figures::and).with_lengths(doubtful.into_iter().map(|(_, length)| length)).statistics()
    }
}

impl Adapted<'_> {
    /// What came of all parts.
    pub fn done(&self) -> &Done {
        &self.rounds.done
    }

    /// What each round did.
    pub fn told(&self) -> &[Told] {
        &self.rounds.told
    }

    /// What it took to number the vertices.
    pub fn numbered(&self) -> Numbered {
        self.numbered
    }

    /// Vertices and tetrahedra.
    pub fn size(&self) -> [usize; 2] {
        [self.numbering.vertices(), self.numbering.tets()]
    }

    /// Calls f on rank 0 with each slice of all ranks: on all threads, where there is one rank, else one after the other.
    ///
    /// # Errors
    /// That of f, and where a piece cannot be read.
    pub fn for_each_slice(&self, f: impl Fn(Slice) -> Result<(), Error> + Sync) -> Result<(), Error> {
        self.rounds.for_each_finished(|at, piece| {
            let numbers = self.numbering.of_piece(at, &piece);
            f(Slice::of(piece, &numbers))
        })
    }

    /// The boundary of the mesh, of which the caller may make what it likes: nothing here asks for it again.
    pub fn take_skin(&mut self) -> Extracted {
        let Extracted { mesh, classification, metrics, off_model, held, crossings, .. } = &mut self.skin;
        Extracted {
            mesh: std::mem::take(mesh),
            classification: std::mem::take(classification),
            metrics: std::mem::take(metrics),
            off_model: std::mem::take(off_model),
            held: std::mem::take(held),
            crossings: std::mem::take(crossings),
            part: None,
        }
    }

    /// The whole mesh in memory, as the kernel gives it.
    ///
    /// # Errors
    /// Where a piece cannot be read.
    pub fn into_memory(mut self) -> Result<crate::adapt::Adapted, Error> {
        let slices = Mutex::new(Vec::new());
        self.for_each_slice(|slice| {
            slices.lock().unwrap_or_else(PoisonError::into_inner).push(slice);
            Ok(())
        })?;
        let mut slices = slices.into_inner().unwrap_or_else(PoisonError::into_inner);
        slices.sort_by_key(|slice| slice.first_tet);
        let [vertices, tets] = self.size();
        let Extracted { mesh, classification: place, metrics, .. } = &mut self.skin;
        let more = vertices - mesh.vertices.len();
        mesh.vertices.reserve_exact(more);
        mesh.tets.nodes.reserve_exact(tets);
        for mut slice in slices {
            place.projected.extend_from_slice(&slice.vertices);
            mesh.vertices.append(&mut slice.vertices);
            mesh.vertex_refs.append(&mut slice.vertex_refs);
            metrics.append(&mut slice.metrics);
            mesh.tets.nodes.append(&mut slice.tets.nodes);
            mesh.tets.refs.append(&mut slice.tets.refs);
        }
        place.entities.resize(vertices, Entity::Interior);
        place.parameters.resize(vertices, [0.0; 2]);
        stage("pieces joined");
        Ok(self.rounds.done.with(self.skin))
    }
}
