//! Finds the narrow voids: boundary triangles that face each other across a void, nearer than they may move until they are looked for again.
use super::triangles::{Triangle, Triangles};
use super::{Narrow, Voids, bounds};
use crate::adapt::core::context::{Context, LONG};
use crate::adapt::core::ids::{FACE, VertexId};
use crate::adapt::core::store::Store;
use crate::geometry::Entity;
use crate::mesh::box_tree::{Bounds, BoxTree};
use crate::mesh::triangle_pair::{Corners, way};
use crate::mesh::vector::{Vec3, add, area2, dot, norm, scale, sub, unit};
use crate::metric::quality::edge_length;
use crate::tasks::{GRAIN, Team};
use std::sync::RwLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// Until voids are looked for again, edges get longer by at most this factor.
const GROWTH: f64 = 2.5;

/// At the end of a run hardly an edge is longer in the metric than this.
const LONGEST: f64 = 2.0 * LONG;

/// Chords rise at most so many times as high as the bend of the surface at their ends tells.
const SAFETY: f64 = 1.5;

/// Part of a reach that counts across the normal: model edges move within their faces.
const SIDEWAYS: f64 = 0.3;

/// A bend below this part of an edge is rounding.
const STRAIGHT: f64 = 1e-9;

/// Triangles whose normals have a greater cosine do not face each other.
const FACING: f64 = 0.5;

/// The boxes about triangles that are held are so much larger than these, in parts of their sides.
const HELD: f64 = 0.25;

/// The face of a triangle that is a face to another part of a larger mesh.
const CUT: u32 = u32::MAX;

/// A triangle of the boundary.
#[derive(Clone, Copy)]
struct Wall {
    vertices: [VertexId; 3],
    /// Seen from outside.
    corners: Corners,
    face: u32,
}

impl Voids {
    /// The narrow voids of a mesh, for edges that get longer by no more than [`GROWTH`]. Between sweeps only.
    pub fn of(team: Team<'_>, context: &Context<'_>) -> Self {
        let walls = Walls::of(team, context);
        let reaches = reaches(team, context, &walls, Until::Growth);
        let mut zone = beside_held(context, &walls);
        if reaches.iter().any(|reach| *reach > 0.0) {
            let boxes = walls.boxes(team, &reaches);
            zone.extend(near_others(team, &walls, &reaches, &boxes, false).into_iter().map(|i| boxes[i]));
        }
        if zone.is_empty() {
            return Self::default();
        }
        let narrow = Narrow::new(zone);
        let Walls { all: mut walls, mut cuts, .. } = walls;
        walls.append(&mut cuts);
        let inside = team.collect(GRAIN, walls.len(), |range, inside| {
            let met = walls[range].iter().filter(|wall| narrow.meets(&wall.corners));
            inside.extend(met.map(|&Wall { vertices, corners, .. }| Triangle { vertices, corners }));
        });
        Self { narrow: Some(Narrow { triangles: RwLock::new(Triangles::new(inside)), ..narrow }) }
    }

    /// Whether there are none even when all edges are as long as the metric allows. Between sweeps only.
    pub fn are_none_to_come(team: Team<'_>, context: &Context<'_>) -> bool {
        let walls = Walls::of(team, context);
        if !beside_held(context, &walls).is_empty() {
            return false;
        }
        let reaches = reaches(team, context, &walls, Until::End);
        let boxes = walls.boxes(team, &reaches);
        reaches.iter().all(|reach| *reach == 0.0) || near_others(team, &walls, &reaches, &boxes, true).is_empty()
    }
}

/// How long edges may get.
#[derive(Clone, Copy)]
enum Until {
    /// By [`GROWTH`], but no longer than the metric allows.
    Growth,
    /// As long as they are at the end of a run ([`LONGEST`]), and by [`GROWTH`] where that is more.
    End,
}

impl Until {
    /// By how much an edge of this length in the metric may grow.
    fn growth(self, length: f64) -> f64 {
        match self {
            Self::Growth => (LONG / length).clamp(1.0, GROWTH),
            Self::End => (LONGEST / length).max(GROWTH),
        }
    }
}

/// The triangles of the boundary, each with the mean normals of its face at its corners.
struct Walls {
    all: Vec<Wall>,
    normals: Vec<[Vec3; 3]>,
    /// Where the mesh is a part of a larger one: its faces to other parts.
    cuts: Vec<Wall>,
}

impl Walls {
    fn of(team: Team<'_>, context: &Context<'_>) -> Self {
        let is_cut = |wall: &Wall| wall.face == CUT;
        let walls = walls(team, &context.store);
        // Most meshes are no part of a larger one.
        let has_cuts = walls.iter().any(is_cut);
        let (cuts, all) = if has_cuts { walls.into_iter().partition(is_cut) } else { (Vec::new(), walls) };
        let normals = normals(team, context, &all);
        Self { all, normals, cuts }
    }

    /// Boxes about all triangles with all that they may come to fill.
    fn boxes(&self, team: Team<'_>, reaches: &[f64]) -> Vec<Bounds> {
        team.map(GRAIN, self.all.len(), |i| bounds(&self.all[i].corners, reaches[i]))
    }
}

/// The triangles of the boundary, with those of cuts.
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
                // Without a tag it is a face to another part of a larger mesh.
                let face = if tags[i] == 0 { CUT } else { tags[i] - 1 };
                walls.push(Wall { vertices, corners: vertices.map(|v| store.position(v)), face });
            }
        }
    })
}

/// Boxes about the triangles of a curved surface at vertices that must not move, and about faces to other parts at these vertices. Short edges
/// beside long chords that stay may fold the surface, and bring it through what stays. Triangles that cannot change need no box.
fn beside_held(context: &Context<'_>, walls: &Walls) -> Vec<Bounds> {
    let mut is_held = vec![false; context.store.vertex_bound()];
    let mut boxes = Vec::new();
    let mut add = |wall: &Wall| {
        let [low, high] = bounds(&wall.corners, 0.0);
        boxes.push(bounds(&wall.corners, HELD * (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max)));
    };
    for wall in walls.all.iter().filter(|wall| context.planes[wall.face as usize].is_none()) {
        let [a, b, c] = wall.vertices;
        if [[a, b], [b, c], [c, a]].iter().all(|&[x, y]| context.required.has_edge(x, y)) {
            continue;
        }
        let mut held = wall.vertices.into_iter().filter(|&v| context.is_frozen(v)).peekable();
        if held.peek().is_some() {
            add(wall);
            held.for_each(|v| is_held[v.index()] = true);
        }
    }
    walls.cuts.iter().filter(|wall| wall.vertices.iter().any(|v| is_held[v.index()])).for_each(add);
    boxes
}

/// How far the surface may move at each triangle: as the chords rise at its vertices.
fn reaches(team: Team<'_>, context: &Context<'_>, Walls { all: walls, normals, .. }: &Walls, until: Until) -> Vec<f64> {
    let rises = team.map(GRAIN, walls.len(), |i| rise(context, &walls[i], &normals[i], until));
    let mut at = vec![0.0f64; context.store.vertex_bound()];
    for (wall, rise) in walls.iter().zip(rises) {
        wall.vertices.iter().for_each(|v| at[v.index()] = at[v.index()].max(rise));
    }
    team.map(GRAIN, walls.len(), |i| walls[i].vertices.iter().fold(0.0, |most, v| at[v.index()].max(most)))
}

/// The mean normals of each triangle's face at its corners; on a plane they are not asked for.
fn normals(team: Team<'_>, context: &Context<'_>, walls: &[Wall]) -> Vec<[Vec3; 3]> {
    let store = &context.store;
    let is_curved = |wall: &Wall| context.planes[wall.face as usize].is_none();
    let area = |[a, b, c]: Corners| area2(a, b, c);
    // Inside a face the triangles at a vertex are all of one face.
    let mut of_inner = vec![[0.0; 3]; store.vertex_bound()];
    let mut corners: Vec<(u32, VertexId, u32)> = Vec::new();
    for (wall, i) in walls.iter().zip(0..).filter(|(wall, _)| is_curved(wall)) {
        let area = area(wall.corners);
        for (k, v) in (0..).zip(wall.vertices) {
            match store.dimension(v) {
                2 => of_inner[v.index()] = add(of_inner[v.index()], area),
                _ => corners.push((wall.face, v, 3 * i + k)),
            }
        }
    }
    let mut normals = team.map(GRAIN, walls.len(), |i| walls[i].vertices.map(|v| unit(of_inner[v.index()])));
    team.sort(&mut corners);
    for same in corners.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let sum = same.iter().fold([0.0; 3], |sum, corner| add(sum, area(walls[corner.2 as usize / 3].corners)));
        for &(_, _, at) in same {
            normals[at as usize / 3][at as usize % 3] = unit(sum);
        }
    }
    normals
}

/// How high the chords at a triangle may rise.
fn rise(context: &Context<'_>, wall: &Wall, normals: &[Vec3; 3], until: Until) -> f64 {
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
        let growth = until.growth(edge_length(edge, &store.metric(a), &store.metric(b)));
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

/// The triangles that are nearer to another, across a void, than both may move: all, or (`is_any_enough`) some if there are any.
fn near_others(
    team: Team<'_>,
    Walls { all: walls, normals: mean_normals, .. }: &Walls,
    reaches: &[f64],
    boxes: &[Bounds],
    is_any_enough: bool,
) -> Vec<usize> {
    let tree = BoxTree::on(team, walls.len(), |i| boxes[i as usize]);
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
    let cones = tree.of_nodes(team, |items| Cone::of(items.iter().map(|&i| normals[i as usize])));
    let is_over = AtomicBool::new(false);
    let may_face = |leaf: usize, node: usize| !is_over.load(Ordering::Relaxed) && cones[leaf].may_face(&cones[node]);
    let pairs = tree.overlapping_pairs(
        team,
        |i| boxes[i as usize],
        may_face,
        |near: &mut Vec<u32>, i, j| {
            if are_near(i as usize, j as usize) {
                near.extend([i, j]);
                is_over.fetch_or(is_any_enough, Ordering::Relaxed);
            }
        },
    );
    let mut near = vec![false; walls.len()];
    pairs.iter().flatten().for_each(|&i| near[i as usize] = true);
    (0..walls.len()).filter(|&i| near[i]).collect()
}

/// Directions about an axis.
#[derive(Clone, Copy)]
struct Cone {
    axis: Vec3,
    /// Cosine and sine of the greatest angle from the axis.
    angle: [f64; 2],
}

impl Cone {
    /// About these directions.
    fn of(directions: impl Iterator<Item = Vec3> + Clone) -> Self {
        let axis = unit(directions.clone().fold([0.0; 3], add));
        let cosine = directions.map(|d| dot(d, axis)).fold(1.0, f64::min);
        Self { axis, angle: [cosine, sine(cosine)] }
    }

    /// Whether triangles with normals in these two may face each other ([`FACING`]).
    fn may_face(&self, other: &Self) -> bool {
        let cosine = dot(self.axis, other.axis);
        let angles = [[cosine, sine(cosine)], self.angle, other.angle];
        // The cosine of the sum of the angles: of one and two, then with the third. It falls as long as the sum is below 180°.
        let sum = |[c, s]: [f64; 2], [d, t]: [f64; 2]| [c * d - s * t, s * d + c * t];
        let are_acute = angles.iter().all(|angle| angle[0] > 0.0);
        let two = sum(angles[0], angles[1]);
        !(are_acute && two[0] > 0.0 && sum(two, angles[2])[0] > FACING + 1e-12)
    }
}

fn sine(cosine: f64) -> f64 {
    (1.0 - cosine * cosine).max(0.0).sqrt()
}
