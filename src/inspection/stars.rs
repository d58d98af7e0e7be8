//! What has to do with neighbours: range by range of the vertices, with all tetrahedra at them.
use super::points::{Source, length};
use super::{Error, Sizes};
use crate::mesh::ranges::{Blocks, Ranged, each_range};
use crate::mesh::validity::{OfStars, Stars, Tagged};
use crate::metric::Lengths;
use crate::tasks::Team;

/// Checks all vertices with their tetrahedra. Returns what is found, and the lengths of all edges.
pub(super) fn check(
    team: Team<'_>,
    source: &Source<'_>,
    sizes: &Sizes,
    blocks: &Blocks,
    tagged: &Tagged,
) -> Result<(OfStars, Lengths), Error> {
    let (mut found, mut lengths) = (OfStars::default(), source.lengths());
    each_range(team, source.mesh, blocks, sizes.range, |ranged| -> Result<_, Error> {
        let (stars, parts) = check_range(team, source, tagged, ranged)?;
        found.extend(stars);
        lengths = parts.into_iter().fold(std::mem::replace(&mut lengths, source.lengths()), Lengths::and);
        Ok(size_of_val(&found.boundary[..]))
    })?;
    Ok((found, lengths))
}

fn check_range(
    team: Team<'_>,
    source: &Source<'_>,
    tagged: &Tagged,
    ranged: &Ranged,
) -> Result<(OfStars, Vec<Lengths>), Error> {
    let Ranged { tets, tet_numbers, numbers, own } = ranged;
    let points = source.points(team, numbers)?;
    let metrics = source.metrics(team, numbers, &points)?;
    let stars = Stars { tets, tet_numbers: Some(tet_numbers), numbers: Some(numbers), own: own.clone() };
    Ok(stars.check(team, tagged, &source.lengths(), |lengths, edge| {
        lengths.add(length(edge, &points, metrics.as_deref()));
    }))
}
