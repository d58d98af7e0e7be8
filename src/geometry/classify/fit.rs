//! The classification of a mesh on a model.
use super::hints::Hints;
use super::{Classification, Error, Report, corners, coverage, entities, patches, ridges, settle, units};
use crate::geometry::discrete::{DEFAULT_RIDGE_ANGLE, Features};
use crate::geometry::{EdgeEntity, Entity, FaceEntity, Geometry, Model, Topology};
use crate::mesh::TetMesh;
use crate::tasks::Team;

/// By default a vertex may be off by this share of the model's diagonal: the rounding of single precision, with room.
const TOLERANCE: f64 = 1e-6;

/// While entities are looked for, vertices may be this many tolerances off, since p-curves, curves and surfaces of a model agree less well
/// than the model says. At the entity that is found a vertex may be one tolerance off.
const SLACK: f64 = 10.0;

/// How to classify.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// How far a vertex may be from its entity, model units. By default 1e-6 of the model's diagonal, or twice the
    /// tolerance that the model states for the entity if that is more.
    pub tolerance: Option<f64>,
    /// Dihedral angle in degrees that separates patches where the file lists no edges. The model has to confirm what it separates.
    pub ridge_angle_deg: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { tolerance: None, ridge_angle_deg: DEFAULT_RIDGE_ANGLE }
    }
}

/// Puts a mesh on a model: each vertex, mesh edge and triangle of its surface gets its entity. What the file says
/// (association, references) is tried first, and believed where the model agrees; the rest is found by
/// geometry and connectivity.
///
/// In the result every triangle has a face; a mesh edge between different faces lies on a model edge that they share;
/// every model edge that is a ridge is covered by one chain from its first vertex to its last, every face by
/// triangles; every model vertex has one mesh vertex, except poles and the ends of seams, which no shape singles out.
///
/// # Errors
/// [`Error`], if the mesh does not fit so: which, where, how far.
pub fn classify(
    team: Team<'_>,
    mesh: &TetMesh,
    model: &Model,
    options: &Options,
) -> Result<(Classification, Report), Error> {
    if mesh.triangles.is_empty() {
        return Err(Error::NoTriangles);
    }
    let topology = model.topology();
    units::check(mesh, topology)?;
    let (edge_borders, face_borders) = borders(topology);
    let fit = Fit {
        edge_borders,
        face_borders,
        team,
        mesh,
        model,
        topology,
        features: Features::detect(team, mesh, options.ridge_angle_deg),
        hints: Hints::new(mesh, topology),
        tolerance: options.tolerance.unwrap_or(TOLERANCE * topology.diagonal()),
        given: options.tolerance.is_some(),
    };
    let faces = patches::match_faces(&fit)?;
    let ridges = ridges::find(&fit, &faces.of_triangle)?;
    let corners = corners::find(&fit, &ridges)?;
    let entities = entities::assemble(&fit, &faces.of_triangle, &ridges, &corners)?;
    coverage::check(&fit, &faces.of_triangle, &ridges, &entities)?;
    settle::settle(&fit, faces, ridges, entities)
}

/// What all steps share.
pub(super) struct Fit<'a> {
    pub team: Team<'a>,
    pub mesh: &'a TetMesh,
    pub model: &'a Model,
    pub topology: &'a Topology,
    pub features: Features,
    pub hints: Hints,
    /// The tolerance given, or that of an entity which states none.
    pub tolerance: f64,
    given: bool,
    /// For each edge the greatest tolerance of its vertices, for each face that of its edges and their vertices. A point on these may be so
    /// far off the edge or face that they bound.
    edge_borders: Vec<f64>,
    face_borders: Vec<f64>,
}

/// The greatest tolerance of what bounds each edge and each face.
fn borders(topology: &Topology) -> (Vec<f64>, Vec<f64>) {
    let of_edge = |edge: &EdgeEntity| {
        let ends = edge.vertices.into_iter().flatten();
        ends.map(|v| topology.vertices[v as usize].tolerance).fold(0.0, f64::max)
    };
    let edges: Vec<f64> = topology.edges.iter().map(of_edge).collect();
    let of_face = |face: &FaceEntity| {
        let bounds = face.edges.iter().map(|&e| topology.edges[e as usize].tolerance.max(edges[e as usize]));
        bounds.fold(0.0, f64::max)
    };
    let faces = topology.faces.iter().map(of_face).collect();
    (edges, faces)
}

/// How far a vertex may be from its entity by default: 1e-6 of the model's diagonal, or twice what the model states for the entity; model units.
pub fn usual_tolerance(topology: &Topology, entity: Entity) -> f64 {
    let stated = match entity {
        Entity::Vertex(i) => topology.vertices[i as usize].tolerance,
        Entity::Edge(i) => topology.edges[i as usize].tolerance,
        Entity::Face(i) => topology.faces[i as usize].tolerance,
        Entity::Interior => 0.0,
    };
    (TOLERANCE * topology.diagonal()).max(2.0 * stated)
}

impl Fit<'_> {
    /// How far a vertex may be from an entity.
    pub fn allowed(&self, entity: Entity) -> f64 {
        if self.given { self.tolerance } else { usual_tolerance(self.topology, entity) }
    }

    /// How far it may be while the entity is looked for.
    pub fn reach(&self, entity: Entity) -> f64 {
        self.allowed(entity).max(self.sure(entity))
    }

    /// A point nearer than this to an entity is not near it by chance. A tolerance that the user gives may span several entities.
    pub fn sure(&self, entity: Entity) -> f64 {
        let border = match entity {
            Entity::Edge(edge) => self.edge_borders[edge as usize],
            Entity::Face(face) => self.face_borders[face as usize],
            Entity::Vertex(_) | Entity::Interior => 0.0,
        };
        (SLACK * usual_tolerance(self.topology, entity)).max(2.0 * border)
    }

    /// How far a vertex may be from a face if none is within reach: edges may be off their faces by more than the model says.
    pub fn far_reach(&self, face: u32) -> f64 {
        self.reach(Entity::Face(face)).max(SLACK * self.face_borders[face as usize])
    }

    /// A point of the mesh.
    pub fn point(&self, vertex: u32) -> crate::mesh::vector::Vec3 {
        self.mesh.vertices[vertex as usize]
    }

    /// The error of vertices off their entities: names the farthest.
    pub fn vertex_off(&self, mut off: Vec<(u32, Entity, f64)>) -> Option<Error> {
        off.sort_by(|a, b| b.2.total_cmp(&a.2).then(a.0.cmp(&b.0)));
        let mut distinct: Vec<u32> = off.iter().map(|entry| entry.0).collect();
        distinct.sort_unstable();
        distinct.dedup();
        off.first().map(|&(vertex, entity, distance)| Error::VertexOff {
            vertex,
            point: self.point(vertex),
            entity,
            distance,
            tolerance: self.allowed(entity),
            others: distinct.len() - 1,
        })
    }
}
