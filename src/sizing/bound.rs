//! Bounds on how another entity may limit the metric at a place, from the boxes of its pieces. They save most searches for closest points.
use super::curvature::Local;
use super::feature::{ACROSS, ALONG, Place};
use super::tree::Box3;
use crate::geometry::Entity;
use crate::mesh::vector::{Vec3, distance, dot, lerp, norm, scale, sub};
use crate::metric::{Eigen, Sym3};

/// How far a box is.
pub fn away(point: Vec3, piece: &Box3) -> f64 {
    norm(std::array::from_fn(|i| (piece[0][i] - point[i]).max(point[i] - piece[1][i]).max(0.0)))
}

/// When a gap limits a metric: |w|/cells < √(gᵀM⁻¹g), with w the way there, on an edge its part across the edge, and g = w/|w|.
pub struct Bound<'a> {
    at: &'a Place,
    local: &'a Local,
    /// M⁻¹.
    inverse: Sym3,
    cells: f64,
    /// Greatest size.
    greatest: f64,
}

impl<'a> Bound<'a> {
    /// At a place, for its metric so far.
    pub fn new(at: &'a Place, local: &'a Local, metric: Sym3, cells: f64) -> Self {
        let eigen = metric.eigen_spd();
        let inverse = Sym3::from_eigen(&Eigen { values: eigen.values.map(|value| 1.0 / value), ..eigen });
        Self { at, local, inverse, cells, greatest: eigen.values[0].sqrt().recip() }
    }

    /// The greatest length of a gap that limits the metric. On an edge its direction makes at least 45° with the tangent.
    pub fn reach(&self) -> f64 {
        let share = if matches!(self.at.entity, Entity::Edge(_)) { ALONG } else { 1.0 };
        self.cells * self.greatest / share * (1.0 + SLACK)
    }

    /// Whether a gap to a point of this box may limit the metric: |w|² < cells √(wᵀM⁻¹w) for some w that is within the box's radius of the
    /// way to its middle.
    pub fn may_limit(&self, piece: &Box3) -> bool {
        let middle = across(sub(lerp(piece[0], piece[1], 0.5), self.at.point), self.at, self.local);
        let radius = 0.5 * distance(piece[0], piece[1]);
        let least = (norm(middle) - radius).max(0.0);
        let most = self.inverse.quadratic(middle).sqrt() + radius * self.greatest;
        least * least < self.cells * most * (1.0 + SLACK)
    }
}

/// Rounding of bounds.
const SLACK: f64 = 1e-9;

/// Whether a gap to a point of this box may go across the faces or the edge at the place. If that holds for no piece of an entity, its
/// closest point is not needed. For a box of an edge (not `is_face`) only the tangent at the place counts.
pub fn may_face(at: &Place, local: &Local, piece: &Box3, is_face: bool) -> bool {
    let middle = sub(lerp(piece[0], piece[1], 0.5), at.point);
    let (radius, away) = (0.5 * distance(piece[0], piece[1]), norm(middle));
    if away <= 1.5 * radius {
        return true;
    }
    // Seen from the place the box is within this angle β of its middle.
    let sine = radius / away;
    let cosine = (1.0 - sine * sine).sqrt();
    let along = |axis: Vec3| dot(axis, middle).abs() / away;
    let beside = match (at.entity, &local.tangents[..]) {
        // At least 45° − β from the tangent,
        (Entity::Edge(_), &[tangent, ..]) => along(tangent) <= ALONG * (cosine + sine),
        _ => true,
    };
    // and at most 60° + β from a normal.
    let least = ACROSS * cosine - (1.0 - ACROSS * ACROSS).sqrt() * sine;
    let faces = || local.normals.is_empty() || local.normals.iter().any(|&normal| along(normal) >= least);
    beside && (!is_face || faces())
}

/// The part of a direction across the edge that the place lies on. Near the edge's end the way to another edge leans along it, and the
/// size along it is not the gap's to limit.
pub fn across(direction: Vec3, at: &Place, local: &Local) -> Vec3 {
    match (at.entity, &local.tangents[..]) {
        (Entity::Edge(_), &[tangent, ..]) => sub(direction, scale(tangent, dot(direction, tangent))),
        _ => direction,
    }
}
