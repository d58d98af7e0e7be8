//! A mesh that is adapted part by part, written by slices: each process measures its pieces and writes them to the same two files.
use crate::cli::files::{Begun, Slices, Written};
use crate::decomposition::{self, Adapted, Measured, NearCuts};
use crate::mesh::TetMesh;
use crate::metric::Sym3;
use crate::metric::statistics::Statistics;
use crate::ranks::{Ranks, agree, broadcast};
use crate::tasks::Team;
use std::sync::{Mutex, PoisonError};

type Failure = Box<dyn std::error::Error>;

/// The error of any rank.
fn agreed<T>(ranks: &dyn Ranks, own: Result<T, Failure>) -> Result<T, Failure> {
    if ranks.count() == 1 {
        return own;
    }
    Ok(agree(ranks, own.map_err(|error| error.to_string()))?)
}

/// What rank 0 does: it has begun the files, writes what the boundary lists too, and ends with the figures of the whole mesh, in whole files.
/// Collective, also where they could not be begun.
///
/// # Errors
/// Where a file cannot be written, by any rank.
pub fn write(
    ranks: &dyn Ranks,
    team: Team<'_>,
    adapted: &Adapted<'_>,
    begun: Result<(Slices, Begun), Failure>,
    (skin, metrics): (&TetMesh, &[Sym3]),
) -> Result<(Statistics, NearCuts), Failure> {
    let message = begun.and_then(|(slices, begun)| Ok((slices, serde_json::to_vec(&begun)?)));
    let (slices, message) = agreed(ranks, message)?;
    broadcast(ranks, &message);
    agreed(ranks, Ok(()))?;
    let listed = slices.put_listed(team, skin, metrics);
    let own = listed.and_then(|()| put(adapted, &slices, Measured::of(team, skin, metrics)));
    let mut measured = agreed(ranks, own)?;
    // Of each rank which rows it has written, and what it has measured.
    let received = ranks.exchange(Vec::new());
    for [(_, rows), (_, figures)] in received.as_chunks().0 {
        let written: Written = serde_json::from_slice(rows)?;
        slices.add_written(&written)?;
        measured.add_encoded(figures)?;
    }
    slices.finish()?;
    Ok(measured.statistics())
}

/// What the others do. Collective.
///
/// # Errors
/// As of [`write`].
pub fn help(ranks: &dyn Ranks, adapted: &Adapted<'_>) -> Result<(), Failure> {
    agreed(ranks, Ok(()))?;
    let begun = broadcast(ranks, &[]);
    let joined = serde_json::from_slice(&begun).map_err(Failure::from).and_then(|begun| Slices::join(&begun));
    let slices = agreed(ranks, joined)?;
    let own = put(adapted, &slices, Measured::default()).and_then(|measured| {
        let written: Written = slices.leave()?;
        Ok(vec![(0, serde_json::to_vec(&written)?), (0, measured.encoded())])
    });
    ranks.exchange(agreed(ranks, own)?);
    Ok(())
}

/// Writes and measures the slices of this rank.
fn put(adapted: &Adapted<'_>, slices: &Slices, measured: Measured) -> Result<Measured, Failure> {
    let measured = Mutex::new(measured);
    adapted.for_each_slice(|mut slice| {
        slices.put(&slice).map_err(|error| decomposition::Error::Told(error.to_string()))?;
        measured.lock().unwrap_or_else(PoisonError::into_inner).add(&mut slice);
        Ok(())
    })?;
    Ok(measured.into_inner().unwrap_or_else(PoisonError::into_inner))
}
