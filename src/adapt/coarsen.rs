//! Coarsening before the store is filled: where the metric asks for far fewer vertices, whole neighbourhoods go onto one vertex at once.
//!
//! The mesh is mapped onto itself: some vertices stay, each of the others goes onto a neighbour that stays, and tetrahedra of which two
//! vertices meet vanish. The boundary is mapped onto itself, so the map covers the domain once. Where all tetrahedra that are left are
//! positive, they therefore fill the domain without overlap, and their faces match.
//! A curved boundary may then pass through another part of itself across a void: there the new triangles are tested ([`apart`]).
//!
//! Neighbours need not be known, and only some words a vertex and the result are written. A round passes through the memory a few times;
//! thinning vertex by vertex passes through it for each sixth of the vertices.
mod apart;
mod level;
mod repair;
mod rounds;
mod surface;
#[cfg(test)]
mod tests;
mod vertex_map;

use crate::adapt::core::fill::Known;
use crate::adapt::core::required::Required;
use crate::geometry::classify::Classification;
use crate::mesh::predicate::is_positive;
use crate::mesh::vector::volume6;
use crate::mesh::{Elements, TetMesh};
use crate::metric::{Source, Sym3};
use crate::tasks::{GRAIN, Team, stage};
use level::Level;
use std::borrow::Cow;

/// A mesh with this many times the tetrahedra that the metric asks for is coarsened.
const CROWDED: f64 = 4.0;

/// A round that removes less than this share of the vertices is the last. Thinning removes the rest as fast.
const LITTLE: f64 = 0.6;

/// A coarse mesh with what filling a store needs.
pub struct Coarse {
    /// Vertices, triangles and tetrahedra.
    pub mesh: TetMesh,
    /// Where they lie on the model.
    pub place: Classification,
    /// ln M at the vertices.
    pub logs: Vec<Sym3>,
    /// For each vertex a tetrahedron of the input that has it.
    pub hints: Vec<u32>,
    /// For each vertex its number in the input.
    pub origin: Vec<u32>,
}

impl Coarse {
    /// What filling a store may know of it.
    pub fn known(&self) -> Known<'_> {
        Known { logs: Some(&self.logs), hints: Some(&self.hints), is_part: false }
    }
}

/// The mesh made coarse, by the metric of `source`; ln M at the vertices may be known. None where it is not much too fine, or not valid.
pub fn coarsened(
    team: Team<'_>,
    mesh: &TetMesh,
    place: &Classification,
    source: &Source,
    required: &Required,
    logs: Option<&[Sym3]>,
) -> Option<Coarse> {
    let logs = match logs.or_else(|| source.logs_on(mesh)) {
        Some(logs) => Cow::Borrowed(logs),
        None => Cow::Owned(team.map(GRAIN, mesh.vertices.len(), |v| source.log_at(mesh.vertices[v], &mut 0))),
    };
    if !is_crowded(team, mesh, &logs) {
        return None;
    }
    let mut level = Level::of(team, mesh, place, logs, required);
    let mut hints = Vec::new();
    loop {
        let before = level.points.len();
        let balls = level.balls(team);
        if hints.is_empty() {
            hints = balls.firsts();
        }
        level = level.coarser(team, &balls);
        if (before - level.points.len()) as f64 <= LITTLE * before as f64 {
            break;
        }
    }
    stage("coarsened");
    Some(finish(level, mesh, place, &hints))
}

/// Whether the mesh is valid and has several times the tetrahedra that the metric asks for.
fn is_crowded(team: Team<'_>, mesh: &TetMesh, logs: &[Sym3]) -> bool {
    let quarters = team.map(GRAIN, logs.len(), |v| (0.125 * logs[v].trace()).exp());
    // None as soon as one is not positive.
    let parts = team.chunks(GRAIN, mesh.tets.len(), |range| {
        let mut sum = 0.0;
        for nodes in &mesh.tets.nodes[range] {
            let points = nodes.map(|v| mesh.vertices[v as usize]);
            if !is_positive(points) {
                return None;
            }
            let [a, b, c, d] = points;
            sum += volume6(a, b, c, d) * nodes.iter().map(|&v| quarters[v as usize]).product::<f64>();
        }
        Some(sum)
    });
    let Some(sum) = parts.into_iter().sum::<Option<f64>>() else { return false };
    // Six times the volume of a regular tetrahedron of unit edges is 1/√2.
    mesh.tets.len() as f64 > CROWDED * std::f64::consts::SQRT_2 * sum
}

/// The last level as a mesh with its place.
fn finish(level: Level, mesh: &TetMesh, place: &Classification, hints: &[u32]) -> Coarse {
    let Level { points, logs, origin, tets, regions, triangles, triangle_origin, .. } = level;
    let mut number = vec![u32::MAX; mesh.vertices.len()];
    origin.iter().zip(0..).for_each(|(&old, new)| number[old as usize] = new);
    let of_vertices = |old: &u32| *old as usize;
    let place = Classification {
        entities: origin.iter().map(|v| place.entities[of_vertices(v)]).collect(),
        parameters: origin.iter().map(|v| place.parameters[of_vertices(v)]).collect(),
        projected: origin.iter().map(|v| place.projected[of_vertices(v)]).collect(),
        ridges: place.ridges.iter().map(|&(ends, curve)| (ends.map(|v| number[v as usize]), curve)).collect(),
        faces: triangle_origin.iter().map(|&t| place.faces[t as usize]).collect(),
    };
    let refs = triangle_origin.iter().map(|&t| mesh.triangles.refs[t as usize]).collect();
    let mesh = TetMesh {
        vertices: points.into_owned(),
        vertex_refs: origin.iter().map(|v| mesh.vertex_refs[of_vertices(v)]).collect(),
        triangles: Elements { nodes: triangles.into_owned(), refs },
        tets: Elements { nodes: tets.into_owned(), refs: regions.into_owned() },
        ..TetMesh::default()
    };
    let hints = origin.iter().map(|v| hints[of_vertices(v)]).collect();
    Coarse { mesh, place, logs: logs.into_owned(), hints, origin }
}
