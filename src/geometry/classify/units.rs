//! Whether mesh and model are in the same units.
use super::Error;
use crate::geometry::Topology;
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, distance, sub};

/// Factors between units of length, and what they mean when the mesh is larger by them.
const FACTORS: [(f64, &str, &str); 7] = [
    (1000.0, ": the mesh is in millimetres, the model in metres", ": the mesh is in metres, the model in millimetres"),
    (100.0, ": the mesh is in centimetres, the model in metres", ": the mesh is in metres, the model in centimetres"),
    (
        10.0,
        ": the mesh is in millimetres, the model in centimetres",
        ": the mesh is in centimetres, the model in millimetres",
    ),
    (25.4, ": the mesh is in millimetres, the model in inches", ": the mesh is in inches, the model in millimetres"),
    (1000.0 / 25.4, ": the mesh is in inches, the model in metres", ": the mesh is in metres, the model in inches"),
    (304.8, ": the mesh is in millimetres, the model in feet", ": the mesh is in feet, the model in millimetres"),
    (12.0, ": the mesh is in inches, the model in feet", ": the mesh is in feet, the model in inches"),
];

/// The ratio of the boxes may differ from a known factor by this: the chords of a coarse mesh cut curved walls.
const SLACK: f64 = 0.05;

/// Sizes within this factor are taken for the same units: a coarse mesh of a ball is that much smaller.
const SAME: f64 = 1.6;

/// Compares the boxes of the mesh's triangles and of the model.
///
/// # Errors
/// [`Error::Units`] if all three sides differ by the same factor.
pub(super) fn check(mesh: &TetMesh, topology: &Topology) -> Result<(), Error> {
    let bounds =
        crate::geometry::discrete::box_of(mesh.triangles.nodes.iter().flatten().map(|&v| mesh.vertices[v as usize]));
    let (size, diagonal) = (distance(bounds[0], bounds[1]), topology.diagonal());
    if size <= 0.0 || diagonal <= 0.0 {
        return Ok(());
    }
    let ratio = size / diagonal;
    let sides = (sub(bounds[1], bounds[0]), sub(topology.bounds[1], topology.bounds[0]));
    if (1.0 / SAME..SAME).contains(&ratio) || !is_uniform(sides, ratio, diagonal) {
        return Ok(());
    }
    let near = |factor: f64| (ratio / factor - 1.0).abs() < SLACK;
    let known = FACTORS.iter().find_map(|&(factor, larger, smaller)| {
        if near(factor) { Some((factor, larger)) } else { near(1.0 / factor).then_some((1.0 / factor, smaller)) }
    });
    let (factor, units) = match known {
        Some((factor, meaning)) => (factor, meaning),
        None => (ratio, ""),
    };
    Err(Error::Units { factor, mesh: size, model: diagonal, units })
}

/// Whether each side of the boxes has the ratio; sides of a flat box don't count.
fn is_uniform((mesh, model): (Vec3, Vec3), ratio: f64, diagonal: f64) -> bool {
    (0..3).all(|i| (mesh[i] - ratio * model[i]).abs() < 3.0 * SLACK * ratio * model[i].max(0.01 * diagonal))
}
