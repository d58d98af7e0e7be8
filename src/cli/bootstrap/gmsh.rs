//! gmsh, version 4 (GPL: started, never linked).
use super::rung::Least;
use super::wish::Wish;
use crate::cli::workplace::Workplace;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

/// Names the program, where it is not in the search path.
pub const VARIABLE: &str = "GEO_ADAPT_GMSH";

/// What to do where it is missing.
pub const REMEDY: &str = "sudo apt install gmsh";

/// Its command: meshes `model` (BREP) into `out` (MSH 4.1). Curved parts get as many segments as the metric of the geometry wants.
pub fn command(
    program: &Path,
    (surface, volume, finer, least): (u32, u32, f64, Least),
    wish: &Wish,
    place: &Workplace,
    [model, out]: [&Path; 2],
) -> std::io::Result<Command> {
    let mut script = String::new();
    let segments = (std::f64::consts::TAU * wish.segments * finer).max(12.0);
    let least = if least == Least::Large { wish.least.max(1e-3 * wish.diagonal) } else { wish.least };
    let [greatest, least] = [wish.greatest, least.min(wish.greatest)].map(|size| size / finer);
    let _ = write!(
        script,
        "General.Terminal = 1;\nMesh.Algorithm = {surface};\nMesh.Algorithm3D = {volume};\nMesh.MeshSizeFromCurvature = {segments};\n\
         Mesh.MeshSizeMin = {least:e};\nMesh.MeshSizeMax = {greatest:e};\nMesh.ElementOrder = 1;\nMesh.SaveAll = 1;\n\
         Mesh.SaveParametric = 1;\nMesh.MshFileVersion = 4.1;\nMesh.Binary = 0;\nMerge \"{}\";\n",
        model.display()
    );
    let path = place.file("model.geo");
    std::fs::write(&path, script)?;
    Ok(run(program, &path, out))
}

/// Its command for a script; on one thread, so that the mesh is the same again.
pub fn run(program: &Path, script: &Path, out: &Path) -> Command {
    let mut command = Command::new(program);
    command.arg(script).args(["-3", "-nt", "1", "-format", "msh41", "-o"]).arg(out);
    command
}
