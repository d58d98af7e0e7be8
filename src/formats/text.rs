//! Writing texts: numbers with as few digits as lead back to the same number.
use std::io::{self, Write};

/// Bytes that are gathered before they are handed on.
const FULL: usize = 1 << 16;

/// A text on its way to a file.
pub(super) struct Text<'a> {
    to: &'a mut dyn Write,
    bytes: Vec<u8>,
}

impl<'a> Text<'a> {
    /// Nothing yet.
    pub fn new(to: &'a mut dyn Write) -> Self {
        Self { to, bytes: Vec::with_capacity(2 * FULL) }
    }

    /// Adds formatted text.
    #[inline]
    pub fn put(&mut self, text: std::fmt::Arguments) {
        self.bytes.write_fmt(text).expect("writing to memory");
    }

    /// Adds a whole number and a blank.
    #[inline]
    pub fn int(&mut self, value: impl Into<i64>) {
        self.put(format_args!("{} ", value.into()));
    }

    /// Adds a number and a blank.
    #[inline]
    pub fn real(&mut self, value: f64) {
        self.put(format_args!("{value:?} "));
    }

    /// Ends a line; a blank or comma before it goes.
    #[inline]
    pub fn end_line(&mut self) -> io::Result<()> {
        if let Some(last @ (b' ' | b',')) = self.bytes.last_mut() {
            *last = b'\n';
        } else {
            self.bytes.push(b'\n');
        }
        self.hand_on()
    }

    /// Adds bytes.
    #[inline]
    pub fn raw(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// Hands the bytes on where there are many.
    #[inline]
    pub fn hand_on(&mut self) -> io::Result<()> {
        if self.bytes.len() > FULL { self.finish() } else { Ok(()) }
    }

    /// Hands on what is left.
    pub fn finish(&mut self) -> io::Result<()> {
        self.to.write_all(&self.bytes)?;
        self.bytes.clear();
        Ok(())
    }
}
