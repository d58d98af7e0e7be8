//! The boundary of the tetrahedra as a surface: closed, manifold, nowhere through itself.
use super::super::adjacency::{NONE, sorted2};
use super::super::vector::Vec3;
use super::super::{Flaw, FlawKind, Offender, crossing};
use super::{Found, Keyed, NAMED};
use crate::tasks::{GRAIN, Team};

/// A face of one tetrahedron.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct BoundaryFace {
    /// Its first triangle, or [`NONE`].
    pub triangle: u32,
    /// Nodes, so that the normal points outwards.
    pub nodes: [u32; 3],
}

/// The boundary of the tetrahedra is a surface: two faces at every edge. More may meet on a tagged edge, where bodies touch. Interior
/// surfaces may end anywhere and meet in any number, so they do not count.
pub(super) fn check_edges(team: Team<'_>, found: &mut Found, boundary: &[BoundaryFace], tagged: &[Keyed<2>]) {
    let mut edges = Vec::with_capacity(3 * boundary.len());
    edges.extend(
        boundary.iter().flat_map(|&BoundaryFace { nodes: [a, b, c], .. }| [[a, b], [b, c], [a, c]].map(sorted2)),
    );
    team.sort(&mut edges);
    for same in edges.chunk_by(|a, b| a == b) {
        let legal =
            same.len() == 2 || same.len() % 2 == 0 && tagged.binary_search_by_key(&same[0], |edge| edge.0).is_ok();
        if !legal {
            found.add(FlawKind::NonManifoldEdge, None, &same[0]);
        }
    }
}

/// The boundary does not pass through itself. (Triangles inside cannot cross, since the tetrahedra on both sides are positive.)
///
/// # Errors
/// Those of `points`.
pub(super) fn crossings<E>(
    team: Team<'_>,
    mut boundary: Vec<BoundaryFace>,
    points: impl Fn(&[u32]) -> Result<Vec<Vec3>, E>,
) -> Result<Option<Flaw>, E> {
    boundary.sort_unstable();
    // Numbers of their own in the same order: tables over the vertices are as long as the boundary has some.
    let mut known: Vec<u32> = boundary.iter().flat_map(|face| face.nodes).collect();
    team.sort(&mut known);
    known.dedup();
    known.shrink_to_fit();
    let points = points(&known)?;
    let number = |v: u32| known.binary_search(&v).unwrap_or_default() as u32;
    let nodes = team.map(GRAIN, boundary.len(), |face| boundary[face].nodes.map(number));
    let crossings = crossing::crossings(team, &nodes, |v| points[v as usize], NAMED);
    if crossings.count == 0 {
        return Ok(None);
    }
    let first = crossings.first.into_iter().map(|crossing| {
        let [a, b] = crossing.triangles.map(|i| &boundary[i]);
        let index = |face: &BoundaryFace| (face.triangle != NONE).then_some(face.triangle as usize);
        Offender { index: index(a), other: index(b), nodes: [a.nodes, b.nodes].concat(), at: crossing.at }
    });
    Ok(Some(Flaw { kind: FlawKind::CrossingTriangles, count: crossings.count, first: first.collect() }))
}
