//! The values of a section, one after the other, checked.
use super::Error;
use super::keyword::Keyword;
use super::source::{Section, Source};
use crate::tasks::{GRAIN, Team};
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

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
    /// A cursor at the first value of a row, counted from 0; none where its place depends on the rows before.
    fn at_row(source: &Source<'a>, section: &Section, row: usize) -> Option<Self>
    where
        Self: Sized;
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

/// Rows of a binary file a task.
const ROWS: usize = 4 * GRAIN;

/// What `row` makes of each row of a section, as two lists. Where the places of rows are known, all threads read; `none` fills the lists
/// first.
pub(super) fn columns<'a, C: Cursor<'a>, A: Copy + Send, B: Copy + Send>(
    team: Team<'_>,
    source: &Source<'a>,
    section: &Section,
    none: (A, B),
    row: impl Fn(&mut C) -> Result<(A, B), String> + Sync,
) -> Result<(Vec<A>, Vec<B>), Error> {
    if C::at_row(source, section, 0).is_none() {
        let room = room(section);
        let (mut first, mut second) = (Vec::with_capacity(room), Vec::with_capacity(room));
        rows::<C>(source, section, |cursor| {
            let (a, b) = row(cursor)?;
            first.push(a);
            second.push(b);
            Ok(())
        })?;
        return Ok((first, second));
    }
    // A binary section has as many rows as it says.
    let (mut first, mut second) = (vec![none.0; section.count], vec![none.1; section.count]);
    let mut blocks: Vec<_> = first.chunks_mut(ROWS).zip(second.chunks_mut(ROWS)).collect();
    let fault = Fault::default();
    team.fill(1, &mut blocks, |start, blocks| {
        for ((first, second), block) in blocks.iter_mut().zip(start..) {
            fault.in_rows::<C>(source, section, block * ROWS..block * ROWS + first.len(), |cursor, place| {
                (first[place], second[place]) = row(cursor)?;
                Ok(())
            });
        }
    });
    drop(blocks);
    fault.result(source, section).map(|()| (first, second))
}

/// The first fault that several tasks find in a section: byte, row from 0, message.
#[derive(Default)]
pub(super) struct Fault(Mutex<Option<(usize, usize, String)>>);

impl Fault {
    /// Calls `row` for these rows of a section in which the places of rows are known, with the number of the row among them, up to a fault.
    pub(super) fn in_rows<'a, C: Cursor<'a>>(
        &self,
        source: &Source<'a>,
        section: &Section,
        range: Range<usize>,
        mut row: impl FnMut(&mut C, usize) -> Result<(), String>,
    ) {
        let Some(mut cursor) = C::at_row(source, section, range.start) else { return };
        for number in range.clone() {
            if let Err(message) = row(&mut cursor, number - range.start) {
                let mut fault = self.0.lock().unwrap_or_else(PoisonError::into_inner);
                if fault.as_ref().is_none_or(|fault| cursor.at() < fault.0) {
                    *fault = Some((cursor.at(), number, message));
                }
                return;
            }
        }
    }

    /// The fault as an error, if there is one.
    pub(super) fn result(self, source: &Source<'_>, section: &Section) -> Result<(), Error> {
        match self.0.into_inner().unwrap_or_else(PoisonError::into_inner) {
            None => Ok(()),
            Some((at, row, message)) => Err(source.row_error(at, section, row + 1, message)),
        }
    }
}

/// How many rows to make room for: what the header says, but no more than the bytes can hold, since a header may be wrong.
pub(super) fn room(section: &Section) -> usize {
    let (ints, reals) = section.row();
    // the shortest value is a digit and a blank
    section.count.min(section.body.len() / (2 * (ints + reals).max(1)) + 1)
}
