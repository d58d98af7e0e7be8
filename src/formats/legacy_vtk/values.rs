//! The values of a legacy file: words, or numbers with the most significant byte first.
use super::super::scan::{Scan, real_or_nan};
use crate::mesh::io::Error;

/// Type of values, with their bytes in a binary file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Int(usize),
    Unsigned(usize),
    Real(usize),
}

impl Kind {
    /// By VTK's word. Its own ids are written with 4 bytes.
    pub fn of(word: &str) -> Option<Self> {
        Some(match word.to_ascii_lowercase().as_str() {
            "char" => Self::Int(1),
            "unsigned_char" => Self::Unsigned(1),
            "short" => Self::Int(2),
            "unsigned_short" => Self::Unsigned(2),
            "int" | "vtkidtype" => Self::Int(4),
            "unsigned_int" => Self::Unsigned(4),
            "long" | "vtktypeint64" => Self::Int(8),
            "unsigned_long" | "vtktypeuint64" => Self::Unsigned(8),
            "float" => Self::Real(4),
            "double" => Self::Real(8),
            _ => return None,
        })
    }

    fn size(self) -> usize {
        let (Self::Int(size) | Self::Unsigned(size) | Self::Real(size)) = self;
        size
    }
}

/// Walks through a file.
pub(super) struct Source<'a> {
    pub scan: Scan<'a>,
    pub is_text: bool,
}

impl Source<'_> {
    /// An error here.
    pub fn fail(&self, message: impl Into<String>) -> Error {
        if self.is_text { self.scan.fail(message) } else { self.scan.fail_at_byte(message) }
    }

    /// So many values as real numbers.
    pub fn reals(&mut self, kind: Kind, count: usize) -> Result<Vec<f64>, Error> {
        let bytes = if self.is_text { 2 } else { kind.size() };
        let mut values = Vec::with_capacity(self.scan.room(count, bytes));
        for _ in 0..count {
            values.push(match kind {
                _ if self.is_text => {
                    let word = self.scan.word()?;
                    real_or_nan(word).map_err(|message| self.scan.fail(message))?
                }
                Kind::Real(4) => f32::from_ne_bytes(self.scan.number(true)?).into(),
                Kind::Real(_) => f64::from_ne_bytes(self.scan.number(true)?),
                Kind::Int(_) | Kind::Unsigned(_) => self.int(kind)? as f64,
            });
        }
        Ok(values)
    }

    /// So many values as whole numbers.
    pub fn ints(&mut self, kind: Kind, count: usize) -> Result<Vec<i64>, Error> {
        let bytes = if self.is_text { 2 } else { kind.size() };
        let mut values = Vec::with_capacity(self.scan.room(count, bytes));
        for _ in 0..count {
            values.push(if self.is_text { self.scan.int()? } else { self.int(kind)? });
        }
        Ok(values)
    }

    fn int(&mut self, kind: Kind) -> Result<i64, Error> {
        let scan = &mut self.scan;
        Ok(match kind {
            Kind::Int(1) => i8::from_ne_bytes(scan.number(true)?).into(),
            Kind::Unsigned(1) => u8::from_ne_bytes(scan.number(true)?).into(),
            Kind::Int(2) => i16::from_ne_bytes(scan.number(true)?).into(),
            Kind::Unsigned(2) => u16::from_ne_bytes(scan.number(true)?).into(),
            Kind::Int(4) => i32::from_ne_bytes(scan.number(true)?).into(),
            Kind::Unsigned(4) => u32::from_ne_bytes(scan.number(true)?).into(),
            // Greater ones than a mesh can have become negative, and are refused.
            Kind::Int(_) | Kind::Unsigned(_) => i64::from_ne_bytes(scan.number(true)?),
            Kind::Real(_) => return Err(self.fail("whole numbers are expected here, not real ones")),
        })
    }

    /// Passes over the next line, if it begins so.
    pub fn skip_line(&mut self, start: &[u8]) {
        let rest = self.scan.rest();
        let blank = rest.iter().take_while(|&&byte| byte <= b' ').count();
        // In a binary file the first byte of the values may be a blank.
        if rest.starts_with(start) || self.is_text && rest[blank..].starts_with(start) {
            self.scan.at += if self.is_text { blank } else { 0 };
            self.scan.line();
        }
    }
}

/// A name as VTK encodes it: %20 for a blank.
pub(super) fn decoded(word: &str) -> String {
    let bytes = word.as_bytes();
    let mut found = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let code = bytes[at..].strip_prefix(b"%").and_then(|rest| std::str::from_utf8(rest.get(..2)?).ok());
        // from_str_radix would take a sign.
        let code = code.filter(|code| code.bytes().all(|digit| digit.is_ascii_hexdigit()));
        match code.and_then(|code| u8::from_str_radix(code, 16).ok()) {
            Some(byte) => {
                found.push(byte);
                at += 3;
            }
            None => {
                found.push(bytes[at]);
                at += 1;
            }
        }
    }
    String::from_utf8_lossy(&found).into_owned()
}

/// A name as one word.
pub(super) fn encoded(name: &str) -> String {
    if name.is_empty() {
        return "unnamed".into();
    }
    let is_plain = |byte: u8| byte.is_ascii_graphic() && byte != b'"' && byte != b'%';
    let code = |byte: u8| if is_plain(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") };
    name.bytes().map(code).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_one_word_and_come_back() {
        for name in ["p", "Reynolds Stress", "100 %", "größe \"x\"\n", "%41"] {
            let word = encoded(name);
            assert!(word.bytes().all(|byte| byte.is_ascii_graphic()), "{word}");
            assert_eq!(decoded(&word), name);
        }
        assert_eq!(decoded("50%"), "50%");
        assert_eq!(decoded("%+1%zz"), "%+1%zz");
    }
}
