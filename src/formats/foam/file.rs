//! A file of OpenFOAM: plain or gzip, with its head.
use super::scan::{Scanner, Token};
use crate::mesh::io::{Error, read_file};
use std::ffi::OsString;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The bytes of a file, unpacked.
pub(super) struct FoamFile {
    /// Where they came from.
    pub path: PathBuf,
    bytes: Vec<u8>,
}

/// What the head of a file says (OpenFOAM user guide, "Basic input/output file format").
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Head {
    /// What the file holds, such as `volScalarField`.
    pub class: String,
    /// Whether its long lists are raw bytes.
    pub binary: bool,
    /// Bytes of a whole number in these lists, 4 or 8.
    pub label: usize,
    /// Bytes of a real number in these lists, 4 or 8.
    pub scalar: usize,
}

/// The file of that name, or with `.gz` behind it, whichever is there.
pub(super) fn find(folder: &Path, name: &str) -> Option<PathBuf> {
    let plain = folder.join(name);
    let mut packed = OsString::from(name);
    packed.push(".gz");
    let packed = folder.join(packed);
    if plain.is_file() { Some(plain) } else { packed.is_file().then_some(packed) }
}

impl FoamFile {
    /// Reads a file; one that ends in `.gz` is unpacked (to at most 1032 times its size: deflate has no higher ratio).
    pub fn open(path: &Path) -> Result<Self, Error> {
        let system = |source| Error::System { path: path.to_owned(), source };
        let mut bytes = read_file(path)?;
        if path.extension().is_some_and(|extension| extension == "gz") {
            let mut unpacked = Vec::new();
            flate2::read::MultiGzDecoder::new(&bytes[..]).read_to_end(&mut unpacked).map_err(system)?;
            bytes = unpacked;
        }
        Ok(Self { path: path.to_owned(), bytes })
    }

    /// The head, and what follows it.
    pub fn parts(&self) -> Result<(Head, Scanner<'_>), Error> {
        let mut scanner = Scanner::new(&self.path, &self.bytes);
        if scanner.next() != Token::Word(b"FoamFile") {
            return Err(scanner.fail("`FoamFile` should stand here: this is no file of OpenFOAM"));
        }
        let head = head(&mut scanner)?;
        Ok((head, scanner))
    }
}

fn head(scanner: &mut Scanner) -> Result<Head, Error> {
    let mut head = Head { class: String::new(), binary: false, label: 4, scalar: 8 };
    scanner.expect(b'{')?;
    while scanner.peek() != Token::Mark(b'}') {
        match scanner.word()? {
            b"class" => head.class = String::from_utf8_lossy(scanner.word()?).into_owned(),
            b"format" => head.binary = scanner.word()? == b"binary",
            b"arch" => {
                let arch = scanner.word()?;
                let says = |wanted: &[u8]| arch.windows(wanted.len()).any(|part| part == wanted);
                if says(b"MSB") {
                    return Err(scanner
                        .fail("the numbers are in the order of another machine (MSB): run foamFormatConvert there"));
                }
                head.label = if says(b"label=64") { 8 } else { 4 };
                head.scalar = if says(b"scalar=32") { 4 } else { 8 };
            }
            _ => {
                scanner.skip_entry()?;
                continue;
            }
        }
        scanner.expect(b';')?;
    }
    scanner.expect(b'}')?;
    Ok(head)
}

/// The head that we write: text, or raw bytes of 32-bit whole and 64-bit real numbers.
pub(super) fn head_text(class: &str, location: &str, object: &str, text: bool) -> String {
    let format = if text { "ascii" } else { "binary" };
    format!(
        "FoamFile\n{{\n    version     2.0;\n    format      {format};\n    arch        \"LSB;label=32;scalar=64\";\n    \
         class       {class};\n    location    \"{location}\";\n    object      {object};\n}}\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head_of(text: &str) -> Result<Head, String> {
        let file = FoamFile { path: "f".into(), bytes: text.as_bytes().to_vec() };
        file.parts().map(|(head, _)| head).map_err(|error| error.to_string())
    }

    #[test]
    fn what_is_written_is_read() {
        for text in [true, false] {
            let head = head_of(&head_text("faceList", "constant/polyMesh", "faces", text)).unwrap();
            assert_eq!(head, Head { class: "faceList".into(), binary: !text, label: 4, scalar: 8 });
        }
        let wide = "/* x */ FoamFile { note \"a; b\"; meta { a 1; } format binary; arch \"LSB;label=64;scalar=32\"; class c; } 1";
        assert_eq!(head_of(wide).unwrap(), Head { class: "c".into(), binary: true, label: 8, scalar: 4 });
        assert!(head_of("FoamFile { arch \"MSB;label=32;scalar=64\"; }").unwrap_err().contains("another machine"));
        assert!(head_of("points").unwrap_err().contains("no file of OpenFOAM"));
        assert!(head_of("FoamFile { class").is_err());
    }
}
