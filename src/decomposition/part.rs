//! Adapts one part of the mesh, while its faces to other parts stay.
use super::join::join;
use super::manifold::{open_faces, resting};
use super::piece::{Piece, SHARED, WAITING};
use super::split::split;
use crate::adapt::{self, Adapted, Effort, Error, Extracted, KINDS, Observer, Options, References, Work};
use crate::geometry::Model;
use crate::mesh::TetMesh;
use crate::mesh::adjacency::{MatchedFaces, TriangleIndex, sorted3};
use crate::metric::Source;
use crate::tasks::{Pool, Team};
use std::time::Duration;

/// What came of a part, beside its mesh.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Done {
    /// Time and counts by operation, in the order of [`adapt::Kind`].
    pub work: [Work; KINDS],
    /// Why the mesh stopped growing before its metric was met; none where it was met.
    pub growth_end: Option<adapt::GrowthEnd>,
    /// Bad tetrahedra that repair left untried, since there were too many of them.
    pub unrepaired: usize,
    /// Surface triangles that deviate from the model by more than the bounds that were given.
    pub deviating: usize,
    /// Time in the model's evaluators.
    pub geometry: Duration,
    /// Seconds that all took ([`super::times::ToldPart`]).
    pub seconds: f64,
}

impl Done {
    /// With a mesh, as the kernel gives it.
    pub fn with(self, extracted: Extracted) -> Adapted {
        let Self { work, growth_end, unrepaired, deviating, geometry, .. } = self;
        Adapted { extracted, work, growth_end, unrepaired, deviating, geometry }
    }

    /// Adds what came of another part.
    pub fn add(&mut self, other: &Self) {
        for (work, more) in self.work.iter_mut().zip(&other.work) {
            work.counts.add(&more.counts);
            work.sweeps += more.sweeps;
            work.time += more.time;
        }
        self.growth_end = self.growth_end.or(other.growth_end);
        self.unrepaired += other.unrepaired;
        self.deviating += other.deviating;
        self.geometry += other.geometry;
        self.seconds += other.seconds;
    }
}

/// What a part is adapted with.
#[derive(Clone, Copy)]
pub struct Tools<'a> {
    /// The model the boundary lies on.
    pub model: &'a Model,
    /// Where new vertices take their metric from.
    pub source: &'a Source,
    /// The references of the whole mesh, with all triangles outwards.
    pub refs: &'a References,
    /// How to adapt.
    pub options: &'a Options,
    /// The threads of one part.
    pub pool: &'a Pool,
    /// Is told of the progress.
    pub observer: &'a dyn Observer,
}

/// What a round is like.
#[derive(Clone, Copy, Debug)]
pub struct Round {
    /// Whether it is about former cuts; else it is about all of the mesh.
    pub is_zone: bool,
    /// Whether there is one part: then there are no cuts.
    pub is_alone: bool,
}

/// Adapts a piece; its new vertices are called `first_id` and so on. Where it hangs together by faces alone it is left as it is.
///
/// # Errors
/// Those of [`adapt::adapt`].
pub fn adapt_piece(tools: Tools<'_>, mut piece: Piece, round: Round, first_id: u64) -> Result<(Piece, Done), Error> {
    if piece.len() == 0 {
        return Ok((piece, Done::default()));
    }
    // Around former cuts, what was not at one is finished.
    let is_finished: Vec<bool> =
        (0..piece.len()).map(|t| round.is_alone || (round.is_zone && !piece.waits(t))).collect();
    let faces = MatchedFaces::of(Team::alone(), &piece.mesh.tets.nodes);
    drop_closed_cuts(&mut piece, &faces);
    let rests = resting(&piece.mesh.tets.nodes, piece.ids.len(), &faces);
    if !rests.contains(&true) {
        return adapt_manifold(tools, piece, faces, round, first_id);
    }
    drop(faces);
    let owner: Vec<u32> = rests.iter().map(|&rests| u32::from(rests)).collect();
    let is_cut = |t: usize, n: usize| !is_finished[if rests[t] { t } else { n }];
    let [active, resting]: [Piece; 2] = split(&piece, &owner, 2, is_cut).try_into().unwrap_or_default();
    drop(piece);
    let faces = MatchedFaces::of(Team::alone(), &active.mesh.tets.nodes);
    let (active, done) = adapt_manifold(tools, active, faces, round, first_id)?;
    Ok((join([active, resting]), done))
}

/// Of the cuts those stay that have one tetrahedron here. Their vertices wait.
fn drop_closed_cuts(piece: &mut Piece, faces: &MatchedFaces) {
    let mut known = std::mem::take(&mut piece.cuts);
    known.sort_unstable();
    piece.marks.iter_mut().for_each(|mark| *mark &= !WAITING);
    if known.is_empty() {
        return;
    }
    for face in open_faces(&piece.mesh.tets.nodes, &faces.neighbours, |_, _| false).map(sorted3) {
        if known.binary_search(&face).is_ok() {
            face.iter().for_each(|&v| piece.marks[v as usize] |= WAITING);
            piece.cuts.push(face);
        }
    }
}

/// What must stay of a piece.
struct Held {
    /// Vertices of the faces to other parts and of triangles that another part has too, ascending.
    vertices: Vec<u32>,
    /// Triangles that another part has too.
    triangles: Vec<u32>,
}

impl Held {
    fn of(piece: &Piece, faces: &MatchedFaces) -> Self {
        let mesh = &piece.mesh;
        let index = TriangleIndex::new(Team::alone(), &mesh.triangles.nodes, mesh.vertices.len());
        let mut has_triangle = vec![0u8; mesh.tets.len()];
        for side in index.sides(Team::alone(), &mesh.tets.nodes) {
            has_triangle[side.tet as usize] |= 1 << side.face;
        }
        let open = open_faces(&mesh.tets.nodes, &faces.neighbours, |t, i| has_triangle[t] & (1 << i) != 0);
        let triangles: Vec<u32> = (0..).zip(&piece.halves).filter(|(_, half)| **half).map(|(t, _)| t).collect();
        let halves = triangles.iter().map(|&t| mesh.triangles.nodes[t as usize]);
        let mut is_held = vec![false; piece.ids.len()];
        open.chain(halves).flatten().for_each(|v| is_held[v as usize] = true);
        let vertices = (0..).zip(&is_held).filter(|(_, held)| **held).map(|(v, _)| v).collect();
        Self { vertices, triangles }
    }
}

fn adapt_manifold(
    tools: Tools<'_>,
    piece: Piece,
    faces: MatchedFaces,
    round: Round,
    first_id: u64,
) -> Result<(Piece, Done), Error> {
    let Tools { model, source, refs, options, pool, observer } = tools;
    let held = Held::of(&piece, &faces);
    drop(faces);
    let part = adapt::Part {
        logs: &piece.logs,
        held: &held.vertices,
        triangles: &held.triangles,
        refs,
        effort: match round {
            Round { is_zone: true, .. } => Effort::AROUND_CUTS,
            Round { is_alone: true, .. } => Effort::FULL,
            _ => Effort::BETWEEN_CUTS,
        },
    };
    let adapted = adapt::adapt_part(&piece.mesh, &piece.place, Some(part), model, source, options, pool, observer)?;
    let Adapted { extracted, work, growth_end, unrepaired, deviating, geometry } = adapted;
    let done = Done { work, growth_end, unrepaired, deviating, geometry, seconds: 0.0 };
    Ok((put_back(&piece, &held, extracted, first_id), done))
}

/// The adapted part as a piece: what was held is called as before.
fn put_back(before: &Piece, held: &Held, extracted: Extracted, first_id: u64) -> Piece {
    let Extracted { mut mesh, classification: mut place, part, .. } = extracted;
    let (logs, number) = part.map(|joint| (joint.logs, joint.held)).unwrap_or_default();
    let mut ids: Vec<u64> = (first_id..).take(logs.len()).collect();
    let mut marks = vec![0; logs.len()];
    for (&old, &new) in held.vertices.iter().zip(&number) {
        let (old, new) = (old as usize, new as usize);
        ids[new] = before.ids[old];
        marks[new] = SHARED | before.marks[old];
        // It did not move, and may have a way to go to the model.
        place.projected[new] = before.place.projected[old];
    }
    let number_of = |v: u32| held.vertices.binary_search(&v).ok().map(|at| number[at]);
    let numbered = |nodes: [u32; 3]| {
        let [a, b, c] = nodes.map(number_of);
        Some([a?, b?, c?])
    };
    let halves = restore_halves(before, held, &mut mesh, numbered);
    keep_required_edges(&mut mesh);
    // A cut between the active and the resting tetrahedra of a part has held vertices too.
    let cuts = before.cuts.iter().filter_map(|&nodes| numbered(nodes)).map(sorted3).collect();
    Piece { mesh, place, logs, ids, marks, halves, cuts }
}

/// Finds the triangles that another part has too. They turn as before: the kernel, which knows one side, may have turned them.
fn restore_halves(
    before: &Piece,
    held: &Held,
    mesh: &mut TetMesh,
    numbered: impl Fn([u32; 3]) -> Option<[u32; 3]>,
) -> Vec<bool> {
    let halves = held.triangles.iter().filter_map(|&t| numbered(before.mesh.triangles.nodes[t as usize]));
    let mut halves: Vec<([u32; 3], [u32; 3])> = halves.map(|nodes| (sorted3(nodes), nodes)).collect();
    halves.sort_unstable();
    let restore = |nodes: &mut [u32; 3]| {
        let known = halves.binary_search_by_key(&sorted3(*nodes), |half| half.0);
        known.map(|at| *nodes = halves[at].1).is_ok()
    };
    mesh.triangles.nodes.iter_mut().map(restore).collect()
}

/// Drops the edges that are listed because they are ridges.
fn keep_required_edges(mesh: &mut TetMesh) {
    let all = std::mem::take(&mut mesh.edges);
    for e in &mut mesh.required_edges {
        let old = *e as usize;
        *e = mesh.edges.len() as u32;
        mesh.edges.push(all.nodes[old], all.refs[old]);
    }
}
