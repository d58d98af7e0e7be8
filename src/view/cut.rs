//! What of a scene is seen: behind a plane, on surfaces that are not hidden, below a quality.
//!
//! A cut goes along the plane itself ([`section`](super::section)), or keeps whole tetrahedra: all that reach behind the plane. So a face between a kept tetrahedron and one that is not kept has all
//! three vertices in front, and the fourth vertex of the kept one is behind. Only tetrahedra with exactly one vertex behind can show a
//! face, and no neighbours are needed to find them.
use super::Scene;
use super::section::{Corner, Heights, Piece};
use crate::mesh::adjacency::NONE;
use crate::mesh::vector::{Vec3, dot, norm};
use crate::tasks::{GRAIN, Team};
use std::collections::BTreeSet;

/// A plane n·p = d; behind it is n·p < d.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Unit normal.
    pub normal: Vec3,
    /// d, model units.
    pub offset: f64,
}

impl Plane {
    /// Whether a point is behind.
    pub fn is_behind(&self, p: Vec3) -> bool {
        dot(self.normal, p) < self.offset
    }
}

impl std::str::FromStr for Plane {
    type Err = String;

    /// Reads `x=0.5`, `-z=0` (which keeps the other side), or `1,1,0=0.5`: n·p = 0.5 with the normal as it is given.
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("'{text}' is no plane; give x=0.5, -z=0.1 (the other side), or a normal: 1,1,0=0.5");
        let (normal, offset) = text.split_once('=').ok_or_else(wrong)?;
        let offset: f64 = offset.trim().parse().map_err(|_| wrong())?;
        let axis = |name: &str| ["x", "y", "z"].iter().position(|axis| *axis == name);
        let normal = normal.trim();
        let (sign, unsigned) = normal.strip_prefix('-').map_or((1.0, normal), |rest| (-1.0, rest));
        let (normal, offset): (Vec3, f64) = if let Some(axis) = axis(unsigned) {
            // -z=0.1 is the plane z = 0.1 seen from below.
            (std::array::from_fn(|i| if i == axis { sign } else { 0.0 }), sign * offset)
        } else {
            let parts: Vec<f64> =
                normal.split(',').map(|part| part.trim().parse()).collect::<Result<_, _>>().map_err(|_| wrong())?;
            (parts.try_into().map_err(|_| wrong())?, offset)
        };
        let length = norm(normal);
        if !(length > 0.0 && length.is_finite() && offset.is_finite()) {
            return Err(wrong());
        }
        Ok(Self { normal: normal.map(|x| x / length), offset: offset / length })
    }
}

/// Where a cut goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// Between tetrahedra, which stay whole.
    #[default]
    Tets,
    /// Along the plane.
    Plane,
}

/// Which part of a scene.
#[derive(Clone, Debug, Default)]
pub struct Part {
    /// What is in front of it is taken away.
    pub plane: Option<Plane>,
    /// How.
    pub style: Style,
    /// References of surfaces that are not drawn.
    pub hidden: BTreeSet<i32>,
    /// Only tetrahedra of a quality below this, and no surface.
    pub below: Option<f32>,
}

/// What is drawn.
pub struct Shown {
    /// Triangles of the surface.
    pub triangles: Vec<u32>,
    /// Faces 4·tet + face.
    pub faces: Vec<u32>,
    /// Edges.
    pub edges: Vec<u32>,
    /// What a cut along the plane makes of tetrahedra and triangles that it meets.
    pub pieces: Vec<Piece>,
    /// What it leaves of edges that it meets.
    pub ends: Vec<[Corner; 2]>,
}

impl Part {
    /// Finds it.
    pub fn of(&self, team: Team<'_>, scene: &Scene<'_>) -> Shown {
        let mesh = scene.mesh;
        if let (Some(plane), Style::Plane, None) = (self.plane, self.style, self.below) {
            return self.along(team, scene, plane);
        }
        let behind =
            team.map(GRAIN, mesh.vertices.len(), |v| self.plane.is_none_or(|plane| plane.is_behind(mesh.vertices[v])));
        let is_behind = |v: u32| behind[v as usize];
        let kept = |tet: u32| tet != NONE && mesh.tets.nodes[tet as usize].iter().any(|&v| is_behind(v));
        let surface = &scene.surface;
        let triangles = team.collect(GRAIN, surface.triangles.len(), |range, found| {
            for t in range.filter(|_| self.below.is_none()) {
                let sides = surface.sides[t];
                let seen = if sides[0] == NONE {
                    surface.triangles.nodes[t].iter().any(|&v| is_behind(v))
                } else {
                    kept(sides[0]) || kept(sides[1])
                };
                if seen && !self.hidden.contains(&surface.triangles.refs[t]) {
                    found.push(t as u32);
                }
            }
        });
        let faces = team.collect(GRAIN, mesh.tets.len(), |range, found| {
            for tet in range {
                let here = mesh.tets.nodes[tet].map(is_behind);
                let count = here.iter().filter(|&&one| one).count();
                if let Some(limit) = self.below {
                    if count > 0 && scene.quality.values[tet] < limit {
                        found.extend((0..4).map(|face| (4 * tet + face) as u32));
                    }
                } else if count == 1 {
                    let face = (0..4).find(|&i| here[i]).unwrap_or(0);
                    if surface.masks[tet] >> face & 1 == 0 {
                        found.push((4 * tet + face) as u32);
                    }
                }
            }
        });
        let on_shown = self.vertices(scene);
        let edges = team.collect(GRAIN, scene.ridges.len(), |range, found| {
            let seen =
                |nodes: [u32; 2]| nodes.iter().any(|&v| is_behind(v)) && nodes.iter().all(|&v| on_shown[v as usize]);
            found.extend(range.filter(|&e| seen(scene.ridges.nodes[e])).map(|e| e as u32));
        });
        Shown { triangles, faces, edges, pieces: Vec::new(), ends: Vec::new() }
    }

    /// What a cut along the plane leaves.
    fn along(&self, team: Team<'_>, scene: &Scene<'_>, plane: Plane) -> Shown {
        let (mesh, surface) = (scene.mesh, &scene.surface.triangles);
        let heights = Heights::of(team, &mesh.vertices, plane);
        let clipped = team.chunks(GRAIN, surface.len(), |range| {
            let (mut whole, mut pieces) = (Vec::new(), Vec::new());
            for t in range.filter(|&t| !self.hidden.contains(&surface.refs[t])) {
                if heights.clip_triangle(t as u32, surface.nodes[t], &mut pieces) {
                    whole.push(t as u32);
                }
            }
            (whole, pieces)
        });
        let (mut triangles, mut pieces) = (Vec::new(), Vec::new());
        for (whole, of_triangles) in clipped {
            triangles.extend(whole);
            pieces.extend(of_triangles);
        }
        pieces.extend(team.collect(GRAIN, mesh.tets.len(), |range, found| {
            range.for_each(|tet| heights.cut_tet(tet as u32, mesh.tets.nodes[tet], found));
        }));
        let on_shown = self.vertices(scene);
        let (mut edges, mut ends) = (Vec::new(), Vec::new());
        for (e, &nodes) in (0..).zip(&scene.ridges.nodes) {
            if !nodes.iter().all(|&v| on_shown[v as usize]) {
                continue;
            }
            match heights.clip_edge(nodes) {
                Some([a, b]) if a.ends[0] == a.ends[1] && b.ends[0] == b.ends[1] => edges.push(e),
                part => ends.extend(part),
            }
        }
        Shown { triangles, faces: Vec::new(), edges, pieces, ends }
    }

    /// Whether each vertex is one of a triangle that is not hidden; the plane does not matter.
    pub fn vertices(&self, scene: &Scene<'_>) -> Vec<bool> {
        let mut on_shown = vec![false; scene.mesh.vertices.len()];
        for (nodes, reference) in scene.surface.triangles.iter() {
            if !self.hidden.contains(&reference) {
                nodes.iter().for_each(|&v| on_shown[v as usize] = true);
            }
        }
        on_shown
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::adjacency::{FACES, neighbours};
    use crate::mesh::samples::cube;
    use crate::view::Given;

    #[test]
    fn planes_are_read() {
        let plane: Plane = "x=0.5".parse().unwrap();
        assert_eq!(plane, Plane { normal: [1.0, 0.0, 0.0], offset: 0.5 });
        let plane: Plane = "-z=0.25".parse().unwrap();
        assert_eq!(plane, Plane { normal: [-0.0, 0.0, -1.0].map(|x: f64| x + 0.0), offset: -0.25 });
        let plane: Plane = "0,-3,4=10".parse().unwrap();
        assert_eq!(plane, Plane { normal: [0.0, -0.6, 0.8], offset: 2.0 });
        for wrong in ["", "x", "w=1", "x=", "1,2=3", "0,0,0=1", "x=nan", "1,2,3,4=5"] {
            assert!(wrong.parse::<Plane>().unwrap_err().contains("x=0.5"), "{wrong}");
        }
    }

    #[test]
    fn the_cut_shows_every_face_between_what_is_kept_and_what_is_not() {
        let mesh = cube(4);
        let scene = Scene::new(Team::alone(), &mesh, Given::default());
        let part = Part { plane: Some("0.3,0.5,1=0.9".parse().unwrap()), ..Part::default() };
        let shown = part.of(Team::alone(), &scene);
        let plane = part.plane.unwrap();
        let kept = |t: u32| mesh.tets.nodes[t as usize].iter().any(|&v| plane.is_behind(mesh.vertices[v as usize]));
        let mut bare = 0;
        for (t, around) in (0..).zip(neighbours(&mesh.tets.nodes)) {
            for (face, other) in (0..).zip(around) {
                if other != NONE && kept(t) && !kept(other) {
                    bare += 1;
                    assert!(shown.faces.contains(&(4 * t + face)), "{t} {face}");
                }
            }
        }
        assert!(bare > 30);
        // Of the surface what belongs to tetrahedra that are kept, whole.
        let surface = &scene.surface;
        let of_kept = surface.sides.iter().filter(|side| kept(side[0])).count();
        assert_eq!(shown.triangles.len(), of_kept);
        assert!(of_kept > 0 && of_kept < surface.triangles.len());
        // Faces of the surface are drawn as such, once.
        let on_surface = |side: u32| {
            let nodes = FACES[side as usize % 4].map(|i| mesh.tets.nodes[side as usize / 4][i]);
            surface.triangles.nodes.iter().any(|t| t.iter().all(|v| nodes.contains(v)))
        };
        assert!(!shown.faces.iter().any(|&side| on_surface(side)));
    }

    #[test]
    fn surfaces_hide_and_bad_tetrahedra_stand_alone() {
        let mesh = cube(2);
        let scene = Scene::new(Team::alone(), &mesh, Given::default());
        let shown = Part { hidden: [1, 2].into(), ..Part::default() }.of(Team::alone(), &scene);
        assert_eq!((shown.triangles.len(), shown.faces.len()), (32, 0));
        let all = Part { below: Some(1.1), ..Part::default() }.of(Team::alone(), &scene);
        assert_eq!((all.triangles.len(), all.faces.len()), (0, 4 * 48));
    }
}
