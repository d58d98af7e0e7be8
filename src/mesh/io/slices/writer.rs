//! Writing binary files by slices.
use super::super::keyword::Keyword;
use super::super::layout::{Framed, frame, version};
use super::super::rows::{Slice, sections};
use super::super::sink::Binary;
use super::super::source::{Section, Words};
use super::super::write::{check_counts, check_slice};
use super::super::{Error, FieldKind, MeshCounts};
use super::covered::Covered;
use super::file::Positioned;
use crate::tasks::{GRAIN, Team};
use std::fs::File;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Rows that are encoded at once: some hundred kilobytes.
const ROWS: usize = GRAIN;

/// A mesh file (.meshb) whose rows come in any order, from any thread.
#[derive(Debug)]
pub struct MeshWriter(Writer);

impl MeshWriter {
    /// Begins an empty file, which is ours, with the heads of all sections. `path` is what errors say. The version is 2, 3 or 4, as the size
    /// asks for.
    ///
    /// # Errors
    /// [`Error::Content`] without vertices, [`Error::System`] when it cannot be written.
    pub fn create(file: File, path: &Path, counts: &MeshCounts) -> Result<Self, Error> {
        check_counts(counts).map_err(|(place, message)| Error::content(path, place, message))?;
        Writer::create(file, path, &sections(|keyword| counts.rows(keyword)), *counts).map(Self)
    }

    /// Writes the rows of a slice, from row `start` (from 0) of its section on.
    ///
    /// # Errors
    /// [`Error::Content`] for rows that are not in the section or are written already, for an index out of range and for a value that is not
    /// finite; [`Error::System`] when the file cannot be written. After an error the file is of no use.
    pub fn put(&self, team: Team<'_>, start: usize, slice: Slice<'_>) -> Result<(), Error> {
        self.0.put(team, start, slice)
    }

    /// Ends the file.
    ///
    /// # Errors
    /// [`Error::Content`] when rows are missing.
    pub fn finish(self) -> Result<(), Error> {
        self.0.finish()
    }
}

/// A metric file (.solb), one symmetric tensor at each vertex, whose rows come in any order, from any thread.
#[derive(Debug)]
pub struct MetricWriter(Writer);

impl MetricWriter {
    /// Begins an empty file, which is ours, for so many vertices. `path` is what errors say.
    ///
    /// # Errors
    /// [`Error::System`] when it cannot be written.
    pub fn create(file: File, path: &Path, vertices: usize) -> Result<Self, Error> {
        let kinds = vec![FieldKind::SymmetricTensor];
        let section = Section { keyword: Keyword::SolAtVertices, count: vertices, body: 0..0, kinds };
        Writer::create(file, path, &[section], MeshCounts { vertices, ..MeshCounts::default() }).map(Self)
    }

    /// The file's name, for errors.
    pub fn path(&self) -> &Path {
        &self.0.path
    }

    /// Writes tensors, shape (n, 6), each 11 12 22 13 23 33, from vertex `start` (from 0) on.
    ///
    /// # Errors
    /// As of [`MeshWriter::put`]. Whether they are positive definite is not asked here.
    pub fn put(&self, team: Team<'_>, start: usize, tensors: &[[f64; 6]]) -> Result<(), Error> {
        self.0.put(team, start, Slice::Tensors(tensors))
    }

    /// Ends the file.
    ///
    /// # Errors
    /// [`Error::Content`] when tensors are missing.
    pub fn finish(self) -> Result<(), Error> {
        self.0.finish()
    }
}

/// A file and where the rows of its sections are.
#[derive(Debug)]
struct Writer {
    file: Positioned,
    path: PathBuf,
    words: Words,
    /// What indices are checked against.
    counts: MeshCounts,
    bodies: Vec<Body>,
}

/// The rows of a section.
#[derive(Debug)]
struct Body {
    keyword: Keyword,
    count: usize,
    /// Where they begin.
    place: u64,
    /// Bytes of one.
    row: usize,
    written: Mutex<Covered>,
}

impl Writer {
    fn create(file: File, path: &Path, sections: &[Section], counts: MeshCounts) -> Result<Self, Error> {
        let version = version(sections);
        let (file, mut bodies) = (Positioned::new(file), Vec::new());
        for Framed { place, head, rows } in frame(version, sections) {
            file.write(&head, place).map_err(|error| Error::system(path, error))?;
            bodies.extend(rows.map(|(section, row)| Body {
                keyword: section.keyword,
                count: section.count,
                place: place + head.len() as u64,
                row,
                written: Mutex::default(),
            }));
        }
        Ok(Self { file, path: path.into(), words: Words::of_version(version, false), counts, bodies })
    }

    fn put(&self, team: Team<'_>, start: usize, slice: Slice<'_>) -> Result<(), Error> {
        let fail = |(place, message): (String, String)| Error::content(&self.path, place, message);
        check_slice(team, &slice, start, &self.counts).map_err(fail)?;
        if slice.is_empty() {
            return Ok(());
        }
        let keyword = slice.keyword();
        let body = self.bodies.iter().find(|body| body.keyword == keyword);
        let end = start.saturating_add(slice.len());
        let Some(body) = body.filter(|body| end <= body.count) else {
            let count = body.map_or(0, |body| body.count);
            let message = format!("rows {} to {end} are given, but the file is for {count}", start + 1);
            return Err(fail((keyword.name().into(), message)));
        };
        let taken = body.written.lock().unwrap_or_else(PoisonError::into_inner).add(start..end);
        taken.map_err(|row| fail((format!("{} {}", keyword.name(), row + 1), "the row comes a second time".into())))?;
        let written = team.chunks(ROWS, slice.len(), |rows| self.write(body, start, &slice, rows));
        written.into_iter().collect()
    }

    /// Writes some rows of a slice that begins at row `start`.
    fn write(&self, body: &Body, start: usize, slice: &Slice<'_>, rows: Range<usize>) -> Result<(), Error> {
        let place = body.place + (start + rows.start) as u64 * body.row as u64;
        let mut bytes = Vec::with_capacity(rows.len() * body.row);
        slice.write(rows, &mut Binary { bytes: &mut bytes, words: self.words });
        self.file.write(&bytes, place).map_err(|error| Error::system(&self.path, error))
    }

    fn finish(self) -> Result<(), Error> {
        for Body { keyword, count, written, .. } in self.bodies {
            let (rows, first) = written.into_inner().unwrap_or_else(PoisonError::into_inner).rows();
            if rows < count {
                let message = format!("{rows} rows of {count} were written; row {} is missing", first + 1);
                return Err(Error::content(&self.path, keyword.name(), message));
            }
        }
        Ok(())
    }
}
