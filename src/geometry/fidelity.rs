//! Fidelity of a mesh's boundary to its model: distances, and the deviation of the normals.
use super::classify::{Classification, usual_tolerance};
use super::{Entity, Evaluate, Geometry, Model, Topology};
use crate::mesh::TetMesh;
use crate::mesh::adjacency::{FACES, Side, TriangleIndex};
use crate::mesh::numbers::from_one;
use crate::mesh::vector::{Vec3, add, area2, cross, distance, dot, norm, scale};
use crate::tasks::{GRAIN, Team};
use serde::Serialize;

/// Triangles that one task measures.
const TRIANGLES: usize = 1 << 10;

/// The vertex that is farthest from something.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Farthest {
    /// Distance, model units.
    pub distance: f64,
    /// Mesh vertex, from 0; in JSON from 1.
    #[serde(serialize_with = "from_one")]
    pub vertex: u32,
    /// What it is classified on.
    pub entity: Entity,
    /// Where it is.
    pub at: Vec3,
}

/// The triangle that deviates most.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Deviation {
    /// Angle between its normal and the model's at the point of its face closest to its centroid, degrees: 0 best, 180 worst.
    pub degrees: f64,
    /// Triangle, from 0; in JSON from 1.
    #[serde(serialize_with = "from_one")]
    pub triangle: u32,
    /// Its face, from 0; in JSON from 1.
    #[serde(serialize_with = "from_one")]
    pub face: u32,
    /// Its centroid.
    pub at: Vec3,
}

/// The fidelity of a mesh's boundary to its model.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Fidelity {
    /// Vertices on the model.
    pub vertices: usize,
    /// The vertex farthest from the model's surface.
    pub from_model: Option<Farthest>,
    /// The vertex farthest from its own entity.
    pub from_entity: Option<Farthest>,
    /// How many vertices are farther from their own entity than `classify` allows by default.
    pub off: usize,
    /// The vertex farthest from its own entity of those that had to stay where the input has them. These do not count above.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub held: Option<Farthest>,
    /// The triangle of the worst normal.
    pub worst_normal: Option<Deviation>,
    /// Mean of that angle over the triangles, degrees.
    pub mean_normal_degrees: f64,
}

/// Measures a mesh that was classified on a model.
pub fn measure(team: Team<'_>, mesh: &TetMesh, model: &Model, classification: &Classification) -> Fidelity {
    measure_adapted(team, mesh, model, classification, &[])
}

/// As [`measure`], with the vertices, ascending, that had to stay where they were.
pub fn measure_adapted(
    team: Team<'_>,
    mesh: &TetMesh,
    model: &Model,
    classification: &Classification,
    held: &[u32],
) -> Fidelity {
    let mut fidelity = Fidelity::default();
    measure_vertices(team, mesh, model, classification, held, &mut fidelity);
    measure_normals(team, mesh, model, classification, &mut fidelity);
    fidelity
}

fn measure_vertices(
    team: Team<'_>,
    mesh: &TetMesh,
    model: &Model,
    classification: &Classification,
    held: &[u32],
    fidelity: &mut Fidelity,
) {
    let topology = model.topology();
    let mut found = team.collect(GRAIN, mesh.vertices.len(), |range, found| {
        let mut evaluator = model.evaluator();
        for vertex in range {
            let (at, entity) = (mesh.vertices[vertex], classification.entities[vertex]);
            let [t, v] = classification.parameters[vertex];
            let distance = match entity {
                Entity::Vertex(i) => distance(at, topology.vertices[i as usize].point),
                Entity::Edge(i) => evaluator.closest_on_edge(i, at, Some(t)).distance,
                Entity::Face(i) => evaluator.closest_on_face(i, at, Some([t, v])).distance,
                Entity::Interior => continue,
            };
            found.push(Farthest { distance, vertex: vertex as u32, entity, at });
        }
    });
    fidelity.vertices = found.len();
    team.sort_by(&mut found, |a, b| b.distance.total_cmp(&a.distance).then(a.vertex.cmp(&b.vertex)));
    if !held.is_empty() {
        let is_held = |found: &Farthest| held.binary_search(&found.vertex).is_ok();
        fidelity.held = found.iter().find(|found| is_held(found)).copied();
        found.retain(|found| !is_held(found));
    }
    fidelity.from_entity = found.first().copied();
    fidelity.off = found.iter().filter(|found| found.distance > usual_tolerance(topology, found.entity)).count();
    // The model is no farther than the vertex' own entity. So most vertices need no search.
    let mut evaluator = model.evaluator();
    for near in found {
        if fidelity.from_model.is_some_and(|known| near.distance <= known.distance) {
            break;
        }
        let distance = distance_from_model(topology, &mut evaluator, near.at, near.distance);
        if fidelity.from_model.is_none_or(|known| distance > known.distance) {
            fidelity.from_model = Some(Farthest { distance, ..near });
        }
    }
}

/// Distance of each vertex from its own entity, model units; NaN inside.
pub fn distances(team: Team<'_>, mesh: &TetMesh, model: &Model, classification: &Classification) -> Vec<f64> {
    let topology = model.topology();
    let parts = team.chunks(GRAIN, mesh.vertices.len(), |range| {
        let mut evaluator = model.evaluator();
        let from_own = |vertex: usize| {
            let (at, [t, v]) = (mesh.vertices[vertex], classification.parameters[vertex]);
            match classification.entities[vertex] {
                Entity::Vertex(i) => distance(at, topology.vertices[i as usize].point),
                Entity::Edge(i) => evaluator.closest_on_edge(i, at, Some(t)).distance,
                Entity::Face(i) => evaluator.closest_on_face(i, at, Some([t, v])).distance,
                Entity::Interior => f64::NAN,
            }
        };
        range.map(from_own).collect()
    });
    team.join(parts)
}

/// Distance of each vertex of a triangle from the nearest face, model units; NaN inside. For meshes that do not fit the model.
pub fn distances_from_faces(team: Team<'_>, mesh: &TetMesh, model: &Model) -> Vec<f64> {
    let mut on_surface = vec![false; mesh.vertices.len()];
    mesh.triangles.nodes.iter().flatten().for_each(|&v| on_surface[v as usize] = true);
    let parts = team.chunks(TRIANGLES, mesh.vertices.len(), |range| {
        let mut evaluator = model.evaluator();
        let to_faces = |vertex: usize| {
            let p = mesh.vertices[vertex];
            let far =
                on_surface[vertex].then(|| distance_from_model(model.topology(), &mut evaluator, p, f64::INFINITY));
            far.unwrap_or(f64::NAN)
        };
        range.map(to_faces).collect()
    });
    team.join(parts)
}

/// Distance to the nearest face, which is no more than `bound`.
fn distance_from_model(topology: &Topology, evaluator: &mut impl Evaluate, p: Vec3, bound: f64) -> f64 {
    let mut least = bound;
    for (face, entity) in topology.faces.iter().enumerate() {
        let [low, high] = entity.bounds;
        let to_box = norm(std::array::from_fn(|i| (low[i] - p[i]).max(p[i] - high[i]).max(0.0)));
        if to_box < least {
            least = least.min(evaluator.closest_on_face(face as u32, p, None).distance);
        }
    }
    least
}

fn measure_normals(
    team: Team<'_>,
    mesh: &TetMesh,
    model: &Model,
    classification: &Classification,
    fidelity: &mut Fidelity,
) {
    let sides = sides(team, mesh);
    let found = team.collect(TRIANGLES, mesh.triangles.len(), |range, found| {
        let mut evaluator = model.evaluator();
        for triangle in range {
            let (nodes, face) = (mesh.triangles.nodes[triangle], classification.faces[triangle]);
            let Some(side) = sides[triangle] else { continue };
            let [a, b, c] = nodes.map(|v| mesh.vertices[v as usize]);
            let at = scale(add(add(a, b), c), 1.0 / 3.0);
            let guess = nodes.iter().find_map(|&v| classification.parameters_on(&mut evaluator, v, face));
            let foot = evaluator.closest_on_face(face, at, guess);
            let truth = evaluator.face_normal(face, foot.uv);
            if dot(truth, truth) > 0.0 {
                let normal = area2(a, b, c);
                // By its tangent: the cosine of a small angle tells nothing of it.
                let (along, across) = (dot(normal, truth), norm(cross(normal, truth)));
                let degrees = across.atan2(side.map_or(along.abs(), |sign| sign * along)).to_degrees();
                found.push(Deviation { degrees, triangle: triangle as u32, face, at });
            }
        }
    });
    let sum: f64 = found.iter().map(|one| one.degrees).sum();
    fidelity.mean_normal_degrees = sum / found.len().max(1) as f64;
    let worse = |a: &Deviation, b: &Deviation| a.degrees.total_cmp(&b.degrees).then(b.triangle.cmp(&a.triangle));
    fidelity.worst_normal = found.into_iter().max_by(worse);
}

/// For each triangle its sign, +1 when its normal points out of its only tetrahedron and −1 when into it; no sign between two tetrahedra.
/// None when it is no face of a tetrahedron.
fn sides(team: Team<'_>, mesh: &TetMesh) -> Vec<Option<Option<f64>>> {
    let mut sides = vec![None; mesh.triangles.len()];
    let index = TriangleIndex::new(team, &mesh.triangles.nodes, mesh.vertices.len());
    for Side { triangle, tet, face } in index.sides(team, &mesh.tets.nodes) {
        let side = &mut sides[triangle as usize];
        if side.is_some() {
            *side = Some(None);
            continue;
        }
        let nodes = mesh.triangles.nodes[triangle as usize];
        let outward = FACES[face as usize].map(|i| mesh.tets.nodes[tet as usize][i]);
        let turned = (0..3).any(|i| (0..3).all(|j| outward[(i + j) % 3] == nodes[j]));
        *side = Some(Some(if turned { 1.0 } else { -1.0 }));
    }
    sides
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Discrete;
    use crate::mesh::samples::cube;

    #[test]
    fn a_cube_on_its_own_surface() {
        let mut mesh = cube(2);
        let (model, classification) = Discrete::from_mesh(Team::alone(), &mesh, 30.0).unwrap();
        let model = Model::Discrete(model);
        // The orientation of the triangles in the file does not matter.
        mesh.triangles.nodes[3].swap(0, 1);
        let fidelity = measure(Team::alone(), &mesh, &model, &classification);
        assert_eq!((fidelity.vertices, fidelity.off), (26, 0));
        assert!(fidelity.from_entity.unwrap().distance < 1e-14 && fidelity.from_model.unwrap().distance < 1e-14);
        assert!(fidelity.worst_normal.unwrap().degrees < 1e-12);
        // A vertex within a side, pushed in: by 0.1 from both, and the triangles around it lean.
        let vertex = mesh.vertices.iter().position(|&p| p == [0.5, 0.5, 0.0]).unwrap();
        mesh.vertices[vertex][2] = 0.1;
        let fidelity = measure(Team::alone(), &mesh, &model, &classification);
        let (own, all) = (fidelity.from_entity.unwrap(), fidelity.from_model.unwrap());
        assert_eq!((own.vertex, all.vertex), (vertex as u32, vertex as u32));
        assert!((own.distance - 0.1).abs() < 1e-12 && (all.distance - 0.1).abs() < 1e-12);
        let lean = fidelity.worst_normal.unwrap().degrees;
        // Of its three corners one is 0.1 out of the plane.
        assert!(lean > 8.2 && lean < 25.8, "{lean}");
        // Slid over a side it leaves its entity, not the model: an edge's vertex here.
        let vertex = mesh.vertices.iter().position(|&p| p == [0.5, 0.0, 1.0]).unwrap();
        mesh.vertices[vertex] = [0.5, 0.2, 1.0];
        let (own, all) = (
            distances(Team::alone(), &mesh, &model, &classification),
            distances_from_faces(Team::alone(), &mesh, &model),
        );
        // It lies on another face; the one pushed in before is the farthest of all.
        let farthest = all.iter().copied().fold(0.0, f64::max);
        assert!((own[vertex] - 0.2).abs() < 1e-12 && all[vertex] < 1e-12 && (farthest - 0.1).abs() < 1e-12);
        assert_eq!((own.iter().filter(|d| d.is_nan()).count(), all.iter().filter(|d| d.is_nan()).count()), (1, 1));
        let fidelity = measure(Team::alone(), &mesh, &model, &classification);
        assert!((fidelity.from_entity.unwrap().distance - 0.2).abs() < 1e-12);
        assert!((fidelity.from_model.unwrap().distance - 0.1).abs() < 1e-12);
        assert_eq!(fidelity.off, 2);
    }
}
