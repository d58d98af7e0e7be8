//! Each part gets its share of each piece, on whatever rank they are.
use super::Error;
use super::bytes::{decoded, encoded, put, take};
use super::cuts::Cuts;
use super::journal::{PartDone, read_done};
use super::piece::Piece;
use super::region::Region;
use super::rounds::{Became, Common, Rounds};
use super::shelf::Key;
use super::split::split;
use super::threads::{Shared, add, on_threads, sorted};
use crate::mesh::vector::Vec3;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// Bytes behind a share that is sent, which say what it is.
const KEY: usize = 24;

/// The owner of a part that is done.
pub const NOBODY: u32 = u32::MAX;

/// The parts of a rank, ascending, each with the pieces that it has a share of.
pub type Dealt = Vec<(u32, Vec<u32>)>;

impl Rounds<'_> {
    /// The rank of each part: the heaviest first, each to the rank with the least work so far.
    pub fn owners(&self, parts: usize, work: &[f64]) -> Vec<u32> {
        let mut order: Vec<usize> = (0..parts).collect();
        order.sort_by(|&a, &b| work[b].total_cmp(&work[a]).then(a.cmp(&b)));
        let mut load = vec![0.0; self.common.ranks.count()];
        let mut owners = vec![0; parts];
        for part in order {
            let least = (0..load.len()).min_by(|&a, &b| f64::total_cmp(&load[a], &load[b])).unwrap_or(0);
            load[least] += work[part];
            owners[part] = least as u32;
        }
        owners
    }

    /// The owners of the parts that are not done yet, and what a run that was ended has left of the others: those of this rank.
    pub fn without_done(&self, round: u32, mut owners: Vec<u32>) -> (Vec<u32>, Shared<PartDone>) {
        let (list, own) = (Shared::default(), self.common.ranks.rank() as u32);
        for (owner, part) in owners.iter_mut().zip(0..) {
            if let Some((became, samples, done)) = read_done(self.common.shelf, round, part) {
                if *owner == own {
                    add(&list, (Became { rank: own, ..became }, samples, done));
                }
                *owner = NOBODY;
            }
        }
        (owners, list)
    }

    /// Gives each part its share of each active piece. Returns the parts of this rank, each with the pieces that it has a share of; and where the
    /// shares lie that this rank gave, if the cuts tell in which `boxes` the parts are.
    pub fn deal(
        &self,
        round: u32,
        cuts: &Cuts,
        log_factor: f64,
        (owners, boxes): (&[u32], Option<&[[Vec3; 2]]>),
    ) -> Result<(Dealt, BTreeMap<u32, Region>), Error> {
        let Common { shelf, ranks, .. } = self.common;
        let (own, parts) = (ranks.rank() as u32, owners.len());
        let shares = Shares::new(self.common, owners);
        let regions: Mutex<BTreeMap<u32, Region>> = Mutex::default();
        let mine: Vec<Became> =
            self.active.pieces.iter().copied().filter(|piece| piece.rank == own && piece.tets > 0).collect();
        let threads = self.at_once(mine.iter().map(|piece| piece.vertices as f64).fold(0.0, f64::max) * 0.4);
        let dealt = on_threads(threads, mine.len(), |at| {
            let of = mine[at].part;
            let mut piece = shelf.take(Key::Active { round: self.active.round, part: of })?;
            piece.scale(log_factor);
            let dealt = if parts == 1 { vec![piece] } else { split(&piece, &cuts.owners(&piece), parts, |_, _| true) };
            for (share, part) in dealt.into_iter().zip(0..).filter(|(share, _)| share.len() > 0) {
                if let Some(boxes) = boxes {
                    let mut regions = regions.lock().unwrap_or_else(PoisonError::into_inner);
                    regions.entry(part).or_insert_with(|| Region::new(boxes[part as usize])).add(&share);
                }
                shares.give(Key::Share { round, part, of }, share)?;
            }
            Ok(())
        });
        self.agreed(dealt)?;
        let kept = self.agreed(shares.exchange())?;
        let parts = kept.iter().filter_map(|key| match key {
            Key::Share { part, of, .. } => Some((*part, *of)),
            _ => None,
        });
        let parts: Vec<(u32, u32)> = parts.collect();
        let by_part = parts.chunk_by(|a, b| a.0 == b.0).map(|same| (same[0].0, same.iter().map(|key| key.1).collect()));
        Ok((by_part.collect(), regions.into_inner().unwrap_or_else(PoisonError::into_inner)))
    }
}

/// Shares on the way to the parts that they are for.
pub struct Shares<'a> {
    common: Common<'a>,
    /// The rank of each part.
    owners: &'a [u32],
    kept: Shared<Key>,
    sent: Shared<(Key, u32, Vec<u8>)>,
}

impl<'a> Shares<'a> {
    /// None yet.
    pub fn new(common: Common<'a>, owners: &'a [u32]) -> Self {
        Self { common, owners, kept: Shared::default(), sent: Shared::default() }
    }

    /// Gives a share to its part, which is not done yet.
    pub fn give(&self, key: Key, share: Piece) -> Result<(), Error> {
        let Common { shelf, ranks, .. } = self.common;
        match self.owners[key.part() as usize] {
            NOBODY => {}
            rank if rank as usize == ranks.rank() => {
                shelf.put(key, share)?;
                add(&self.kept, key);
            }
            rank => add(&self.sent, (key, rank, encoded(&share))),
        }
        Ok(())
    }

    /// Sends what is for others, and puts away what they send. Returns all that has come to this rank, in order. Collective.
    pub fn exchange(self) -> Result<Vec<Key>, Error> {
        let Self { common: Common { shelf, ranks, .. }, kept, sent, .. } = self;
        let message = |(key, rank, mut bytes): (Key, u32, Vec<u8>)| {
            put(&mut bytes, &key.numbers());
            (rank as usize, bytes)
        };
        let messages = sorted(sent, |(key, ..)| *key).into_iter().map(message).collect();
        for (_, bytes) in ranks.exchange(messages) {
            let (share, key) = bytes.split_at_checked(bytes.len().wrapping_sub(KEY)).ok_or(Error::Message)?;
            let numbers: [u32; 4] = take(&mut &*key).and_then(|key| key.try_into().ok()).ok_or(Error::Message)?;
            let key = Key::of_numbers(numbers).ok_or(Error::Message)?;
            shelf.put(key, decoded(share).ok_or(Error::Message)?)?;
            add(&kept, key);
        }
        Ok(sorted(kept, |key| *key))
    }
}
