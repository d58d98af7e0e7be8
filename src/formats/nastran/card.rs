//! An entry of the bulk data, with its continuations.
use crate::mesh::io::number::parse_real;
use std::borrow::Cow;

/// Most fields that are kept: no entry that is read has more.
const MOST: usize = 64;

/// An entry: its name and the fields behind it.
#[derive(Default)]
pub(super) struct Card<'a> {
    pub name: Cow<'a, [u8]>,
    fields: Vec<Cow<'a, [u8]>>,
    /// Where it begins.
    pub line: usize,
}

impl<'a> Card<'a> {
    /// A field behind the name, from 0; empty where there is none.
    pub fn field(&self, number: usize) -> &[u8] {
        self.fields.get(number).map_or(b"", |field| field)
    }

    /// Begins with a line.
    pub fn begin(&mut self, line: &'a [u8], number: usize) {
        self.fields.clear();
        self.line = number;
        self.name = Cow::Borrowed(b"");
        let mut parts = fields(line);
        if let Some(name) = parts.next() {
            self.name = match name {
                Cow::Borrowed(name) => Cow::Borrowed(name.strip_suffix(b"*").unwrap_or(name).trim_ascii_end()),
                Cow::Owned(name) => Cow::Owned(name.strip_suffix(b"*").unwrap_or(&name).trim_ascii_end().to_vec()),
            };
        }
        self.fields.extend(parts);
    }

    /// Whether the line is a continuation, which is added then.
    pub fn goes_on(&mut self, line: &'a [u8]) -> bool {
        let is_more = matches!(line.first(), Some(b'+' | b'*' | b' ' | b',' | b'\t'));
        if is_more && !self.name.is_empty() && self.fields.len() < MOST {
            self.fields.extend(fields(line).skip(1));
        }
        is_more
    }
}

/// The fields of a line: words between commas, or columns of 8 characters, of 16 where the first field has a star. The last, which marks
/// a continuation, is left out.
fn fields<'a>(line: &'a [u8]) -> Box<dyn Iterator<Item = Cow<'a, [u8]>> + 'a> {
    let line = line.split(|&byte| byte == b'$').next().unwrap_or_default().trim_ascii_end();
    if line.contains(&b',') {
        let words = line.split(|&byte| byte == b',').map(<[u8]>::trim_ascii).enumerate();
        return Box::new(
            words.filter(|(at, word)| *at == 0 || !word.starts_with(b"+")).map(|(_, word)| Cow::Borrowed(word)).take(9),
        );
    }
    let line = if line.contains(&b'\t') { Cow::Owned(expanded(line)) } else { Cow::Borrowed(line) };
    let first = &line[..line.len().min(8)];
    let (width, count) = if first.contains(&b'*') { (16, 5) } else { (8, 9) };
    let column = move |number: usize| {
        let start = if number == 0 { 0 } else { 8 + (number - 1) * width };
        let end = if number == 0 { 8 } else { start + width };
        match &line {
            Cow::Borrowed(line) => Cow::Borrowed(cut(line, start, end)),
            Cow::Owned(line) => Cow::Owned(cut(line, start, end).to_vec()),
        }
    };
    Box::new((0..count).map(column))
}

fn cut(line: &[u8], start: usize, end: usize) -> &[u8] {
    line.get(start..end.min(line.len())).unwrap_or_default().trim_ascii()
}

/// Tabs go to the next column of 8.
fn expanded(line: &[u8]) -> Vec<u8> {
    let mut found = Vec::new();
    for &byte in line {
        if byte == b'\t' {
            found.resize(found.len() / 8 * 8 + 8, b' ');
        } else {
            found.push(byte);
        }
    }
    found
}

/// A number; Nastran writes 1.5-3 for 0.0015 too.
pub(super) fn real(word: &[u8]) -> Result<f64, String> {
    let sign =
        word.iter().enumerate().skip(1).find(|&(at, &byte)| {
            (byte == b'-' || byte == b'+') && (word[at - 1].is_ascii_digit() || word[at - 1] == b'.')
        });
    match sign {
        Some((at, _)) => {
            let text = [&word[..at], b"e", &word[at..]].concat();
            parse_real(&text).map_err(|_| parse_real(word).err().unwrap_or_default())
        }
        None => parse_real(word),
    }
}

/// A number in 16 characters, as near as they allow.
pub(super) fn in_16(x: f64) -> String {
    let short = format!("{x:?}");
    if short.len() <= 16 && !short.contains('e') {
        return short;
    }
    let fixed = |digits: usize| {
        let text = format!("{x:.digits$}");
        if digits == 0 { text + "." } else { text }
    };
    // 1.5e-3 is 1.5-3, and 1.5e3 is 1.5+3.
    let scientific = |digits: usize| {
        let text = format!("{x:.digits$e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        let dot = if digits == 0 { "." } else { "" };
        let sign = if exponent.starts_with('-') { "" } else { "+" };
        format!("{mantissa}{dot}{sign}{exponent}")
    };
    // The most digits that there is room for.
    let longest = |form: &dyn Fn(usize) -> String| (0..=14).rev().map(form).find(|text| text.len() <= 16);
    let error = |text: &String| real(text.as_bytes()).map_or(f64::INFINITY, |found| (found - x).abs());
    let both = longest(&fixed).into_iter().chain(longest(&scientific));
    both.min_by(|a, b| error(a).total_cmp(&error(b))).unwrap_or(short)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_read_however_they_are_written() {
        let words = |line: &str| -> Vec<String> {
            let found = fields(line.as_bytes()).map(|word| String::from_utf8_lossy(&word).into_owned());
            found.take(5).collect()
        };
        let wanted = ["GRID", "1", "", "1.5-3", "-2."];
        for line in [
            "GRID    1               1.5-3   -2.     +",
            "GRID,1,,1.5-3,-2.,+",
            "GRID\t1\t\t1.5-3\t-2.",
            "GRID,1, ,1.5-3 , -2. $ a",
        ] {
            assert_eq!(words(line), wanted, "{line}");
        }
        assert_eq!(words("GRID*                  1                           1.5-3             -2.")[1..], wanted[1..]);
        let mut card = Card::default();
        card.begin(b"GRID*                  1                           1.5-3             -2.*", 7);
        assert!(card.goes_on(b"*                     3.") && !card.goes_on(b"GRID    2"));
        assert_eq!((&*card.name, card.field(4), card.line), (&b"GRID"[..], &b"3."[..], 7));
    }

    #[test]
    fn numbers_in_16_characters() {
        for (text, value) in [("1.5-3", 1.5e-3), ("-1.+2", -100.0), ("7.0E+1", 70.0), ("1.D0", 1.0), ("-.5", -0.5)] {
            assert_eq!(real(text.as_bytes()), Ok(value), "{text}");
        }
        assert!(real(b"1-").is_err() && real(b"x").is_err() && real(b"").is_err());
        for x in [0.0, -1.0 / 3.0, 1e-300, -1.234567890123456e-7, 1e22, 123_456_789.123_456_79, -2e15 / 3.0, 0.1] {
            let text = in_16(x);
            let found = real(text.as_bytes()).unwrap();
            assert!(text.len() <= 16 && text.contains('.') && (found - x).abs() <= 2e-9 * x.abs(), "{x}: {text}");
        }
        assert_eq!((in_16(0.1), in_16(1e22)), ("0.1".into(), in_16(1e22)));
    }
}
