//! SU2's meshes: a text of elements, points and markers. Source: su2code.github.io, "Mesh File"; elements have VTK's numbers, indices
//! count from 0.
use super::format::vtk::{LINE, QUADRILATERAL, TETRAHEDRON, TRIANGLE, VERTEX, name};
use super::scan::Scan;
use super::text::Text;
use super::{Dataset, markers, stacks};
use crate::geometry::Label;
use crate::mesh::TetMesh;
use crate::mesh::io::{Batch, Error, Read};
use crate::mesh::stack::{Cell, Stack};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::path::Path;

/// The marker of SU2's old parallel meshes, whose elements are points.
const PARALLEL: &str = "SEND_RECEIVE";

struct Reader<'a> {
    scan: Scan<'a>,
    mesh: TetMesh,
    stack: Stack,
    /// Tags of the markers; the references of their elements are indices into it, until all are known.
    tags: Vec<String>,
    /// Place of a tag among them.
    place: BTreeMap<String, i32>,
    noted: BTreeMap<String, i32>,
    notices: Vec<String>,
}

/// Reads a mesh; the triangles of a marker get a reference, whose name is the marker's.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Read<Dataset>, Error> {
    let scan = Scan::new(path, bytes);
    let (mesh, tags, notices) = (TetMesh::default(), Vec::new(), Vec::new());
    let (stack, place, noted) = (Stack::default(), BTreeMap::new(), BTreeMap::new());
    let mut reader = Reader { scan, mesh, stack, tags, place, noted, notices };
    reader.read()?;
    let Reader { mut mesh, mut stack, tags, noted, mut notices, .. } = reader;
    let references = markers::references(&tags, &noted);
    let mut content = Dataset::default();
    for (tag, &reference) in tags.into_iter().zip(&references) {
        if tag != reference.to_string() && tag != PARALLEL {
            content.names.triangles.insert(reference, Label { name: Some(tag), colour: None });
        }
    }
    for reference in mesh.triangles.refs.iter_mut().chain(&mut mesh.edges.refs).chain(&mut stack.quads.refs) {
        *reference = references.get(*reference as usize).copied().unwrap_or(0);
    }
    let lines: BTreeSet<i32> = mesh.edges.refs.iter().copied().collect();
    let of_lines = content.names.triangles.iter().filter(|(reference, _)| lines.contains(reference));
    content.names.edges = of_lines.map(|(&reference, label)| (reference, label.clone())).collect();
    let faces: BTreeSet<i32> = mesh.triangles.refs.iter().chain(&stack.quads.refs).copied().collect();
    content.names.triangles.retain(|reference, _| faces.contains(reference) || !lines.contains(reference));
    stacks::join(path, &mut mesh, &mut stack, &mut notices)?;
    (content.mesh, content.stack) = (mesh, stack);
    Ok(Read { content, notices })
}

impl Reader<'_> {
    fn read(&mut self) -> Result<(), Error> {
        let (mut dimension, mut marker) = (None, None);
        while let Some(line) = self.scan.line() {
            if let Some(comment) = line.strip_prefix(b"%") {
                self.noted.extend(markers::noted(comment).map(|(reference, tag)| (tag.to_owned(), reference)));
                continue;
            }
            let Some(equals) = line.iter().position(|&byte| byte == b'=') else { continue };
            let (key, value) = (line[..equals].trim_ascii(), line[equals + 1..].trim_ascii());
            match key {
                b"NDIME" => dimension = Some(self.dimension(value)?),
                b"NZONE" if self.scan.count(value)? > 1 => {
                    return Err(self.scan.fail("the mesh has several zones; give a file for each of them"));
                }
                b"NELEM" | b"NPOIN" if dimension.is_none() => {
                    return Err(self.scan.fail("NDIME= must come first; write NDIME= 3 above"));
                }
                b"NELEM" => self.elements(value)?,
                b"NPOIN" => self.points(value)?,
                b"MARKER_TAG" => marker = Some(String::from_utf8_lossy(value).into_owned()),
                b"MARKER_ELEMS" => match marker.take() {
                    Some(tag) => self.marker(tag, value)?,
                    None => return Err(self.scan.fail("MARKER_TAG= is missing before it")),
                },
                _ => {}
            }
        }
        if self.mesh.vertices.is_empty() {
            return Err(self.scan.fail("there are no points (NPOIN=); give a mesh of SU2, version 3 to 8"));
        }
        Ok(())
    }

    fn dimension(&mut self, value: &[u8]) -> Result<(), Error> {
        match self.scan.count(value)? {
            3 => Ok(()),
            other => Err(self.scan.fail(format!("NDIME= {other}: meshes in 3D are read; give one"))),
        }
    }

    fn points(&mut self, value: &[u8]) -> Result<(), Error> {
        let count = self.scan.count(value)?;
        if !self.mesh.vertices.is_empty() {
            return Err(self.scan.fail("NPOIN= comes a second time; join the two"));
        }
        let room = self.scan.room(count, 6);
        self.mesh.vertices.reserve_exact(room);
        for _ in 0..count {
            self.mesh.vertices.push(self.scan.reals()?);
            self.scan.line(); // the point's number, which is that of its place
        }
        self.mesh.vertex_refs = vec![0; self.mesh.vertices.len()];
        Ok(())
    }

    fn elements(&mut self, value: &[u8]) -> Result<(), Error> {
        let count = self.scan.count(value)?;
        let room = self.scan.room(count, 10);
        self.mesh.tets.nodes.reserve_exact(room);
        for _ in 0..count {
            match self.scan.int()? {
                TETRAHEDRON => {
                    let nodes = self.scan.vertices(0)?;
                    self.mesh.tets.nodes.push(nodes);
                }
                other => {
                    let kind = stacks::kind_of(other).ok_or_else(|| self.refused(other))?;
                    let nodes = (0..kind.corners()).map(|_| self.scan.vertex(0)).collect::<Result<Vec<u32>, _>>()?;
                    self.stack.cells.push(Cell::new(kind, &nodes, 1));
                }
            }
            self.scan.line(); // the element's number
        }
        self.mesh.tets.refs = vec![1; self.mesh.tets.len()];
        Ok(())
    }

    fn marker(&mut self, tag: String, value: &[u8]) -> Result<(), Error> {
        let count = self.scan.count(value)?;
        let next = self.tags.len() as i32;
        let marker = *self.place.entry(tag.clone()).or_insert(next);
        if tag == PARALLEL {
            self.notices.push(format!("the marker {PARALLEL} is left out"));
        }
        if marker == next {
            self.tags.push(tag);
        }
        for _ in 0..count {
            match self.scan.int()? {
                TRIANGLE => {
                    let nodes = self.scan.vertices(0)?;
                    self.mesh.triangles.push(nodes, marker);
                }
                QUADRILATERAL => {
                    let nodes = self.scan.vertices(0)?;
                    self.stack.quads.push(nodes, marker);
                }
                LINE => {
                    let nodes = self.scan.vertices(0)?;
                    self.mesh.edges.push(nodes, marker);
                }
                VERTEX => {}
                other => return Err(self.refused(other)),
            }
            self.scan.line();
        }
        Ok(())
    }

    fn refused(&self, kind: i64) -> Error {
        self.scan.fail(format!(
            "an element of type {kind}{}: tetrahedra, prisms, pyramids and hexahedra are read, with triangles and quadrilaterals on their \
             boundary; split the others",
            name(kind)
        ))
    }
}

/// Writes cells, the tetrahedra first, points and markers.
pub(super) fn write(batch: &mut Batch, path: &Path, data: &Dataset) -> Result<Vec<String>, Error> {
    let found = data.mesh.triangles.refs.iter().chain(&data.stack.quads.refs).copied().collect();
    let (tags, notices) = markers::tags(&found, &data.names.triangles);
    batch.add_main(path, |to| emit(to, (&data.mesh, &data.stack), &tags))?;
    Ok(notices)
}

fn emit(to: &mut dyn Write, (mesh, stack): (&TetMesh, &Stack), tags: &BTreeMap<i32, String>) -> io::Result<()> {
    let mut text = Text::new(to);
    let mut order: Vec<&String> = Vec::new();
    let (mut of, mut places) = (BTreeMap::new(), BTreeMap::new());
    for (&reference, tag) in tags {
        let place = *places.entry(tag).or_insert(order.len());
        if place == order.len() {
            order.push(tag);
            if *tag != reference.to_string() {
                text.put(format_args!("% {}\n", markers::note(reference, tag)));
            }
        }
        of.insert(reference, place);
    }
    text.put(format_args!("NDIME= 3\nNELEM= {}\n", mesh.tets.len() + stack.cells.len()));
    for (number, nodes) in mesh.tets.nodes.iter().enumerate() {
        text.int(TETRAHEDRON);
        nodes.iter().for_each(|&node| text.int(node));
        text.int(number as i64);
        text.end_line()?;
    }
    for (cell, number) in stack.cells.iter().zip(mesh.tets.len()..) {
        text.int(stacks::number_of(cell.kind));
        cell.nodes().iter().for_each(|&node| text.int(node));
        text.int(number as i64);
        text.end_line()?;
    }
    text.put(format_args!("NPOIN= {}\n", mesh.vertices.len()));
    for (number, point) in mesh.vertices.iter().enumerate() {
        point.iter().for_each(|&x| text.real(x));
        text.int(number as i64);
        text.end_line()?;
    }
    // Triangles by marker, in their order, and quadrilaterals behind them.
    let mut rows: Vec<Vec<(i64, &[u32])>> = vec![Vec::new(); order.len()];
    for (nodes, reference) in mesh.triangles.nodes.iter().zip(&mesh.triangles.refs) {
        rows[of[reference]].push((TRIANGLE, nodes));
    }
    for (nodes, reference) in stack.quads.nodes.iter().zip(&stack.quads.refs) {
        rows[of[reference]].push((QUADRILATERAL, nodes));
    }
    text.put(format_args!("NMARK= {}\n", order.len()));
    for (tag, faces) in order.iter().zip(&rows) {
        text.put(format_args!("MARKER_TAG= {tag}\nMARKER_ELEMS= {}\n", faces.len()));
        for &(kind, nodes) in faces {
            text.int(kind);
            nodes.iter().for_each(|&node| text.int(node));
            text.end_line()?;
        }
    }
    text.finish()
}
