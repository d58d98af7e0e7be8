//! Where points belong on the model that were added to its surface while that was filled.
use crate::delaunay::{Origin, Tetrahedra};
use crate::geometry::{Entity, Evaluate, Geometry, Model};
use crate::mesh::adjacency::sorted2;
use crate::mesh::vector::Vec3;
use std::collections::BTreeMap;

/// The place of an added point.
#[cfg_attr(not(feature = "occt"), expect(dead_code, reason = "triangles take the point alone"))]
pub struct OnModel {
    /// Its number.
    pub vertex: u32,
    /// An edge or a face.
    pub entity: Entity,
    /// t of an edge, u and v of a face.
    pub parameters: [f64; 2],
    /// The point of the model, model units.
    pub point: Vec3,
}

/// The places of all that were added on the surface; `face_of` is the model's face of a triangle of the input. `curves` are the model's edges
/// by the ends of their pieces, which are divided here as the points divide them.
pub fn places(
    model: &Model,
    filled: &Tetrahedra,
    face_of: impl Fn(u32) -> u32,
    curves: &mut BTreeMap<[u32; 2], u32>,
) -> Vec<OnModel> {
    let mut evaluator = model.evaluator();
    let mut faces = vec![None; filled.points.len()];
    for (nodes, &source) in filled.triangles.iter().zip(&filled.source) {
        nodes.iter().for_each(|&v| faces[v as usize] = Some(face_of(source)));
    }
    let first = filled.points.len() - filled.added.len();
    let mut found = Vec::new();
    for (added, vertex) in filled.added.iter().zip(first as u32..) {
        let divided = match added.origin {
            Origin::Edge(ends) => curves.remove(&sorted2(ends)).map(|edge| (ends, edge)),
            Origin::Triangle(_) | Origin::Inside => None,
        };
        if let Some((ends, edge)) = divided {
            curves.extend(ends.map(|end| (sorted2([end, vertex]), edge)));
            let on = evaluator.closest_on_edge(edge, added.point, None);
            found.push(OnModel { vertex, entity: Entity::Edge(edge), parameters: [on.t, 0.0], point: on.point });
        } else if let Some(face) = faces[vertex as usize] {
            let on = evaluator.closest_on_face(face, added.point, None);
            found.push(OnModel { vertex, entity: Entity::Face(face), parameters: on.uv, point: on.point });
        }
    }
    found
}
