//! The closest points of faces of a model to the vertices of a mesh.
use super::corners::corners;
use super::foot::Foot;
use crate::geometry::classify::Classification;
use crate::geometry::discrete::{BoxTree, box_of, closest_on_triangle};
use crate::geometry::{Entity, Evaluate, Evaluator, Geometry, Model, OnSurface, Topology};
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, add, distance, dot, scale, sub};
use crate::sizing::walls::{away, own_faces};
use crate::tasks::Team;
use std::collections::{BTreeMap, BTreeSet};

/// Vertices a task. Each task makes an evaluator.
pub const VERTICES: usize = 1 << 9;
/// A share of the model's diagonal: as exact are closest points.
const EXACT: f64 = 1e-9;

/// Faces of a model, with the triangles that a mesh has on them: a search begins at the nearest of these.
pub struct Search<'a> {
    mesh: &'a TetMesh,
    place: &'a Classification,
    model: &'a Model,
    topology: &'a Topology,
    /// Ascending.
    faces: Vec<u32>,
    /// The other ones of these that each makes a corner with, where they are looked for.
    corners: BTreeMap<u32, Vec<u32>>,
    /// The mesh's triangles on them.
    triangles: Vec<u32>,
    tree: BoxTree,
    /// How exact closest points are.
    pub exact: f64,
}

impl<'a> Search<'a> {
    /// For faces that the mesh has triangles on.
    pub fn new(mesh: &'a TetMesh, place: &'a Classification, model: &'a Model, faces: &[u32]) -> Self {
        let topology = model.topology();
        let asked: BTreeSet<u32> = faces.iter().copied().collect();
        let triangles: Vec<u32> =
            (0..).zip(&place.faces).filter(|(_, face)| asked.contains(face)).map(|(triangle, _)| triangle).collect();
        let corners = |triangle: u32| mesh.triangles.nodes[triangle as usize].map(|v| place.projected[v as usize]);
        let boxes: Vec<[Vec3; 2]> = triangles.iter().map(|&triangle| box_of(corners(triangle))).collect();
        let faces: Vec<u32> = asked.into_iter().collect();
        let exact = EXACT * topology.diagonal();
        Self {
            mesh,
            place,
            model,
            topology,
            faces,
            corners: BTreeMap::new(),
            triangles,
            tree: BoxTree::new(&boxes),
            exact,
        }
    }

    /// The same, with the corners that the faces make, before which a vertex has a foot on both.
    pub fn with_corners(self) -> Self {
        Self { corners: corners(self.mesh, self.place, self.model, &self.faces), ..self }
    }

    /// The exact distance of each vertex from the faces, shape (n,), model units: 0 on them.
    pub fn distances(&self, team: Team<'_>) -> Vec<f64> {
        team.collect(VERTICES, self.mesh.vertices.len(), |range, found| {
            let mut evaluator = self.model.evaluator();
            found.extend(range.map(|v| {
                if self.is_on(self.place.entities[v]) { 0.0 } else { self.nearest(&mut evaluator, v).1.distance }
            }));
        })
    }

    /// Whether an entity is on the faces.
    pub fn is_on(&self, entity: Entity) -> bool {
        let is_asked = |face: &u32| self.faces.binary_search(face).is_ok();
        let has_edge = |edge: &u32| self.topology.edges[*edge as usize].faces.iter().any(is_asked);
        match entity {
            Entity::Face(face) => is_asked(&face),
            Entity::Edge(edge) => has_edge(&edge),
            Entity::Vertex(vertex) => self.topology.vertices[vertex as usize].edges.iter().any(has_edge),
            Entity::Interior => false,
        }
    }

    /// The closest point of the faces to a vertex, and on which face. It is looked for on the face of the nearest triangle from there, and then on
    /// the faces whose boxes are nearer than what is found; each search is a global one (docs/decisions/closest-points.md).
    pub fn nearest(&self, evaluator: &mut Evaluator, vertex: usize) -> (u32, OnSurface) {
        let point = self.place.projected[vertex];
        let corners = |i: u32| {
            let nodes = self.mesh.triangles.nodes[self.triangles[i as usize] as usize];
            nodes.map(|v| self.place.projected[v as usize])
        };
        let square = |i: u32| {
            let [a, b, c] = corners(i);
            let [u, v, w] = closest_on_triangle([a, b, c], point);
            let way = sub(point, add(add(scale(a, u), scale(b, v)), scale(c, w)));
            dot(way, way)
        };
        let begin = self.tree.nearest(point, f64::INFINITY, square).unwrap_or(0);
        let triangle = self.triangles[begin as usize] as usize;
        let face = self.place.faces[triangle];
        let on_face = self.mesh.triangles.nodes[triangle].into_iter().map(|v| v as usize);
        let guess = on_face.clone().find(|&v| self.place.entities[v] == Entity::Face(face));
        let guess = guess.map(|v| self.place.parameters[v]);
        let mut best = (face, evaluator.closest_on_face(face, point, guess));
        // The corners lie on the face too: a bound that holds whatever a search finds.
        for corner in corners(begin) {
            let bound = distance(corner, point);
            if best.1.distance.is_nan() || best.1.distance > bound + self.exact {
                best.1 = OnSurface { point: corner, distance: bound, ..best.1 };
            }
        }
        for &other in self.faces.iter().filter(|&&other| other != face) {
            if away(point, &self.topology.faces[other as usize].bounds) < best.1.distance
                && let Some(on) = evaluator.closest_on_face_within(other, point, best.1.distance)
            {
                best = (other, on);
            }
        }
        best
    }

    /// Adds the feet of a vertex: on the wall one for each of its faces there, else the nearest; and those on the faces that make a corner with
    /// these, where they are nearer than `reach` tells from the feet so far and the vertex is before them. `asked` is room for faces.
    pub fn feet(
        &self,
        evaluator: &mut Evaluator,
        vertex: usize,
        reach: impl Fn(&[Foot]) -> f64,
        (found, asked): (&mut Vec<Foot>, &mut Vec<u32>),
    ) {
        let (point, begin) = (self.place.projected[vertex], found.len());
        asked.clear();
        if self.is_on(self.place.entities[vertex]) {
            for (face, uv) in own_faces(self.topology, self.place, evaluator, vertex) {
                // A vertex may lie on two edges of a face, whose normals there are the same.
                if self.faces.binary_search(&face).is_ok() && !asked.contains(&face) {
                    found.push(Foot::on_wall(evaluator, self.topology, face, uv));
                    asked.push(face);
                }
            }
        }
        if found.len() == begin {
            let nearest = self.nearest(evaluator, vertex);
            found.push(Foot::in_layers(evaluator, self.topology, nearest, point, self.exact));
            asked.push(nearest.0);
        }
        for k in 0..asked.len() {
            let corners = self.corners.get(&asked[k]).map_or(&[][..], Vec::as_slice);
            for &other in corners {
                if asked.contains(&other) {
                    continue;
                }
                asked.push(other);
                found.extend(self.foot_before(evaluator, point, other, reach(&found[begin..])));
            }
        }
    }

    /// The foot of a point on a face that it lies before, nearer than a limit.
    fn foot_before(&self, evaluator: &mut Evaluator, point: Vec3, face: u32, limit: f64) -> Option<Foot> {
        if away(point, &self.topology.faces[face as usize].bounds) >= limit {
            return None;
        }
        let on = evaluator.closest_on_face_within(face, point, limit)?;
        let foot = Foot::off_wall(evaluator, self.topology, (face, on), point, self.exact);
        // Outward is out of the mesh: who looks at the back of a face has the body between.
        let is_before = dot(foot.normal, evaluator.face_normal(face, on.uv)) < 0.0;
        (foot.is_inside && is_before && foot.distance > self.exact).then_some(foot)
    }
}
