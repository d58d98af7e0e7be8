//! Surfaces for tests.
use crate::mesh::vector::{Vec3, scale, unit};
use std::f64::consts::{PI, TAU};

/// Points and triangles.
#[derive(Clone, Debug, Default)]
pub struct Shape {
    pub points: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
}

/// Numbers in [0, 1).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / 2f64.powi(53)
    }
}

impl Shape {
    pub fn append(&mut self, other: &Shape) {
        let n = self.points.len() as u32;
        self.points.extend(&other.points);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + n)));
    }

    /// Equal points made one, triangles without extent or with a twin left out.
    pub fn welded(self) -> Shape {
        let mut order: Vec<usize> = (0..self.points.len()).collect();
        order.sort_by(|&a, &b| self.points[a].partial_cmp(&self.points[b]).unwrap());
        let mut number = vec![0; self.points.len()];
        let mut points: Vec<Vec3> = Vec::new();
        for i in order {
            if points.last() != Some(&self.points[i]) {
                points.push(self.points[i]);
            }
            number[i] = points.len() as u32 - 1;
        }
        let mut seen = std::collections::HashSet::new();
        let mut triangles: Vec<[u32; 3]> = self.triangles.iter().map(|t| t.map(|v| number[v as usize])).collect();
        triangles.retain(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0] && seen.insert(super::sorted3(*t)));
        Shape { points, triangles }
    }
}

/// A box of structured triangles.
pub fn block(low: Vec3, size: Vec3, n: [usize; 3]) -> Shape {
    let mut s = Shape::default();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for end in 0..2 {
            let first = s.points.len() as u32;
            for j in 0..=n[v] {
                for i in 0..=n[u] {
                    let mut p = low;
                    p[axis] += size[axis] * end as f64;
                    p[u] += size[u] * (i as f64 / n[u] as f64);
                    p[v] += size[v] * (j as f64 / n[v] as f64);
                    s.points.push(p);
                }
            }
            let row = n[u] as u32 + 1;
            for j in 0..n[v] as u32 {
                for i in 0..n[u] as u32 {
                    let a = first + j * row + i;
                    let (b, c, d) = (a + 1, a + row, a + row + 1);
                    s.triangles.extend(if end == 1 { [[a, b, d], [a, d, c]] } else { [[a, d, b], [a, c, d]] });
                }
            }
        }
    }
    s.welded()
}

/// Two boxes with a common face.
pub fn two_boxes(n: usize) -> Shape {
    let mut s = block([0.0; 3], [1.0; 3], [n, n, n]);
    s.append(&block([1.0, 0.0, 0.0], [1.0; 3], [n, n, n]));
    // The common face is triangulated alike from both sides? Only where the diagonals agree: take one side's.
    let on_plane = |s: &Shape, t: &[u32; 3]| t.iter().all(|&v| s.points[v as usize][0] == 1.0);
    let keep =
        s.triangles.iter().enumerate().filter(|(i, t)| *i < 12 * n * n || !on_plane(&s, t)).map(|(_, t)| *t).collect();
    Shape { points: s.points.clone(), triangles: keep }.welded()
}

/// The twisted prism that has no tetrahedra without a further point (Schönhardt 1928).
pub fn schonhardt() -> Shape {
    let point = |k: usize, turn: f64, z: f64| {
        let a = TAU * k as f64 / 3.0 + turn;
        [a.cos(), a.sin(), z]
    };
    let points: Vec<Vec3> =
        (0..6).map(|k| if k < 3 { point(k, 0.0, 0.0) } else { point(k - 3, PI / 6.0, 1.0) }).collect();
    // Of both choices of diagonals the one that leaves less volume.
    let make = |turn: bool| {
        let mut triangles = vec![[0, 2, 1], [3, 4, 5]];
        for k in 0..3_u32 {
            let l = (k + 1) % 3;
            if turn {
                triangles.extend([[k, l, l + 3], [k, l + 3, k + 3]]);
            } else {
                triangles.extend([[k, l, k + 3], [l, l + 3, k + 3]]);
            }
        }
        Shape { points: points.clone(), triangles }
    };
    let (a, b) = (make(true), make(false));
    if volume(&a) < volume(&b) { a } else { b }
}

pub fn volume(s: &Shape) -> f64 {
    s.triangles.iter().map(|t| t.map(|v| s.points[v as usize])).map(|[a, b, c]| super::volume6([0.0; 3], a, b, c)).sum()
}

/// A unit square plate with different random points on both sides, triangulated by splitting triangles.
pub fn plate(thickness: f64, above: usize, below: usize, seed: u64) -> Shape {
    let mut random = Random(seed);
    let mut s = Shape::default();
    for (z, n) in [(0.0, below), (thickness, above)] {
        let first = s.points.len() as u32;
        s.points.extend([[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]]);
        let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
        for _ in 0..n {
            let t = triangles.swap_remove((random.next() * triangles.len() as f64) as usize);
            let w = [0.1 + random.next(), 0.1 + random.next(), 0.1 + random.next()];
            let sum = w[0] + w[1] + w[2];
            let corner = t.map(|v: u32| s.points[(first + v) as usize]);
            let mut p = [0, 1, 2].map(|k| (0..3).map(|j| corner[j][k] * w[j]).sum::<f64>() / sum);
            p[2] = z;
            let m = s.points.len() as u32 - first;
            s.points.push(p);
            triangles.extend([[t[0], t[1], m], [t[1], t[2], m], [t[2], t[0], m]]);
        }
        s.triangles.extend(
            triangles.iter().map(|t| t.map(|v| v + first)).map(|t| if z == 0.0 { [t[0], t[2], t[1]] } else { t }),
        );
    }
    let top = below as u32 + 4;
    for k in 0..4 {
        let l = (k + 1) % 4;
        s.triangles.extend([[k, l, top + l], [k, top + l, top + k]]);
    }
    s
}

/// Points spread on a sphere (a spiral), with the triangles of their hull.
pub fn sphere(n: usize, radius: f64, seed: u64) -> Shape {
    let turn = PI * (3.0 - 5f64.sqrt());
    let points: Vec<Vec3> = (0..n)
        .map(|i| (1.0 - (2 * i + 1) as f64 / n as f64, i as f64 * turn + seed as f64))
        .map(|(z, a)| scale([(1.0 - z * z).sqrt() * a.cos(), (1.0 - z * z).sqrt() * a.sin(), z], radius))
        .collect();
    let m = super::Triangulation::new(&points).unwrap();
    let hull = m.nodes.iter().filter(|t| t[0] != u32::MAX && t[3] == u32::MAX).map(|t| [t[0], t[1], t[2]]).collect();
    Shape { points, triangles: hull }
}

/// An icosahedron whose triangles are split in four `levels` times, on a sphere.
pub fn ico(levels: usize, radius: f64) -> Shape {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let mut points = Vec::new();
    for (a, b) in [(1.0, g), (1.0, -g), (-1.0, g), (-1.0, -g)] {
        points.extend([[0.0, a, b], [a, b, 0.0], [b, 0.0, a]]);
    }
    let m = super::Triangulation::new(&points).unwrap();
    let mut triangles: Vec<[u32; 3]> =
        m.nodes.iter().filter(|t| t[0] != u32::MAX && t[3] == u32::MAX).map(|t| [t[0], t[1], t[2]]).collect();
    for _ in 0..levels {
        let mut middle = std::collections::HashMap::new();
        let mut next = Vec::new();
        for t in triangles {
            let m = [0, 1, 2].map(|k| {
                let (a, b): (u32, u32) = (t[k], t[(k + 1) % 3]);
                *middle.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    let (p, q) = (points[a as usize], points[b as usize]);
                    points.push([0, 1, 2].map(|k| (p[k] + q[k]) / 2.0));
                    points.len() as u32 - 1
                })
            });
            next.extend([[t[0], m[0], m[2]], [m[0], t[1], m[1]], [m[2], m[1], t[2]], m]);
        }
        triangles = next;
    }
    points.iter_mut().for_each(|p| *p = scale(unit(*p), radius));
    Shape { points, triangles }
}

pub fn torus(n: usize, m: usize, radius: f64, tube: f64) -> Shape {
    let mut s = Shape::default();
    for i in 0..n {
        for j in 0..m {
            let (a, b) = (TAU * i as f64 / n as f64, TAU * j as f64 / m as f64);
            let r = radius + tube * b.cos();
            s.points.push([r * a.cos(), r * a.sin(), tube * b.sin()]);
            let v = |i: usize, j: usize| (i % n * m + j % m) as u32;
            let (p, q, r, t) = (v(i, j), v(i + 1, j), v(i + 1, j + 1), v(i, j + 1));
            s.triangles.extend([[p, q, r], [p, r, t]]);
        }
    }
    s
}

/// A cone of radius 1 whose side and base are fans of n triangles.
pub fn cone(n: usize, height: f64) -> Shape {
    let mut s = Shape { points: vec![[0.0, 0.0, height], [0.0; 3]], triangles: vec![] };
    for i in 0..n as u32 {
        let a = TAU * f64::from(i) / n as f64;
        s.points.push([a.cos(), a.sin(), 0.0]);
        let (p, q) = (2 + i, 2 + (i + 1) % n as u32);
        s.triangles.extend([[0, p, q], [1, q, p]]);
    }
    s
}

/// A wedge with that angle at its edge, the edge along z in n parts, its sides of different triangles.
pub fn wedge(angle: f64, n: usize) -> Shape {
    let mut s = block([0.0; 3], [1.0; 3], [2, 1, n]);
    for p in &mut s.points {
        let a = angle * p[1];
        // The side x = 0 becomes the edge.
        *p = [p[0] * a.cos(), p[0] * a.sin(), p[2]];
    }
    s.welded()
}

/// A star-shaped body of n points with bumps, pressed by `stretch`.
pub fn blob(n: usize, seed: u64, bumps: f64, stretch: Vec3) -> Shape {
    let mut random = Random(seed.wrapping_mul(77).wrapping_add(1));
    let points: Vec<Vec3> = (0..n)
        .map(|_| {
            let (z, a) = (2.0 * random.next() - 1.0, TAU * random.next());
            [(1.0 - z * z).sqrt() * a.cos(), (1.0 - z * z).sqrt() * a.sin(), z]
        })
        .collect();
    let m = super::Triangulation::new(&points).unwrap();
    let triangles =
        m.nodes.iter().filter(|t| t[0] != u32::MAX && t[3] == u32::MAX).map(|t| [t[0], t[1], t[2]]).collect();
    let points = points
        .iter()
        .map(|p| {
            let r = 1.0 - bumps + bumps * random.next();
            [0, 1, 2].map(|k| p[k] * r * stretch[k])
        })
        .collect();
    Shape { points, triangles }
}

/// A ball of n rings of n points with four waves, and poles at that height: with 0.8 fans of n narrow triangles go into a
/// saddle, with less into a crater.
pub fn wavy_ball(n: u32, pole: f64) -> Shape {
    let mut s = Shape { points: vec![[0.0, 0.0, pole]], triangles: Vec::new() };
    for i in 0..n {
        for j in 0..n {
            let (t, p) = (PI * (f64::from(i) + 0.5) / f64::from(n), TAU * f64::from(j) / f64::from(n));
            let r = 1.0 + 0.2 * (3.0 * t).sin() * (4.0 * p).cos();
            s.points.push([r * t.sin() * p.cos(), r * t.sin() * p.sin(), r * t.cos()]);
        }
    }
    s.points.push([0.0, 0.0, -pole]);
    let at = |i: u32, j: u32| 1 + n * i + j % n;
    for j in 0..n {
        s.triangles.push([0, at(0, j), at(0, j + 1)]);
        s.triangles.push([1 + n * n, at(n - 1, j + 1), at(n - 1, j)]);
        for i in 0..n - 1 {
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            s.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    s
}
