//! Writing a legacy file, version 3.0: any VTK, ParaView and meshio read it.
use super::super::format::vtk::{LINE, TETRAHEDRON, TRIANGLE};
use super::super::text::Text;
use super::super::vtu::{BY_KIND, REFERENCES, by_kind, by_name, to_vtk};
use super::super::{Dataset, error};
use super::values::encoded;
use crate::mesh::io::{Batch, Error};
use std::io::{self, Write};
use std::path::Path;

/// A text, or numbers with the most significant byte first.
struct Out<'a> {
    text: Text<'a>,
    is_text: bool,
}

impl Out<'_> {
    fn int(&mut self, value: i32) {
        if self.is_text { self.text.int(value) } else { self.text.raw(&value.to_be_bytes()) }
    }

    fn real(&mut self, value: f64) {
        if self.is_text { self.text.real(value) } else { self.text.raw(&value.to_be_bytes()) }
    }

    fn end_row(&mut self) -> io::Result<()> {
        if self.is_text { self.text.end_line() } else { self.text.hand_on() }
    }

    /// Ends a section.
    fn end(&mut self) -> io::Result<()> {
        if !self.is_text {
            self.text.raw(b"\n");
        }
        self.text.hand_on()
    }

    fn reals(&mut self, values: &[f64], width: usize) -> io::Result<()> {
        for row in values.chunks(width.max(1)) {
            row.iter().for_each(|&value| self.real(value));
            self.end_row()?;
        }
        self.end()
    }

    fn ints(&mut self, values: impl IntoIterator<Item = i32>) -> io::Result<()> {
        for value in values {
            self.int(value);
            self.end_row()?;
        }
        self.end()
    }
}

/// Writes a grid.
pub(in super::super) fn write(
    batch: &mut Batch,
    path: &Path,
    data: &Dataset,
    is_text: bool,
) -> Result<Vec<String>, Error> {
    let mesh = &data.mesh;
    let total = 5 * mesh.tets.len() + 4 * mesh.triangles.len() + 3 * mesh.edges.len();
    if total.max(mesh.vertices.len()) > i32::MAX as usize {
        return Err(error::at(path, "CELLS", "their numbers do not fit 32 bits; write .vtu"));
    }
    batch.add_main(path, |to| emit(Out { text: Text::new(to as &mut dyn Write), is_text }, data, total))?;
    Ok(Vec::new())
}

fn emit(mut out: Out, data: &Dataset, total: usize) -> io::Result<()> {
    let mesh = &data.mesh;
    let cells = mesh.tets.len() + mesh.triangles.len() + mesh.edges.len();
    let mode = if out.is_text { "ASCII" } else { "BINARY" };
    out.text.put(format_args!("# vtk DataFile Version 3.0\ngeo-adapt\n{mode}\nDATASET UNSTRUCTURED_GRID\n"));
    names(&mut out, data)?;
    out.text.put(format_args!("POINTS {} double\n", mesh.vertices.len()));
    out.reals(mesh.vertices.as_flattened(), 3)?;
    out.text.put(format_args!("CELLS {cells} {total}\n"));
    nodes(&mut out, &mesh.tets.nodes)?;
    nodes(&mut out, &mesh.triangles.nodes)?;
    nodes(&mut out, &mesh.edges.nodes)?;
    out.end()?;
    out.text.put(format_args!("CELL_TYPES {cells}\n"));
    let counts = [(TETRAHEDRON, mesh.tets.len()), (TRIANGLE, mesh.triangles.len()), (LINE, mesh.edges.len())];
    out.ints(counts.into_iter().flat_map(|(kind, count)| std::iter::repeat_n(kind as i32, count)))?;
    if cells > 0 {
        out.text.put(format_args!("CELL_DATA {cells}\n"));
        references(&mut out, data, cells)?;
    }
    at_points(&mut out, data)?;
    out.text.finish()
}

fn nodes<const N: usize>(out: &mut Out, elements: &[[u32; N]]) -> io::Result<()> {
    for nodes in elements {
        out.int(N as i32);
        nodes.iter().for_each(|&node| out.int(node as i32));
        out.end_row()?;
    }
    Ok(())
}

/// The names of references: pairs of reference and dimension.
fn names(out: &mut Out, data: &Dataset) -> io::Result<()> {
    let arrays = by_name(&data.names);
    if arrays.is_empty() {
        return Ok(());
    }
    out.text.put(format_args!("FIELD FieldData {}\n", arrays.len()));
    for (name, pairs) in arrays {
        out.text.put(format_args!("{} 2 {} int\n", encoded(name), pairs.len()));
        out.ints(pairs.into_iter().flatten())?;
    }
    Ok(())
}

/// The references of all cells, and of each kind of them.
fn references(out: &mut Out, data: &Dataset, cells: usize) -> io::Result<()> {
    let mesh = &data.mesh;
    let all = [&mesh.tets.refs, &mesh.triangles.refs, &mesh.edges.refs].into_iter().flatten().copied().collect();
    out.text.put(format_args!("FIELD FieldData {}\n", 1 + BY_KIND.len()));
    for (name, values) in [(REFERENCES[0], all)].into_iter().chain(BY_KIND.into_iter().zip(by_kind(data))) {
        out.text.put(format_args!("{name} 1 {cells} int\n"));
        out.ints(values)?;
    }
    Ok(())
}

/// References of vertices, and the fields.
fn at_points(out: &mut Out, data: &Dataset) -> io::Result<()> {
    let (mesh, vertices) = (&data.mesh, data.mesh.vertices.len());
    let has_refs = mesh.vertex_refs.iter().any(|&reference| reference != 0);
    let count = data.fields.len() + usize::from(has_refs);
    if count == 0 {
        return Ok(());
    }
    out.text.put(format_args!("POINT_DATA {vertices}\nFIELD FieldData {count}\n"));
    for field in &data.fields {
        let width = field.kind.values();
        out.text.put(format_args!("{} {width} {vertices} double\n", encoded(&field.name)));
        out.reals(&to_vtk(field), width)?;
    }
    if has_refs {
        out.text.put(format_args!("{} 1 {vertices} int\n", REFERENCES[0]));
        out.ints(mesh.vertex_refs.iter().copied())?;
    }
    Ok(())
}
