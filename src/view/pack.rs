//! Arrays as text: deltas, bytes of equal rank side by side, zlib, base64.
//!
//! Numbers of neighbours in a mesh are near each other, so of the differences from row to row the upper bytes are mostly 0, and
//! compress to nothing once they stand together. Blocks are compressed apart: on all threads here, and side by side in the browser.
use crate::tasks::{GRAIN, Team};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde::Serialize;
use std::io::Write;

/// Bytes of a block before it is compressed.
const BLOCK: usize = 1 << 20;

/// What an array holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Unsigned, 8 bits.
    U8,
    /// Unsigned, 16 bits.
    U16,
    /// Unsigned, 32 bits.
    U32,
    /// IEEE 754, 32 bits.
    F32,
}

impl Kind {
    fn width(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }
}

/// An array in the order of the data. Of each column after the other come the lowest bytes of all rows, then the next ones.
#[derive(Clone, Debug, Serialize)]
pub struct Entry {
    name: String,
    kind: Kind,
    rows: usize,
    columns: usize,
    /// Each row is the difference from the one before, in two's complement, as 2d or −2d − 1.
    delta: bool,
}

/// Arrays one after the other.
pub struct Packer<'t> {
    team: Team<'t>,
    /// What there is.
    pub entries: Vec<Entry>,
    bytes: Vec<u8>,
}

impl<'t> Packer<'t> {
    /// Empty.
    pub fn new(team: Team<'t>) -> Self {
        Self { team, entries: Vec::new(), bytes: Vec::new() }
    }

    /// Adds whole numbers, shape (rows, N).
    pub fn numbers<const N: usize>(&mut self, name: &str, rows: &[[u32; N]]) {
        let zigzag = |row: usize, column: usize| {
            let before = if row == 0 { 0 } else { rows[row - 1][column] };
            let difference = rows[row][column].wrapping_sub(before) as i32;
            ((difference << 1) ^ (difference >> 31)) as u32
        };
        self.add(Entry { name: name.into(), kind: Kind::U32, rows: rows.len(), columns: N, delta: true }, zigzag);
    }

    /// Adds reals, shape (rows, N).
    pub fn reals<const N: usize>(&mut self, name: &str, rows: &[[f32; N]]) {
        let entry = Entry { name: name.into(), kind: Kind::F32, rows: rows.len(), columns: N, delta: false };
        self.add(entry, |row, column| rows[row][column].to_bits());
    }

    /// Adds numbers of 8 or 16 bits, shape (rows, 1).
    pub fn small(&mut self, name: &str, kind: Kind, rows: usize, value: impl Fn(usize) -> u32 + Sync) {
        self.add(Entry { name: name.into(), kind, rows, columns: 1, delta: false }, |row, _| value(row));
    }

    fn add(&mut self, entry: Entry, word: impl Fn(usize, usize) -> u32 + Sync) {
        let (rows, columns, width) = (entry.rows, entry.columns, entry.kind.width());
        let start = self.bytes.len();
        self.bytes.resize(start + rows * columns * width, 0);
        if rows > 0 {
            for (number, plane) in self.bytes[start..].chunks_mut(rows).enumerate() {
                let (column, shift) = (number / width, 8 * (number % width));
                self.team.fill(4 * GRAIN, plane, |first, bytes| {
                    for (byte, row) in bytes.iter_mut().zip(first..) {
                        *byte = (word(row, column) >> shift) as u8;
                    }
                });
            }
        }
        self.entries.push(entry);
    }

    /// The blocks, each as base64, in their order.
    pub fn blocks(&self) -> Vec<String> {
        self.team.chunks(BLOCK, self.bytes.len(), |range| {
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
            // Writing to memory does not fail.
            let _ = encoder.write_all(&self.bytes[range]);
            base64(&encoder.finish().unwrap_or_default())
        })
    }
}

/// RFC 4648, section 4.
pub(crate) fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let word = three.iter().zip([16, 8, 0]).fold(0, |word, (&byte, shift)| word | u32::from(byte) << shift);
        for letter in 0..4 {
            let filled = letter <= three.len();
            text.push(if filled { LETTERS[(word >> (18 - 6 * letter)) as usize & 63] as char } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_the_standard() {
        // RFC 4648, section 10.
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }

    #[test]
    fn bytes_of_equal_rank_stand_together() {
        let mut packer = Packer::new(Team::alone());
        packer.numbers("n", &[[5, 300], [4, 301], [6, 0]]);
        // 5, −1, +2 → 10, 1, 4; 300, +1, −301 → 600, 2, 601.
        let mut expected = vec![10, 1, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        expected.extend([88, 2, 89, 2, 0, 2, 0, 0, 0, 0, 0, 0]);
        assert_eq!(packer.bytes, expected);
        packer.small("s", Kind::U16, 2, |row| [1, 0x203][row]);
        assert_eq!(packer.bytes[24..], [1, 3, 0, 2]);
        assert_eq!(packer.entries.len(), 2);
    }
}
