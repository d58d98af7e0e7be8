//! What is done when: the mesh grows in stages, each cut anew, and then the tetrahedra around former cuts are adapted until none is left.
//!
//! Where the cuts lie and what becomes of a part depends on the mesh alone. Which rank does it, how many parts are done at once and
//! where they lie meanwhile does not matter: every list is in the order of the parts.
use super::Error;
use super::cuts::{Cuts, Sample, Tree, samples};
use super::ground::{Block, Ground};
use super::input::{Input, Skin};
use super::join::join;
use super::journal::{self, Journal, Lists, PartDone, write_done};
use super::part::Done;
use super::piece::Piece;
use super::shelf::{Key, Shelf};
use super::sizes::{Sizes, growth, wanted_vertices};
use super::threads::{Shared, add, sorted};
use super::times::{Stopwatch, Told, ToldPart};
use crate::adapt::{Observer, Options, References};
use crate::geometry::Model;
use crate::metric::field::complexity_factor;
use crate::ranks::{Ranks, agree};
use crate::tasks::Pool;
use std::time::Instant;

/// Most tetrahedra that are asked where to cut.
const SAMPLES: usize = 1 << 18;

/// The least of a piece.
const LEAST_SAMPLES: usize = 1 << 10;

/// Most rounds around former cuts.
const MOST_ZONES: usize = 12;

/// What the parts of a run have in common.
#[derive(Clone, Copy)]
pub struct Common<'a> {
    /// The model.
    pub model: &'a Model,
    /// How to adapt; the scheduler does not count.
    pub options: &'a Options,
    /// How large parts are.
    pub sizes: Sizes,
    /// The threads.
    pub pool: &'a Pool,
    /// The processes.
    pub ranks: &'a dyn Ranks,
    /// Where pieces lie.
    pub shelf: &'a Shelf,
    /// Bytes of memory for all that is done at once, at the most.
    pub memory: Option<u64>,
    /// Is told of the progress.
    pub observer: &'a dyn Observer,
}

/// What a part became, as all ranks know it.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Became {
    /// Its number in the round.
    pub part: u32,
    /// The rank that has it.
    pub rank: u32,
    /// Tetrahedra that are not finished.
    pub tets: u64,
    /// Their vertices.
    pub vertices: u64,
    /// Vertices with those that are finished.
    pub all: u64,
    /// What it took, s.
    pub seconds: f64,
}

impl Became {
    /// For who asks what it took; `work` is what was expected of each part.
    fn told(&self, work: &[f64]) -> ToldPart {
        let Self { part, rank, tets: active_tets, vertices: active, all: vertices, seconds } = *self;
        let work = work.get(part as usize).copied().unwrap_or(0.0);
        ToldPart { rank, work, vertices, active, active_tets, seconds }
    }
}

/// The pieces of a round that are not finished, and samples of their tetrahedra, in the order of the parts.
#[derive(Default)]
pub struct Active {
    /// The round.
    pub round: u32,
    /// The pieces.
    pub pieces: Vec<Became>,
    /// The samples.
    pub samples: Vec<Sample>,
}

/// The rounds so far.
pub struct Rounds<'a> {
    /// What its parts have in common.
    pub common: Common<'a>,
    /// What came of them.
    pub done: Done,
    /// Each of them.
    pub told: Vec<Told>,
    /// The finished pieces and the ranks that have them.
    pub finished: Vec<(Key, u32)>,
    /// What is not finished.
    pub active: Active,
    /// The cuts of the last round of growth, and of those after.
    pub(super) former: Vec<(u32, Tree)>,
    /// The first id that is free.
    pub(super) next_id: u64,
    /// Steps of the plan that are done.
    steps: usize,
    /// What the run is known by.
    run: u64,
    /// The references of the mesh, with all triangles outwards.
    pub(super) refs: References,
    /// Vertices of the finished pieces.
    finished_vertices: u64,
    /// Whether the user has ended the run, on any rank: since the end of the last round all know it.
    is_ended: bool,
}

impl<'a> Rounds<'a> {
    /// Before the first, of an input and its skin. Or after those that are in the journal of a run of this name. Also the blocks of the metric,
    /// if it `lies_on_it` and is larger than a part.
    ///
    /// # Errors
    /// Where the input cannot be read, or put away.
    pub fn new(
        common: Common<'a>,
        run: u64,
        refs: References,
        (input, skin): (&dyn Input, &Skin<'_>),
        lies_on_it: bool,
    ) -> Result<(Self, Vec<Block>), Error> {
        let active = Active::default();
        let (done, told, finished, former) = (Done::default(), Vec::new(), Vec::new(), Vec::new());
        let (next_id, steps, finished_vertices, is_ended) = (1 << 40, 0, 0, false);
        let mut rounds = Self {
            common,
            done,
            told,
            finished,
            active,
            former,
            next_id,
            steps,
            run,
            refs,
            finished_vertices,
            is_ended,
        };
        if let Some(blocks) = rounds.goes_on() {
            return Ok((rounds, blocks));
        }
        if common.ranks.rank() == 0 {
            // What is there is of another run.
            common.shelf.clear();
        }
        rounds.agreed(Ok(()))?;
        rounds.read(input, skin)?;
        let blocks = rounds.cut_ground(input.size()[0], lies_on_it)?;
        rounds.note(&blocks)?;
        Ok((rounds, blocks))
    }

    /// A part put together from its shares.
    pub fn joined(&self, round: u32, part: u32, of: &[u32]) -> Result<Piece, Error> {
        let share = |&of: &u32| self.common.shelf.take(Key::Share { round, part, of });
        Ok(join(of.iter().map(share).collect::<Result<Vec<_>, _>>()?))
    }

    /// Goes on from the journal, if all ranks find the same one: the blocks of the metric.
    fn goes_on(&mut self) -> Option<Vec<Block>> {
        let found = Journal::read(self.common.shelf, self.run);
        let round = found.as_ref().map_or(u32::MAX, |(journal, ..)| journal.round);
        let rounds = self.common.ranks.gather(&round.to_ne_bytes());
        let (journal, lists) = found.filter(|_| rounds.iter().all(|other| *other == rounds[0]))?;
        let Lists { mut pieces, samples, mut blocks } = lists;
        let ranks = self.common.ranks.count() as u32;
        let Journal { round, steps, next_id, finished, done, told, former, .. } = journal;
        pieces.iter_mut().zip(0..).for_each(|(piece, at)| piece.rank = at % ranks);
        self.finished = finished.into_iter().zip(0..).map(|(key, at)| (key, at % ranks)).collect();
        self.active = Active { round, pieces, samples };
        blocks.iter_mut().zip(0..).for_each(|(block, at)| block.rank = at % ranks);
        (self.steps, self.next_id, self.done, self.told, self.former) = (steps, next_id, done, told, former);
        Some(blocks)
    }

    /// How many rounds were done before this run went on.
    pub fn rounds_before(&self) -> usize {
        self.told.len()
    }

    /// Writes the journal.
    fn note(&self, blocks: &[Block]) -> Result<(), Error> {
        let written = match (self.common.shelf, self.common.ranks.rank()) {
            (Shelf::Disk(folder), 0) => {
                let journal = Journal {
                    run: self.run,
                    round: self.active.round,
                    steps: self.steps,
                    next_id: self.next_id,
                    finished: self.finished.iter().map(|(key, _)| *key).collect(),
                    done: self.done.clone(),
                    told: self.told.clone(),
                    former: self.former.clone(),
                };
                let lists = (&self.active.pieces[..], &self.active.samples[..], blocks);
                journal.write(folder, lists)
            }
            _ => Ok(()),
        };
        self.agreed(written)
    }

    /// Makes a mesh of this complexity of `given` vertices. On return `ground` is as it was.
    ///
    /// # Errors
    /// Those of the kernel, and where pieces cannot be kept.
    pub fn run(
        &mut self,
        ground: &mut Ground,
        team: crate::tasks::Team<'_>,
        complexity: f64,
        given: usize,
    ) -> Result<(), Error> {
        let (wanted, given) = (wanted_vertices(complexity), given as f64);
        let sizes = self.common.sizes;
        let stages = growth(wanted, given, &sizes);
        let (mut present, mut scaled) = (given, 0.0);
        for (at, &share) in stages.iter().enumerate() {
            let log_factor = complexity_factor(1.0, share).ln();
            ground.scale(team, log_factor - scaled);
            if at >= self.steps {
                let parts = sizes.parts(present.max(share * wanted));
                let is_last = at + 1 == stages.len();
                self.round(ground, parts, log_factor - scaled, false, is_last)?;
            }
            (present, scaled) = (share * wanted, log_factor);
        }
        while self.steps < stages.len() + MOST_ZONES {
            let vertices: u64 = self.active.pieces.iter().map(|piece| piece.vertices).sum();
            if vertices == 0 || self.is_ended {
                break;
            }
            let before = self.told.last().map_or((1, 0.0), |told| (told.parts, told.vertices as f64));
            self.round(ground, sizes.zone_parts(vertices as f64, before), 0.0, true, true)?;
        }
        self.finish_all();
        Ok(())
    }

    /// Vertices of all pieces; one on several counts for each.
    fn vertices(&self) -> usize {
        let active: u64 = self.active.pieces.iter().map(|piece| piece.vertices).sum();
        active as usize + self.finished_vertices as usize
    }

    /// Whether the user has ended the run, as far as this rank knows.
    pub(super) fn ends(&self) -> bool {
        self.is_ended || self.common.observer.stop()
    }

    /// All ranks hear whether the run has ended on any of them.
    fn agree_on_end(&mut self) {
        self.is_ended = self.common.ranks.gather(&[u8::from(self.ends())]).contains(&vec![1]);
    }

    /// What is left is finished as it is.
    fn finish_all(&mut self) {
        let Active { round, pieces, .. } = std::mem::take(&mut self.active);
        let left = pieces.iter().filter(|piece| piece.tets > 0);
        self.finished.extend(left.map(|piece| (Key::Active { round, part: piece.part }, piece.rank)));
        self.finished.sort_unstable();
    }

    /// The error of any rank.
    pub fn agreed<T>(&self, result: Result<T, Error>) -> Result<T, Error> {
        if self.common.ranks.count() == 1 {
            return result;
        }
        agree(self.common.ranks, result.map_err(|error| error.to_string())).map_err(Error::Told)
    }

    /// Cuts what is active into parts, whose ln M grow by `log_factor`, and adapts each. In the last round of the stages, and in those after, what
    /// no cut has touched is finished.
    fn round(
        &mut self,
        ground: &Ground,
        parts: usize,
        log_factor: f64,
        is_zone: bool,
        divides: bool,
    ) -> Result<(), Error> {
        let (began, is_alone) = (Instant::now(), self.common.pool.threads() == 1);
        let watch = Stopwatch::start(true);
        let round = self.active.round + 1;
        let whole = Sample::box_of(&self.active.samples);
        let samples = std::mem::take(&mut self.active.samples);
        let cuts = Cuts::of(samples, parts, self.common.pool.threads());
        if divides && parts > 1 {
            self.former.push((round, cuts.tree.clone()));
        }
        let cutting = watch.seconds();
        let watch = Stopwatch::start(is_alone);
        let tets = self.active.pieces.iter().map(|piece| piece.tets as usize).sum();
        self.common.observer.begin(crate::adapt::Kind::Split, self.told.len(), parts);
        let owners = self.owners(parts, &cuts.work);
        let (owners, list) = self.without_done(round, owners);
        let boxes = matches!(ground, Ground::Blocks(..)).then(|| cuts.boxes(whole));
        let (mut mine, regions) = self.deal(round, &cuts, log_factor, (&owners, boxes.as_deref()))?;
        let around = self.deal_ground(round, ground, regions, &owners)?;
        // The heaviest first, so that none is left for the end.
        let work = |part: u32| cuts.work[part as usize];
        mine.sort_by(|a, b| work(b.0).total_cmp(&work(a.0)).then(a.0.cmp(&b.0)));
        let dealing = watch.seconds();
        let adapted = self.adapt_parts(round, (ground, &around), (parts, &mine), (is_zone, divides), &list);
        self.agreed(adapted)?;
        self.next_id += (parts as u64) << 33;
        self.steps += 1;
        let before = (self.active.round, std::mem::take(&mut self.active.pieces));
        self.become_active(round, list)?;
        let vertices = self.active.pieces.iter().map(|piece| piece.all as usize).sum();
        self.common.observer.vertices(self.vertices());
        let of_parts = self.active.pieces.iter().map(|piece| piece.told(&cuts.work)).collect();
        let seconds = began.elapsed().as_secs_f64();
        self.told.push(Told { parts, tets, vertices, seconds, cutting, dealing, of_parts });
        // Parts that were ended halfway are good for the mesh that is written now, and not for a run that goes on.
        self.agree_on_end();
        if self.is_ended {
            return Ok(());
        }
        self.note(ground.blocks())?;
        // With the journal, what was before is not needed any more.
        let own = self.common.ranks.rank() as u32;
        for piece in before.1.iter().filter(|piece| piece.rank == own) {
            self.common.shelf.forget(Key::Active { round: before.0, part: piece.part });
        }
        Ok(())
    }

    /// Puts away what a part became, one of so many: what is not finished, and what is.
    pub(super) fn put_away(
        &self,
        (round, part, parts): (u32, u32, usize),
        [active, finished]: [Piece; 2],
        done: Done,
        list: &Shared<PartDone>,
    ) -> Result<(), Error> {
        let Common { shelf, ranks, .. } = self.common;
        let most = (SAMPLES / parts.max(1)).max(LEAST_SAMPLES);
        let became = Became {
            part,
            rank: ranks.rank() as u32,
            tets: active.len() as u64,
            vertices: active.ids.len() as u64,
            all: (active.ids.len() + finished.ids.len()) as u64,
            seconds: done.seconds,
        };
        let told = (became, samples(&active, most), done);
        if active.len() > 0 {
            shelf.put(Key::Active { round, part }, active)?;
        }
        if finished.len() > 0 {
            shelf.put(Key::Finished { round, part }, finished)?;
        }
        if !self.ends() {
            write_done(shelf, round, &told)?;
        }
        add(list, told);
        Ok(())
    }

    /// All ranks tell what their parts became.
    pub fn become_active(&mut self, round: u32, list: Shared<PartDone>) -> Result<(), Error> {
        let mut bytes = Vec::new();
        for told in sorted(list, |(became, ..)| became.part) {
            bytes.append(&mut journal::encoded(&told)?);
        }
        let mut all = Vec::new();
        for from in self.common.ranks.gather(&bytes) {
            let mut from = &from[..];
            while !from.is_empty() {
                all.push(journal::decoded(&mut from).ok_or(Error::Message)?);
            }
        }
        all.sort_by_key(|(became, ..)| became.part);
        self.active = Active { round, ..Active::default() };
        for (became, mut samples, done) in all {
            self.done.add(&done);
            self.finished_vertices += became.all - became.vertices;
            if became.all > became.vertices {
                self.finished.push((Key::Finished { round, part: became.part }, became.rank));
            }
            self.active.pieces.push(became);
            self.active.samples.append(&mut samples);
        }
        Ok(())
    }
}
