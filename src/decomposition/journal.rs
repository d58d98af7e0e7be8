//! What is known after a round, beside the pieces: enough to go on from there when the run is killed.
use super::Error;
use super::bytes::{put, take};
use super::cuts::{Sample, Tree};
use super::ground::Block;
use super::part::Done;
use super::rounds::Became;
use super::shelf::{self, JOURNAL, Key, Shelf};
use super::times::Told;
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::{Path, PathBuf};

/// What is known after a round.
#[derive(Serialize, Deserialize)]
pub struct Journal {
    /// Of what is adapted, and how: another run's pieces are of no use.
    pub run: u64,
    /// The round.
    pub round: u32,
    /// How many steps of the plan are done.
    pub steps: usize,
    /// The first id that is free.
    pub next_id: u64,
    /// The finished pieces.
    pub finished: Vec<Key>,
    /// What came of all parts.
    pub done: Done,
    /// What each round did.
    pub told: Vec<Told>,
    /// The cuts of the last round of growth, and of those after.
    pub former: Vec<(u32, Tree)>,
}

/// The file with what parts became and the samples of their tetrahedra.
fn parts(folder: &Path, round: u32) -> PathBuf {
    folder.join(format!("r{round:02}.parts"))
}

/// The long lists of what is known after a round.
pub struct Lists {
    /// What is not finished.
    pub pieces: Vec<Became>,
    /// Samples of it.
    pub samples: Vec<Sample>,
    /// The blocks of the metric.
    pub blocks: Vec<Block>,
}

impl Journal {
    /// Writes it, after all pieces that it speaks of.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn write(
        &self,
        folder: &Path,
        (pieces, samples, blocks): (&[Became], &[Sample], &[Block]),
    ) -> Result<(), Error> {
        let mut bytes = Vec::new();
        put(&mut bytes, pieces);
        put(&mut bytes, samples);
        put(&mut bytes, blocks);
        shelf::write(&parts(folder, self.round), &bytes)?;
        let text = serde_json::to_vec(self).map_err(|_| Error::Message)?;
        shelf::write(&folder.join(JOURNAL), &text)?;
        if let Some(before) = self.round.checked_sub(1) {
            drop(fs::remove_file(parts(folder, before)));
        }
        Ok(())
    }

    /// The journal of a run in its scratch folder; none where there is none, or another run's.
    pub fn read(shelf: &Shelf, run: u64) -> Option<(Self, Lists)> {
        let Shelf::Disk(folder) = shelf else { return None };
        let journal: Self = serde_json::from_slice(&fs::read(folder.join(JOURNAL)).ok()?).ok()?;
        if journal.run != run {
            return None;
        }
        let bytes = fs::read(parts(folder, journal.round)).ok()?;
        let mut from = &bytes[..];
        let lists = Lists { pieces: take(&mut from)?, samples: take(&mut from)?, blocks: take(&mut from)? };
        Some((journal, lists))
    }
}

/// Writes what a part became in a round, after its pieces: a run that goes on need not adapt it again.
///
/// # Errors
/// When the disk refuses.
pub fn write_done(shelf: &Shelf, round: u32, done: &PartDone) -> Result<(), Error> {
    let Shelf::Disk(folder) = shelf else { return Ok(()) };
    Ok(shelf::write(&folder.join(format!("r{round:02}-p{:05}.done", done.0.part)), &encoded(done)?)?)
}

/// What a part became in a round, if that is done.
pub fn read_done(shelf: &Shelf, round: u32, part: u32) -> Option<PartDone> {
    let Shelf::Disk(folder) = shelf else { return None };
    let bytes = fs::read(folder.join(format!("r{round:02}-p{part:05}.done"))).ok()?;
    decoded(&mut &bytes[..])
}

/// What a part became, samples of its tetrahedra, and what came of it beside.
pub type PartDone = (Became, Vec<Sample>, Done);

/// As bytes.
///
/// # Errors
/// None that is known.
pub fn encoded((became, samples, done): &PartDone) -> Result<Vec<u8>, Error> {
    let mut bytes = Vec::new();
    put(&mut bytes, &[*became]);
    put(&mut bytes, samples);
    put(&mut bytes, &serde_json::to_vec(done).map_err(|_| Error::Message)?);
    Ok(bytes)
}

/// From the front of some bytes.
pub fn decoded(from: &mut &[u8]) -> Option<PartDone> {
    let [became]: [Became; 1] = take(from)?.try_into().ok()?;
    let samples = take(from)?;
    let done = serde_json::from_slice(&take::<u8>(from)?).ok()?;
    Some((became, samples, done))
}
