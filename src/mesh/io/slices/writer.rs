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

/// Rows that were written: the section, the first row, and the one behind the last.
pub type Written = [u64; 3];

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

    /// As [`MeshWriter::create`], of a file that another process has begun, for the same counts.
    ///
    /// # Errors
    /// As there, and [`Error::Content`] where the file is not that one.
    pub fn join(file: File, path: &Path, counts: &MeshCounts) -> Result<Self, Error> {
        Writer::join(file, path, &sections(|keyword| counts.rows(keyword)), *counts).map(Self)
    }

    /// Writes the rows of a slice, from row `start` (from 0) of its section on.
    ///
    /// # Errors
    /// [`Error::Content`] for rows that are not in the section or are written already, for an index out of range and for a value that is not
    /// finite; [`Error::System`] when the file cannot be written. After an error the file is of no use.
    pub fn put(&self, team: Team<'_>, start: usize, slice: Slice<'_>) -> Result<(), Error> {
        self.0.put(team, start, slice)
    }

    /// Ends what a process that joined has to write: all of it is on the disk. Returns which rows these are, for [`MeshWriter::add_written`].
    ///
    /// # Errors
    /// [`Error::System`] when the disk refuses.
    pub fn leave(self) -> Result<Vec<Written>, Error> {
        self.0.leave()
    }

    /// Another process has written these rows.
    ///
    /// # Errors
    /// [`Error::Content`] where one is not in the file, or was written before.
    pub fn add_written(&self, rows: &[Written]) -> Result<(), Error> {
        self.0.add_written(rows)
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
        Writer::create(file, path, &[tensors(vertices)], MeshCounts { vertices, ..MeshCounts::default() }).map(Self)
    }

    /// As [`MeshWriter::join`].
    ///
    /// # Errors
    /// As there.
    pub fn join(file: File, path: &Path, vertices: usize) -> Result<Self, Error> {
        Writer::join(file, path, &[tensors(vertices)], MeshCounts { vertices, ..MeshCounts::default() }).map(Self)
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

    /// As [`MeshWriter::leave`].
    ///
    /// # Errors
    /// As there.
    pub fn leave(self) -> Result<Vec<Written>, Error> {
        self.0.leave()
    }

    /// As [`MeshWriter::add_written`].
    ///
    /// # Errors
    /// As there.
    pub fn add_written(&self, rows: &[Written]) -> Result<(), Error> {
        self.0.add_written(rows)
    }

    /// Ends the file.
    ///
    /// # Errors
    /// [`Error::Content`] when tensors are missing.
    pub fn finish(self) -> Result<(), Error> {
        self.0.finish()
    }
}

/// A solution file (.solb), some fields at each vertex, whose rows come in any order, from any thread.
#[derive(Debug)]
pub struct SolutionWriter(Writer);

impl SolutionWriter {
    /// Begins an empty file, which is ours, for so many vertices with fields of these kinds. `path` is what errors say.
    ///
    /// # Errors
    /// [`Error::System`] when it cannot be written.
    pub fn create(file: File, path: &Path, vertices: usize, kinds: &[FieldKind]) -> Result<Self, Error> {
        let section = Section { keyword: Keyword::SolAtVertices, count: vertices, body: 0..0, kinds: kinds.to_vec() };
        Writer::create(file, path, &[section], MeshCounts { vertices, ..MeshCounts::default() }).map(Self)
    }

    /// Writes rows of all values of a vertex, shape (n, width), from vertex `start` (from 0) on.
    ///
    /// # Errors
    /// As of [`MeshWriter::put`].
    pub fn put(&self, team: Team<'_>, start: usize, (width, values): (usize, &[f64])) -> Result<(), Error> {
        self.0.put(team, start, Slice::Fields(width, values))
    }

    /// Ends the file.
    ///
    /// # Errors
    /// [`Error::Content`] when rows are missing.
    pub fn finish(self) -> Result<(), Error> {
        self.0.finish()
    }
}

/// The section of a metric.
fn tensors(vertices: usize) -> Section {
    Section { keyword: Keyword::SolAtVertices, count: vertices, body: 0..0, kinds: vec![FieldKind::SymmetricTensor] }
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
    /// The last head ends the file, so it has its whole length from now on.
    fn create(file: File, path: &Path, sections: &[Section], counts: MeshCounts) -> Result<Self, Error> {
        let frame = frame(version(sections), sections);
        let writer = Self::of(file, path, &frame, sections, counts);
        let heads = frame.iter().try_for_each(|framed| writer.file.write(&framed.head, framed.place));
        heads.map_err(|error| Error::system(path, error))?;
        Ok(writer)
    }

    fn join(file: File, path: &Path, sections: &[Section], counts: MeshCounts) -> Result<Self, Error> {
        let frame = frame(version(sections), sections);
        let wanted = frame.last().map_or(0, |end| end.place + end.head.len() as u64);
        let writer = Self::of(file, path, &frame, sections, counts);
        let size = writer.file.size().map_err(|error| Error::system(path, error))?;
        if size != wanted {
            let message = format!("it has {size} bytes, and the process that has begun it says {wanted}");
            return Err(Error::content(path, "the file", message));
        }
        Ok(writer)
    }

    fn of(file: File, path: &Path, frame: &[Framed<'_>], sections: &[Section], counts: MeshCounts) -> Self {
        let body = |framed: &Framed<'_>| {
            let (section, row) = framed.rows?;
            Some(Body {
                keyword: section.keyword,
                count: section.count,
                place: framed.place + framed.head.len() as u64,
                row,
                written: Mutex::default(),
            })
        };
        let words = Words::of_version(version(sections), false);
        let bodies = frame.iter().filter_map(body).collect();
        Self { file: Positioned::new(file), path: path.into(), words, counts, bodies }
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
        self.take(body, start..end)?;
        let written = team.chunks(ROWS, slice.len(), |rows| self.write(body, start, &slice, rows));
        written.into_iter().collect()
    }

    /// These rows are written.
    fn take(&self, body: &Body, rows: Range<usize>) -> Result<(), Error> {
        let taken = body.written.lock().unwrap_or_else(PoisonError::into_inner).add(rows);
        let place = |row: usize| format!("{} {}", body.keyword.name(), row + 1);
        taken.map_err(|row| Error::content(&self.path, place(row), "the row comes a second time"))
    }

    fn leave(self) -> Result<Vec<Written>, Error> {
        self.file.sync().map_err(|error| Error::system(&self.path, error))?;
        let of_body = |(section, body): (u64, Body)| {
            let written = body.written.into_inner().unwrap_or_else(PoisonError::into_inner);
            written.ranges().map(|rows| [section, rows.start as u64, rows.end as u64]).collect::<Vec<_>>()
        };
        Ok((0..).zip(self.bodies).flat_map(of_body).collect())
    }

    fn add_written(&self, rows: &[Written]) -> Result<(), Error> {
        rows.iter().try_for_each(|rows| {
            let [section, start, end] = rows.map(|number| usize::try_from(number).unwrap_or(usize::MAX));
            let body = self.bodies.get(section).filter(|body| start <= end && end <= body.count);
            let unknown = || Error::content(&self.path, "the file", "another process has written other sections");
            self.take(body.ok_or_else(unknown)?, start..end)
        })
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
