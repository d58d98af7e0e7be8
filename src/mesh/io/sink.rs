//! How the values of rows become bytes: a text, or words.
use super::source::Words;
use std::io::Write;

/// Takes rows value by value.
pub(super) trait Sink {
    /// An integer of a row.
    fn int(&mut self, value: i64);
    /// A real of a row.
    fn real(&mut self, value: f64);
    /// The end of a row.
    fn end_row(&mut self);
}

/// A text; reals with as few digits as lead back to the same number.
pub(super) struct Text<'b>(pub &'b mut Vec<u8>);

impl Text<'_> {
    pub(super) fn text(&mut self, text: std::fmt::Arguments) {
        self.0.write_fmt(text).expect("writing to memory");
    }
}

impl Sink for Text<'_> {
    fn int(&mut self, value: i64) {
        self.text(format_args!("{value} "));
    }

    fn real(&mut self, value: f64) {
        self.text(format_args!("{value:?} "));
    }

    fn end_row(&mut self) {
        self.0.pop(); // the blank
        self.0.push(b'\n');
    }
}

/// Words of a binary file, least significant byte first.
pub(super) struct Binary<'b> {
    pub bytes: &'b mut Vec<u8>,
    pub words: Words,
}

impl Binary<'_> {
    /// A word that is as long in all versions.
    pub(super) fn word(&mut self, value: i32) {
        self.bytes.extend_from_slice(&value.to_le_bytes());
    }

    /// An integer of 4 or 8 bytes.
    #[inline(always)]
    pub(super) fn sized(&mut self, value: i64, size: usize) {
        // Each of a length that is known here: twice as fast.
        match size {
            4 => self.bytes.extend_from_slice(&(value as i32).to_le_bytes()),
            _ => self.bytes.extend_from_slice(&value.to_le_bytes()),
        }
    }
}

impl Sink for Binary<'_> {
    #[inline(always)]
    fn int(&mut self, value: i64) {
        self.sized(value, self.words.int);
    }

    #[inline(always)]
    fn real(&mut self, value: f64) {
        self.bytes.extend_from_slice(&value.to_le_bytes());
    }

    #[inline(always)]
    fn end_row(&mut self) {}
}
