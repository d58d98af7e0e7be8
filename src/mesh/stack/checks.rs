//! Whether the cells can be, alone and beside the tetrahedra.
use super::Stack;
use super::error::{Error, Of};
use super::sides::{Side, Sides, against_tets};
use crate::mesh::TetMesh;
use crate::mesh::adjacency::sorted3;
use std::collections::HashSet;

/// Checks nodes, volumes and faces. Returns whether the base of each cell is seen clockwise from its top.
pub(super) fn check(stack: &Stack, mesh: &TetMesh) -> Result<Vec<bool>, Error> {
    let of_cell = |at: usize| Of::Cell(stack.cells[at].kind, at);
    for (at, cell) in stack.cells.iter().enumerate() {
        nodes(of_cell(at), cell.nodes(), mesh.vertices.len())?;
    }
    for (at, quad) in stack.quads.nodes.iter().enumerate() {
        nodes(Of::Quad(at), quad, mesh.vertices.len())?;
    }
    let mut turned = Vec::with_capacity(stack.cells.len());
    for (at, cell) in stack.cells.iter().enumerate() {
        let volume = cell.volume(&mesh.vertices);
        // Neither positive nor negative where a coordinate is no number.
        if volume == 0.0 || volume.is_nan() {
            return Err(Error::Flat { of: of_cell(at) });
        }
        turned.push(volume < 0.0);
    }
    let sides = Sides::of(stack);
    if let Some(group) = sides.groups().find(|group| group.len() > 2) {
        return Err(Error::Crowded { of: of_cell(group[2].cell), nodes: group[2].nodes.clone() });
    }
    if let Some(at) = stack.quads.nodes.iter().position(|quad| !sides.has(quad)) {
        return Err(Error::Loose { of: Of::Quad(at) });
    }
    match unmatched(stack, mesh, &sides) {
        Some(side) => Err(Error::Unmatched { of: of_cell(side.cell), nodes: side.nodes.clone() }),
        None => Ok(turned),
    }
}

fn nodes(of: Of, nodes: &[u32], vertices: usize) -> Result<(), Error> {
    if nodes.iter().any(|&v| v as usize >= vertices) {
        return Err(Error::Index { of, vertices });
    }
    match (1..nodes.len()).find(|&i| nodes[..i].contains(&nodes[i])) {
        Some(i) => Err(Error::Twice { of, vertex: nodes[i] + 1 }),
        None => Ok(()),
    }
}

/// The first quadrilateral of one cell alone that a tetrahedron lies against.
fn unmatched<'s>(stack: &Stack, mesh: &TetMesh, sides: &'s Sides) -> Option<&'s Side> {
    let halves = |nodes: &[u32]| match *nodes {
        [a, b, c, d] => vec![[a, b, c], [b, c, d], [c, d, a], [d, a, b]].into_iter().map(sorted3).collect(),
        _ => Vec::new(),
    };
    let all: HashSet<[u32; 3]> = sides.open().flat_map(|side| halves(&side.nodes)).collect();
    let hit = against_tets(stack, mesh, &all);
    sides.open().find(|side| !hit.is_empty() && halves(&side.nodes).iter().any(|half| hit.contains(half)))
}
