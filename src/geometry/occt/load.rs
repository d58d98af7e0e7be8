//! Reading of a model file, and its entities as a [`Topology`].
use super::bridge::ffi;
use super::curve::Curve;
use super::surface::Surface;
use super::{OcctModel, Shape};
use crate::geometry::{CurveKind, EdgeEntity, Error, FaceEntity, SurfaceKind, Topology, VertexEntity};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// OCCT's readers share global state: two at a time crash.
static LOADING: Mutex<()> = Mutex::new(());

/// Where the p-curves give only a numerical range, this share of it is added at each end.
const RANGE_MARGIN: f64 = 1e-7;

#[derive(Clone, Copy, PartialEq)]
enum Format {
    Step = 0,
    Iges = 1,
    Brep = 2,
}

/// Reads a model: see [`OcctModel::read`].
pub fn read(path: &Path) -> Result<OcctModel, Error> {
    let fail = |message: String| Error::Model { path: path.into(), message };
    let format = format_of(path).ok_or_else(|| {
        fail("unknown kind of model; the name must end in .step, .stp, .iges, .igs, .brep or .egads".into())
    })?;
    let (head, tail) = ends(path).map_err(|source| Error::Open { path: path.into(), source })?;
    check(format, &head, &tail).map_err(|message| fail(message.into()))?;
    let name = path.to_str().ok_or_else(|| fail("the file's name is not UTF-8; rename it".into()))?;
    let _guard = LOADING.lock().unwrap_or_else(PoisonError::into_inner);
    let occt = ffi::load_model(name, format as u32).map_err(|error| fail(error.what().into()))?;
    build(occt).map_err(|error| fail(format!("OpenCASCADE cannot use the model: {}", error.what())))
}

/// The format by the file's extension.
fn format_of(path: &Path) -> Option<Format> {
    match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
        "step" | "stp" => Some(Format::Step),
        "iges" | "igs" => Some(Format::Iges),
        "brep" | "egads" => Some(Format::Brep),
        _ => None,
    }
}

/// The first and the last kilobytes of a file.
fn ends(path: &Path) -> std::io::Result<(Vec<u8>, Vec<u8>)> {
    const LENGTH: u64 = 4096;
    if path.is_dir() {
        return Err(std::io::Error::other("is a directory; name a model file"));
    }
    let mut file = File::open(path)?;
    let (mut head, mut tail) = (Vec::new(), Vec::new());
    file.by_ref().take(LENGTH).read_to_end(&mut head)?;
    let size = file.metadata()?.len();
    file.seek(SeekFrom::Start(size.saturating_sub(LENGTH)))?;
    file.read_to_end(&mut tail)?;
    Ok((head, tail))
}

/// Tells files of another kind and cut files before OCCT sees them, which takes what it finds without complaint.
fn check(format: Format, head: &[u8], tail: &[u8]) -> Result<(), &'static str> {
    let has = |text: &[u8], word: &str| text.windows(word.len()).any(|window| window == word.as_bytes());
    let letter = |line: &[u8], letter: u8| line.get(72) == Some(&letter);
    if head.iter().all(u8::is_ascii_whitespace) {
        return Err("the file is empty; export the model again");
    }
    match format {
        Format::Step if !has(head, "ISO-10303-21") => {
            Err("this is no STEP file (it does not begin with ISO-10303-21); export the model as STEP")
        }
        Format::Step if !has(tail, "END-ISO-10303-21") => {
            Err("the STEP file is cut off (END-ISO-10303-21 is missing); copy or export it again")
        }
        Format::Iges if !head.split(|&c| c == b'\n').next().is_some_and(|line| letter(line, b'S')) => {
            Err("this is no IGES file (its first line is no start record); export the model as IGES")
        }
        Format::Iges if !tail.split(|&c| c == b'\n').any(|line| letter(line, b'T')) => {
            Err("the IGES file is cut off (its terminate record is missing); copy or export it again")
        }
        Format::Brep if !has(head, "CASCADE Topology V") => Err(
            "this is no OpenCASCADE BREP file (no line `CASCADE Topology V…`); write the model as BREP text or STEP",
        ),
        _ => Ok(()),
    }
}

/// Lists the entities of a loaded model and copies the analytic shapes.
fn build(occt: cxx::SharedPtr<ffi::Model>) -> Result<OcctModel, cxx::Exception> {
    let mut evaluator = ffi::new_evaluator(&occt)?;
    let (mut topology, mut surfaces, mut curves) = (Topology::default(), Vec::new(), Vec::new());
    for i in 0..occt.vertex_count()? {
        let record = occt.vertex_record(i)?;
        topology.vertices.push(VertexEntity { point: record.point, edges: Vec::new(), tolerance: record.tolerance });
    }
    for i in 0..occt.edge_count()? {
        let record = occt.edge_record(i)?;
        let form = if !record.degenerate && record.kind <= 1 { evaluator.pin_mut().curve_form(i)? } else { NO_FORM };
        let curve = if record.degenerate { Curve::General } else { Curve::new(record.kind, &form) };
        curves.push(Shape::new(curve, (4 * record.spans as usize).clamp(16, 512), 0));
        topology.edges.push(edge_entity(&record));
    }
    for i in 0..occt.face_count()? {
        let record = occt.face_record(i)?;
        let form = if record.kind <= 4 { evaluator.pin_mut().surface_form(i)? } else { NO_FORM };
        let counts = record.spans.map(|n| (2 * n as usize).clamp(8, 48));
        surfaces.push(Shape::new(Surface::new(record.kind, &form), counts[0], counts[1]));
        add_face(&mut topology, i, &record);
    }
    connect(&mut topology);
    topology.solids = occt.solid_count()?;
    topology.bounds = corners(occt.bounds()?);
    let [low, high] = topology.bounds;
    let size = low.iter().chain(&high).fold(topology.diagonal(), |size, x| size.max(x.abs()));
    Ok(OcctModel { topology, occt, surfaces, curves, size })
}

/// For entities without a closed form.
const NO_FORM: ffi::Form = ffi::Form { origin: [0.0; 3], x: [0.0; 3], y: [0.0; 3], z: [0.0; 3], sizes: [0.0; 2] };

fn edge_entity(record: &ffi::EdgeRecord) -> EdgeEntity {
    use CurveKind::*;
    const KINDS: [CurveKind; 9] = [Line, Circle, Ellipse, Hyperbola, Parabola, Bezier, BSpline, Offset, Other];
    EdgeEntity {
        kind: if record.degenerate { None } else { KINDS.get(record.kind as usize).copied().unwrap_or(Other) },
        vertices: record.vertices.map(|v| u32::try_from(v).ok()),
        faces: Vec::new(),
        range: record.range,
        period: (record.period > 0.0).then_some(record.period),
        degenerate: record.degenerate,
        seam: false,
        tolerance: record.tolerance,
    }
}

/// Adds a face, and itself to its edges: twice to those it has twice, which [`connect`] makes seams.
fn add_face(topology: &mut Topology, index: u32, record: &ffi::FaceRecord) {
    use SurfaceKind::*;
    const KINDS: [SurfaceKind; 11] =
        [Plane, Cylinder, Cone, Sphere, Torus, Bezier, BSpline, Revolution, Extrusion, Offset, Other];
    let mut edges = Vec::new();
    for &edge in &record.edges {
        topology.edges[edge as usize].faces.push(index);
        if !edges.contains(&edge) {
            edges.push(edge);
        }
    }
    let period = record.period.map(|p| (p > 0.0).then_some(p));
    topology.faces.push(FaceEntity {
        kind: KINDS.get(record.kind as usize).copied().unwrap_or(Other),
        edges,
        range: [0, 1].map(|k: usize| face_range(record, k, period[k])),
        period,
        reversed: record.reversed,
        tolerance: record.tolerance,
        bounds: corners(record.bounds),
    });
}

/// The range of u (0) or v (1), wide enough for every point of the face.
fn face_range(record: &ffi::FaceRecord, k: usize, period: Option<f64>) -> [f64; 2] {
    let [low, high] = [record.range[2 * k], record.range[2 * k + 1]];
    if record.exact_range {
        return [low, high];
    }
    let margin = RANGE_MARGIN * (high - low);
    match period {
        Some(period) if high - low + 2.0 * margin >= period => [low, low + period],
        Some(_) => [low - margin, high + margin],
        None => [(low - margin).max(record.natural[2 * k]), (high + margin).min(record.natural[2 * k + 1])],
    }
}

/// Marks the seams, leaves each face once in an edge, tells the vertices their edges, and finds the largest tolerance.
fn connect(topology: &mut Topology) {
    for (i, edge) in topology.edges.iter_mut().enumerate() {
        let count = edge.faces.len();
        edge.faces.dedup();
        edge.seam = !edge.degenerate && count == 2 && edge.faces.len() == 1;
        for vertex in edge.vertices.into_iter().flatten() {
            let edges = &mut topology.vertices[vertex as usize].edges;
            if edges.last() != Some(&(i as u32)) {
                edges.push(i as u32);
            }
        }
    }
    let tolerances = topology.vertices.iter().map(|v| v.tolerance);
    let tolerances = tolerances.chain(topology.edges.iter().map(|e| e.tolerance));
    topology.tolerance = tolerances.chain(topology.faces.iter().map(|f| f.tolerance)).fold(0.0, f64::max);
}

fn corners(bounds: [f64; 6]) -> [[f64; 3]; 2] {
    let [a, b, c, d, e, f] = bounds;
    [[a, b, c], [d, e, f]]
}
