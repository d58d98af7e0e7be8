//! Writing a .msh of version 2.2 or 4.1. All nodes are in one block: which entity they are on is not known here.
use super::super::text::Text;
use super::super::{Dataset, NamedField};
use super::{CELLS, LINE, QUADRILATERAL, TETRAHEDRON, TRIANGLE};
use crate::geometry::Label;
use crate::mesh::TetMesh;
use crate::mesh::io::{Batch, Error, FieldKind};
use crate::mesh::vector::Vec3;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::Path;

/// A file on its way.
struct Out<'a> {
    text: Text<'a>,
    is_text: bool,
}

impl Out<'_> {
    #[inline]
    fn int(&mut self, value: i32) {
        if self.is_text { self.text.int(value) } else { self.text.raw(&value.to_ne_bytes()) }
    }

    #[inline]
    fn size(&mut self, value: usize) {
        if self.is_text { self.text.int(value as i64) } else { self.text.raw(&(value as u64).to_ne_bytes()) }
    }

    #[inline]
    fn real(&mut self, value: f64) {
        if self.is_text { self.text.real(value) } else { self.text.raw(&value.to_ne_bytes()) }
    }

    #[inline]
    fn end_row(&mut self) -> io::Result<()> {
        if self.is_text { self.text.end_line() } else { self.text.hand_on() }
    }

    /// A line of text, in binary files too.
    fn line(&mut self, line: std::fmt::Arguments) {
        self.text.put(line);
        self.text.raw(b"\n");
    }

    /// The end of a section; behind bytes a line ends first.
    fn end(&mut self, section: &str) {
        if !self.is_text {
            self.text.raw(b"\n");
        }
        self.line(format_args!("$End{section}"));
    }
}

/// Elements of a kind: nodes, so many of each, and references.
struct Block<'a> {
    kind: i32,
    width: usize,
    nodes: Cow<'a, [u32]>,
    refs: Cow<'a, [i32]>,
}

impl<'a> Block<'a> {
    fn new(kind: i64, width: usize, nodes: &'a [u32], refs: &'a [i32]) -> Self {
        Self { kind: kind as i32, width, nodes: nodes.into(), refs: refs.into() }
    }

    fn iter(&self) -> impl Iterator<Item = (&[u32], i32)> {
        self.nodes.chunks_exact(self.width).zip(self.refs.iter().copied())
    }
}

/// Elements of a dimension: entities, their groups and their elements.
struct Part<'a> {
    dimension: i32,
    blocks: Vec<Block<'a>>,
    /// Numbers of the entities by reference; gmsh wants them positive.
    entities: BTreeMap<i32, i32>,
    /// Physical groups by reference.
    groups: BTreeMap<i32, i32>,
    /// Names of the physical groups.
    names: BTreeMap<i32, String>,
}

impl<'a> Part<'a> {
    /// With `grouped` each entity gets a group, without a name where it has none. If there are any groups, gmsh writes only elements in
    /// groups, and meshio wants every element in one.
    fn new(
        dimension: i32,
        blocks: Vec<Block<'a>>,
        labels: &BTreeMap<i32, Label>,
        grouped: bool,
        notices: &mut Vec<String>,
    ) -> Self {
        let found: BTreeSet<i32> = blocks.iter().flat_map(|block| block.refs.iter().copied()).collect();
        let mut entities: BTreeMap<i32, i32> = found.iter().filter(|&&r| r > 0).map(|&r| (r, r)).collect();
        let mut free = (1..).filter(|number| !found.contains(number));
        for &reference in found.iter().filter(|&&reference| reference <= 0) {
            let number = free.next().unwrap_or(i32::MAX);
            notices.push(format!("the reference {reference} is written as {number}: gmsh wants positive ones"));
            entities.insert(reference, number);
        }
        let (mut groups, mut names) = (BTreeMap::new(), BTreeMap::new());
        let mut of_name: BTreeMap<&str, i32> = BTreeMap::new();
        for (reference, &entity) in &entities {
            if let Some(name) = labels.get(reference).and_then(|label| label.name.as_deref()) {
                let group = *of_name.entry(name).or_insert(entity);
                groups.insert(*reference, group);
                names.entry(group).or_insert_with(|| name.replace(['"', '\n', '\r'], "_"));
            } else if grouped {
                groups.insert(*reference, entity);
            }
        }
        Self { dimension, blocks, entities, groups, names }
    }

    /// The number of its elements.
    fn len(&self) -> usize {
        self.blocks.iter().map(|block| block.refs.len()).sum()
    }
}

/// Writes a mesh; nodes and elements are numbered from 1 in their order.
pub(in super::super) fn write(
    batch: &mut Batch,
    path: &Path,
    data: &Dataset,
    is_new: bool,
    is_text: bool,
) -> Result<Vec<String>, Error> {
    let (mesh, names) = (&data.mesh, &data.names);
    let mut notices = Vec::new();
    let grouped = !names.is_empty();
    let lines = vec![Block::new(LINE, 2, mesh.edges.nodes.as_flattened(), &mesh.edges.refs)];
    let quads = &data.stack.quads;
    let faces = vec![
        Block::new(TRIANGLE, 3, mesh.triangles.nodes.as_flattened(), &mesh.triangles.refs),
        Block::new(QUADRILATERAL, 4, quads.nodes.as_flattened(), &quads.refs),
    ];
    let mut cells = vec![Block::new(TETRAHEDRON, 4, mesh.tets.nodes.as_flattened(), &mesh.tets.refs)];
    cells.extend(CELLS.map(|(number, kind)| {
        let of_kind = || data.stack.cells_of(kind);
        let nodes = of_kind().flat_map(|cell| cell.nodes().iter().copied()).collect();
        Block {
            kind: number as i32,
            width: kind.corners(),
            nodes,
            refs: of_kind().map(|cell| cell.reference).collect(),
        }
    }));
    let parts = [
        Part::new(1, lines, &names.edges, grouped, &mut notices),
        Part::new(2, faces, &names.triangles, grouped, &mut notices),
        Part::new(3, cells, &names.tetrahedra, grouped, &mut notices),
    ];
    batch.add_main(path, |to| emit(&mut Out { text: Text::new(to), is_text }, data, &parts, is_new))?;
    Ok(notices)
}

fn emit(out: &mut Out, data: &Dataset, parts: &[Part; 3], is_new: bool) -> io::Result<()> {
    let (version, kind) = (if is_new { "4.1" } else { "2.2" }, i32::from(!out.is_text));
    out.line(format_args!("$MeshFormat\n{version} {kind} 8"));
    if !out.is_text {
        out.int(1);
    }
    out.end("MeshFormat");
    let names: usize = parts.iter().map(|part| part.names.len()).sum();
    if names > 0 {
        out.line(format_args!("$PhysicalNames\n{names}"));
        for Part { dimension, names, .. } in parts {
            names.iter().for_each(|(group, name)| out.line(format_args!("{dimension} {group} \"{name}\"")));
        }
        out.line(format_args!("$EndPhysicalNames"));
    }
    let mesh = &data.mesh;
    if is_new {
        entities(out, mesh, parts)?;
        nodes_4(out, mesh, parts)?;
        elements_4(out, parts)?;
    } else {
        nodes_2(out, mesh)?;
        elements_2(out, parts)?;
    }
    data.fields.iter().try_for_each(|field| node_data(out, field))?;
    out.text.finish()
}

/// Entities with their boxes and physical groups.
fn entities(out: &mut Out, mesh: &TetMesh, parts: &[Part; 3]) -> io::Result<()> {
    fn boxes(mesh: &TetMesh, part: &Part) -> BTreeMap<i32, [Vec3; 2]> {
        let mut boxes: BTreeMap<i32, [Vec3; 2]> = BTreeMap::new();
        for (nodes, reference) in part.blocks.iter().flat_map(Block::iter) {
            let [low, high] = boxes.entry(reference).or_insert([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]]);
            for point in nodes.iter().map(|&v| mesh.vertices[v as usize]) {
                for i in 0..3 {
                    (low[i], high[i]) = (low[i].min(point[i]), high[i].max(point[i]));
                }
            }
        }
        boxes
    }
    out.line(format_args!("$Entities"));
    out.size(0);
    parts.iter().for_each(|part| out.size(part.entities.len()));
    out.end_row()?;
    for part in parts {
        let boxes = boxes(mesh, part);
        for (reference, &entity) in &part.entities {
            out.int(entity);
            boxes[reference].as_flattened().iter().for_each(|&x| out.real(x));
            let group = part.groups.get(reference);
            out.size(group.iter().len());
            group.into_iter().for_each(|&group| out.int(group));
            out.size(0);
            out.end_row()?;
        }
    }
    out.end("Entities");
    Ok(())
}

fn nodes_4(out: &mut Out, mesh: &TetMesh, parts: &[Part; 3]) -> io::Result<()> {
    let count = mesh.vertices.len();
    out.line(format_args!("$Nodes"));
    [1, count, 1, count].into_iter().for_each(|size| out.size(size));
    out.end_row()?;
    // The first entity of the highest dimension.
    let entity = parts.iter().rev().find_map(|part| Some((part.dimension, *part.entities.values().next()?)));
    let (dimension, entity) = entity.unwrap_or((3, 1));
    [dimension, entity, 0].into_iter().for_each(|int| out.int(int));
    out.size(count);
    out.end_row()?;
    for tag in 1..=count {
        out.size(tag);
        out.end_row()?;
    }
    for point in &mesh.vertices {
        point.iter().for_each(|&x| out.real(x));
        out.end_row()?;
    }
    out.end("Nodes");
    Ok(())
}

fn elements_4(out: &mut Out, parts: &[Part; 3]) -> io::Result<()> {
    /// The elements of a kind by their references, each in their order.
    fn rows(block: &Block) -> BTreeMap<i32, Vec<u32>> {
        let mut rows: BTreeMap<i32, Vec<u32>> = BTreeMap::new();
        for (element, &reference) in (0..).zip(&*block.refs) {
            rows.entry(reference).or_default().push(element);
        }
        rows
    }
    let total = parts.iter().map(Part::len).sum();
    out.line(format_args!("$Elements"));
    let found = |block: &Block| block.refs.iter().collect::<BTreeSet<_>>().len();
    let count = parts.iter().flat_map(|part| &part.blocks).map(found).sum();
    [count, total, usize::from(total > 0), total].into_iter().for_each(|size| out.size(size));
    out.end_row()?;
    let mut next = 1;
    for (part, block) in parts.iter().flat_map(|part| part.blocks.iter().map(move |block| (part, block))) {
        for (reference, row) in rows(block) {
            [part.dimension, part.entities[&reference], block.kind].into_iter().for_each(|int| out.int(int));
            out.size(row.len());
            out.end_row()?;
            for element in row {
                out.size(next);
                let at = block.width * element as usize;
                block.nodes[at..at + block.width].iter().for_each(|&v| out.size(v as usize + 1));
                out.end_row()?;
                next += 1;
            }
        }
    }
    out.end("Elements");
    Ok(())
}

fn nodes_2(out: &mut Out, mesh: &TetMesh) -> io::Result<()> {
    out.line(format_args!("$Nodes\n{}", mesh.vertices.len()));
    for (tag, point) in (1..).zip(&mesh.vertices) {
        out.int(tag);
        point.iter().for_each(|&x| out.real(x));
        out.end_row()?;
    }
    out.end("Nodes");
    Ok(())
}

fn elements_2(out: &mut Out, parts: &[Part; 3]) -> io::Result<()> {
    out.line(format_args!("$Elements\n{}", parts.iter().map(Part::len).sum::<usize>()));
    let mut number = 1;
    for (part, block) in parts.iter().flat_map(|part| part.blocks.iter().map(move |block| (part, block))) {
        let count = block.refs.len() as i32;
        if !out.is_text && count > 0 {
            [block.kind, count, 2].into_iter().for_each(|int| out.int(int));
        }
        for (nodes, reference) in block.iter() {
            out.int(number);
            if out.is_text {
                [block.kind, 2].into_iter().for_each(|int| out.int(int));
            }
            out.int(part.groups.get(&reference).copied().unwrap_or(0));
            out.int(part.entities[&reference]);
            nodes.iter().for_each(|&v| out.int(v as i32 + 1));
            out.end_row()?;
            number += 1;
        }
    }
    out.end("Elements");
    Ok(())
}

/// A field; a symmetric tensor has nine values here.
fn node_data(out: &mut Out, field: &NamedField) -> io::Result<()> {
    let width = field.kind.values();
    let written = if field.kind == FieldKind::SymmetricTensor { 9 } else { width };
    let count = field.values.len() / width;
    let name = field.name.replace(['"', '\n', '\r'], "_");
    out.line(format_args!("$NodeData\n1\n\"{name}\"\n1\n0.0\n3\n0\n{written}\n{count}"));
    for (tag, row) in (1..).zip(field.values.chunks_exact(width)) {
        out.int(tag);
        match *row {
            [xx, xy, yy, xz, yz, zz] => [xx, xy, xz, xy, yy, yz, xz, yz, zz].into_iter().for_each(|x| out.real(x)),
            _ => row.iter().for_each(|&x| out.real(x)),
        }
        out.end_row()?;
    }
    out.end("NodeData");
    Ok(())
}
