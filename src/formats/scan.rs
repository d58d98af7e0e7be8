//! Walking through a text.
use super::error;
use crate::mesh::io::Error;
use crate::mesh::io::number::{parse_int, parse_real};
use std::path::Path;

/// A place in a text. Blanks are all bytes up to 32.
pub(super) struct Scan<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    /// Where the next byte is.
    pub at: usize,
    /// Where the last line or word began: what errors name.
    last: usize,
}

impl<'a> Scan<'a> {
    /// At the beginning.
    pub fn new(path: &'a Path, bytes: &'a [u8]) -> Self {
        Self { path, bytes, at: 0, last: 0 }
    }

    /// Bytes that are left.
    pub fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The rest of this line, blanks at both ends cut off; none at the end.
    pub fn line(&mut self) -> Option<&'a [u8]> {
        let rest = self.bytes.get(self.at..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|&b| b == b'\n');
        self.last = self.at;
        self.at += length.map_or(rest.len(), |length| length + 1);
        Some(rest[..length.unwrap_or(rest.len())].trim_ascii())
    }

    /// The rest of this line as it is, without its end; none at the end.
    pub fn raw_line(&mut self) -> Option<&'a [u8]> {
        let start = self.at;
        self.line()?;
        let line = &self.bytes[start..self.at];
        let line = line.strip_suffix(b"\n").unwrap_or(line);
        Some(line.strip_suffix(b"\r").unwrap_or(line))
    }

    /// The next word of this line, a finite number; none where the line ends.
    pub fn real_here(&mut self) -> Result<Option<f64>, Error> {
        while let Some(&byte) = self.bytes.get(self.at) {
            match byte {
                b'\n' => return Ok(None),
                0..=b' ' => self.at += 1,
                _ => return self.real().map(Some),
            }
        }
        Ok(None)
    }

    /// The next word, on whatever line.
    #[inline]
    pub fn word(&mut self) -> Result<&'a [u8], Error> {
        while self.bytes.get(self.at).is_some_and(|&byte| byte <= b' ') {
            self.at += 1;
        }
        if self.left() == 0 {
            self.last = self.at;
            return Err(self.fail("the file ends here; it was cut, or a count is too large"));
        }
        Ok(self.take())
    }

    #[inline]
    fn take(&mut self) -> &'a [u8] {
        self.last = self.at;
        while self.bytes.get(self.at).is_some_and(|&byte| byte > b' ') {
            self.at += 1;
        }
        &self.bytes[self.last..self.at]
    }

    /// The next word, a whole number.
    #[inline]
    pub fn int(&mut self) -> Result<i64, Error> {
        let word = self.word()?;
        parse_int(word).map_err(|message| self.fail(message))
    }

    /// The next word, a finite number.
    #[inline]
    pub fn real(&mut self) -> Result<f64, Error> {
        let word = self.word()?;
        parse_real(word).map_err(|message| self.fail(message))
    }

    /// The next words, finite numbers.
    pub fn reals<const N: usize>(&mut self) -> Result<[f64; N], Error> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.real()?;
        }
        Ok(values)
    }

    /// The next word, the index of a vertex, from 0 after `base` is taken off.
    #[inline]
    pub fn vertex(&mut self, base: i64) -> Result<u32, Error> {
        let value = self.int()?;
        u32::try_from(value.wrapping_sub(base))
            .map_err(|_| self.fail(format!("{value} is no number of a vertex; they count from {base}")))
    }

    /// The next words, indices of vertices.
    #[inline]
    pub fn vertices<const N: usize>(&mut self, base: i64) -> Result<[u32; N], Error> {
        let mut nodes = [0; N];
        for node in &mut nodes {
            *node = self.vertex(base)?;
        }
        Ok(nodes)
    }

    /// How many there are, by the first word of a text.
    pub fn count(&self, text: &[u8]) -> Result<usize, Error> {
        let word = text.split(|byte| *byte <= b' ').find(|word| !word.is_empty()).unwrap_or_default();
        let count = parse_int(word).map_err(|message| self.fail(message))?;
        usize::try_from(count).map_err(|_| self.fail(format!("the count says {count}; 0 or more is expected")))
    }

    /// How many items to make room for: what a count says, but no more than fit into the bytes that are left, at `bytes` or more each.
    pub fn room(&self, count: usize, bytes: usize) -> usize {
        count.min(self.left() / bytes + 1)
    }

    /// All bytes that are left.
    pub fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// The next N bytes of a binary file, in the order of this machine; `big` says whether the most significant comes first in the file.
    #[inline]
    pub fn number<const N: usize>(&mut self, big: bool) -> Result<[u8; N], Error> {
        let Some(&(mut bytes)) = self.rest().first_chunk::<N>() else {
            return Err(self.fail_at_byte("the file ends here; it was cut, or a count is too large"));
        };
        self.at += N;
        if big != cfg!(target_endian = "big") {
            bytes.reverse();
        }
        Ok(bytes)
    }

    /// An error here, in a binary file.
    pub fn fail_at_byte(&self, message: impl Into<String>) -> Error {
        error::at(self.path, format!("byte {}", self.at), message)
    }

    /// An error at the last word or line.
    pub fn fail(&self, message: impl Into<String>) -> Error {
        let line = 1 + self.bytes[..self.last.min(self.bytes.len())].iter().filter(|&&b| b == b'\n').count();
        error::at(self.path, format!("line {line}"), message)
    }
}

/// A number; not a number where a solver that failed wrote nan or inf, so that the field alone is lost.
pub(super) fn real_or_nan(word: &[u8]) -> Result<f64, String> {
    parse_real(word).or_else(|message| {
        let digits = word.strip_prefix(b"-").or(word.strip_prefix(b"+")).unwrap_or(word);
        let is_endless = [&b"nan"[..], b"inf", b"infinity"].iter().any(|other| digits.eq_ignore_ascii_case(other));
        if is_endless { Ok(f64::NAN) } else { Err(message) }
    })
}
