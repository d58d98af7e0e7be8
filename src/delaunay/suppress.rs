//! Takes added points off the surface again: the tetrahedra about one, region by region, are replaced by others with the edge or
//! triangle that it had split, with a point inside where there is no other way (after George, Borouchaki and Saltel 2003).
use super::complex::FACE;
use super::fill::{fill, seen_from};
use super::{Added, Origin, Tetrahedra};
use crate::mesh::adjacency::sorted3;
use crate::mesh::vector::{Vec3, add, area2, norm, scale, sub, unit};

/// A tetrahedron or triangle that is no more.
const DEAD: u32 = u32::MAX;

/// The mesh while points are taken out, with the tetrahedra and triangles at each added point.
struct Mesh<'a> {
    r: &'a mut Tetrahedra,
    /// Number of points of the input.
    input: usize,
    tets: Vec<Vec<u32>>,
    triangles: Vec<Vec<u32>>,
}

/// What takes the place of the tetrahedra of one region about a point.
struct Sector {
    tets: Vec<[u32; 4]>,
    region: u32,
}

/// Takes out what added points it can; the later ones first, since they split what came of the earlier. `factor` is the scale
/// of coordinates in which no determinant over- or underflows.
pub fn suppress(r: &mut Tetrahedra, input: usize, factor: f64) {
    if r.added.is_empty() {
        return;
    }
    let added = r.added.len();
    r.points.iter_mut().for_each(|p| *p = scale(*p, factor));
    let mut m = Mesh { r, input, tets: vec![Vec::new(); added], triangles: vec![Vec::new(); added] };
    for t in 0..m.r.tets.len() {
        m.note_tet(t as u32);
    }
    for t in 0..m.r.triangles.len() {
        m.note_triangle(t as u32);
    }
    let mut gone = vec![false; added];
    loop {
        let before = gone.iter().filter(|&&g| g).count();
        for k in (0..added).rev() {
            if !gone[k] {
                gone[k] = m.take_out(k);
            }
        }
        if gone.iter().filter(|&&g| g).count() == before {
            break;
        }
    }
    compact(r, input, &gone, factor);
}

impl Mesh<'_> {
    fn note_tet(&mut self, t: u32) {
        for v in self.r.tets[t as usize] {
            if let Some(list) = (v as usize).checked_sub(self.input).and_then(|k| self.tets.get_mut(k)) {
                list.push(t);
            }
        }
    }

    fn note_triangle(&mut self, t: u32) {
        for v in self.r.triangles[t as usize] {
            if let Some(list) = (v as usize).checked_sub(self.input).and_then(|k| self.triangles.get_mut(k)) {
                list.push(t);
            }
        }
    }

    /// The triangles that take the place of those at the k-th added point m: each with two or three of the old ones. `None` when
    /// others than those that it made lie at it.
    fn restored(&self, k: usize, m: u32) -> Option<Vec<([u32; 3], u32)>> {
        let old = &self.triangles[k];
        let with = |t: u32, x: u32| self.r.triangles[t as usize].contains(&x);
        match self.r.added[k].origin {
            Origin::Edge([u, v]) => {
                let half: Vec<u32> = old.iter().copied().filter(|&t| with(t, u) && !with(t, v)).collect();
                let paired = half.iter().all(|&t| {
                    let c = self.r.triangles[t as usize].into_iter().find(|&x| x != u && x != m);
                    c.is_some_and(|c| old.iter().any(|&o| with(o, v) && with(o, c) && !with(o, u)))
                });
                (paired && 2 * half.len() == old.len()).then(|| {
                    half.iter()
                        .map(|&t| (self.r.triangles[t as usize].map(|x| if x == m { v } else { x }), t))
                        .collect()
                })
            }
            Origin::Triangle(f) => {
                let own = old.iter().all(|&t| self.r.triangles[t as usize].iter().all(|x| *x == m || f.contains(x)));
                (own && old.len() == 3).then(|| vec![(f, old[0])])
            }
            Origin::Inside => old.is_empty().then(Vec::new),
        }
    }

    /// Takes out the k-th added point if its place can be filled.
    fn take_out(&mut self, k: usize) -> bool {
        let m = (self.input + k) as u32;
        let Some(restored) = self.restored(k, m) else { return false };
        let walls: Vec<[u32; 3]> = self.triangles[k].iter().map(|&t| sorted3(self.r.triangles[t as usize])).collect();
        // Tetrahedra of one region between the triangles are joined across the faces at m that are none of these.
        let star = self.tets[k].clone();
        let mut group: Vec<usize> = (0..star.len()).collect();
        let mut faces: Vec<([u32; 3], usize)> = Vec::new();
        for (i, &t) in star.iter().enumerate() {
            let n = self.r.tets[t as usize];
            faces.extend(
                FACE.map(|f| (sorted3(f.map(|j| n[j])), i))
                    .into_iter()
                    .filter(|(f, _)| f.contains(&m) && !walls.contains(f)),
            );
        }
        faces.sort_unstable();
        for pair in faces.windows(2).filter(|p| p[0].0 == p[1].0) {
            let (a, b) = (group[pair[0].1], group[pair[1].1]);
            group.iter_mut().filter(|g| **g == a).for_each(|g| *g = b);
        }
        let mut names = group.clone();
        names.sort_unstable();
        names.dedup();
        let points = self.r.points.len();
        let mut sectors = Vec::new();
        for name in names {
            let own: Vec<u32> = star.iter().zip(&group).filter(|(_, g)| **g == name).map(|(t, _)| *t).collect();
            let Some(sector) = self.fill_sector(m, k, &own, &walls, &restored) else {
                self.r.points.truncate(points);
                return false;
            };
            sectors.push(sector);
        }
        for t in star {
            for v in self.r.tets[t as usize] {
                if let Some(list) = (v as usize).checked_sub(self.input).and_then(|k| self.tets.get_mut(k)) {
                    list.retain(|&x| x != t);
                }
            }
            self.r.tets[t as usize] = [DEAD; 4];
        }
        for s in sectors {
            for t in s.tets {
                self.r.tets.push(t);
                self.r.regions.push(s.region);
                self.note_tet(self.r.tets.len() as u32 - 1);
            }
        }
        let old = std::mem::take(&mut self.triangles[k]);
        for &t in &old {
            for v in self.r.triangles[t as usize] {
                if let Some(list) = (v as usize).checked_sub(self.input).and_then(|k| self.triangles.get_mut(k)) {
                    list.retain(|&x| x != t);
                }
            }
            self.r.triangles[t as usize] = [DEAD; 3];
        }
        for (f, t) in restored {
            // A triangle of the caller's orientation: that of the first part.
            self.r.triangles[t as usize] = f;
            self.note_triangle(t);
        }
        true
    }

    /// Fills what the tetrahedra `own` about m leave, with the restored triangles in the place of the split ones; perhaps with
    /// one more point, which is appended.
    fn fill_sector(
        &mut self,
        m: u32,
        k: usize,
        own: &[u32],
        walls: &[[u32; 3]],
        restored: &[([u32; 3], u32)],
    ) -> Option<Sector> {
        let region = self.r.regions[*own.first()? as usize];
        let (mut front, mut new_faces): (Vec<[u32; 3]>, Vec<[u32; 3]>) = (Vec::new(), Vec::new());
        for &t in own {
            let n = self.r.tets[t as usize];
            for f in FACE {
                let face = f.map(|j| n[j]);
                if !face.contains(&m) {
                    front.push(face);
                } else if walls.contains(&sorted3(face)) {
                    let whole = match self.r.added[k].origin {
                        Origin::Edge([u, v]) => face.contains(&u).then(|| face.map(|x| if x == m { v } else { x })),
                        Origin::Triangle(g) => {
                            // The first part alone stands for the three, in its own orientation.
                            let missing = g.into_iter().find(|x| !face.contains(x))?;
                            (missing == g[0]).then(|| face.map(|x| if x == m { missing } else { x }))
                        }
                        Origin::Inside => None,
                    };
                    new_faces.extend(whole);
                }
            }
        }
        let known = |f: &[u32; 3]| restored.iter().any(|(g, _)| sorted3(*g) == sorted3(*f));
        if !new_faces.iter().all(known) {
            return None;
        }
        front.extend(&new_faces);
        if let Some(tets) = fill(&self.r.points, front.clone()) {
            return Some(Sector { tets, region });
        }
        if new_faces.is_empty() {
            return None;
        }
        let p = self.inner_point(m, &front, &new_faces)?;
        let s = self.r.points.len() as u32;
        self.r.points.push(p);
        Some(Sector { tets: front.iter().map(|f| [f[0], f[1], f[2], s]).collect(), region })
    }

    /// A point from which all faces are seen, off m towards the inner side of the new faces.
    fn inner_point(&self, m: u32, front: &[[u32; 3]], new_faces: &[[u32; 3]]) -> Option<Vec3> {
        let at = |v: u32| self.r.points[v as usize];
        let normal = |f: &[u32; 3]| unit(area2(at(f[0]), at(f[1]), at(f[2])));
        let inwards = unit(new_faces.iter().fold([0.0; 3], |s, f| add(s, normal(f))));
        let mut corners: Vec<u32> = front.iter().flatten().copied().collect();
        corners.sort_unstable();
        corners.dedup();
        let middle = scale(corners.iter().fold([0.0; 3], |s, &v| add(s, at(v))), 1.0 / corners.len() as f64);
        let reach = corners.iter().map(|&v| norm(sub(at(v), at(m)))).fold(0.0, f64::max);
        let towards = unit(sub(middle, at(m)));
        let reached = |direction: Vec3| add(at(m), scale(direction, reach));
        let ends = [reached(inwards), reached(towards), reached(unit(add(inwards, towards)))];
        seen_from(&self.r.points, front, &[at(m)], &ends)
    }
}

/// Leaves out what is dead and numbers the points anew: input, added on the surface, added inside.
fn compact(r: &mut Tetrahedra, input: usize, gone: &[bool], factor: f64) {
    let mut number: Vec<u32> = (0..input as u32).collect();
    let mut next = input as u32;
    for g in gone {
        number.push(next);
        next += u32::from(!g);
    }
    for _ in input + gone.len()..r.points.len() {
        number.push(next);
        next += 1;
    }
    let renumber = |v: &mut u32| *v = number[*v as usize];
    let points = std::mem::take(&mut r.points);
    let kept = |i: usize| i < input || i >= input + gone.len() || !gone[i - input];
    let back = 1.0 / factor;
    r.points = points.iter().enumerate().filter(|(i, _)| kept(*i)).map(|(_, p)| scale(*p, back)).collect();
    let mut added: Vec<Added> = r.added.iter().zip(gone).filter(|(_, g)| !**g).map(|(a, _)| *a).collect();
    for a in &mut added {
        match &mut a.origin {
            Origin::Edge(ends) => ends.iter_mut().for_each(renumber),
            Origin::Triangle(f) => f.iter_mut().for_each(renumber),
            Origin::Inside => {}
        }
    }
    for (k, a) in added.iter().enumerate() {
        r.points[input + k] = a.point;
    }
    added.extend(r.points[input + added.len()..].iter().map(|&point| Added { point, origin: Origin::Inside }));
    r.added = added;
    let alive: Vec<bool> = r.tets.iter().map(|t| t[0] != DEAD).collect();
    let mut k = 0;
    r.regions.retain(|_| {
        k += 1;
        alive[k - 1]
    });
    r.tets.retain(|t| t[0] != DEAD);
    r.tets.iter_mut().flatten().for_each(renumber);
    let alive: Vec<bool> = r.triangles.iter().map(|t| t[0] != DEAD).collect();
    let keep = |k: &mut usize| {
        *k += 1;
        alive[*k - 1]
    };
    let (mut a, mut b) = (0, 0);
    r.source.retain(|_| keep(&mut a));
    r.sides.retain(|_| keep(&mut b));
    r.triangles.retain(|t| t[0] != DEAD);
    r.triangles.iter_mut().flatten().for_each(renumber);
}
