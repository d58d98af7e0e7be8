//! CGNS in its HDF5 form: nodes are groups with the attributes `name`, `label` and `type`, and their numbers are the dataset ` data`
//! (CGNS/HDF5 File Mapping Manual). Unstructured zones of tetrahedra, pyramids, prisms, hexahedra, triangles, quadrilaterals and lines are read.
//!
//! Boundaries are conditions (BC_t), called as their family or themselves; what is in none is called as its section (Elements_t). In our
//! files each section has the reference in a Descriptor_t.
mod boundary;
mod fields;
mod sections;
mod write;

pub(super) use write::write;

use super::hdf5::{Hdf5, MAGIC, attribute, damaged};
use super::{Dataset, error, stacks};
use crate::geometry::{Label, Names};
use crate::mesh::TetMesh;
use crate::mesh::io::{Error, Read};
use hdf5_pure::Group;
use std::collections::BTreeMap;
use std::path::Path;

/// What CGNS calls elements.
pub(super) mod kind {
    use crate::mesh::stack::Kind;

    pub const NODE: i64 = 2;
    pub const BAR_2: i64 = 3;
    pub const TRI_3: i64 = 5;
    pub const QUAD_4: i64 = 7;
    pub const TETRA_4: i64 = 10;
    pub const PYRA_5: i64 = 12;
    pub const PENTA_6: i64 = 14;
    pub const HEXA_8: i64 = 17;
    pub const MIXED: i64 = 20;

    /// The numbers of cells that are no tetrahedra.
    pub const OF_STACK: [(i64, Kind); 3] =
        [(PYRA_5, Kind::Pyramid), (PENTA_6, Kind::Prism), (HEXA_8, Kind::Hexahedron)];

    /// The kind of such cells.
    pub fn of_stack(number: i64) -> Option<Kind> {
        OF_STACK.into_iter().find(|(other, _)| *other == number).map(|(_, kind)| kind)
    }

    /// How many nodes an element has that is read.
    pub fn nodes(number: i64) -> Option<usize> {
        match number {
            TETRA_4 | QUAD_4 => Some(4),
            TRI_3 => Some(3),
            BAR_2 => Some(2),
            NODE => Some(1),
            _ => of_stack(number).map(Kind::corners),
        }
    }
}

/// The descriptors of our sections.
const REFERENCE: &str = "Reference";
const NAME: &str = "Name";

/// A node of the tree.
struct Node<'h> {
    file: &'h Hdf5,
    group: Group,
    name: String,
    label: String,
}

impl<'h> Node<'h> {
    /// The nodes below this one.
    fn children(&self) -> Result<Vec<Node<'h>>, Error> {
        let groups = self.group.iter_groups().map_err(|error| self.fail(damaged(&error)))?;
        Ok(groups
            .map(|(name, group)| Node {
                label: attribute(&group, "label").unwrap_or_default(),
                file: self.file,
                group,
                name,
            })
            .collect())
    }

    /// Those with a label.
    fn labelled(&self, label: &str) -> Result<Vec<Node<'h>>, Error> {
        Ok(self.children()?.into_iter().filter(|child| child.label == label).collect())
    }

    /// The one of a name.
    fn child(&self, name: &str) -> Option<Node<'h>> {
        let group = self.group.group(name).ok()?;
        Some(Node {
            label: attribute(&group, "label").unwrap_or_default(),
            file: self.file,
            group,
            name: name.to_owned(),
        })
    }

    fn ints(&self) -> Result<Vec<i64>, Error> {
        self.file.array_of(&self.name, self.data()?)?.ints()
    }

    fn reals(&self) -> Result<Vec<f64>, Error> {
        self.file.array_of(&self.name, self.data()?)?.reals()
    }

    fn text(&self) -> Result<String, Error> {
        self.file.text(&self.name, self.data()?)
    }

    /// The text of a child, where there is one.
    fn text_of(&self, child: &str) -> Option<String> {
        self.child(child)?.text().ok()
    }

    fn data(&self) -> Result<hdf5_pure::Dataset, Error> {
        self.group.dataset(" data").map_err(|error| self.fail(damaged(&error)))
    }

    fn fail(&self, message: impl Into<String>) -> Error {
        self.file.fail(&self.name, message)
    }
}

/// Elements that have numbers in a zone, from `first`.
struct Section {
    name: String,
    first: i64,
    /// Where each element is in the mesh.
    elements: Vec<Element>,
    /// In our own files.
    reference: Option<i32>,
    called: Option<String>,
}

/// An element of the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Element {
    Tet(usize),
    Cell(usize),
    Triangle(usize),
    Quad(usize),
    Edge(usize),
    Other,
}

/// Reads a file.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Read<Dataset>, Error> {
    if !bytes.starts_with(MAGIC) {
        let message = "no CGNS file on HDF5; an older one, on ADF, becomes one by: cgnsconvert -h OLD NEW";
        return Err(error::at(path, "byte 0", message));
    }
    let file = Hdf5::of_bytes(path, bytes.to_vec())?;
    let root = Node { file: &file, group: file.root(), name: "/".into(), label: String::new() };
    let mut zones = Vec::new();
    for base in root.labelled("CGNSBase_t")? {
        zones.extend(base.labelled("Zone_t")?);
    }
    let mut data = Dataset::default();
    let mut notices = Vec::new();
    let mut labels = Labels::default();
    let mut parts = Vec::new();
    for zone in &zones {
        let base = data.mesh.vertices.len();
        coordinates(zone, &mut data.mesh)?;
        let sections = sections::read(zone, base, &mut data)?;
        boundary::refer(zone, base, &sections, &mut data, &mut labels)?;
        parts.push((zone, base..data.mesh.vertices.len(), sections));
    }
    if parts.is_empty() {
        return Err(error::at(path, "CGNSBase_t", "there is no Zone_t in it"));
    }
    if parts.len() > 1 {
        notices.push(format!("{}: {} zones; points that they share are not joined", path.display(), parts.len()));
    }
    stacks::join(path, &mut data.mesh, &mut data.stack, &mut notices)?;
    data.fields = fields::read(&parts, &data, &mut notices)?;
    data.names = labels.names;
    Ok(Read { content: data, notices })
}

/// References that are given as names are met.
#[derive(Default)]
struct Labels {
    names: Names,
    /// By dimension and name.
    given: BTreeMap<(usize, String), i32>,
}

impl Labels {
    /// The reference of a name among the elements of a dimension, a new one for a new name.
    fn reference(&mut self, dimension: usize, name: &str) -> i32 {
        let next = 1 + self.given.keys().filter(|(other, _)| *other == dimension).count() as i32;
        let reference = *self.given.entry((dimension, name.to_owned())).or_insert(next);
        self.call(dimension, reference, name);
        reference
    }

    fn call(&mut self, dimension: usize, reference: i32, name: &str) {
        let labels = match dimension {
            1 => &mut self.names.edges,
            2 => &mut self.names.triangles,
            _ => &mut self.names.tetrahedra,
        };
        labels.insert(reference, Label { name: Some(name.to_owned()), colour: None });
    }
}

/// Appends the points of a zone.
fn coordinates(zone: &Node<'_>, mesh: &mut TetMesh) -> Result<(), Error> {
    if let Some(kind) = zone.text_of("ZoneType").filter(|kind| kind != "Unstructured") {
        return Err(zone.fail(format!("a zone of type {}; Unstructured is read", error::short(&kind))));
    }
    let grids = zone.labelled("GridCoordinates_t")?;
    let grid = grids.iter().find(|grid| grid.name == "GridCoordinates").or(grids.first());
    let grid = grid.ok_or_else(|| zone.fail("the zone has no GridCoordinates_t"))?;
    let axis = |name: &str| grid.child(name).map(|array| array.reals()).transpose();
    let (Some(x), Some(y), z) = (axis("CoordinateX")?, axis("CoordinateY")?, axis("CoordinateZ")?) else {
        return Err(grid.fail("CoordinateX, CoordinateY and CoordinateZ are expected"));
    };
    let z = z.unwrap_or_else(|| vec![0.0; x.len()]);
    if x.len() != y.len() || x.len() != z.len() {
        return Err(grid.fail("the coordinates are not equally many"));
    }
    if mesh.vertices.len() + x.len() > u32::MAX as usize {
        return Err(grid.fail("there are too many points; at most 2^32 - 1 are supported"));
    }
    mesh.vertices.extend(x.iter().zip(&y).zip(&z).map(|((&x, &y), &z)| [x, y, z]));
    mesh.vertex_refs.resize(mesh.vertices.len(), 0);
    Ok(())
}
