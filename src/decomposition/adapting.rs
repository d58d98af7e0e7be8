//! The parts of this rank are adapted: so many at once, on so many threads each.
use super::Error;
use super::ground::{Around, Ground};
use super::journal::PartDone;
use super::part::{Round, Tools, adapt_piece};
use super::piece::Piece;
use super::rounds::{Common, Rounds};
use super::shelf::Key;
use super::threads::{Shared, on_threads};
use super::times::Stopwatch;
use super::zones::divide;
use crate::adapt::{Observer, Options, Scheduler};
use crate::tasks::Pool;

/// From so many parts on, each is one thread's. Fewer are adapted in the way that gives the same mesh on any number of threads, and share
/// those of their rank.
const OF_ONE_THREAD: usize = 16;

/// Memory for a vertex that is being adapted, bytes.
const BYTES_A_VERTEX: f64 = 1_200.0;

/// What a part takes of a metric in blocks is so much of its own memory.
const GROUND: f64 = 0.6;

/// The observer of a part: it hears of an end alone.
struct Quiet<'a>(&'a Rounds<'a>);

impl Observer for Quiet<'_> {
    fn stop(&self) -> bool {
        self.0.ends()
    }
}

impl Rounds<'_> {
    /// How many parts of so many vertices may be in memory at once.
    pub fn at_once(&self, vertices: f64) -> usize {
        let threads = self.common.pool.threads();
        let Some(memory) = self.common.memory else { return threads };
        ((memory as f64 / (BYTES_A_VERTEX * vertices.max(1.0))) as usize).clamp(1, threads)
    }

    /// Adapts the parts of this rank, the first ones first, of so many in all.
    pub fn adapt_parts(
        &self,
        round: u32,
        (ground, around): (&Ground, &Around),
        (parts, mine): (usize, &[(u32, Vec<u32>)]),
        (is_zone, divides): (bool, bool),
        list: &Shared<PartDone>,
    ) -> Result<(), Error> {
        let Common { model, options, pool, shelf, observer, sizes, .. } = self.common;
        let is_shared = parts < OF_ONE_THREAD;
        let scheduler = if is_shared { Scheduler::Deterministic } else { Scheduler::Sequential };
        let options = Options { scheduler, is_draft: false, ..options.clone() };
        let quiet = Quiet(self);
        let beside = if ground.blocks().is_empty() { 1.0 } else { 1.0 + GROUND };
        let (threads, at_once) = (pool.threads(), self.at_once(beside * sizes.part).min(mine.len()).max(1));
        on_threads(at_once, mine.len(), |at| {
            // What is left over goes to the first, which are the heaviest.
            let own = if is_shared { threads / at_once + usize::from(at < threads % at_once) } else { 1 };
            let pool = &Pool::new(own).map_err(|error| Error::Told(error.to_string()))?;
            let watch = Stopwatch::start(own == 1);
            let (part, of) = &mine[at];
            let part = *part;
            let piece = self.joined(round, part, of)?;
            let under = ground.under(shelf, round, part, around)?;
            let source = under.source();
            let tools = Tools { model, source, refs: &self.refs, options: &options, pool, observer: &quiet };
            let first_id = self.next_id + (u64::from(part) << 33);
            let (piece, mut done) = adapt_piece(tools, piece, Round { is_zone, is_alone: parts == 1 }, first_id)?;
            of.iter().for_each(|&of| shelf.forget(Key::Share { round, part, of }));
            let pieces = if divides { divide(&piece) } else { [piece, Piece::default()] };
            done.seconds = watch.seconds();
            self.put_away((round, part, self.active.pieces.len()), pieces, done, list)?;
            observer.advance(1);
            Ok(())
        })
    }
}
