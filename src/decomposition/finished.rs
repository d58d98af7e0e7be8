//! The finished pieces of all ranks.
use super::Error;
use super::bytes::{decoded, encoded, put, take};
use super::outline::Outline;
use super::piece::Piece;
use super::rounds::{Common, Rounds};
use super::threads::{Shared, add, on_threads, sorted};

/// Bytes behind a piece that is sent, which say which one it is.
const KEY: usize = 16;

impl Rounds<'_> {
    /// What must be known of all finished pieces to number their vertices.
    ///
    /// # Errors
    /// Where a piece cannot be read.
    pub fn outlines(&self) -> Result<Vec<Outline>, Error> {
        let Common { shelf, ranks, .. } = self.common;
        let own = ranks.rank() as u32;
        let list = Shared::default();
        let outlined = on_threads(self.common.pool.threads(), self.finished.len(), |at| {
            let (key, rank) = self.finished[at];
            if rank == own {
                let piece = shelf.take(key)?;
                add(&list, (at as u64, Outline::of(&piece)));
                shelf.give_back(key, piece);
            }
            Ok(())
        });
        self.agreed(outlined)?;
        let mut bytes = Vec::new();
        for (at, outline) in sorted(list, |(at, _)| *at) {
            put(&mut bytes, &[at]);
            bytes.append(&mut outline.encoded());
        }
        let mut outlines = Vec::new();
        for from in ranks.gather(&bytes) {
            let mut from = &from[..];
            while !from.is_empty() {
                let at = take::<u64>(&mut from).ok_or(Error::Message)?;
                outlines.push((at, Outline::decoded(&mut from).ok_or(Error::Message)?));
            }
        }
        outlines.sort_by_key(|(at, _)| at[0]);
        Ok(outlines.into_iter().map(|(_, outline)| outline).collect())
    }

    /// Calls f with each finished piece of this rank and its place in the order of all, on all threads.
    ///
    /// # Errors
    /// That of f, and where a piece cannot be read.
    pub fn for_each_own(&self, f: impl Fn(usize, Piece) -> Result<(), Error> + Sync) -> Result<(), Error> {
        let Common { shelf, ranks, pool, .. } = self.common;
        let own: Vec<usize> =
            (0..self.finished.len()).filter(|&at| self.finished[at].1 as usize == ranks.rank()).collect();
        on_threads(pool.threads(), own.len(), |i| f(own[i], shelf.take(self.finished[own[i]].0)?))
    }

    /// Calls f on rank 0 with each finished piece of all ranks and its place in their order: on all threads where there is one rank, else one
    /// after the other. Collective.
    ///
    /// # Errors
    /// That of f, and where a piece cannot be read.
    pub fn for_each_finished(&self, f: impl Fn(usize, Piece) -> Result<(), Error> + Sync) -> Result<(), Error> {
        let Common { shelf, ranks, .. } = self.common;
        if ranks.count() == 1 {
            return self.for_each_own(f);
        }
        // One piece of each rank at a time.
        let mut of_rank = vec![Vec::new(); ranks.count()];
        self.finished.iter().zip(0..).for_each(|((key, rank), at)| of_rank[*rank as usize].push((*key, at)));
        let most = of_rank.iter().map(Vec::len).max().unwrap_or(0);
        for turn in 0..most {
            let own = of_rank[ranks.rank()].get(turn).map(|&(key, at)| Ok::<_, Error>((at, shelf.take(key)?)));
            let own = self.agreed(own.transpose())?;
            let message = |(at, piece): (usize, Piece)| {
                let mut bytes = encoded(&piece);
                put(&mut bytes, &[at as u64]);
                (0, bytes)
            };
            let received = ranks.exchange(own.into_iter().map(message).collect());
            let done = received.into_iter().try_for_each(|(_, bytes)| {
                let (piece, at) = bytes.split_at_checked(bytes.len().wrapping_sub(KEY)).ok_or(Error::Message)?;
                let [at]: [u64; 1] = take(&mut &*at).and_then(|at| at.try_into().ok()).ok_or(Error::Message)?;
                f(at as usize, decoded(piece).ok_or(Error::Message)?)
            });
            self.agreed(done)?;
        }
        Ok(())
    }
}
