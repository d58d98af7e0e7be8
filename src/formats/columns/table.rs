//! The rows of a restart as they stand in the file: binary or text.
use super::super::error;
use super::super::scan::{Scan, real_or_nan};
use super::{MAGIC, NAME};
use crate::mesh::io::Error;
use std::path::Path;

/// A table: names of the columns, and the rows one after the other.
pub(super) struct Table {
    pub names: Vec<String>,
    pub values: Vec<f64>,
}

/// Reads so many rows.
pub(super) fn read(path: &Path, bytes: &[u8], points: usize, notices: &mut Vec<String>) -> Result<Table, Error> {
    match Endian::of(bytes) {
        Some(endian) => binary(path, bytes, endian, points, notices),
        None => text(path, bytes, points),
    }
}

/// The order of a binary file's bytes.
#[derive(Clone, Copy)]
enum Endian {
    Little,
    Big,
}

impl Endian {
    fn of(bytes: &[u8]) -> Option<Self> {
        let first = *bytes.first_chunk::<4>()?;
        match MAGIC {
            magic if magic == i32::from_le_bytes(first) => Some(Self::Little),
            magic if magic == i32::from_be_bytes(first) => Some(Self::Big),
            _ => None,
        }
    }

    fn int(self, bytes: [u8; 4]) -> i32 {
        match self {
            Self::Little => i32::from_le_bytes(bytes),
            Self::Big => i32::from_be_bytes(bytes),
        }
    }

    fn real(self, bytes: [u8; 8]) -> f64 {
        match self {
            Self::Little => f64::from_le_bytes(bytes),
            Self::Big => f64::from_be_bytes(bytes),
        }
    }
}

fn binary(path: &Path, bytes: &[u8], endian: Endian, points: usize, notices: &mut Vec<String>) -> Result<Table, Error> {
    let header =
        bytes.get(..20).ok_or_else(|| error::at(path, "byte 4", "the header is cut off; write the file again"))?;
    let [_, columns, rows, ..] = header.as_chunks::<4>().0 else { unreachable!("twenty bytes are five integers") };
    let [columns, rows] = [endian.int(*columns), endian.int(*rows)];
    let wrong = |message: String| error::at(path, "header", message);
    let (Ok(columns), Ok(rows)) = (usize::try_from(columns), usize::try_from(rows)) else {
        return Err(wrong(format!("{columns} fields at {rows} points cannot be; write the file again")));
    };
    if rows != points {
        return Err(wrong(of_other(rows, points)));
    }
    let start = 20 + NAME * columns;
    let size = columns.saturating_mul(rows).saturating_mul(8);
    let Some(body) = bytes.get(start..).filter(|body| body.len() >= size && columns > 0) else {
        let message =
            format!("{columns} fields at {rows} points do not fit into {} bytes; the file was cut", bytes.len());
        return Err(wrong(message));
    };
    // Number of the iteration, angles and residuals: SU2 6 and 7 write them at the end.
    if body.len() > size + 128 {
        notices.push(format!("{}: {} bytes follow the fields and are not read", path.display(), body.len() - size));
    }
    let names = bytes[20..start].chunks(NAME).map(|name| {
        let name = name.split(|&byte| byte == 0).next().unwrap_or_default();
        String::from_utf8_lossy(name).trim().to_owned()
    });
    let values = body[..size].as_chunks::<8>().0.iter().map(|&value| endian.real(value));
    Ok(Table { names: names.collect(), values: values.collect() })
}

/// Names in quotes, separated by commas (or tabs in tables of older versions), then a line a point.
fn text(path: &Path, bytes: &[u8], points: usize) -> Result<Table, Error> {
    let mut scan = Scan::new(path, bytes);
    let is_separator = |byte: &u8| matches!(byte, b',' | b'\t' | b';');
    let head = scan.line().unwrap_or_default();
    let names: Vec<String> = head
        .split(is_separator)
        .map(|name| String::from_utf8_lossy(name).trim_matches(|c: char| c.is_whitespace() || c == '"').to_owned())
        .collect();
    if !names.iter().any(|name| name.starts_with(|c: char| c.is_alphabetic())) {
        return Err(scan.fail(
            "names of fields are expected, separated by commas, as SU2 writes them: \"PointID\",\"x\",\"y\",\"z\",…",
        ));
    }
    let mut values = Vec::with_capacity(scan.room(points.saturating_mul(names.len()), 2));
    let mut rows = 0;
    while let Some(line) = scan.line() {
        if line.is_empty() {
            continue;
        }
        let before = values.len();
        for word in line.split(is_separator) {
            let word = word.trim_ascii();
            values.push(real_or_nan(word).map_err(|message| scan.fail(message))?);
        }
        if values.len() - before != names.len() {
            let message = format!(
                "{} values; {} are expected, one for each name of the first line",
                values.len() - before,
                names.len()
            );
            return Err(scan.fail(message));
        }
        rows += 1;
        if rows > points {
            return Err(
                scan.fail(format!("more rows than the mesh has vertices ({points}); give the file of this mesh"))
            );
        }
    }
    if rows != points {
        return Err(error::at(path, "whole file", of_other(rows, points)));
    }
    Ok(Table { names, values })
}

fn of_other(rows: usize, points: usize) -> String {
    format!("values at {rows} points, and the mesh has {points} vertices; give the file of this mesh")
}
