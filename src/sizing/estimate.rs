//! Estimated curvature at the vertices of a mesh that is its own model.
use super::curvature::{Curvature, Local};
use crate::geometry::classify::Classification;
use crate::geometry::{Evaluate, Geometry, Model, SurfaceFrame, principal};
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, add, area2, dot, norm, scale, unit};
use crate::metric::{Sym3, plane_basis};
use crate::tasks::{Rows, Team};
use nalgebra::Matrix2;

/// Triangles a task.
const TRIANGLES: usize = 1 << 10;

/// The shape operators of the triangles (Rusinkiewicz 2004, as the discrete model fits them). A vertex takes their mean over the triangles
/// of each face there.
pub struct Estimate<'a> {
    faces: &'a [u32],
    /// 3·triangle + corner at each vertex.
    at: Rows,
    /// Of each triangle area·Σ κ_i d_i d_iᵀ and area·normal.
    shapes: Vec<(Sym3, Vec3)>,
}

impl<'a> Estimate<'a> {
    /// Of a mesh on its own surface.
    pub fn new(team: Team<'_>, mesh: &TetMesh, place: &'a Classification, model: &Model) -> Self {
        let triangles = &mesh.triangles.nodes;
        let at = Rows::by_key(team, mesh.vertices.len(), triangles.len(), |t| triangles[t]);
        let shapes = team.collect(TRIANGLES, triangles.len(), |range, shapes| {
            let mut evaluator = model.evaluator();
            shapes.extend(range.map(|t| {
                let [a, b, c] = triangles[t].map(|v| mesh.vertices[v as usize]);
                let area = 0.5 * norm(area2(a, b, c));
                let on = evaluator.closest_on_face(place.faces[t], scale(add(add(a, b), c), 1.0 / 3.0), None);
                let frame = evaluator.face_frame(place.faces[t], on.uv);
                let [first, second] = [0, 1].map(|i| Sym3::outer(frame.directions[i], area * frame.curvatures[i]));
                (first.plus(second), scale(frame.normal, area))
            }));
        });
        Self { faces: &place.faces, at, shapes }
    }

    /// Adds the faces at a vertex to what is asked of it.
    pub fn add_faces(&self, curvature: &Curvature, vertex: usize, local: &mut Local) {
        let triangles = || self.at.row(vertex).iter().map(|&entry| entry as usize / 3);
        let mut last = None;
        // The faces in increasing order: few vertices have more than one.
        while let Some(face) = triangles().map(|t| self.faces[t]).filter(|&f| last.is_none_or(|last| f > last)).min() {
            let own = triangles().filter(|&t| self.faces[t] == face).map(|t| self.shapes[t]);
            let (shape, normal) = own.fold((Sym3::ZERO, [0.0; 3]), |sum, one| (sum.0.plus(one.0), add(sum.1, one.1)));
            let area = norm(normal);
            if area > 0.0 {
                curvature.add_frame(&frame(shape.times(1.0 / area), unit(normal)), local);
            }
            last = Some(face);
        }
    }
}

/// The principal curvatures of a shape operator, in the plane across the normal.
fn frame(shape: Sym3, normal: Vec3) -> SurfaceFrame {
    let (u, w) = plane_basis(normal);
    let off = dot(u, shape.apply(w));
    let in_plane = Matrix2::new(shape.quadratic(u), off, off, shape.quadratic(w));
    let (curvatures, directions) = principal(in_plane, [u, w]);
    let zero = [0.0; 3];
    SurfaceFrame { point: zero, du: zero, dv: zero, normal, curvatures, directions }
}
