//! The first pieces: the slices of the input, or where there are several, the blocks that these are cut into.
use super::Error;
use super::cuts::Cuts;
use super::ground::{self, Block};
use super::input::{Input, Skin, slices};
use super::part::Done;
use super::piece::Piece;
use super::rounds::{Common, Rounds};
use super::shelf::Key;
use super::threads::{Shared, add, on_threads, sorted};

impl Rounds<'_> {
    /// Reads the slices of the input, which become the first pieces.
    pub fn read(&mut self, input: &dyn Input, skin: &Skin<'_>) -> Result<(), Error> {
        let ranks = self.common.ranks;
        let slices = slices(input.size()[1], &self.common.sizes);
        let mine: Vec<usize> = (0..slices.len()).filter(|slice| slice % ranks.count() == ranks.rank()).collect();
        let list = Shared::default();
        let read = on_threads(self.at_once(self.common.sizes.part), mine.len(), |at| {
            let piece = skin.piece(input, slices[mine[at]].clone())?;
            self.put_away((0, mine[at] as u32, slices.len()), [piece, Piece::default()], Done::default(), &list)
        });
        self.agreed(read)?;
        self.become_active(0, list)
    }

    /// Cuts the input into blocks, where it has several slices. They become the pieces, and are returned as those of the metric if that
    /// `lies_on_it`.
    pub fn cut_ground(&mut self, vertices: usize, lies_on_it: bool) -> Result<Vec<Block>, Error> {
        if self.active.pieces.len() < 2 {
            return Ok(Vec::new());
        }
        let Common { sizes, shelf, ranks, pool, .. } = self.common;
        let cuts = Cuts::of(std::mem::take(&mut self.active.samples), sizes.parts(vertices as f64), pool.threads());
        let owners = self.owners(cuts.work.len(), &cuts.work);
        let (round, own) = (self.active.round + 1, ranks.rank() as u32);
        let (mine, _) = self.deal(round, &cuts, 0.0, (&owners, None))?;
        let (list, blocks) = (Shared::default(), Shared::default());
        let joined = on_threads(self.at_once(sizes.part), mine.len(), |at| {
            let (part, of) = &mine[at];
            let piece = self.joined(round, *part, of)?;
            if lies_on_it {
                add(&blocks, Block::of(*part, own, &piece));
                shelf.put(Key::Ground { block: *part }, ground::of_piece(&piece))?;
            }
            of.iter().for_each(|&of| shelf.forget(Key::Share { round, part: *part, of }));
            self.put_away((round, *part, owners.len()), [piece, Piece::default()], Done::default(), &list)
        });
        self.agreed(joined)?;
        let before = self.active.round;
        for piece in self.active.pieces.iter().filter(|piece| piece.rank == own) {
            shelf.forget(Key::Active { round: before, part: piece.part });
        }
        self.become_active(round, list)?;
        let own = sorted(blocks, |block| block.number);
        let mut all = Vec::new();
        for bytes in ranks.gather(bytemuck::cast_slice(&own)) {
            all.extend(bytemuck::pod_collect_to_vec::<u8, Block>(&bytes));
        }
        all.sort_by_key(|block| block.number);
        Ok(all)
    }
}
