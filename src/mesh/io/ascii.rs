//! ASCII files: words, numbers and comments (# to the end of the line), separated by blanks.
use super::cursor::Cursor;
use super::keyword::Keyword;
use super::number::{parse_int, parse_real, shown};
use super::source::{Contents, Encoding, Section, Source, check_dimension, field_kinds};
use super::{Error, FieldKind};
use std::ops::Range;
use std::path::Path;

/// Most unknown words that get a notice. A damaged file can have very many.
const MOST_NOTICES: usize = 20;

/// Takes a text apart at blanks and comments.
#[derive(Clone)]
struct Tokens<'a> {
    bytes: &'a [u8],
    next: usize,
}

impl Tokens<'_> {
    /// Moves on to the next token's first byte, or the end.
    #[inline]
    fn skip_blank(&mut self) {
        while let Some(&byte) = self.bytes.get(self.next) {
            match byte {
                b'#' => self.skip_line(),
                0..=b' ' => self.next += 1,
                _ => return,
            }
        }
    }

    /// Moves on behind the line.
    fn skip_line(&mut self) {
        let rest = &self.bytes[self.next..];
        self.next += rest.iter().position(|&b| b == b'\n').map_or(rest.len(), |p| p + 1);
    }

    /// The next token.
    #[inline]
    fn token(&mut self) -> Option<Range<usize>> {
        self.skip_blank();
        let start = self.next;
        while self.bytes.get(self.next).is_some_and(|&b| b > b' ') {
            self.next += 1;
        }
        (start < self.next).then_some(start..self.next)
    }

    /// The next token that is a word, numbers skipped.
    fn word(&mut self) -> Option<Range<usize>> {
        loop {
            let token = self.token()?;
            if is_word(&self.bytes[token.clone()]) {
                return Some(token);
            }
        }
    }
}

/// Whether a token is a keyword and not a number: C prints numbers as nan, nan(…), inf or infinity, too.
#[inline]
fn is_word(token: &[u8]) -> bool {
    let begins = |word: &[u8]| token.len() >= word.len() && token[..word.len()].eq_ignore_ascii_case(word);
    token[0].is_ascii_alphabetic() && !begins(b"nan") && !token.eq_ignore_ascii_case(b"inf") && !begins(b"infinity")
}

/// Finds the sections of a text: each goes to the next word.
pub(super) fn contents<'a>(path: &'a Path, bytes: &'a [u8]) -> Result<Contents<'a>, Error> {
    let source = Source { path, bytes, start: 0, encoding: Encoding::Ascii };
    let start = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    let mut tokens = Tokens { bytes, next: start };
    check_version(&source, &mut tokens)?;
    let mut contents = Contents { source, sections: Vec::new(), notices: Vec::new() };
    let mut skipped: Vec<&[u8]> = Vec::new();
    let mut dimension = None;
    loop {
        let Some(word) = tokens.word() else {
            let message = "the text ends without End: it was cut; copy it again, or add End when it is whole";
            return Err(source.error(bytes.len(), "End", message));
        };
        let name = &bytes[word.clone()];
        match Keyword::from_name(name) {
            Some(keyword) => contents.add(section(&source, &mut tokens, keyword)?, word.start)?,
            None if name == b"End" => break,
            None if name == b"Dimension" => dimension = Some(header(&source, &mut tokens, "Dimension")?),
            None if name == b"FloatingPointPrecision" => {} // says nothing about a text
            None => {
                if name == b"Comments" {
                    skip_comments(&mut tokens);
                }
                if !skipped.contains(&name) && skipped.len() < MOST_NOTICES {
                    skipped.push(name);
                    contents.notices.push(source.notice(word.start, &shown(name)));
                }
            }
        }
    }
    if let Some(token) = tokens.token() {
        let message = format!("{} follows the end; cut it off", shown(&bytes[token.clone()]));
        return Err(source.error(token.start, "End", message));
    }
    check_dimension(&source, bytes.len(), dimension)?;
    Ok(contents)
}

/// The text must begin as libMeshb's do.
fn check_version(source: &Source, tokens: &mut Tokens) -> Result<(), Error> {
    let first = tokens.token().map_or(&[][..], |t| &tokens.bytes[t]);
    if first != b"MeshVersionFormatted" {
        let message = "no mesh or solution file of libMeshb: a text that begins with MeshVersionFormatted is expected, \
                       or a binary file that begins with the four bytes of the number 1";
        return Err(Error::content(source.path, "start of the file", message));
    }
    match header(source, tokens, "MeshVersionFormatted")? {
        1..=4 => Ok(()),
        version => {
            let message = format!("version {version} is not known; 1 to 4 are");
            Err(source.error(tokens.next, "MeshVersionFormatted", message))
        }
    }
}

/// A whole number in a keyword's header.
fn header(source: &Source, tokens: &mut Tokens, name: &str) -> Result<i64, Error> {
    match tokens.token() {
        Some(token) => {
            parse_int(&source.bytes[token.clone()]).map_err(|message| source.error(token.start, name, message))
        }
        None => {
            Err(source.error(source.bytes.len(), name, "the text ends before the number; it was cut, copy it again"))
        }
    }
}

/// Reads a section's header and finds its end.
fn section(source: &Source, tokens: &mut Tokens, keyword: Keyword) -> Result<Section, Error> {
    let name = keyword.name();
    let count = header(source, tokens, name)?;
    let Ok(count) = usize::try_from(count) else {
        return Err(source.error(tokens.next, name, format!("the count says {count}; 0 or more is expected")));
    };
    let mut kinds = Vec::new();
    if keyword == Keyword::SolAtVertices {
        kinds = solution_header(source, tokens, name)?;
    }
    let start = tokens.next;
    let end = match tokens.word() {
        Some(word) => word.start,
        None => source.bytes.len(),
    };
    tokens.next = end;
    Ok(Section { keyword, count, body: start..end, kinds })
}

/// The fields of a solution: their number and their types.
fn solution_header(source: &Source, tokens: &mut Tokens, name: &str) -> Result<Vec<FieldKind>, Error> {
    let fields = header(source, tokens, name)?;
    if fields < 1 {
        return Err(source.error(tokens.next, name, format!("{fields} fields; at least 1 is expected")));
    }
    let mut codes = Vec::new();
    for _ in 0..fields {
        codes.push(header(source, tokens, name)?);
    }
    field_kinds(codes.into_iter()).map_err(|message| source.error(tokens.next, name, message))
}

/// The keyword Comments is followed by a count and as many lines of free text, which are skipped.
fn skip_comments(tokens: &mut Tokens) {
    let lines = tokens.token().and_then(|t| parse_int(&tokens.bytes[t]).ok()).unwrap_or(0);
    tokens.skip_line();
    for _ in 0..lines {
        if tokens.next >= tokens.bytes.len() {
            return;
        }
        tokens.skip_line();
    }
}

/// Walks through the values of a section of a text.
pub(super) struct AsciiCursor<'a> {
    tokens: Tokens<'a>,
    at: usize,
}

impl AsciiCursor<'_> {
    #[inline]
    fn next(&mut self) -> Result<Range<usize>, String> {
        match self.tokens.token() {
            Some(token) => {
                self.at = token.start;
                Ok(token)
            }
            None => {
                self.at = self.tokens.next;
                Err("the list ends here, before its count is reached; correct the count or the list".into())
            }
        }
    }
}

impl<'a> Cursor<'a> for AsciiCursor<'a> {
    fn new(source: &Source<'a>, section: &Section) -> Self {
        let tokens = Tokens { bytes: &source.bytes[..section.body.end], next: section.body.start };
        Self { at: tokens.next, tokens }
    }

    #[inline]
    fn at_row(_: &Source<'a>, _: &Section, _: usize) -> Option<Self> {
        None
    }

    fn int(&mut self) -> Result<i64, String> {
        let token = self.next()?;
        parse_int(&self.tokens.bytes[token])
    }

    #[inline]
    fn raw_real(&mut self) -> Result<f64, String> {
        let token = self.next()?;
        parse_real(&self.tokens.bytes[token])
    }

    fn at(&self) -> usize {
        self.at
    }

    fn finish(&mut self) -> Result<(), String> {
        match self.next() {
            Ok(token) => {
                let token = shown(&self.tokens.bytes[token]);
                Err(format!("{token} follows when the count is reached; correct the count or the list"))
            }
            Err(_) => Ok(()),
        }
    }
}
