//! Bounds, from the boxes of its pieces, on what another entity may ask of a place: they spare most closest points.
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

/// What a gap must be like to limit a metric: with w the part across of the way there, |w|/cells < √(gᵀM⁻¹g), g = w/|w|.
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

    /// How long a gap that limits it may be: on an edge it leans along that by 45° at most.
    pub fn reach(&self) -> f64 {
        let share = if matches!(self.at.entity, Entity::Edge(_)) { ALONG } else { 1.0 };
        self.cells * self.greatest / share * (1.0 + SLACK)
    }

    /// Whether a gap to a point of this box may limit it: |w|² < cells √(wᵀM⁻¹w) for no w within the box's radius of its middle's.
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

/// Whether a gap to a point of this box may go across what lies at the place: if not for any piece of an entity, its closest point
/// need not be looked for. Of an edge (not `is_face`) its tangent alone counts.
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

/// What of a direction goes across the edge that a place lies on: near its end the way to another edge leans along it, and sizes along it
/// are not the gap's.
pub fn across(direction: Vec3, at: &Place, local: &Local) -> Vec3 {
    match (at.entity, &local.tangents[..]) {
        (Entity::Edge(_), &[tangent, ..]) => sub(direction, scale(tangent, dot(direction, tangent))),
        _ => direction,
    }
}
