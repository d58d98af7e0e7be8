//! gmsh's meshes (.msh), versions 2.2 and 4.1, as text and binary: points, lines, triangles, quadrilaterals and cells of the first order, names of
//! physical groups, data at nodes and elements. Source: gmsh's reference manual, "MSH file format".
//!
//! A reference is the number of the elementary entity (the face of the model); its name is that of the physical group that has it, so
//! several references may have one name.
mod data;
mod source;
mod v2;
mod v4;
mod write;

pub(super) use write::write;

use super::orientation;
use super::tags::Tags;
use super::{Dataset, error, stacks};
use crate::geometry::{Label, Names};
use crate::mesh::io::{Error, Read};
use crate::mesh::stack::{Kind, Stack};
use crate::mesh::{Elements, TetMesh};
use crate::tasks::Team;
use source::{Encoding, Source};
use std::collections::BTreeMap;
use std::path::Path;

/// gmsh's numbers of the elements that we have.
const LINE: i64 = 1;
const TRIANGLE: i64 = 2;
const QUADRILATERAL: i64 = 3;
const TETRAHEDRON: i64 = 4;
const POINT: i64 = 15;

/// gmsh's numbers of the cells of a stack; the order of the nodes is ours.
const CELLS: [(i64, Kind); 3] = [(5, Kind::Hexahedron), (6, Kind::Prism), (7, Kind::Pyramid)];

/// The kind of cells of such a number.
fn kind_of(number: i64) -> Option<Kind> {
    CELLS.into_iter().find(|(other, _)| *other == number).map(|(_, kind)| kind)
}

/// What a file holds.
struct Raw {
    mesh: TetMesh,
    stack: Stack,
    nodes: Tags,
    /// Numbers of the tetrahedra.
    tets: Vec<usize>,
    /// Numbers of the cells of the stack.
    cells: Vec<usize>,
    /// Names of the physical groups by dimension and number.
    groups: BTreeMap<(i64, i64), String>,
    /// Physical groups of the entities by dimension and number of the entity.
    of_entity: BTreeMap<(i64, i64), i64>,
    data: Vec<data::View>,
    notices: Vec<String>,
}

/// Reads a mesh with its names and fields. Nodes that no line, triangle and tetrahedron has are left out.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Read<Dataset>, Error> {
    let mut raw = sections(path, bytes)?;
    raw.mesh.association = Default::default(); // the numbers of gmsh's model, which is not ours
    let names = names(&raw);
    stacks::join(path, &mut raw.mesh, &mut raw.stack, &mut raw.notices)?;
    let mut fields = Vec::new();
    for view in std::mem::take(&mut raw.data) {
        view.resolve(&mut raw, &mut fields);
    }
    let Raw { mut mesh, mut stack, mut notices, .. } = raw;
    let kept = compact((&mut mesh, &mut stack), |mesh, keep| {
        mesh.tets.nodes.as_flattened().iter().chain(mesh.triangles.nodes.as_flattened()).for_each(|&v| keep(v));
        mesh.edges.nodes.as_flattened().iter().for_each(|&v| keep(v));
    });
    let lost = kept.iter().filter(|kept| !**kept).count();
    if lost > 0 {
        notices.push(format!("{}: {lost} nodes without elements are left out", path.display()));
        for field in &mut fields {
            let rows = field.values.chunks_exact(field.kind.values()).zip(&kept).filter(|(_, kept)| **kept);
            field.values = rows.flat_map(|(row, _)| row).copied().collect();
        }
    }
    Ok(Read { content: Dataset { mesh, stack, names, fields }, notices })
}

/// Reads the mesh that gmsh made of a CAD model, version 4.1. References are the numbers of the model's edges, faces and solids; the
/// association is that of the nodes that were written on entities, with their parameters where there are any. Nodes that no tetrahedron
/// has are left out, and where most tetrahedra are negative all are turned. Other cells than tetrahedra are left out too.
///
/// # Errors
/// [`Error::System`] when the file cannot be read, [`Error::Content`] when it is no such file, or there are no tetrahedra in it.
pub fn read_msh(path: &Path) -> Result<TetMesh, Error> {
    let bytes = error::read(path)?;
    let Raw { mut mesh, .. } = sections(path, &bytes)?;
    if mesh.tets.is_empty() {
        return Err(error::at(path, "Elements", "no tetrahedra in it"));
    }
    compact((&mut mesh, &mut Stack::default()), |mesh, keep| {
        mesh.tets.nodes.as_flattened().iter().for_each(|&v| keep(v))
    });
    orientation::unify_all(Team::alone(), &mesh.vertices, &mut mesh.tets.nodes);
    Ok(mesh)
}

/// Goes through the sections of a file.
fn sections(path: &Path, bytes: &[u8]) -> Result<Raw, Error> {
    let mut source = Source::new(path, bytes);
    let mut raw = Raw {
        mesh: TetMesh::default(),
        stack: Stack::default(),
        nodes: Tags::Row { first: 1, count: 0 },
        tets: Vec::new(),
        cells: Vec::new(),
        groups: BTreeMap::new(),
        of_entity: BTreeMap::new(),
        data: Vec::new(),
        notices: Vec::new(),
    };
    let (mut is_new, mut has_elements) = (None, false);
    while let Some(line) = source.scan.line() {
        let Some(section) = line.strip_prefix(b"$").filter(|name| !name.starts_with(b"End")) else { continue };
        if section == b"MeshFormat" {
            is_new = Some(format(&mut source)?);
        }
        match (section, is_new) {
            (b"MeshFormat", _) => {}
            (b"Comments", _) => source.leave(section)?,
            (_, None) => return Err(source.fail("$MeshFormat must come first; give a mesh of MSH version 2.2 or 4.1")),
            (b"PhysicalNames", _) => groups(&mut source, &mut raw)?,
            (b"Nodes", _) if !raw.mesh.vertices.is_empty() => return Err(twice(&source, "Nodes")),
            (b"Elements", _) if std::mem::replace(&mut has_elements, true) => return Err(twice(&source, "Elements")),
            (b"Entities", Some(true)) => v4::entities(&mut source, &mut raw)?,
            (b"Nodes", Some(true)) => v4::nodes(&mut source, &mut raw)?,
            (b"Elements", Some(true)) => v4::elements(&mut source, &mut raw)?,
            (b"Nodes", Some(false)) => v2::nodes(&mut source, &mut raw)?,
            (b"Elements", Some(false)) => v2::elements(&mut source, &mut raw)?,
            (b"NodeData", _) => raw.data.push(data::view(&mut source, true)?),
            (b"ElementData", _) => raw.data.push(data::view(&mut source, false)?),
            _ => {
                if matches!(section, b"PartitionedEntities" | b"ElementNodeData" | b"ParametricNodes") {
                    raw.notices.push(format!("{}: ${} is not read", path.display(), String::from_utf8_lossy(section)));
                }
                source.leave(section)?;
            }
        }
    }
    if raw.mesh.vertices.is_empty() {
        return Err(source.fail("there are no nodes in it; give a mesh of MSH version 2.2 or 4.1"));
    }
    Ok(raw)
}

/// A section that comes again.
fn twice(source: &Source, section: &str) -> Error {
    source.fail(format!("${section} comes a second time; join the two"))
}

/// Reads the version and the encoding: whether it is 4.1.
fn format(source: &mut Source) -> Result<bool, Error> {
    let line = source.scan.line().unwrap_or_default();
    let mut words = line.split(|byte| *byte <= b' ').filter(|word| !word.is_empty());
    let is_new = match words.next() {
        Some(b"4.1") => true,
        Some(b"2.2" | b"2.1" | b"2" | b"2.0") => false,
        _ => return Err(source.fail("a mesh of MSH version 2.2 or 4.1 is expected; gmsh writes it by -format msh41")),
    };
    match words.next() {
        Some(b"0") => {}
        Some(b"1") => {
            let first = source.rest().first_chunk().copied().unwrap_or_default();
            let big = match (i32::from_le_bytes(first), i32::from_be_bytes(first)) {
                (1, _) => false,
                (_, 1) => true,
                _ => {
                    return Err(
                        source.fail("the number 1 is expected behind the head of a binary file; write it again")
                    );
                }
            };
            source.encoding = Encoding::Binary { big };
            source.skip(4)?;
        }
        _ => return Err(source.fail("0 (text) or 1 (binary) is expected behind the version")),
    }
    if is_new && !source.is_text() && words.next() != Some(b"8") {
        return Err(source.fail("numbers of 8 bytes are expected; write the file on a machine of 64 bits"));
    }
    Ok(is_new)
}

/// Names of physical groups: dimension, number, name in quotes.
fn groups(source: &mut Source, raw: &mut Raw) -> Result<(), Error> {
    let line = source.scan.line().unwrap_or_default();
    let count = source.scan.count(line)?;
    for _ in 0..count {
        let line = source.scan.line().ok_or_else(|| source.scan.fail("the file is cut off"))?;
        let text = String::from_utf8_lossy(line);
        let mut words = text.splitn(3, |c: char| c.is_ascii_whitespace());
        let mut number = || words.next().and_then(|word| word.parse::<i64>().ok());
        let (Some(dimension), Some(group)) = (number(), number()) else {
            return Err(source.scan.fail("dimension, number and name of a physical group are expected"));
        };
        let name = words.next().unwrap_or("").trim();
        raw.groups.insert((dimension, group), name.trim_matches('"').to_owned());
    }
    Ok(())
}

/// What the references are called: by their physical groups.
fn names(raw: &Raw) -> Names {
    let of = |dimension: i64, refs: &[i32]| -> BTreeMap<i32, Label> {
        let mut labels = BTreeMap::new();
        let mut last = None;
        for &reference in refs.iter().filter(|&&reference| last.replace(reference) != Some(reference)) {
            let Some(&group) = raw.of_entity.get(&(dimension, reference.into())) else { continue };
            let name = match raw.groups.get(&(dimension, group)) {
                Some(name) => name.clone(),
                None if group == i64::from(reference) => continue,
                None => format!("group {group}"),
            };
            labels.entry(reference).or_insert(Label { name: Some(name), colour: None });
        }
        labels
    };
    let mesh = &raw.mesh;
    let stack = &raw.stack;
    let faces: Vec<i32> = mesh.triangles.refs.iter().chain(&stack.quads.refs).copied().collect();
    let cells = mesh.tets.refs.iter().copied().chain(stack.cells.iter().map(|cell| cell.reference));
    Names { edges: of(1, &mesh.edges.refs), triangles: of(2, &faces), tetrahedra: of(3, &cells.collect::<Vec<_>>()) }
}

/// Removes the nodes that are not `used`, with their elements and places. Returns which nodes stay.
fn compact((mesh, stack): (&mut TetMesh, &mut Stack), used: impl Fn(&TetMesh, &mut dyn FnMut(u32))) -> Vec<bool> {
    let mut kept = vec![false; mesh.vertices.len()];
    used(mesh, &mut |v| kept[v as usize] = true);
    if !kept.contains(&false) {
        return kept;
    }
    let mut next = 0;
    let number: Vec<u32> = kept
        .iter()
        .map(|&kept| {
            let number = if kept { next } else { u32::MAX };
            next += u32::from(kept);
            number
        })
        .collect();
    let mut stays = kept.iter();
    mesh.vertices.retain(|_| stays.next() == Some(&true));
    mesh.vertex_refs.truncate(mesh.vertices.len());
    renumber(&mut mesh.tets, &number);
    renumber(&mut mesh.triangles, &number);
    renumber(&mut mesh.edges, &number);
    stack.nodes_mut().for_each(|v| *v = number[*v as usize]);
    let on = &mut mesh.association;
    on.vertices.retain(|on| kept[on.vertex as usize]);
    on.edges.retain(|on| kept[on.vertex as usize]);
    on.faces.retain(|on| kept[on.vertex as usize]);
    let vertices = on.vertices.iter_mut().map(|on| &mut on.vertex).chain(on.edges.iter_mut().map(|on| &mut on.vertex));
    vertices.chain(on.faces.iter_mut().map(|on| &mut on.vertex)).for_each(|v| *v = number[*v as usize]);
    kept
}

/// The elements whose nodes all stay, with their new numbers.
fn renumber<const N: usize>(elements: &mut Elements<N>, number: &[u32]) {
    let mut kept = Elements::default();
    for (nodes, reference) in elements.iter() {
        let nodes = nodes.map(|v| number[v as usize]);
        if !nodes.contains(&u32::MAX) {
            kept.push(nodes, reference);
        }
    }
    *elements = kept;
}

#[cfg(test)]
mod tests;
