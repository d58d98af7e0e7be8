//! Ids for new vertices and tetrahedra: those of dead ones first, then fresh ones of the store.
use super::ids::{TetId, VertexId};
use super::refusal::Refusal;
use super::store::Store;
use crate::tasks::Team;
use std::ops::Range;

/// Fresh ids are taken from the store in blocks of this size.
pub const ID_BLOCK: usize = 64;

/// Blocks that a task marks as free.
const BLOCKS: usize = 64;

/// Ids that a thread, or a part of the mesh, may use. Those given back last are used first.
#[derive(Default)]
pub struct IdPool {
    vertices: Vec<VertexId>,
    tets: Vec<TetId>,
    /// Blocks of vertex ids and of tetrahedron ids that no part has used: they are used before fresh ones.
    blocks: [Vec<Range<u32>>; 2],
    stripes: Option<[Stripe; 2]>,
}

/// Of the blocks of fresh ids every n-th belongs to this pool. So the other pools get the same ids, whatever this one takes.
#[derive(Clone, Copy)]
struct Stripe {
    next: usize,
    step: usize,
}

impl Stripe {
    fn advance(&mut self) -> usize {
        let start = self.next;
        self.next += self.step;
        start
    }
}

impl IdPool {
    /// A free vertex id.
    pub(super) fn vertex(&mut self, store: &Store) -> Result<VertexId, Refusal> {
        if self.vertices.is_empty() {
            let block = self.fresh_vertices(store).ok_or(Refusal::Full)?;
            self.vertices.extend(block.rev().map(VertexId));
        }
        self.vertices.pop().ok_or(Refusal::Full)
    }

    fn fresh_vertices(&mut self, store: &Store) -> Option<Range<u32>> {
        self.blocks[0].pop().or_else(|| match &mut self.stripes {
            None => store.take_vertices(ID_BLOCK),
            Some([vertices, _]) => store.take_vertices_at(vertices.advance(), ID_BLOCK),
        })
    }

    fn fresh_tets(&mut self, store: &Store) -> Option<Range<u32>> {
        self.blocks[1].pop().or_else(|| match &mut self.stripes {
            None => store.take_tets(ID_BLOCK),
            Some([_, tets]) => store.take_tets_at(tets.advance(), ID_BLOCK),
        })
    }

    /// Makes sure that `count` tetrahedron ids are at hand.
    pub(super) fn provide_tets(&mut self, store: &Store, count: usize) -> Result<(), Refusal> {
        while self.tets.len() < count {
            let block = self.fresh_tets(store).ok_or(Refusal::Full)?;
            // Fresh ids go to the bottom: freed ones are used again first.
            self.tets.splice(0..0, block.rev().map(TetId));
        }
        Ok(())
    }

    /// A free tetrahedron id; after [`IdPool::provide_tets`].
    pub(super) fn tet(&mut self) -> TetId {
        self.tets.pop().expect("ids were provided")
    }

    /// Forgets all ids: the store was renumbered.
    pub fn clear(&mut self) {
        self.vertices.clear();
        self.tets.clear();
        self.blocks = Default::default();
    }

    /// Gives a vertex id back.
    pub(super) fn free_vertex(&mut self, v: VertexId) {
        self.vertices.push(v);
    }

    /// Gives a tetrahedron id back.
    pub(super) fn free_tet(&mut self, t: TetId) {
        self.tets.push(t);
    }

    /// Splits all free ids evenly among so many pools. Each takes fresh ids from a stripe of its own, so the ids that a part uses do not
    /// depend on when the other parts use theirs.
    pub fn split(&mut self, store: &Store, parts: usize) -> Vec<Self> {
        let bounds = [store.vertex_bound(), store.tet_bound()];
        let mut share = |part: usize| Self {
            vertices: split_last(&mut self.vertices, parts - part),
            tets: split_last(&mut self.tets, parts - part),
            blocks: self.blocks.each_mut().map(|blocks| split_last(blocks, parts - part)),
            stripes: Some(bounds.map(|bound| Stripe { next: bound + part * ID_BLOCK, step: parts * ID_BLOCK })),
        };
        (0..parts).map(&mut share).collect()
    }

    /// Joins the pools that were split off, and adds the fresh blocks that were passed over.
    pub fn merge(&mut self, team: Team<'_>, store: &Store, parts: Vec<Self>) {
        let mut stripes = Vec::with_capacity(parts.len());
        for mut pool in parts {
            self.vertices.append(&mut pool.vertices);
            self.tets.append(&mut pool.tets);
            self.blocks.iter_mut().zip(&mut pool.blocks).for_each(|(all, blocks)| all.append(blocks));
            stripes.extend(pool.stripes);
        }
        for (kind, blocks) in self.blocks.iter_mut().enumerate() {
            let mut passed_over = Vec::new();
            // Stripes begin a block apart; all go on to the end of the longest.
            let end_of = |stripe: &Stripe, part: usize| stripe.next - part * ID_BLOCK;
            let end = stripes.iter().enumerate().map(|(part, stripe)| end_of(&stripe[kind], part)).max().unwrap_or(0);
            for (part, stripe) in stripes.iter_mut().enumerate() {
                while end_of(&stripe[kind], part) < end {
                    passed_over.push(stripe[kind].advance());
                }
            }
            let take = |start: &usize| match kind {
                0 => store.take_vertices_at(*start, ID_BLOCK),
                _ => store.take_tets_at(*start, ID_BLOCK),
            };
            let taken = team.chunks(BLOCKS, passed_over.len(), |range| -> Vec<_> {
                passed_over[range].iter().filter_map(take).collect()
            });
            blocks.extend(taken.into_iter().flatten());
        }
    }
}

/// Takes the last of so many equal parts off.
fn split_last<T>(list: &mut Vec<T>, parts: usize) -> Vec<T> {
    list.split_off(list.len() - list.len() / parts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn ids_are_split_and_merged_without_loss() {
        let store = Store::with_capacity(10_000, 10_000);
        let mut all = IdPool::default();
        all.provide_tets(&store, 100).unwrap();
        let first = all.vertex(&store).unwrap();
        all.free_vertex(first);
        let mut parts = all.split(&store, 3);
        let mut used = BTreeSet::new();
        // The second part uses most, the third none.
        for (part, count) in [(0, 150), (1, 500)] {
            for _ in 0..count {
                parts[part].provide_tets(&store, 1).unwrap();
                assert!(used.insert(parts[part].tet()), "no id twice");
                parts[part].vertex(&store).unwrap();
            }
        }
        all.merge(Team::alone(), &store, parts);
        let blocks = all.blocks.clone().map(|blocks| blocks.into_iter().flatten().collect::<Vec<_>>());
        let free: BTreeSet<_> = all.tets.iter().copied().chain(blocks[1].iter().copied().map(TetId)).collect();
        assert_eq!(free.len(), all.tets.len() + blocks[1].len());
        assert!(free.is_disjoint(&used));
        assert_eq!(free.len() + used.len(), store.tet_bound(), "every id below the bound is used or free");
        assert_eq!(all.vertices.len() + blocks[0].len() + 650, store.vertex_bound());
    }

    #[test]
    fn what_a_part_gets_does_not_depend_on_when() {
        let ids = |order: [usize; 2]| {
            let store = Store::with_capacity(10_000, 10_000);
            let mut parts = IdPool::default().split(&store, 2);
            let mut got = [Vec::new(), Vec::new()];
            for part in order {
                for _ in 0..200 {
                    got[part].push(parts[part].vertex(&store).unwrap());
                }
            }
            got
        };
        assert_eq!(ids([0, 1]), ids([1, 0]));
    }

    #[test]
    fn a_full_store_says_so() {
        let store = Store::with_capacity(100, 100);
        let mut parts = IdPool::default().split(&store, 2);
        assert!(parts[0].vertex(&store).is_ok());
        assert_eq!(parts[1].vertex(&store), Err(Refusal::Full));
    }
}
