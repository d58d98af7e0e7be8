//! The header: lines `field: value` up to an empty one.
use super::{Encoding, Kind, content};
use crate::image::frame::Frame;
use crate::mesh::io::Error;
use crate::mesh::vector::Vec3;
use std::path::{Path, PathBuf};

/// What the header says of the voxels.
pub struct Header {
    pub kind: Kind,
    pub sizes: [usize; 3],
    pub frame: Frame,
    pub encoding: Encoding,
    pub big_endian: bool,
    /// The file of the voxels, when they are not behind the header.
    pub data_file: Option<PathBuf>,
    /// Lines passed over before the voxels.
    pub line_skip: usize,
    /// Bytes passed over then; none: the voxels are the last bytes of the file.
    pub byte_skip: Option<usize>,
}

/// A field's value and its line, counted from 1.
#[derive(Clone, Copy)]
struct Value<'a> {
    text: &'a str,
    line: usize,
}

/// Fields that are used, by the spelling without blanks.
const USED: [&str; 14] = [
    "type",
    "dimension",
    "sizes",
    "encoding",
    "endian",
    "spacings",
    "spacedirections",
    "spaceorigin",
    "spacedimension",
    "datafile",
    "lineskip",
    "byteskip",
    "axismins",
    "axismaxs",
];

/// Fields that say nothing of shape, values or place.
const IGNORED: [&str; 19] = [
    "content",
    "kinds",
    "space",
    "spaceunits",
    "units",
    "labels",
    "centers",
    "centerings",
    "thicknesses",
    "min",
    "max",
    "oldmin",
    "oldmax",
    "number",
    "sampleunits",
    "measurementframe",
    "blocksize",
    "date",
    "comment",
];

/// The fields of a header.
struct Fields<'a> {
    path: &'a Path,
    /// In the order of [`USED`].
    values: [Option<Value<'a>>; USED.len()],
    /// Lines of the header.
    lines: usize,
}

/// Parses the header; also where the rest of the file begins.
pub fn parse(path: &Path, file: &[u8]) -> Result<(Header, usize), Error> {
    let (fields, rest) = Fields::read(path, file)?;
    let header = fields.header()?;
    Ok((header, rest))
}

impl<'a> Fields<'a> {
    fn read(path: &'a Path, file: &'a [u8]) -> Result<(Self, usize), Error> {
        let mut fields = Self { path, values: [None; USED.len()], lines: 0 };
        let mut at = 0;
        while at < file.len() {
            let end = file[at..].iter().position(|&byte| byte == b'\n').map_or(file.len(), |length| at + length);
            let next = (end + 1).min(file.len());
            fields.lines += 1;
            let line = file[at..end].strip_suffix(b"\r").unwrap_or(&file[at..end]);
            at = next;
            if fields.lines == 1 {
                let version = line.strip_prefix(b"NRRD000");
                if !version.is_some_and(|digit| matches!(digit, [b'1'..=b'5'])) {
                    return Err(fields.wrong(1, "not NRRD: the first line must be NRRD0001 to NRRD0005"));
                }
                continue;
            }
            if line.is_empty() {
                break;
            }
            let text = std::str::from_utf8(line).map_err(|_| {
                fields.wrong(fields.lines, "is no text; an empty line must stand between the header and the voxels")
            })?;
            fields.add(text)?;
        }
        if fields.lines == 0 {
            return Err(fields.wrong(1, "not NRRD: the file is empty"));
        }
        Ok((fields, at))
    }

    fn wrong(&self, line: usize, message: impl Into<String>) -> Error {
        content(self.path, format!("line {line}"), message)
    }

    /// Takes a line that is not empty.
    fn add(&mut self, text: &'a str) -> Result<(), Error> {
        let line = self.lines;
        if text.starts_with('#') || text.contains(":=") {
            return Ok(());
        }
        let Some((name, value)) = text.split_once(':') else {
            return Err(self.wrong(line, format!("'{text}' is no field; write 'field: value', or # before a comment")));
        };
        let name: String = name.chars().filter(|c| !c.is_whitespace()).flat_map(char::to_lowercase).collect();
        if let Some(field) = USED.iter().position(|&used| used == name) {
            if let Some(before) = self.values[field] {
                return Err(self.wrong(line, format!("the field of line {} again; delete one", before.line)));
            }
            self.values[field] = Some(Value { text: value.trim(), line });
        } else if !IGNORED.contains(&name.as_str()) {
            return Err(
                self.wrong(line, format!("the field '{name}' is not known; write name:=value for what is your own"))
            );
        }
        Ok(())
    }

    fn get(&self, name: &str) -> Option<Value<'a>> {
        self.values[USED.iter().position(|&used| used == name).expect("a used field")]
    }

    fn require(&self, name: &str) -> Result<Value<'a>, Error> {
        let message = || format!("the header ends without the field '{name}'; add it");
        self.get(name).ok_or_else(|| self.wrong(self.lines, message()))
    }

    fn header(&self) -> Result<Header, Error> {
        let kind = self.kind()?;
        let sizes = self.sizes()?;
        let encoding = self.encoding()?;
        let detached = self.get("datafile").map(|value| self.data_file(value)).transpose()?;
        let line_skip = self.skip("lineskip")?.unwrap_or(0);
        let byte_skip = match self.get("byteskip") {
            Some(value) if value.text == "-1" && encoding == Encoding::Raw => None,
            _ => Some(self.skip("byteskip")?.unwrap_or(0)),
        };
        let big_endian = self.big_endian(kind, encoding)?;
        let frame = self.frame()?;
        Ok(Header { kind, sizes, frame, encoding, big_endian, data_file: detached, line_skip, byte_skip })
    }

    fn kind(&self) -> Result<Kind, Error> {
        let value = self.require("type")?;
        let name = value.text.to_lowercase();
        let name = name.split_whitespace().collect::<Vec<_>>().join(" ");
        Kind::ALL.into_iter().find(|kind| kind.names().contains(&name.as_str())).ok_or_else(|| {
            let message = "is not supported; convert to int8, uint8, int16, uint16, int32, uint32, float or double";
            self.wrong(value.line, format!("type '{}' {message}", value.text))
        })
    }

    fn sizes(&self) -> Result<[usize; 3], Error> {
        let dimension = self.require("dimension")?;
        if dimension.text != "3" {
            let message = format!(
                "dimension {}; only images of 3 axes can be meshed: take one channel, one time",
                dimension.text
            );
            return Err(self.wrong(dimension.line, message));
        }
        let value = self.require("sizes")?;
        let sizes: Option<Vec<usize>> = value.text.split_whitespace().map(|size| size.parse().ok()).collect();
        let sizes: [usize; 3] =
            sizes.and_then(|sizes| sizes.try_into().ok()).filter(|sizes: &[usize; 3]| !sizes.contains(&0)).ok_or_else(
                || self.wrong(value.line, format!("sizes '{}'; give three positive whole numbers", value.text)),
            )?;
        let voxels = sizes.iter().try_fold(8, |product: usize, &size| product.checked_mul(size));
        match voxels {
            Some(bytes) if bytes <= isize::MAX as usize => Ok(sizes),
            _ => Err(self.wrong(value.line, format!("sizes '{}' are more than any memory", value.text))),
        }
    }

    fn encoding(&self) -> Result<Encoding, Error> {
        let value = self.require("encoding")?;
        match value.text.to_lowercase().as_str() {
            "raw" => Ok(Encoding::Raw),
            "gzip" | "gz" => Ok(Encoding::Gzip),
            "text" | "txt" | "ascii" => Ok(Encoding::Text),
            other => {
                Err(self
                    .wrong(value.line, format!("encoding '{other}' is not supported; save it as raw, gzip or text")))
            }
        }
    }

    fn big_endian(&self, kind: Kind, encoding: Encoding) -> Result<bool, Error> {
        let Some(value) = self.get("endian") else {
            if kind.size() == 1 || encoding == Encoding::Text {
                return Ok(false);
            }
            self.require("endian")?;
            return Ok(false);
        };
        match value.text.to_lowercase().as_str() {
            "little" => Ok(false),
            "big" => Ok(true),
            other => Err(self.wrong(value.line, format!("endian '{other}'; say little or big"))),
        }
    }

    fn data_file(&self, value: Value<'_>) -> Result<PathBuf, Error> {
        let several = value.text.starts_with("LIST") || value.text.contains('%');
        if value.text.is_empty() || several {
            let message = format!("data file '{}'; name one file: several are not supported", value.text);
            return Err(self.wrong(value.line, message));
        }
        Ok(self.path.parent().unwrap_or(Path::new("")).join(value.text))
    }

    fn skip(&self, name: &str) -> Result<Option<usize>, Error> {
        let Some(value) = self.get(name) else { return Ok(None) };
        let skip = value.text.parse().map_err(|_| {
            self.wrong(
                value.line,
                format!("skip '{}'; give a whole number (-1 for bytes of raw voxels only)", value.text),
            )
        })?;
        Ok(Some(skip))
    }

    fn frame(&self) -> Result<Frame, Error> {
        for name in ["axismins", "axismaxs"] {
            if let Some(value) =
                self.get(name).filter(|value| value.text.split_whitespace().any(|x| x.to_lowercase() != "nan"))
            {
                return Err(self
                    .wrong(value.line, "axis mins and maxs are not supported; use space directions and space origin"));
            }
        }
        if let Some(value) = self.get("spacedimension").filter(|value| value.text != "3") {
            return Err(self.wrong(value.line, format!("space dimension {}; only 3 is supported", value.text)));
        }
        let Some(directions) = self.get("spacedirections") else {
            let Some(value) = self.get("spacings") else {
                return Frame::of_spacings([1.0; 3]).ok_or_else(|| self.wrong(1, "no frame"));
            };
            let frame = numbers(value.text).and_then(|spacings| {
                let positive = spacings.iter().all(|&x| x > 0.0);
                positive.then(|| Frame::of_spacings(spacings)).flatten()
            });
            return frame.ok_or_else(|| {
                self.wrong(value.line, format!("spacings '{}'; give three positive numbers", value.text))
            });
        };
        let origin = match self.get("spaceorigin") {
            None => [0.0; 3],
            Some(value) => vectors::<1>(value.text).map(|[origin]| origin).ok_or_else(|| {
                self.wrong(value.line, format!("space origin '{}'; give a point (x,y,z)", value.text))
            })?,
        };
        let frame = vectors::<3>(directions.text).and_then(|axes| Frame::new(origin, axes));
        let message = "give three vectors (x,y,z) that span space, one an axis";
        frame.ok_or_else(|| self.wrong(directions.line, format!("space directions '{}'; {message}", directions.text)))
    }
}

/// Three numbers.
fn numbers(text: &str) -> Option<Vec3> {
    let numbers: Option<Vec<f64>> = text.split_whitespace().map(|x| x.parse().ok()).collect();
    numbers?.try_into().ok()
}

/// Vectors in parentheses, with commas within.
fn vectors<const N: usize>(text: &str) -> Option<[Vec3; N]> {
    let mut found = Vec::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        let (inside, behind) = rest.strip_prefix('(')?.split_once(')')?;
        found.push(numbers(&inside.replace(',', " "))?);
        rest = behind.trim_start();
    }
    found.try_into().ok()
}
