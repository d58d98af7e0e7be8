//! The voxels: raw, compressed or as text.
use super::header::Header;
use super::{Encoding, Kind, content};
use crate::mesh::io::{Error, read_file};
use flate2::read::MultiGzDecoder;
use std::io::Read;
use std::path::Path;

/// A voxel's value.
#[inline]
pub fn value(bytes: &[u8], kind: Kind, voxel: usize) -> f64 {
    fn at<const N: usize>(bytes: &[u8], voxel: usize) -> [u8; N] {
        std::array::from_fn(|i| bytes[voxel * N + i])
    }
    match kind {
        Kind::Int8 => f64::from(bytes[voxel] as i8),
        Kind::Uint8 => f64::from(bytes[voxel]),
        Kind::Int16 => f64::from(i16::from_le_bytes(at(bytes, voxel))),
        Kind::Uint16 => f64::from(u16::from_le_bytes(at(bytes, voxel))),
        Kind::Int32 => f64::from(i32::from_le_bytes(at(bytes, voxel))),
        Kind::Uint32 => f64::from(u32::from_le_bytes(at(bytes, voxel))),
        Kind::Float => f64::from(f32::from_le_bytes(at(bytes, voxel))),
        Kind::Double => f64::from_le_bytes(at(bytes, voxel)),
    }
}

/// Appends a value, rounded to what the kind holds.
pub fn push(bytes: &mut Vec<u8>, kind: Kind, value: f64) {
    match kind {
        Kind::Int8 => bytes.extend((value as i8).to_le_bytes()),
        Kind::Uint8 => bytes.push(value as u8),
        Kind::Int16 => bytes.extend((value as i16).to_le_bytes()),
        Kind::Uint16 => bytes.extend((value as u16).to_le_bytes()),
        Kind::Int32 => bytes.extend((value as i32).to_le_bytes()),
        Kind::Uint32 => bytes.extend((value as u32).to_le_bytes()),
        Kind::Float => bytes.extend((value as f32).to_le_bytes()),
        Kind::Double => bytes.extend(value.to_le_bytes()),
    }
}

/// The voxels, least significant byte first; `behind` is what follows the header in its own file.
pub fn read(path: &Path, header: &Header, behind: &[u8]) -> Result<Vec<u8>, Error> {
    let Some(other) = &header.data_file else { return decode(path, "behind the header", header, behind) };
    let file = read_file(other)?;
    decode(other, "voxels", header, &file)
}

/// What a byte of deflate can hold at most.
const DEFLATE: usize = 1032;

fn decode(path: &Path, place: &str, header: &Header, file: &[u8]) -> Result<Vec<u8>, Error> {
    let voxels: usize = header.sizes.iter().product();
    let needed = voxels * header.kind.size();
    let file = skip_lines(file, header.line_skip)
        .ok_or_else(|| content(path, place, format!("ends before the {} lines of 'line skip'", header.line_skip)))?;
    let short = |found: usize| {
        let [x, y, z] = header.sizes;
        let message =
            format!("ends after {found} of {needed} bytes that the sizes {x} {y} {z} ask for; is the file cut?");
        content(path, place, message)
    };
    let mut bytes = match header.encoding {
        Encoding::Text => return text(path, place, header, voxels, file),
        Encoding::Raw => {
            let skip = header.byte_skip.unwrap_or(file.len().saturating_sub(needed));
            let found = file.get(skip..).unwrap_or_default();
            found.get(..needed).ok_or_else(|| short(found.len()))?.to_vec()
        }
        Encoding::Gzip => {
            let skip = header.byte_skip.unwrap_or(0);
            if needed / DEFLATE > file.len() {
                return Err(content(
                    path,
                    place,
                    format!(
                        "has {} bytes, which cannot hold the {needed} that the sizes ask for; is the file cut?",
                        file.len()
                    ),
                ));
            }
            let mut bytes = Vec::new();
            let mut decoder = MultiGzDecoder::new(file).take(needed.saturating_add(skip) as u64);
            decoder.read_to_end(&mut bytes).map_err(|error| {
                content(
                    path,
                    place,
                    format!("is not whole gzip ({error}) after {} of {needed} bytes; is the file cut?", bytes.len()),
                )
            })?;
            let found = bytes.len().saturating_sub(skip);
            bytes.drain(..skip.min(bytes.len()));
            if found < needed {
                return Err(short(found));
            }
            bytes
        }
    };
    if header.big_endian {
        bytes.chunks_exact_mut(header.kind.size()).for_each(<[u8]>::reverse);
    }
    Ok(bytes)
}

fn skip_lines(mut file: &[u8], lines: usize) -> Option<&[u8]> {
    for _ in 0..lines {
        let end = file.iter().position(|&byte| byte == b'\n')?;
        file = &file[end + 1..];
    }
    Some(file)
}

fn text(path: &Path, place: &str, header: &Header, voxels: usize, file: &[u8]) -> Result<Vec<u8>, Error> {
    let file = file.get(header.byte_skip.unwrap_or(0)..).unwrap_or_default();
    let mut bytes = Vec::new();
    let mut found = 0;
    let words = file.split(|byte| byte.is_ascii_whitespace() || *byte == b',').filter(|word| !word.is_empty());
    for word in words {
        let word = std::str::from_utf8(word).unwrap_or("(no text)");
        let value: Option<f64> = word.parse().ok().filter(|&value| holds(header.kind, value));
        let value = value.ok_or_else(|| {
            let kind = header.kind.names()[0];
            content(path, place, format!("value {} is '{word}', which is no {kind}; correct it or the type", found + 1))
        })?;
        push(&mut bytes, header.kind, value);
        found += 1;
        if found > voxels {
            return Err(content(
                path,
                place,
                format!("has more than the {voxels} values that the sizes ask for; correct one"),
            ));
        }
    }
    if found < voxels {
        return Err(content(path, place, format!("ends after {found} of {voxels} values; is the file cut?")));
    }
    Ok(bytes)
}

/// Whether the kind can hold the value (floating point: rounded).
fn holds(kind: Kind, number: f64) -> bool {
    let mut bytes = Vec::with_capacity(8);
    push(&mut bytes, kind, number);
    !kind.is_integer() || value(&bytes, kind, 0) == number
}
