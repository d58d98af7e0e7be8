//! Reading binary files by slices.
use super::super::binary::{self, BinaryCursor, Bytes, row_size};
use super::super::cursor::{Cursor, Fault};
use super::super::keyword::Keyword;
use super::super::read::{
    association, check_mesh, element, indices, mesh_notices, solution_notices, solution_section, vertex,
};
use super::super::source::{Contents, Encoding, Section, Source, Words, empty};
use super::super::{Error, FieldKind, MeshCounts, Solution, SolutionField, check_regular};
use super::file::{Heads, Positioned};
use crate::mesh::vector::Vec3;
use crate::mesh::{Association, Elements};
use crate::tasks::{GRAIN, Team};
use std::fs::File;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Rows that are read at once: some hundred kilobytes.
const ROWS: usize = GRAIN;

/// A mesh file (.meshb, any version and byte order) of which ranges of rows are read. Many threads may read at once.
#[derive(Debug)]
pub struct MeshReader {
    reader: Reader,
    counts: MeshCounts,
    notices: Vec<String>,
}

impl MeshReader {
    /// Reads the heads of the sections, no rows.
    ///
    /// # Errors
    /// [`Error::System`] when the file cannot be read, [`Error::Content`] when it is a text, has no vertices, has cells that are no tetrahedra, or
    /// what its heads say cannot be true.
    pub fn open(path: &Path) -> Result<Self, Error> {
        Reader::open(path, |contents| {
            check_mesh(&contents)?;
            refuse_stack(&contents)?;
            let counts = MeshCounts::from_each(|keyword| contents.count(keyword));
            Ok((counts, mesh_notices(contents)))
        })
        .map(|(reader, (counts, notices))| Self { reader, counts, notices })
    }

    /// The file's name, for errors.
    pub fn path(&self) -> &Path {
        &self.reader.path
    }

    /// Number of rows of each section.
    pub fn counts(&self) -> &MeshCounts {
        &self.counts
    }

    /// Notices about what is passed over, to be shown to the user.
    pub fn notices(&self) -> &[String] {
        &self.notices
    }

    /// Coordinates, shape (n, 3), and references, shape (n,), of these vertices, from 0.
    ///
    /// # Errors
    /// [`Error::Content`] for vertices that are not there and for wrong values, [`Error::System`] when the file cannot be read.
    pub fn vertices(&self, team: Team<'_>, range: Range<usize>) -> Result<(Vec<Vec3>, Vec<i32>), Error> {
        let row = |row: &mut BinaryCursor<'_>| vertex(row);
        self.reader.columns(team, Keyword::Vertices, range, ([0.0; 3], 0), row)
    }

    /// These tagged edges, from 0; their nodes count from 0 in the whole mesh.
    ///
    /// # Errors
    /// As of [`MeshReader::vertices`].
    pub fn edges(&self, team: Team<'_>, range: Range<usize>) -> Result<Elements<2>, Error> {
        self.elements(team, Keyword::Edges, range)
    }

    /// These triangles, as [`MeshReader::edges`].
    ///
    /// # Errors
    /// As there.
    pub fn triangles(&self, team: Team<'_>, range: Range<usize>) -> Result<Elements<3>, Error> {
        self.elements(team, Keyword::Triangles, range)
    }

    /// These tetrahedra, as [`MeshReader::edges`].
    ///
    /// # Errors
    /// As there.
    pub fn tets(&self, team: Team<'_>, range: Range<usize>) -> Result<Elements<4>, Error> {
        self.elements(team, Keyword::Tetrahedra, range)
    }

    /// Vertices that are corners: all of them, as the other lists.
    ///
    /// # Errors
    /// As of [`MeshReader::vertices`].
    pub fn corners(&self) -> Result<Vec<u32>, Error> {
        self.list(Keyword::Corners)
    }

    /// Edges that are ridges.
    ///
    /// # Errors
    /// As of [`MeshReader::vertices`].
    pub fn ridges(&self) -> Result<Vec<u32>, Error> {
        self.list(Keyword::Ridges)
    }

    /// Vertices that must stay.
    ///
    /// # Errors
    /// As of [`MeshReader::vertices`].
    pub fn required_vertices(&self) -> Result<Vec<u32>, Error> {
        self.list(Keyword::RequiredVertices)
    }

    /// Edges that must stay.
    ///
    /// # Errors
    /// As of [`MeshReader::vertices`].
    pub fn required_edges(&self) -> Result<Vec<u32>, Error> {
        self.list(Keyword::RequiredEdges)
    }

    /// Triangles that must stay.
    ///
    /// # Errors
    /// As of [`MeshReader::vertices`].
    pub fn required_triangles(&self) -> Result<Vec<u32>, Error> {
        self.list(Keyword::RequiredTriangles)
    }

    /// The association with a CAD model.
    ///
    /// # Errors
    /// As of [`MeshReader::vertices`].
    pub fn association(&self) -> Result<Association, Error> {
        let mut found = Association::default();
        for keyword in [Keyword::OnVertices, Keyword::OnEdges, Keyword::OnFaces] {
            self.reader.whole(keyword, |source, section| {
                association::<BinaryCursor>(source, section, self.counts.vertices, &mut found)
            })?;
        }
        Ok(found)
    }

    fn elements<const N: usize>(
        &self,
        team: Team<'_>,
        keyword: Keyword,
        range: Range<usize>,
    ) -> Result<Elements<N>, Error> {
        let vertices = self.counts.vertices;
        let row = |row: &mut BinaryCursor<'_>| element(row, vertices);
        let (nodes, refs) = self.reader.columns(team, keyword, range, ([0; N], 0), row)?;
        Ok(Elements { nodes, refs })
    }

    fn list(&self, keyword: Keyword) -> Result<Vec<u32>, Error> {
        let limit = self.counts.rows(keyword.target());
        let list = self.reader.whole(keyword, |source, section| indices::<BinaryCursor>(source, section, limit))?;
        Ok(list.unwrap_or_default())
    }
}

/// Cells that are no tetrahedra would be lost.
fn refuse_stack(contents: &Contents<'_>) -> Result<(), Error> {
    let is_of_stack = |keyword: Keyword| keyword == Keyword::Quadrilaterals || keyword.kind().is_some();
    match contents.sections.iter().find(|section| section.count > 0 && is_of_stack(section.keyword)) {
        None => Ok(()),
        Some(Section { keyword, count, body, .. }) => {
            let message = format!(
                "there are {count}, which are not read by slices; split them by `geo-adapt convert --split` first"
            );
            Err(contents.source.error(body.start, keyword.name(), message))
        }
    }
}

/// A solution file (.solb) of which ranges of vertices are read. Many threads may read at once.
#[derive(Debug)]
pub struct SolutionReader {
    reader: Reader,
    vertices: usize,
    kinds: Vec<FieldKind>,
    notices: Vec<String>,
}

impl SolutionReader {
    /// Reads the heads of the sections, no rows.
    ///
    /// # Errors
    /// As of [`MeshReader::open`].
    pub fn open(path: &Path) -> Result<Self, Error> {
        Reader::open(path, |contents| {
            let section = solution_section(&contents)?;
            let (vertices, kinds) = (section.count, section.kinds.clone());
            Ok((vertices, kinds, solution_notices(contents)))
        })
        .map(|(reader, (vertices, kinds, notices))| Self { reader, vertices, kinds, notices })
    }

    /// The file's name, for errors.
    pub fn path(&self) -> &Path {
        &self.reader.path
    }

    /// Number of vertices.
    pub fn vertices(&self) -> usize {
        self.vertices
    }

    /// The fields.
    pub fn kinds(&self) -> &[FieldKind] {
        &self.kinds
    }

    /// Notices about what is passed over, to be shown to the user.
    pub fn notices(&self) -> &[String] {
        &self.notices
    }

    /// All values of these vertices, from 0, in rows of those of a vertex: shape (n, width).
    ///
    /// # Errors
    /// As of [`MeshReader::vertices`].
    pub fn rows(&self, team: Team<'_>, range: Range<usize>) -> Result<Vec<f64>, Error> {
        let width = self.width();
        let section = self.reader.section(Keyword::SolAtVertices, &range)?;
        let mut rows = vec![0.0; width * range.len()];
        if width > 0 {
            let parts = rows.chunks_mut(width * ROWS).collect();
            self.reader.fill(team, section, range, parts, |values, place, row| {
                values[width * place..][..width].iter_mut().try_for_each(|value| row.real().map(|read| *value = read))
            })?;
        }
        Ok(rows)
    }

    /// Values of a row.
    pub fn width(&self) -> usize {
        self.kinds.iter().map(|kind| kind.values()).sum()
    }

    /// All fields at these vertices, from 0: a solution of so many.
    ///
    /// # Errors
    /// As of [`MeshReader::vertices`].
    pub fn fields(&self, team: Team<'_>, range: Range<usize>) -> Result<Solution, Error> {
        let (width, vertices) = (self.width(), range.len());
        let rows = self.rows(team, range)?;
        let mut before = 0;
        let field = |&kind: &FieldKind| {
            let own = before..before + kind.values();
            before = own.end;
            let values = rows.chunks_exact(width).flat_map(|row| &row[own.clone()]).copied().collect();
            SolutionField { kind, values }
        };
        let fields = match self.kinds[..] {
            [kind] => vec![SolutionField { kind, values: rows }],
            _ => self.kinds.iter().map(field).collect(),
        };
        Ok(Solution { vertices, fields })
    }
}

/// A file and its sections.
#[derive(Debug)]
struct Reader {
    file: Positioned,
    path: PathBuf,
    words: Words,
    sections: Vec<Section>,
}

impl Reader {
    /// Finds the sections; `checked` says whether they are what is expected, and what else is to be known of them.
    fn open<T>(path: &Path, checked: impl FnOnce(Contents<'_>) -> Result<T, Error>) -> Result<(Self, T), Error> {
        check_regular(path)?;
        let system = |error| Error::system(path, error);
        let file = Positioned::new(File::open(path).map_err(system)?);
        let heads = Heads::of(&file).map_err(system)?;
        let contents = match heads.word(0) {
            Some([1, 0, 0, 0]) => binary::contents(path, &heads, false),
            Some([0, 0, 0, 1]) => binary::contents(path, &heads, true),
            _ if heads.size() == 0 => Err(empty(path)),
            _ => {
                let message = "no binary file of libMeshb, and only these are read by slices: give .meshb or .solb";
                Err(Error::content(path, "start of the file", message))
            }
        };
        // Where reading failed, the file only seemed to end.
        heads.result().map_err(system)?;
        let contents = contents?;
        let Encoding::Binary(words) = contents.source.encoding else { unreachable!("a binary file") };
        let sections = contents.sections.clone();
        let known = checked(contents)?;
        Ok((Self { file, path: path.into(), words, sections }, known))
    }

    /// The section of a keyword, if it has these rows. One that is absent has none.
    fn section(&self, keyword: Keyword, range: &Range<usize>) -> Result<Option<&Section>, Error> {
        let section = self.sections.iter().find(|section| section.keyword == keyword);
        let count = section.map_or(0, |section| section.count);
        if range.start > range.end || range.end > count {
            let message = format!("rows {} to {} are asked for, but there are {count}", range.start + 1, range.end);
            return Err(Error::content(&self.path, keyword.name(), message));
        }
        Ok(section)
    }

    /// Some rows of a section.
    fn window<'b>(
        &'b self,
        section: &Section,
        range: &Range<usize>,
        bytes: &'b mut Vec<u8>,
    ) -> Result<Source<'b>, Error> {
        let row = row_size(self.words, section);
        let start = section.body.start + range.start * row;
        bytes.resize(range.len() * row, 0);
        self.file.read(bytes, start as u64).map_err(|error| Error::system(&self.path, error))?;
        Ok(Source { path: &self.path, bytes, start, encoding: Encoding::Binary(self.words) })
    }

    /// What `read` makes of all rows of a section; none where it is absent.
    fn whole<T>(
        &self,
        keyword: Keyword,
        read: impl FnOnce(&Source<'_>, &Section) -> Result<T, Error>,
    ) -> Result<Option<T>, Error> {
        let Some(section) = self.sections.iter().find(|section| section.keyword == keyword) else { return Ok(None) };
        let mut bytes = Vec::new();
        let source = self.window(section, &(0..section.count), &mut bytes)?;
        read(&source, section).map(Some)
    }

    /// What `row` makes of each of these rows, as two lists; `none` fills the lists first.
    fn columns<A: Copy + Send, B: Copy + Send>(
        &self,
        team: Team<'_>,
        keyword: Keyword,
        range: Range<usize>,
        none: (A, B),
        row: impl Fn(&mut BinaryCursor<'_>) -> Result<(A, B), String> + Sync,
    ) -> Result<(Vec<A>, Vec<B>), Error> {
        let section = self.section(keyword, &range)?;
        let (mut first, mut second) = (vec![none.0; range.len()], vec![none.1; range.len()]);
        let parts = first.chunks_mut(ROWS).zip(second.chunks_mut(ROWS)).collect();
        self.fill(team, section, range, parts, |(first, second), place, cursor| {
            (first[place], second[place]) = row(cursor)?;
            Ok(())
        })?;
        Ok((first, second))
    }

    /// Fills parts of [`ROWS`] rows each, the last one of less: calls `fill` with the part, a row's number in it and the cursor there. Of several
    /// errors the first in the file counts.
    fn fill<P: Send>(
        &self,
        team: Team<'_>,
        section: Option<&Section>,
        range: Range<usize>,
        parts: Vec<P>,
        fill: impl Fn(&mut P, usize, &mut BinaryCursor<'_>) -> Result<(), String> + Sync,
    ) -> Result<(), Error> {
        let Some(section) = section else { return Ok(()) };
        let mut parts: Vec<_> = parts.into_iter().map(|part| (part, Ok(()))).collect();
        team.fill(1, &mut parts, |index, parts| {
            let mut bytes = Vec::new();
            for ((part, result), index) in parts.iter_mut().zip(index..) {
                let start = range.start + index * ROWS;
                let rows = start..range.end.min(start + ROWS);
                *result = self.window(section, &rows, &mut bytes).and_then(|source| {
                    let fault = Fault::default();
                    fault.in_rows(&source, section, rows, |cursor, place| fill(part, place, cursor));
                    fault.result(&source, section)
                });
            }
        });
        parts.into_iter().try_for_each(|(_, result)| result)
    }
}
