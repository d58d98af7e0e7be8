//! How far a model is from the middles of the edges that a mesh has on it: the background metric is of second degree there.
use crate::geometry::classify::Classification;
use crate::geometry::{Evaluate, Geometry, Model};
use crate::mesh::TetMesh;
use crate::mesh::adjacency::{MatchedFaces, sorted2};
use crate::mesh::vector::{Vec3, lerp, sub};
use crate::metric::{Background, Rise, Sym3};
use crate::tasks::{GRAIN, Team};
use std::sync::Arc;

/// An edge rises whose middle is farther from the model than this, in the metric of one of its ends.
const LEAST: f64 = 0.25;

/// An edge of the mesh, and where on the model it is: on an edge (before), or on a face.
type Edge = ([u32; 2], On);

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum On {
    Edge(u32),
    Face(u32),
}

/// A metric at the vertices of a mesh, on its model.
///
/// # Panics
/// As of [`Background::on`].
pub fn background(
    team: Team<'_>,
    (mesh, faces): (&Arc<TetMesh>, MatchedFaces),
    on: (&Classification, &Model),
    logs: Vec<Sym3>,
) -> Background {
    let rises = rises(team, (&mesh.vertices, &mesh.triangles.nodes), on, &logs);
    Background::on(team, Arc::clone(mesh), faces, logs).of_second_degree(team, &rises)
}

/// The edges whose middles are farther from the model than a quarter in the metric, ascending, each with the way from its middle to the model, length. Of
/// triangles, shape (t, 3), on vertices, shape (n, 3), that lie on the model as `place` has it, and ln M at these, shape (n,).
pub fn rises(
    team: Team<'_>,
    (vertices, triangles): (&[Vec3], &[[u32; 3]]),
    (place, model): (&Classification, &Model),
    logs: &[Sym3],
) -> Vec<Rise> {
    let mut edges: Vec<Edge> = place.ridges.iter().map(|&(nodes, edge)| (sorted2(nodes), On::Edge(edge))).collect();
    edges.extend(team.collect(GRAIN, triangles.len(), |range, edges| {
        for ([a, b, c], &face) in triangles[range.clone()].iter().copied().zip(&place.faces[range]) {
            if !model.is_plane(face) {
                edges.extend([[a, b], [b, c], [c, a]].map(|nodes| (sorted2(nodes), On::Face(face))));
            }
        }
    }));
    team.sort_by(&mut edges, Ord::cmp);
    edges.dedup_by_key(|(nodes, _)| *nodes);
    team.collect(GRAIN / 4, edges.len(), |range, found| {
        let mut evaluator = model.evaluator();
        for &(nodes, on) in &edges[range] {
            let [a, b] = nodes.map(|v| vertices[v as usize]);
            let middle = lerp(a, b, 0.5);
            let foot = match on {
                On::Edge(edge) => evaluator.closest_on_edge(edge, middle, None).point,
                On::Face(face) => {
                    let guess = nodes.iter().find_map(|&v| place.parameters_on(&mut evaluator, v, face));
                    evaluator.closest_on_face(face, middle, guess).point
                }
            };
            let rise = sub(foot, middle);
            if nodes.iter().any(|&v| logs[v as usize].exp().quadratic(rise) > LEAST * LEAST) {
                found.push((nodes, rise));
            }
        }
    })
}
