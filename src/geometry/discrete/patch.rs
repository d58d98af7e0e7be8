//! The shape of a discrete face: a patch of triangles, exact where it is plane, smooth where it has cubic patches.
use super::plane::Plane;
use super::polyline::closest_on_triangle;
use super::smooth::Smooth;
use super::tree::{Box3, BoxTree, EMPTY, box_of, join};
use crate::geometry::{OnSurface, SurfaceFrame, principal};
use crate::mesh::vector::{Vec3, add, area2, cross, distance, dot, norm, scale, sub, unit};
use nalgebra::{Matrix2, Matrix6x3, RowVector3, Vector3, Vector6};
use std::collections::HashMap;

/// Triangles of one discrete face, normals outward.
///
/// Parameters: on a plane patch the coordinates on its axes. On another, u = k + b1/2, v = b2, where k is the triangle
/// and b1, b2 are the barycentric weights of its second and third corner. These name a point, but are no chart.
pub(crate) struct Patch {
    triangles: Vec<[Vec3; 3]>,
    normals: Vec<Vec3>,
    /// Normals of the patch at the corners of each triangle, mean over the patch's triangles there.
    corner_normals: Vec<[Vec3; 3]>,
    plane: Option<Plane>,
    /// What makes it smooth; none where all triangles are flat.
    smooth: Option<Smooth>,
    tree: BoxTree,
    bounds: Box3,
}

impl Patch {
    /// A patch of at least one triangle, plane or with cubic patches or of flat triangles alone.
    pub fn new(points: &[Vec3], nodes: &[[u32; 3]], plane: Option<Plane>, smooth: Option<Smooth>) -> Self {
        let triangles: Vec<[Vec3; 3]> = nodes.iter().map(|n| n.map(|v| points[v as usize])).collect();
        let normals: Vec<Vec3> = triangles.iter().map(|&[a, b, c]| unit(area2(a, b, c))).collect();
        let boxes: Vec<Box3> = triangles.iter().map(|&corners| box_of(corners)).collect();
        let is_flat = plane.is_none() && smooth.is_none();
        let corner_normals = if is_flat { corner_normals(nodes, &triangles) } else { Vec::new() };
        let bounds = boxes.iter().copied().chain(smooth.iter().map(Smooth::bounds)).fold(EMPTY, join);
        Self { tree: BoxTree::new(&boxes), triangles, normals, corner_normals, plane, smooth, bounds }
    }

    /// Box of the patch.
    pub fn bounds(&self) -> Box3 {
        self.bounds
    }

    /// Whether it lies in a plane.
    pub fn is_plane(&self) -> bool {
        self.plane.is_some()
    }

    /// Number of its triangles.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// The corners of triangle k.
    pub fn corners(&self, k: usize) -> [Vec3; 3] {
        self.triangles[k]
    }

    /// Whether triangle k has a cubic patch.
    pub fn is_curved(&self, k: usize) -> bool {
        self.smooth.as_ref().is_some_and(|smooth| !smooth.is_chord(k))
    }

    /// Box of triangle k, or of its cubic patch.
    pub fn bounds_of(&self, k: usize) -> Box3 {
        match &self.smooth {
            Some(smooth) => smooth.bounds_of(k, self.triangles[k]),
            None => box_of(self.triangles[k]),
        }
    }

    /// Bounds of the parameters.
    pub fn range(&self) -> [[f64; 2]; 2] {
        let Some(plane) = &self.plane else { return [[0.0, self.triangles.len() as f64], [0.0, 1.0]] };
        let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for uv in self.triangles.iter().flatten().map(|&p| plane.parameters(p)) {
            for i in 0..2 {
                range[i] = [range[i][0].min(uv[i]), range[i][1].max(uv[i])];
            }
        }
        range
    }

    /// Parameters of a point of triangle k with barycentric weights.
    pub fn parameters(&self, k: usize, weights: [f64; 3]) -> [f64; 2] {
        match &self.plane {
            Some(plane) => plane.parameters(self.at(k, weights)),
            None => [k as f64 + 0.5 * weights[1].clamp(0.0, 1.0), weights[2]],
        }
    }

    /// Parameters at the share s of a side, 3·triangle + side.
    pub fn parameters_on_side(&self, side: usize, s: f64) -> [f64; 2] {
        let mut weights = [0.0; 3];
        weights[side % 3] = 1.0 - s;
        weights[(side % 3 + 1) % 3] = s;
        self.parameters(side / 3, weights)
    }

    /// Triangle and weights at parameters, of a patch that is not plane.
    fn locate(&self, uv: [f64; 2]) -> (usize, [f64; 3]) {
        let last = self.triangles.len() - 1;
        let k = if uv[0] > 0.0 { (uv[0] as usize).min(last) } else { 0 };
        let b1 = (2.0 * (uv[0] - k as f64)).clamp(0.0, 1.0);
        let b2 = uv[1].clamp(0.0, 1.0);
        let sum = (b1 + b2).max(1.0);
        (k, [1.0 - (b1 + b2) / sum, b1 / sum, b2 / sum])
    }

    /// The point of triangle k, or of its cubic patch, with barycentric weights.
    pub fn at(&self, k: usize, weights: [f64; 3]) -> Vec3 {
        match &self.smooth {
            Some(smooth) => smooth.point(k, self.triangles[k], weights),
            None => self.on_chord(k, weights),
        }
    }

    fn on_chord(&self, k: usize, weights: [f64; 3]) -> Vec3 {
        let [a, b, c] = self.triangles[k];
        add(add(scale(a, weights[0]), scale(b, weights[1])), scale(c, weights[2]))
    }

    /// Outward normal at parameters. On flat triangles it is the triangle's own at its centroid and tends to the mean of the
    /// neighbours towards its sides, so it is continuous and the input's triangles have no normal deviation.
    pub fn normal(&self, uv: [f64; 2]) -> Vec3 {
        if let Some(plane) = &self.plane {
            return plane.normal;
        }
        let (k, w) = self.locate(uv);
        if let Some(smooth) = &self.smooth {
            return smooth.normal(k, self.triangles[k], w);
        }
        let bubble = 27.0 * w[0] * w[1] * w[2];
        let [a, b, c] = self.corner_normals[k];
        let rim = add(add(scale(a, w[0]), scale(b, w[1])), scale(c, w[2]));
        unit(add(scale(unit(rim), 1.0 - bubble), scale(self.normals[k], bubble)))
    }

    /// Point, derivatives, normal and curvatures at parameters.
    pub fn frame(&self, uv: [f64; 2]) -> SurfaceFrame {
        if let Some(plane) = &self.plane {
            return plane.frame(uv);
        }
        let (k, weights) = self.locate(uv);
        let [a, b, c] = self.triangles[k];
        if let Some(smooth) = &self.smooth {
            return smooth.frame(k, [a, b, c], weights);
        }
        let (curvatures, directions) = self.curvatures(k);
        SurfaceFrame {
            point: self.at(k, weights),
            du: scale(sub(b, a), 2.0),
            dv: sub(c, a),
            normal: self.normal(uv),
            curvatures,
            directions,
        }
    }

    /// Closest point of the patch. The guess only bounds the search for the closest flat triangle; on cubic patches the foot is looked
    /// for from there.
    pub fn closest(&self, p: Vec3, guess: Option<[f64; 2]>) -> OnSurface {
        let first = match (guess, &self.plane) {
            (Some(uv), None) => self.locate(uv).0,
            _ => 0,
        };
        let measure = |k: usize| {
            let away = sub(p, self.on_chord(k, closest_on_triangle(self.triangles[k], p)));
            dot(away, away)
        };
        let nearest = self.tree.nearest(p, measure(first), |k| measure(k as usize)).map_or(first, |k| k as usize);
        let mut k = nearest;
        let mut weights = closest_on_triangle(self.triangles[k], p);
        let mut inside = weights.iter().all(|&w| w > 0.0);
        let mut point = self.on_chord(k, weights);
        if let Some(smooth) = self.smooth.as_ref().filter(|smooth| !(inside && smooth.is_chord(k))) {
            let foot = smooth.foot(p, k, weights, |k| self.triangles[k]);
            (k, weights, point) = (foot.triangle, foot.weights, foot.point);
            inside = weights.iter().all(|&w| w > 0.0);
        }
        if let Some(plane) = &self.plane {
            // The mean plane is the face. Its triangles only bound it.
            point = plane.project(if inside { p } else { point });
            return OnSurface { uv: plane.parameters(point), point, distance: distance(p, point) };
        }
        OnSurface { uv: self.parameters(k, weights), point, distance: distance(p, point) }
    }

    /// Closest point of the plane of a plane patch, whether or not the triangles reach there; else as [`Patch::closest`].
    pub fn closest_untrimmed(&self, p: Vec3, guess: [f64; 2]) -> OnSurface {
        let Some(plane) = &self.plane else { return self.closest(p, Some(guess)) };
        let point = plane.project(p);
        OnSurface { uv: plane.parameters(point), point, distance: distance(p, point) }
    }

    /// Principal curvatures and directions of triangle k: the symmetric S that fits n_j − n_i = −S (p_j − p_i) along
    /// its sides best, with the patch's normals n at the corners p (after Rusinkiewicz 2004).
    fn curvatures(&self, k: usize) -> ([f64; 2], [Vec3; 2]) {
        let corners = self.triangles[k];
        let e1 = unit(sub(corners[1], corners[0]));
        let e2 = cross(self.normals[k], e1);
        let (mut rows, mut turns) = (Matrix6x3::zeros(), Vector6::zeros());
        for i in 0..3 {
            let j = (i + 1) % 3;
            let (along, turn) =
                (sub(corners[j], corners[i]), sub(self.corner_normals[k][j], self.corner_normals[k][i]));
            let (x, y) = (dot(along, e1), dot(along, e2));
            rows.set_row(2 * i, &RowVector3::new(x, y, 0.0));
            rows.set_row(2 * i + 1, &RowVector3::new(0.0, x, y));
            turns[2 * i] = -dot(turn, e1);
            turns[2 * i + 1] = -dot(turn, e2);
        }
        match least_squares(rows, turns) {
            Some(s) => principal(Matrix2::new(s[0], s[1], s[1], s[2]), [e1, e2]),
            None => ([0.0; 2], [e1, e2]),
        }
    }
}

/// When no more than this share of a column is left beside the others, that is rounding: the triangle is a line.
const SINGULAR: f64 = 1e-7;

/// The x with the least |A x − b|; none where the columns of A depend on each other.
fn least_squares(a: Matrix6x3<f64>, b: Vector6<f64>) -> Option<Vector3<f64>> {
    let (q, r) = a.qr().unpack();
    let is_told = (0..3).all(|k| r[(k, k)].abs() > SINGULAR * a.column(k).norm());
    is_told.then(|| r.solve_upper_triangular(&q.tr_mul(&b))).flatten()
}

/// Means of the triangles' normals at the patch's vertices, weighted with the angle there.
fn corner_normals(nodes: &[[u32; 3]], triangles: &[[Vec3; 3]]) -> Vec<[Vec3; 3]> {
    let mut sums: HashMap<u32, Vec3> = HashMap::new();
    for (nodes, corners) in nodes.iter().zip(triangles) {
        let normal = unit(area2(corners[0], corners[1], corners[2]));
        for k in 0..3 {
            let (to_next, to_last) = (sub(corners[(k + 1) % 3], corners[k]), sub(corners[(k + 2) % 3], corners[k]));
            let angle = norm(cross(to_next, to_last)).atan2(dot(to_next, to_last));
            let sum = sums.entry(nodes[k]).or_insert([0.0; 3]);
            *sum = add(*sum, scale(normal, angle));
        }
    }
    nodes.iter().map(|nodes| nodes.map(|v| unit(sums[&v]))).collect()
}
