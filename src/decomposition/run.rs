//! A run by parts, and what it gives back.
use super::Error;
use super::former::NearCuts;
use super::ground::{self, Ground};
use super::input::{Input, Skin};
use super::outline::Numbering;
use super::part::Done;
use super::piece::Piece;
use super::rounds::{Common, Rounds};
use super::sizes::wanted_vertices;
use super::slices::{Measured, Slice};
use super::threads::{Shared, add, sorted};
use super::times::{Numbered, Stopwatch, Told};
use crate::adapt::forecast::Forecast;
use crate::adapt::{Extracted, References, held_vertices};
use crate::geometry::Entity;
use crate::mesh::TetMesh;
use crate::mesh::adjacency::sorted3;
use crate::mesh::crossing::{self, Crossings};
use crate::metric::{Source, Sym3};
use crate::tasks::{Team, stage};
use std::collections::HashSet;

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

/// What is adapted.
pub struct Given<'a> {
    /// The mesh, with its metric.
    pub input: &'a dyn Input,
    /// Its boundary on the model.
    pub skin: &'a Skin<'a>,
    /// Where new vertices take their metric from. What lies on the vertices is taken from the input, where that is larger than a part.
    pub source: Option<Source>,
    /// The complexity of the metric.
    pub complexity: f64,
    /// A name for what is adapted and how.
    pub name: u64,
}

/// Adapts a mesh by parts. If the scratch folder has a journal of a run of its name, the run goes on from there, and `told` is called with the number
/// of rounds that were done.
///
/// # Errors
/// Those of [`crate::adapt::adapt`], and where pieces cannot be kept.
pub fn adapt<'a>(common: Common<'a>, given: Given<'_>, told: impl FnOnce(usize)) -> Result<Adapted<'a>, Error> {
    let team = Team::new(common.pool, common.options.plan);
    let Given { input, skin, source, complexity, name } = given;
    let refs = skin.references(team, common.model);
    let is_analytic = matches!(source, Some(Source::Analytic { .. }));
    let (mut rounds, blocks) = Rounds::new(common, name, refs.outwards(), (input, skin), !is_analytic)?;
    if rounds.rounds_before() > 0 {
        told(rounds.rounds_before());
    }
    let vertices = input.size()[0];
    common.observer.forecast(&forecast(&common, complexity, vertices));
    let mut ground = match source {
        Some(source) if blocks.is_empty() => Ground::Whole(source),
        None if blocks.is_empty() => Ground::Whole(ground::whole(team, input, skin, common.model)?),
        _ => Ground::Blocks(blocks, 0.0),
    };
    rounds.run(&mut ground, team, complexity, vertices)?;
    stage("rounds");
    let mut watch = Stopwatch::start(common.pool.threads() == 1);
    let found = rounds.outlines()?;
    let outlines = watch.lap();
    let mut numbering = Numbering::of(found);
    let numbers = watch.lap();
    let skin = outer(team, &mut numbering, &refs, &common);
    stage("vertices numbered");
    let numbered = Numbered { outlines, numbers, boundary: watch.lap() };
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
fn outer(team: Team<'_>, numbering: &mut Numbering, refs: &References, common: &Common<'_>) -> Extracted {
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

    /// Calls f with each slice of this rank, on all threads.
    ///
    /// # Errors
    /// That of f, and where a piece cannot be read.
    pub fn for_each_slice(&self, f: impl Fn(Slice) -> Result<(), Error> + Sync) -> Result<(), Error> {
        self.rounds.for_each_own(|at, piece| f(self.slice(at, piece)))
    }

    /// Gives all slices of this rank to rank 0, which puts the mesh [together in memory](Self::into_memory). Collective.
    ///
    /// # Errors
    /// That of any rank.
    pub fn give_slices(&self) -> Result<(), Error> {
        self.rounds.for_each_finished(|_, _| Ok(()))
    }

    fn slice(&self, at: usize, piece: Piece) -> Slice {
        let numbers = self.numbering.of_piece(at, &piece);
        Slice::of(piece, &numbers, self.rounds.felt(at))
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

    /// The whole mesh in memory, as the kernel gives it, and how good it is near cuts: on rank 0, to which the others
    /// [give their slices](Self::give_slices).
    ///
    /// # Errors
    /// Where a piece cannot be read.
    pub fn into_memory(mut self) -> Result<(crate::adapt::Adapted, NearCuts), Error> {
        let slices = Shared::default();
        self.rounds.for_each_finished(|at, piece| {
            add(&slices, self.slice(at, piece));
            Ok(())
        })?;
        let slices = sorted(slices, |slice| slice.first_tet);
        let [vertices, tets] = self.size();
        let Extracted { mesh, classification: place, metrics, .. } = &mut self.skin;
        let more = vertices - mesh.vertices.len();
        mesh.vertices.reserve_exact(more);
        mesh.tets.nodes.reserve_exact(tets);
        let mut measured = Measured::default();
        for mut slice in slices {
            measured.add(&mut slice);
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
        Ok((self.rounds.done.with(self.skin), measured.statistics().1))
    }
}
