//! From its files a mesh gets the metric that it gets in memory, to the bit, however small the pieces.
use super::*;
use crate::mesh::TetMesh;
use crate::mesh::io::{FieldKind, Solution, SolutionField, write_mesh, write_solution};
use crate::mesh::samples::{cube, shuffled};
use crate::mesh::vector::Vec3;
use crate::metric::multiscale::{self, Options as InMemory};
use crate::metric::recovery::Recovery;
use crate::tasks::{Plan, Pool};

/// From one vertex a range and a task to all at once.
const SIZES: [Sizes; 3] = [
    Sizes { slice: 64, block: 16, range: 1, vertices: 100, task: 1 },
    Sizes { slice: 256, block: 64, range: 60_000, vertices: 300, task: 100_000 },
    Sizes { slice: 1 << 15, block: 1 << 10, range: 1 << 30, vertices: 1 << 14, task: 1 << 30 },
];

/// Fronts across each other, one of them steep, and something everywhere.
fn front([x, y, z]: Vec3, step: f64) -> [f64; 2] {
    [(30.0 * (x + 0.25 * y - 0.5 - 0.1 * step)).tanh() + 0.2 * (y - z) * (y - z), (8.0 * (z - 0.3 - step)).tanh() * x]
}

/// A mesh with fields at two steps in files, each of two scalars behind a vector.
struct Case {
    folder: tempfile::TempDir,
    mesh: TetMesh,
    values: [[Vec<f64>; 2]; 2],
}

impl Case {
    fn new(mesh: TetMesh) -> Self {
        let folder = tempfile::tempdir().unwrap();
        write_mesh(&folder.path().join("a.meshb"), &mesh).unwrap();
        let values = [0, 1].map(|step| {
            [0, 1].map(|which| mesh.vertices.iter().map(|&p| front(p, f64::from(step))[which]).collect::<Vec<f64>>())
        });
        for (step, scalars) in values.iter().enumerate() {
            let vector = SolutionField { kind: FieldKind::Vector, values: mesh.vertices.as_flattened().to_vec() };
            let field = |values: &Vec<f64>| SolutionField { kind: FieldKind::Scalar, values: values.clone() };
            let fields = vec![vector, field(&scalars[0]), field(&scalars[1])];
            let path = folder.path().join(format!("{step}.solb"));
            write_solution(&path, &Solution { vertices: mesh.vertices.len(), fields }).unwrap();
        }
        Self { folder, mesh, values }
    }

    /// The metrics of the first scalar, and of both scalars at both steps.
    fn sensors<T>(&self, of: impl Fn(usize, usize) -> T) -> [Vec<Vec<T>>; 2] {
        [vec![vec![of(0, 0)]], vec![vec![of(0, 0), of(1, 0)], vec![of(0, 1), of(1, 1)]]]
    }

    /// Makes metrics by these options in memory and from files, by pieces of these sizes, on one thread and on several. Returns how many
    /// vertices took the Hessian of others.
    fn is_met(&self, options: &Options, sizes: &[Sizes]) -> usize {
        let path = |name: &str| self.folder.path().join(name);
        let reader = MeshReader::open(&path("a.meshb")).unwrap();
        let files = ["0.solb", "1.solb"].map(|name| SolutionReader::open(&path(name)).unwrap());
        let (pool, scratch) = (Pool::new(3).unwrap(), Scratch::within(self.folder.path()));
        let Options { norm, complexity, gradation, limits } = *options;
        let bounds =
            Bounds { complexity, measure: Measure::AtVertices, gradation, limits, fixed: None, by_others: None };
        let in_memory = InMemory { recovery: Recovery::Fit, norm, bounds };
        let all = self.sensors(|step, which| self.values[step][which].as_slice());
        let steps = self.sensors(|step, which| Step { file: &files[step], component: 3 + which });
        let mut unfitted = 0;
        for (sensors, steps) in all.iter().zip(&steps) {
            let (logs, summary) = multiscale::multiscale(Team::alone(), &self.mesh, sensors, &in_memory).unwrap();
            let figures = summary::Summary::of(Team::alone(), &self.mesh, &logs);
            unfitted = unfitted.max(summary.unfitted);
            for sizes in sizes {
                for team in [Team::alone(), Team::new(&pool, Plan::default())] {
                    let (metric, done) = multiscale(team, &reader, steps, options, (sizes, &scratch)).unwrap();
                    assert_eq!(done, summary, "{sizes:?}");
                    assert!(metric.logs.read(0..logs.len()).unwrap() == logs, "{sizes:?}");
                    assert_eq!(metric.summary().unwrap(), figures);
                }
            }
        }
        unfitted
    }

    /// The error of a metric of the first scalar.
    fn error(&self) -> Error {
        let path = |name: &str| self.folder.path().join(name);
        let reader = MeshReader::open(&path("a.meshb")).unwrap();
        let file = SolutionReader::open(&path("0.solb")).unwrap();
        let (sensors, scratch) = ([vec![Step { file: &file, component: 3 }]], Scratch::within(self.folder.path()));
        let made = multiscale(Team::alone(), &reader, &sensors, &usual(), (&SIZES[1], &scratch));
        made.err().expect("it should be refused")
    }
}

fn usual() -> Options {
    Options { norm: Norm::default(), complexity: 500.0, gradation: Some(1.5), limits: Limits::default() }
}

/// A cube whose inner vertices are moved a little.
fn moved(n: u32) -> TetMesh {
    let mut mesh = cube(n);
    for p in &mut mesh.vertices {
        let [x, y, z] = *p;
        let bump = (x - x * x) * (y - y * y) * (z - z * z) * (90.0 * (x + 2.0 * y + 3.0 * z)).sin() / f64::from(n);
        *p = [x + 9.0 * bump, y - 7.0 * bump, z + 3.0 * bump];
    }
    mesh
}

/// Adds tetrahedra one after the other, each with a new vertex over a face of the last.
fn with_whisker(mut mesh: TetMesh) -> TetMesh {
    let [_, mut b, mut c, mut d] = *mesh.tets.nodes.last().unwrap();
    for step in 0..9 {
        let new = mesh.vertices.len() as u32;
        mesh.vertices.push([1.5, 1.5 + 0.1 * f64::from(step % 3), 1.0 + 0.2 * f64::from(step)]);
        mesh.vertex_refs.push(0);
        mesh.tets.push([b, c, d, new], 1);
        (b, c, d) = (c, d, new);
    }
    mesh
}

#[test]
fn the_metric_is_that_in_memory() {
    let limits = Limits { hmin: Some(0.02), hmax: Some(0.4), aspect_ratio: Some(6.0) };
    let case = Case::new(moved(9));
    case.is_met(&usual(), &SIZES);
    case.is_met(&Options { gradation: None, norm: Norm::MOST, ..usual() }, &SIZES[1..2]);
    case.is_met(&Options { gradation: Some(1.1), complexity: 3000.0, ..usual() }, &SIZES[1..2]);
    case.is_met(&Options { limits, ..usual() }, &SIZES[1..]);
}

#[test]
fn vertices_may_be_in_any_order_and_may_not_determine_a_hessian() {
    Case::new(shuffled(&moved(7))).is_met(&usual(), &SIZES);
    let mut mesh = with_whisker(moved(6));
    // One that no tetrahedron has.
    mesh.vertices.push([5.0; 3]);
    mesh.vertex_refs.push(0);
    let case = Case::new(mesh);
    assert!(case.is_met(&usual(), &SIZES) > 1, "the whisker has no fits");
}

/// More vertices than a slice, so that there are several of all that is read at once.
#[test]
fn slices_join() {
    Case::new(moved(26)).is_met(&Options { complexity: 20_000.0, ..usual() }, &SIZES[2..]);
}

#[test]
fn what_has_no_metric_is_told() {
    // A tetrahedron far from all others.
    let mut mesh = moved(5);
    let first = mesh.vertices.len() as u32;
    mesh.vertices.extend([[3.0, 0.0, 0.0], [4.0, 0.0, 0.0], [3.0, 1.0, 0.0], [3.0, 0.0, 1.0]]);
    mesh.vertex_refs.extend([0; 4]);
    mesh.tets.push([first, first + 1, first + 2, first + 3], 1);
    let error = Case::new(mesh).error();
    assert!(matches!(error, Error::TooFew { vertex } if vertex == first), "{error}");
    let mut flat = moved(5);
    flat.vertices.iter_mut().for_each(|p| *p = p.map(|x| 1e-9 * x));
    let error = Case::new(flat).error();
    assert!(matches!(error, Error::Multiscale(multiscale::Error::Flat { sensor: 0 })), "{error}");
}

#[test]
fn too_little_memory_is_told_with_what_would_do() {
    let counts = crate::mesh::io::MeshCounts { vertices: 10_000_000, tets: 56_000_000, ..Default::default() };
    let Err(Error::Memory { needed, .. }) = Sizes::of(100_000_000, 2, true, &counts) else { panic!("it does not fit") };
    assert!((400_000_000..500_000_000).contains(&needed), "{needed}");
    assert!(
        Sizes::of(needed as u64, 2, true, &counts).is_ok() && Sizes::of(needed as u64 - 1, 2, true, &counts).is_err()
    );
    assert!(Sizes::of(200_000_000, 2, false, &counts).is_ok());
}
