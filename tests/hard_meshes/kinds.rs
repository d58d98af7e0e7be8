//! Small meshes on which something may go wrong: what they look like, and what must come of them.
use geo_adapt::mesh::samples::{cube, with_boundary};
use geo_adapt::mesh::vector::{Vec3, cross, dot, norm, scale, sub};
use geo_adapt::mesh::{Elements, TetMesh};
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// A kind of mesh.
pub struct Kind {
    pub name: &'static str,
    pub mesh: TetMesh,
    /// More options of `adapt`.
    pub options: Vec<&'static str>,
    /// How far volumes may be off, as a part: rounding, and on round surfaces the chords.
    pub slack: f64,
    /// Words of the error with which it must be refused.
    pub refused: Option<&'static str>,
}

impl Kind {
    fn new(name: &'static str, mesh: TetMesh) -> Self {
        Self { name, mesh, options: Vec::new(), slack: 1e-9, refused: None }
    }

    fn slack(self, slack: f64) -> Self {
        Self { slack, ..self }
    }

    fn options(self, options: &[&'static str]) -> Self {
        Self { options: options.to_vec(), ..self }
    }

    fn refused(self, words: &'static str) -> Self {
        Self { refused: Some(words), ..self }
    }
}

/// All kinds.
pub fn all() -> Vec<Kind> {
    [simple(), holes(), thin(), far(), marked(), held()].into_iter().flatten().collect()
}

fn simple() -> Vec<Kind> {
    let corners: Vec<Vec3> = cube(1).vertices;
    let five = vec![[0, 4, 2, 1], [6, 2, 4, 7], [5, 4, 1, 7], [3, 1, 2, 7], [1, 2, 4, 7]];
    vec![
        Kind::new("none", TetMesh { tets: Elements::default(), ..cube(1) }).refused("no tetrahedra"),
        Kind::new(
            "one tetrahedron",
            oriented(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], vec![[0, 1, 2, 3]]),
        ),
        Kind::new("five", oriented(corners, five)),
        Kind::new("cube 1", cube(1)),
        Kind::new("cube 2", cube(2)),
        Kind::new("cube 5", cube(5)),
        // As round as the ball: a coarse metric leaves the chords that the kernel's own limits allow.
        Kind::new("fan of 100", fan(100)).slack(0.3),
        Kind::new("fan of 500", fan(500)).slack(0.3),
        Kind::new("ball", moved(cube(4), ball)).slack(0.3),
        Kind::new("jiggled", moved(cube(3), |p| std::array::from_fn(|i| p[i] + jiggle(p)[i]))),
    ]
}

fn holes() -> Vec<Kind> {
    let middle = |x: f64| (x - 0.5).abs() < 0.2;
    vec![
        Kind::new("tunnel", kept(3, |c| !(middle(c[0]) && middle(c[1])))),
        Kind::new("hollow", kept(3, |c| !c.into_iter().all(middle))),
        Kind::new("angle", kept(2, |c| !(c[0] > 0.5 && c[1] > 0.5))),
        Kind::new("two bodies", kept(3, |c| !middle(c[0]))),
        Kind::new("unused vertices", with_unused(cube(2))),
    ]
}

fn thin() -> Vec<Kind> {
    let flat = |height: f64| moved(cube(2), move |p| [p[0], p[1], if p[2] == 0.5 { height } else { p[2] }]);
    let sliver = moved(cube(3), |p| if p == [1.0 / 3.0; 3] { [1e-18, p[1], p[2]] } else { p });
    vec![
        Kind::new("slivers of 1e-18", sliver),
        Kind::new("layer of 1e-18", flat(1e-18)),
        Kind::new("layer of 1e-6", flat(1e-6)),
        Kind::new("needle", stretched(3, [1e3, 1.0, 1.0])),
        Kind::new("plate", stretched(3, [1.0, 1.0, 1e-2])),
        Kind::new("wide plate", stretched(3, [10.0, 10.0, 0.1])),
        Kind::new("sheared", moved(cube(3), |p| [p[0] + 20.0 * p[1], p[1], p[2]])),
        Kind::new("graded", moved(cube(3), |p| p.map(|x| x.powi(12)))),
    ]
}

fn far() -> Vec<Kind> {
    let at = |offset: f64| moved(cube(2), move |p| p.map(|x| x + offset));
    vec![
        Kind::new("offset 1e8", at(1e8)).slack(1e-6),
        Kind::new("offset 1e12", at(1e12)).slack(1e-2),
        Kind::new("scale 1e9", stretched(2, [1e9; 3])),
        Kind::new("scale 1e-9", stretched(2, [1e-9; 3])),
        Kind::new("scale 1e60", stretched(2, [1e60; 3])),
        Kind::new("scale 1e-60", stretched(2, [1e-60; 3])),
    ]
}

fn marked() -> Vec<Kind> {
    let mut regions = cube(5);
    regions.tets.refs = (1..).take(regions.tets.len()).collect();
    let mut board = cube(4);
    let cell = |tet: usize| tet / 6;
    board.tets.refs = (0..board.tets.len()).map(|t| 1 + (cell(t) + cell(t) / 4 + cell(t) / 16) as i32 % 2).collect();
    let mut patches = cube(5);
    patches.triangles.refs = (1..).take(patches.triangles.len()).collect();
    vec![
        Kind::new("a region each", regions),
        Kind::new("two regions in turn", board),
        Kind::new("a reference each", patches),
    ]
}

fn held() -> Vec<Kind> {
    let mut all = cube(5);
    all.triangles = faces(&all);
    all.edges = edges(&all);
    all.required_triangles = (0..all.triangles.len() as u32).collect();
    all.required_edges = (0..all.edges.len() as u32).collect();
    let mut skin = cube(5);
    skin.required_triangles = (0..skin.triangles.len() as u32).collect();
    let mut vertices = cube(3);
    vertices.required_vertices = (0..vertices.vertices.len() as u32).collect();
    vec![
        Kind::new("all required", all),
        Kind::new("a required skin", skin),
        Kind::new("required vertices", vertices),
        Kind::new("all frozen", cube(3)).options(&["--freeze", "region:1"]),
        Kind::new("a frozen side", cube(3)).options(&["--freeze", "1"]),
    ]
}

/// The tetrahedra turned to be positive.
fn oriented(vertices: Vec<Vec3>, tets: Vec<[u32; 4]>) -> TetMesh {
    let positive = |[a, b, c, d]: [u32; 4]| {
        let [p, q, r, s] = [a, b, c, d].map(|v| vertices[v as usize]);
        if dot(cross(sub(q, p), sub(r, p)), sub(s, p)) < 0.0 { [b, a, c, d] } else { [a, b, c, d] }
    };
    let tets = tets.into_iter().map(positive).collect();
    with_boundary(vertices, tets)
}

/// So many tetrahedra about an edge.
pub fn fan(n: u32) -> TetMesh {
    let rim = |i: u32| {
        let (s, c) = (TAU * f64::from(i) / f64::from(n)).sin_cos();
        [c, s, 0.5]
    };
    let vertices = [[0.0; 3], [0.0, 0.0, 1.0]].into_iter().chain((0..n).map(rim)).collect();
    oriented(vertices, (0..n).map(|i| [0, 1, 2 + i, 2 + (i + 1) % n]).collect())
}

fn moved(mut mesh: TetMesh, to: impl Fn(Vec3) -> Vec3) -> TetMesh {
    mesh.vertices.iter_mut().for_each(|p| *p = to(*p));
    mesh
}

fn stretched(n: u32, by: Vec3) -> TetMesh {
    moved(cube(n), |p| std::array::from_fn(|i| p[i] * by[i]))
}

/// The cube [0, 1]³ as a ball.
fn ball(p: Vec3) -> Vec3 {
    let q = p.map(|x| 2.0 * x - 1.0);
    let (most, length) = (q.into_iter().fold(0.0f64, |a, x| a.max(x.abs())), norm(q));
    if length == 0.0 { q } else { scale(q, most / length) }
}

/// Some of a tenth, inside.
fn jiggle(p: Vec3) -> Vec3 {
    let inside = p.iter().all(|&x| x > 0.0 && x < 1.0);
    let part = |i: usize| ((p[0] * 12.9898 + p[1] * 78.233 + p[2] * 37.719 + i as f64) * 43_758.545).fract() * 0.1;
    if inside { [part(0), part(1), part(2)] } else { [0.0; 3] }
}

/// The cells of a cube whose centres are wanted.
fn kept(n: u32, wanted: impl Fn(Vec3) -> bool) -> TetMesh {
    let mesh = cube(n);
    let centre = |nodes: &[u32; 4]| -> Vec3 {
        let corners = nodes.map(|v| mesh.vertices[v as usize]);
        std::array::from_fn(|i| {
            let (low, high) = corners.iter().fold((1.0f64, 0.0f64), |(l, h), p| (l.min(p[i]), h.max(p[i])));
            0.5 * (low + high)
        })
    };
    let tets: Vec<[u32; 4]> = mesh.tets.nodes.iter().copied().filter(|nodes| wanted(centre(nodes))).collect();
    let used: BTreeSet<u32> = tets.iter().flatten().copied().collect();
    let number = |v: u32| used.range(..v).count() as u32;
    let vertices = used.iter().map(|&v| mesh.vertices[v as usize]).collect();
    with_boundary(vertices, tets.into_iter().map(|nodes| nodes.map(number)).collect())
}

fn with_unused(mut mesh: TetMesh) -> TetMesh {
    mesh.vertices.extend([[5.0; 3], [-3.0, 0.0, 0.0], [0.3; 3]]);
    mesh.vertex_refs.resize(mesh.vertices.len(), 0);
    mesh
}

/// Every face once.
fn faces(mesh: &TetMesh) -> Elements<3> {
    let mut faces = Elements::default();
    let of = |[a, b, c, d]: [u32; 4]| [[b, c, d], [a, d, c], [a, b, d], [a, c, b]];
    let mut met = BTreeSet::new();
    for face in mesh.tets.nodes.iter().copied().flat_map(of) {
        let mut key = face;
        key.sort_unstable();
        if met.insert(key) {
            faces.push(face, 1);
        }
    }
    faces
}

/// Every edge once.
fn edges(mesh: &TetMesh) -> Elements<2> {
    let mut edges = Elements::default();
    let of = |[a, b, c, d]: [u32; 4]| [[a, b], [a, c], [a, d], [b, c], [b, d], [c, d]];
    let all: BTreeSet<[u32; 2]> =
        mesh.tets.nodes.iter().copied().flat_map(of).map(|[a, b]| [a.min(b), a.max(b)]).collect();
    all.into_iter().for_each(|nodes| edges.push(nodes, 1));
    edges
}
