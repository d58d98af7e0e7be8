//! What a model must have to be filled.
use crate::cli::table;
use crate::geometry::{Evaluate, Geometry, Model, Topology};
use crate::mesh::vector::distance;
use std::path::Path;

/// The diagonal of a face's box, a quarter of the faces being smaller: the body's scale, also in a far field.
pub fn small_face(topology: &Topology) -> f64 {
    let mut diagonals: Vec<f64> = topology.faces.iter().map(|face| distance(face.bounds[0], face.bounds[1])).collect();
    diagonals.sort_by(f64::total_cmp);
    diagonals.get(diagonals.len() / 4).copied().unwrap_or_default()
}

/// Refuses a model that is no volume.
pub fn check_solids(path: &Path, model: &Model) -> Result<(), String> {
    if model.topology().solids > 0 {
        return Ok(());
    }
    let topology = model.topology();
    let faces = topology.faces.len();
    Err(format!(
        "{}: the model has no solid, only surfaces ({faces} faces{}): there is nothing to fill; join them to a closed solid in the CAD \
         program and export that, or close gaps with --heal=LENGTH",
        path.display(),
        open_edges(model)
    ))
}

/// How many edges have one face alone, and where one of those is: there a face is missing, or does not meet its neighbour.
fn open_edges(model: &Model) -> String {
    let edges = &model.topology().edges;
    let open = |edge: &usize| edges[*edge].faces.len() == 1 && !edges[*edge].seam && !edges[*edge].degenerate;
    let Some(first) = (0..edges.len()).find(open) else { return String::new() };
    let middle = 0.5 * (edges[first].range[0] + edges[first].range[1]);
    let at = model.evaluator().edge_frame(first as u32, middle).point;
    let (count, all) = ((0..edges.len()).filter(open).count(), edges.len());
    format!("; {count} of {all} edges have a face on one side alone, the first at {}", table::place(at))
}
