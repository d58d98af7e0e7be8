//! Writing a .vtu: appended raw data in blocks of zlib, or words.
use super::super::format::vtk::{LINE, QUADRILATERAL, TETRAHEDRON, TRIANGLE};
use super::super::stacks::number_of;
use super::super::text::Text;
use super::super::{Dataset, NamedField};
use super::{BY_KIND, REFERENCES, SYMMETRIC};
use crate::geometry::Names;
use crate::mesh::io::{Batch, Error, FieldKind};
use crate::tasks::Team;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use quick_xml::escape::escape;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

/// Bytes of a block before compression.
const BLOCK: usize = 1 << 18;

/// The values of an array.
enum Values<'a> {
    Real(Cow<'a, [f64]>),
    Int(Cow<'a, [i32]>),
    Long(Vec<i64>),
    Byte(Vec<u8>),
}

impl Values<'_> {
    fn kind(&self) -> &'static str {
        match self {
            Self::Real(_) => "Float64",
            Self::Int(_) => "Int32",
            Self::Long(_) => "Int64",
            Self::Byte(_) => "UInt8",
        }
    }

    fn bytes(&self) -> &[u8] {
        match self {
            Self::Real(values) => bytemuck::cast_slice(values),
            Self::Int(values) => bytemuck::cast_slice(values),
            Self::Long(values) => bytemuck::cast_slice(values),
            Self::Byte(values) => values,
        }
    }
}

/// An array.
struct Array<'a> {
    name: Cow<'a, str>,
    width: usize,
    values: Values<'a>,
}

/// What encloses arrays.
struct Section<'a> {
    tag: &'static str,
    arrays: Vec<Array<'a>>,
}

/// Writes a grid.
pub(in super::super) fn write(
    batch: &mut Batch,
    team: Team<'_>,
    path: &Path,
    data: &Dataset,
    as_text: bool,
) -> Result<Vec<String>, Error> {
    let sections = sections(data);
    if as_text {
        batch.add_main(path, |to| text(to, data, &sections))?;
    } else {
        let stored = stored(team, &sections);
        batch.add_main(path, |to| appended(to, data, &sections, &stored))?;
    }
    Ok(Vec::new())
}

/// Writes a piece of a grid, which belongs to a file of its own.
pub(super) fn write_piece(batch: &mut Batch, team: Team<'_>, path: &Path, data: &Dataset) -> Result<(), Error> {
    let sections = sections(data);
    let stored = stored(team, &sections);
    batch.add(path, |to| appended(to, data, &sections, &stored))
}

/// What a grid of several pieces says of the arrays that each of them has, those of this one.
pub(super) fn shared_arrays(data: &Dataset) -> String {
    let mut text = String::new();
    for Section { tag, arrays } in sections(data).iter().filter(|section| section.tag != "Cells") {
        let arrays = arrays.iter().map(|array| format!("{}/>\n", declared("PDataArray", array)));
        text.push_str(&format!("<P{tag}>\n{}</P{tag}>\n", arrays.collect::<String>()));
    }
    text
}

fn stored(team: Team<'_>, sections: &[Section]) -> Vec<Vec<u8>> {
    let arrays = sections.iter().flat_map(|section| &section.arrays);
    arrays.map(|array| deflated(team, array.values.bytes())).collect()
}

fn sections(data: &Dataset) -> Vec<Section<'_>> {
    let mesh = &data.mesh;
    let named = |name: &'static str, width, values| Array { name: name.into(), width, values };
    let mut at_points: Vec<Array> = data.fields.iter().map(field).collect();
    if mesh.vertex_refs.iter().any(|&reference| reference != 0) {
        at_points.push(named(REFERENCES[0], 1, Values::Int((&mesh.vertex_refs).into())));
    }
    let mut cells = vec![named(REFERENCES[0], 1, Values::Int(references(data).concat().into()))];
    cells.extend(BY_KIND.into_iter().zip(by_kind(data)).map(|(name, refs)| named(name, 1, Values::Int(refs.into()))));
    let points = vec![named("Points", 3, Values::Real(mesh.vertices.as_flattened().into()))];
    vec![
        Section { tag: "PointData", arrays: at_points },
        Section { tag: "CellData", arrays: cells },
        Section { tag: "Points", arrays: points },
        Section { tag: "Cells", arrays: topology(data) },
    ]
}

/// The references of cells in space, on surfaces and along curves, each in the order of the file.
fn references(Dataset { mesh, stack, .. }: &Dataset) -> [Vec<i32>; 3] {
    let cells = mesh.tets.refs.iter().copied().chain(stack.cells.iter().map(|cell| cell.reference));
    let faces = mesh.triangles.refs.iter().chain(&stack.quads.refs).copied();
    [cells.collect(), faces.collect(), mesh.edges.refs.clone()]
}

/// The references of each kind of cells, 0 for the other cells.
pub(in super::super) fn by_kind(data: &Dataset) -> [Vec<i32>; 3] {
    let kinds = references(data);
    [0, 1, 2].map(|kind| {
        let of = |(at, refs): (usize, &Vec<i32>)| if at == kind { refs.clone() } else { vec![0; refs.len()] };
        kinds.iter().enumerate().flat_map(of).collect()
    })
}

fn field(field: &NamedField) -> Array<'_> {
    Array { name: field.name.as_str().into(), width: field.kind.values(), values: Values::Real(to_vtk(field)) }
}

/// The values of a field in VTK's order.
pub(in super::super) fn to_vtk(field: &NamedField) -> Cow<'_, [f64]> {
    match field.kind {
        FieldKind::SymmetricTensor => {
            let mut values = vec![0.0; field.values.len()];
            for (to, from) in values.as_chunks_mut::<6>().0.iter_mut().zip(field.values.as_chunks::<6>().0) {
                for (ours, &vtks) in SYMMETRIC.iter().enumerate() {
                    to[vtks] = from[ours];
                }
            }
            values.into()
        }
        _ => (&field.values).into(),
    }
}

/// Nodes of the cells, their ends among these, their types.
fn topology(Dataset { mesh, stack, .. }: &Dataset) -> Vec<Array<'static>> {
    let nodes = || {
        let tets = mesh.tets.nodes.as_flattened().iter();
        let cells = stack.cells.iter().flat_map(|cell| cell.nodes());
        let faces = mesh.triangles.nodes.as_flattened().iter().chain(stack.quads.nodes.as_flattened());
        tets.chain(cells).chain(faces).chain(mesh.edges.nodes.as_flattened()).copied()
    };
    let kinds = || {
        let of = |(count, width, kind): (usize, i64, i64)| std::iter::repeat_n((width, kind), count);
        let cells = stack.cells.iter().map(|cell| (cell.kind.corners() as i64, number_of(cell.kind)));
        let behind =
            [(mesh.triangles.len(), 3, TRIANGLE), (stack.quads.len(), 4, QUADRILATERAL), (mesh.edges.len(), 2, LINE)];
        of((mesh.tets.len(), 4, TETRAHEDRON)).chain(cells).chain(behind.into_iter().flat_map(of))
    };
    let ends = || {
        kinds().scan(0, |end, (width, _)| {
            *end += width;
            Some(*end)
        })
    };
    let total: usize = kinds().map(|(width, _)| width as usize).sum();
    // Half as long where it does.
    let (nodes, ends) = if total.max(mesh.vertices.len()) <= i32::MAX as usize {
        (Values::Int(nodes().map(|v| v as i32).collect()), Values::Int(ends().map(|end: i64| end as i32).collect()))
    } else {
        (Values::Long(nodes().map(i64::from).collect()), Values::Long(ends().collect()))
    };
    let types = kinds().map(|(_, kind)| kind as u8).collect();
    let array = |name: &'static str, values| Array { name: name.into(), width: 1, values };
    vec![array("connectivity", nodes), array("offsets", ends), array("types", Values::Byte(types))]
}

/// Blocks of zlib behind their header.
fn deflated(team: Team<'_>, bytes: &[u8]) -> Vec<u8> {
    let blocks = team.chunks(BLOCK, bytes.len(), |range| {
        let mut encoder = ZlibEncoder::new(Vec::with_capacity(range.len() / 2), Compression::fast());
        encoder.write_all(&bytes[range]).and_then(|()| encoder.finish()).expect("writing to memory")
    });
    let last = bytes.len() % BLOCK;
    let header = [blocks.len(), BLOCK, last].into_iter().chain(blocks.iter().map(Vec::len));
    let mut stored: Vec<u8> = header.flat_map(|number| (number as u64).to_ne_bytes()).collect();
    blocks.iter().for_each(|block| stored.extend_from_slice(block));
    stored
}

/// What precedes the piece.
/// The order of bytes.
pub(super) fn order() -> &'static str {
    if cfg!(target_endian = "big") { "BigEndian" } else { "LittleEndian" }
}

fn head(data: &Dataset, compressor: &str) -> String {
    let order = order();
    let (mesh, stack) = (&data.mesh, &data.stack);
    let faces = mesh.triangles.len() + stack.quads.len();
    let (points, cells) = (mesh.vertices.len(), mesh.tets.len() + stack.cells.len() + faces + mesh.edges.len());
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"{order}\" header_type=\"UInt64\"{compressor}>\n\
         <UnstructuredGrid>\n{}<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">\n",
        names(&data.names)
    )
}

/// The names of references, each with those that have it: reference and dimension.
pub(in super::super) fn by_name(names: &Names) -> BTreeMap<&str, Vec<[i32; 2]>> {
    let mut pairs: BTreeMap<&str, Vec<[i32; 2]>> = BTreeMap::new();
    for (labels, dimension) in [(&names.edges, 1), (&names.triangles, 2), (&names.tetrahedra, 3)] {
        for (reference, label) in labels {
            if let Some(name) = label.name.as_deref().filter(|name| !name.is_empty()) {
                pairs.entry(name).or_default().push([*reference, dimension]);
            }
        }
    }
    pairs
}

/// The names of references as field data.
fn names(names: &Names) -> String {
    let pairs = by_name(names);
    if pairs.is_empty() {
        return String::new();
    }
    let array = |(name, pairs): (&str, &Vec<[i32; 2]>)| {
        let text: Vec<String> = pairs.iter().map(|[reference, dimension]| format!("{reference} {dimension}")).collect();
        let (name, count, pairs) = (attribute(name), pairs.len(), text.join(" "));
        format!(
            "<DataArray type=\"Int32\" Name=\"{name}\" NumberOfComponents=\"2\" NumberOfTuples=\"{count}\" format=\"ascii\">{pairs}</DataArray>\n"
        )
    };
    let arrays: String = pairs.iter().map(|(name, pairs)| array((name, pairs))).collect();
    format!("<FieldData>\n{arrays}</FieldData>\n")
}

/// A text as an attribute has it; control characters cannot stand in XML.
fn attribute(text: &str) -> String {
    escape(text.replace(|c: char| c.is_control(), "_")).into_owned()
}

/// An array's element up to `format=`.
fn opening(array: &Array) -> String {
    format!("{} format=", declared("DataArray", array))
}

/// What an array is.
fn declared(tag: &str, array: &Array) -> String {
    let (kind, name, width) = (array.values.kind(), attribute(&array.name), array.width);
    format!("<{tag} type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{width}\"")
}

fn appended(to: &mut dyn Write, data: &Dataset, sections: &[Section], stored: &[Vec<u8>]) -> io::Result<()> {
    to.write_all(head(data, " compressor=\"vtkZLibDataCompressor\"").as_bytes())?;
    let (mut offset, mut sizes) = (0, stored.iter().map(Vec::len));
    for section in sections {
        writeln!(to, "<{}>", section.tag)?;
        for array in &section.arrays {
            writeln!(to, "{}\"appended\" offset=\"{offset}\"/>", opening(array))?;
            offset += sizes.next().unwrap_or(0);
        }
        writeln!(to, "</{}>", section.tag)?;
    }
    to.write_all(b"</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_")?;
    stored.iter().try_for_each(|bytes| to.write_all(bytes))?;
    to.write_all(b"\n</AppendedData>\n</VTKFile>\n")
}

fn text(to: &mut dyn Write, data: &Dataset, sections: &[Section]) -> io::Result<()> {
    let mut text = Text::new(to);
    text.put(format_args!("{}", head(data, "")));
    for section in sections {
        text.put(format_args!("<{}>\n", section.tag));
        for array in &section.arrays {
            text.put(format_args!("{}\"ascii\">\n", opening(array)));
            let width = if array.width > 1 { array.width } else { 12 };
            let mut left = width;
            let mut row = |text: &mut Text, value: &dyn Fn(&mut Text)| {
                value(text);
                left -= 1;
                if left == 0 {
                    left = width;
                    return text.end_line();
                }
                Ok(())
            };
            match &array.values {
                Values::Real(values) => {
                    values.iter().try_for_each(|&value| row(&mut text, &|text| text.real(value)))?
                }
                Values::Int(values) => values.iter().try_for_each(|&value| row(&mut text, &|text| text.int(value)))?,
                Values::Long(values) => values.iter().try_for_each(|&value| row(&mut text, &|text| text.int(value)))?,
                Values::Byte(values) => values.iter().try_for_each(|&value| row(&mut text, &|text| text.int(value)))?,
            }
            text.put(format_args!("\n</DataArray>\n"));
        }
        text.put(format_args!("</{}>\n", section.tag));
    }
    text.put(format_args!("</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"));
    text.finish()
}
