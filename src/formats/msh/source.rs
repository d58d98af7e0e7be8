//! The values of a .msh, as words or as bytes.
use super::super::error;
use super::super::scan::Scan;
use crate::mesh::io::Error;
use std::path::Path;

/// How numbers stand in the file.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    /// Bytes; whether the most significant comes first.
    Binary {
        big: bool,
    },
}

/// A place in a file.
pub(super) struct Source<'a> {
    /// Walks through lines and words.
    pub scan: Scan<'a>,
    pub encoding: Encoding,
}

impl<'a> Source<'a> {
    /// At the beginning; a text until the head tells other.
    pub fn new(path: &'a Path, bytes: &'a [u8]) -> Self {
        Self { scan: Scan::new(path, bytes), encoding: Encoding::Text }
    }

    /// The bytes from here.
    pub fn rest(&self) -> &'a [u8] {
        self.scan.rest()
    }

    /// Whether it is a text.
    pub fn is_text(&self) -> bool {
        self.encoding == Encoding::Text
    }

    /// An error here.
    pub fn fail(&self, message: impl Into<String>) -> Error {
        match self.encoding {
            Encoding::Text => self.scan.fail(message),
            Encoding::Binary { .. } => self.scan.fail_at_byte(message),
        }
    }

    /// An int.
    #[inline]
    pub fn int(&mut self) -> Result<i64, Error> {
        match self.encoding {
            Encoding::Text => self.scan.int(),
            Encoding::Binary { big } => self.scan.number(big).map(|bytes| i32::from_ne_bytes(bytes).into()),
        }
    }

    /// A size_t: a count, or a tag of a node or element.
    #[inline]
    pub fn size(&mut self) -> Result<usize, Error> {
        let value = match self.encoding {
            Encoding::Text => self.scan.int()?,
            Encoding::Binary { big } => i64::from_ne_bytes(self.scan.number(big)?),
        };
        usize::try_from(value).map_err(|_| self.fail(format!("{value} stands where a count or number is expected")))
    }

    /// A double.
    #[inline]
    pub fn real(&mut self) -> Result<f64, Error> {
        match self.encoding {
            Encoding::Text => self.scan.real(),
            Encoding::Binary { big } => self.scan.number(big).map(f64::from_ne_bytes),
        }
    }

    /// Three doubles, finite.
    pub fn point(&mut self) -> Result<[f64; 3], Error> {
        let point = [self.real()?, self.real()?, self.real()?];
        if point.iter().all(|x| x.is_finite()) {
            Ok(point)
        } else {
            Err(self.fail("a coordinate is not finite; correct it"))
        }
    }

    /// Passes over so many bytes, where it is no text.
    pub fn skip(&mut self, bytes: usize) -> Result<(), Error> {
        if bytes > self.scan.left() {
            return Err(self.fail("the file ends here; it was cut, or a count is too large"));
        }
        self.scan.at += bytes;
        Ok(())
    }

    /// How many items to make room for: what a count says, but no more than fit into the rest, at so many numbers or more each.
    pub fn room(&self, count: usize, numbers: usize) -> usize {
        let least = if self.is_text() { 2 } else { 4 };
        self.scan.room(count, least * numbers)
    }

    /// Moves on behind the end of a section.
    pub fn leave(&mut self, section: &[u8]) -> Result<(), Error> {
        let end = [b"$End", section].concat();
        let rest = self.scan.rest();
        let Some(at) = rest.windows(end.len()).position(|part| part == end) else {
            let section = error::short(&String::from_utf8_lossy(section));
            return Err(self.fail(format!("$End{section} is missing: the file was cut off")));
        };
        self.scan.at += at + end.len();
        Ok(())
    }
}
