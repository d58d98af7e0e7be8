//! Items in parts that are joined two by two (disjoint sets).

/// Parts of the items 0 to n. Each stands under its first item, in whatever order its items were joined.
pub struct DisjointSets(Vec<u32>);

impl DisjointSets {
    /// Every item alone.
    pub fn new(items: usize) -> Self {
        Self((0..items as u32).collect())
    }

    /// How many items there are.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// The first item of the part that an item is in; halves the way to it.
    pub fn first(&mut self, mut item: u32) -> u32 {
        let Self(above) = self;
        while above[item as usize] != item {
            above[item as usize] = above[above[item as usize] as usize];
            item = above[item as usize];
        }
        item
    }

    /// Makes one part of those of two items.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.first(a), self.first(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_stands_under_its_first_item() {
        let mut parts = DisjointSets::new(7);
        [(6, 4), (1, 3), (4, 3), (5, 5)].into_iter().for_each(|(a, b)| parts.join(a, b));
        assert_eq!((0..parts.count() as u32).map(|item| parts.first(item)).collect::<Vec<_>>(), [0, 1, 2, 1, 1, 5, 1]);
    }
}
