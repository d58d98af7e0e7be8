//! PLY, text and binary of both byte orders.
use super::super::sets::{self, Meaning};
use super::super::{Dataset, error};
use super::soup::Soup;
use crate::mesh::io::{Error, Read};
use std::path::Path;

/// A number's type.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// A property: one number, or a list with a number before it.
struct Property {
    name: String,
    list: Option<Kind>,
    kind: Kind,
}

struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

#[derive(Clone, Copy, PartialEq)]
enum Encoding {
    Text,
    Little,
    Big,
}

/// Reads vertices and faces, with the property `reference` of these; all else is gone over.
pub fn read(path: &Path, bytes: &[u8]) -> Result<Read<Dataset>, Error> {
    let Head { encoding, elements, noted, body } = head(path, bytes)?;
    let mut numbers = Numbers { path, encoding, rest: body };
    let mut soup = Soup::default();
    noted.into_iter().for_each(|noted| soup.call(noted.reference, noted.name));
    let (mut points, mut row, mut polygon) = (Vec::new(), Vec::new(), Vec::new());
    for element in &elements {
        let axis = |name: &str| element.properties.iter().position(|p| p.name == name && p.list.is_none());
        let axes = [axis("x"), axis("y"), axis("z")];
        let reference = axis("reference");
        for k in 0..element.count {
            let place = || format!("{} {}", element.name, k + 1);
            row.clear();
            polygon.clear();
            for property in &element.properties {
                let count = property.list.map(|kind| numbers.next(kind, &place)).transpose()?;
                let is_polygon = element.name == "face" && property.name.starts_with("vertex_ind");
                let mut left = count.unwrap_or(1.0);
                while left >= 1.0 {
                    let value = numbers.next(property.kind, &place)?;
                    if is_polygon {
                        let vertex = points.get(value as usize).filter(|_| value >= 0.0);
                        polygon.push(
                            *vertex.ok_or_else(|| error::at(path, place(), format!("there is no vertex {value}")))?,
                        );
                    } else if count.is_none() {
                        row.push(value);
                    }
                    left -= 1.0;
                }
                if count.is_some() {
                    row.push(0.0);
                }
            }
            if element.name == "face" {
                soup.polygon(&polygon, reference.map_or(1, |at| row[at] as i32));
            }
            if let ("vertex", [Some(x), Some(y), Some(z)]) = (&element.name[..], axes) {
                points.push(soup.vertex(path, place, [row[x], row[y], row[z]])?);
            }
        }
    }
    Ok(soup.finish(path))
}

/// The head.
struct Head<'a> {
    encoding: Encoding,
    elements: Vec<Element>,
    /// What comments of ours say of references.
    noted: Vec<Meaning>,
    /// The bytes after it.
    body: &'a [u8],
}

fn head<'a>(path: &Path, bytes: &'a [u8]) -> Result<Head<'a>, Error> {
    let (mut encoding, mut elements, mut rest) = (None, Vec::<Element>::new(), bytes);
    let mut noted = Vec::new();
    for number in 1.. {
        let wrong = |message: &str| error::at(path, format!("line {number}"), message);
        let end = rest.iter().take(4096).position(|&b| b == b'\n').ok_or_else(|| wrong("the head does not end"))?;
        let line = String::from_utf8_lossy(&rest[..end]).into_owned();
        rest = &rest[end + 1..];
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match words[..] {
            ["ply"] if number == 1 => {}
            _ if number == 1 => return Err(wrong("no PLY file: it begins with ply")),
            ["format", word, ..] => {
                encoding = Some(match word {
                    "ascii" => Encoding::Text,
                    "binary_little_endian" => Encoding::Little,
                    "binary_big_endian" => Encoding::Big,
                    _ => return Err(wrong("this format is not known")),
                });
            }
            ["element", name, count] => {
                let count = count.parse().map_err(|_| wrong("an element has a number"))?;
                elements.push(Element { name: name.into(), count, properties: Vec::new() });
            }
            ["property", "list", count, kind, name] => {
                let element = elements.last_mut().ok_or_else(|| wrong("a property of nothing"))?;
                let [list, kind] =
                    [count, kind].map(|word| kind_of(word).ok_or_else(|| wrong("this type is not known")));
                element.properties.push(Property { name: name.into(), list: Some(list?), kind: kind? });
            }
            ["property", kind, name] => {
                let element = elements.last_mut().ok_or_else(|| wrong("a property of nothing"))?;
                let kind = kind_of(kind).ok_or_else(|| wrong("this type is not known"))?;
                element.properties.push(Property { name: name.into(), list: None, kind });
            }
            ["comment", ..] => noted.extend(line.trim_start().strip_prefix("comment").and_then(Meaning::noted)),
            ["end_header"] => break,
            _ => {}
        }
    }
    let encoding = encoding.ok_or_else(|| error::at(path, "the head", "it says no format"))?;
    // An element without a property could be any number of times in no bytes at all.
    elements.retain(|element| !element.properties.is_empty());
    noted.retain(|noted| noted.kind == sets::Kind::Triangles);
    Ok(Head { encoding, elements, noted, body: rest })
}

fn kind_of(word: &str) -> Option<Kind> {
    Some(match word {
        "char" | "int8" => Kind::I8,
        "uchar" | "uint8" => Kind::U8,
        "short" | "int16" => Kind::I16,
        "ushort" | "uint16" => Kind::U16,
        "int" | "int32" => Kind::I32,
        "uint" | "uint32" => Kind::U32,
        "float" | "float32" => Kind::F32,
        "double" | "float64" => Kind::F64,
        _ => return None,
    })
}

/// The numbers after the head, one after the other.
struct Numbers<'a> {
    path: &'a Path,
    encoding: Encoding,
    rest: &'a [u8],
}

impl Numbers<'_> {
    fn next(&mut self, kind: Kind, place: &impl Fn() -> String) -> Result<f64, Error> {
        if self.encoding == Encoding::Text {
            return self.word(place);
        }
        let size = match kind {
            Kind::I8 | Kind::U8 => 1,
            Kind::I16 | Kind::U16 => 2,
            Kind::I32 | Kind::U32 | Kind::F32 => 4,
            Kind::F64 => 8,
        };
        let Some((bytes, rest)) = self.rest.split_at_checked(size) else { return Err(self.cut_off(place)) };
        self.rest = rest;
        // The bytes as a little-endian number of eight.
        let mut all = [0; 8];
        all[..size].copy_from_slice(bytes);
        if self.encoding == Encoding::Big {
            all[..size].reverse();
        }
        let word = u64::from_le_bytes(all);
        Ok(match kind {
            Kind::I8 => f64::from(word as u8 as i8),
            Kind::U8 => f64::from(word as u8),
            Kind::I16 => f64::from(word as u16 as i16),
            Kind::U16 => f64::from(word as u16),
            Kind::I32 => f64::from(word as u32 as i32),
            Kind::U32 => f64::from(word as u32),
            Kind::F32 => f64::from(f32::from_bits(word as u32)),
            Kind::F64 => f64::from_bits(word),
        })
    }

    fn word(&mut self, place: &impl Fn() -> String) -> Result<f64, Error> {
        let text = self.rest.trim_ascii_start();
        let end = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
        if end == 0 {
            return Err(self.cut_off(place));
        }
        let word = String::from_utf8_lossy(&text[..end]);
        let value = word
            .parse()
            .map_err(|_| error::at(self.path, place(), format!("'{}' is no number", error::short(&word))))?;
        self.rest = &text[end..];
        Ok(value)
    }

    fn cut_off(&self, place: &impl Fn() -> String) -> Error {
        error::at(self.path, place(), "the file ends before it; is it cut off?")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "element vertex 3\nproperty float x\nproperty uchar red\nproperty double y\nproperty float z\n\
                        element face 1\nproperty list uchar int vertex_indices\nend_header\n";

    #[test]
    fn text_and_both_byte_orders_are_the_same_mesh() {
        let path = Path::new("a.ply");
        let text = format!("ply\nformat ascii 1.0\ncomment\n{HEAD}0 9 0.5 0\n1 9 0 0\n0 9 1 2\n3 0 1 2\n");
        let expected = read(path, text.as_bytes()).unwrap().content;
        assert_eq!(expected.mesh.vertices, [[0.0, 0.5, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 2.0]]);
        assert_eq!(expected.mesh.triangles.nodes, [[0, 1, 2]]);
        for big in [false, true] {
            let name = if big { "big" } else { "little" };
            let mut bytes = format!("ply\nformat binary_{name}_endian 1.0\n{HEAD}").into_bytes();
            let mut put = |mut number: Vec<u8>| {
                if big {
                    number.reverse();
                }
                bytes.extend(number);
            };
            for p in &expected.mesh.vertices {
                put((p[0] as f32).to_le_bytes().to_vec());
                put(vec![9]);
                put(p[1].to_le_bytes().to_vec());
                put((p[2] as f32).to_le_bytes().to_vec());
            }
            put(vec![3]);
            (0..3i32).for_each(|v| put(v.to_le_bytes().to_vec()));
            assert_eq!(read(path, &bytes).unwrap().content, expected);
            assert!(read(path, &bytes[..bytes.len() - 1]).unwrap_err().to_string().contains("face 1"));
        }
    }

    #[test]
    fn damaged_files_are_told() {
        let text = |body: &str| format!("ply\nformat ascii 1.0\n{HEAD}{body}");
        let whole = "0 9 0.5 0\n1 9 0 0\n0 9 1 2\n";
        for (content, word) in [
            (text(&format!("{whole}3 0 1 7\n")), "no vertex 7"),
            (text(&format!("{whole}3 0 1 -1\n")), "no vertex -1"),
            (text("0 9 q 0\n"), "'q'"),
            (text("0 9 nan 0\n"), "finite"),
            (text("0 9"), "cut off"),
            ("ply\nelement vertex 1\n".into(), "does not end"),
            ("ply\nelement vertex 99999999999\nend_header\n".into(), "no format"),
            ("plx\n".into(), "no PLY"),
            ("ply\nformat ascii 1.0\nelement vertex 18446744073709551615\nend_header\n".into(), ""),
        ] {
            let result = read(Path::new("a.ply"), content.as_bytes());
            assert!(word.is_empty() || result.unwrap_err().to_string().contains(word), "{content}");
        }
    }
}
