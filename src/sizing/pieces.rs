//! Pieces of a model's faces and ridges, each in a box: samples of the model itself, whatever the mesh.
use super::tree::{Box3, EMPTY, box_of, join};
use crate::geometry::{Entity, Evaluate, Evaluator, Geometry, Model, SurfaceKind, Topology};
use crate::mesh::vector::distance;
use crate::tasks::Team;

/// Pieces of a face in each direction, and of an edge.
const PIECES: usize = 8;
/// Samples of a piece in each direction, its ends included.
const SAMPLES: usize = 3;
/// Between its samples a piece may leave their box by this share of its diagonal.
const MARGIN: f64 = 0.15;
/// An entity no larger than this share of the greatest size is one piece. Gaps reach about as far as the greatest size, so smaller boxes
/// would rule out little more.
const SMALL: f64 = 0.25;

/// Boxes of the pieces of all faces and ridges, with the entity of each; for gaps that reach a few times the greatest size.
pub fn pieces(team: Team<'_>, model: &Model, greatest: f64) -> Vec<(Box3, Entity)> {
    let topology = model.topology();
    let faces = topology.faces.len();
    team.collect(1, faces + topology.edges.len(), |range, found| {
        let mut evaluator = model.evaluator();
        for i in range {
            if i < faces {
                pieces_of_face(topology, &mut evaluator, (i as u32, SMALL * greatest), found);
            } else if topology.is_ridge((i - faces) as u32) {
                pieces_of_edge(topology, &mut evaluator, ((i - faces) as u32, SMALL * greatest), found);
            }
        }
    })
}

fn pieces_of_face(
    topology: &Topology,
    evaluator: &mut Evaluator,
    (face, small): (u32, f64),
    found: &mut Vec<(Box3, Entity)>,
) {
    let entity = &topology.faces[face as usize];
    let (owner, slack) = (Entity::Face(face), topology.tolerance);
    if entity.kind == SurfaceKind::Discrete {
        // Its parameters are no chart.
        found.push((entity.bounds, owner));
        return;
    }
    if distance(entity.bounds[0], entity.bounds[1]) <= small {
        let [low, high] = entity.bounds;
        found.push(([low.map(|x| x - slack), high.map(|x| x + slack)], owner));
        return;
    }
    let mut box_at = |i: usize, j: usize| {
        let mut all = EMPTY;
        for k in 0..SAMPLES * SAMPLES {
            let part = |cell: usize, k: usize| (cell as f64 + k as f64 / (SAMPLES - 1) as f64) / PIECES as f64;
            let at = [part(i, k / SAMPLES), part(j, k % SAMPLES)];
            let uv = [0, 1].map(|k: usize| entity.range[k][0] + at[k] * (entity.range[k][1] - entity.range[k][0]));
            let p = evaluator.face_frame(face, uv).point;
            all = join(all, [p, p]);
        }
        all
    };
    for (i, j) in (0..PIECES * PIECES).map(|k| (k / PIECES, k % PIECES)) {
        let [low, high] = widen(box_at(i, j));
        // No part of the face leaves its own box.
        let piece = [
            std::array::from_fn(|k| f64::max(low[k], entity.bounds[0][k] - slack)),
            std::array::from_fn(|k| f64::min(high[k], entity.bounds[1][k] + slack)),
        ];
        if (0..3).all(|k| piece[0][k] <= piece[1][k]) {
            found.push((piece, owner));
        }
    }
}

fn pieces_of_edge(
    topology: &Topology,
    evaluator: &mut Evaluator,
    (edge, small): (u32, f64),
    found: &mut Vec<(Box3, Entity)>,
) {
    let [first, last] = topology.edges[edge as usize].range;
    let begin = found.len();
    for i in 0..PIECES {
        let at = |k: usize| (i as f64 + k as f64 / (SAMPLES - 1) as f64) / PIECES as f64;
        let points = (0..SAMPLES).map(|k| evaluator.edge_frame(edge, first + at(k) * (last - first)).point);
        found.push((widen(box_of(points)), Entity::Edge(edge)));
    }
    let all = found[begin..].iter().fold(EMPTY, |all, piece| join(all, piece.0));
    if distance(all[0], all[1]) <= small {
        found.truncate(begin);
        found.push((all, Entity::Edge(edge)));
    }
}

/// The box with its margin.
fn widen([low, high]: Box3) -> Box3 {
    let margin = MARGIN * distance(low, high);
    [low.map(|x| x - margin), high.map(|x| x + margin)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Discrete;
    use crate::mesh::samples::cube;

    #[test]
    fn boxes_hold_the_points_of_their_entities() {
        let (model, _) = Discrete::from_mesh(Team::alone(), &cube(3), 30.0).unwrap();
        let model = Model::Discrete(model);
        assert_eq!(pieces(Team::alone(), &model, 10.0).len(), 6 + 12);
        let found = pieces(Team::alone(), &model, 1.0);
        assert_eq!(found.len(), 6 + 12 * PIECES);
        let mut evaluator = model.evaluator();
        for edge in 0..12 {
            let [first, last] = model.topology().edges[edge as usize].range;
            for i in 0..=50 {
                let p = evaluator.edge_frame(edge, first + f64::from(i) / 50.0 * (last - first)).point;
                let holds = |b: &Box3| (0..3).all(|k| b[0][k] <= p[k] && p[k] <= b[1][k]);
                assert!(found.iter().any(|(b, owner)| *owner == Entity::Edge(edge) && holds(b)));
            }
        }
    }
}
