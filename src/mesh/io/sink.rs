//! Where the values of a file go: a text, or a binary file.
use super::FieldKind;
use super::keyword::{DIMENSION, END};
use super::source::{Section, Words};
use std::io::{self, Write};

/// Bytes that are gathered before they are handed on.
const BUFFER: usize = 1 << 16;

/// Takes a file value by value. The file's head comes with the sink, its end with [`Sink::end`].
pub(super) trait Sink {
    /// A keyword and its header; as many rows must follow as its count says.
    fn section(&mut self, section: &Section);
    /// An integer of a row.
    fn int(&mut self, value: i64);
    /// A real of a row.
    fn real(&mut self, value: f64);
    /// The end of a row.
    fn end_row(&mut self) -> io::Result<()>;
    /// Appends a row of reals to the bytes as [`Sink::real`] and [`Sink::end_row`] would: for tasks that encode many rows at once.
    fn encode(row: impl Iterator<Item = f64>, bytes: &mut Vec<u8>);
    /// Hands on rows that are encoded.
    fn rows(&mut self, bytes: &[u8]) -> io::Result<()>;
    /// The end of the file.
    fn end(self) -> io::Result<()>;
}

/// Writes a text; reals with as few digits as lead back to the same number.
pub(super) struct AsciiSink<'a> {
    to: &'a mut dyn Write,
    buffer: Vec<u8>,
}

impl<'a> AsciiSink<'a> {
    pub(super) fn new(to: &'a mut dyn Write, version: i64) -> Self {
        let head = format!("MeshVersionFormatted {version}\n\nDimension 3\n");
        Self { to, buffer: head.into_bytes() }
    }

    fn text(&mut self, text: std::fmt::Arguments) {
        self.buffer.write_fmt(text).expect("writing to memory");
    }
}

impl Sink for AsciiSink<'_> {
    fn section(&mut self, section: &Section) {
        self.text(format_args!("\n{}\n{}\n", section.keyword.name(), section.count));
        if !section.kinds.is_empty() {
            self.int(section.kinds.len() as i64);
            section.kinds.iter().for_each(|kind| self.int(kind.code()));
            self.buffer.push(b'\n');
        }
    }

    fn int(&mut self, value: i64) {
        self.text(format_args!("{value} "));
    }

    fn real(&mut self, value: f64) {
        self.text(format_args!("{value:?} "));
    }

    fn end_row(&mut self) -> io::Result<()> {
        self.buffer.pop(); // the blank
        self.buffer.push(b'\n');
        flush_full(self.to, &mut self.buffer, BUFFER)
    }

    fn encode(row: impl Iterator<Item = f64>, bytes: &mut Vec<u8>) {
        row.for_each(|value| write!(bytes, "{value:?} ").expect("writing to memory"));
        bytes.pop(); // the blank
        bytes.push(b'\n');
    }

    fn rows(&mut self, bytes: &[u8]) -> io::Result<()> {
        flush_full(self.to, &mut self.buffer, 0)?;
        self.to.write_all(bytes)
    }

    fn end(mut self) -> io::Result<()> {
        self.text(format_args!("\nEnd\n"));
        flush_full(self.to, &mut self.buffer, 0)
    }
}

fn flush_full(to: &mut dyn Write, buffer: &mut Vec<u8>, limit: usize) -> io::Result<()> {
    if buffer.len() > limit {
        to.write_all(buffer)?;
        buffer.clear();
    }
    Ok(())
}

/// Writes a binary file of version 2, 3 or 4, least significant byte first. Positions of keywords are
/// computed from the counts, so the file is written from front to back.
pub(super) struct BinarySink<'a> {
    to: &'a mut dyn Write,
    buffer: Vec<u8>,
    words: Words,
    /// Where the next keyword begins.
    position: u64,
}

impl<'a> BinarySink<'a> {
    pub(super) fn new(to: &'a mut dyn Write, version: i64) -> Self {
        let mut sink = Self { to, buffer: Vec::new(), words: Words::of_version(version, false), position: 8 };
        sink.word(1);
        sink.word(version as i32);
        sink.keyword(DIMENSION, 4);
        sink.word(3);
        sink
    }

    fn word(&mut self, value: i32) {
        self.buffer.extend_from_slice(&value.to_le_bytes());
    }

    fn sized(&mut self, value: i64, size: usize) {
        self.buffer.extend_from_slice(&value.to_le_bytes()[..size]);
    }

    /// A keyword with `body` bytes behind it.
    fn keyword(&mut self, code: i32, body: u64) {
        self.position += 4 + self.words.position as u64 + body;
        self.word(code);
        let next = if code == END { 0 } else { self.position as i64 };
        self.sized(next, self.words.position);
    }
}

/// Bytes of a section behind its keyword and position.
fn body_size(words: Words, section: &Section) -> u64 {
    let (ints, reals) = section.row();
    let fields = if section.kinds.is_empty() { 0 } else { 4 * (1 + section.kinds.len()) };
    (words.int + fields) as u64 + section.count as u64 * (ints * words.int + reals * words.real) as u64
}

/// Version for a file of these sections: 2, or 3 when it passes the 2 GiB that its positions reach, or 4 when
/// a count passes what its integers hold.
pub(super) fn version(sections: &[Section]) -> i64 {
    const LARGEST: u64 = i32::MAX as u64;
    let size: u64 = sections.iter().map(|s| 8 + body_size(Words::of_version(2, false), s)).sum();
    if sections.iter().any(|s| s.count as u64 > LARGEST) {
        4
    } else if size + 28 > LARGEST {
        3 // 28: head, Dimension, End
    } else {
        2
    }
}

impl Sink for BinarySink<'_> {
    fn section(&mut self, section: &Section) {
        self.keyword(section.keyword.code(), body_size(self.words, section));
        self.sized(section.count as i64, self.words.int);
        if !section.kinds.is_empty() {
            self.word(section.kinds.len() as i32);
            section.kinds.iter().for_each(|kind: &FieldKind| self.word(kind.code() as i32));
        }
    }

    #[inline]
    fn int(&mut self, value: i64) {
        self.sized(value, self.words.int);
    }

    #[inline]
    fn real(&mut self, value: f64) {
        self.buffer.extend_from_slice(&value.to_le_bytes());
    }

    #[inline]
    fn end_row(&mut self) -> io::Result<()> {
        flush_full(self.to, &mut self.buffer, BUFFER)
    }

    fn encode(row: impl Iterator<Item = f64>, bytes: &mut Vec<u8>) {
        row.for_each(|value| bytes.extend_from_slice(&value.to_le_bytes()));
    }

    fn rows(&mut self, bytes: &[u8]) -> io::Result<()> {
        flush_full(self.to, &mut self.buffer, 0)?;
        self.to.write_all(bytes)
    }

    fn end(mut self) -> io::Result<()> {
        self.keyword(END, 0);
        flush_full(self.to, &mut self.buffer, 0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::keyword::Keyword;
    use super::*;

    fn section(keyword: Keyword, count: usize) -> Section {
        Section { keyword, count, body: 0..0, kinds: Vec::new() }
    }

    #[test]
    fn the_version_follows_from_the_size() {
        assert_eq!(version(&[section(Keyword::Vertices, 1000)]), 2);
        // 28 bytes a vertex
        let full = (i32::MAX as usize - 28 - 12) / 28;
        assert_eq!(version(&[section(Keyword::Vertices, full)]), 2);
        assert_eq!(version(&[section(Keyword::Vertices, full + 1)]), 3);
        let metric = Section { kinds: vec![FieldKind::SymmetricTensor], ..section(Keyword::SolAtVertices, 50_000_000) };
        assert_eq!(version(&[metric]), 3);
        assert_eq!(version(&[section(Keyword::Corners, i32::MAX as usize + 1)]), 4);
    }
}
