//! The corners of a wall: pairs of its faces that bend towards each other.
use crate::geometry::classify::Classification;
use crate::geometry::{Entity, Evaluate, Geometry, Model};
use crate::mesh::TetMesh;
use crate::mesh::vector::{add, dot, scale, sub};
use crate::sizing::walls::own_faces;
use std::collections::{BTreeMap, BTreeSet};

/// Faces whose normals at a vertex differ by less make no corner: the cosine of 1°. There the layers of the nearest face are those of both.
const SMOOTH: f64 = 0.999_847_7;

/// For each of some faces of a model those of them that make a corner with it, ascending: the domain of the mesh is between the two, as before the sides
/// of a step, and not around both, as about a trailing edge. It is seen at the vertices of the mesh that lie on both.
pub fn corners(mesh: &TetMesh, place: &Classification, model: &Model, faces: &[u32]) -> BTreeMap<u32, Vec<u32>> {
    let (topology, mut evaluator) = (model.topology(), model.evaluator());
    let asked: BTreeSet<u32> = faces.iter().copied().collect();
    let mut found: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
    for (&nodes, &face) in mesh.triangles.nodes.iter().zip(&place.faces).filter(|(_, face)| asked.contains(face)) {
        let [a, b, c] = nodes.map(|v| place.projected[v as usize]);
        let middle = scale(add(add(a, b), c), 1.0 / 3.0);
        for v in nodes.map(|v| v as usize) {
            if !matches!(place.entities[v], Entity::Edge(_) | Entity::Vertex(_)) {
                continue;
            }
            let own = own_faces(topology, place, &mut evaluator, v);
            let normals: Vec<_> =
                own.iter().filter(|own| own.0 == face).map(|&(face, uv)| evaluator.face_normal(face, uv)).collect();
            let into = sub(middle, place.projected[v]);
            for &(other, uv) in own.iter().filter(|own| own.0 != face && asked.contains(&own.0)) {
                if found.get(&face).is_some_and(|others| others.contains(&other)) {
                    continue;
                }
                // Outward is out of the mesh.
                let outward = evaluator.face_normal(other, uv);
                if dot(into, outward) < 0.0 && normals.iter().any(|normal| dot(*normal, outward) < SMOOTH) {
                    found.entry(face).or_default().insert(other);
                    found.entry(other).or_default().insert(face);
                }
            }
        }
    }
    found.into_iter().map(|(face, others)| (face, others.into_iter().collect())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Discrete;
    use crate::geometry::discrete::{DiscreteOptions, complete_boundary};
    use crate::mesh::Elements;
    use crate::mesh::samples::cube;
    use crate::tasks::Team;

    /// Within a cube each side is before the four beside it; about a hole in its middle no side is before another.
    #[test]
    fn sides_of_a_cube_make_corners_inside_and_none_outside() {
        let mut mesh = cube(3);
        let middle = |nodes: &[u32; 4]| {
            let sum = nodes.iter().fold([0.0; 3], |sum, &v| add(sum, mesh.vertices[v as usize]));
            scale(sum, 0.25)
        };
        let is_in_hole = |nodes: &[u32; 4]| middle(nodes).iter().all(|x| (1.0 / 3.0..2.0 / 3.0).contains(x));
        let mut kept = Elements::default();
        mesh.tets
            .iter()
            .filter(|(nodes, _)| !is_in_hole(nodes))
            .for_each(|(nodes, reference)| kept.push(nodes, reference));
        assert_eq!(kept.len() + 6, mesh.tets.len());
        mesh.tets = kept;
        complete_boundary(Team::alone(), &mut mesh);
        let (surface, place) = Discrete::new(Team::alone(), &mesh, &DiscreteOptions::default()).unwrap();
        let model = Model::Discrete(surface);
        let faces: Vec<u32> = (0..model.topology().faces.len() as u32).collect();
        assert_eq!(faces.len(), 12);
        let found = corners(&mesh, &place, &model, &faces);
        assert_eq!(found.len(), 6);
        for (face, others) in &found {
            assert_eq!(others.len(), 4, "{face}: {others:?}");
            assert!(others.iter().all(|other| found[other].contains(face)));
        }
    }
}
