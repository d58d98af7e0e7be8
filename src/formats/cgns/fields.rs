//! Solutions (FlowSolution_t) at vertices and at cells. CGNS has scalars alone: VelocityX, VelocityY and VelocityZ are a vector.
use super::super::{Dataset, NamedField, error};
use super::{Element, Node, Section};
use crate::mesh::io::{Error, FieldKind};
use crate::tasks::Team;
use std::collections::BTreeMap;
use std::ops::Range;

/// The ends of the names of components, in our order.
pub(super) fn ends(kind: FieldKind) -> &'static [&'static str] {
    match kind {
        FieldKind::Scalar => &[""],
        FieldKind::Vector => &["X", "Y", "Z"],
        FieldKind::SymmetricTensor => &["XX", "XY", "YY", "XZ", "YZ", "ZZ"],
        FieldKind::Tensor => &["XX", "XY", "XZ", "YX", "YY", "YZ", "ZX", "ZY", "ZZ"],
    }
}

/// Reads the solutions of all zones.
pub(super) fn read(
    zones: &[(&Node<'_>, Range<usize>, Vec<Section>)],
    data: &Dataset,
    notices: &mut Vec<String>,
) -> Result<Vec<NamedField>, Error> {
    let mut order = Vec::new();
    let mut found: BTreeMap<String, (bool, Vec<f64>)> = BTreeMap::new();
    for (zone, points, sections) in zones {
        let cells = sections.iter().flat_map(|section| &section.elements).filter_map(|element| match element {
            Element::Tet(at) => Some(*at),
            Element::Cell(at) => Some(data.own_tets() + at),
            _ => None,
        });
        let cells: Vec<usize> = cells.collect();
        for solution in zone.labelled("FlowSolution_t")? {
            let at_cells = match solution.text_of("GridLocation").as_deref() {
                None | Some("Vertex") => false,
                Some("CellCenter") => true,
                Some(_) => continue,
            };
            for array in solution.labelled("DataArray_t")? {
                let values = array.reals()?;
                let room = if at_cells { cells.len() } else { points.len() };
                if values.len() != room {
                    let name = error::short(&array.name);
                    notices.push(format!("{name} has {} values for {room} places and is left out", values.len()));
                    continue;
                }
                let all = if at_cells { data.cells() } else { data.mesh.vertices.len() };
                let new = || (at_cells, vec![f64::NAN; all]);
                if !found.contains_key(&array.name) {
                    order.push(array.name.clone());
                }
                let (is_cells, to) = found.entry(array.name.clone()).or_insert_with(new);
                if *is_cells && !at_cells {
                    (*is_cells, *to) = new();
                } else if *is_cells != at_cells {
                    continue;
                }
                if at_cells {
                    values.iter().zip(&cells).for_each(|(value, &at)| to[at] = *value);
                } else {
                    to[points.clone()].copy_from_slice(&values);
                }
            }
        }
    }
    let mut at_vertices = BTreeMap::new();
    for name in &order {
        let Some((at_cells, mut values)) = found.remove(name) else { continue };
        if at_cells {
            values = data.cells_to_vertices(Team::alone(), values, 1);
            notices.push(format!("{} was given at cells: their mean about each vertex is taken", error::short(name)));
        }
        at_vertices.insert(name.clone(), values);
    }
    Ok(joined(&order, at_vertices))
}

/// Components of one name as one field.
fn joined(order: &[String], mut values: BTreeMap<String, Vec<f64>>) -> Vec<NamedField> {
    let mut fields = Vec::new();
    for name in order {
        if !values.contains_key(name) {
            continue;
        }
        let kinds = [FieldKind::Tensor, FieldKind::SymmetricTensor, FieldKind::Vector];
        let whole = kinds.into_iter().find_map(|kind| {
            let stem = ends(kind).iter().find_map(|end| name.strip_suffix(end)).filter(|stem| !stem.is_empty())?;
            let parts: Vec<String> = ends(kind).iter().map(|end| format!("{stem}{end}")).collect();
            parts.iter().all(|part| values.contains_key(part)).then(|| (stem.to_owned(), kind, parts))
        });
        let (called, kind, parts) = whole.unwrap_or_else(|| (name.clone(), FieldKind::Scalar, vec![name.clone()]));
        let parts: Vec<Vec<f64>> = parts.iter().filter_map(|part| values.remove(part)).collect();
        let count = parts.first().map_or(0, Vec::len);
        let rows = (0..count).flat_map(|row| parts.iter().map(move |part| part[row])).collect();
        fields.push(NamedField { name: called, kind, values: rows });
    }
    fields
}
