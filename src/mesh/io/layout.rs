//! A file that is written: what stands where, and how all threads write it.
//!
//! A file is parts (its head, each section, its end), each a head and rows; some rows are a piece, which one task encodes. In a binary file
//! the counts tell where each piece goes, so tasks put them there in any order. A text, a pipe, and a system without such writes get the
//! pieces from front to back. The bytes are the same.
use super::binary::row_size;
use super::keyword::{DIMENSION, END};
use super::rows::Content;
use super::sink::{Binary, Sink, Text};
use super::source::{Encoding, Section, Words};
use crate::tasks::{GRAIN, Team};
use std::io::{self, Write};
use std::ops::Range;

/// Rows of a piece: some hundred kilobytes.
const ROWS: usize = GRAIN;

/// Pieces that wait for those before them to be written: some megabytes, and enough tasks for all threads.
const WAITING: usize = 64;

/// What takes the bytes of a file.
pub(super) enum To<'a> {
    /// An empty file of our own: it can be written at any place.
    File(&'a std::fs::File),
    /// Something that is written from front to back.
    Stream(&'a mut dyn Write),
}

/// Some bytes and the rows of a section behind them.
struct Part<'s> {
    head: Vec<u8>,
    rows: Option<&'s Section>,
}

/// Some rows of a part, with its head before the first.
struct Piece {
    part: usize,
    rows: Range<usize>,
    /// Where it begins in a binary file.
    place: u64,
}

/// The parts of a file.
pub(super) struct Layout<'s> {
    encoding: Encoding,
    parts: Vec<Part<'s>>,
    content: Content<'s>,
}

impl<'s> Layout<'s> {
    /// Of these sections of a mesh or a solution; as a text if it is not `binary`.
    pub(super) fn of(binary: bool, version: i64, sections: &'s [Section], content: Content<'s>) -> Self {
        if binary {
            let words = Words::of_version(version, false);
            Self { encoding: Encoding::Binary(words), parts: binary_parts(version, words, sections), content }
        } else {
            Self { encoding: Encoding::Ascii, parts: text_parts(version, sections), content }
        }
    }

    /// Writes the file.
    pub(super) fn write(&self, team: Team<'_>, to: To<'_>) -> io::Result<()> {
        match to {
            #[cfg(unix)]
            To::File(file) if self.encoding != Encoding::Ascii && team.threads() > 1 => self.in_place(team, file),
            To::File(mut file) => self.in_order(team, &mut file),
            To::Stream(stream) => self.in_order(team, stream),
        }
    }

    /// Each task writes its pieces where they belong. Of several errors the first in the file counts.
    #[cfg(unix)]
    fn in_place(&self, team: Team<'_>, file: &std::fs::File) -> io::Result<()> {
        use std::os::unix::fs::FileExt;
        use std::sync::{Mutex, PoisonError};
        let pieces = self.pieces();
        let failed = Mutex::new(None::<(u64, io::Error)>);
        team.for_each(1, pieces.len(), |range| {
            for piece in &pieces[range] {
                let goes_on = |failed: &Option<(u64, _)>| failed.as_ref().is_none_or(|(place, _)| piece.place < *place);
                if !goes_on(&failed.lock().unwrap_or_else(PoisonError::into_inner)) {
                    continue;
                }
                let mut bytes = Vec::new();
                self.encode(piece, &mut bytes);
                if let Err(error) = file.write_all_at(&bytes, piece.place) {
                    let mut failed = failed.lock().unwrap_or_else(PoisonError::into_inner);
                    if goes_on(&failed) {
                        *failed = Some((piece.place, error));
                    }
                }
            }
        });
        failed.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(Ok(()), |(_, error)| Err(error))
    }

    /// All threads encode some pieces, then they are written one after the other.
    fn in_order(&self, team: Team<'_>, to: &mut dyn Write) -> io::Result<()> {
        let mut buffers = vec![Vec::new(); if team.threads() > 1 { WAITING } else { 1 }];
        for pieces in self.pieces().chunks(buffers.len()) {
            let buffers = &mut buffers[..pieces.len()];
            team.fill(1, buffers, |start, buffers| {
                for (bytes, piece) in buffers.iter_mut().zip(&pieces[start..]) {
                    bytes.clear();
                    self.encode(piece, bytes);
                }
            });
            buffers.iter().try_for_each(|bytes| to.write_all(bytes))?;
        }
        Ok(())
    }

    fn pieces(&self) -> Vec<Piece> {
        let (mut pieces, mut place) = (Vec::new(), 0);
        for (part, Part { rows, .. }) in self.parts.iter().enumerate() {
            let count = rows.map_or(0, |section| section.count);
            for start in (0..count.max(1)).step_by(ROWS) {
                let rows = start..count.min(start + ROWS);
                let length = self.length(part, &rows);
                pieces.push(Piece { part, rows, place });
                place += length;
            }
        }
        pieces
    }

    /// Bytes of a piece of a binary file.
    fn length(&self, part: usize, rows: &Range<usize>) -> u64 {
        let Part { head, rows: section } = &self.parts[part];
        let row = match (self.encoding, section) {
            (Encoding::Binary(words), Some(section)) => row_size(words, section),
            _ => 0,
        };
        (if rows.start == 0 { head.len() } else { 0 } + rows.len() * row) as u64
    }

    /// Appends the bytes of a piece.
    fn encode(&self, piece: &Piece, bytes: &mut Vec<u8>) {
        let Piece { part, rows, .. } = piece;
        let Part { head, rows: section } = &self.parts[*part];
        bytes.reserve(self.length(*part, rows) as usize);
        if rows.start == 0 {
            bytes.extend_from_slice(head);
        }
        let Some(section) = section else { return };
        match self.encoding {
            Encoding::Ascii => self.content.rows(section.keyword, rows.clone(), &mut Text(bytes)),
            Encoding::Binary(words) => self.content.rows(section.keyword, rows.clone(), &mut Binary { bytes, words }),
        }
    }
}

/// The parts of a text.
fn text_parts(version: i64, sections: &[Section]) -> Vec<Part<'_>> {
    let head = format!("MeshVersionFormatted {version}\n\nDimension 3\n").into_bytes();
    let mut parts = vec![Part { head, rows: None }];
    parts.extend(sections.iter().map(|section| {
        let mut head = format!("\n{}\n{}\n", section.keyword.name(), section.count).into_bytes();
        if !section.kinds.is_empty() {
            let mut text = Text(&mut head);
            text.int(section.kinds.len() as i64);
            section.kinds.iter().for_each(|kind| text.int(kind.code()));
            head.push(b'\n');
        }
        Part { head, rows: Some(section) }
    }));
    parts.push(Part { head: b"\nEnd\n".to_vec(), rows: None });
    parts
}

/// The parts of a binary file of version 2, 3 or 4: each keyword says where the next begins.
fn binary_parts(version: i64, words: Words, sections: &[Section]) -> Vec<Part<'_>> {
    let mut position = 8;
    let mut keyword = |head: &mut Binary, code: i32, body: u64| {
        position += 4 + words.position as u64 + body;
        head.word(code);
        head.sized(if code == END { 0 } else { position as i64 }, words.position);
    };
    let mut bytes = Vec::new();
    let mut head = Binary { bytes: &mut bytes, words };
    head.word(1);
    head.word(version as i32);
    keyword(&mut head, DIMENSION, 4);
    head.word(3);
    let mut parts = vec![Part { head: bytes, rows: None }];
    for section in sections {
        let mut bytes = Vec::new();
        let mut head = Binary { bytes: &mut bytes, words };
        keyword(&mut head, section.keyword.code(), body_size(words, section));
        head.int(section.count as i64);
        if !section.kinds.is_empty() {
            head.word(section.kinds.len() as i32);
            section.kinds.iter().for_each(|kind| head.word(kind.code() as i32));
        }
        parts.push(Part { head: bytes, rows: Some(section) });
    }
    let mut bytes = Vec::new();
    keyword(&mut Binary { bytes: &mut bytes, words }, END, 0);
    parts.push(Part { head: bytes, rows: None });
    parts
}

/// A head of a binary file, and the rows that follow it.
pub(super) struct Framed<'s> {
    /// Where the head begins.
    pub place: u64,
    /// Its bytes.
    pub head: Vec<u8>,
    /// The section whose rows follow, and the bytes of a row.
    pub rows: Option<(&'s Section, usize)>,
}

/// A binary file without its rows.
pub(super) fn frame(version: i64, sections: &[Section]) -> Vec<Framed<'_>> {
    let (words, mut next) = (Words::of_version(version, false), 0);
    let parts = binary_parts(version, words, sections).into_iter();
    parts
        .map(|Part { head, rows }| {
            let (place, rows) = (next, rows.map(|section| (section, row_size(words, section))));
            next += head.len() as u64 + rows.map_or(0, |(section, row)| section.count as u64 * row as u64);
            Framed { place, head, rows }
        })
        .collect()
}

/// Bytes of a section behind its keyword and position.
fn body_size(words: Words, section: &Section) -> u64 {
    let fields = if section.kinds.is_empty() { 0 } else { 4 * (1 + section.kinds.len()) };
    (words.int + fields) as u64 + section.count as u64 * row_size(words, section) as u64
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

#[cfg(test)]
mod tests;
