//! Which vertices the tetrahedra of each block have: so that a range of vertices need not read all of the file.
use std::ops::Range;

/// Classes of vertices; those of a class follow one another.
const CLASSES: usize = 512;

/// Words of a block.
const WORDS: usize = CLASSES / 64;

/// Bytes of a block.
pub const BYTES: usize = 8 * WORDS;

/// A bit for each class of vertices that a block has some of.
pub type Bits = [u64; WORDS];

/// How the vertices are divided into classes.
#[derive(Clone, Copy)]
pub struct Classes {
    /// Vertices of a class.
    size: usize,
}

impl Classes {
    /// Of so many vertices.
    pub fn of(vertices: usize) -> Self {
        Self { size: vertices.div_ceil(CLASSES).max(1) }
    }

    /// The bits of a block of tetrahedra.
    pub fn bits(self, tets: &[[u32; 4]]) -> Bits {
        let mut bits = [0; WORDS];
        for &v in tets.as_flattened() {
            let class = v as usize / self.size;
            bits[class / 64] |= 1 << (class % 64);
        }
        bits
    }

    /// The bits of a range of vertices that is not empty.
    fn bits_of(self, vertices: &Range<usize>) -> Bits {
        let mut bits = [0; WORDS];
        for class in vertices.start / self.size..=(vertices.end - 1) / self.size {
            bits[class / 64] |= 1 << (class % 64);
        }
        bits
    }
}

/// The blocks of a mesh.
pub struct Blocks {
    /// How the vertices are divided.
    pub classes: Classes,
    /// Tetrahedra of a block.
    pub size: usize,
    /// All tetrahedra.
    pub tets: usize,
    /// Of each block.
    pub bits: Vec<Bits>,
}

impl Blocks {
    /// The tetrahedra of the blocks that may have one of these vertices, in ranges of at most `most` (at least a block) in their order.
    pub fn with(&self, vertices: &Range<usize>, most: usize) -> Vec<Range<usize>> {
        let asked = self.classes.bits_of(vertices);
        let mut ranges: Vec<Range<usize>> = Vec::new();
        for (block, bits) in self.bits.iter().enumerate() {
            if bits.iter().zip(&asked).all(|(a, b)| a & b == 0) {
                continue;
            }
            let block = block * self.size..self.tets.min((block + 1) * self.size);
            match ranges.last_mut() {
                Some(last) if last.end == block.start && block.end - last.start <= most => last.end = block.end,
                _ => ranges.push(block),
            }
        }
        ranges
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_with_a_vertex_are_found() {
        let tets: Vec<[u32; 4]> = (0..5000).map(|t| [t, t + 1, t + 2, t + 700 * (t % 2)]).collect();
        let classes = Classes::of(6000);
        let bits = tets.chunks(16).map(|block| classes.bits(block)).collect();
        let blocks = Blocks { classes, size: 16, tets: tets.len(), bits };
        for (vertices, most) in [(0..1, 16), (300..310, 64), (5999..6000, 64), (0..6000, 100)] {
            let found = blocks.with(&vertices, most);
            assert!(found.iter().all(|range| range.len() <= most) && found.is_sorted_by(|a, b| a.end <= b.start));
            for (t, nodes) in tets.iter().enumerate() {
                let has = nodes.iter().any(|&v| vertices.contains(&(v as usize)));
                assert!(!has || found.iter().any(|range| range.contains(&t)), "{t}");
            }
            let read: usize = found.iter().map(Range::len).sum();
            assert!(read <= 5000 && (vertices.len() > 100 || read < 200), "{read}");
        }
    }
}
