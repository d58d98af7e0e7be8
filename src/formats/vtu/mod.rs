//! VTK's unstructured grids (.vtu): of ParaView, PyVista, meshio, SU2. References are the cell array `reference` (or what other
//! programs call so); names are arrays of FieldData, as meshio keeps gmsh's: name → reference and dimension, one pair after the other.
mod decode;
pub mod pieces;
mod write;
mod xml;

pub(super) use write::{by_kind, by_name, to_vtk, write};

use super::cells::cells_to_vertices;
use super::format::vtk::{self, LINE, QUADRILATERAL, TETRAHEDRON, TRIANGLE, VERTEX};
use super::{Dataset, NamedField, error, stacks};
use crate::geometry::{Label, Names};
use crate::mesh::TetMesh;
use crate::mesh::io::{Error, FieldKind, Read};
use crate::mesh::stack::{Cell, Stack};
use crate::tasks::Team;
use decode::Decoder;
use std::collections::BTreeMap;
use std::path::Path;
use xml::{Array, Kind, Piece};

/// What the references of cells are called: by us, by meshio for libMeshb's, gmsh's and SU2's files, by VMTK.
pub(super) const REFERENCES: [&str; 6] =
    ["reference", "medit:ref", "gmsh:physical", "gmsh:geometrical", "su2:tag", "CellEntityIds"];

/// References of tetrahedra, triangles and edges alone, beside those of all cells, 0 for the others: a program that draws one kind of cells
/// has them apart.
pub(super) const BY_KIND: [&str; 3] = ["region", "surface", "edge"];

/// Most values an item of an array that become fields, one each.
const MOST: usize = 16;

/// Most numbers of an array of FieldData that is looked at for names.
const MOST_NAMED: usize = 1 << 16;

/// VTK's places of our components of a symmetric tensor: it has XX YY ZZ XY YZ XZ, we 11 12 22 13 23 33.
const SYMMETRIC: [usize; 6] = [0, 3, 1, 5, 4, 2];

/// An array of all pieces: its values at the points, or at the tetrahedra.
struct Joined {
    width: usize,
    values: Vec<f64>,
}

struct Reader<'d, 'a> {
    path: &'d Path,
    decoder: Decoder<'d, 'a>,
    reference: Option<String>,
    mesh: TetMesh,
    stack: Stack,
    at_points: BTreeMap<String, Joined>,
    at_tets: BTreeMap<String, Joined>,
    /// At the cells of the stack, of each array of `at_tets`.
    at_stack: BTreeMap<String, Vec<f64>>,
    /// Names of the arrays in the order of the file, points before cells.
    order: Vec<String>,
    notices: Vec<String>,
}

/// Reads a grid.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Read<Dataset>, Error> {
    let document = xml::document(path, bytes)?;
    let has = |name: &str| {
        document
            .pieces
            .iter()
            .filter(|piece| piece.cells > 0)
            .all(|piece| piece.cell_data.iter().any(|array| array.name == name))
    };
    let mut reader = Reader {
        path,
        decoder: Decoder::new(path, &document),
        reference: REFERENCES.into_iter().find(|name| has(name)).map(String::from),
        mesh: TetMesh::default(),
        stack: Stack::default(),
        at_points: BTreeMap::new(),
        at_tets: BTreeMap::new(),
        at_stack: BTreeMap::new(),
        order: Vec::new(),
        notices: Vec::new(),
    };
    for piece in &document.pieces {
        reader.piece(piece)?;
    }
    stacks::join(path, &mut reader.mesh, &mut reader.stack, &mut reader.notices)?;
    let names = reader.names(&document.field_data)?;
    let fields = reader.fields();
    let Reader { mesh, stack, notices, .. } = reader;
    Ok(Read { content: Dataset { mesh, stack, names, fields }, notices })
}

impl<'a> Reader<'_, 'a> {
    fn piece(&mut self, piece: &Piece<'a>) -> Result<(), Error> {
        let base = self.mesh.vertices.len();
        if piece.points > 0 {
            let [coordinates] = &piece.coordinates[..] else {
                return Err(error::at(self.path, "Points", "one array is expected in it"));
            };
            if coordinates.width != 3 {
                return Err(self.decoder.fail(coordinates, "three coordinates a point are expected"));
            }
            let points = self.decoder.reals(coordinates, piece.points)?;
            self.mesh.vertices.extend_from_slice(points.as_chunks::<3>().0);
        }
        if self.mesh.vertices.len() > u32::MAX as usize {
            return Err(error::at(self.path, "Points", "there are too many; at most 2^32 - 1 are supported"));
        }
        self.mesh.vertex_refs.resize(self.mesh.vertices.len(), 0);
        for array in &piece.point_data {
            self.point_array(array, base, piece.points)?;
        }
        if piece.cells > 0 {
            self.cells(piece, base)?;
        }
        Ok(())
    }

    fn point_array(&mut self, array: &Array<'a>, base: usize, points: usize) -> Result<(), Error> {
        match array.kind {
            Kind::Real(_) if array.width > MOST => self.skip_wide(array),
            Kind::Real(_) => {
                let values = self.decoder.reals(array, points)?;
                self.join(array, values, true);
            }
            Kind::Int(_) | Kind::Unsigned(_) if array.name == REFERENCES[0] && array.width == 1 => {
                let values = self.decoder.ints(array, points)?;
                for (vertex, value) in values.into_iter().enumerate() {
                    self.mesh.vertex_refs[base + vertex] = self.reference(array, value)?;
                }
            }
            _ => self.skip(array),
        }
        Ok(())
    }

    /// Tells once that an array is not read.
    fn skip(&mut self, array: &Array) {
        if !array.name.starts_with("vtk") {
            self.leave_out(array, "is not of real numbers");
        }
    }

    /// Whether an array can be a field. Others are not unpacked: they may be a thousand times as large as the file.
    fn skip_wide(&mut self, array: &Array) {
        self.leave_out(array, &format!("has {} values an item", array.width));
    }

    fn leave_out(&mut self, array: &Array, why: &str) {
        let notice = format!("the array {} {why} and is left out", error::short(&array.name));
        if !self.notices.contains(&notice) && self.notices.len() < MOST {
            self.notices.push(notice);
        }
    }

    fn reference(&self, array: &Array, value: i64) -> Result<i32, Error> {
        i32::try_from(value)
            .map_err(|_| self.decoder.fail(array, format!("reference {value} does not fit 32 bits; renumber them")))
    }

    /// Appends the values of a piece.
    fn join(&mut self, array: &Array, values: Vec<f64>, at_points: bool) {
        if !self.at_points.contains_key(&array.name) && !self.at_tets.contains_key(&array.name) {
            self.order.push(array.name.clone());
        }
        let of = if at_points { &mut self.at_points } else { &mut self.at_tets };
        let joined = of.entry(array.name.clone()).or_insert(Joined { width: array.width, values: Vec::new() });
        if joined.width == array.width {
            if joined.values.is_empty() {
                joined.values = values;
            } else {
                joined.values.extend(values);
            }
        }
    }

    fn cells(&mut self, piece: &Piece<'a>, base: usize) -> Result<(), Error> {
        let array = |name: &str| {
            let found = piece.topology.iter().find(|array| array.name == name);
            found.ok_or_else(|| error::at(self.path, "Cells", format!("the array {name} is missing")))
        };
        let (nodes, offsets, types) = (array("connectivity")?, array("offsets")?, array("types")?);
        let types = self.decoder.ints(types, piece.cells)?;
        let ends = self.decoder.ints(offsets, piece.cells)?;
        let total = ends.last().and_then(|&end| usize::try_from(end).ok()).unwrap_or(usize::MAX);
        let all = self.decoder.ints(nodes, total)?;
        let references = match &self.reference {
            Some(name) => piece.cell_data.iter().find(|array| array.name == *name),
            None => None,
        };
        let of_cells = references.map(|array| Ok((array, self.decoder.ints(array, piece.cells)?))).transpose()?;
        let mut start = 0;
        for (cell, (&kind, &end)) in types.iter().zip(&ends).enumerate() {
            let wrong =
                |message: String| error::at(self.path, format!("cell {} of {}", cell + 1, piece.cells), message);
            let end = usize::try_from(end).ok().filter(|&end| start <= end && end <= all.len());
            let end = end.ok_or_else(|| wrong("the offsets do not ascend; write the file again".into()))?;
            let cell_nodes = &all[start..end];
            start = end;
            let reference = match &of_cells {
                Some((array, values)) => self.reference(array, values[cell])?,
                None => 1,
            };
            let vertex = |node: i64| match usize::try_from(node) {
                Ok(node) if node < piece.points => Ok((base + node) as u32),
                _ => Err(wrong(format!("it has the point {node}, and there are {}, counted from 0", piece.points))),
            };
            match (kind, cell_nodes) {
                (TETRAHEDRON, &[a, b, c, d]) => {
                    self.mesh.tets.push([vertex(a)?, vertex(b)?, vertex(c)?, vertex(d)?], reference)
                }
                (TRIANGLE, &[a, b, c]) => self.mesh.triangles.push([vertex(a)?, vertex(b)?, vertex(c)?], reference),
                (QUADRILATERAL, &[a, b, c, d]) => {
                    self.stack.quads.push([vertex(a)?, vertex(b)?, vertex(c)?, vertex(d)?], reference)
                }
                (LINE, &[a, b]) => self.mesh.edges.push([vertex(a)?, vertex(b)?], reference),
                (VERTEX, _) => {}
                (TETRAHEDRON | TRIANGLE | QUADRILATERAL | LINE, nodes) => {
                    return Err(wrong(format!("a cell of type {kind} with {} points", nodes.len())));
                }
                (_, nodes) => match stacks::kind_of(kind) {
                    Some(of) if of.corners() == nodes.len() => {
                        let nodes = nodes.iter().map(|&node| vertex(node)).collect::<Result<Vec<u32>, _>>()?;
                        self.stack.cells.push(Cell::new(of, &nodes, reference));
                    }
                    Some(_) => return Err(wrong(format!("a cell of type {kind} with {} points", nodes.len()))),
                    None => {
                        let name = vtk::name(kind);
                        return Err(wrong(format!(
                            "a cell of type {kind}{name}: tetrahedra, prisms, pyramids, hexahedra, triangles, quadrilaterals and lines are read; split \
                             the others"
                        )));
                    }
                },
            }
        }
        self.cell_arrays(piece, &types)
    }

    /// The values of the tetrahedra and of the stack's cells.
    fn cell_arrays(&mut self, piece: &Piece<'a>, types: &[i64]) -> Result<(), Error> {
        for array in &piece.cell_data {
            match array.kind {
                Kind::Real(_) if array.width > MOST => self.skip_wide(array),
                Kind::Real(_) => {
                    let values = self.decoder.reals(array, piece.cells)?;
                    let rows = || values.chunks_exact(array.width).zip(types);
                    let of_tets = rows().filter(|(_, kind)| **kind == TETRAHEDRON);
                    let of_stack = rows().filter(|(_, kind)| stacks::kind_of(**kind).is_some());
                    self.at_stack.entry(array.name.clone()).or_default().extend(of_stack.flat_map(|(row, _)| row));
                    self.join(array, of_tets.flat_map(|(row, _)| row).copied().collect(), false);
                }
                _ if REFERENCES.contains(&array.name.as_str()) || BY_KIND.contains(&array.name.as_str()) => {}
                _ => self.skip(array),
            }
        }
        Ok(())
    }

    /// The names that FieldData holds.
    fn names(&mut self, arrays: &[Array<'a>]) -> Result<Names, Error> {
        let mut names = Names::default();
        for array in arrays.iter().filter(|array| matches!(array.kind, Kind::Int(_)) && !array.name.is_empty()) {
            let Some(pairs) = self.decoder.few_ints(array, MOST_NAMED)? else { continue };
            name_pairs(&array.name, array.width, &pairs, &mut names);
        }
        Ok(names)
    }

    /// The fields: those at points, and those at tetrahedra where there is none of the name.
    fn fields(&mut self) -> Vec<NamedField> {
        let mut fields = Vec::new();
        let order = std::mem::take(&mut self.order);
        let with_tets = !self.mesh.tets.is_empty();
        let cells =
            if self.stack.is_empty() { self.mesh.tets.len() } else { self.stack.own()[0] + self.stack.cells.len() };
        for name in order {
            let (mut joined, is_cells) = match self.at_points.remove(&name) {
                Some(joined) => (joined, false),
                None => match self.at_tets.remove(&name) {
                    Some(joined) if with_tets => (joined, true),
                    _ => continue,
                },
            };
            if is_cells {
                joined.values.extend(self.at_stack.remove(&name).unwrap_or_default());
            }
            let items = if is_cells { cells } else { self.mesh.vertices.len() };
            if joined.values.len() != items * joined.width {
                self.notices.push(format!("the array {} is not in all pieces and is left out", error::short(&name)));
                continue;
            }
            let Joined { width, mut values } = joined;
            if is_cells {
                values = if self.stack.is_empty() { values } else { self.stack.spread(values, width) };
                values = cells_to_vertices(Team::alone(), &self.mesh, &values, width);
                self.notices
                    .push(format!("{} was given at cells: their mean about each vertex is taken", error::short(&name)));
            }
            of_array(name, width, values, &mut fields);
        }
        fields
    }
}

/// Adds what an array of field data says, if it is pairs of reference and dimension: that these are called as it is.
pub(super) fn name_pairs(name: &str, width: usize, pairs: &[i64], names: &mut Names) {
    if !pairs.len().is_multiple_of(2) || (width != 2 && pairs.len() != 2) {
        return;
    }
    for &[reference, dimension] in pairs.as_chunks::<2>().0 {
        let of = match dimension {
            1 => &mut names.edges,
            2 => &mut names.triangles,
            3 => &mut names.tetrahedra,
            _ => continue,
        };
        if let Ok(reference) = i32::try_from(reference) {
            of.insert(reference, Label { name: Some(name.to_owned()), colour: None });
        }
    }
}

/// Fields of an array, by its values an item.
pub(super) fn of_array(name: String, width: usize, values: Vec<f64>, fields: &mut Vec<NamedField>) {
    let kind = match width {
        1 => FieldKind::Scalar,
        2 | 3 => FieldKind::Vector,
        6 => FieldKind::SymmetricTensor,
        9 => FieldKind::Tensor,
        _ => {
            for component in 0..width {
                let values = values.iter().skip(component).step_by(width).copied().collect();
                fields.push(NamedField { name: format!("{name} {}", component + 1), kind: FieldKind::Scalar, values });
            }
            return;
        }
    };
    let values = match width {
        2 => values.as_chunks::<2>().0.iter().flat_map(|&[x, y]| [x, y, 0.0]).collect(),
        6 => values.as_chunks::<6>().0.iter().flat_map(|tensor| SYMMETRIC.map(|i| tensor[i])).collect(),
        _ => values,
    };
    fields.push(NamedField { name, kind, values });
}
