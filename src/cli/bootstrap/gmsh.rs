//! gmsh, version 4 (GPL: started, never linked).
use super::ladder::Wish;
use super::process::Workplace;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

/// What it is called.
pub const NAME: &str = "gmsh";

/// Names the program, where it is not in the search path.
pub const VARIABLE: &str = "GEO_ADAPT_GMSH";

/// What to do where it is missing.
pub const REMEDY: &str = "sudo apt install gmsh";

/// Least size, of the model's diagonal: the curvature at an apex has no bound.
const LEAST: f64 = 1e-4;

/// Its name of an algorithm for surfaces.
pub fn algorithm(number: u32) -> &'static str {
    match number {
        1 => "MeshAdapt",
        5 => "Delaunay",
        _ => "frontal-Delaunay",
    }
}

/// Its name of an algorithm for volumes.
pub fn algorithm_3d(number: u32) -> &'static str {
    match number {
        4 => "frontal",
        10 => "HXT",
        _ => "Delaunay",
    }
}

/// Its command: meshes `model` (BREP) into `out` (MSH 4.1). Curved parts get as many segments as the metric of the geometry wants.
pub fn command(
    program: &Path,
    (surface, volume, finer): (u32, u32, f64),
    wish: &Wish,
    place: &Workplace,
    [model, out]: [&Path; 2],
) -> std::io::Result<Command> {
    let mut script = String::new();
    let segments = (std::f64::consts::TAU * wish.segments * finer).max(12.0);
    let (greatest, least) = (wish.greatest / finer, (LEAST * wish.diagonal).min(0.1 * wish.greatest) / finer);
    let _ = write!(
        script,
        "General.Terminal = 1;\nMesh.Algorithm = {surface};\nMesh.Algorithm3D = {volume};\nMesh.MeshSizeFromCurvature = {segments};\n\
         Mesh.MeshSizeMin = {least:e};\nMesh.MeshSizeMax = {greatest:e};\nMesh.ElementOrder = 1;\nMesh.SaveAll = 1;\n\
         Mesh.SaveParametric = 1;\nMesh.MshFileVersion = 4.1;\nMesh.Binary = 0;\nMerge \"{}\";\n",
        model.display()
    );
    let path = place.file("model.geo");
    std::fs::write(&path, script)?;
    let mut command = Command::new(program);
    // One thread, so that the mesh is the same again.
    command.arg(path).args(["-3", "-nt", "1", "-format", "msh41", "-o"]).arg(out);
    Ok(command)
}
