//! A model itself as what is shown: triangles of its faces, which have the numbers of the faces.
use crate::cli::model::{about, counts};
use crate::cli::{load, table};
use crate::geometry::{Geometry, Model, names};
use crate::mesh::TetMesh;
use crate::view::{Given, NamesFile, OfModel};
use std::error::Error;
use std::path::Path;

/// Whether a file is a CAD model, by its extension.
pub fn is_model(path: &Path) -> bool {
    let kind = path.extension().and_then(|kind| kind.to_str()).unwrap_or_default().to_ascii_lowercase();
    ["step", "stp", "iges", "igs", "brep", "egads"].contains(&kind.as_str())
}

/// The triangles of a model, and what is told of its faces; with what the user should know.
///
/// # Errors
/// When it is no model, or its faces cannot be triangulated in time.
pub fn read(path: &Path) -> Result<(TetMesh, Given, Vec<String>), Box<dyn Error>> {
    let model = load::model(path)?;
    let (mesh, notices) = triangles(&model).map_err(|error| format!("{}: {error}", path.display()))?;
    let topology = model.topology();
    let corner = |point: [f64; 3]| point.map(table::figure).join(", ");
    let row = |name: &str, value: String| [name.to_string(), value];
    let area: Option<f64> = (0..topology.faces.len() as u32).map(|face| model.face_area(face)).sum();
    let mut figures = vec![
        row("solids", topology.solids.to_string()),
        row("faces", topology.faces.len().to_string()),
        row("edges", topology.edges.len().to_string()),
        row("vertices", topology.vertices.len().to_string()),
    ];
    figures.extend(area.map(|area| row("area of all faces", table::figure(area))));
    figures.push(row("box from", corner(topology.bounds[0])));
    figures.push(row("box to", corner(topology.bounds[1])));
    figures.push(row("largest tolerance", table::figure(topology.tolerance)));
    let file = names::of_model(path).file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let given = Given {
        figures,
        names: model.names().clone(),
        names_file: NamesFile { file, names: names::read_of_model(path)?, fields: Vec::new() },
        model: Some(OfModel { counts: counts(topology).join(", "), about: about(&model) }),
        ..Given::default()
    };
    Ok((mesh, given, notices))
}

#[cfg(feature = "occt")]
fn triangles(model: &Model) -> Result<(TetMesh, Vec<String>), String> {
    use crate::surface::{Options, triangulate};
    use crate::tasks::Team;
    use std::time::{Duration, Instant};
    /// How long the faces may take to be triangulated.
    const LIMIT: Duration = Duration::from_secs(600);
    /// Segments for a radian of curvature: as fine as is seen.
    const SEGMENTS: f64 = 6.0;
    /// Edges as short as this are not divided further, of the diagonal: nobody sees it.
    const LEAST: f64 = 1e-3;
    let Model::Occt(cad) = model else { return Err("it is no CAD model".into()) };
    let topology = model.topology();
    // Where triangles cross they are shown as they are.
    let options = Options {
        rounds: 0,
        segments: SEGMENTS,
        least: LEAST * topology.diagonal(),
        ..Options::new(topology.diagonal())
    };
    let start = Instant::now();
    let surface = triangulate(Team::alone(), cad, &options, &|| start.elapsed() < LIMIT)
        .ok_or_else(|| format!("its faces are not triangulated after {} s", LIMIT.as_secs()))?;
    let mut mesh = TetMesh { vertices: surface.points, ..TetMesh::default() };
    mesh.vertex_refs = vec![0; mesh.vertices.len()];
    for (&nodes, &face) in surface.triangles.iter().zip(&surface.faces) {
        mesh.triangles.push(nodes, face as i32 + 1);
    }
    for (edge, chain) in (0..).zip(&surface.chains).filter(|(edge, _)| topology.is_ridge(*edge)) {
        chain.windows(2).for_each(|ends| mesh.edges.push([ends[0], ends[1]], edge as i32 + 1));
    }
    let missing: Vec<String> = surface.missing.iter().map(|face| (face + 1).to_string()).collect();
    let notices = if missing.is_empty() {
        Vec::new()
    } else {
        vec![format!("faces that cannot be triangulated are not shown: {}", missing.join(", "))]
    };
    Ok((mesh, notices))
}

#[cfg(not(feature = "occt"))]
fn triangles(_: &Model) -> Result<(TetMesh, Vec<String>), String> {
    Err("this build has no CAD backend; build geo-adapt with its feature `occt`".into())
}
