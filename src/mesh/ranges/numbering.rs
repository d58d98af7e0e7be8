//! Numbers from 0 for the vertices of a few tetrahedra.

/// Different numbers, ascending, and where each of them is.
pub struct Numbering {
    /// The numbers, ascending.
    pub numbers: Vec<u32>,
    table: Table,
}

/// A number and its place, by the number, with open addressing.
#[derive(Default)]
struct Table {
    slots: Vec<[u32; 2]>,
    shift: u32,
}

/// A slot without a number: no vertex has this one.
const FREE: [u32; 2] = [u32::MAX; 2];

impl Numbering {
    /// Of numbers below `u32::MAX`.
    pub fn of(given: impl Iterator<Item = u32>) -> Self {
        Self::of_at_most(given, |_| true).unwrap_or_else(|| Self { numbers: Vec::new(), table: Table::with_room(2) })
    }

    /// As [`Numbering::of`]; none when they are more than `fits` lets be.
    pub fn of_at_most(given: impl Iterator<Item = u32>, fits: impl Fn(usize) -> bool) -> Option<Self> {
        let (mut table, mut numbers) = (Table::with_room(1 << 8), Vec::new());
        for number in given {
            if table.slot(number)[0] == number {
                continue;
            }
            numbers.push(number);
            *table.slot(number) = [number, 0];
            if 2 * numbers.len() > table.slots.len() {
                if !fits(numbers.len()) {
                    return None;
                }
                table = Table::with_room(2 * table.slots.len());
                numbers.iter().for_each(|&number| *table.slot(number) = [number, 0]);
            }
        }
        if !fits(numbers.len()) {
            return None;
        }
        numbers.sort_unstable();
        numbers.iter().zip(0..).for_each(|(&number, place)| *table.slot(number) = [number, place]);
        Some(Self { numbers, table })
    }

    /// The numbers alone.
    pub fn into_numbers(self) -> Vec<u32> {
        self.numbers
    }

    /// The place of one of the numbers among them.
    #[inline]
    pub fn place(&self, number: u32) -> u32 {
        self.table.slots[self.table.find(number)][1]
    }
}

impl Table {
    /// With so many slots, a power of two.
    fn with_room(slots: usize) -> Self {
        Self { slots: vec![FREE; slots], shift: 32 - slots.trailing_zeros() }
    }

    /// The slot of a number, or the free one for it.
    #[inline]
    fn find(&self, number: u32) -> usize {
        // Fibonacci hashing: the upper bits of the product are well mixed.
        let mut at = (number.wrapping_mul(0x9E37_79B9) >> self.shift) as usize;
        while self.slots[at][0] != number && self.slots[at] != FREE {
            at = (at + 1) & (self.slots.len() - 1);
        }
        at
    }

    fn slot(&mut self, number: u32) -> &mut [u32; 2] {
        let at = self.find(number);
        &mut self.slots[at]
    }
}

/// Numbers nodes anew, from 0 on in their order. Returns the numbers that they had, shape (n,), ascending.
pub fn renumbered(lists: &mut [&mut [u32]]) -> Vec<u32> {
    let numbering = Numbering::of(lists.iter().flat_map(|list| list.iter().copied()));
    lists.iter_mut().flat_map(|list| list.iter_mut()).for_each(|v| *v = numbering.place(*v));
    numbering.into_numbers()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_keep_their_order() {
        let mut lists = [vec![5, 9, 7000], vec![9, 6]];
        let [a, b] = &mut lists;
        assert_eq!(renumbered(&mut [a, b]), [5, 6, 9, 7000]);
        assert_eq!(lists, [vec![0, 2, 3], vec![2, 1]]);
        assert!(renumbered(&mut []).is_empty() && renumbered(&mut [&mut []]).is_empty());
    }

    #[test]
    fn places_are_those_in_the_sorted_list() {
        let given = (0..5000u32).map(|i| i.wrapping_mul(7919) % 1777 * 1000);
        let numbering = Numbering::of(given.clone());
        assert!(numbering.numbers.len() == 1777 && numbering.numbers.is_sorted());
        for number in given {
            assert_eq!(numbering.numbers[numbering.place(number) as usize], number);
        }
        assert!(Numbering::of(std::iter::empty()).numbers.is_empty());
    }
}
