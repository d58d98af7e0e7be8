//! Whether a mesh is valid: positive tetrahedra, a closed manifold boundary that has its triangles, nothing twice, nothing loose.
//!
//! Tetrahedra are checked one by one ([`check_tet`]), and all that has to do with neighbours at the vertices ([`Stars`]): so a mesh that is
//! larger than memory can be checked piece by piece. [`conclude`] joins what was found and checks the boundary.
mod boundary;
mod found;
mod stars;
#[cfg(test)]
mod tests;

pub use boundary::BoundaryFace;
pub use found::Found;
pub use stars::{OfStars, Stars};

use super::adjacency::{sorted2, sorted3};
use super::predicate::orientation;
use super::vector::Vec3;
use super::{Elements, Flaw, FlawKind, TetMesh};
use crate::tasks::{GRAIN, Team};
use serde::Serialize;
use std::convert::Infallible;

/// Most flaws of a kind that are named.
const NAMED: usize = 3;

/// The result of [`check`].
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Validity {
    /// Kinds of flaws found; none in a valid mesh.
    pub flaws: Vec<Flaw>,
}

impl Validity {
    /// Whether nothing is wrong.
    pub fn is_valid(&self) -> bool {
        self.flaws.is_empty()
    }

    /// How often a kind of flaw was found.
    pub fn count(&self, kind: FlawKind) -> usize {
        self.flaws.iter().find(|flaw| flaw.kind == kind).map_or(0, |flaw| flaw.count)
    }
}

/// Checks a mesh whose indices are in range.
pub fn check(mesh: &TetMesh) -> Validity {
    check_on(Team::alone(), mesh)
}

/// As [`check`], with threads.
pub fn check_on(team: Team<'_>, mesh: &TetMesh) -> Validity {
    let at = |v: u32| mesh.vertices[v as usize];
    let tets = team.chunks(GRAIN, mesh.tets.len(), |range| {
        let mut found = Found::default();
        range.for_each(|t| check_tet(&mut found, t, mesh.tets.nodes[t], mesh.tets.nodes[t].map(at)));
        found
    });
    let tets = tets.into_iter().fold(Found::default(), Found::and);
    let tagged = Tagged::of(team, &mesh.triangles, &mesh.edges);
    let (stars, _) = Stars::whole(mesh).check(team, &tagged, &(), |(), _| {});
    let points = |nodes: &[u32]| Ok::<_, Infallible>(team.map(GRAIN, nodes.len(), |k| at(nodes[k])));
    match conclude(team, tets, &mesh.triangles.nodes, &tagged, stars, points) {
        Ok(validity) => validity,
        Err(never) => match never {},
    }
}

/// Sorted nodes of an element, and its index.
pub type Keyed<const N: usize> = ([u32; N], u32);

/// Triangles and tagged edges of a mesh by their sorted nodes, in ascending order.
pub struct Tagged {
    /// The triangles.
    pub triangles: Vec<Keyed<3>>,
    /// The tagged edges.
    pub edges: Vec<Keyed<2>>,
}

impl Tagged {
    /// Those of a mesh.
    pub fn of(team: Team<'_>, triangles: &Elements<3>, edges: &Elements<2>) -> Self {
        let mut triangles = triangles.nodes.iter().map(|&nodes| sorted3(nodes)).zip(0..).collect();
        let mut edges = edges.nodes.iter().map(|&nodes| sorted2(nodes)).zip(0..).collect();
        team.sort(&mut triangles);
        team.sort(&mut edges);
        Self { triangles, edges }
    }
}

fn repeats<const N: usize>(nodes: &[u32; N]) -> bool {
    (1..N).any(|i| nodes[..i].contains(&nodes[i]))
}

/// Checks a tetrahedron by itself: different nodes, and positive.
pub fn check_tet(found: &mut Found, tet: usize, nodes: [u32; 4], [a, b, c, d]: [Vec3; 4]) {
    if repeats(&nodes) {
        return found.add(FlawKind::RepeatedNodes, Some(tet), &nodes);
    }
    let sign = orientation(a, b, c, d);
    if sign < 0.0 {
        found.add(FlawKind::InvertedTet, Some(tet), &nodes);
    } else if sign.is_nan() || sign == 0.0 {
        found.add(FlawKind::FlatTet, Some(tet), &nodes);
    }
}

/// Joins what was found at the tetrahedra one by one and at the vertices ([`Stars`], all of them), and checks the triangles and the boundary.
/// `points` gives the coordinates of vertices, which it is given in ascending order.
///
/// # Errors
/// Those of `points`.
pub fn conclude<E>(
    team: Team<'_>,
    tets: Found,
    triangles: &[[u32; 3]],
    tagged: &Tagged,
    stars: OfStars,
    points: impl Fn(&[u32]) -> Result<Vec<Vec3>, E>,
) -> Result<Validity, E> {
    let OfStars { twice, faces, edges, vertices, boundary } = stars;
    let mut found = tets.and(twice);
    check_triangles(&mut found, triangles, &tagged.triangles);
    found = found.and(faces);
    boundary::check_edges(team, &mut found, &boundary, &tagged.edges);
    found = found.and(edges).and(vertices);
    // Where tetrahedra are inverted or flat there is no outside.
    let hinders = [FlawKind::RepeatedNodes, FlawKind::InvertedTet, FlawKind::FlatTet];
    let has_outside = hinders.into_iter().all(|kind| found.count(kind) == 0);
    let mut validity = found.located(&points)?;
    if has_outside {
        validity.flaws.extend(boundary::crossings(team, boundary, points)?);
    }
    Ok(validity)
}

/// Triangles by themselves and against each other: all equal ones but the first of each are too many.
fn check_triangles(found: &mut Found, triangles: &[[u32; 3]], sorted: &[Keyed<3>]) {
    for (t, nodes) in triangles.iter().enumerate() {
        if repeats(nodes) {
            found.add(FlawKind::RepeatedNodes, Some(t), nodes);
        }
    }
    for pair in sorted.windows(2) {
        if pair[0].0 == pair[1].0 {
            let second = pair[1].1 as usize;
            found.add(FlawKind::DuplicateTriangle, Some(second), &triangles[second]);
        }
    }
}
