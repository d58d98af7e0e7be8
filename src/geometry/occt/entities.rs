//! The entities of a loaded model as a [`Topology`], and copies of its shapes.
use super::bridge::ffi;
use super::{OcctModel, Shape, copy};
use crate::geometry::{CurveKind, EdgeEntity, FaceEntity, Label, Names, SurfaceKind, Topology, VertexEntity};
use cxx::Exception;
use std::collections::BTreeMap;
use std::sync::{Mutex, OnceLock};

/// Where the p-curves give only a numerical range, this share of it is added at each end.
const RANGE_MARGIN: f64 = 1e-7;

/// Lists the entities and copies their shapes.
pub fn build(occt: cxx::SharedPtr<ffi::Model>) -> Result<OcctModel, Exception> {
    let mut evaluator = ffi::new_evaluator(&occt)?;
    // First of all: OCCT finds no end in the box of a face that is refused here.
    let faces = (0..occt.face_count()?).map(|i| occt.face_record(i)).collect::<Result<Vec<_>, _>>()?;
    let mut topology = Topology { bounds: corners(occt.bounds()?), solids: occt.solid_count()?, ..Topology::default() };
    let [low, high] = topology.bounds;
    let size = low.iter().chain(&high).fold(topology.diagonal(), |size, x| size.max(x.abs()));
    let (mut surfaces, mut curves) = (Vec::new(), Vec::new());
    for i in 0..occt.vertex_count()? {
        let record = occt.vertex_record(i)?;
        topology.vertices.push(VertexEntity { point: record.point, edges: Vec::new(), tolerance: record.tolerance });
    }
    for i in 0..occt.edge_count()? {
        let record = occt.edge_record(i)?;
        let curve = copy::curve(&occt, &mut evaluator, i, &record, size)?;
        curves.push(Shape::new(curve, [record.spans, 0]));
        topology.edges.push(edge_entity(&record));
    }
    for (i, record) in (0..).zip(&faces) {
        let surface = copy::surface(&occt, &mut evaluator, i, record, size)?;
        surfaces.push(Shape::new(surface, record.spans));
        add_face(&mut topology, i, record);
    }
    connect(&mut topology);
    let rounded = topology.faces.iter().map(|face| is_rounded(&topology, face)).collect();
    let pcurves = copy::pcurves(&occt, &mut evaluator, &topology)?;
    let trims = topology.faces.iter().map(|_| OnceLock::new()).collect();
    let names = names(&occt, &topology)?;
    Ok(OcctModel { topology, names, occt, surfaces, curves, pcurves, trims, rounded, idle: Mutex::default(), size })
}

/// The labels of edges, faces and solids by their numbers from 1.
fn names(occt: &ffi::Model, topology: &Topology) -> Result<Names, Exception> {
    let of = |dimension: u32, count: u32| {
        let mut labels = BTreeMap::new();
        for i in 0..count {
            let ffi::LabelRecord { name, colour } = occt.label(dimension, i)?;
            let [name, colour] = [name, colour].map(|text| Some(text).filter(|text| !text.is_empty()));
            if name.is_some() || colour.is_some() {
                labels.insert(i as i32 + 1, Label { name, colour });
            }
        }
        Ok(labels)
    };
    Ok(Names {
        edges: of(1, topology.edges.len() as u32)?,
        triangles: of(2, topology.faces.len() as u32)?,
        tetrahedra: of(3, topology.solids)?,
    })
}

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

/// Adds a face, and lists it at its edges; twice at an edge that it has twice, which [`connect`] makes a seam.
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

/// Marks the seams, lists each face once at an edge, lists the edges at their vertices, and finds the largest tolerance.
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

/// Whether chords of the face's edges may leave it: on a cylinder circles and lines follow the parameters, on a plane round edges do not.
fn is_rounded(topology: &Topology, face: &FaceEntity) -> bool {
    let follows = |kind: CurveKind| match (face.kind, kind) {
        (_, CurveKind::Line | CurveKind::None) => true,
        (SurfaceKind::Plane, _) => false,
        (_, CurveKind::Circle) => true,
        _ => false,
    };
    !face.edges.iter().all(|&edge| follows(topology.edges[edge as usize].kind))
}
