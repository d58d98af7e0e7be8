//! Writing CGNS: one base, one zone, a section for each reference.
use super::super::sets::{Kind, meaning};
use super::super::{Dataset, error};
use super::fields::ends;
use super::kind::{self, BAR_2, OF_STACK, QUAD_4, TETRA_4, TRI_3};
use super::{NAME, REFERENCE};
use crate::mesh::io::{Batch, Error};
use hdf5_pure::{AttrValue, FileBuilder, FinishedGroup, GroupBuilder, LibVer};
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::Path;

/// Bytes of a name.
const LONGEST: usize = 32;

/// The numbers of a node.
enum Data<'a> {
    None,
    Int(Vec<i32>),
    /// Of a shape other than a row, the index that changes fastest last.
    Shaped(Vec<i32>, [u64; 2]),
    Single(f32),
    Real(Vec<f64>),
    Text(&'a str),
}

/// A node that is being made.
struct Node {
    group: GroupBuilder,
}

impl Node {
    fn new(name: &str, label: &str, data: Data<'_>) -> Result<Self, hdf5_pure::Error> {
        let mut group = FileBuilder::new().create_group(name);
        let kind = match data {
            Data::None => "MT",
            Data::Int(_) | Data::Shaped(..) => "I4",
            Data::Single(_) => "R4",
            Data::Real(_) => "R8",
            Data::Text(_) => "C1",
        };
        group.set_attr("name", AttrValue::ascii_string_sized(name, 33)?);
        group.set_attr("label", AttrValue::ascii_string_sized(label, 33)?);
        group.set_attr("type", AttrValue::ascii_string_sized(kind, 3)?);
        group.set_attr("flags", AttrValue::I32Array(vec![1]));
        if matches!(data, Data::None) {
            return Ok(Self { group });
        }
        let dataset = group.create_dataset(" data");
        match data {
            Data::None => dataset,
            Data::Int(values) => dataset.with_i32_data(&values),
            Data::Shaped(values, shape) => dataset.with_i32_data(&values).with_shape(&shape),
            Data::Single(value) => dataset.with_f32_data(&[value]),
            Data::Real(values) => dataset.with_f64_data(&values),
            Data::Text(text) => dataset.with_i8_data(&bytes(text)),
        };
        Ok(Self { group })
    }

    fn add(&mut self, name: &str, label: &str, data: Data<'_>) -> Result<(), hdf5_pure::Error> {
        let child = Self::new(name, label, data)?;
        self.group.add_group(child.finish());
        Ok(())
    }

    fn finish(self) -> FinishedGroup {
        self.group.finish()
    }
}

fn bytes(text: &str) -> Vec<i8> {
    text.bytes().map(|byte| byte as i8).collect()
}

/// Names that CGNS can have: ASCII, short, without a slash, each once.
#[derive(Default)]
struct Plain(BTreeSet<String>);

impl Plain {
    fn name(&mut self, wanted: &str, room: usize) -> String {
        let is_odd = |c: char| !c.is_ascii_graphic() && c != ' ' || c == '/';
        let plain: String = wanted.trim().chars().map(|c| if is_odd(c) { '_' } else { c }).take(room).collect();
        let plain = if plain.is_empty() || plain == "." || plain == ".." { "unnamed".into() } else { plain };
        let mut name = plain.clone();
        let mut number = 2;
        while !self.0.insert(name.clone()) {
            let end = format!("_{number}");
            name = format!("{}{end}", &plain[..plain.len().min(room - end.len())]);
            number += 1;
        }
        name
    }
}

/// Writes a mesh.
pub(in super::super) fn write(batch: &mut Batch, path: &Path, data: &Dataset) -> Result<Vec<String>, Error> {
    let mesh = &data.mesh;
    let of_stack = data.stack.cells.len() + data.stack.quads.len();
    let elements = mesh.tets.len() + mesh.triangles.len() + mesh.edges.len() + of_stack;
    if i32::try_from(mesh.vertices.len().max(elements)).is_err() {
        return Err(error::at(path, "its size", "more than 2^31 - 1 vertices or elements; write .vtu"));
    }
    let mut notices = Vec::new();
    let built = file(data, &mut notices).map_err(|error| error::at(path, "HDF5", error.to_string()))?;
    batch.add_main(path, |to| built.finish_to(to).map_err(io::Error::other))?;
    Ok(notices)
}

fn file(data: &Dataset, notices: &mut Vec<String>) -> Result<FileBuilder, hdf5_pure::Error> {
    let mut builder = FileBuilder::new();
    builder.with_libver_bounds(LibVer::Earliest, LibVer::V18);
    builder.set_attr("name", AttrValue::ascii_string_sized("HDF5 MotherNode", 33)?);
    builder.set_attr("label", AttrValue::ascii_string_sized("Root Node of HDF5 File", 33)?);
    builder.set_attr("type", AttrValue::ascii_string_sized("MT", 3)?);
    let format = if cfg!(target_endian = "big") { "IEEE_BIG_32\0\0\0\0" } else { "IEEE_LITTLE_32\0" };
    builder.create_dataset(" format").with_i8_data(&bytes(format));
    builder.create_dataset(" hdf5version").with_i8_data(&bytes(&format!("{:\0<33}", "HDF5 Version 1.8")));
    builder.add_group(Node::new("CGNSLibraryVersion", "CGNSLibraryVersion_t", Data::Single(3.4))?.finish());
    let mesh = &data.mesh;
    let dimension = if data.cells() == 0 { 2 } else { 3 };
    let mut base = Node::new("Base", "CGNSBase_t", Data::Int(vec![dimension, 3]))?;
    let (vertices, cells) = (mesh.vertices.len(), if dimension == 3 { data.cells() } else { mesh.triangles.len() });
    let mut zone = Node::new("Zone", "Zone_t", Data::Shaped(vec![vertices as i32, cells as i32, 0], [3, 1]))?;
    zone.add("ZoneType", "ZoneType_t", Data::Text("Unstructured"))?;
    let mut grid = Node::new("GridCoordinates", "GridCoordinates_t", Data::None)?;
    for (axis, name) in ["CoordinateX", "CoordinateY", "CoordinateZ"].into_iter().enumerate() {
        grid.add(name, "DataArray_t", Data::Real(mesh.vertices.iter().map(|point| point[axis]).collect()))?;
    }
    zone.group.add_group(grid.finish());
    let families = elements(&mut zone, data)?;
    solution(&mut zone, data, notices)?;
    for family in families {
        base.add(&family, "Family_t", Data::None)?;
    }
    base.group.add_group(zone.finish());
    builder.add_group(base.finish());
    Ok(builder)
}

/// The nodes of the elements by their dimension's place in [`Kind::ALL`], their type and their reference.
fn parts(data: &Dataset) -> BTreeMap<(usize, i64, i32), Vec<u32>> {
    let Dataset { mesh, stack, .. } = data;
    let mut parts: BTreeMap<_, Vec<u32>> = BTreeMap::new();
    let mut add = |kind: Kind, number: i64, nodes: &[u32], reference: i32| {
        let at = Kind::ALL.iter().position(|other| *other == kind).unwrap_or(0);
        parts.entry((at, number, reference)).or_default().extend(nodes);
    };
    mesh.tets.iter().for_each(|(nodes, reference)| add(Kind::Tetrahedra, TETRA_4, &nodes, reference));
    for (number, of) in OF_STACK {
        stack.cells_of(of).for_each(|cell| add(Kind::Tetrahedra, number, cell.nodes(), cell.reference));
    }
    mesh.triangles.iter().for_each(|(nodes, reference)| add(Kind::Triangles, TRI_3, &nodes, reference));
    stack.quads.iter().for_each(|(nodes, reference)| add(Kind::Triangles, QUAD_4, &nodes, reference));
    mesh.edges.iter().for_each(|(nodes, reference)| add(Kind::Edges, BAR_2, &nodes, reference));
    parts
}

/// A section for each type and reference, and a boundary condition for each of triangles or quadrilaterals. Returns the families.
fn elements(zone: &mut Node, data: &Dataset) -> Result<Vec<String>, hdf5_pure::Error> {
    let (mut names, mut of_conditions) = (Plain::default(), Plain::default());
    // Names of other nodes of a zone and of a base.
    let taken = ["ZoneType", "GridCoordinates", "ZoneBC", "FlowSolution"];
    names.0.extend(taken.map(String::from));
    let mut of_families = Plain(BTreeSet::from(["Zone".into()]));
    let mut families: BTreeMap<String, String> = BTreeMap::new();
    let mut conditions = Node::new("ZoneBC", "ZoneBC_t", Data::None)?;
    let (mut first, mut any) = (1, false);
    for ((at, number, reference), nodes) in parts(data) {
        let of = Kind::ALL[at];
        let called = meaning(data, (of, reference)).name;
        let shown = called.clone().unwrap_or_else(|| format!("{} {reference}", of.unnamed()));
        let last = first + (nodes.len() / kind::nodes(number).unwrap_or(1)) as i32 - 1;
        let name = names.name(&shown, LONGEST);
        let mut section = Node::new(&name, "Elements_t", Data::Int(vec![number as i32, 0]))?;
        section.add("ElementRange", "IndexRange_t", Data::Int(vec![first, last]))?;
        let nodes = nodes.iter().map(|&node| node as i32 + 1).collect();
        section.add("ElementConnectivity", "DataArray_t", Data::Int(nodes))?;
        section.add(REFERENCE, "Descriptor_t", Data::Text(&reference.to_string()))?;
        if let Some(called) = &called {
            section.add(NAME, "Descriptor_t", Data::Text(called))?;
        }
        zone.group.add_group(section.finish());
        if of == Kind::Triangles {
            let family = families.entry(shown.clone()).or_insert_with(|| of_families.name(&shown, LONGEST));
            let mut condition = Node::new(&of_conditions.name(&shown, LONGEST), "BC_t", Data::Text("FamilySpecified"))?;
            condition.add("PointRange", "IndexRange_t", Data::Shaped(vec![first, last], [2, 1]))?;
            condition.add("GridLocation", "GridLocation_t", Data::Text("FaceCenter"))?;
            condition.add("FamilyName", "FamilyName_t", Data::Text(family))?;
            conditions.group.add_group(condition.finish());
            any = true;
        }
        first = last + 1;
    }
    if any {
        zone.group.add_group(conditions.finish());
    }
    Ok(families.into_values().collect())
}

/// The fields, a scalar for each component.
fn solution(zone: &mut Node, data: &Dataset, notices: &mut Vec<String>) -> Result<(), hdf5_pure::Error> {
    if data.fields.is_empty() {
        return Ok(());
    }
    let mut solution = Node::new("FlowSolution", "FlowSolution_t", Data::None)?;
    solution.add("GridLocation", "GridLocation_t", Data::Text("Vertex"))?;
    let mut names = Plain(BTreeSet::from(["GridLocation".into()]));
    for field in &data.fields {
        let ends = ends(field.kind);
        let stem = names.name(&field.name, LONGEST - ends[0].len());
        if stem != field.name {
            notices.push(format!("the field {} is called {stem}", error::short(&field.name)));
        }
        for (k, end) in ends.iter().enumerate() {
            let values = field.values.iter().skip(k).step_by(ends.len()).copied().collect();
            solution.add(&format!("{stem}{end}"), "DataArray_t", Data::Real(values))?;
        }
    }
    zone.group.add_group(solution.finish());
    Ok(())
}
