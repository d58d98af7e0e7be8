//! VTK's legacy files (.vtk), as text and binary, versions 1 to 5.1: unstructured grids, and the polygons of a surface. Source: "VTK File
//! Formats" in VTK's documentation, and for version 5.1 the release notes of VTK 9. Names and references are those of .vtu.
mod values;
mod write;

pub(super) use write::write;

use super::cells::cells_to_vertices;
use super::format::vtk::{LINE, TETRAHEDRON, TRIANGLE, VERTEX, name};
use super::scan::Scan;
use super::vtu::{BY_KIND, REFERENCES, name_pairs, of_array};
use super::{Dataset, error};
use crate::mesh::TetMesh;
use crate::mesh::io::{Error, Read};
use crate::tasks::Team;
use std::path::Path;
use values::{Kind, Source, decoded};

/// What VTK calls a polygon.
const POLYGON: i64 = 7;

/// Most values an item of an array that becomes fields.
const MOST: usize = 16;

/// Most arrays that are told to be left out.
const MOST_TOLD: usize = 16;

/// What the next arrays belong to.
#[derive(Clone, Copy, PartialEq)]
enum At {
    /// The whole grid: names.
    Grid,
    Points,
    Cells,
}

/// An array of values at points or cells.
struct Array {
    name: String,
    at: At,
    width: usize,
    is_real: bool,
    values: Vec<f64>,
}

struct Reader<'a> {
    path: &'a Path,
    source: Source<'a>,
    /// Whether cells are offsets and connectivity, as since version 5.
    has_offsets: bool,
    data: Dataset,
    /// Nodes of all cells, and where those of each end.
    nodes: Vec<i64>,
    ends: Vec<usize>,
    types: Vec<i64>,
    arrays: Vec<Array>,
    at: At,
    /// Items of the arrays.
    items: usize,
    notices: Vec<String>,
}

/// Reads a grid.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Read<Dataset>, Error> {
    let mut scan = Scan::new(path, bytes);
    let head = scan.line().unwrap_or_default();
    let version = String::from_utf8_lossy(head.strip_prefix(b"# vtk DataFile Version ").unwrap_or_default());
    let Ok(version) = version.trim().parse::<f64>() else {
        return Err(scan.fail("`# vtk DataFile Version 3.0` is expected; give a legacy file of VTK, or a .vtu"));
    };
    scan.line(); // the title
    let is_text = match scan.line().unwrap_or_default().to_ascii_uppercase().as_slice() {
        b"ASCII" => true,
        b"BINARY" => false,
        _ => return Err(scan.fail("ASCII or BINARY is expected here; write the file again")),
    };
    let mut reader = Reader {
        path,
        source: Source { scan, is_text },
        has_offsets: version >= 5.0,
        data: Dataset::default(),
        nodes: Vec::new(),
        ends: Vec::new(),
        types: Vec::new(),
        arrays: Vec::new(),
        at: At::Grid,
        items: 0,
        notices: Vec::new(),
    };
    reader.sections()?;
    reader.elements()?;
    reader.fields();
    let Reader { data, notices, .. } = reader;
    Ok(Read { content: data, notices })
}

impl<'a> Reader<'a> {
    fn sections(&mut self) -> Result<(), Error> {
        while let Some(line) = self.source.scan.line() {
            let line = String::from_utf8_lossy(line).into_owned();
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            let Some(key) = words.first() else { continue };
            match (key.to_ascii_uppercase().as_str(), &words[1..]) {
                ("DATASET", [kind]) => match kind.to_ascii_uppercase().as_str() {
                    "UNSTRUCTURED_GRID" | "POLYDATA" => {}
                    _ => {
                        return Err(self.fail(format!(
                            "a dataset {}: UNSTRUCTURED_GRID and POLYDATA are read",
                            error::short(kind)
                        )));
                    }
                },
                ("POINTS", [count, kind]) => self.points(count, kind)?,
                ("CELLS", [count, total]) => self.cells(count, total, None)?,
                ("VERTICES", [count, total]) => self.cells(count, total, Some(VERTEX))?,
                ("LINES", [count, total]) => self.cells(count, total, Some(LINE))?,
                ("POLYGONS", [count, total]) => self.cells(count, total, Some(POLYGON))?,
                ("CELL_TYPES", [count]) => {
                    let count = self.count(count)?;
                    self.types = self.source.ints(Kind::Int(4), count)?;
                }
                ("POINT_DATA", [count]) => (self.at, self.items) = (At::Points, self.count(count)?),
                ("CELL_DATA", [count]) => (self.at, self.items) = (At::Cells, self.count(count)?),
                ("FIELD", [_, count]) => self.field(count)?,
                ("SCALARS", [name, kind, rest @ ..]) => {
                    let width = rest.first().map_or(Ok(1), |width| self.count(width))?;
                    self.values(name, kind, width, self.items)?;
                }
                ("LOOKUP_TABLE", [_]) => {} // the one of the scalars that follow
                ("LOOKUP_TABLE", [name, count]) => {
                    let count = self.count(count)?;
                    self.colours(name, 4, count)?;
                }
                ("COLOR_SCALARS", [name, width]) => {
                    let width = self.count(width)?;
                    self.colours(name, width, self.items)?;
                }
                ("VECTORS" | "NORMALS", [name, kind]) => self.values(name, kind, 3, self.items)?,
                ("TENSORS", [name, kind]) => self.values(name, kind, 9, self.items)?,
                ("TENSORS6", [name, kind]) => self.values(name, kind, 6, self.items)?,
                ("GLOBAL_IDS" | "PEDIGREE_IDS", [name, kind]) => self.values(name, kind, 1, self.items)?,
                ("TEXTURE_COORDINATES", [name, width, kind]) => {
                    let width = self.count(width)?;
                    self.values(name, kind, width, self.items)?;
                }
                ("METADATA", []) => while self.source.scan.line().is_some_and(|line| !line.is_empty()) {},
                (_, _) => {
                    let message = format!("'{}' is no section of VTK's legacy files that is read", error::short(&line));
                    return Err(self.fail(message));
                }
            }
        }
        Ok(())
    }

    fn fail(&self, message: impl Into<String>) -> Error {
        self.source.fail(message)
    }

    fn count(&self, word: &str) -> Result<usize, Error> {
        self.source.scan.count(word.as_bytes())
    }

    fn kind(&self, word: &str) -> Result<Kind, Error> {
        Kind::of(word)
            .ok_or_else(|| self.fail(format!("values of type {} are not read; leave them out", error::short(word))))
    }

    fn points(&mut self, count: &str, kind: &str) -> Result<(), Error> {
        let (count, kind) = (self.count(count)?, self.kind(kind)?);
        if !self.data.mesh.vertices.is_empty() {
            return Err(self.fail("POINTS come a second time; join the two"));
        }
        let values = self.source.reals(kind, count.saturating_mul(3))?;
        self.data.mesh.vertices = values.as_chunks::<3>().0.to_vec();
        self.data.mesh.vertex_refs = vec![0; self.data.mesh.vertices.len()];
        Ok(())
    }

    /// Cells, of one type where that is told.
    fn cells(&mut self, count: &str, total: &str, kind: Option<i64>) -> Result<(), Error> {
        let (count, total) = (self.count(count)?, self.count(total)?);
        let before = self.ends.len();
        if self.has_offsets {
            let offsets = self.part("OFFSETS", count)?;
            let nodes = self.part("CONNECTIVITY", total)?;
            let first = self.nodes.len();
            for pair in offsets.windows(2) {
                let end = usize::try_from(pair[1]).ok().filter(|&end| pair[0] <= pair[1] && end <= nodes.len());
                let end =
                    end.ok_or_else(|| self.fail("the offsets of the cells do not ascend; write the file again"))?;
                self.ends.push(first + end);
            }
            self.nodes.extend(nodes);
        } else {
            let list = self.source.ints(Kind::Int(4), total)?;
            let mut rest = &list[..];
            for _ in 0..count {
                let cut = rest.split_first().and_then(|(&n, rest)| rest.split_at_checked(usize::try_from(n).ok()?));
                let Some((nodes, left)) = cut else {
                    return Err(self.fail("the list of the cells is too short for their number; write the file again"));
                };
                self.nodes.extend(nodes);
                self.ends.push(self.nodes.len());
                rest = left;
            }
        }
        if let Some(kind) = kind {
            self.types.extend(std::iter::repeat_n(kind, self.ends.len() - before));
        }
        Ok(())
    }

    /// A part of the cells, with its name and type before it.
    fn part(&mut self, name: &str, count: usize) -> Result<Vec<i64>, Error> {
        let mut line = self.source.scan.line();
        while line.is_some_and(<[u8]>::is_empty) {
            line = self.source.scan.line();
        }
        let line = String::from_utf8_lossy(line.unwrap_or_default()).into_owned();
        match line.split_once(' ') {
            Some((key, kind)) if key.eq_ignore_ascii_case(name) => {
                let kind = self.kind(kind.trim())?;
                self.source.ints(kind, count)
            }
            _ => Err(self.fail(format!("{name} and a type are expected here, as in version 5.1"))),
        }
    }

    /// Arrays, each with its width and items.
    fn field(&mut self, count: &str) -> Result<(), Error> {
        for _ in 0..self.count(count)? {
            let mut line = self.source.scan.line();
            while line.is_some_and(|line| line.is_empty() || line.starts_with(b"METADATA")) {
                if line.is_some_and(|line| !line.is_empty()) {
                    while self.source.scan.line().is_some_and(|line| !line.is_empty()) {}
                }
                line = self.source.scan.line();
            }
            let line = String::from_utf8_lossy(line.unwrap_or_default()).into_owned();
            match line.split_ascii_whitespace().collect::<Vec<_>>()[..] {
                [name, width, items, kind] => {
                    let (width, items) = (self.count(width)?, self.count(items)?);
                    self.values(name, kind, width, items)?;
                }
                // An array without a name and values.
                ["NULL_ARRAY"] => {}
                _ => return Err(self.fail("name, width, number and type of an array are expected here")),
            }
        }
        Ok(())
    }

    fn values(&mut self, name: &str, kind: &str, width: usize, items: usize) -> Result<(), Error> {
        let (name, kind) = (decoded(name), self.kind(kind)?);
        // The lookup table of scalars stands between their head and their values.
        self.source.skip_line(b"LOOKUP_TABLE");
        let values = self.source.reals(kind, width.saturating_mul(items))?;
        if self.at == At::Grid {
            if matches!(kind, Kind::Int(_)) {
                let pairs: Vec<i64> = values.iter().map(|&value| value as i64).collect();
                name_pairs(&name, width, &pairs, &mut self.data.names);
            }
        } else {
            self.arrays.push(Array { name, at: self.at, width, is_real: matches!(kind, Kind::Real(_)), values });
        }
        Ok(())
    }

    /// Colours are passed over: bytes in binary files, numbers in texts.
    fn colours(&mut self, name: &str, width: usize, items: usize) -> Result<(), Error> {
        self.source.reals(Kind::Unsigned(1), width.saturating_mul(items))?;
        self.tell(name, "is of colours");
        Ok(())
    }

    fn tell(&mut self, name: &str, why: &str) {
        if self.notices.len() < MOST_TOLD {
            self.notices.push(format!("the array {} {why} and is left out", error::short(name)));
        }
    }

    /// From cells to elements with their references.
    fn elements(&mut self) -> Result<(), Error> {
        let (cells, points) = (self.ends.len(), self.data.mesh.vertices.len());
        if self.types.len() != cells {
            let message = format!("{} types for {cells} cells (CELL_TYPES); write the file again", self.types.len());
            return Err(error::at(self.path, "CELL_TYPES", message));
        }
        let is_reference = |array: &&Array, name: &str| array.at == At::Cells && array.name == name && array.width == 1;
        let references = REFERENCES.iter().find_map(|name| self.arrays.iter().find(|array| is_reference(array, name)));
        let mesh = &mut self.data.mesh;
        let mut start = 0;
        for (cell, (&kind, &end)) in self.types.iter().zip(&self.ends).enumerate() {
            let wrong = |message: String| error::at(self.path, format!("cell {} of {cells}", cell + 1), message);
            let vertex = |node: i64| match usize::try_from(node) {
                Ok(node) if node < points => Ok(node as u32),
                _ => Err(wrong(format!("it has the point {node}, and there are {points}, counted from 0"))),
            };
            let value = references.map_or(Some(1.0), |array| array.values.get(cell).copied());
            let reference = value.filter(|value| *value == f64::from(*value as i32)).map(|value| value as i32);
            let reference =
                reference.ok_or_else(|| wrong("its reference does not fit 32 bits; renumber them".into()))?;
            let nodes = self.nodes.get(start..end).unwrap_or_default();
            start = end;
            match (kind, nodes) {
                (TETRAHEDRON, &[a, b, c, d]) => {
                    mesh.tets.push([vertex(a)?, vertex(b)?, vertex(c)?, vertex(d)?], reference)
                }
                (TRIANGLE | POLYGON, &[a, b, c]) => {
                    mesh.triangles.push([vertex(a)?, vertex(b)?, vertex(c)?], reference)
                }
                (LINE, &[a, b]) => mesh.edges.push([vertex(a)?, vertex(b)?], reference),
                (VERTEX | 2, _) => {}
                _ => {
                    let (name, count) = (name(kind), nodes.len());
                    return Err(wrong(format!(
                        "a cell of type {kind}{name} with {count} points: tetrahedra, triangles and lines are read; split the others"
                    )));
                }
            }
        }
        Ok(())
    }

    /// From arrays to fields: those at points, and those at tetrahedra where there is none of the name.
    fn fields(&mut self) {
        let mut arrays = std::mem::take(&mut self.arrays);
        // Files may have those of cells first.
        arrays.sort_by_key(|array| array.at == At::Cells);
        let at_points = |name: &str| arrays.iter().any(|array| array.at == At::Points && array.name == name);
        for array in &arrays {
            let Array { name, at, width, is_real, values } = array;
            let is_cells = *at == At::Cells;
            let items = if is_cells { self.types.len() } else { self.data.mesh.vertices.len() };
            if !is_real {
                self.whole_numbers(array);
            } else if *width == 0 || *width > MOST || values.len() != items * width {
                self.tell(name, &format!("has {width} values an item, or not one item for each point or cell"));
            } else if !is_cells {
                of_array(name.clone(), *width, values.clone(), &mut self.data.fields);
            } else if !at_points(name) && !self.data.mesh.tets.is_empty() {
                let rows = values.chunks_exact(*width).zip(&self.types).filter(|(_, kind)| **kind == TETRAHEDRON);
                let of_tets: Vec<f64> = rows.flat_map(|(row, _)| row).copied().collect();
                let values = cells_to_vertices(Team::alone(), &self.data.mesh, &of_tets, *width);
                of_array(name.clone(), *width, values, &mut self.data.fields);
                self.notices
                    .push(format!("{} was given at cells: their mean about each vertex is taken", error::short(name)));
            }
        }
    }

    /// References of vertices; other whole numbers are no fields.
    fn whole_numbers(&mut self, array: &Array) {
        let TetMesh { vertex_refs, vertices, .. } = &mut self.data.mesh;
        let is_known = REFERENCES.contains(&array.name.as_str()) || BY_KIND.contains(&array.name.as_str());
        if array.at == At::Cells && is_known {
            return;
        }
        if array.at == At::Points && array.name == REFERENCES[0] && array.values.len() == vertices.len() {
            *vertex_refs = array.values.iter().map(|&value| value as i32).collect();
        } else if !array.name.starts_with("vtk") {
            self.tell(&array.name, "is not of real numbers");
        }
    }
}
