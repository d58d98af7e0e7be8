//! The elements of a .vtu: which arrays there are, and where their data is.
use super::super::error;
use crate::mesh::io::Error;
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use std::path::Path;

/// Type of the values of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Int(usize),
    Unsigned(usize),
    Real(usize),
    /// Texts, bits: not ours.
    Other,
}

impl Kind {
    /// Bytes of a value.
    pub fn size(self) -> usize {
        match self {
            Self::Int(size) | Self::Unsigned(size) | Self::Real(size) => size,
            Self::Other => 1,
        }
    }
}

/// Where the data of an array is.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place<'a> {
    /// Words in the element.
    Text(&'a str),
    /// Base64 in the element.
    Base64(&'a str),
    /// In the appended data, at a byte (raw) or character (base64) behind the underscore.
    Appended(usize),
}

/// An array.
#[derive(Clone, Debug)]
pub(super) struct Array<'a> {
    pub name: String,
    pub kind: Kind,
    /// Values an item.
    pub width: usize,
    pub place: Place<'a>,
}

/// A piece of the grid.
#[derive(Clone, Debug, Default)]
pub(super) struct Piece<'a> {
    pub points: usize,
    pub cells: usize,
    pub coordinates: Vec<Array<'a>>,
    pub topology: Vec<Array<'a>>,
    pub point_data: Vec<Array<'a>>,
    pub cell_data: Vec<Array<'a>>,
}

/// All of it.
#[derive(Debug, Default)]
pub(super) struct Document<'a> {
    pub pieces: Vec<Piece<'a>>,
    pub field_data: Vec<Array<'a>>,
    pub is_big_endian: bool,
    /// Bytes of the numbers before binary data.
    pub header: usize,
    pub is_compressed: bool,
    /// What follows the underscore, and whether it is in base64.
    pub appended: Option<(&'a [u8], bool)>,
}

/// What encloses an array.
#[derive(Clone, Copy, PartialEq)]
enum Part {
    Nothing,
    Field,
    Points,
    Cells,
    PointData,
    CellData,
}

/// Begins the appended data, which is no XML when it is raw.
const APPENDED: &[u8] = b"<AppendedData";

/// Takes a file apart.
pub(super) fn document<'a>(path: &Path, bytes: &'a [u8]) -> Result<Document<'a>, Error> {
    let cut = bytes.windows(APPENDED.len()).position(|part| part == APPENDED);
    let (head, tail) = bytes.split_at(cut.unwrap_or(bytes.len()));
    let head = std::str::from_utf8(head).map_err(|error| {
        error::at(
            path,
            format!("byte {}", error.valid_up_to()),
            "the text before the appended data is not UTF-8; write the file again",
        )
    })?;
    let mut walk =
        Walk { path, head, document: Document { header: 4, ..Document::default() }, part: Part::Nothing, at: 0 };
    walk.head()?;
    let mut document = walk.document;
    document.appended = (!tail.is_empty()).then(|| appended(path, tail)).transpose()?;
    if document.pieces.is_empty() {
        return Err(error::at(path, "UnstructuredGrid", "there is no Piece in it; give an unstructured grid of VTK"));
    }
    Ok(document)
}

/// The appended data, and whether it is in base64.
fn appended<'a>(path: &Path, tail: &'a [u8]) -> Result<(&'a [u8], bool), Error> {
    let wrong = |message: &str| error::at(path, "AppendedData", message);
    let end = tail.iter().position(|&byte| byte == b'>').ok_or_else(|| wrong("the file ends in it; it was cut"))?;
    let tag = String::from_utf8_lossy(&tail[..end]);
    let is_base64 = match (tag.contains("\"base64\"") || tag.contains("'base64'"), tag.contains("raw")) {
        (true, _) => true,
        (_, true) => false,
        _ => return Err(wrong("the encoding is neither raw nor base64; write the file again")),
    };
    let data = &tail[end + 1..];
    let blanks = data.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
    let data = data[blanks..].strip_prefix(b"_").ok_or_else(|| wrong("an underscore is expected before the data"))?;
    Ok((data, is_base64))
}

/// Attributes of an element by name.
struct Attributes(Vec<(String, String)>);

impl Attributes {
    fn get(&self, name: &str) -> Option<&str> {
        self.0.iter().find(|(other, _)| other == name).map(|(_, value)| value.trim())
    }
}

struct Walk<'p, 'a> {
    path: &'p Path,
    head: &'a str,
    document: Document<'a>,
    part: Part,
    at: usize,
}

impl<'a> Walk<'_, 'a> {
    fn fail(&self, message: impl Into<String>) -> Error {
        let line = 1 + self.head.as_bytes()[..self.at.min(self.head.len())].iter().filter(|&&b| b == b'\n').count();
        error::at(self.path, format!("line {line}"), message)
    }

    fn head(&mut self) -> Result<(), Error> {
        let mut reader = Reader::from_str(self.head);
        loop {
            self.at = reader.buffer_position() as usize;
            let event = reader
                .read_event()
                .map_err(|error| self.fail(format!("no XML as VTK writes it ({})", brief(&error))))?;
            match event {
                Event::Start(tag) if tag.name().as_ref() == "DataArray" => {
                    let attributes = self.attributes(&tag)?;
                    let text = self.text(&mut reader)?;
                    self.array(&attributes, text)?;
                }
                Event::Empty(tag) if tag.name().as_ref() == "DataArray" => {
                    let attributes = self.attributes(&tag)?;
                    self.array(&attributes, "")?;
                }
                Event::Start(tag) => self.open(&tag)?,
                Event::End(tag) if part_of(tag.name().as_ref()).is_some() => self.part = Part::Nothing,
                Event::Eof => return Ok(()),
                _ => {}
            }
        }
    }

    fn attributes(&self, tag: &BytesStart) -> Result<Attributes, Error> {
        let mut all = Vec::new();
        for attribute in tag.attributes().with_checks(false) {
            let wrong = |error: &dyn std::fmt::Display| self.fail(format!("an attribute is wrong ({})", brief(error)));
            let attribute = attribute.map_err(|error| wrong(&error))?;
            let value = attribute.normalized_value(XmlVersion::Implicit1_0).map_err(|error| wrong(&error))?;
            all.push((attribute.key.as_ref().to_owned(), value.into_owned()));
        }
        Ok(Attributes(all))
    }

    fn count(&self, attributes: &Attributes, name: &str) -> Result<usize, Error> {
        let text = attributes.get(name).ok_or_else(|| self.fail(format!("{name} is missing")))?;
        text.parse().map_err(|_| self.fail(format!("{name}=\"{}\" is no count", error::short(text))))
    }

    fn open(&mut self, tag: &BytesStart) -> Result<(), Error> {
        let name = tag.name();
        match name.as_ref() {
            "VTKFile" => {
                let attributes = self.attributes(tag)?;
                match attributes.get("type") {
                    Some("UnstructuredGrid") => {}
                    other => {
                        let message = format!(
                            "a file of type {}; an UnstructuredGrid (.vtu) is expected",
                            error::short(other.unwrap_or("none"))
                        );
                        return Err(self.fail(message));
                    }
                }
                self.document.is_big_endian = attributes.get("byte_order") == Some("BigEndian");
                self.document.header = if attributes.get("header_type") == Some("UInt64") { 8 } else { 4 };
                self.document.is_compressed = match attributes.get("compressor").filter(|name| !name.is_empty()) {
                    None => false,
                    Some("vtkZLibDataCompressor") => true,
                    Some(other) => {
                        return Err(self.fail(format!(
                            "compressed by {}; write it with ZLib, or not compressed",
                            error::short(other)
                        )));
                    }
                };
            }
            "Piece" => {
                let attributes = self.attributes(tag)?;
                let [points, cells] = ["NumberOfPoints", "NumberOfCells"].map(|name| self.count(&attributes, name));
                self.document.pieces.push(Piece { points: points?, cells: cells?, ..Piece::default() });
            }
            other => self.part = part_of(other).unwrap_or(self.part),
        }
        Ok(())
    }

    /// The text of an array up to its end; what stands in elements within it is about its values.
    fn text(&self, reader: &mut Reader<&'a [u8]>) -> Result<&'a str, Error> {
        let (mut depth, mut found) = (0_usize, "");
        loop {
            let event = reader
                .read_event()
                .map_err(|error| self.fail(format!("no XML as VTK writes it ({})", brief(&error))))?;
            match event {
                Event::Start(_) => depth += 1,
                Event::End(_) if depth == 0 => return Ok(found),
                Event::End(_) => depth -= 1,
                Event::Text(text) if depth == 0 => {
                    let std::borrow::Cow::Borrowed(text) = text.into_inner() else {
                        unreachable!("a text of a slice is borrowed")
                    };
                    match (found.trim_ascii().is_empty(), text.trim_ascii().is_empty()) {
                        (_, true) => {}
                        (true, false) => found = text,
                        (false, false) => {
                            return Err(self.fail("the values of an array are in two pieces; write the file again"));
                        }
                    }
                }
                Event::Eof => return Err(self.fail("the file ends within an array; it was cut")),
                _ => {}
            }
        }
    }

    fn array(&mut self, attributes: &Attributes, text: &'a str) -> Result<(), Error> {
        let kind = match attributes.get("type") {
            Some("Int8") => Kind::Int(1),
            Some("Int16") => Kind::Int(2),
            Some("Int32") => Kind::Int(4),
            Some("Int64") => Kind::Int(8),
            Some("UInt8") => Kind::Unsigned(1),
            Some("UInt16") => Kind::Unsigned(2),
            Some("UInt32") => Kind::Unsigned(4),
            Some("UInt64") => Kind::Unsigned(8),
            Some("Float32") => Kind::Real(4),
            Some("Float64") => Kind::Real(8),
            _ => Kind::Other,
        };
        let place = match attributes.get("format") {
            Some("appended") => Place::Appended(self.count(attributes, "offset")?),
            Some("binary") => Place::Base64(text),
            Some("ascii") | None => Place::Text(text),
            Some(other) => {
                return Err(self.fail(format!(
                    "format=\"{}\" of an array: ascii, binary or appended are read",
                    error::short(other)
                )));
            }
        };
        let width = match attributes.get("NumberOfComponents") {
            None | Some("") => 1,
            Some(_) => self.count(attributes, "NumberOfComponents")?.max(1),
        };
        let array = Array { name: attributes.get("Name").unwrap_or("").to_owned(), kind, width, place };
        let piece = self.document.pieces.last_mut();
        let list = match (self.part, piece) {
            (Part::Field, None) => Some(&mut self.document.field_data),
            (Part::Points, Some(piece)) => Some(&mut piece.coordinates),
            (Part::Cells, Some(piece)) => Some(&mut piece.topology),
            (Part::PointData, Some(piece)) => Some(&mut piece.point_data),
            (Part::CellData, Some(piece)) => Some(&mut piece.cell_data),
            _ => None,
        };
        list.into_iter().for_each(|list| list.push(array.clone()));
        Ok(())
    }
}

/// What is wrong with the XML; elements of damaged files can have very long names.
fn brief(error: &dyn std::fmt::Display) -> String {
    error.to_string().chars().take(120).flat_map(char::escape_debug).collect()
}

fn part_of(name: &str) -> Option<Part> {
    Some(match name {
        "FieldData" => Part::Field,
        "Points" => Part::Points,
        "Cells" => Part::Cells,
        "PointData" => Part::PointData,
        "CellData" => Part::CellData,
        _ => return None,
    })
}
