//! Lists of numbers: as text, or raw bytes between brackets.
use super::file::Head;
use super::ordered::Face;
use super::scan::{Scanner, Token};
use crate::mesh::adjacency::NONE;
use crate::mesh::io::Error;

/// A list's number of entries, which take so many bytes at least; more than can follow are refused before there is memory for them.
fn count(scanner: &mut Scanner, least: usize) -> Result<usize, Error> {
    let count: usize = scanner.value()?;
    if count > scanner.rest() / least.max(1) && scanner.peek() != Token::Mark(b'{') {
        return Err(scanner.fail(format!("{count} entries should follow, but the file is too short for them")));
    }
    Ok(count)
}

/// Opens a list of `count` entries, of which `expected` are wanted: `(` before them, or `{` before the one that all are.
fn open(scanner: &mut Scanner, count: usize, expected: Option<usize>) -> Result<Form, Error> {
    if let Some(expected) = expected.filter(|&expected| expected != count) {
        return Err(scanner.fail(format!("a list of {expected} should stand here, it has {count} entries")));
    }
    match scanner.next() {
        Token::Mark(b'(') => Ok(Form::Each),
        // Only where it is known how many there are: a short text cannot ask for much memory.
        Token::Mark(b'{') if expected.is_some() => Ok(Form::Same),
        other => Err(scanner.fail(format!("the list should begin here, found {}", other.shown()))),
    }
}

enum Form {
    Each,
    Same,
}

/// An empty list may come without brackets.
fn is_bare(scanner: &mut Scanner, count: usize) -> bool {
    count == 0 && !matches!(scanner.peek(), Token::Mark(b'(' | b'{'))
}

/// A list of whole numbers from 0 on.
pub(super) fn labels(scanner: &mut Scanner, head: &Head, expected: Option<usize>) -> Result<Vec<u32>, Error> {
    let count = count(scanner, if head.binary { head.label } else { 1 })?;
    if is_bare(scanner, count) && expected.is_none_or(|expected| expected == 0) {
        return Ok(Vec::new());
    }
    let found = match open(scanner, count, expected)? {
        Form::Same => {
            let value = label(scanner)?;
            scanner.expect(b'}')?;
            return Ok(vec![value; count]);
        }
        Form::Each if !head.binary => (0..count).map(|_| label(scanner)).collect::<Result<_, _>>()?,
        Form::Each => {
            let bytes = scanner.raw(bytes_of(scanner, count, head.label)?)?;
            let fit = |value: i64| {
                u32::try_from(value).map_err(|_| scanner.fail(format!("{value} is no number of a point, face or cell")))
            };
            match head.label {
                4 => bytes
                    .as_chunks()
                    .0
                    .iter()
                    .map(|&four| fit(i64::from(i32::from_le_bytes(four))))
                    .collect::<Result<_, _>>()?,
                _ => {
                    bytes.as_chunks().0.iter().map(|&eight| fit(i64::from_le_bytes(eight))).collect::<Result<_, _>>()?
                }
            }
        }
    };
    scanner.expect(b')')?;
    Ok(found)
}

fn label(scanner: &mut Scanner) -> Result<u32, Error> {
    let value: i64 = scanner.value()?;
    u32::try_from(value).map_err(|_| scanner.fail(format!("{value} is no number of a point, face or cell")))
}

fn bytes_of(scanner: &Scanner, count: usize, each: usize) -> Result<usize, Error> {
    count.checked_mul(each).ok_or_else(|| scanner.fail(format!("{count} entries are too many")))
}

/// A list of tuples of `width` finite reals (of one: of bare numbers), row by row.
pub(super) fn reals(
    scanner: &mut Scanner,
    head: &Head,
    width: usize,
    expected: Option<usize>,
) -> Result<Vec<f64>, Error> {
    let count = count(scanner, if head.binary { head.scalar * width } else { width })?;
    if is_bare(scanner, count) && expected.is_none_or(|expected| expected == 0) {
        return Ok(Vec::new());
    }
    let mut found = Vec::new();
    match open(scanner, count, expected)? {
        Form::Same => {
            tuple(scanner, width, &mut found)?;
            scanner.expect(b'}')?;
            return Ok(found.repeat(count));
        }
        Form::Each if !head.binary => {
            found.reserve(count * width);
            (0..count).try_for_each(|_| tuple(scanner, width, &mut found))?;
        }
        Form::Each => {
            let bytes = scanner.raw(bytes_of(scanner, count, head.scalar * width)?)?;
            found = match head.scalar {
                4 => bytes.as_chunks().0.iter().map(|&four| f64::from(f32::from_le_bytes(four))).collect(),
                _ => bytes.as_chunks().0.iter().map(|&eight| f64::from_le_bytes(eight)).collect(),
            };
            if let Some(at) = found.iter().position(|value| !value.is_finite()) {
                return Err(scanner.fail(format!(
                    "entry {} of {count} of the list that ends here is not finite: {}",
                    at / width,
                    found[at]
                )));
            }
        }
    }
    scanner.expect(b')')?;
    Ok(found)
}

/// A number, or `(a b c)`.
pub(super) fn tuple(scanner: &mut Scanner, width: usize, found: &mut Vec<f64>) -> Result<(), Error> {
    if width == 1 {
        found.push(scanner.real()?);
        return Ok(());
    }
    scanner.expect(b'(')?;
    for _ in 0..width {
        found.push(scanner.real()?);
    }
    scanner.expect(b')')
}

/// Faces of three or four points, behind the third of three none: `n(3(a b c) …)` as text, or, of the class faceCompactList, where each begins and
/// then all of their points.
pub(super) fn faces(scanner: &mut Scanner, head: &Head) -> Result<Vec<Face>, Error> {
    let other = |scanner: &Scanner, face: usize, size: u64| {
        let wanted = "only tetrahedra, prisms, pyramids and hexahedra are read; split the cells first";
        scanner.fail(format!("face {face} has {size} points: {wanted}"))
    };
    if head.class == "faceCompactList" {
        let starts = labels(scanner, head, None)?;
        let points = labels(scanner, head, Some(starts.last().map_or(0, |&last| last as usize)))?;
        if starts.first().is_some_and(|&first| first != 0) {
            return Err(scanner.fail("the first face should begin at 0"));
        }
        let mut found = Vec::with_capacity(starts.len());
        for (face, pair) in starts.windows(2).enumerate() {
            match points.get(pair[0] as usize..pair[1] as usize) {
                Some(&[a, b, c]) => found.push([a, b, c, NONE]),
                Some(&[a, b, c, d]) => found.push([a, b, c, d]),
                _ => return Err(other(scanner, face, u64::from(pair[1]).saturating_sub(pair[0].into()))),
            }
        }
        return Ok(found);
    }
    let count = count(scanner, 6)?;
    scanner.expect(b'(')?;
    let mut faces = Vec::with_capacity(count);
    for face in 0..count {
        let size: u64 = scanner.value()?;
        if size != 3 && size != 4 {
            return Err(other(scanner, face, size));
        }
        scanner.expect(b'(')?;
        let [a, b, c] = [label(scanner)?, label(scanner)?, label(scanner)?];
        faces.push([a, b, c, if size == 4 { label(scanner)? } else { NONE }]);
        scanner.expect(b')')?;
    }
    scanner.expect(b')')?;
    Ok(faces)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn head(binary: bool, label: usize, scalar: usize) -> Head {
        Head { class: String::new(), binary, label, scalar }
    }

    #[test]
    fn labels_in_every_form() {
        let path = Path::new("f");
        let read = |bytes: &[u8], head: &Head, expected| labels(&mut Scanner::new(path, bytes), head, expected);
        let text = head(false, 4, 8);
        assert_eq!(read(b"3(0 7 2)", &text, None).unwrap(), [0, 7, 2]);
        assert_eq!(read(b" 3 {5}", &text, Some(3)).unwrap(), [5, 5, 5]);
        assert!(read(b"0", &text, None).unwrap().is_empty());
        assert!(read(b"0()", &text, Some(0)).unwrap().is_empty());
        for (label, bytes) in
            [(4, [1i32, 2].map(i32::to_le_bytes).concat()), (8, [1i64, 2].map(i64::to_le_bytes).concat())]
        {
            let bytes = [b"\n2\n(", &bytes[..], b")"].concat();
            assert_eq!(read(&bytes, &head(true, label, 8), None).unwrap(), [1, 2]);
        }
        let message = |bytes: &[u8], head: &Head, expected| read(bytes, head, expected).unwrap_err().to_string();
        assert!(message(b"900000000000{0}", &text, None).contains("the list should begin here, found `{`"));
        assert!(message(b"900000000000(0)", &text, None).contains("too short"));
        assert!(message(b"2(0 -1)", &text, None).contains("-1 is no number of a point"));
        assert!(message(b"2(0 1)", &text, Some(3)).contains("a list of 3 should stand here, it has 2"));
        assert!(
            message(&[b"1(", &(-2i32).to_le_bytes()[..], b")"].concat(), &head(true, 4, 8), None)
                .contains("-2 is no number")
        );
        assert!(message(b"4611686018427387905(", &head(true, 8, 8), None).contains("too short"));
    }

    #[test]
    fn reals_in_every_form() {
        let path = Path::new("f");
        let read = |bytes: &[u8], head: &Head, width| reals(&mut Scanner::new(path, bytes), head, width, Some(2));
        let text = head(false, 4, 8);
        assert_eq!(read(b"2(0.5 -1e3)", &text, 1).unwrap(), [0.5, -1e3]);
        assert_eq!(read(b"2((1 2 3) (4 5 6))", &text, 3).unwrap(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(read(b"2{(1 2 3)}", &text, 3).unwrap(), [1.0, 2.0, 3.0, 1.0, 2.0, 3.0]);
        let single = [b"2(", &[0.5f32, 2.0].map(f32::to_le_bytes).concat()[..], b")"].concat();
        assert_eq!(read(&single, &head(true, 4, 4), 1).unwrap(), [0.5, 2.0]);
        let nan = [b"2(", &[0.5, f64::NAN].map(f64::to_le_bytes).concat()[..], b")"].concat();
        assert!(read(&nan, &head(true, 4, 8), 1).unwrap_err().to_string().contains("entry 1 of 2"));
        assert!(read(b"2(0.5 inf)", &text, 1).is_err());
    }

    #[test]
    fn faces_of_other_than_three_or_four_points_are_named() {
        let path = Path::new("f");
        let text = Head { class: "faceList".into(), ..head(false, 4, 8) };
        let read = |bytes: &[u8], head: &Head| faces(&mut Scanner::new(path, bytes), head);
        assert_eq!(read(b"2(3(0 1 2) 4(3 4 5 6))", &text).unwrap(), [[0, 1, 2, NONE], [3, 4, 5, 6]]);
        assert!(read(b"2(3(0 1 2) 5(3 4 5 6 7))", &text).unwrap_err().to_string().contains("face 1 has 5 points"));
        let compact = Head { class: "faceCompactList".into(), ..text };
        assert_eq!(read(b"3(0 3 7)\n7(0 1 2 3 4 5 6)", &compact).unwrap(), [[0, 1, 2, NONE], [3, 4, 5, 6]]);
        assert!(
            read(b"3(0 3 8)\n8(0 1 2 3 4 5 6 7)", &compact).unwrap_err().to_string().contains("face 1 has 5 points")
        );
        assert!(read(b"2(1 4)\n4(0 1 2 3)", &compact).is_err());
    }
}
