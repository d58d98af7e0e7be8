//! Words, marks and raw bytes of OpenFOAM's files, one after the other.
use crate::mesh::io::Error;
use std::path::Path;

/// What comes next in a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Token<'a> {
    /// One of `{ } ( ) [ ] ;`.
    Mark(u8),
    /// A run of other bytes, or a string without its quotes.
    Word(&'a [u8]),
    /// Nothing follows.
    End,
}

impl Token<'_> {
    /// As a person reads it.
    pub fn shown(self) -> String {
        match self {
            Self::Mark(mark) => format!("`{}`", char::from(mark)),
            Self::Word(word) => format!("`{}`", String::from_utf8_lossy(&word[..word.len().min(40)])),
            Self::End => "the end of the file".to_owned(),
        }
    }
}

/// The bytes of a file, and how far they have been read.
#[derive(Clone, Debug)]
pub(super) struct Scanner<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    at: usize,
}

fn is_mark(byte: u8) -> bool {
    matches!(byte, b'{' | b'}' | b'(' | b')' | b'[' | b']' | b';')
}

impl<'a> Scanner<'a> {
    /// At the beginning of the bytes of a file.
    pub fn new(path: &'a Path, bytes: &'a [u8]) -> Self {
        Self { path, bytes, at: 0 }
    }

    /// An error at what was read last.
    pub fn fail(&self, message: impl Into<String>) -> Error {
        let line = 1 + self.bytes[..self.at.min(self.bytes.len())].iter().filter(|&&byte| byte == b'\n').count();
        let place = format!("line {line} (byte {})", self.at);
        Error::Content { path: self.path.to_owned(), place, message: message.into() }
    }

    /// How many bytes follow.
    pub fn rest(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Passes over white space and comments.
    fn skip(&mut self) {
        while let Some(&byte) = self.bytes.get(self.at) {
            let rest = &self.bytes[self.at..];
            if byte.is_ascii_whitespace() {
                self.at += 1;
            } else if rest.starts_with(b"//") {
                self.at += rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
            } else if rest.starts_with(b"/*") {
                self.at += rest.windows(2).skip(2).position(|two| two == b"*/").map_or(rest.len(), |end| end + 4);
            } else {
                break;
            }
        }
    }

    /// The next word or mark.
    pub fn next(&mut self) -> Token<'a> {
        self.skip();
        let rest = &self.bytes[self.at..];
        match rest.first() {
            None => Token::End,
            Some(&mark) if is_mark(mark) => {
                self.at += 1;
                Token::Mark(mark)
            }
            Some(b'"') => {
                let end = rest[1..].iter().position(|&byte| byte == b'"').unwrap_or(rest.len() - 1);
                self.at += (end + 2).min(rest.len());
                Token::Word(&rest[1..=end])
            }
            Some(_) => {
                let ends = |&byte: &u8| byte.is_ascii_whitespace() || is_mark(byte) || byte == b'"';
                let end = rest.iter().position(ends).unwrap_or(rest.len());
                self.at += end;
                Token::Word(&rest[..end])
            }
        }
    }

    /// What comes next, which stays to be read.
    pub fn peek(&self) -> Token<'a> {
        self.clone().next()
    }

    /// Takes a mark.
    pub fn expect(&mut self, mark: u8) -> Result<(), Error> {
        match self.next() {
            Token::Mark(found) if found == mark => Ok(()),
            other => Err(self.fail(format!("expected `{}`, found {}", char::from(mark), other.shown()))),
        }
    }

    /// Takes a word.
    pub fn word(&mut self) -> Result<&'a [u8], Error> {
        match self.next() {
            Token::Word(word) => Ok(word),
            other => Err(self.fail(format!("expected a word, found {}", other.shown()))),
        }
    }

    /// Takes a word that stands for a value.
    pub fn value<T: std::str::FromStr>(&mut self) -> Result<T, Error> {
        let word = self.word()?;
        let value = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        value.ok_or_else(|| self.fail(format!("{} is no value that can stand here", Token::Word(word).shown())))
    }

    /// Takes a number of the text; one that is not finite is refused.
    pub fn real(&mut self) -> Result<f64, Error> {
        let value: f64 = self.value()?;
        if value.is_finite() { Ok(value) } else { Err(self.fail(format!("{value} is not a finite number"))) }
    }

    /// Takes raw bytes, just here.
    pub fn raw(&mut self, count: usize) -> Result<&'a [u8], Error> {
        if count > self.rest() {
            return Err(self
                .fail(format!("{count} bytes should follow, but the file ends: it is cut off or its count is wrong")));
        }
        let found = &self.bytes[self.at..self.at + count];
        self.at += count;
        Ok(found)
    }

    /// Passes over what belongs to an entry of a dictionary whose name was read: `{ … }`, or all up to `;`.
    pub fn skip_entry(&mut self) -> Result<(), Error> {
        let mut depth = 0usize;
        let is_dictionary = self.peek() == Token::Mark(b'{');
        loop {
            match self.next() {
                Token::Mark(b'{' | b'(' | b'[') => depth += 1,
                Token::Mark(b';') if depth == 0 => return Ok(()),
                Token::Mark(b';') | Token::Word(_) => {}
                Token::Mark(mark) if depth > 0 => {
                    depth -= 1;
                    if depth == 0 && mark == b'}' && is_dictionary {
                        return Ok(());
                    }
                }
                other => return Err(self.fail(format!("an entry should end here, found {}", other.shown()))),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_marks_strings_and_comments() {
        let text = b"a 3(0 1) /* ( */ \"x y\" // z\n{b;} \"open";
        let path = Path::new("f");
        let mut scanner = Scanner::new(path, text);
        let mut found = Vec::new();
        while scanner.peek() != Token::End {
            found.push(scanner.next().shown());
        }
        assert_eq!(found, ["`a`", "`3`", "`(`", "`0`", "`1`", "`)`", "`x y`", "`{`", "`b`", "`;`", "`}`", "`open`"]);
        assert_eq!(scanner.fail("x").to_string(), format!("f: line 2 (byte {}): x", text.len()));
    }

    #[test]
    fn entries_are_passed_over_whole() {
        let path = Path::new("f");
        let mut scanner = Scanner::new(path, b"{ a (1 2); b { c 1; } } next 1 List<word> 1(x; y) 3{0}; last");
        scanner.skip_entry().unwrap();
        assert_eq!(scanner.word().unwrap(), b"next");
        scanner.skip_entry().unwrap();
        assert_eq!(scanner.word().unwrap(), b"last");
        assert!(scanner.skip_entry().is_err());
        assert!(Scanner::new(path, b" } ").skip_entry().is_err());
        assert!(Scanner::new(path, b"nan").real().unwrap_err().to_string().contains("not a finite number"));
    }
}
