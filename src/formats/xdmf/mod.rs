//! XDMF: XML that says what the arrays of an HDF5 file beside it are, or has them as words. Of FEniCSx (one grid of cells of one kind, and
//! others on the same points for the tags of boundaries; functions, in time or not), of meshio (one grid of mixed cells), of ParaView.
//!
//! We write .xdmf as FEniCSx reads it and .xmf as meshio does. References are the cell array `reference` (or what other programs call so);
//! names are in an Information, as meshio has them: `<main><map key="wall" dim="2">7</map></main>`.
mod grids;
mod items;
mod write;
mod xml;

pub(super) use write::{heavy_path, write};

use super::cells::cells_to_vertices;
use super::vtu::{BY_KIND, REFERENCES, name_pairs, of_array};
use super::{Dataset, NamedField, error};
use crate::geometry::Names;
use crate::mesh::TetMesh;
use crate::mesh::io::{Error, FieldKind, Read};
use crate::tasks::Team;
use grids::{Cell, Data, Grid, Topology, grids};
use items::{Item, Items, Numbers, Place, beside};
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use xml::Element;

/// XDMF's places of our components of a symmetric tensor: it has XX XY XZ YY YZ ZZ, we 11 12 22 13 23 33.
const SYMMETRIC: [usize; 6] = [0, 1, 3, 2, 4, 5];

/// Most values an item of an array that become fields, one each.
const MOST: usize = 16;

/// Most notices.
const MOST_NOTICES: usize = 16;

/// An array as it is gathered: its values at vertices or tetrahedra, NaN where it has none yet.
struct Joined {
    width: usize,
    values: Vec<f64>,
    at_cells: bool,
}

struct Reader<'d> {
    path: &'d Path,
    items: &'d Items<'d>,
    mesh: TetMesh,
    /// The vertices of each set of coordinates: where they begin, how many.
    points: Vec<(Item<'d>, usize, usize)>,
    /// The cells of each topology that was read.
    topologies: Vec<(Item<'d>, Vec<Cell>)>,
    /// Elements by their vertices in ascending order, where there is more than one grid.
    known: HashMap<Vec<u32>, Cell>,
    arrays: BTreeMap<String, Joined>,
    /// Names of the arrays in the order of the file.
    order: Vec<String>,
    notices: Vec<String>,
}

/// Reads a mesh; what it says of HDF5 files is read from these.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Read<Dataset>, Error> {
    let tree = tree(path, bytes)?;
    let mut notices = Vec::new();
    let all = grids(path, &tree, &mut notices)?;
    let items = Items::open(path, all.iter().flat_map(Grid::items))?;
    let mut reader = Reader {
        path,
        items: &items,
        mesh: TetMesh::default(),
        points: Vec::new(),
        topologies: Vec::new(),
        known: HashMap::new(),
        arrays: BTreeMap::new(),
        order: Vec::new(),
        notices,
    };
    let several = all.len() > 1;
    all.iter().try_for_each(|grid| reader.grid(grid, several))?;
    let fields = reader.fields();
    let Reader { mesh, notices, .. } = reader;
    Ok(Read { content: Dataset { mesh, names: names(&tree), fields, ..Dataset::default() }, notices })
}

/// The files that an .xdmf names, as far as it can be read.
pub(super) fn files(path: &Path) -> Vec<PathBuf> {
    let found = || {
        let bytes = error::read(path).ok()?;
        let tree = tree(path, &bytes).ok()?;
        let all = grids(path, &tree, &mut Vec::new()).ok()?;
        let names = all.iter().flat_map(Grid::items).filter_map(|item| match item.place {
            Place::Heavy(name, _) => Some(beside(path, name)),
            Place::Text(_) => None,
        });
        let mut names: Vec<PathBuf> = names.collect();
        names.dedup();
        Some(names)
    };
    found().unwrap_or_default()
}

fn tree<'a>(path: &Path, bytes: &'a [u8]) -> Result<Element<'a>, Error> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        error::at(path, format!("byte {}", error.valid_up_to()), "it is not UTF-8; write the file again")
    })?;
    xml::tree(path, text)
}

impl<'d> Reader<'d> {
    fn grid(&mut self, grid: &Grid<'d>, several: bool) -> Result<(), Error> {
        let (base, points) = self.points(grid)?;
        let at = self.topology(grid, base, points, several)?;
        for data in &grid.data {
            if data.at_cells {
                self.cell_array(grid, data, at)?;
            } else {
                self.point_array(data, base, points)?;
            }
        }
        Ok(())
    }

    /// Where the vertices of a grid begin, and how many they are.
    fn points(&mut self, grid: &Grid<'d>) -> Result<(usize, usize), Error> {
        let (item, width) = &grid.geometry;
        if let Some((_, base, count)) = self.points.iter().find(|(other, ..)| other.place == item.place) {
            return Ok((*base, *count));
        }
        let numbers = self.items.numbers(item)?;
        let base = self.mesh.vertices.len();
        let values = self.items.reals(item, &numbers)?;
        if !values.len().is_multiple_of(*width) {
            return Err(self.items.fail(item, format!("{} coordinates, and a point has {width}", values.len())));
        }
        let point = |row: &[f64]| [row[0], row[1], row.get(2).copied().unwrap_or(0.0)];
        self.mesh.vertices.extend(values.chunks_exact(*width).map(point));
        let count = self.mesh.vertices.len() - base;
        if self.mesh.vertices.len() > u32::MAX as usize {
            return Err(self.items.fail(item, "there are too many points; at most 2^32 - 1 are supported"));
        }
        self.mesh.vertex_refs.resize(self.mesh.vertices.len(), 0);
        self.points.push((item.clone(), base, count));
        Ok((base, count))
    }

    /// Which of the topologies is that of a grid.
    fn topology(&mut self, grid: &Grid<'d>, base: usize, points: usize, several: bool) -> Result<usize, Error> {
        let Topology { item, kind } = &grid.topology;
        if let Some(at) = self.topologies.iter().position(|(other, _)| other.place == item.place) {
            return Ok(at);
        }
        let numbers = self.items.ints(item, &self.items.numbers(item)?)?;
        let wrong = |cell: usize, message: String| {
            error::at(self.path, format!("line {}, cell {}", grid.line, cell + 1), message)
        };
        let mut cells = Vec::new();
        let mut rest = &numbers[..];
        while !rest.is_empty() {
            let at = cells.len();
            let kind = kind.or_else(|| {
                let kind = grids::kind(*rest.first()?);
                rest = &rest[1..];
                kind
            });
            let kind = kind.ok_or_else(|| {
                wrong(at, "tetrahedra, triangles, lines and vertices are read; split the others".into())
            })?;
            if grid.topology.kind.is_none() && kind <= 2 {
                // The number of its nodes precedes them.
                if rest.first() != Some(&(kind as i64)) {
                    return Err(wrong(at, "lines of two nodes and single vertices are read".into()));
                }
                rest = &rest[1..];
            }
            let (nodes, behind) = rest
                .split_at_checked(kind)
                .ok_or_else(|| wrong(at, "its nodes end too early; the file was cut, or is no such topology".into()))?;
            rest = behind;
            let vertex = |&node: &i64| match usize::try_from(node) {
                Ok(node) if node < points => Ok((base + node) as u32),
                _ => Err(wrong(at, format!("it has the point {node}, and there are {points}, counted from 0"))),
            };
            let nodes = nodes.iter().map(vertex).collect::<Result<Vec<u32>, _>>()?;
            let mesh = &mut self.mesh;
            let mut put = || match nodes[..] {
                [a, b, c, d] => {
                    mesh.tets.push([a, b, c, d], 1);
                    Cell::Tet(mesh.tets.len() - 1)
                }
                [a, b, c] => {
                    mesh.triangles.push([a, b, c], 1);
                    Cell::Triangle(mesh.triangles.len() - 1)
                }
                [a, b] => {
                    mesh.edges.push([a, b], 1);
                    Cell::Edge(mesh.edges.len() - 1)
                }
                _ => Cell::Other,
            };
            cells.push(if several {
                let mut key = nodes.clone();
                key.sort_unstable();
                *self.known.entry(key).or_insert_with(put)
            } else {
                put()
            });
        }
        self.topologies.push((item.clone(), cells));
        Ok(self.topologies.len() - 1)
    }

    fn point_array(&mut self, data: &Data<'d>, base: usize, points: usize) -> Result<(), Error> {
        let numbers = self.items.numbers(&data.item)?;
        let Some(width) = self.width(data, &numbers, points)? else { return Ok(()) };
        if self.items.are_said_whole(&data.item, &numbers) {
            if data.name != REFERENCES[0] || width != 1 {
                return self.leave_out(&data.name, "is not of real numbers");
            }
            for (vertex, value) in self.items.ints(&data.item, &numbers)?.into_iter().enumerate() {
                self.mesh.vertex_refs[base + vertex] = self.reference(data, value)?;
            }
            return Ok(());
        }
        let values = self.items.reals(&data.item, &numbers)?;
        let all = self.mesh.vertices.len();
        let joined = self.joined(&data.name, width, false);
        joined.values.resize(all * width, f64::NAN);
        joined.values[base * width..][..values.len()].copy_from_slice(&values);
        Ok(())
    }

    fn cell_array(&mut self, grid: &Grid<'d>, data: &Data<'d>, at: usize) -> Result<(), Error> {
        let cells = std::mem::take(&mut self.topologies[at].1);
        let done = self.array_of_cells(grid, data, &cells);
        self.topologies[at].1 = cells;
        done
    }

    fn array_of_cells(&mut self, grid: &Grid<'d>, data: &Data<'d>, cells: &[Cell]) -> Result<(), Error> {
        let numbers = self.items.numbers(&data.item)?;
        let Some(width) = self.width(data, &numbers, cells.len())? else { return Ok(()) };
        // FEniCSx's tags are a grid of their own, with any name, and do not say that they are whole.
        let is_tag = grid.has_own_cells && grid.data.len() == 1 && self.items.are_whole(&data.item, &numbers);
        let best = REFERENCES.into_iter().find(|name| grid.data.iter().any(|data| data.at_cells && data.name == *name));
        if width == 1 && (is_tag || best == Some(&*data.name)) {
            for (cell, value) in cells.iter().zip(self.items.ints(&data.item, &numbers)?) {
                let reference = self.reference(data, value)?;
                match *cell {
                    Cell::Tet(at) => self.mesh.tets.refs[at] = reference,
                    Cell::Triangle(at) => self.mesh.triangles.refs[at] = reference,
                    Cell::Edge(at) => self.mesh.edges.refs[at] = reference,
                    Cell::Other => {}
                }
            }
            return Ok(());
        }
        if self.items.are_said_whole(&data.item, &numbers) {
            let is_known = REFERENCES.contains(&data.name.as_str()) || BY_KIND.contains(&data.name.as_str());
            return if is_known { Ok(()) } else { self.leave_out(&data.name, "is not of real numbers") };
        }
        let values = self.items.reals(&data.item, &numbers)?;
        let all = self.mesh.tets.len();
        let joined = self.joined(&data.name, width, true);
        joined.values.resize(all * width, f64::NAN);
        for (cell, row) in cells.iter().zip(values.chunks_exact(width)) {
            if let Cell::Tet(at) = *cell {
                joined.values[at * width..][..width].copy_from_slice(row);
            }
        }
        Ok(())
    }

    /// The values an item of an array; none where it is no field.
    fn width(&mut self, data: &Data<'d>, numbers: &Numbers<'_>, items: usize) -> Result<Option<usize>, Error> {
        let count = numbers.count();
        if items == 0 && count == 0 {
            return Ok(None);
        }
        if items == 0 || !count.is_multiple_of(items) || count == 0 {
            let (name, what) = (error::short(&data.name), if data.at_cells { "cells" } else { "points" });
            return Err(self.items.fail(&data.item, format!("{name} has {count} values for {items} {what}")));
        }
        let width = count / items;
        if width > MOST {
            self.leave_out(&data.name, &format!("has {width} values an item"))?;
            return Ok(None);
        }
        Ok(Some(width))
    }

    fn reference(&self, data: &Data<'d>, value: i64) -> Result<i32, Error> {
        i32::try_from(value)
            .map_err(|_| self.items.fail(&data.item, format!("reference {value} does not fit 32 bits; renumber them")))
    }

    /// The array of a name. One of another width, or elsewhere, is begun again.
    fn joined(&mut self, name: &str, width: usize, at_cells: bool) -> &mut Joined {
        if !self.arrays.contains_key(name) {
            self.order.push(name.to_owned());
        }
        let new = || Joined { width, values: Vec::new(), at_cells };
        let joined = self.arrays.entry(name.to_owned()).or_insert_with(new);
        if joined.width != width || joined.at_cells != at_cells {
            *joined = new();
        }
        joined
    }

    fn leave_out(&mut self, name: &str, why: &str) -> Result<(), Error> {
        let notice = format!("the array {} {why} and is left out", error::short(name));
        if !self.notices.contains(&notice) && self.notices.len() < MOST_NOTICES {
            self.notices.push(notice);
        }
        Ok(())
    }

    /// The arrays as fields at the vertices.
    fn fields(&mut self) -> Vec<NamedField> {
        let mut fields = Vec::new();
        for name in std::mem::take(&mut self.order) {
            let Some(Joined { width, mut values, at_cells }) = self.arrays.remove(&name) else { continue };
            if at_cells {
                if self.mesh.tets.is_empty() {
                    continue;
                }
                values.resize(self.mesh.tets.len() * width, f64::NAN);
                values = cells_to_vertices(Team::alone(), &self.mesh, &values, width);
                let name = error::short(&name);
                self.notices.push(format!("{name} was given at cells: their mean about each vertex is taken"));
            }
            values.resize(self.mesh.vertices.len() * width, f64::NAN);
            if width == 6 {
                let values = values.as_chunks::<6>().0.iter().flat_map(|tensor| SYMMETRIC.map(|k| tensor[k])).collect();
                fields.push(NamedField { name, kind: FieldKind::SymmetricTensor, values });
            } else {
                of_array(name, width, values, &mut fields);
            }
        }
        fields
    }
}

/// The names that an Information has.
fn names(tree: &Element<'_>) -> Names {
    let mut names = Names::default();
    let mut open = vec![tree];
    while let Some(element) = open.pop() {
        open.extend(&element.children);
        if element.name != "Information" {
            continue;
        }
        let Ok(inner) = xml::tree(Path::new(""), &element.text) else { continue };
        let Some(main) = inner.all("main").next() else { continue };
        for map in main.all("map") {
            let numbers = [&*map.text, map.get("dim").unwrap_or_default()].map(|word| word.trim().parse().ok());
            if let ([Some(reference), Some(dimension)], Some(name)) = (numbers, map.get("key")) {
                name_pairs(name, 2, &[reference, dimension], &mut names);
            }
        }
    }
    names
}
