//! The values of a section, one after the other, checked.
use super::Error;
use super::keyword::Keyword;
use super::source::{Section, Source};

/// Walks through the values of a section. Errors are the message alone; [`rows`] adds the place.
pub(super) trait Cursor<'a> {
    /// At the first value.
    fn new(source: &Source<'a>, section: &Section) -> Self;
    /// The next value, an integer.
    fn int(&mut self) -> Result<i64, String>;
    /// The next value, a real; may be infinite or NaN.
    fn raw_real(&mut self) -> Result<f64, String>;
    /// Byte at which the last value begins.
    fn at(&self) -> usize;
    /// An error if there are values left.
    fn finish(&mut self) -> Result<(), String>;

    /// The next value, a finite real.
    fn real(&mut self) -> Result<f64, String> {
        let value = self.raw_real()?;
        if value.is_finite() { Ok(value) } else { Err(format!("{value} is not a finite number")) }
    }

    /// The next values, finite reals.
    fn reals<const N: usize>(&mut self) -> Result<[f64; N], String> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.real()?;
        }
        Ok(values)
    }

    /// The next value, a reference or an id.
    fn reference(&mut self) -> Result<i32, String> {
        let value = self.int()?;
        i32::try_from(value).map_err(|_| format!("reference {value} does not fit 32 bits; renumber the references"))
    }

    /// The next value, an index from 1 into `limit` entities of a keyword, as one from 0.
    fn index(&mut self, limit: usize, of: Keyword) -> Result<u32, String> {
        let value = self.int()?;
        match u32::try_from(value.wrapping_sub(1)) {
            Ok(index) if (index as usize) < limit => Ok(index),
            _ => Err(format!("index {value} is out of range: the file has {limit} {}, counted from 1", of.name())),
        }
    }
}

/// Calls `row` for each row of a section, with a cursor at its first value.
pub(super) fn rows<'a, C: Cursor<'a>>(
    source: &Source<'a>,
    section: &Section,
    mut row: impl FnMut(&mut C) -> Result<(), String>,
) -> Result<(), Error> {
    let mut cursor = C::new(source, section);
    for number in 1..=section.count {
        row(&mut cursor).map_err(|message| source.row_error(cursor.at(), section, number, message))?;
    }
    cursor.finish().map_err(|message| source.error(cursor.at(), section.keyword.name(), message))
}

/// Rows to make room for: what the header says, but no more than the bytes can hold, for headers lie.
pub(super) fn room(section: &Section) -> usize {
    let (ints, reals) = section.row();
    // the shortest value is a digit and a blank
    section.count.min(section.body.len() / (2 * (ints + reals).max(1)) + 1)
}
