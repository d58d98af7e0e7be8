//! The grids of an .xdmf: which items are their points, cells and values.
use super::items::Item;
use super::xml::Element;
use crate::mesh::io::Error;
use std::path::Path;

/// Where a cell of a grid is in the mesh.
#[derive(Clone, Copy, Debug)]
pub(super) enum Cell {
    Tet(usize),
    Triangle(usize),
    Edge(usize),
    Other,
}

/// The cells of a grid.
#[derive(Clone, Debug)]
pub(super) struct Topology<'e> {
    pub item: Item<'e>,
    /// Nodes of a cell; none where cells are mixed, each with its kind before it.
    pub kind: Option<usize>,
}

/// Values at points or cells.
#[derive(Clone, Debug)]
pub(super) struct Data<'e> {
    pub name: String,
    pub at_cells: bool,
    pub item: Item<'e>,
}

/// A grid.
#[derive(Clone, Debug)]
pub(super) struct Grid<'e> {
    /// With the coordinates of a point.
    pub geometry: (Item<'e>, usize),
    pub topology: Topology<'e>,
    /// Whether its cells are not those of another grid.
    pub has_own_cells: bool,
    pub data: Vec<Data<'e>>,
    pub line: usize,
}

impl<'e> Grid<'e> {
    /// All that it reads.
    pub fn items(&self) -> impl Iterator<Item = &Item<'e>> {
        [&self.geometry.0, &self.topology.item].into_iter().chain(self.data.iter().map(|data| &data.item))
    }
}

/// The grids in the order of the file. Of those of a time series the last one counts.
pub(super) fn grids<'e>(path: &Path, tree: &'e Element<'_>, notices: &mut Vec<String>) -> Result<Vec<Grid<'e>>, Error> {
    let domain = tree.all("Xdmf").next().and_then(|root| root.all("Domain").next());
    let domain = domain.ok_or_else(|| tree.fail(path, "there is no Xdmf with a Domain in it; give a file of XDMF"))?;
    let mut found = Vec::new();
    let mut elements: Vec<&Element> = Vec::new();
    gather(path, domain, &mut elements, notices);
    for &element in &elements {
        found.push(grid(path, element, &elements)?);
    }
    if found.is_empty() {
        return Err(domain.fail(path, "there is no Grid in the Domain"));
    }
    Ok(found)
}

/// The uniform grids within an element.
fn gather<'e, 'a>(path: &Path, within: &'e Element<'a>, found: &mut Vec<&'e Element<'a>>, notices: &mut Vec<String>) {
    for grid in within.children.iter().filter(|child| child.name == "Grid") {
        let is =
            |attribute: &str, value: &str| grid.get(attribute).is_some_and(|word| word.eq_ignore_ascii_case(value));
        if !is("GridType", "Collection") && !is("GridType", "Tree") {
            found.push(grid);
            continue;
        }
        let mut inner = Vec::new();
        gather(path, grid, &mut inner, notices);
        if is("CollectionType", "Temporal") && inner.len() > 1 {
            notices.push(format!("{}: of {} steps in time the last is read", path.display(), inner.len()));
            // The mesh may stand in an earlier step.
            let has_cells = |step: &&Element<'_>| step.all("Topology").next().is_some();
            let from = inner.iter().rposition(has_cells).unwrap_or(inner.len() - 1);
            inner = if from + 1 < inner.len() { vec![inner[from], inner[inner.len() - 1]] } else { vec![inner[from]] };
        }
        found.extend(inner);
    }
}

fn grid<'e>(path: &Path, element: &'e Element<'_>, all: &[&'e Element<'_>]) -> Result<Grid<'e>, Error> {
    let part = |name: &'static str| -> Result<&'e Element<'_>, Error> {
        let own = element.children.iter().find(|child| child.name == name);
        let found = own.or_else(|| included(element, name, all));
        found.ok_or_else(|| element.fail(path, format!("the Grid has no {name}")))
    };
    let (geometry, topology) = (part("Geometry")?, part("Topology")?);
    let kind = geometry.get("GeometryType").or(geometry.get("Type")).unwrap_or("XYZ");
    let width = match kind.to_ascii_uppercase().as_str() {
        "XYZ" => 3,
        "XY" => 2,
        _ => return Err(geometry.fail(path, format!("a Geometry of type {}; XYZ is read", super::error::short(kind)))),
    };
    let mut data = Vec::new();
    for attribute in element.children.iter().filter(|child| child.name == "Attribute") {
        let at_cells = match attribute.get("Center").unwrap_or("Node") {
            "Node" => false,
            "Cell" => true,
            _ => continue,
        };
        let name = attribute.get("Name").unwrap_or("unnamed").to_owned();
        data.push(Data { name, at_cells, item: Item::of(path, attribute)? });
    }
    Ok(Grid {
        geometry: (Item::of(path, geometry)?, width),
        topology: Topology { item: Item::of(path, topology)?, kind: nodes(path, topology)? },
        has_own_cells: element.children.iter().any(|child| child.name == "Topology"),
        data,
        line: element.line,
    })
}

/// What an XInclude points to: that of the grid that it names, else of the first that has it.
fn included<'e>(element: &Element<'_>, name: &str, all: &[&'e Element<'_>]) -> Option<&'e Element<'e>> {
    let pointers = element.children.iter().filter(|child| child.name.ends_with("include"));
    let pointer = pointers.filter_map(|child| child.get("xpointer")).find(|pointer| pointer.contains(name))?;
    let holds = |grid: &&&Element<'_>| grid.children.iter().any(|child| child.name == name);
    let is_named = |grid: &&&Element<'_>| {
        let wanted = grid.get("Name").unwrap_or_default();
        ['"', '\''].iter().any(|quote| pointer.contains(&format!("@Name={quote}{wanted}{quote}")))
    };
    let with = || all.iter().filter(holds);
    let grid = with().find(is_named).or_else(|| with().next())?;
    grid.children.iter().find(|child| child.name == name)
}

/// Nodes of a cell of a topology; none where cells are mixed.
fn nodes(path: &Path, topology: &Element<'_>) -> Result<Option<usize>, Error> {
    let kind = topology.get("TopologyType").or(topology.get("Type")).unwrap_or("Mixed");
    let per_cell = topology.get("NodesPerElement");
    Ok(match kind.to_ascii_lowercase().as_str() {
        "mixed" => None,
        "tetrahedron" => Some(4),
        "triangle" => Some(3),
        "polyline" if per_cell.is_none_or(|count| count == "2") => Some(2),
        "polyvertex" if per_cell.is_none_or(|count| count == "1") => Some(1),
        _ => {
            let message =
                format!("cells of type {}: tetrahedra, triangles and lines are read", super::error::short(kind));
            return Err(topology.fail(path, message));
        }
    })
}

/// Nodes of a mixed cell of this kind; none for those that are not read.
pub(super) fn kind(number: i64) -> Option<usize> {
    match number {
        1 => Some(1),
        2 => Some(2),
        4 => Some(3),
        6 => Some(4),
        _ => None,
    }
}
