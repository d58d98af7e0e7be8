//! The result is that in memory, to the bit, whatever is done at once.
use super::*;
use crate::mesh::TetMesh;
use crate::mesh::io::{self, FieldKind, Solution, SolutionField};
use crate::mesh::locate::Locator;
use crate::mesh::samples::cube;
use crate::mesh::vector::{Vec3, add, scale};
use crate::tasks::{Plan, Pool};
use crate::transfer::{Keep, conservative as in_memory, interpolate as interpolate_in_memory, measure};
use tempfile::TempDir;

/// Cells of some ten tetrahedra, which do not fit and are halved again; then larger ones; then all at once.
const SIZES: [Sizes; 3] = [
    Sizes { task: 9_000, waiting: 9_000, slice: 37 },
    Sizes { task: 60_000, waiting: 200_000, slice: 1 << 10 },
    Sizes { task: 1 << 30, waiting: 1 << 30, slice: 1 << 14 },
];

/// Two meshes and a field in files.
struct Case {
    folder: TempDir,
    meshes: [TetMesh; 2],
    width: usize,
    values: Vec<f64>,
}

impl Case {
    fn new(old: TetMesh, new: TetMesh) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let value = |p: Vec3| [(7.0 * p[0]).sin() + p[1] * p[2], (3.0 * p[2] + p[0]).cos()];
        let fields = [0, 1].map(|k| {
            let values = old.vertices.iter().map(|&p| value(p)[k]).collect();
            SolutionField { kind: FieldKind::Scalar, values }
        });
        let solution = Solution { vertices: old.vertices.len(), fields: fields.to_vec() };
        let path = |name: &str| folder.path().join(name);
        io::write_mesh(&path("old.meshb"), &old).unwrap();
        io::write_mesh(&path("new.meshb"), &new).unwrap();
        io::write_solution(&path("old.solb"), &solution).unwrap();
        let values = old.vertices.iter().flat_map(|&p| value(p)).collect();
        Self { folder, meshes: [old, new], width: 2, values }
    }

    fn path(&self, name: &str) -> std::path::PathBuf {
        self.folder.path().join(name)
    }

    /// Compares both ways of transfer, and returns how many vertices are outside.
    fn check(&self) -> usize {
        let (alone, [old, new], width) = (Team::alone(), &self.meshes, self.width);
        let locator = Locator::new(old.vertices.clone(), old.tets.nodes.clone());
        let places = Places::of(alone, &locator, &new.vertices);
        let expected = interpolate_in_memory(alone, &locator, &places, width, &self.values);
        let before = measure(alone, old, width, &self.values);
        let kept = [Keep::Mean, Keep::Mass]
            .map(|keep| (keep, in_memory(alone, &locator, new, &places, width, &self.values, keep).unwrap()));
        let readers = ["old.meshb", "new.meshb"].map(|name| MeshReader::open(&self.path(name)).unwrap());
        let [of, to] = &readers;
        let fields = crate::mesh::io::slices::SolutionReader::open(&self.path("old.solb")).unwrap();
        let scratch = Scratch::within(self.folder.path());
        let (pool, many) = (Pool::new(3).unwrap(), new.vertices.len());
        for sizes in &SIZES {
            for team in [alone, Team::new(&pool, Plan::default())] {
                let found = interpolate(team, [of, to], &Linear(&fields), (sizes, &scratch)).unwrap();
                assert_eq!((found.outside, found.farthest), (places.outside, places.farthest), "{sizes:?}");
                same(&found.rows[1].read(0..many).unwrap(), &expected, sizes);
                let after = measure(alone, new, width, &expected);
                assert_eq!(found.measure(team).unwrap(), [before.clone(), after]);
            }
            for (keep, expected) in &kept {
                let team = Team::new(&pool, Plan::default());
                let (found, overlap) =
                    conservative(team, [of, to], (&Linear(&fields), *keep), (sizes, &scratch)).unwrap();
                same(&found.rows[1].read(0..many).unwrap(), &expected.values, sizes);
                let counts = (overlap.partly, overlap.outside, overlap.common);
                assert_eq!(counts, (expected.partly, expected.outside, expected.common), "{sizes:?}");
                assert_eq!(overlap.corrected, expected.corrected);
            }
        }
        let left: Vec<_> = std::fs::read_dir(self.folder.path()).unwrap().collect();
        assert_eq!(left.len(), 3, "nothing stays in the scratch folder");
        places.outside
    }
}

/// To the bit.
fn same(found: &[f64], expected: &[f64], sizes: &Sizes) {
    let first = found.iter().zip(expected).position(|(a, b)| a.to_bits() != b.to_bits());
    assert_eq!((found.len(), first), (expected.len(), None), "{sizes:?}");
}

fn at(mut mesh: TetMesh, f: impl Fn(Vec3) -> Vec3) -> TetMesh {
    mesh.vertices.iter_mut().for_each(|p| *p = f(*p));
    mesh
}

/// All tetrahedra of the cube but some.
fn without(n: u32, is_missing: impl Fn(Vec3) -> bool) -> TetMesh {
    let mut mesh = cube(n);
    let middle = |tet: &[u32; 4]| tet.iter().fold([0.0; 3], |s, &v| add(s, scale(mesh.vertices[v as usize], 0.25)));
    mesh.tets.nodes = mesh.tets.nodes.iter().copied().filter(|tet| !is_missing(middle(tet))).collect();
    mesh.tets.refs.truncate(mesh.tets.nodes.len());
    (mesh.triangles, mesh.edges) = Default::default();
    mesh
}

fn bent(p: Vec3) -> Vec3 {
    [p[0], p[1] + 0.05 * p[0] * (1.0 - p[0]), 0.9 * p[2] + 0.1 * p[0] * p[2]]
}

#[test]
fn between_cubes() {
    assert!(Case::new(cube(6), at(cube(5), bent)).check() > 0);
}

#[test]
fn where_all_vertices_are_on_faces() {
    // The same mesh, and one with vertices in the middle of edges.
    assert_eq!(Case::new(cube(5), cube(5)).check() + Case::new(cube(3), cube(6)).check(), 0);
    let layers = |p: Vec3| [0.8 * p[0] - 0.6 * p[1], 0.6 * p[0] + 0.8 * p[1] + 3e-6 * p[2] * p[2], 1e-4 * p[2]];
    Case::new(at(cube(4), layers), at(cube(8), layers)).check();
}

#[test]
fn far_outside() {
    let hollow = || without(5, |p| p.iter().all(|&x| (0.2..0.8).contains(&x)));
    let larger = |p: Vec3| p.map(|x| 1.8 * x - 0.4);
    assert!(Case::new(hollow(), at(cube(6), larger)).check() > 100);
    assert!(Case::new(at(hollow(), larger), at(cube(6), larger)).check() > 10);
    // Nothing of the old mesh is near.
    let beyond = |p: Vec3| [p[0] + 9.0, 0.1 * p[1], 0.3 * p[2] - 2.0];
    assert_eq!(Case::new(cube(4), at(cube(3), beyond)).check(), 64);
}

#[test]
fn where_parts_meet_at_edges_alone() {
    let board = without(6, |p| p.iter().filter(|&&x| x < 0.5).count() % 2 == 1);
    assert!(Case::new(board, cube(8)).check() > 0);
}

#[test]
fn where_one_mesh_is_much_finer_than_the_other() {
    let graded = |p: Vec3| p.map(|x| x * x * x);
    Case::new(at(cube(9), graded), cube(3)).check();
    Case::new(cube(3), at(cube(9), graded)).check();
}

#[test]
fn inverted_and_empty_meshes_are_refused() {
    let mut wrong = cube(3);
    wrong.tets.nodes[7].swap(0, 1);
    let flat = at(cube(2), |p| [p[0], p[1], 0.0]);
    for (old, new, words) in [
        (wrong.clone(), cube(2), "tetrahedron 8 of the old mesh is inverted"),
        (cube(2), wrong, "tetrahedron 8 of the new mesh is inverted"),
        (cube(2), flat, "the new mesh has no volume"),
    ] {
        let case = Case::new(old, new);
        let readers = ["old.meshb", "new.meshb"].map(|name| MeshReader::open(&case.path(name)).unwrap());
        let fields = crate::mesh::io::slices::SolutionReader::open(&case.path("old.solb")).unwrap();
        let scratch = Scratch::within(case.folder.path());
        let asked = (&Linear(&fields), Keep::Mean);
        let refused = conservative(Team::alone(), readers.each_ref(), asked, (&SIZES[0], &scratch));
        let said = refused.map(drop).unwrap_err().to_string();
        assert!(said.contains(words), "{said}");
    }
}

#[test]
fn too_little_memory_is_told() {
    let counts = crate::mesh::io::MeshCounts::of(&cube(2));
    let said = Sizes::of(50_000_000, 2, 3, [&counts; 2]).unwrap_err().to_string();
    assert!(said.contains("50 MB") && said.contains("give --memory") && said.contains("fewer --threads"), "{said}");
    let asked: u64 = said.split("--memory ").nth(1).unwrap().split("MB").next().unwrap().parse().unwrap();
    assert!(Sizes::of(asked * 1_000_000, 2, 3, [&counts; 2]).is_ok());
    assert!(Sizes::of((asked - 2) * 1_000_000, 2, 3, [&counts; 2]).is_err());
    let many = crate::mesh::io::MeshCounts { tets: u32::MAX as usize, ..counts };
    let said = Sizes::of(1 << 40, 2, 3, [&counts, &many]).unwrap_err().to_string();
    assert!(said.contains("the new mesh has 4294967295 tetrahedra"), "{said}");
}
