//! The listing of a model for programs: entities count from 1, as in meshes and messages.
use crate::geometry::{ClosedGap, CurveKind, EdgeEntity, Evaluate, FaceEntity, Geometry, Model, Names, SurfaceKind};
use crate::mesh::vector::{Vec3, norm};
use serde::Serialize;
use std::collections::BTreeSet;

/// A face with what tells it from others.
pub struct Face<'a> {
    /// From 1.
    pub number: u32,
    /// As the model has it; its indices count from 0.
    pub entity: &'a FaceEntity,
    /// Square model units.
    pub area: Option<f64>,
    /// Centre of its area; on a curved face that lies beside it.
    pub centre: Option<Vec3>,
    /// The point of the face that is nearest to the centre.
    pub point: Option<Vec3>,
    /// Outward unit normal at that point.
    pub normal: Option<Vec3>,
    /// Whether it closes on itself, as a whole cylinder: then its normals point all round.
    pub closed: bool,
    /// Faces that share an edge with it, from 1.
    pub neighbours: Vec<u32>,
}

impl<'a> Face<'a> {
    /// All faces of a model.
    pub fn all(model: &'a Model) -> Vec<Self> {
        let topology = model.topology();
        let mut on = model.evaluator();
        let face = |(entity, index): (&'a FaceEntity, u32)| {
            let centre = model.face_centre(index);
            let nearest = centre.map(|centre| on.closest_on_face(index, centre, None));
            let normal = nearest.map(|at| on.face_normal(index, at.uv)).filter(|&normal| norm(normal) > 0.0);
            let beside = entity.edges.iter().flat_map(|&edge| &topology.edges[edge as usize].faces);
            let neighbours: BTreeSet<u32> = beside.filter(|&&other| other != index).map(|other| other + 1).collect();
            Self {
                number: index + 1,
                entity,
                area: model.face_area(index),
                centre,
                point: nearest.map(|at| at.point),
                normal,
                closed: entity.edges.iter().any(|&edge| topology.edges[edge as usize].seam),
                neighbours: neighbours.into_iter().collect(),
            }
        };
        topology.faces.iter().zip(0..).map(face).collect()
    }
}

/// What --json prints.
#[derive(Serialize)]
pub struct Listing<'a> {
    solids: u32,
    bounds: [Vec3; 2],
    diagonal: f64,
    tolerance: f64,
    faces: Vec<FaceRow<'a>>,
    edges: Vec<EdgeRow>,
    vertices: Vec<VertexRow>,
    /// Edges that were off their faces in the file.
    moved_onto_faces: Vec<MovedRow>,
    names: &'a Names,
}

#[derive(Serialize)]
struct MovedRow {
    edge: u32,
    /// Greatest distance from its faces in the file, and now, model units.
    before: f64,
    after: f64,
}

#[derive(Serialize)]
struct FaceRow<'a> {
    number: u32,
    kind: SurfaceKind,
    name: Option<&'a str>,
    colour: Option<&'a str>,
    area: Option<f64>,
    centre: Option<Vec3>,
    point: Option<Vec3>,
    normal: Option<Vec3>,
    closed: bool,
    bounds: [Vec3; 2],
    neighbours: Vec<u32>,
    edges: Vec<u32>,
    range: [[f64; 2]; 2],
    period: [Option<f64>; 2],
    reversed: bool,
    tolerance: f64,
}

#[derive(Serialize)]
struct EdgeRow {
    number: u32,
    kind: CurveKind,
    length: Option<f64>,
    vertices: [Option<u32>; 2],
    faces: Vec<u32>,
    range: [f64; 2],
    period: Option<f64>,
    degenerate: bool,
    seam: bool,
    tolerance: f64,
}

#[derive(Serialize)]
struct VertexRow {
    number: u32,
    point: Vec3,
    edges: Vec<u32>,
    tolerance: f64,
}

impl<'a> Listing<'a> {
    /// Of a model.
    pub fn new(model: &'a Model) -> Self {
        let topology = model.topology();
        let vertices = topology.vertices.iter().zip(1..).map(|(vertex, number)| VertexRow {
            number,
            point: vertex.point,
            edges: from_one(&vertex.edges),
            tolerance: vertex.tolerance,
        });
        Self {
            solids: topology.solids,
            bounds: topology.bounds,
            diagonal: topology.diagonal(),
            tolerance: topology.tolerance,
            faces: Face::all(model).into_iter().map(|face| face_row(face, model.names())).collect(),
            edges: topology.edges.iter().zip(0..).map(|(edge, i)| edge_row(edge, i, model)).collect(),
            vertices: vertices.collect(),
            moved_onto_faces: model.closed_gaps().into_iter().map(moved).collect(),
            names: model.names(),
        }
    }
}

fn moved(ClosedGap { edge, before, after }: ClosedGap) -> MovedRow {
    MovedRow { edge: edge + 1, before, after }
}

fn from_one(indices: &[u32]) -> Vec<u32> {
    indices.iter().map(|i| i + 1).collect()
}

fn face_row<'a>(face: Face<'a>, names: &'a Names) -> FaceRow<'a> {
    let (entity, label) = (face.entity, names.triangles.get(&(face.number as i32)));
    FaceRow {
        number: face.number,
        kind: entity.kind,
        name: label.and_then(|label| label.name.as_deref()),
        colour: label.and_then(|label| label.colour.as_deref()),
        area: face.area,
        centre: face.centre,
        point: face.point,
        normal: face.normal,
        closed: face.closed,
        bounds: entity.bounds,
        neighbours: face.neighbours,
        edges: from_one(&entity.edges),
        range: entity.range,
        period: entity.period,
        reversed: entity.reversed,
        tolerance: entity.tolerance,
    }
}

fn edge_row(edge: &EdgeEntity, index: u32, model: &Model) -> EdgeRow {
    EdgeRow {
        number: index + 1,
        kind: edge.kind,
        length: model.edge_length(index),
        vertices: edge.vertices.map(|vertex| vertex.map(|v| v + 1)),
        faces: from_one(&edge.faces),
        range: edge.range,
        period: edge.period,
        degenerate: edge.degenerate,
        seam: edge.seam,
        tolerance: edge.tolerance,
    }
}
