//! What the adapter asks of a geometry.
use super::{SurfaceKind, Topology};
use crate::mesh::vector::Vec3;

/// A point on an edge.
#[derive(Clone, Copy, Debug)]
pub struct OnCurve {
    /// Parameter, within the edge's range.
    pub t: f64,
    /// The point, model units.
    pub point: Vec3,
    /// Distance from the point that was asked for.
    pub distance: f64,
}

/// A point on a face.
#[derive(Clone, Copy, Debug)]
pub struct OnSurface {
    /// Parameters.
    pub uv: [f64; 2],
    /// The point, model units.
    pub point: Vec3,
    /// Distance from the point that was asked for.
    pub distance: f64,
}

/// Point and derivatives of a curve.
#[derive(Clone, Copy, Debug)]
pub struct CurveFrame {
    /// C(t).
    pub point: Vec3,
    /// C′(t).
    pub d1: Vec3,
    /// C″(t).
    pub d2: Vec3,
}

impl CurveFrame {
    /// Curvature |C′×C″|/|C′|³, in 1/length.
    pub fn curvature(&self) -> f64 {
        use crate::mesh::vector::{cross, norm};
        let speed = norm(self.d1);
        if speed == 0.0 { 0.0 } else { norm(cross(self.d1, self.d2)) / (speed * speed * speed) }
    }
}

/// Point, derivatives, outward unit normal and principal curvatures of a face.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceFrame {
    /// S(u, v).
    pub point: Vec3,
    /// S_u.
    pub du: Vec3,
    /// S_v.
    pub dv: Vec3,
    /// Unit normal, out of the solid; zero where undefined (an apex).
    pub normal: Vec3,
    /// Principal curvatures κ1, κ2 in 1/length, |κ1| ≥ |κ2|; zero where undefined.
    pub curvatures: [f64; 2],
    /// Unit principal directions, of κ1 and κ2.
    pub directions: [Vec3; 2],
}

/// A geometry: entities and their shape. Shared by all threads; each thread takes its own evaluator,
/// which may hold caches.
pub trait Geometry: Sync {
    /// The evaluator of one thread.
    type Evaluator<'a>: Evaluate
    where
        Self: 'a;

    /// Entities and adjacency.
    fn topology(&self) -> &Topology;

    /// A new evaluator, for one thread.
    fn evaluator(&self) -> Self::Evaluator<'_>;

    /// Whether a face lies in a plane.
    fn is_plane(&self, face: u32) -> bool {
        self.topology().faces[face as usize].kind == SurfaceKind::Plane
    }
}

/// Shape queries. Indices are those of [`Topology`], from 0. Parameters outside the range are
/// taken into it (by the period, else to the nearer end). No query panics or throws.
pub trait Evaluate {
    /// C(t) and derivatives of an edge. A degenerate edge gives its point and zero derivatives.
    fn edge_frame(&mut self, edge: u32, t: f64) -> CurveFrame;

    /// S(u, v), normal and curvatures of a face.
    fn face_frame(&mut self, face: u32, uv: [f64; 2]) -> SurfaceFrame;

    /// Outward unit normal of a face: cheaper than the whole frame. Zero where undefined.
    fn face_normal(&mut self, face: u32, uv: [f64; 2]) -> Vec3;

    /// Parameters on `face` of the point at `t` of its edge (its p-curve; on a seam the first one); none if the edge
    /// is not one of the face.
    fn edge_on_face(&mut self, edge: u32, t: f64, face: u32) -> Option<[f64; 2]>;

    /// Closest point of the edge, ends included. With a good guess it is found from there, else globally:
    /// a wrong guess costs time, never correctness.
    fn closest_on_edge(&mut self, edge: u32, point: Vec3, guess: Option<f64>) -> OnCurve;

    /// Closest point of the *trimmed* face, its boundary included.
    fn closest_on_face(&mut self, face: u32, point: Vec3, guess: Option<[f64; 2]>) -> OnSurface;

    /// The same, if it is closer than `limit`: where nothing of the face can be, that is told at once.
    fn closest_on_face_within(&mut self, face: u32, point: Vec3, limit: f64) -> Option<OnSurface> {
        Some(self.closest_on_face(face, point, None)).filter(|on| on.distance < limit)
    }

    /// Closest point of the edge, if it is closer than `limit`.
    fn closest_on_edge_within(&mut self, edge: u32, point: Vec3, limit: f64) -> Option<OnCurve> {
        Some(self.closest_on_edge(edge, point, None)).filter(|on| on.distance < limit)
    }

    /// A box about the whole edge (least and greatest corner), where it is known at no cost.
    fn edge_box(&self, edge: u32) -> Option<[Vec3; 2]> {
        let _ = edge;
        None
    }

    /// Closest point on the face's surface near the guess: what the adapter uses for points inside a face. The trimming is looked at only
    /// where chords of the face's edges leave it (a plane with a round edge): a vertex in a layer thinner than the chord's rise would
    /// come to lie beside the face. Falls back to [`Evaluate::closest_on_face`] when it does not converge to a true foot point.
    fn closest_on_surface(&mut self, face: u32, point: Vec3, guess: [f64; 2]) -> OnSurface;

    /// The same without a look at the trimming: for points that are known to be on the face, as on its border, where that look costs most.
    fn foot_on_surface(&mut self, face: u32, point: Vec3, guess: [f64; 2]) -> OnSurface {
        self.closest_on_surface(face, point, guess)
    }
}
