//! Edges of a cavity's rim, each seen from its two faces.

/// A hash table by the two ends, emptied at no cost.
#[derive(Default)]
pub struct EdgeTable {
    slots: Vec<Slot>,
    turn: u32,
}

#[derive(Clone, Copy, Default)]
struct Slot {
    turn: u32,
    side: u32,
    ends: [u32; 2],
}

impl EdgeTable {
    /// Empties it and makes room for so many edges.
    pub fn clear(&mut self, edges: usize) {
        let size = (4 * edges).next_power_of_two().max(64);
        self.turn = self.turn.wrapping_add(1);
        if self.slots.len() < size || self.turn == 0 {
            self.slots.clear();
            self.slots.resize(size.max(self.slots.len()), Slot::default());
            self.turn = 1;
        }
    }

    /// The side that was given when the edge came before. The first time there is none, and this side is kept.
    pub fn meet(&mut self, a: u32, b: u32, side: u32) -> Option<u32> {
        let ends = [a.min(b), a.max(b)];
        let key = (u64::from(ends[0]) << 32 | u64::from(ends[1])).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let mask = self.slots.len() - 1;
        let mut at = (key >> 40) as usize & mask;
        loop {
            let slot = &mut self.slots[at];
            if slot.turn != self.turn {
                *slot = Slot { turn: self.turn, side, ends };
                return None;
            }
            if slot.ends == ends {
                return Some(slot.side);
            }
            at = (at + 1) & mask;
        }
    }
}
