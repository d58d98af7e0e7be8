//! Normal and curvature of a surface at one of its vertices, by a polynomial that fits its neighbourhood.
//!
//! The height over the tangent plane is fitted by weighted least squares through the vertex (Jiao and Zha 2008; Goldfeather and Interrante
//! 2004), here with one column more than the cubic's: the square of the height, with which spheres come out as they are.
use crate::mesh::vector::{Vec3, add, cross, dot, norm, scale, sub, unit};

/// Columns: x y | x² xy y² | x³ x²y xy² y³ | z².
const COLUMNS: usize = 10;
/// How many of them each degree takes.
const OF_DEGREE: [usize; 4] = [0, 2, 5, COLUMNS];
/// Rows that a degree needs beyond its columns, so that noise and uneven rings do not come through.
const SPARE: usize = 3;
/// How often the fit is taken again in the plane that it found.
const TURNS: usize = 3;
/// A frame that turns less than this (radians) is the right one.
const TURNED: f64 = 1e-3;
/// A higher degree has to bring the variance below this share of the lower one's.
const WORTH: f64 = 0.7;
/// What is left of a column beside the others when they depend on each other.
const SINGULAR: f64 = 1e-5;

/// A neighbour: its place relative to the vertex, and a normal there.
#[derive(Clone, Copy)]
pub(crate) struct Neighbour {
    pub offset: Vec3,
    pub normal: Vec3,
}

/// What was fitted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalFit {
    /// Unit normal.
    pub normal: Vec3,
    /// Shape operator S in space, 1/length: n changes by −S dp; terms 11 12 22 13 23 33.
    pub shape: [f64; 6],
}

/// Room for the rows of a fit; one for each thread.
#[derive(Default)]
pub(crate) struct Room {
    rows: Vec<[f64; COLUMNS + 1]>,
}

impl Room {
    /// Fits the neighbourhood of a vertex, whose normal is about `normal`; `size` is the length of its edges. None where it tells nothing.
    pub fn fit(&mut self, neighbours: &[Neighbour], normal: Vec3, size: f64) -> Option<LocalFit> {
        let has_size = size > 0.0;
        if !has_size {
            return None;
        }
        let (mut normal, mut found) = (normal, None);
        for _ in 0..TURNS {
            let next = self.fit_over(neighbours, normal, size)?;
            let turned = norm(sub(next.normal, normal));
            normal = next.normal;
            found = Some(next);
            if turned < TURNED {
                break;
            }
        }
        found
    }

    /// The fit over the plane across a normal.
    fn fit_over(&mut self, neighbours: &[Neighbour], normal: Vec3, size: f64) -> Option<LocalFit> {
        let (e1, e2) = axes(normal);
        self.rows.clear();
        for neighbour in neighbours {
            let facing = dot(neighbour.normal, normal);
            if facing <= LEAST_FACING {
                continue;
            }
            let [x, y, z] = [e1, e2, normal].map(|axis| dot(neighbour.offset, axis) / size);
            let weight = facing / (1.0 + dot(neighbour.offset, neighbour.offset) / (size * size)).sqrt();
            let row = [x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y, z * z, z];
            self.rows.push(row.map(|term| weight * term));
        }
        let count = self.rows.len();
        let most = (1..=3).rev().find(|&degree| OF_DEGREE[degree] + SPARE <= count).or((count > 2).then_some(1))?;
        let columns = triangularize(&mut self.rows, OF_DEGREE[most]);
        // What the columns from `p` on and the rows below leave of the heights.
        let left = |p: usize| self.rows[p..].iter().map(|row| row[COLUMNS] * row[COLUMNS]).sum::<f64>();
        let variance = |p: usize| left(p) / (count - p) as f64;
        let mut degree = 1;
        for next in 2..=most {
            let sound = columns >= OF_DEGREE[next] || (next == 3 && columns + 1 == COLUMNS);
            if sound && variance(OF_DEGREE[next].min(columns)) < WORTH * variance(OF_DEGREE[degree]) {
                degree = next;
            }
        }
        let p = OF_DEGREE[degree].min(columns);
        if p < 2 {
            return None;
        }
        let mut c = [0.0; COLUMNS];
        for i in (0..p).rev() {
            let known: f64 = (i + 1..p).map(|j| self.rows[i][j] * c[j]).sum();
            c[i] = (self.rows[i][COLUMNS] - known) / self.rows[i][i];
        }
        let (gx, gy) = (c[0], c[1]);
        // Second derivatives at the vertex; z² brings its part where the plane is not the tangent plane.
        let second = [2.0 * (c[2] + c[9] * gx * gx), c[3] + 2.0 * c[9] * gx * gy, 2.0 * (c[4] + c[9] * gy * gy)];
        let slope = (1.0 + gx * gx + gy * gy).sqrt();
        let [t1, t2] = [(e1, gx), (e2, gy)].map(|(axis, slope)| add(axis, scale(normal, slope)));
        let shape = in_space([t1, t2], second.map(|term| term / (slope * size)));
        let found = unit(sub(normal, add(scale(e1, gx), scale(e2, gy))));
        found.iter().chain(&shape).all(|x| x.is_finite()).then_some(LocalFit { normal: found, shape })
    }
}

/// A neighbour that looks farther to the side lies on another sheet.
const LEAST_FACING: f64 = 0.2;

/// Two axes with the normal: right-handed, unit.
pub(crate) fn axes(normal: Vec3) -> (Vec3, Vec3) {
    let least = (1..3).fold(0, |m, i| if normal[i].abs() < normal[m].abs() { i } else { m });
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let e1 = unit(cross(axis, normal));
    (e1, cross(normal, e1))
}

/// Householder's reflections on the first columns, the last (heights) with them. Returns how many columns do not depend on those before.
fn triangularize(rows: &mut [[f64; COLUMNS + 1]], columns: usize) -> usize {
    for k in 0..columns.min(rows.len()) {
        let square =
            |from: usize, rows: &[[f64; COLUMNS + 1]]| rows[from..].iter().map(|row| row[k] * row[k]).sum::<f64>();
        let (whole, left) = (square(0, rows), square(k, rows));
        let is_told = left > SINGULAR * SINGULAR * whole;
        if !is_told {
            return k;
        }
        let alpha = if rows[k][k] > 0.0 { -left.sqrt() } else { left.sqrt() };
        // The reflection's vector stands in column k, from row k on.
        rows[k][k] -= alpha;
        let beta = -1.0 / (alpha * rows[k][k]);
        for j in (k + 1..columns).chain([COLUMNS]) {
            let along = beta * rows[k..].iter().map(|row| row[k] * row[j]).sum::<f64>();
            for row in &mut rows[k..] {
                row[j] -= along * row[k];
            }
        }
        rows[k][k] = alpha;
        for row in &mut rows[k + 1..] {
            row[k] = 0.0;
        }
    }
    columns.min(rows.len())
}

/// The tensor Σ (I⁻¹ II I⁻¹)_ij t_i t_jᵀ of a second fundamental form II (11 12 22) for the tangents t.
fn in_space(t: [Vec3; 2], second: [f64; 3]) -> [f64; 6] {
    let [e, f, g] = [dot(t[0], t[0]), dot(t[0], t[1]), dot(t[1], t[1])];
    let det = e * g - f * f;
    // The dual tangents.
    let dual =
        [scale(sub(scale(t[0], g), scale(t[1], f)), 1.0 / det), scale(sub(scale(t[1], e), scale(t[0], f)), 1.0 / det)];
    let term = |i: usize, j: usize| {
        second[0] * dual[0][i] * dual[0][j]
            + second[1] * (dual[0][i] * dual[1][j] + dual[1][i] * dual[0][j])
            + second[2] * dual[1][i] * dual[1][j]
    };
    [term(0, 0), term(0, 1), term(1, 1), term(0, 2), term(1, 2), term(2, 2)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A patch of points (x, y, f) about the origin.
    fn neighbours(f: impl Fn(f64, f64) -> f64) -> Vec<Neighbour> {
        let mut found = Vec::new();
        for k in 0..20 {
            let (r, a) = (0.1 + 0.15 * f64::from(k % 3), 1.3 * f64::from(k));
            let (x, y) = (r * a.cos(), r * a.sin());
            found.push(Neighbour { offset: [x, y, f(x, y)], normal: [0.0, 0.0, 1.0] });
        }
        found
    }

    #[test]
    fn spheres_and_cubics_come_out() {
        let tilted = unit([0.1, -0.2, 1.0]);
        let ball = neighbours(|x, y| (4.0 - x * x - y * y).sqrt() - 2.0);
        let fit = Room::default().fit(&ball, tilted, 0.2).unwrap();
        assert!(norm(sub(fit.normal, [0.0, 0.0, 1.0])) < 1e-9, "{fit:?}");
        assert!((fit.shape[0] + 0.5).abs() < 1e-6 && (fit.shape[2] + 0.5).abs() < 1e-6 && fit.shape[1].abs() < 1e-6);
        let cubic = neighbours(|x, y| 0.1 * x - 0.05 * y + x * x - 0.3 * x * y + 0.7 * x * x * x - y * y * y);
        let mut room = Room::default();
        let fit = room.fit_over(&cubic, [0.0, 0.0, 1.0], 0.2).unwrap();
        assert!(norm(sub(fit.normal, unit([-0.1, 0.05, 1.0]))) < 1e-10, "{fit:?}");
        assert!((fit.shape[0] * (1.0f64 + 0.0125).powf(1.5) - 2.0).abs() < 0.1, "{fit:?}");
    }

    #[test]
    fn few_or_aligned_neighbours_take_a_lower_degree_or_none() {
        let ball = neighbours(|x, y| (4.0 - x * x - y * y).sqrt() - 2.0);
        let mut room = Room::default();
        let quadratic = room.fit(&ball[..9], [0.0, 0.0, 1.0], 0.2).unwrap();
        assert!(norm(sub(quadratic.normal, [0.0, 0.0, 1.0])) < 1e-2 && (quadratic.shape[0] + 0.5).abs() < 0.02);
        let linear = room.fit(&ball[..4], [0.0, 0.0, 1.0], 0.2).unwrap();
        assert_eq!(linear.shape, [0.0; 6]);
        assert!(room.fit(&ball[..2], [0.0, 0.0, 1.0], 0.2).is_none());
        assert!(room.fit(&ball, [0.0, 0.0, 1.0], 0.0).is_none());
        let line: Vec<Neighbour> =
            (1..9).map(|k| Neighbour { offset: [f64::from(k), 0.0, 0.0], normal: [0.0, 0.0, 1.0] }).collect();
        assert!(room.fit(&line, [0.0, 0.0, 1.0], 1.0).is_none());
        let lost = [Neighbour { offset: [f64::NAN; 3], normal: [0.0, 0.0, 1.0] }; 8];
        assert!(room.fit(&lost, [0.0, 0.0, 1.0], 1.0).is_none());
    }

    #[test]
    fn noise_about_a_plane_is_averaged() {
        let mut seed = 5u64;
        let mut noise = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let mut rough = neighbours(|_, _| 0.0);
        rough.iter_mut().for_each(|p| p.offset[2] = 0.01 * noise());
        let fit = Room::default().fit(&rough, [0.0, 0.0, 1.0], 0.2).unwrap();
        assert!(fit.normal[2] > 0.999, "{fit:?}");
    }
}
