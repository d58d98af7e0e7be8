//! The foot of a point on a wall: the distance, its gradient and its second derivatives there.
use crate::geometry::{Evaluate, Evaluator, OnSurface, SurfaceFrame, SurfaceKind, Topology};
use crate::mesh::vector::{Vec3, add, cross, dot, norm, scale, sub, unit};
use crate::metric::{Sym3, plane_basis};

/// The way from a face's closest point is along its normal if this share of it at most is across: 0.1° on a CAD model. Else the closest point is
/// on the face's border, and the distance is that from an edge or a vertex.
const ALONG: f64 = 2e-3;
/// The same on triangles that stand for a smooth surface, whose normals turn from one to the next: 30°.
const ALONG_TRIANGLES: f64 = 0.5;
/// In layers the way may be as far from the normal, 11°: a wedge between the two that is narrower than one cell of layers that grow by a fifth needs no
/// cells of its own about the border, as on a plane of symmetry that a wall meets nearly at right angles.
const WEDGE: f64 = 0.2;
/// At a pole or an apex the curvatures are those at parameters so far towards the middle of the face.
const NUDGE: f64 = 2e-3;
/// 1 − s κ is at least this: at the focal points of a wall the distance has no second derivatives.
const FOCAL: f64 = 1e-3;

/// The closest point of a wall to a point. There the distance d has the gradient `normal` and the second derivatives Σ cᵢ tᵢ tᵢᵀ.
#[derive(Clone, Copy, Debug)]
pub struct Foot {
    /// d, model units.
    pub distance: f64,
    /// Unit vector in which d grows: away from the wall.
    pub normal: Vec3,
    /// tᵢ: principal directions of the surface of equal distance through the point, unit vectors across the normal.
    pub directions: [Vec3; 2],
    /// cᵢ: its curvatures along them, 1/length; positive where it bends away from the normal.
    pub curvatures: [f64; 2],
    /// Curvatures of the wall itself, 1/length, not negative; infinite about an edge and at a corner.
    pub bends: [f64; 2],
    /// Radii of the surface of equal distance: of a wall with the curvature κ |1 − s κ|/|κ| at the distance s along its normal.
    pub radii: [f64; 2],
    /// Whether the way is along the normal of the face; else the foot is on an edge or a vertex.
    pub is_inside: bool,
}

impl Foot {
    /// u′ ∇²d + u″ n nᵀ: the second derivatives of a function u of the distance, by its derivatives.
    pub fn hessian(&self, [first, second]: [f64; 2]) -> Sym3 {
        let [a, b] = self.directions;
        let bent = Sym3::outer(a, first * self.curvatures[0]).plus(Sym3::outer(b, first * self.curvatures[1]));
        bent.plus(Sym3::outer(self.normal, second))
    }

    /// At a point of the wall itself, by its face and parameters.
    pub fn on_wall(evaluator: &mut Evaluator, topology: &Topology, face: u32, uv: [f64; 2]) -> Self {
        let frame = regular_frame(evaluator, topology, face, uv);
        if is_unit(frame.normal) { Self::inside(&frame, 0.0, scale(frame.normal, -1.0)) } else { Self::APEX }
    }

    /// At an apex, where a wall has no normal: as thin in all directions.
    const APEX: Self = Self {
        distance: 0.0,
        normal: [0.0, 0.0, 1.0],
        directions: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        curvatures: [0.0; 2],
        bends: [f64::INFINITY; 2],
        radii: [0.0; 2],
        is_inside: false,
    };

    /// Of a point off the wall, by the closest point of a face. `exact` is how exact that is.
    pub fn off_wall(
        evaluator: &mut Evaluator,
        topology: &Topology,
        (face, on): (u32, OnSurface),
        point: Vec3,
        exact: f64,
    ) -> Self {
        Self::within(evaluator, topology, (face, on), point, (ALONG, exact))
    }

    /// The same for the sizes of layers, where the foot on a border counts as one within the face if the way is nearly along the normal there.
    pub fn in_layers(
        evaluator: &mut Evaluator,
        topology: &Topology,
        (face, on): (u32, OnSurface),
        point: Vec3,
        exact: f64,
    ) -> Self {
        Self::within(evaluator, topology, (face, on), point, (WEDGE, exact))
    }

    /// Within the face where no more than a share `on_cad` of the way is across the normal, or on triangles [`ALONG_TRIANGLES`].
    fn within(
        evaluator: &mut Evaluator,
        topology: &Topology,
        (face, on): (u32, OnSurface),
        point: Vec3,
        (on_cad, exact): (f64, f64),
    ) -> Self {
        let (way, distance) = (sub(point, on.point), on.distance);
        let frame = regular_frame(evaluator, topology, face, on.uv);
        let normal = unit(way);
        let aside = norm(sub(way, scale(frame.normal, dot(way, frame.normal))));
        let is_discrete = topology.faces[face as usize].kind == SurfaceKind::Discrete;
        let along = if is_discrete { ALONG_TRIANGLES } else { on_cad };
        if is_unit(frame.normal) && aside <= along * distance + exact {
            return Self::inside(&frame, distance, if distance > exact { normal } else { facing(&frame, way) });
        }
        if !is_unit(normal) {
            return Self { distance, ..Self::APEX };
        }
        Self::border(evaluator, topology, (face, on.point), (normal, distance), exact)
    }

    /// Of a face at a point of it.
    fn inside(frame: &SurfaceFrame, distance: f64, normal: Vec3) -> Self {
        let outward = if dot(normal, frame.normal) < 0.0 { -1.0 } else { 1.0 };
        let first = unit(sub(frame.directions[0], scale(normal, dot(frame.directions[0], normal))));
        let directions = if is_unit(first) && frame.curvatures != [0.0; 2] {
            [first, cross(normal, first)]
        } else {
            <[Vec3; 2]>::from(plane_basis(normal))
        };
        let flat = frame.curvatures.map(|curvature| 1.0 - outward * distance * curvature);
        let each = |of: &dyn Fn(f64, f64) -> f64| [0, 1].map(|i: usize| of(frame.curvatures[i], flat[i]));
        Self {
            distance,
            normal,
            directions,
            curvatures: each(&|curvature, flat| -outward * curvature / flat.max(FOCAL)),
            bends: frame.curvatures.map(f64::abs),
            radii: each(&|curvature, flat| {
                if curvature == 0.0 { f64::INFINITY } else { flat.max(0.0) / curvature.abs() }
            }),
            is_inside: true,
        }
    }

    /// Of a face's border: about an edge the surfaces of equal distance are tubes, about a corner spheres.
    fn border(
        evaluator: &mut Evaluator,
        topology: &Topology,
        (face, foot): (u32, Vec3),
        (normal, distance): (Vec3, f64),
        exact: f64,
    ) -> Self {
        let (first, second) = plane_basis(normal);
        let round = 1.0 / distance;
        let corner = Self {
            distance,
            normal,
            directions: [first, second],
            curvatures: [round; 2],
            bends: [f64::INFINITY; 2],
            radii: [distance; 2],
            is_inside: false,
        };
        let near = 10.0 * exact;
        let edges = topology.faces[face as usize].edges.iter().filter(|&&edge| topology.is_ridge(edge));
        for &edge in edges {
            let entity = &topology.edges[edge as usize];
            let Some(on) = evaluator.closest_on_edge_within(edge, foot, near + entity.tolerance) else { continue };
            let mut ends = entity.vertices.into_iter().flatten();
            if ends.any(|end| norm(sub(topology.vertices[end as usize].point, foot)) <= near) {
                return corner;
            }
            let frame = evaluator.edge_frame(edge, on.t);
            let speed = norm(frame.d1);
            let tangent = unit(sub(frame.d1, scale(normal, dot(frame.d1, normal))));
            if !is_unit(tangent) || !speed.is_finite() {
                return corner;
            }
            // The part of the curve's curvature towards the point, and the surface of equal distance along it.
            let square = speed * speed;
            let across = sub(frame.d2, scale(frame.d1, dot(frame.d1, frame.d2) / square));
            let bend = dot(across, normal) / square;
            let flat = 1.0 - distance * bend;
            let radius = if bend == 0.0 { f64::INFINITY } else { flat.max(0.0) / bend.abs() };
            return Self {
                directions: [tangent, cross(normal, tangent)],
                curvatures: [-bend / flat.max(FOCAL), round],
                bends: [norm(across) / square, f64::INFINITY],
                radii: [radius, distance],
                ..corner
            };
        }
        corner
    }
}

/// The normal, on the side of the way.
fn facing(frame: &SurfaceFrame, way: Vec3) -> Vec3 {
    if dot(frame.normal, way) > 0.0 { frame.normal } else { scale(frame.normal, -1.0) }
}

/// The frame of a face; at a pole with the curvatures beside it.
fn regular_frame(evaluator: &mut Evaluator, topology: &Topology, face: u32, uv: [f64; 2]) -> SurfaceFrame {
    let frame = evaluator.face_frame(face, uv);
    if !is_unit(frame.normal) || frame.directions.into_iter().all(is_unit) {
        return frame;
    }
    let middle = topology.faces[face as usize].range.map(|[low, high]| 0.5 * (low + high));
    let beside = evaluator.face_frame(face, [0, 1].map(|k: usize| uv[k] + NUDGE * (middle[k] - uv[k])));
    if !beside.directions.into_iter().all(is_unit) {
        return frame;
    }
    let flat = |v: Vec3| unit(add(v, scale(frame.normal, -dot(v, frame.normal))));
    SurfaceFrame { curvatures: beside.curvatures, directions: beside.directions.map(flat), ..frame }
}

fn is_unit(v: Vec3) -> bool {
    (norm(v) - 1.0).abs() < 1e-6
}
