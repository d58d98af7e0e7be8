//! Writing XDMF: the arrays into an HDF5 file beside it, or as words.
use super::super::text::Text;
use super::super::vtu::{REFERENCES, by_name};
use super::super::{Dataset, NamedField, error};
use super::SYMMETRIC;
use crate::mesh::io::{Batch, Error, FieldKind};
use hdf5_pure::{FileBuilder, LibVer};
use quick_xml::escape::escape;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Numbers with the shape that they have.
struct Array {
    values: Values,
    rows: usize,
    width: usize,
}

enum Values {
    Real(Vec<f64>),
    Int(Vec<i64>),
}

impl Array {
    fn real(values: Vec<f64>, width: usize) -> Self {
        Self { rows: values.len() / width.max(1), values: Values::Real(values), width }
    }

    fn int(values: Vec<i64>, width: usize) -> Self {
        Self { rows: values.len() / width.max(1), values: Values::Int(values), width }
    }
}

/// Text, with arrays in it.
enum Part {
    Text(String),
    Array(Array),
}

/// Where the arrays go: a.h5 beside a.xdmf, and a.xmf.h5 beside a.xmf, so that neither of these two takes the other's.
pub(in super::super) fn heavy_path(path: &Path) -> PathBuf {
    let is_xmf = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("xmf"));
    path.with_extension(if is_xmf { "xmf.h5" } else { "h5" })
}

/// Writes a mesh: as one grid of mixed cells (`is_mixed`), or one a kind of cells.
pub(in super::super) fn write(
    batch: &mut Batch,
    path: &Path,
    data: &Dataset,
    is_mixed: bool,
    as_text: bool,
) -> Result<Vec<String>, Error> {
    let parts = if is_mixed { mixed(data) } else { by_kind(data) };
    if as_text {
        batch.add_main(path, |to| words(to, &parts))?;
        return Ok(Vec::new());
    }
    let heavy = heavy_path(path);
    let name = heavy.file_name().and_then(|name| name.to_str()).filter(|name| !name.contains(':'));
    let name = name
        .ok_or_else(|| error::at(path, "the name", "XDMF cannot name the file of the arrays; give it another name"))?;
    let stored = builder(&parts);
    batch.add(&heavy, |to| stored.finish_to(to).map_err(io::Error::other))?;
    batch.add_main(path, |to| light(to, &parts, name))?;
    Ok(vec![format!("the arrays are in {}", heavy.display())])
}

/// One grid for each kind of cells, all on the same points: as FEniCSx reads them.
fn by_kind(data: &Dataset) -> Vec<Part> {
    let mesh = &data.mesh;
    let kinds = [
        ("Tetrahedron", "regions", long(mesh.tets.nodes.as_flattened()), 4, &mesh.tets.refs),
        ("Triangle", "surface", long(mesh.triangles.nodes.as_flattened()), 3, &mesh.triangles.refs),
        ("PolyLine", "edges", long(mesh.edges.nodes.as_flattened()), 2, &mesh.edges.refs),
    ];
    let mut parts = vec![Part::Text(HEAD.into())];
    let mut is_first = true;
    for (kind, name, nodes, width, refs) in kinds {
        if refs.is_empty() {
            continue;
        }
        let name = if is_first { "mesh" } else { name };
        parts.push(Part::Text(format!("<Grid Name=\"{name}\" GridType=\"Uniform\">\n")));
        if !is_first {
            parts.push(Part::Text("<xi:include xpointer=\"xpointer(/Xdmf/Domain/Grid/Geometry)\"/>\n".into()));
        }
        let count = refs.len();
        let topology =
            format!("<Topology TopologyType=\"{kind}\" NumberOfElements=\"{count}\" NodesPerElement=\"{width}\">\n");
        enclosed(&mut parts, topology, Array::int(nodes, width), "Topology");
        if is_first {
            points(&mut parts, data);
        }
        attribute(&mut parts, if is_first { REFERENCES[0] } else { name }, "Scalar", "Cell", Array::int(wide(refs), 1));
        if is_first {
            at_points(&mut parts, data);
        }
        parts.push(Part::Text("</Grid>\n".into()));
        is_first = false;
    }
    parts.push(Part::Text(TAIL.into()));
    parts
}

/// One grid of all cells, the kind of each before its nodes: as meshio reads them.
fn mixed(data: &Dataset) -> Vec<Part> {
    let mesh = &data.mesh;
    let mut cells = Vec::new();
    mesh.tets.nodes.iter().for_each(|nodes| {
        cells.push(6);
        cells.extend(nodes.map(i64::from));
    });
    mesh.triangles.nodes.iter().for_each(|nodes| {
        cells.push(4);
        cells.extend(nodes.map(i64::from));
    });
    mesh.edges.nodes.iter().for_each(|nodes| {
        cells.extend([2, 2]);
        cells.extend(nodes.map(i64::from));
    });
    let refs: Vec<i64> =
        [&mesh.tets.refs, &mesh.triangles.refs, &mesh.edges.refs].into_iter().flat_map(|refs| wide(refs)).collect();
    let mut parts = vec![Part::Text(HEAD.into()), Part::Text("<Grid Name=\"mesh\">\n".into())];
    let topology = format!("<Topology TopologyType=\"Mixed\" NumberOfElements=\"{}\">\n", refs.len());
    enclosed(&mut parts, topology, Array::int(cells, 1), "Topology");
    points(&mut parts, data);
    attribute(&mut parts, REFERENCES[0], "Scalar", "Cell", Array::int(refs, 1));
    at_points(&mut parts, data);
    parts.push(Part::Text("</Grid>\n".into()));
    parts.push(Part::Text(TAIL.into()));
    parts
}

const HEAD: &str =
    "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\" xmlns:xi=\"http://www.w3.org/2001/XInclude\">\n<Domain>\n";
const TAIL: &str = "</Domain>\n</Xdmf>\n";

fn wide(refs: &[i32]) -> Vec<i64> {
    refs.iter().map(|&reference| reference.into()).collect()
}

fn long(nodes: &[u32]) -> Vec<i64> {
    nodes.iter().map(|&node| node.into()).collect()
}

fn enclosed(parts: &mut Vec<Part>, opening: String, array: Array, tag: &str) {
    parts.extend([Part::Text(opening), Part::Array(array), Part::Text(format!("</{tag}>\n"))]);
}

fn points(parts: &mut Vec<Part>, data: &Dataset) {
    let points = Array::real(data.mesh.vertices.as_flattened().to_vec(), 3);
    enclosed(parts, "<Geometry GeometryType=\"XYZ\">\n".into(), points, "Geometry");
}

fn attribute(parts: &mut Vec<Part>, name: &str, kind: &str, center: &str, array: Array) {
    let name = escape(name.replace(|c: char| c.is_control(), "_")).into_owned();
    let opening = format!("<Attribute Name=\"{name}\" AttributeType=\"{kind}\" Center=\"{center}\">\n");
    enclosed(parts, opening, array, "Attribute");
}

/// Fields, references of vertices, and the names of references.
fn at_points(parts: &mut Vec<Part>, data: &Dataset) {
    for NamedField { name, kind, values } in &data.fields {
        let (word, values) = match kind {
            FieldKind::Scalar => ("Scalar", values.clone()),
            FieldKind::Vector => ("Vector", values.clone()),
            FieldKind::Tensor => ("Tensor", values.clone()),
            FieldKind::SymmetricTensor => {
                let mut moved = values.clone();
                for (to, from) in moved.as_chunks_mut::<6>().0.iter_mut().zip(values.as_chunks::<6>().0) {
                    SYMMETRIC.iter().enumerate().for_each(|(ours, &theirs)| to[theirs] = from[ours]);
                }
                ("Tensor6", moved)
            }
        };
        attribute(parts, name, word, "Node", Array::real(values, kind.values()));
    }
    if data.mesh.vertex_refs.iter().any(|&reference| reference != 0) {
        attribute(parts, REFERENCES[0], "Scalar", "Node", Array::int(wide(&data.mesh.vertex_refs), 1));
    }
    let mut maps = String::new();
    for (name, pairs) in by_name(&data.names) {
        for [reference, dimension] in pairs {
            let name = escape(name.replace(|c: char| c.is_control(), "_"));
            maps.push_str(&format!("<map key=\"{name}\" dim=\"{dimension}\">{reference}</map>"));
        }
    }
    if !maps.is_empty() {
        let text = escape(format!("<main>{maps}</main>"));
        parts.push(Part::Text(format!("<Information Name=\"field_data\">{text}</Information>\n")));
    }
}

/// An item's element up to its numbers.
fn opening(array: &Array, format: &str) -> String {
    let kind = if matches!(array.values, Values::Real(_)) { "Float" } else { "Int" };
    let (rows, width) = (array.rows, array.width);
    let dimensions = if width == 1 { rows.to_string() } else { format!("{rows} {width}") };
    format!("<DataItem Dimensions=\"{dimensions}\" NumberType=\"{kind}\" Precision=\"8\" Format=\"{format}\">")
}

fn arrays(parts: &[Part]) -> impl Iterator<Item = &Array> {
    parts.iter().filter_map(|part| match part {
        Part::Array(array) => Some(array),
        Part::Text(_) => None,
    })
}

/// The arrays as datasets data0, data1 …
fn builder(parts: &[Part]) -> FileBuilder {
    let mut builder = FileBuilder::new();
    builder.with_libver_bounds(LibVer::Earliest, LibVer::V18);
    for (number, array) in arrays(parts).enumerate() {
        let dataset = builder.create_dataset(&format!("data{number}"));
        match &array.values {
            Values::Real(values) => dataset.with_f64_data(values),
            Values::Int(values) => dataset.with_i64_data(values),
        };
        let shape = [array.rows as u64, array.width as u64];
        dataset.with_shape(if array.width == 1 { &shape[..1] } else { &shape });
    }
    builder
}

fn light(to: &mut dyn Write, parts: &[Part], heavy: &str) -> io::Result<()> {
    let mut number = 0;
    for part in parts {
        match part {
            Part::Text(text) => to.write_all(text.as_bytes())?,
            Part::Array(array) => {
                writeln!(to, "{}{}:/data{number}</DataItem>", opening(array, "HDF"), escape(heavy))?;
                number += 1;
            }
        }
    }
    Ok(())
}

fn words(to: &mut dyn Write, parts: &[Part]) -> io::Result<()> {
    let mut text = Text::new(to);
    for part in parts {
        match part {
            Part::Text(words) => text.put(format_args!("{words}")),
            Part::Array(array) => {
                text.put(format_args!("{}\n", opening(array, "XML")));
                for row in 0..array.rows {
                    let of = row * array.width..(row + 1) * array.width;
                    match &array.values {
                        Values::Real(values) => values[of].iter().for_each(|&value| text.real(value)),
                        Values::Int(values) => values[of].iter().for_each(|&value| text.int(value)),
                    }
                    text.end_line()?;
                }
                text.put(format_args!("</DataItem>\n"));
            }
        }
    }
    text.finish()
}
