//! SU2's restarts: a row of numbers a point, as a text (.csv, and tables of older versions) or binary (.dat). Source: su2code.github.io,
//! "Restart File", and what SU2 8 writes. A binary file has five integers (a magic number, fields, points, two more), the names in 33
//! characters each, the rows, and perhaps numbers about the run.
mod table;

use super::text::Text;
use super::{Dataset, NamedField, error};
use crate::mesh::io::{Batch, Error, FieldKind, Read};
use crate::mesh::vector::{Vec3, distance};
use std::path::Path;
use table::Table;

/// The number that begins a binary file.
const MAGIC: i32 = 535_532;

/// Characters of a name in a binary file, the last of them 0.
const NAME: usize = 33;

/// The names of the columns of a point's number and coordinates.
const POINT: &str = "PointID";
const PLACE: [&str; 3] = ["x", "y", "z"];

/// How far the coordinates of a restart may be from the mesh's, of the diagonal of its box: texts have few digits.
const NEAR: f64 = 1e-5;

/// Reads fields onto these vertices; columns x, y and z must be theirs.
pub(super) fn read(path: &Path, bytes: &[u8], vertices: &[Vec3]) -> Result<Read<Vec<NamedField>>, Error> {
    let mut notices = Vec::new();
    let table = table::read(path, bytes, vertices.len(), &mut notices)?;
    let rows = order(path, &table, vertices.len())?;
    check_place(path, &table, &rows, vertices)?;
    Ok(Read { content: fields(&table, &rows), notices })
}

/// The row of each vertex: the one with its number, where the table has such a column.
fn order(path: &Path, table: &Table, vertices: usize) -> Result<Vec<u32>, Error> {
    let Some(column) = table.names.iter().position(|name| name.eq_ignore_ascii_case(POINT) || name == "Point_ID")
    else {
        return Ok((0..vertices as u32).collect());
    };
    let mut rows = vec![u32::MAX; vertices];
    for (row, values) in table.values.chunks_exact(table.names.len()).enumerate() {
        let id = values[column];
        let place = || format!("row {} of {vertices}", row + 1);
        let is_vertex = id >= 0.0 && id < vertices as f64 && id.fract() == 0.0;
        if !is_vertex || rows[id as usize] != u32::MAX {
            let message = format!("{POINT} {id} is no vertex, or comes twice; the vertices count from 0");
            return Err(error::at(path, place(), message));
        }
        rows[id as usize] = row as u32;
    }
    Ok(rows)
}

/// Refuses the file of another mesh.
fn check_place(path: &Path, table: &Table, rows: &[u32], vertices: &[Vec3]) -> Result<(), Error> {
    let width = table.names.len();
    let columns = PLACE.map(|name| table.names.iter().position(|other| other.eq_ignore_ascii_case(name)));
    let [Some(x), Some(y), Some(z)] = columns else { return Ok(()) };
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for point in vertices {
        for i in 0..3 {
            (low[i], high[i]) = (low[i].min(point[i]), high[i].max(point[i]));
        }
    }
    let near = NEAR * distance(low, high);
    for (vertex, (&row, &point)) in rows.iter().zip(vertices).enumerate() {
        let values = &table.values[row as usize * width..][..width];
        let there = [values[x], values[y], values[z]];
        let far = distance(there, point);
        if far > near || far.is_nan() {
            let message = format!(
                "vertex {vertex} (from 0) is at {there:?} there and at {point:?} in the mesh; give the file of this mesh"
            );
            return Err(error::at(path, format!("row {}", row + 1), message));
        }
    }
    Ok(())
}

/// How the columns of a field of a kind end.
pub(super) fn endings(kind: FieldKind) -> &'static [&'static str] {
    match kind {
        FieldKind::Scalar => &[""],
        FieldKind::Vector => &["_x", "_y", "_z"],
        FieldKind::SymmetricTensor => &["_xx", "_xy", "_yy", "_xz", "_yz", "_zz"],
        FieldKind::Tensor => &["_xx", "_xy", "_xz", "_yx", "_yy", "_yz", "_zx", "_zy", "_zz"],
    }
}

/// The columns as fields; neighbours that end as the components of a tensor or vector do are one.
fn fields(table: &Table, rows: &[u32]) -> Vec<NamedField> {
    let width = table.names.len();
    let others = [POINT, "Point_ID"].into_iter().chain(PLACE);
    let is_place = |name: &str| others.clone().any(|other| name.eq_ignore_ascii_case(other));
    let mut fields = Vec::new();
    let mut column = 0;
    while column < width {
        if is_place(&table.names[column]) {
            column += 1;
            continue;
        }
        let kinds = [FieldKind::Tensor, FieldKind::SymmetricTensor, FieldKind::Vector, FieldKind::Scalar];
        let found = kinds.into_iter().find_map(|kind| {
            let ends = endings(kind);
            let names = table.names.get(column..column + ends.len())?;
            let stem = names[0].strip_suffix(ends[0])?;
            let fits = names.iter().zip(ends).all(|(name, end)| name.strip_suffix(end) == Some(stem));
            fits.then(|| (kind, stem.to_owned()))
        });
        let (kind, name) = found.unwrap_or((FieldKind::Scalar, table.names[column].clone()));
        let values = rows.iter().flat_map(|&row| &table.values[row as usize * width + column..][..kind.values()]);
        fields.push(NamedField { name, kind, values: values.copied().collect() });
        column += kind.values();
    }
    fields
}

/// What the columns are called.
fn names(data: &Dataset) -> Vec<String> {
    let of = |field: &NamedField| {
        endings(field.kind).iter().map(move |end| format!("{}{end}", field.name)).collect::<Vec<_>>()
    };
    PLACE.map(String::from).into_iter().chain(data.fields.iter().flat_map(of)).collect()
}

/// The values of a row.
fn row(data: &Dataset, vertex: usize) -> impl Iterator<Item = f64> + '_ {
    let of = move |field: &'_ NamedField| {
        let width = field.kind.values();
        vertex * width..(vertex + 1) * width
    };
    let fields = data.fields.iter().flat_map(move |field| field.values[of(field)].iter().copied());
    data.mesh.vertices[vertex].into_iter().chain(fields)
}

/// Refuses a dataset without fields.
fn check_fields(path: &Path, data: &Dataset) -> Result<(), Error> {
    if data.fields.is_empty() {
        return Err(error::at(path, "fields", "there is no field to write; give some by --fields"));
    }
    Ok(())
}

/// Writes a text.
pub(super) fn write_text(batch: &mut Batch, path: &Path, data: &Dataset) -> Result<Vec<String>, Error> {
    check_fields(path, data)?;
    batch.add(path, |to| {
        let mut text = Text::new(to);
        text.put(format_args!("\"{POINT}\""));
        names(data)
            .iter()
            .for_each(|name| text.put(format_args!(",\"{}\"", name.replace(['"', ',', '\t', ';', '\n'], "_"))));
        text.end_line()?;
        for vertex in 0..data.mesh.vertices.len() {
            text.put(format_args!("{vertex}"));
            row(data, vertex).for_each(|value| text.put(format_args!(",{value:?}")));
            text.end_line()?;
        }
        text.finish()
    })?;
    Ok(Vec::new())
}

/// Writes a binary file.
pub(super) fn write_binary(batch: &mut Batch, path: &Path, data: &Dataset) -> Result<Vec<String>, Error> {
    check_fields(path, data)?;
    let names = names(data);
    if let Some(long) = names.iter().find(|name| name.len() >= NAME) {
        let message = format!(
            "the name has {} bytes, and there is room for {}; write .csv, or name it shorter",
            long.len(),
            NAME - 1
        );
        return Err(error::at(path, format!("field {long}"), message));
    }
    let (columns, rows) = (names.len(), data.mesh.vertices.len());
    let Ok(rows) = i32::try_from(rows) else {
        return Err(error::at(path, "header", format!("{rows} points do not fit 32 bits; write .csv")));
    };
    batch.add(path, |to| {
        let mut bytes = Vec::with_capacity(1 << 17);
        [MAGIC, columns as i32, rows, 0, 0].iter().for_each(|int| bytes.extend(int.to_le_bytes()));
        for name in &names {
            let end = bytes.len() + NAME;
            bytes.extend(name.as_bytes());
            bytes.resize(end, 0);
        }
        for vertex in 0..data.mesh.vertices.len() {
            row(data, vertex).for_each(|value| bytes.extend(value.to_le_bytes()));
            if bytes.len() > 1 << 16 {
                to.write_all(&bytes)?;
                bytes.clear();
            }
        }
        to.write_all(&bytes)
    })?;
    Ok(Vec::new())
}
