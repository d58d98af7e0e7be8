//! Cases of OpenFOAM: the mesh (polyMesh) and fields at its cells, as text or raw bytes, plain or gzip.
//! Source: OpenFOAM user guide, "Mesh description" and "Field files" (v1912); only tetrahedra, prisms, pyramids and hexahedra.
//!
//! Reading goes bytes → `file` (head) → `scan` (words) → `list`, `boundary` → `poly_mesh`; fields go from cells to vertices by `average`.
mod boundary;
mod field;
mod file;
mod list;
mod ordered;
mod poly_mesh;
mod scan;
mod words;
mod write;

pub use boundary::Patch;
pub use field::{
    CellField, KINEMATIC_PRESSURE, VELOCITY, read_cell_field, write_cell_field, write_cell_field_of, write_face_field,
};
pub use write::write_poly_mesh;

use super::{Dataset, NamedField};
use crate::mesh::io::{Batch, Error, Read};
use crate::tasks::Team;
use poly_mesh::PolyMesh;
use std::path::{Path, PathBuf};

/// The name of a patch of triangles without one.
fn unnamed_surface(reference: i32) -> String {
    format!("surface_{reference}")
}

/// The name of a zone of tetrahedra without one.
fn unnamed_region(reference: i32) -> String {
    format!("region_{reference}")
}

/// Whether this is a case, or its polyMesh.
pub fn is_case(path: &Path) -> bool {
    file::find(&poly_mesh_of(path), "faces").is_some()
}

/// Whether a path is a folder, and so a case: the folder exists, or the path ends in `/`.
pub fn is_folder(path: &Path) -> bool {
    path.as_os_str().to_string_lossy().ends_with('/') || path.is_dir()
}

/// The polyMesh of a case, or of itself.
fn poly_mesh_of(path: &Path) -> PathBuf {
    let is_itself = path.file_name().is_some_and(|name| name == "polyMesh");
    if is_itself { path.to_owned() } else { path.join("constant/polyMesh") }
}

/// The case of a polyMesh, or itself.
fn case_of(path: &Path) -> PathBuf {
    let is_itself = path.file_name().is_some_and(|name| name == "polyMesh");
    let case = path.parent().and_then(Path::parent).filter(|_| is_itself);
    case.unwrap_or(path).to_owned()
}

/// Reads the mesh of a case and the names of its references, without fields.
///
/// # Errors
/// As [`read`].
pub fn read_mesh(path: &Path) -> Result<Dataset, Error> {
    Ok(poly_mesh::read(&poly_mesh_of(path))?.data)
}

/// The cells on both sides of the inner faces of a case, in their order: owner and neighbour.
///
/// # Errors
/// As [`read`].
pub fn read_inner_faces(path: &Path) -> Result<Vec<[u32; 2]>, Error> {
    poly_mesh::inner_faces(&poly_mesh_of(path))
}

/// Reads a case, or its polyMesh: the mesh, and the fields of the newest time folder, averaged to the vertices.
///
/// # Errors
/// [`Error::System`] when a file is not there or cannot be read, [`Error::Content`] when what it says cannot be true, or the mesh has
/// cells that are no tetrahedra, prisms, pyramids or hexahedra.
pub fn read(path: &Path) -> Result<Read<Dataset>, Error> {
    read_on(Team::alone(), path)
}

/// As [`read`], on the threads of a team.
///
/// # Errors
/// As [`read`].
pub fn read_on(team: Team<'_>, path: &Path) -> Result<Read<Dataset>, Error> {
    let PolyMesh { mut data, cells, mut notices } = poly_mesh::read(&poly_mesh_of(path))?;
    let (mut fields, mut passed) = (Vec::new(), Vec::new());
    if let Some(time) = newest_time(&case_of(path)) {
        for file in files_of(&time)? {
            let name =
                file.file_stem().filter(|_| file.extension().is_some_and(|end| end == "gz")).or(file.file_name());
            let name = name.unwrap_or_default().to_string_lossy().into_owned();
            match read_cell_field(&file, cells.len())? {
                Ok(CellField { kind, mut values }) => {
                    let width = kind.values();
                    if !data.stack.is_empty() {
                        let rows = cells.iter().flat_map(|&cell| &values[cell as usize * width..][..width]);
                        values = rows.copied().collect();
                    }
                    let values = data.cells_to_vertices(team, values, width);
                    fields.push(NamedField { name, kind, values });
                }
                Err(class) => passed.push(format!("{name} ({class})")),
            }
        }
        if !passed.is_empty() {
            notices.push(format!(
                "{}: passed over, since these are no fields at cells: {}",
                time.display(),
                passed.join(", ")
            ));
        }
    }
    data.fields = fields;
    Ok(Read { content: data, notices })
}

/// The time folder of the greatest time.
pub fn newest_time(case: &Path) -> Option<PathBuf> {
    let entries = std::fs::read_dir(case).ok()?.flatten().map(|entry| entry.path());
    let timed = entries.filter_map(|path| {
        Some((path.file_name()?.to_str()?.parse::<f64>().ok().filter(|time| time.is_finite())?, path))
    });
    timed.filter(|(_, path)| path.is_dir()).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, path)| path)
}

/// The files of a folder that are OpenFOAM's, by name.
fn files_of(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let system = |source| Error::System { path: folder.to_owned(), source };
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(system)? {
        let path = entry.map_err(system)?.path();
        let is_hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        if path.is_file() && !is_hidden {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// The files that [`read`] reads.
pub fn read_files(path: &Path) -> Vec<PathBuf> {
    let folders = [Some(poly_mesh_of(path)), newest_time(&case_of(path))];
    folders.iter().flatten().flat_map(|folder| files_of(folder).unwrap_or_default()).collect()
}

/// The files that [`write()`] may replace: of the fields those that are there.
pub fn written_files(path: &Path) -> Vec<PathBuf> {
    let folder = poly_mesh_of(path);
    let mut files: Vec<_> = write::FILES.iter().map(|name| folder.join(name)).collect();
    if folder != path {
        files.extend(files_of(&path.join("0")).unwrap_or_default());
    }
    files
}

/// Writes a case, or its polyMesh alone where the path says so: the mesh with a patch a reference, named as it is, and the fields at the
/// cells (the means of the values at their vertices) in the time folder `0`, with gradient zero at all patches; and a `system` folder
/// where there is none, so that OpenFOAM's tools take the case. Returns what a case cannot carry, a line each.
///
/// # Errors
/// [`Error::Content`] when the mesh is not whole or a value is not finite, [`Error::System`] when a file cannot be written.
pub fn write(path: &Path, data: &Dataset, text: bool) -> Result<Vec<String>, Error> {
    write_on(Team::alone(), path, data, text)
}

/// As [`write`], on the threads of a team: the same files to the last byte.
///
/// # Errors
/// As [`write`].
pub fn write_on(team: Team<'_>, path: &Path, data: &Dataset, text: bool) -> Result<Vec<String>, Error> {
    let mut batch = Batch::new();
    let notices = add(&mut batch, team, path, data, text)?;
    batch.commit()?;
    Ok(notices)
}

/// Adds what [`write_on`] writes to files that belong together.
///
/// # Errors
/// As [`write`].
pub fn add(batch: &mut Batch, team: Team<'_>, path: &Path, data: &Dataset, text: bool) -> Result<Vec<String>, Error> {
    let mesh = &data.mesh;
    let folder = poly_mesh_of(path);
    let patches = write::add_poly_mesh(batch, team, &folder, data, &|_, _| "patch".to_owned(), text)?;
    let mut notices = Vec::new();
    let lost = [
        ("edges", mesh.edges.len()),
        ("corners", mesh.corners.len()),
        ("required entities", mesh.required_vertices.len() + mesh.required_edges.len() + mesh.required_triangles.len()),
        ("the association with a model", usize::from(!mesh.association.is_empty())),
    ];
    let lost: Vec<_> = lost.iter().filter(|(_, count)| *count > 0).map(|(what, _)| *what).collect();
    if !lost.is_empty() {
        notices.push(format!("OpenFOAM has no place for {}: these are left out", lost.join(", ")));
    }
    if folder == path {
        if !data.fields.is_empty() {
            notices.push("a polyMesh has no fields; name the case to write them".to_owned());
        }
        return Ok(notices);
    }
    add_system(batch, path)?;
    if data.fields.is_empty() {
        return Ok(notices);
    }
    let time = path.join("0");
    batch.folder(&time)?;
    let entries: Vec<_> = patches.into_iter().map(|patch| (patch.name, "type zeroGradient;".to_owned())).collect();
    for NamedField { name, kind, values } in &data.fields {
        let values = data.vertices_to_cells(team, values, kind.values());
        let file = name.replace(|c: char| !c.is_ascii_alphanumeric() && !"_.-".contains(c), "_");
        if file != *name {
            notices.push(format!("the field {name} is called {file} there"));
        }
        let field = CellField { kind: *kind, values };
        let (path, cells) = (time.join(file), data.cells());
        field::add_cell_field(batch, &path, &field, cells, &entries, text, field::dimensions(&path))?;
    }
    Ok(notices)
}

/// The fewest files that OpenFOAM's tools ask for. Files that exist stay.
fn add_system(batch: &mut Batch, case: &Path) -> Result<(), Error> {
    let folder = case.join("system");
    batch.folder(&folder)?;
    let files = [
        (
            "controlDict",
            "application none;\nstartFrom latestTime;\nstopAt endTime;\nendTime 0;\ndeltaT 1;\nwriteInterval 1;\n",
        ),
        ("fvSchemes", "ddtSchemes {}\ngradSchemes {}\ndivSchemes {}\nlaplacianSchemes {}\n"),
        ("fvSolution", ""),
    ];
    for (name, body) in files {
        let path = folder.join(name);
        if !path.is_file() {
            batch.add(&path, |w| write!(w, "{}{body}", file::head_text("dictionary", "system", name, true)))?;
        }
    }
    Ok(())
}
