//! Normal and curvature at each sector of a surface's vertices.
use super::Features;
use super::cubic::CubicCurve;
use super::local_fit::{LocalFit, Neighbour, Room, axes};
use super::sectors::{Sectors, corner_at};
use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::stamped_set::StampedSet;
use crate::mesh::vector::{Vec3, add, area2, cross, distance, dot, norm, scale, sub, unit};
use crate::tasks::Team;
use nalgebra::{Matrix3, Vector3};
use std::collections::HashMap;

/// Neighbours that are looked for, and rings in which.
const WANTED: usize = 18;
const RINGS: usize = 4;
/// Sectors a task.
const SECTORS: usize = 256;
/// Two ridges whose tangents have a smaller sine than this go on as one; others hold the tangent plane between them.
const APART: f64 = 0.35;
/// A normal that ridges say is believed if it has this cosine with the fitted one.
const BELIEVED: f64 = 0.8;

/// What the patches are made for.
pub(crate) struct Surface<'a> {
    /// Points of the mesh.
    pub points: &'a [Vec3],
    /// Its triangles, outward.
    pub triangles: &'a [[u32; 3]],
    /// Their ridges and faces.
    pub features: &'a Features,
    /// Per face whether its inner edges stay straight: a plane, or one whose triangles do not agree about a side.
    pub is_flat: &'a [bool],
    /// A vertex this near to the plane of its neighbours is on it: the rounding of the file, model units.
    pub rounding: f64,
}

/// Where the normals of neighbours all have a greater cosine than this (25°), the fit's curvature is the better one.
const COARSE: f64 = 0.906;
/// Normals on both sides of a ridge with a greater cosine than this (4°) are one.
const SMOOTH: f64 = 0.9976;

/// Normal and curvature at a sector.
#[derive(Clone, Copy)]
pub(crate) struct SectorShape {
    /// Unit normal.
    pub normal: Vec3,
    /// Shape operator in space, 1/length: terms 11 12 22 13 23 33.
    pub shape: [f64; 6],
}

/// The shapes of all sectors, and which triangles are parts of planes.
pub(crate) fn sector_shapes(
    team: Team<'_>,
    surface: &Surface,
    sectors: &Sectors,
    ridges: &[CubicCurve],
    ridge_of: &[Option<u32>],
) -> (Vec<SectorShape>, Vec<bool>) {
    let maker = Maker::new(team, surface, sectors);
    let is_plane = team.map(SECTORS, sectors.len(), |s| maker.is_plane(s));
    let flat = maker.plane_parts(&is_plane);
    let with = || (Room::default(), StampedSet::default(), Vec::new(), Vec::new());
    let mut shapes = team.map_with(SECTORS, sectors.len(), with, |(room, seen, found, neighbours), s| {
        let plain = SectorShape { normal: maker.normals[s], shape: [0.0; 6] };
        if is_plane[s] {
            return plain;
        }
        let fit = maker.fit(s, &is_plane, room, seen, found, neighbours);
        let fitted = fit.map_or(plain, |fit| SectorShape { normal: fit.normal, shape: fit.shape });
        let normal = match maker.plane_beside(s, &flat) {
            Some(normal) => normal,
            None => maker.along_ridges(s, fitted.normal, ridges, ridge_of),
        };
        SectorShape { normal, ..fitted }
    });
    maker.join_smooth_ridges(&mut shapes, &is_plane, &flat);
    let turned = team.map_with(
        SECTORS,
        sectors.len(),
        || (StampedSet::default(), Vec::new()),
        |(seen, found), s| maker.shape_of_normals(s, &shapes, seen, found),
    );
    for (shape, turned) in shapes.iter_mut().zip(turned) {
        shape.shape = turned.unwrap_or(shape.shape);
    }
    (shapes, flat)
}

struct Maker<'a> {
    surface: &'a Surface<'a>,
    sectors: &'a Sectors,
    /// Mean normals of the sectors' triangles, weighted with their angles.
    normals: Vec<Vec3>,
    /// Unit normals of the triangles.
    facets: Vec<Vec3>,
}

impl<'a> Maker<'a> {
    fn new(team: Team<'_>, surface: &'a Surface<'a>, sectors: &'a Sectors) -> Self {
        let facets = team.map(SECTORS, surface.triangles.len(), |t| {
            let [a, b, c] = surface.triangles[t].map(|v| surface.points[v as usize]);
            unit(area2(a, b, c))
        });
        let mut maker = Self { surface, sectors, normals: Vec::new(), facets };
        maker.normals = team.map(SECTORS, sectors.len(), |s| maker.mean_normal(s));
        maker
    }

    /// A corner's point, and those of the next and the last corner of its triangle.
    fn corner(&self, corner: u32) -> [Vec3; 3] {
        let (t, k) = (corner as usize / 3, corner as usize % 3);
        [0, 1, 2].map(|i| self.surface.points[self.surface.triangles[t][(k + i) % 3] as usize])
    }

    fn point(&self, sector: usize) -> Vec3 {
        self.corner(self.sectors.corners.row(sector)[0])[0]
    }

    fn mean_normal(&self, sector: usize) -> Vec3 {
        let sum = self.sectors.corners.row(sector).iter().fold([0.0; 3], |sum, &corner| {
            let [here, next, last] = self.corner(corner);
            let (e, f) = (sub(next, here), sub(last, here));
            let angle = norm(cross(e, f)).atan2(dot(e, f));
            add(sum, scale(self.facets[corner as usize / 3], angle))
        });
        unit(sum)
    }

    /// Triangles at vertices inside plane parts, and those that go on in their planes.
    fn plane_parts(&self, is_plane: &[bool]) -> Vec<bool> {
        let Surface { triangles, features, points, rounding, .. } = *self.surface;
        let mut flat = vec![false; triangles.len()];
        let mut stack = Vec::new();
        for s in (0..is_plane.len()).filter(|&s| is_plane[s]) {
            for t in self.sectors.corners.row(s).iter().map(|&corner| corner as usize / 3) {
                if !flat[t] {
                    flat[t] = true;
                    stack.push(t);
                }
            }
        }
        while let Some(t) = stack.pop() {
            let (here, normal) = (points[triangles[t][0] as usize], self.facets[t]);
            for &edge in &features.edges.of_side[3 * t..3 * t + 3] {
                for other in features.edges.triangles(edge as usize) {
                    let is_on = |v: u32| dot(sub(points[v as usize], here), normal).abs() <= rounding;
                    let goes_on = !features.ridge[edge as usize] && dot(self.facets[other], normal) > 0.5;
                    if !flat[other] && goes_on && triangles[other].into_iter().all(is_on) {
                        flat[other] = true;
                        stack.push(other);
                    }
                }
            }
        }
        flat
    }

    /// Whether the vertex lies inside a plane part: all of its triangles do, and it has none but these.
    fn is_plane(&self, sector: usize) -> bool {
        let (here, normal) = (self.point(sector), self.normals[sector]);
        let corners = self.sectors.corners.row(sector);
        let is_on = |p: Vec3| dot(sub(p, here), normal).abs() <= self.surface.rounding;
        self.is_inside(sector)
            && corners.iter().all(|&corner| {
                let [_, next, last] = self.corner(corner);
                is_on(next) && is_on(last)
            })
    }

    /// Whether the triangles of the sector close around its vertex.
    fn is_inside(&self, sector: usize) -> bool {
        let features = self.surface.features;
        self.sectors.corners.row(sector).iter().all(|&corner| {
            let (t, k) = (corner as usize / 3, corner as usize % 3);
            [k, (k + 2) % 3].iter().all(|side| !features.ridge[features.edges.of_side[3 * t + side] as usize])
        })
    }

    /// The normal of the plane parts at a sector, if there are any.
    fn plane_beside(&self, sector: usize, flat: &[bool]) -> Option<Vec3> {
        let triangles = self.sectors.corners.row(sector).iter().map(|&corner| corner as usize / 3);
        let sum = triangles.filter(|&t| flat[t]).fold([0.0; 3], |sum, t| add(sum, self.facets[t]));
        (sum != [0.0; 3]).then(|| unit(sum))
    }

    fn fit(
        &self,
        sector: usize,
        is_plane: &[bool],
        room: &mut Room,
        seen: &mut StampedSet,
        found: &mut Vec<u32>,
        neighbours: &mut Vec<Neighbour>,
    ) -> Option<LocalFit> {
        let here = self.point(sector);
        self.sectors.around(sector as u32, WANTED, RINGS, seen, found);
        neighbours.clear();
        // What a plane says of its own inside tells nothing about what curves beside it.
        let others = found[1..].iter().filter(|&&s| !is_plane[s as usize]);
        neighbours.extend(
            others.map(|&s| Neighbour { offset: sub(self.point(s as usize), here), normal: self.normals[s as usize] }),
        );
        let corners = self.sectors.corners.row(sector);
        let lengths = corners.iter().map(|&corner| {
            let [here, next, last] = self.corner(corner);
            distance(here, next) + distance(here, last)
        });
        room.fit(neighbours, self.normals[sector], lengths.sum::<f64>() / (2 * corners.len()) as f64)
    }

    /// The symmetric S with n_j − n_i = −S (p_j − p_i) in the tangent plane, over the neighbours j of a sector, by least squares: with good
    /// normals it is right on circles however far apart the neighbours are (Rusinkiewicz 2004 has it for triangles). None where the fitted one,
    /// of one order more, is better, since the normals turn little; or where the neighbours lie in a line.
    fn shape_of_normals(
        &self,
        sector: usize,
        shapes: &[SectorShape],
        seen: &mut StampedSet,
        found: &mut Vec<u32>,
    ) -> Option<[f64; 6]> {
        let (here, normal) = (self.point(sector), shapes[sector].normal);
        let (e1, e2) = axes(normal);
        self.sectors.around(sector as u32, 0, 1, seen, found);
        if found[1..].iter().all(|&other| dot(shapes[other as usize].normal, normal) > COARSE) {
            return None;
        }
        let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for &other in &found[1..] {
            let offset = sub(self.point(other as usize), here);
            let turn = sub(shapes[other as usize].normal, normal);
            let ([x, y], [a, b]) = ([e1, e2].map(|e| dot(offset, e)), [e1, e2].map(|e| dot(turn, e)));
            let square = x * x + y * y;
            if square > 0.0 {
                let (xx, xy, yy) = (x * x / square, x * y / square, y * y / square);
                matrix += Matrix3::new(xx, xy, 0.0, xy, 1.0, xy, 0.0, xy, yy);
                right -= Vector3::new(x * a, y * a + x * b, y * b) / square;
            }
        }
        let count = (found.len() - 1) as f64;
        let is_told = matrix.determinant() > 1e-3 * count * count * count;
        let s = is_told.then(|| matrix.lu().solve(&right)).flatten()?;
        let term =
            |i: usize, j: usize| s[0] * e1[i] * e1[j] + s[1] * (e1[i] * e2[j] + e2[i] * e1[j]) + s[2] * e2[i] * e2[j];
        let shape = [term(0, 0), term(0, 1), term(1, 1), term(0, 2), term(1, 2), term(2, 2)];
        shape.iter().all(|x| x.is_finite()).then_some(shape)
    }

    /// Gives the sectors on both sides of a ridge one normal where theirs are nearly the same: that is a line on a smooth surface, between
    /// references. What a plane says there counts alone.
    fn join_smooth_ridges(&self, shapes: &mut [SectorShape], is_plane: &[bool], flat: &[bool]) {
        let Surface { triangles, features, is_flat, .. } = *self.surface;
        let mut sets = DisjointSets::new(shapes.len());
        for edge in (0..features.edges.len()).filter(|&edge| features.ridge[edge]) {
            let &[first, second] = features.edges.sides(edge) else { continue };
            for v in features.edges.nodes[edge] {
                let [a, b] = [first, second].map(|side| self.sectors.of_corner[corner_at(triangles, side, v) as usize]);
                if a != b && dot(shapes[a as usize].normal, shapes[b as usize].normal) > SMOOTH {
                    sets.join(a, b);
                }
            }
        }
        let is_exact = |s: usize| {
            let mut own = self.sectors.corners.row(s).iter().map(|&corner| corner as usize / 3);
            is_plane[s] || own.any(|t| flat[t] || is_flat[features.patch[t] as usize])
        };
        let mut sums: HashMap<u32, [Vec3; 2]> = HashMap::new();
        for s in 0..shapes.len() as u32 {
            let first = sets.first(s);
            if first != s {
                sums.entry(first).or_default();
            }
        }
        for s in 0..shapes.len() {
            if let Some(sum) = sums.get_mut(&sets.first(s as u32)) {
                let kind = usize::from(is_exact(s));
                sum[kind] = add(sum[kind], shapes[s].normal);
            }
        }
        for s in 0..shapes.len() {
            if let Some([any, exact]) = sums.get(&sets.first(s as u32)) {
                shapes[s].normal = unit(if *exact == [0.0; 3] { *any } else { *exact });
            }
        }
    }

    /// The normal made perpendicular to the ridges at the sector.
    fn along_ridges(&self, sector: usize, normal: Vec3, ridges: &[CubicCurve], ridge_of: &[Option<u32>]) -> Vec3 {
        let edges = &self.surface.features.edges;
        let (mut tangents, mut count) = ([[0.0; 3]; 2], 0);
        for &corner in self.sectors.corners.row(sector) {
            let (t, k) = (corner as usize / 3, corner as usize % 3);
            let vertex = self.surface.triangles[t][k];
            for side in [k, (k + 2) % 3] {
                let edge = edges.of_side[3 * t + side] as usize;
                let Some(ridge) = ridge_of[edge] else { continue };
                let curve = &ridges[ridge as usize];
                let [from, to] =
                    if edges.nodes[edge][0] == vertex { [curve[0], curve[1]] } else { [curve[3], curve[2]] };
                if count == 2 {
                    return normal;
                }
                tangents[count] = unit(sub(to, from));
                count += 1;
            }
        }
        let [a, b] = tangents;
        let across = cross(a, b);
        if count == 2 && norm(across) > APART {
            let both = if dot(across, normal) < 0.0 { scale(unit(across), -1.0) } else { unit(across) };
            return if dot(both, normal) > BELIEVED { both } else { normal };
        }
        let along = if count == 2 && dot(a, b) < 0.0 { unit(sub(a, b)) } else { a };
        let found = unit(sub(normal, scale(along, dot(normal, along))));
        if dot(found, normal) > BELIEVED { found } else { normal }
    }
}
