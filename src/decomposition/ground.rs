//! The metric of the input, cut into blocks where it is larger than a part: each part takes what lies about it, in each round.
use super::Error;
use super::bytes::{put, take};
use super::deal::{NOBODY, Shares};
use super::input::{Input, Skin, Vertices};
use super::join::join;
use super::piece::Piece;
use super::region::{Region, box_of};
use super::rounds::Rounds;
use super::shelf::{Key, Shelf};
use super::split::split_tets;
use super::threads::on_threads;
use crate::geometry::Model;
use crate::mesh::TetMesh;
use crate::mesh::adjacency::MatchedFaces;
use crate::mesh::ranges::renumbered;
use crate::mesh::vector::Vec3;
use crate::metric::{Background, Source, Sym3};
use crate::tasks::Team;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Where new vertices take their metric from.
pub enum Ground {
    /// A source that all have as a whole.
    Whole(Source),
    /// Blocks, and the logarithm of the factor of their M.
    Blocks(Vec<Block>, f64),
}

/// A block: a piece without boundary, which lies on the shelf of its rank.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Block {
    /// Its number.
    pub number: u32,
    /// The rank that has it.
    pub rank: u32,
    /// Its box.
    pub low: Vec3,
    pub high: Vec3,
}

impl Block {
    /// Of a piece.
    pub fn of(number: u32, rank: u32, piece: &Piece) -> Self {
        let [low, high] = box_of(&piece.mesh.vertices);
        Self { number, rank, low, high }
    }
}

/// The metric of an input of one slice, with its boundary on the model.
pub fn whole(team: Team<'_>, input: &dyn Input, skin: &Skin<'_>, model: &Model) -> Result<Source, Error> {
    let mut mesh = TetMesh { tets: input.tets(0..input.size()[1])?, ..TetMesh::default() };
    let numbers = renumbered(&mut [mesh.tets.nodes.as_flattened_mut()]);
    let Vertices { points, logs, .. } = input.vertices(&numbers)?;
    let rises = skin.rises(team, (&numbers, &logs), model);
    mesh.vertices = points;
    Ok(Source::Background(background(team, mesh, logs).of_second_degree(team, &rises)))
}

fn background(team: Team<'_>, mesh: TetMesh, logs: Vec<Sym3>) -> Background {
    let faces = MatchedFaces::of(team, &mesh.tets.nodes);
    Background::on(team, Arc::new(mesh), faces, logs)
}

/// What a block is of a piece: its metric on tetrahedra.
pub fn of_piece(piece: &Piece) -> Piece {
    split_tets(piece, &(0..piece.len() as u32).collect::<Vec<_>>())
}

/// What a part takes its metric from.
pub enum Under<'s> {
    /// What all have.
    Whole(&'s Source),
    /// Its own.
    Own(Source),
}

impl Under<'_> {
    /// The source.
    pub fn source(&self) -> &Source {
        match self {
            Self::Whole(source) => source,
            Self::Own(source) => source,
        }
    }
}

/// From which blocks each part of this rank takes tetrahedra.
pub type Around = BTreeMap<u32, Vec<u32>>;

impl Ground {
    /// The blocks; none where all have a source as a whole.
    pub fn blocks(&self) -> &[Block] {
        match self {
            Self::Whole(_) => &[],
            Self::Blocks(blocks, _) => blocks,
        }
    }

    /// Scales M by e^`log_factor`.
    pub fn scale(&mut self, team: Team<'_>, log_factor: f64) {
        match self {
            Self::Whole(source) => source.scale(team, log_factor),
            Self::Blocks(_, log) => *log += log_factor,
        }
    }

    /// What a part takes its metric from, in a round.
    pub fn under(&self, shelf: &Shelf, round: u32, part: u32, around: &Around) -> Result<Under<'_>, Error> {
        let (source, log) = match self {
            Self::Whole(source) => return Ok(Under::Whole(source)),
            Self::Blocks(_, log) => (around.get(&part), *log),
        };
        let of = source.map(Vec::as_slice).unwrap_or_default();
        let share = |&of: &u32| shelf.take(Key::Around { round, part, of });
        let mut piece = join(of.iter().map(share).collect::<Result<Vec<_>, _>>()?);
        of.iter().for_each(|&of| shelf.forget(Key::Around { round, part, of }));
        piece.scale(log);
        // Blocks have no boundary: they are as straight as the mesh.
        Ok(Under::Own(Source::Background(background(Team::alone(), piece.mesh, piece.logs))))
    }
}

impl Rounds<'_> {
    /// Gives each part what it needs of the blocks, on whatever rank they are. `regions` are those of the shares of this rank.
    pub fn deal_ground(
        &self,
        round: u32,
        ground: &Ground,
        regions: BTreeMap<u32, Region>,
        owners: &[u32],
    ) -> Result<Around, Error> {
        let Ground::Blocks(blocks, _) = ground else { return Ok(Around::new()) };
        let regions = self.regions(regions)?;
        let own = self.common.ranks.rank() as u32;
        let mine: Vec<&Block> = blocks.iter().filter(|block| block.rank == own).collect();
        let shares = Shares::new(self.common, owners);
        let threads = self.at_once(self.common.sizes.part * 0.4);
        let dealt = on_threads(threads, mine.len(), |at| {
            let Block { number, low, high, .. } = *mine[at];
            let wanted = |part: &u32| owners[*part as usize] != NOBODY;
            let near = regions.iter().filter(|(part, region)| wanted(part) && region.reaches([low, high]));
            let near: Vec<_> = near.collect();
            if near.is_empty() {
                return Ok(());
            }
            let key = Key::Ground { block: number };
            let block = self.common.shelf.take(key)?;
            for (&part, region) in near {
                let tets = region.of(&block);
                if !tets.is_empty() {
                    shares.give(Key::Around { round, part, of: number }, split_tets(&block, &tets))?;
                }
            }
            self.common.shelf.give_back(key, block);
            Ok(())
        });
        self.agreed(dealt)?;
        let kept = self.agreed(shares.exchange())?;
        let mut around = Around::new();
        for key in kept {
            if let Key::Around { part, of, .. } = key {
                around.entry(part).or_default().push(of);
            }
        }
        Ok(around)
    }

    /// Where each part lies, from what all ranks know of their shares.
    fn regions(&self, own: BTreeMap<u32, Region>) -> Result<BTreeMap<u32, Region>, Error> {
        let mut bytes = Vec::new();
        for (part, region) in own {
            put(&mut bytes, &[u64::from(part)]);
            put(&mut bytes, &region.words());
        }
        let mut all: BTreeMap<u32, Region> = BTreeMap::new();
        for from in self.common.ranks.gather(&bytes) {
            let mut from = &from[..];
            while !from.is_empty() {
                let [part]: [u64; 1] = take(&mut from).and_then(|part| part.try_into().ok()).ok_or(Error::Message)?;
                let words: Vec<u64> = take(&mut from).ok_or(Error::Message)?;
                let region = Region::of_words(&words).ok_or(Error::Message)?;
                match all.get_mut(&(part as u32)) {
                    Some(known) => known.join(&region),
                    None => drop(all.insert(part as u32, region)),
                }
            }
        }
        Ok(all.into_iter().map(|(part, region)| (part, region.grown())).collect())
    }
}
