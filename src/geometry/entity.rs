//! The entities of a boundary representation and how they touch. Indices count from 0; files,
//! messages and JSON count from 1, in the order of OCCT's `TopExp::MapShapes`.
use crate::mesh::numbers::from_one;
use crate::mesh::vector::Vec3;
use serde::Serialize;

/// What a mesh vertex lies on, lowest dimension first: it may move only within its entity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub enum Entity {
    /// A vertex of the model: the mesh vertex is fixed.
    Vertex(#[serde(serialize_with = "from_one")] u32),
    /// An edge of the model.
    Edge(#[serde(serialize_with = "from_one")] u32),
    /// A face of the model.
    Face(#[serde(serialize_with = "from_one")] u32),
    /// Inside a solid.
    Interior,
}

impl Entity {
    /// Dimension: 0 vertex, 1 edge, 2 face, 3 interior.
    pub fn dimension(self) -> u32 {
        match self {
            Entity::Vertex(_) => 0,
            Entity::Edge(_) => 1,
            Entity::Face(_) => 2,
            Entity::Interior => 3,
        }
    }
}

/// Prints it as messages do, from 1.
impl std::fmt::Display for Entity {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Entity::Vertex(i) => write!(f, "vertex {}", i + 1),
            Entity::Edge(i) => write!(f, "edge {}", i + 1),
            Entity::Face(i) => write!(f, "face {}", i + 1),
            Entity::Interior => write!(f, "the inside"),
        }
    }
}

/// The kind of a face's surface, as shown by `geo-adapt model`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs)]
pub enum SurfaceKind {
    Plane,
    Cylinder,
    Cone,
    Sphere,
    Torus,
    Bezier,
    BSpline,
    Revolution,
    Extrusion,
    Offset,
    Other,
    /// A patch of mesh triangles.
    Discrete,
}

/// The kind of an edge's curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs)]
pub enum CurveKind {
    Line,
    Circle,
    Ellipse,
    Hyperbola,
    Parabola,
    Bezier,
    BSpline,
    Offset,
    Other,
    /// A degenerate edge has no curve.
    None,
    /// A chain of mesh edges.
    Discrete,
}

/// A vertex of the model.
#[derive(Clone, Debug, Serialize)]
pub struct VertexEntity {
    /// Its point, model units.
    pub point: Vec3,
    /// Edges that end here.
    #[serde(serialize_with = "from_one")]
    pub edges: Vec<u32>,
    /// Tolerance the model states for it.
    pub tolerance: f64,
}

/// An edge of the model.
#[derive(Clone, Debug, Serialize)]
pub struct EdgeEntity {
    /// Kind of curve.
    pub kind: CurveKind,
    /// First and last vertex (by increasing t); equal on a closed edge, none on a closed edge without vertices.
    #[serde(serialize_with = "from_one")]
    pub vertices: [Option<u32>; 2],
    /// Faces beside it; a seam lists its face once.
    #[serde(serialize_with = "from_one")]
    pub faces: Vec<u32>,
    /// First and last parameter.
    pub range: [f64; 2],
    /// Period of the curve, if periodic.
    pub period: Option<f64>,
    /// Whether it is degenerate: a point in space (a sphere's pole). Nothing is classified on it.
    pub degenerate: bool,
    /// Whether it is a seam, where a periodic face closes on itself. It is no ridge, and nothing is classified on it.
    pub seam: bool,
    /// Tolerance the model states for it.
    pub tolerance: f64,
}

/// A face of the model.
#[derive(Clone, Debug, Serialize)]
pub struct FaceEntity {
    /// Kind of surface.
    pub kind: SurfaceKind,
    /// Its edges, each once, seams and degenerate ones too.
    #[serde(serialize_with = "from_one")]
    pub edges: Vec<u32>,
    /// Bounds of u and v.
    pub range: [[f64; 2]; 2],
    /// Periods of u and v, where periodic.
    pub period: [Option<f64>; 2],
    /// Whether the outward normal is −(Su × Sv).
    pub reversed: bool,
    /// Tolerance the model states for it.
    pub tolerance: f64,
    /// Box of the face: least and greatest corner.
    pub bounds: [Vec3; 2],
}

/// All entities of a model.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Topology {
    /// Vertices.
    pub vertices: Vec<VertexEntity>,
    /// Edges.
    pub edges: Vec<EdgeEntity>,
    /// Faces.
    pub faces: Vec<FaceEntity>,
    /// Number of solids.
    pub solids: u32,
    /// Box: least and greatest corner.
    pub bounds: [Vec3; 2],
    /// Largest tolerance of any entity.
    pub tolerance: f64,
}

impl Topology {
    /// Length of the box's diagonal.
    pub fn diagonal(&self) -> f64 {
        crate::mesh::vector::distance(self.bounds[0], self.bounds[1])
    }

    /// Whether mesh edges and vertices are classified on this edge: not degenerate and no seam.
    pub fn is_ridge(&self, edge: u32) -> bool {
        let edge = &self.edges[edge as usize];
        !edge.degenerate && !edge.seam
    }
}
