//! A file in memory: its encoding, its sections, and how to name a place in it.
use super::keyword::Keyword;
use super::{Error, FieldKind, ascii, binary};
use std::ops::Range;
use std::path::Path;

/// How the values of a file are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    /// Text.
    Ascii,
    /// Words of the given sizes.
    Binary(Words),
}

/// The words of a binary file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Words {
    /// Most significant byte first.
    pub big: bool,
    /// Bytes of an integer (count, index, reference): 4, or 8 in version 4.
    pub int: usize,
    /// Bytes of a real: 4 in version 1, else 8.
    pub real: usize,
    /// Bytes of a position in the file: 4, or 8 from version 3.
    pub position: usize,
}

impl Words {
    /// The words of a version, 1 to 4.
    pub(super) fn of_version(version: i64, big: bool) -> Self {
        Self {
            big,
            int: if version >= 4 { 8 } else { 4 },
            real: if version == 1 { 4 } else { 8 },
            position: if version >= 3 { 8 } else { 4 },
        }
    }
}

/// The bytes of a file, or some of a binary one. All places are counted from the file's beginning.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    /// The file's name, for errors.
    pub path: &'a Path,
    /// Its bytes from `start` on.
    pub bytes: &'a [u8],
    /// Where these begin in the file.
    pub start: usize,
    /// Its encoding.
    pub encoding: Encoding,
}

/// The rows of one keyword.
#[derive(Clone, Debug)]
pub(super) struct Section {
    /// The keyword.
    pub keyword: Keyword,
    /// Rows as the header says.
    pub count: usize,
    /// The rows' bytes.
    pub body: Range<usize>,
    /// The fields of a solution.
    pub kinds: Vec<FieldKind>,
}

impl Section {
    /// Integers and reals in a row.
    pub(super) fn row(&self) -> (usize, usize) {
        let (ints, reals) = self.keyword.row();
        (ints, reals + self.kinds.iter().map(|k| k.values()).sum::<usize>())
    }
}

/// What a file holds.
pub(super) struct Contents<'a> {
    /// The bytes, with the final encoding.
    pub source: Source<'a>,
    /// The sections, each keyword once.
    pub sections: Vec<Section>,
    /// What was passed over.
    pub notices: Vec<String>,
}

impl Contents<'_> {
    /// Finds the sections of a file, told ASCII or binary by its first bytes.
    pub(super) fn of<'a>(path: &'a Path, bytes: &'a [u8]) -> Result<Contents<'a>, Error> {
        match bytes {
            [] => Err(empty(path)),
            [1, 0, 0, 0, ..] | [0, 0, 0, 1, ..] => {
                let mut contents = binary::contents(path, bytes, bytes[0] == 0)?;
                contents.source.bytes = bytes;
                Ok(contents)
            }
            _ => ascii::contents(path, bytes),
        }
    }

    /// The section of a keyword.
    pub(super) fn section(&self, keyword: Keyword) -> Option<&Section> {
        self.sections.iter().find(|s| s.keyword == keyword)
    }

    /// Rows of a keyword, none when it is absent.
    pub(super) fn count(&self, keyword: Keyword) -> usize {
        self.section(keyword).map_or(0, |s| s.count)
    }

    /// Takes a section in; a second one of the same keyword is an error, for either could be the true one.
    pub(super) fn add(&mut self, section: Section, at: usize) -> Result<(), Error> {
        if self.section(section.keyword).is_some() {
            let name = section.keyword.name();
            return Err(self.source.error(at, name, "the keyword comes a second time; join the two into one list"));
        }
        self.sections.push(section);
        Ok(())
    }
}

/// The error of a file without bytes.
pub(super) fn empty(path: &Path) -> Error {
    Error::content(path, "byte 0", "the file is empty; a mesh or solution file is expected")
}

impl Source<'_> {
    /// An error at a byte of the file.
    pub(super) fn error(&self, at: usize, context: &str, message: impl Into<String>) -> Error {
        Error::content(self.path, format!("{}, {context}", self.place(at)), message)
    }

    /// An error at a byte in a row, counted from 1.
    pub(super) fn row_error(&self, at: usize, section: &Section, row: usize, message: String) -> Error {
        let context = format!("{} {row} of {}", section.keyword.name(), section.count);
        self.error(at, &context, message)
    }

    /// A notice about a keyword that is passed over.
    pub(super) fn notice(&self, at: usize, keyword: &str) -> String {
        format!("{}: {}: {keyword} is not read, skipped", self.path.display(), self.place(at))
    }

    /// What a byte is called: its line in a text, counted from 1, else its number, from 0.
    fn place(&self, at: usize) -> String {
        match self.encoding {
            Encoding::Ascii => {
                let before = &self.bytes[..at.min(self.bytes.len())];
                format!("line {}", 1 + before.iter().filter(|&&b| b == b'\n').count())
            }
            Encoding::Binary(_) => format!("byte {at}"),
        }
    }
}

/// Kinds of a solution's fields from the numbers in its header.
pub(super) fn field_kinds(codes: impl Iterator<Item = i64>) -> Result<Vec<FieldKind>, String> {
    codes
        .map(|code| {
            FieldKind::from_code(code).ok_or_else(|| {
                format!("field type {code} is not known; 1 scalar, 2 vector, 3 symmetric tensor, 4 tensor are")
            })
        })
        .collect()
}

/// Only three dimensions are read. `size` is the number of bytes of the file.
pub(super) fn check_dimension(source: &Source, size: usize, dimension: Option<i64>) -> Result<(), Error> {
    match dimension {
        Some(3) => Ok(()),
        Some(d) => Err(source.error(0, "Dimension", format!("dimension {d} is not supported; give a mesh in 3D"))),
        None => Err(source.error(size, "Dimension", "Dimension is missing; 'Dimension 3' is expected")),
    }
}
