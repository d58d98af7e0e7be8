//! Finds the narrow voids: boundary triangles that face each other across a void, nearer than they may move until they are looked for again.
use super::triangles::Triangle;
use super::{Narrow, Voids, bounds, overlap};
use crate::adapt::core::context::{Context, LONG};
use crate::adapt::core::ids::{FACE, VertexId};
use crate::adapt::core::store::Store;
use crate::geometry::Entity;
use crate::mesh::box_tree::{Bounds, BoxTree};
use crate::mesh::triangle_pair::{Corners, way};
use crate::mesh::vector::{Vec3, add, area2, dot, norm, scale, sub, unit};
use crate::metric::quality::edge_length;
use crate::tasks::{GRAIN, Team};

/// Triangles of which another's neighbours are looked for, a task.
const FEW: usize = 256;

/// Until voids are looked for again, edges get longer by at most this factor.
const GROWTH: f64 = 2.5;

/// Chords rise at most so many times as high as the bend of the surface at their ends tells.
const SAFETY: f64 = 1.5;

/// Part of a reach that counts across the normal: model edges move within their faces.
const SIDEWAYS: f64 = 0.3;

/// A bend below this part of an edge is rounding.
const STRAIGHT: f64 = 1e-9;

/// Triangles whose normals have a greater cosine do not face each other.
const FACING: f64 = 0.5;

/// A triangle of the boundary.
#[derive(Clone, Copy)]
struct Wall {
    vertices: [VertexId; 3],
    /// Seen from outside.
    corners: Corners,
    face: u32,
}

impl Voids {
    /// The narrow voids of a mesh. Between sweeps only.
    pub fn of(team: Team<'_>, context: &Context<'_>) -> Self {
        let walls = walls(team, &context.store);
        let normals = normals(team, context, &walls);
        let reaches = reaches(team, context, &walls, &normals);
        if reaches.iter().all(|reach| *reach == 0.0) {
            return Self::default();
        }
        let boxes: Vec<Bounds> =
            walls.iter().zip(&reaches).map(|(wall, reach)| bounds(&wall.corners, *reach)).collect();
        let zone: Vec<Bounds> =
            near_others(team, &walls, &normals, &reaches, &boxes).into_iter().map(|i| boxes[i]).collect();
        if zone.is_empty() {
            return Self::default();
        }
        let mut narrow = Narrow::new(zone);
        let inside = team.collect(GRAIN, walls.len(), |range, inside| {
            inside.extend(range.filter(|&i| narrow.meets(&walls[i].corners)));
        });
        let triangles = narrow.triangles.get_mut().expect("it is new");
        for i in inside {
            let Wall { vertices: mut key, corners, .. } = walls[i];
            key.sort_unstable();
            triangles.insert(Triangle { key, corners });
        }
        Self { narrow: Some(narrow) }
    }
}

/// The triangles of the boundary.
fn walls(team: Team<'_>, store: &Store) -> Vec<Wall> {
    team.collect(GRAIN, store.tet_bound(), |range, walls| {
        for t in store.live_tets_in(range) {
            let n = store.neighbours(t);
            if n.iter().all(|n| n.is_some()) {
                continue;
            }
            let (v, tags) = (store.vertices(t), store.tags(t));
            for i in (0..4).filter(|&i| !n[i].is_some()) {
                let [a, b, c] = FACE[i].map(|k| v[k]);
                let vertices = [a, c, b];
                walls.push(Wall { vertices, corners: vertices.map(|v| store.position(v)), face: tags[i].max(1) - 1 });
            }
        }
    })
}

/// How far the surface may move at each triangle: as the chords rise at its vertices.
fn reaches(team: Team<'_>, context: &Context<'_>, walls: &[Wall], normals: &[[Vec3; 3]]) -> Vec<f64> {
    let rises = team.map(GRAIN, walls.len(), |i| rise(context, &walls[i], &normals[i]));
    let mut at = vec![0.0f64; context.store.vertex_bound()];
    for (wall, rise) in walls.iter().zip(rises) {
        wall.vertices.iter().for_each(|v| at[v.index()] = at[v.index()].max(rise));
    }
    walls.iter().map(|wall| wall.vertices.iter().fold(0.0, |most, v| at[v.index()].max(most))).collect()
}

/// The mean normals of each triangle's face at its corners; on a plane they are not asked for.
fn normals(team: Team<'_>, context: &Context<'_>, walls: &[Wall]) -> Vec<[Vec3; 3]> {
    let mut corners = team.collect(GRAIN, walls.len(), |range, corners| {
        for i in range.filter(|&i| context.planes[walls[i].face as usize].is_none()) {
            corners.extend([0, 1, 2].map(|k| (walls[i].face, walls[i].vertices[k], (3 * i + k) as u32)));
        }
    });
    team.sort(&mut corners);
    let mut normals = vec![[[0.0; 3]; 3]; walls.len()];
    for same in corners.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let area = |at: u32| {
            let [a, b, c] = walls[at as usize / 3].corners;
            area2(a, b, c)
        };
        let normal = unit(same.iter().fold([0.0; 3], |sum, corner| add(sum, area(corner.2))));
        for &(_, _, at) in same {
            normals[at as usize / 3][at as usize % 3] = normal;
        }
    }
    normals
}

/// How high the chords at a triangle may rise.
fn rise(context: &Context<'_>, wall: &Wall, normals: &[Vec3; 3]) -> f64 {
    let store = &context.store;
    let mut most = 0.0f64;
    for k in 0..3 {
        let [i, j] = [k, (k + 1) % 3];
        let [a, b] = [wall.vertices[i], wall.vertices[j]];
        let edge = sub(wall.corners[j], wall.corners[i]);
        // A chord of an arc rises by an eighth of its length times the angle of the arc.
        let mut bend = dot(edge, sub(normals[j], normals[i])).abs() / 8.0;
        if store.ridge_curve(a, b).is_some() {
            bend = bend.max(norm(edge) * ridge_angle(store, a, b) / 8.0);
        }
        if bend <= STRAIGHT * norm(edge) {
            continue;
        }
        let growth = (LONG / edge_length(edge, &store.metric(a), &store.metric(b))).clamp(1.0, GROWTH);
        most = most.max((SAFETY * bend * growth * growth).min(norm(edge) * growth));
    }
    most
}

/// The angle of the arc of a model's edge between two neighbours on it.
fn ridge_angle(store: &Store, a: VertexId, b: VertexId) -> f64 {
    let along = unit(sub(store.position(b), store.position(a)));
    let turn = |v: VertexId| {
        let Entity::Edge(_) = store.entity(v) else { return 0.0 };
        let ends = store.ridge(v);
        if !ends.iter().all(|end| end.is_some()) {
            return 0.0;
        }
        let tangent = unit(sub(store.position(ends[1]), store.position(ends[0])));
        let tangent = scale(tangent, if dot(tangent, along) < 0.0 { -1.0 } else { 1.0 });
        norm(sub(tangent, along))
    };
    2.0 * turn(a).max(turn(b))
}

/// The triangles that are nearer to another, across a void, than both may move.
fn near_others(
    team: Team<'_>,
    walls: &[Wall],
    mean_normals: &[[Vec3; 3]],
    reaches: &[f64],
    boxes: &[Bounds],
) -> Vec<usize> {
    let tree = BoxTree::new(walls.len(), |i| boxes[i as usize]);
    let normal = |i: usize| {
        let [a, b, c] = walls[i].corners;
        unit(area2(a, b, c))
    };
    let normals = team.map(GRAIN, walls.len(), normal);
    let is_above =
        |i: usize, j: usize| walls[j].corners.iter().any(|p| dot(sub(*p, walls[i].corners[0]), normals[i]) > 0.0);
    // Long thin triangles across a curved wall may tilt towards each other, and yet it is one wall: there its mean normals tell.
    let side = |i: usize| mean_normals[i].into_iter().fold([0.0; 3], add);
    let is_one_wall = |i: usize, j: usize| walls[i].face == walls[j].face && dot(side(i), side(j)) > 0.0;
    let are_near = |i: usize, j: usize| {
        reaches[i] + reaches[j] > 0.0
            && dot(normals[i], normals[j]) < FACING
            && overlap(&boxes[i], &boxes[j])
            && !walls[i].vertices.iter().any(|v| walls[j].vertices.contains(v))
            && !is_one_wall(i, j)
            && is_above(i, j)
            && is_above(j, i)
            && {
                let way = way(&walls[i].corners, &walls[j].corners);
                let (length, along) = (norm(way), unit(way));
                // They meet along the way between them.
                let part = |cosine: f64| cosine.max(SIDEWAYS);
                let reach = reaches[i] * part(dot(normals[i], along)) + reaches[j] * part(-dot(normals[j], along));
                length <= reach
            }
    };
    team.collect(FEW, walls.len(), |range, near| {
        near.extend(range.filter(|&i| {
            let mut is_near = false;
            tree.overlapping(&boxes[i], |j| is_near = is_near || are_near(i, j as usize));
            is_near
        }));
    })
}
