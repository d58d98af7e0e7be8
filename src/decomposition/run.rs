//! A run by parts, and what it gives back.
use super::Error;
use super::outline::{Numbering, Numbers};
use super::part::Done;
use super::piece::Piece;
use super::rounds::{Common, Rounds, Told};
use crate::adapt::{Extracted, References, held_vertices};
use crate::geometry::Entity;
use crate::geometry::classify::Classification;
use crate::mesh::{Elements, TetMesh};
use crate::metric::{Source, Sym3};
use crate::tasks::{GRAIN, Team, stage};
use std::sync::{Mutex, PoisonError};

/// An adapted mesh in pieces.
pub struct Adapted<'a> {
    rounds: Rounds<'a>,
    numbering: Numbering,
    /// The boundary of the mesh with all that is listed of it, and no tetrahedra: its vertices are the first ones of the mesh.
    pub skin: Extracted,
}

/// Adapts a mesh by parts. `source` is as it was afterwards.
///
/// # Errors
/// Those of [`crate::adapt::adapt`], and where pieces cannot be kept.
pub fn adapt<'a>(
    common: Common<'a>,
    mesh: &TetMesh,
    place: &Classification,
    source: &mut Source,
) -> Result<Adapted<'a>, Error> {
    let team = Team::new(common.pool, common.options.plan);
    source.check(team, mesh).map_err(crate::adapt::Error::from)?;
    let complexity = source.complexity(team, mesh);
    let refs = References::of(team, mesh, place, common.model);
    let whole = (common.ranks.rank() == 0).then(|| {
        let logs = match source.logs_on(mesh) {
            Some(logs) => logs.to_vec(),
            None => team.map(GRAIN, mesh.vertices.len(), |v| source.log_at(mesh.vertices[v], &mut 0)),
        };
        Piece::whole(team, mesh, place, logs)
    });
    let mut rounds = Rounds::new(common, whole)?;
    rounds.run(source, team, complexity, mesh.vertices.len())?;
    stage("rounds");
    let mut numbering = rounds.numbering()?;
    let skin = skin(&mut numbering, &refs, &common);
    stage("vertices numbered");
    Ok(Adapted { rounds, numbering, skin })
}

/// The boundary as the kernel gives it, with the references of the input.
fn skin(numbering: &mut Numbering, refs: &References, common: &Common<'_>) -> Extracted {
    let Piece { mut mesh, place: classification, logs, .. } = std::mem::take(&mut numbering.skin);
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
    Extracted { mesh, classification, metrics, off_model, held, crossings: Default::default(), part: None }
}

/// Some of the whole mesh: vertices inside, and tetrahedra, each from a number on.
pub struct Slice {
    /// The number of the first vertex.
    pub first: usize,
    /// Coordinates.
    pub vertices: Vec<crate::mesh::vector::Vec3>,
    /// References.
    pub vertex_refs: Vec<i32>,
    /// M.
    pub metrics: Vec<Sym3>,
    /// The number of the first tetrahedron.
    pub first_tet: usize,
    /// Tetrahedra, by the numbers of the whole mesh.
    pub tets: Elements<4>,
}

impl Slice {
    fn of(piece: Piece, numbers: &Numbers) -> Self {
        let Numbers { numbers, written, first, first_tet } = numbers;
        let mut tets = piece.mesh.tets;
        tets.nodes.iter_mut().flatten().for_each(|v| *v = numbers[*v as usize]);
        Self {
            first: *first,
            vertices: written.iter().map(|&v| piece.mesh.vertices[v as usize]).collect(),
            vertex_refs: written.iter().map(|&v| piece.mesh.vertex_refs[v as usize]).collect(),
            metrics: written.iter().map(|&v| piece.logs[v as usize].exp()).collect(),
            first_tet: *first_tet,
            tets,
        }
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

    /// Vertices and tetrahedra.
    pub fn size(&self) -> [usize; 2] {
        [self.numbering.vertices(), self.numbering.tets()]
    }

    /// Calls f with each slice of this rank, on all threads.
    ///
    /// # Errors
    /// That of f, and where a piece cannot be read.
    pub fn for_each_slice(&self, f: impl Fn(Slice) -> Result<(), Error> + Sync) -> Result<(), Error> {
        self.rounds.for_each_finished(|at, piece| {
            let numbers = self.numbering.of_piece(at, &piece);
            f(Slice::of(piece, &numbers))
        })
    }

    /// The whole mesh in memory, as the kernel gives it.
    ///
    /// # Errors
    /// Where a piece cannot be read.
    pub fn into_memory(mut self, team: Team<'_>) -> Result<crate::adapt::Adapted, Error> {
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
        let faces = crate::mesh::adjacency::MatchedFaces::of(team, &mesh.tets.nodes);
        self.skin.crossings = crate::mesh::crossing::of_boundary(team, mesh, &faces, 3);
        let Done { work, growth_end, unrepaired, deviating, geometry } = self.rounds.done;
        stage("pieces joined");
        Ok(crate::adapt::Adapted { extracted: self.skin, work, growth_end, unrepaired, deviating, geometry })
    }
}
