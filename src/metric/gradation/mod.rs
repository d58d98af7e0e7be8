//! Gradation: sizes grow from vertex to vertex at a bounded rate. Mixed-space homogeneous (Alauzet 2010, §6.2.1; METHOD.md §1.7).
//!
//! For an edge pq with vector e the metric of p grows to q: G has the eigenvectors of M_p and the eigenvalues
//! λ_i · [(1 + √λ_i |e| ln r)^t (1 + L_p(e) ln r)^(1−t)]^(−2), t = 1/8; M_q ← M_q ∩ G, both ways, until nothing changes.
//!
//! [`front`] says which vertices tell their neighbours of their metrics, and when; [`edges`] what becomes of these. The metrics are in memory, or
//! in files (`metric::out_of_core`).
pub(super) mod edges;
pub(super) mod front;
mod growth;
mod in_memory;
mod measure;
#[cfg(test)]
mod tests;

use super::Sym3;
use crate::mesh::TetMesh;
use crate::mesh::vector::Vec3;
use crate::mesh::vertex_neighbours::VertexNeighbours;
use crate::tasks::Team;
use front::Front;
use in_memory::InMemory;
pub use measure::{Growths, measure};

/// An intersection that raises no eigenvalue by more than this share (a size by half of it) is no change. With 1e-6 a field of strong and
/// turning anisotropy takes half as many updates more, for sizes that no mesh can tell apart.
const TOLERANCE: f64 = 1e-3;

/// Changed sizes within this factor of the least one are one class.
const CLASS: f64 = 1.25;

/// Vertices a task: one takes a microsecond or two.
const FEW: usize = 1 << 8;

/// Words of 64 vertices a task of the search for targets. Most words are zero.
const WORDS: usize = 1 << 14;

/// What grading did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Graded {
    /// Rounds of the front.
    pub rounds: usize,
    /// Metrics that were replaced, in all rounds.
    pub updates: usize,
    /// Vertices that have another metric than before.
    pub changed: usize,
}

/// Grades ln M at the vertices, shape (n,), by a ratio r > 1, along the edges of the
/// tetrahedra, or of the triangles where there is no tetrahedron. Vertices without an edge stay as they are. So does, bit for bit, every
/// metric that is graded already.
///
/// # Panics
/// When there are not as many metrics as vertices.
pub fn grade(team: Team<'_>, mesh: &TetMesh, logs: &mut [Sym3], ratio: f64) -> Graded {
    grade_with(team, &mesh.vertices, &VertexNeighbours::of_mesh(team, mesh), logs, ratio)
}

/// As [`grade`], with the neighbours of the vertices along the edges.
///
/// # Panics
/// As [`grade`].
pub fn grade_with(
    team: Team<'_>,
    vertices: &[Vec3],
    around: &VertexNeighbours,
    logs: &mut [Sym3],
    ratio: f64,
) -> Graded {
    assert_eq!(vertices.len(), logs.len(), "one ln M a vertex");
    run(team, vertices, around, logs, ratio, |_, _| true)
}

/// As [`grade_with`], where all but the vertices from `first` on were graded together before the others came between them.
pub fn grade_added(
    team: Team<'_>,
    vertices: &[Vec3],
    around: &VertexNeighbours,
    logs: &mut [Sym3],
    (ratio, first): (f64, usize),
) -> Graded {
    let is_added = |v: u32| v as usize >= first;
    run(team, vertices, around, logs, ratio, |p, q| is_added(p) || is_added(q))
}

/// As [`grade_with`], where only the metrics of some vertices have become finer since all were graded.
pub fn grade_again(
    team: Team<'_>,
    vertices: &[Vec3],
    around: &VertexNeighbours,
    logs: &mut [Sym3],
    (ratio, finer): (f64, &[u32]),
) -> Graded {
    let mut is_finer = vec![false; logs.len()];
    finer.iter().for_each(|&v| is_finer[v as usize] = true);
    run(team, vertices, around, logs, ratio, |p, _| is_finer[p as usize])
}

/// Grades, where only edges from p to q that are `open` need to be looked at.
fn run(
    team: Team<'_>,
    vertices: &[Vec3],
    around: &VertexNeighbours,
    logs: &mut [Sym3],
    ratio: f64,
    is_open: impl Fn(u32, u32) -> bool + Sync,
) -> Graded {
    let count = logs.len();
    let Ok(graded) = Front::new(team, count, InMemory::new(team, vertices, around, logs, ratio.ln())).run(is_open);
    graded
}
