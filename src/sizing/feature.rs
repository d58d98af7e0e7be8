//! Thin parts and gaps: entities that come near each other and do not touch.
//!
//! For each point of the boundary the closest points of the other entities are found, on the model itself and not on the mesh, so that a
//! coarse mesh gets a gap as it is. Entities of bodies that are not connected do not count: nothing is meshed between them, and where they
//! touch (a ball in its race) a gap has no end. A tree of boxes over pieces of the model tells which entities may be near. The size is
//! limited only along the direction of the gap (METHOD.md §1.13).
use super::bodies::Bodies;
use super::bound::{Bound, across, away, may_face};
use super::curvature::{Local, cut};
use super::others::{Found, Other};
use super::pieces::pieces;
use super::sight::Obstacles;
use super::touch::Touch;
use super::tree::{Box3, Tree, meet};
use crate::geometry::classify::Classification;
use crate::geometry::{Entity, Evaluate, Evaluator, Geometry, Model, Topology};
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, distance, dot, norm, scale, sub, unit};
use crate::metric::Sym3;
use crate::tasks::Team;
use serde::Serialize;
use std::collections::BinaryHeap;

/// A gap goes across a face if its direction makes at most 60° with the normal,
pub(super) const ACROSS: f64 = 0.5;
/// and the other face looks back, or at least not away by more than this cosine.
const AWAY: f64 = 0.25;
/// A gap goes across an edge if its direction makes at least 45° with the tangent.
pub(super) const ALONG: f64 = 0.707;
/// A gap limits nothing where the way across it already has this share of its cells. A way that leans, as to the rim of a face across a thin part,
/// has them once the nearest gap is limited; limited itself, it would make the sizes along the walls small.
const DIVIDED: f64 = 0.9;
/// Entities nearer than this share of the diagonal touch, whether the model says so or not.
const TOUCHING: f64 = 1e-7;

/// Two entities that come near.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gap {
    /// How near, model units.
    pub distance: f64,
    /// From where.
    pub at: Vec3,
    /// On which entity that is.
    pub from: Entity,
    /// The other one.
    pub to: Entity,
}

impl Gap {
    /// The nearer of two.
    pub(super) fn nearer(a: Option<Self>, b: Option<Self>) -> Option<Self> {
        match (a, b) {
            (Some(a), Some(b)) => Some(if b.distance < a.distance { b } else { a }),
            (a, b) => a.or(b),
        }
    }
}

/// A point of the boundary.
#[derive(Clone, Copy)]
pub struct Place {
    /// Where it is, on the model.
    pub point: Vec3,
    /// On what.
    pub entity: Entity,
    /// The mesh vertex there; none between vertices.
    pub vertex: Option<u32>,
    /// The mesh triangle there; none on an edge or at a vertex.
    pub triangle: Option<u32>,
}

/// Scratch of one thread.
#[derive(Default)]
pub struct Scratch {
    /// Pieces of other entities that may limit the metric, those of an entity one after the other.
    pieces: Vec<(Entity, u32)>,
    others: BinaryHeap<Other>,
}

/// The entities of a model, for finding those near a place.
pub struct Near<'a> {
    topology: &'a Topology,
    mesh: &'a TetMesh,
    place: &'a Classification,
    touch: Touch<'a>,
    bodies: Bodies<'a>,
    sight: Obstacles<'a>,
    pieces: Tree,
    boxes: Vec<Box3>,
    owners: Vec<Entity>,
    cells: f64,
    least: f64,
    /// What is nearer touches.
    touching: f64,
    /// Whether normals tell the sides of a face apart: not where two solids may share it.
    has_sides: bool,
}

impl<'a> Near<'a> {
    /// So many cells across, sizes between these.
    pub fn new(
        team: Team<'_>,
        mesh: &'a TetMesh,
        place: &'a Classification,
        model: &'a Model,
        cells: f64,
        [least, greatest]: [f64; 2],
    ) -> Self {
        let topology = model.topology();
        let (boxes, owners): (Vec<Box3>, Vec<Entity>) = pieces(team, model, greatest).into_iter().unzip();
        Self {
            topology,
            mesh,
            place,
            touch: Touch::new(model, TOUCHING * topology.diagonal()),
            bodies: Bodies::new(topology, mesh, place),
            sight: Obstacles::new(team, mesh),
            pieces: Tree::new(team, &boxes),
            boxes,
            owners,
            cells,
            least,
            touching: topology.tolerance.max(TOUCHING * topology.diagonal()),
            has_sides: topology.solids <= 1,
        }
    }

    /// The metric at a place, limited across the gaps there, and the nearest gap that limits it. `local` has the directions of the entities
    /// at the place. `known` is a metric whose sizes the final one does not exceed: only gaps that limit it too are looked for, and they limit
    /// it as well.
    ///
    /// The nearest entity limits first; often it leaves nothing to do for those behind it. Closest points cost most, so that of an entity
    /// is found only when its boxes say that it is the next, and that it could still limit the metric.
    pub fn limit(
        &self,
        evaluator: &mut Evaluator,
        at: &Place,
        local: &Local,
        mut metric: Sym3,
        known: &mut Sym3,
        Scratch { pieces, others }: &mut Scratch,
    ) -> (Sym3, Option<Gap>) {
        let reach = self.cells / known.eigen().values[0].sqrt();
        let mut list = std::mem::take(others).into_vec();
        self.collect(at, local, *known, reach, pieces, &mut list);
        *others = BinaryHeap::from(list);
        let mut nearest: Option<Gap> = None;
        let mut thinnest = f64::INFINITY;
        let mut bound = Bound::new(at, local, *known, self.cells);
        while let Some(Other { length, to, found }) = others.pop() {
            if length >= bound.reach() {
                break;
            }
            let Some(Found { there, normal }) = found else {
                let begin = pieces.partition_point(|piece| piece.0 < to);
                let own = pieces[begin..].iter().take_while(|piece| piece.0 == to);
                let found = if own.clone().any(|piece| bound.may_limit(&self.boxes[piece.1 as usize])) {
                    self.closest(evaluator, at, to, reach.min(bound.reach()))
                } else {
                    None
                };
                match found.map(|found| (distance(at.point, found.there), found)) {
                    Some((length, found)) if length < reach && length > self.touching => {
                        others.push(Other { length, to, found: Some(found) });
                    }
                    _ => {}
                }
                continue;
            };
            let way = scale(sub(there, at.point), 1.0 / length);
            let across = across(way, at, local);
            let share = norm(across);
            let (g, size) = (unit(across), (share * length / self.cells).max(self.least));
            // The line of sight is tested last: it costs most.
            let is_small = dot(g, known.solve(g)) <= size * size || metric.quadratic(g).sqrt() * size >= DIVIDED;
            if share < ALONG || is_small || !self.is_facing(local, way, normal) {
                continue;
            }
            let in_face = normal.is_none() && self.touch.share_face(at.entity, edge_of(to));
            if in_face || self.sight.is_clear(at.point, there, |triangle| self.is_own(at, to, triangle)) {
                (metric, *known) = (cut(metric, g, size), cut(*known, g, size));
                bound = Bound::new(at, local, *known, self.cells);
                thinnest = thinnest.min(size);
                nearest = nearest.or(Some(Gap { distance: length, at: at.point, from: at.entity, to }));
            }
        }
        (chord_limited(metric, thinnest, local.greatest_curvature), nearest)
    }

    /// The entities within reach that may limit the metric, and their pieces in the entities' order.
    fn collect(
        &self,
        at: &Place,
        local: &Local,
        metric: Sym3,
        reach: f64,
        pieces: &mut Vec<(Entity, u32)>,
        others: &mut Vec<Other>,
    ) {
        let bound = Bound::new(at, local, metric, self.cells);
        pieces.clear();
        others.clear();
        let about = [at.point.map(|x| x - reach), at.point.map(|x| x + reach)];
        // From inside a face edges are not asked: the faces beside them are.
        let faces_only = at.entity.dimension() == 2;
        let admits = |part: &Box3| meet(part, &about) && bound.may_limit(part) && may_face(at, local, part, faces_only);
        self.pieces.each_where(admits, |piece| {
            let owner = self.owners[piece as usize];
            let is_face = owner.dimension() == 2;
            if is_face && (faces_only || may_face(at, local, &self.boxes[piece as usize], true))
                || !is_face && !faces_only
            {
                pieces.push((owner, piece));
            }
            true
        });
        pieces.sort_unstable();
        let mut last = None;
        for &(to, piece) in pieces.iter() {
            let length = away(at.point, &self.boxes[piece as usize]);
            if last == Some(to) {
                if let Some(other) = others.last_mut().filter(|other| other.to == to) {
                    other.length = other.length.min(length);
                }
                continue;
            }
            last = Some(to);
            if !self.touch.touches(at.entity, to) && !self.bodies.are_apart(at.entity, to) {
                others.push(Other { length, to, found: None });
            }
        }
    }

    /// The closest point of another entity within the limit, and the normal there of a face.
    fn closest(&self, evaluator: &mut Evaluator, at: &Place, to: Entity, limit: f64) -> Option<Found> {
        match to {
            Entity::Face(face) => {
                let on = evaluator.closest_on_face_within(face, at.point, limit)?;
                Some(Found { there: on.point, normal: Some(evaluator.face_normal(face, on.uv)) })
            }
            Entity::Edge(edge) => {
                let on = evaluator.closest_on_edge_within(edge, at.point, limit)?;
                Some(Found { there: on.point, normal: None })
            }
            _ => None,
        }
    }

    /// Whether a face with this normal lies opposite to one of the faces at the place, in the direction g. An edge (no normal) always does.
    fn is_facing(&self, local: &Local, g: Vec3, normal: Option<Vec3>) -> bool {
        let Some(normal) = normal else { return true };
        let faces = |&own: &Vec3| {
            let cosine = dot(own, g);
            let looks_away = self.has_sides && cosine.signum() * dot(normal, g) > AWAY;
            cosine.abs() >= ACROSS && !looks_away
        };
        local.normals.is_empty() || local.normals.iter().any(faces)
    }

    /// Whether a triangle belongs to one end of a gap.
    fn is_own(&self, at: &Place, to: Entity, triangle: u32) -> bool {
        let face = self.place.faces[triangle as usize];
        let beside = match to {
            Entity::Face(other) => face == other,
            Entity::Edge(edge) => self.topology.edges[edge as usize].faces.contains(&face),
            Entity::Vertex(_) | Entity::Interior => false,
        };
        let here = match (at.vertex, at.triangle, at.entity) {
            (Some(vertex), ..) => self.mesh.triangles.nodes[triangle as usize].contains(&vertex),
            (None, Some(own), _) => own == triangle,
            (None, None, Entity::Edge(edge)) => self.topology.edges[edge as usize].faces.contains(&face),
            _ => false,
        };
        beside || here
    }
}

/// Bounds all sizes so that an edge along a wall of this curvature has its middle no farther from the wall than `across`. Otherwise thin
/// cells on a sliver of a curved face would stand out of the wall, and no mesh could follow them.
fn chord_limited(metric: Sym3, across: f64, curvature: f64) -> Sym3 {
    let along = (8.0 * across / curvature).sqrt();
    let reaches = along.is_finite() && metric.eigen().values[0] * along * along < 1.0;
    if reaches { metric.intersect(&Sym3::IDENTITY.times(along.max(across).powi(-2))) } else { metric }
}

fn edge_of(entity: Entity) -> u32 {
    if let Entity::Edge(edge) = entity { edge } else { u32::MAX }
}
