//! Patches of the boundary, and zones of cells and faces.
use super::file::Head;
use super::list;
use super::scan::{Scanner, Token};
use crate::mesh::io::Error;
use std::ops::Range;

/// Faces at the end of the list of faces that have a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Patch {
    /// The name; `label` has the whole one where it is no word of OpenFOAM's (we write it; OpenFOAM passes over it).
    pub name: String,
    /// Its reference in the mesh: what the entry `reference` says (we write it; OpenFOAM passes over it), else its number from 1.
    pub reference: i32,
    /// The type: `patch`, `wall`, `symmetryPlane`.
    pub kind: String,
    /// Its faces.
    pub faces: Range<usize>,
    /// The references of its faces, each with their number, in their order, where there are several: what the entry `parts` says (we write
    /// it; OpenFOAM passes over it).
    pub parts: Vec<(i32, usize)>,
}

/// Cells or faces that have a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Zone {
    /// The name.
    pub name: String,
    /// Its reference in the mesh, as of a [`Patch`].
    pub reference: i32,
    /// The cells or faces.
    pub members: Vec<u32>,
}

/// Calls `read` with each name of `n ( name { … } … )` and the scanner behind its `{`.
fn entries(
    scanner: &mut Scanner,
    mut read: impl FnMut(&mut Scanner, usize, String) -> Result<(), Error>,
) -> Result<(), Error> {
    let count: usize = scanner.value()?;
    scanner.expect(b'(')?;
    for number in 0..count {
        let name = String::from_utf8_lossy(scanner.word()?).into_owned();
        scanner.expect(b'{')?;
        read(scanner, number, name)?;
        scanner.expect(b'}')?;
    }
    scanner.expect(b')')
}

fn number_from_1(scanner: &Scanner, number: usize) -> Result<i32, Error> {
    i32::try_from(number + 1).map_err(|_| scanner.fail("these are too many"))
}

/// The patches; each lies within so many faces.
pub(super) fn patches(scanner: &mut Scanner, faces: usize) -> Result<Vec<Patch>, Error> {
    let mut found = Vec::new();
    entries(scanner, |scanner, number, name| {
        let mut patch = Patch {
            name,
            reference: number_from_1(scanner, number)?,
            kind: String::new(),
            faces: 0..0,
            parts: Vec::new(),
        };
        let (mut start, mut count) = (0usize, 0usize);
        while scanner.peek() != Token::Mark(b'}') {
            match scanner.word()? {
                b"type" => patch.kind = String::from_utf8_lossy(scanner.word()?).into_owned(),
                b"nFaces" => count = scanner.value()?,
                b"startFace" => start = scanner.value()?,
                b"reference" => patch.reference = scanner.value()?,
                b"parts" => patch.parts = parts(scanner)?,
                b"label" => patch.name = String::from_utf8_lossy(scanner.word()?).into_owned(),
                _ => {
                    scanner.skip_entry()?;
                    continue;
                }
            }
            scanner.expect(b';')?;
        }
        patch.faces = match start.checked_add(count) {
            Some(end) if end <= faces => start..end,
            _ => {
                return Err(scanner.fail(format!(
                    "patch {} has {count} faces from {start} on, but there are {faces} faces",
                    patch.name
                )));
            }
        };
        // Where another program has changed the faces they are of one reference.
        let mut total = 0usize;
        patch.parts.iter().for_each(|part| total = total.saturating_add(part.1));
        if total != count {
            patch.parts.clear();
        }
        found.push(patch);
        Ok(())
    })?;
    Ok(found)
}

/// References with their numbers of faces: `(2 18 5 18)`.
fn parts(scanner: &mut Scanner) -> Result<Vec<(i32, usize)>, Error> {
    let mut found = Vec::new();
    scanner.expect(b'(')?;
    while scanner.peek() != Token::Mark(b')') {
        found.push((scanner.value()?, scanner.value()?));
    }
    scanner.expect(b')')?;
    Ok(found)
}

/// The zones, whose members stand behind `list` (`cellLabels`, `faceLabels`) and are less than `items`.
pub(super) fn zones(scanner: &mut Scanner, head: &Head, list: &[u8], items: usize) -> Result<Vec<Zone>, Error> {
    let mut found = Vec::new();
    entries(scanner, |scanner, number, name| {
        let mut zone = Zone { name, reference: number_from_1(scanner, number)?, members: Vec::new() };
        while scanner.peek() != Token::Mark(b'}') {
            let key = scanner.word()?;
            if key == b"reference" {
                zone.reference = scanner.value()?;
                scanner.expect(b';')?;
            } else if key == b"label" {
                zone.name = String::from_utf8_lossy(scanner.word()?).into_owned();
                scanner.expect(b';')?;
            } else if key == list {
                if matches!(scanner.peek(), Token::Word(word) if word.starts_with(b"List")) {
                    scanner.word()?;
                }
                zone.members = list::labels(scanner, head, None)?;
                if let Some(&far) = zone.members.iter().find(|&&member| member as usize >= items) {
                    return Err(scanner.fail(format!("zone {} has number {far}, but there are {items}", zone.name)));
                }
                scanner.expect(b';')?;
            } else if key == b"flipMap" {
                flips(scanner, head)?;
            } else {
                scanner.skip_entry()?;
            }
        }
        found.push(zone);
        Ok(())
    })?;
    Ok(found)
}

/// Passes over a list of booleans: a byte each.
fn flips(scanner: &mut Scanner, head: &Head) -> Result<(), Error> {
    if head.binary {
        if matches!(scanner.peek(), Token::Word(word) if word.starts_with(b"List")) {
            scanner.word()?;
        }
        let count: usize = scanner.value()?;
        if scanner.peek() == Token::Mark(b'(') {
            scanner.expect(b'(')?;
            scanner.raw(count)?;
            scanner.expect(b')')?;
        }
        return scanner.expect(b';');
    }
    scanner.skip_entry()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn patches_with_and_without_a_reference() {
        let text = b"2 ( wall { type wall; inGroups 1(wall); nFaces 2; startFace 5; } \
            \"far field\" { startFace 7; nFaces 3; type patch; reference 12; x { y 1; } } )";
        let found = patches(&mut Scanner::new(Path::new("f"), text), 10).unwrap();
        let patch = |name: &str, reference, kind: &str, faces, parts: &[_]| Patch {
            name: name.into(),
            reference,
            kind: kind.into(),
            faces,
            parts: parts.to_vec(),
        };
        assert_eq!(found, [patch("wall", 1, "wall", 5..7, &[]), patch("far field", 12, "patch", 7..10, &[])]);
        let few = patches(&mut Scanner::new(Path::new("f"), text), 9).unwrap_err().to_string();
        assert!(few.contains("patch far field has 3 faces from 7 on, but there are 9"));
        let text = b"1 ( wall { type wall; nFaces 3; startFace 7; parts (4 1 9 2); reference 4; } )";
        let found = patches(&mut Scanner::new(Path::new("f"), text), 10).unwrap();
        assert_eq!(found, [patch("wall", 4, "wall", 7..10, &[(4, 1), (9, 2)])]);
        // Another program has taken faces away.
        let text = b"1 ( wall { type wall; nFaces 2; startFace 7; parts (4 1 9 2); reference 4; } )";
        let found = patches(&mut Scanner::new(Path::new("f"), text), 10).unwrap();
        assert_eq!(found, [patch("wall", 4, "wall", 7..9, &[])]);
    }

    #[test]
    fn zones_in_text_and_in_bytes() {
        let head = |binary| Head { class: String::new(), binary, label: 4, scalar: 8 };
        let read =
            |bytes: &[u8], binary| zones(&mut Scanner::new(Path::new("f"), bytes), &head(binary), b"faceLabels", 4);
        let text = b"1(a { type faceZone; faceLabels List<label> 2(1 3); flipMap List<bool> 2(0 1); reference 7; })";
        let zone = Zone { name: "a".into(), reference: 7, members: vec![1, 3] };
        assert_eq!(read(text, false).unwrap(), std::slice::from_ref(&zone));
        let bytes = [
            b"1(a { faceLabels List<label> \n2\n(",
            &[1i32, 3].map(i32::to_le_bytes).concat()[..],
            b"); flipMap List<bool> \n2\n(};); reference 7; })",
        ];
        assert_eq!(read(&bytes.concat(), true).unwrap(), [zone]);
        assert!(
            read(b"1(a { faceLabels List<label> 2(1 4); })", false)
                .unwrap_err()
                .to_string()
                .contains("number 4, but there are 4")
        );
    }
}
