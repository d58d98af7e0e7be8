//! What a format cannot carry.
use super::{Dataset, Format};
use std::collections::BTreeSet;

/// One line for each thing of the data that a file of the format cannot carry.
pub(super) fn notices(format: Format, data: &Dataset) -> Vec<String> {
    let mesh = &data.mesh;
    if format.is_fields() {
        return vec!["fields alone are written, no mesh".into()];
    }
    // A case tells itself.
    if matches!(format, Format::Libmeshb | Format::Foam) {
        return Vec::new();
    }
    let (edges, regions, fields, names) = match format {
        Format::Su2 | Format::Ugrid(_) => (false, false, false, [true, false, false]),
        Format::Surface(_) => (false, false, false, [true, false, false]),
        Format::Abaqus | Format::Nastran => (true, true, false, [true; 3]),
        _ => (true, true, true, [true; 3]),
    };
    let mut lost: Vec<String> = Vec::new();
    let mut count = |count: usize, what: &str| lost.extend((count > 0).then(|| format!("{count} {what}: left out")));
    if matches!(format, Format::Surface(_)) {
        count(mesh.tets.len(), "tetrahedra (it holds the surface)");
    }
    if !edges {
        count(mesh.edges.len(), "edges");
    }
    if !regions {
        let cells = data.stack.cells.iter().map(|cell| cell.reference);
        let found: BTreeSet<i32> = mesh.tets.refs.iter().copied().chain(cells).filter(|&region| region != 1).collect();
        let cells = mesh.tets.len() + data.stack.cells.len();
        count(
            if found.is_empty() { 0 } else { cells },
            if data.stack.is_empty() { "references of tetrahedra" } else { "references of cells" },
        );
    }
    if !matches!(format, Format::Vtu | Format::LegacyVtk | Format::Xdmf { .. }) {
        count(mesh.vertex_refs.iter().filter(|&&reference| reference != 0).count(), "references of vertices");
    }
    if !fields {
        count(data.fields.len(), "fields (write them to a .csv, .dat or .solb)");
    }
    let labels = [&data.names.triangles, &data.names.edges, &data.names.tetrahedra];
    let unnamed = labels.iter().zip(names).filter(|(_, carried)| !carried);
    count(
        unnamed.flat_map(|(labels, _)| labels.values()).filter(|label| label.name.is_some()).count(),
        "names of edges and regions",
    );
    count(labels.iter().flat_map(|labels| labels.values()).filter(|label| label.colour.is_some()).count(), "colours");
    count(mesh.corners.len() + mesh.ridges.len(), "marks of corners and ridges");
    let required = mesh.required_vertices.len() + mesh.required_edges.len() + mesh.required_triangles.len();
    count(required, "marks of required vertices, edges and triangles");
    let on = &mesh.association;
    count(on.vertices.len() + on.edges.len() + on.faces.len(), "places on the CAD model");
    lost
}
