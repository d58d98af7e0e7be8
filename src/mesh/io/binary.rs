//! Binary files: the chain of keywords and the values.
//!
//! ```text
//!  1 (tells the byte order) │ version │ keyword │ position of the next keyword │ count │ rows … │ keyword │ …
//! ```
//! The chain ends at the keyword End. Versions differ in the size of words (see [`Words`]).
use super::cursor::Cursor;
use super::keyword::{DIMENSION, END, Keyword, PRECISION, describe};
use super::source::{Contents, Encoding, Section, Source, Words, field_kinds};
use super::{Error, FieldKind};
use std::ops::Range;
use std::path::Path;

/// Bytes of a keyword, a dimension, a number of fields, a field's type: in all versions.
const WORD: usize = 4;

/// What the chain is found in: bytes in memory, or a file of which only the heads are read.
pub(super) trait Bytes {
    /// Number of bytes.
    fn size(&self) -> usize;
    /// The bytes at a place, if there are so many.
    fn word<const N: usize>(&self, at: usize) -> Option<[u8; N]>;
}

impl Bytes for [u8] {
    fn size(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn word<const N: usize>(&self, at: usize) -> Option<[u8; N]> {
        self.get(at..)?.first_chunk().copied()
    }
}

/// The bytes before a place.
struct Before<'b, B: ?Sized>(&'b B, usize);

impl<B: Bytes + ?Sized> Bytes for Before<'_, B> {
    fn size(&self) -> usize {
        self.1
    }

    fn word<const N: usize>(&self, at: usize) -> Option<[u8; N]> {
        if at.checked_add(N)? <= self.1 { self.0.word(at) } else { None }
    }
}

impl Words {
    /// The integer of `size` bytes (4 or 8) at `at`, if the bytes reach that far.
    #[inline(always)]
    fn int_at<B: Bytes + ?Sized>(&self, bytes: &B, at: usize, size: usize) -> Option<i64> {
        if size == 4 {
            let word = bytes.word(at)?;
            Some(if self.big { i32::from_be_bytes(word) } else { i32::from_le_bytes(word) }.into())
        } else {
            let word = bytes.word(at)?;
            Some(if self.big { i64::from_be_bytes(word) } else { i64::from_le_bytes(word) })
        }
    }

    /// The real at `at`, if the bytes reach that far.
    #[inline(always)]
    fn real_at(&self, bytes: &[u8], at: usize) -> Option<f64> {
        if self.real == 4 {
            let word = bytes.word(at)?;
            Some(if self.big { f32::from_be_bytes(word) } else { f32::from_le_bytes(word) }.into())
        } else {
            let word = bytes.word(at)?;
            Some(if self.big { f64::from_be_bytes(word) } else { f64::from_le_bytes(word) })
        }
    }
}

/// One link of the chain: a keyword and the bytes up to the next.
struct Link {
    code: i32,
    at: usize,
    body: Range<usize>,
}

impl Link {
    /// What errors call it.
    fn name(&self) -> String {
        describe(self.code)
    }
}

/// Finds the sections of a binary file. The bytes of what is returned are still empty.
pub(super) fn contents<'a, B: Bytes + ?Sized>(path: &'a Path, bytes: &B, big: bool) -> Result<Contents<'a>, Error> {
    let mut words = Words::of_version(2, big);
    let mut source = Source { path, bytes: &[], start: 0, encoding: Encoding::Binary(words) };
    match words.int_at(bytes, 4, WORD) {
        Some(version @ 1..=4) => words = Words::of_version(version, big),
        Some(version) => {
            return Err(source.error(4, "version", format!("version {version} is not known; 1 to 4 are")));
        }
        None => return Err(source.error(bytes.size(), "version", CUT)),
    }
    let chain = chain(&source, bytes, words)?;
    if let Some(real) = precision(bytes, words, &chain) {
        words.real = real;
    }
    source.encoding = Encoding::Binary(words);
    // Before the sections, whose rows are shorter in two dimensions. The last one counts.
    let dimension = chain.iter().rfind(|link| link.code == DIMENSION);
    let dimension = dimension.and_then(|link| words.int_at(&Before(bytes, link.body.end), link.body.start, WORD));
    super::source::check_dimension(&source, bytes.size(), dimension)?;
    let mut contents = Contents { source, sections: Vec::new(), notices: Vec::new() };
    for link in &chain {
        match Keyword::from_code(link.code) {
            Some(keyword) => contents.add(section(&source, bytes, words, link, keyword)?, link.at)?,
            None if [DIMENSION, PRECISION].contains(&link.code) => {}
            None => contents.notices.push(source.notice(link.at, &link.name())),
        }
    }
    Ok(contents)
}

/// Remedy for a file that ends too early.
const CUT: &str = "the file ends here: it was cut; copy or write it again";

/// Follows the chain to the keyword End.
fn chain<B: Bytes + ?Sized>(source: &Source, bytes: &B, words: Words) -> Result<Vec<Link>, Error> {
    let size = bytes.size();
    let mut links = Vec::new();
    let mut at = 2 * WORD;
    loop {
        let Some(code) = words.int_at(bytes, at, WORD) else {
            return Err(source.error(size, "keyword", CUT));
        };
        let code = code as i32; // read from four bytes
        let body = at + WORD + words.position;
        if code == END {
            // some writers leave out End's own position, which means nothing
            return if size <= body {
                Ok(links)
            } else {
                Err(source.error(body, "End", format!("{} bytes follow the end; cut them off", size - body)))
            };
        }
        let Some(next) = words.int_at(bytes, at + WORD, words.position) else {
            return Err(source.error(size, &describe(code), CUT));
        };
        // since positions only grow, the chain ends
        let next = match usize::try_from(next) {
            Ok(0) => return Err(source.error(at, &describe(code), NO_END)),
            Ok(next) if next >= body && next < size => next,
            Ok(next) if next >= size => return Err(source.error(at, &describe(code), beyond(next, size))),
            _ => return Err(source.error(at, &describe(code), backwards(next))),
        };
        links.push(Link { code, at, body: body..next });
        at = next;
    }
}

/// Remedy for a chain that stops before the keyword End.
const NO_END: &str = "no next keyword and no End: the file was not written to its end; write it again";

fn beyond(next: usize, size: usize) -> String {
    format!("the next keyword is said to be at byte {next}, but the file has {size} bytes: it was cut; copy it again")
}

fn backwards(next: i64) -> String {
    format!("the next keyword is said to be at byte {next}, before this one's end; the file is damaged, write it again")
}

/// Bytes of a real, when the file says so itself.
fn precision<B: Bytes + ?Sized>(bytes: &B, words: Words, chain: &[Link]) -> Option<usize> {
    let link = chain.iter().find(|link| link.code == PRECISION && link.body.len() == words.int)?;
    match words.int_at(bytes, link.body.start, words.int) {
        Some(32) => Some(4),
        Some(64) => Some(8),
        _ => None,
    }
}

/// Reads a section's header and checks that its rows fill it exactly.
fn section<B: Bytes + ?Sized>(
    source: &Source,
    bytes: &B,
    words: Words,
    link: &Link,
    keyword: Keyword,
) -> Result<Section, Error> {
    let bytes = &Before(bytes, link.body.end);
    let fail = |at: usize, message: String| source.error(at, keyword.name(), message);
    let mut at = link.body.start;
    let Some(count) = words.int_at(bytes, at, words.int) else {
        return Err(fail(at, "the next keyword follows before the count; the file is damaged, write it again".into()));
    };
    at += words.int;
    let mut kinds = Vec::new();
    if keyword == Keyword::SolAtVertices {
        kinds = solution_header(words, bytes, at).map_err(|message| fail(at, message))?;
        at += WORD * (1 + kinds.len());
    }
    let mut section = Section { keyword, count: 0, body: at..link.body.end, kinds };
    let (row, body) = (row_size(words, &section), section.body.len());
    match usize::try_from(count) {
        Ok(count) if count.checked_mul(row) == Some(body) => section.count = count,
        _ => {
            let holds = if body.is_multiple_of(row) { format!("{}", body / row) } else { format!("{body} bytes") };
            return Err(fail(
                link.body.start,
                format!("the count says {count}, but there are {holds}: the file is damaged, write it again"),
            ));
        }
    }
    Ok(section)
}

/// The fields of a solution: their number and their types.
fn solution_header(words: Words, bytes: &impl Bytes, at: usize) -> Result<Vec<FieldKind>, String> {
    let fields = words.int_at(bytes, at, WORD).ok_or("the number of fields is missing; write the file again")?;
    let room = bytes.size().saturating_sub(at + WORD) / WORD;
    match usize::try_from(fields) {
        Ok(fields) if (1..=room).contains(&fields) => {
            field_kinds((1..=fields).filter_map(|k| words.int_at(bytes, at + WORD * k, WORD)))
        }
        _ => Err(format!("{fields} fields are said to follow; at least 1 is expected, and no more than fit")),
    }
}

/// Walks through the values of a section of a binary file. Places are those in `bytes`.
pub(super) struct BinaryCursor<'a> {
    bytes: &'a [u8],
    words: Words,
    next: usize,
    at: usize,
    /// Where the bytes begin in the file.
    start: usize,
}

impl BinaryCursor<'_> {
    #[inline(always)]
    fn step(&mut self, size: usize) -> usize {
        self.at = self.next;
        self.next += size;
        self.at
    }

    /// Passes over so many reals.
    #[inline(always)]
    pub(super) fn skip_reals(&mut self, count: usize) {
        self.next += count * self.words.real;
    }
}

impl<'a> BinaryCursor<'a> {
    /// At the first value of a row of which the source has the bytes.
    fn of_row(source: &Source<'a>, section: &Section, row: usize) -> Self {
        let Encoding::Binary(words) = source.encoding else { unreachable!("a binary cursor on a text") };
        let place = section.body.start + row * row_size(words, section) - source.start;
        let end = source.bytes.len().min(section.body.end - source.start);
        Self { bytes: &source.bytes[..end], words, next: place, at: place, start: source.start }
    }
}

impl<'a> Cursor<'a> for BinaryCursor<'a> {
    fn new(source: &Source<'a>, section: &Section) -> Self {
        Self::of_row(source, section, 0)
    }

    #[inline(always)]
    fn int(&mut self) -> Result<i64, String> {
        let at = self.step(self.words.int);
        self.words.int_at(self.bytes, at, self.words.int).ok_or_else(|| CUT.into())
    }

    #[inline(always)]
    fn raw_real(&mut self) -> Result<f64, String> {
        let at = self.step(self.words.real);
        self.words.real_at(self.bytes, at).ok_or_else(|| CUT.into())
    }

    fn at_row(source: &Source<'a>, section: &Section, row: usize) -> Option<Self> {
        Some(Self::of_row(source, section, row))
    }

    fn at(&self) -> usize {
        self.start + self.at
    }

    fn finish(&mut self) -> Result<(), String> {
        Ok(()) // the rows fill the section, see `section`
    }
}

/// Bytes of a row.
pub(super) fn row_size(words: Words, section: &Section) -> usize {
    let (ints, reals) = section.row();
    ints * words.int + reals * words.real
}
