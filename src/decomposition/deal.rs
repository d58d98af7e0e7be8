//! Each part gets its share of each piece, on whatever rank they are.
use super::Error;
use super::bytes::{decoded, encoded, put, take};
use super::cuts::Cuts;
use super::journal::{PartDone, read_done};
use super::rounds::{Became, Common, KEY, Rounds};
use super::shelf::Key;
use super::split::split;
use super::threads::{Shared, add, on_threads, sorted};

/// The owner of a part that is done.
const NOBODY: u32 = u32::MAX;

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

    /// Gives each part its share of each active piece. Returns the parts of this rank, each with the pieces that it has a share of.
    pub fn deal(
        &self,
        round: u32,
        cuts: &Cuts,
        log_factor: f64,
        owners: &[u32],
    ) -> Result<Vec<(u32, Vec<u32>)>, Error> {
        let Common { shelf, ranks, .. } = self.common;
        let (own, parts) = (ranks.rank() as u32, owners.len());
        let (kept, sent) = (Shared::default(), Shared::default());
        let mine: Vec<Became> =
            self.active.pieces.iter().copied().filter(|piece| piece.rank == own && piece.tets > 0).collect();
        let threads = self.at_once(mine.iter().map(|piece| piece.vertices as f64).fold(0.0, f64::max) * 0.4);
        let dealt = on_threads(threads, mine.len(), |at| {
            let of = mine[at].part;
            let mut piece = shelf.take(Key::Active { round: self.active.round, part: of })?;
            piece.scale(log_factor);
            let shares = if parts == 1 { vec![piece] } else { split(&piece, &cuts.owners(&piece), parts, |_, _| true) };
            for (share, part) in shares.into_iter().zip(0..).filter(|(share, _)| share.len() > 0) {
                match owners[part as usize] {
                    NOBODY => {}
                    rank if rank == own => {
                        shelf.put(Key::Share { round, part, of }, share)?;
                        add(&kept, (part, of));
                    }
                    rank => add(&sent, ((of, part), rank, encoded(&share))),
                }
            }
            Ok(())
        });
        self.agreed(dealt)?;
        let messages = sorted(sent, |(key, ..)| *key).into_iter().map(|((of, part), rank, mut bytes)| {
            put(&mut bytes, &[part, of]);
            (rank as usize, bytes)
        });
        let received = ranks.exchange(messages.collect()).into_iter().try_for_each(|(_, bytes)| {
            let (share, key) = bytes.split_at_checked(bytes.len().wrapping_sub(KEY)).ok_or(Error::Message)?;
            let [part, of]: [u32; 2] = take(&mut &*key).and_then(|key| key.try_into().ok()).ok_or(Error::Message)?;
            shelf.put(Key::Share { round, part, of }, decoded(share).ok_or(Error::Message)?)?;
            add(&kept, (part, of));
            Ok(())
        });
        self.agreed(received)?;
        let kept = sorted(kept, |key| *key);
        let by_part = kept.chunk_by(|a, b| a.0 == b.0).map(|same| (same[0].0, same.iter().map(|key| key.1).collect()));
        Ok(by_part.collect())
    }
}
