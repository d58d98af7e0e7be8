//! Which tetrahedra share a face.
use super::adjacency::{FACES, NONE, sorted3};
use crate::tasks::{GRAIN, Rows, Team, plain, zeros};
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// A face of more than two tetrahedra.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OverSharedFace {
    /// Its nodes, ascending.
    pub nodes: [u32; 3],
    /// How many tetrahedra share it.
    pub tets: usize,
}

/// What lies across each face of each tetrahedron.
#[derive(Clone, Debug)]
pub struct MatchedFaces {
    /// The neighbour across each face, shape (n, 4); [`NONE`] on the boundary. Of a face of more than two tetrahedra the
    /// first two are neighbours.
    pub neighbours: Vec<[u32; 4]>,
    /// The face of more than two tetrahedra that comes first in the order of the nodes, if there is one.
    pub crowded: Option<OverSharedFace>,
}

impl MatchedFaces {
    /// Matches the faces of fewer than 2³⁰ tetrahedra. Faces are gathered at their least node and matched there in a small table. Time and
    /// memory (16 bytes a tetrahedron beside the result) grow in proportion to the tetrahedra, and memory is read nearly in order where
    /// nodes that are near each other have near numbers.
    pub fn of(team: Team<'_>, tets: &[[u32; 4]]) -> Self {
        let sides = sides_by_least_node(team, tets);
        // Of each side its neighbour ^ NONE, so that zeroed memory says NONE.
        let across = zeros(4 * tets.len());
        let crowds = team.chunks(GRAIN, sides.len(), |range| {
            let mut table = Table::default();
            // All faces are matched, even when one has too many tetrahedra.
            let crowds = range.filter_map(|v| table.match_at(v as u32, &sides, tets, &across));
            crowds.reduce(|first, _| first)
        });
        let mut neighbours: Vec<[u32; 4]> = bytemuck::allocation::cast_vec(plain(across));
        team.fill(GRAIN, &mut neighbours, |_, some| {
            some.as_flattened_mut().iter_mut().for_each(|across| *across ^= NONE)
        });
        Self { neighbours, crowded: crowds.into_iter().flatten().next() }
    }
}

/// The sides 4·tet + face at the least node of the face.
fn sides_by_least_node(team: Team<'_>, tets: &[[u32; 4]]) -> Rows {
    let greatest = team.chunks(GRAIN, tets.len(), |range| tets[range].iter().flatten().max().copied());
    let nodes = greatest.into_iter().max().flatten().map_or(0, |greatest| greatest as usize + 1);
    // Three faces have the least node of the tetrahedron, and the one opposite to it has the second least.
    Rows::by_key::<4>(team, nodes, tets.len(), |t| {
        let nodes = tets[t];
        let at = (1..4).fold(0, |least, i| if nodes[i] < nodes[least] { i } else { least });
        let second = (0..4).filter(|&i| i != at).map(|i| nodes[i]).min().unwrap_or(nodes[at]);
        std::array::from_fn(|face| if face == at { second } else { nodes[at] })
    })
}

/// A face at its least node.
#[derive(Clone, Copy)]
struct Slot {
    /// The other two nodes, ascending.
    key: [u32; 2],
    /// The first side with them.
    side: u32,
    /// How many sides have them; 0 in a free slot.
    count: u32,
}

const FREE: Slot = Slot { key: [0; 2], side: 0, count: 0 };

/// Faces by their nodes, with open addressing; it lives in the first cache.
#[derive(Default)]
struct Table {
    slots: Vec<Slot>,
    mask: usize,
}

impl Table {
    /// Makes room for so many faces, and forgets those of before.
    fn clear(&mut self, faces: usize) {
        let size = (2 * faces).next_power_of_two();
        self.mask = size - 1;
        self.slots.clear();
        self.slots.resize(size, FREE);
    }

    /// The slot of a face, or the free one for it.
    #[inline]
    fn slot(&mut self, key: [u32; 2]) -> &mut Slot {
        // Fibonacci hashing: the upper bits of the product are well mixed.
        let word = (u64::from(key[1]) << 32 | u64::from(key[0])).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let mut at = (word >> 40) as usize & self.mask;
        while self.slots[at].count != 0 && self.slots[at].key != key {
            at = (at + 1) & self.mask;
        }
        &mut self.slots[at]
    }

    /// Matches the faces whose least node is v; returns the first one of more than two tetrahedra.
    fn match_at(&mut self, v: u32, sides: &Rows, tets: &[[u32; 4]], across: &[AtomicU32]) -> Option<OverSharedFace> {
        let sides = sides.row(v as usize);
        self.clear(sides.len());
        let mut crowded: Option<OverSharedFace> = None;
        for &side in sides {
            let (tet, face) = (side as usize / 4, side as usize % 4);
            let nodes = tets[tet];
            let [_, b, c] = sorted3(FACES[face].map(|i| nodes[i]));
            let slot = self.slot([b, c]);
            slot.count += 1;
            match slot.count {
                1 => (slot.key, slot.side) = ([b, c], side),
                2 => {
                    across[side as usize].store((slot.side / 4) ^ NONE, Relaxed);
                    across[slot.side as usize].store((side / 4) ^ NONE, Relaxed);
                }
                tets => {
                    let crowd = OverSharedFace { nodes: [v, b, c], tets: tets as usize };
                    if crowded.is_none_or(|known| crowd.nodes <= known.nodes) {
                        crowded = Some(crowd);
                    }
                }
            }
        }
        crowded
    }
}

#[cfg(test)]
mod tests {
    use super::super::adjacency::{neighbours, sorted_faces};
    use super::super::samples::cube;
    use super::*;

    #[test]
    fn matched_as_by_sorting() {
        let mut tets = cube(4).tets.nodes;
        // Some more that share faces with those that are there, and one that comes twice.
        for t in [7, 100, 250] {
            let [a, b, c, _] = tets[t];
            tets.push([b, a, c, 3]);
        }
        tets.push(tets[31]);
        let mut expected = vec![[NONE; 4]; tets.len()];
        let mut crowds = Vec::new();
        let keys = sorted_faces(&tets);
        for same in keys.chunk_by(|a, b| a.nodes == b.nodes) {
            if let [a, b, ..] = same {
                expected[a.side as usize / 4][a.side as usize % 4] = b.side / 4;
                expected[b.side as usize / 4][b.side as usize % 4] = a.side / 4;
            }
            if same.len() > 2 {
                crowds.push(OverSharedFace { nodes: same[0].nodes, tets: same.len() });
            }
        }
        let found = MatchedFaces::of(Team::alone(), &tets);
        assert_eq!(found.neighbours, expected);
        assert!(crowds.len() > 3);
        assert_eq!(found.crowded, Some(crowds[0]));
        assert_eq!(MatchedFaces::of(Team::alone(), &cube(2).tets.nodes).crowded, None);
        assert!(neighbours(&[]).is_empty());
    }
}
