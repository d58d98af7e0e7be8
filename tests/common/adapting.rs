//! Runs of `geo-adapt adapt`, each in a folder of its own, and what every run promises.
use super::program;
use geo_adapt::mesh::io::{FieldKind, Solution, SolutionField};
use geo_adapt::mesh::vector::{Vec3, area2, norm, scale, volume6};
use geo_adapt::mesh::{Elements, TetMesh, io, validity};
use geo_adapt::metric::{Field, Sym3};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The folder of a run.
pub struct Workplace {
    folder: tempfile::TempDir,
}

/// What a run left.
pub struct Adapted {
    pub mesh: TetMesh,
    pub metrics: Vec<Sym3>,
    pub report: Value,
    pub path: PathBuf,
}

impl Workplace {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a mesh as in.meshb.
    pub fn mesh(&self, mesh: &TetMesh) -> PathBuf {
        let path = self.path("in.meshb");
        io::write_mesh(&path, mesh).unwrap();
        path
    }

    /// A model of the folder geometry, and a coarse mesh that `bootstrap` made of it: two segments a radian of curvature, no feature cells.
    pub fn coarse_start(&self, model: &str) -> (String, PathBuf) {
        let model = text(&Path::new(env!("CARGO_MANIFEST_DIR")).join("geometry").join(model));
        let start = self.path("start.meshb");
        let coarse = ["bootstrap", &model, "-o", &text(&start), "--segments", "2", "--feature-cells", "off", "--quiet"];
        let run = program().args(coarse).output().unwrap();
        assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
        (model, start)
    }

    /// Writes a metric for the mesh as size.solb.
    pub fn metric(&self, mesh: &TetMesh, at: impl Fn(Vec3) -> Sym3) -> String {
        let path = self.path("size.solb");
        write_tensors(&path, mesh.vertices.iter().map(|&p| at(p)));
        text(&path)
    }

    /// `geo-adapt adapt input -o out.meshb`, not yet started.
    pub fn command(&self, input: &Path, arguments: &[&str]) -> Command {
        let mut command = program();
        command.arg("adapt").arg(input).arg("-o").arg(self.path("out.meshb")).args(arguments);
        command
    }

    /// A run that must succeed, on one thread if the arguments don't say otherwise; checked for what every run promises.
    pub fn adapt(&self, input: &Path, arguments: &[&str]) -> Adapted {
        let report = text(&self.path("report.json"));
        let mut arguments = [arguments, &["--report", &report]].concat();
        if !arguments.contains(&"--threads") {
            arguments.extend(["--threads", "1"]);
        }
        let run = self.command(input, &arguments).output().unwrap();
        assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
        assert!(!stderr(&run).contains(|c: char| c.is_control() && c != '\n'), "{:?}", stderr(&run));
        self.result()
    }

    /// Reads what a run wrote.
    pub fn result(&self) -> Adapted {
        let path = self.path("out.meshb");
        let read = io::read_mesh(&path).unwrap();
        assert!(read.notices.is_empty(), "{:?}", read.notices);
        let mesh = read.content;
        assert!(validity::check(&mesh).is_valid(), "{:?}", validity::check(&mesh));
        let metric = self.path("out.solb");
        let metrics = Field::read(&metric, mesh.vertices.len()).unwrap().content.metrics;
        let report: Value = serde_json::from_slice(&std::fs::read(self.path("report.json")).unwrap()).unwrap();
        let inspected =
            program().arg("inspect").arg(&path).arg("--json").arg("--metric").arg(&metric).output().unwrap();
        let inspected: Value = serde_json::from_slice(&inspected.stdout).unwrap();
        for (name, value) in report["statistics"].as_object().unwrap() {
            agree(name, value, &inspected[name]);
        }
        Adapted { mesh, metrics, report, path }
    }

    /// A run that must fail on its input: the message, which is one, names nothing internal, and nothing was written.
    pub fn refusal(&self, input: &Path, arguments: &[&str]) -> String {
        let run = self.command(input, arguments).output().unwrap();
        let message = complaint(&run);
        assert!(!self.path("out.meshb").exists() && !self.path("out.solb").exists(), "{message}");
        message
    }
}

/// Writes tensors as they are, metrics or not.
pub fn write_tensors(path: &Path, tensors: impl Iterator<Item = Sym3>) {
    let values: Vec<f64> = tensors.flat_map(|tensor| tensor.0).collect();
    let field = SolutionField { kind: FieldKind::SymmetricTensor, values };
    io::write_solution(path, &Solution { vertices: field.values.len() / 6, fields: vec![field] }).unwrap();
}

/// What a refused run said: exit code 2, nothing on stdout, one error on stderr.
pub fn complaint(run: &Output) -> String {
    let message = stderr(run);
    assert_eq!(run.status.code(), Some(2), "{message}");
    assert!(run.stdout.is_empty() && !message.contains("panicked"), "{message}");
    assert_eq!(message.matches("error: ").count(), 1, "{message}");
    message
}

pub fn stderr(run: &Output) -> String {
    String::from_utf8(run.stderr.clone()).unwrap()
}

pub fn text(path: &Path) -> String {
    path.to_str().unwrap().into()
}

/// Numbers to rounding (the report is made before the files are written), everything else exactly.
fn agree(name: &str, a: &Value, b: &Value) {
    match (a, b) {
        (Value::Number(x), Value::Number(y)) => {
            let (x, y) = (x.as_f64().unwrap(), y.as_f64().unwrap());
            assert!((x - y).abs() <= 1e-12 * x.abs().max(1.0), "{name}: {x} {y}");
        }
        (Value::Object(x), Value::Object(y)) => {
            assert!(x.keys().eq(y.keys()), "{name}");
            x.iter().for_each(|(key, value)| agree(&format!("{name}.{key}"), value, &y[key]));
        }
        (Value::Array(x), Value::Array(y)) => {
            assert_eq!(x.len(), y.len(), "{name}");
            x.iter().zip(y).for_each(|(x, y)| agree(name, x, y));
        }
        _ => assert_eq!(a, b, "{name}"),
    }
}

/// The same size in all directions.
pub fn isotropic(size: f64) -> Sym3 {
    Sym3::IDENTITY.times(1.0 / (size * size))
}

/// The unit cube as n³ cells of six tetrahedra. Triangles on its sides have the references 1 to 6 (x = 0, x = 1, y = 0 …),
/// those between regions 7; `region` is asked at each cell's centre.
pub fn cube(n: u32, region: impl Fn(Vec3) -> i32) -> TetMesh {
    let mut mesh = TetMesh::default();
    let index = |[i, j, k]: [u32; 3]| (i * (n + 1) + j) * (n + 1) + k;
    let side = n + 1;
    for v in 0..side * side * side {
        let cell = [v / (side * side), v / side % side, v % side];
        mesh.vertices.push(cell.map(|x| f64::from(x) / f64::from(n)));
        mesh.vertex_refs.push(0);
    }
    for cell in 0..n * n * n {
        let first = [cell / (n * n), cell / n % n, cell % n];
        let region = region(first.map(|x| (f64::from(x) + 0.5) / f64::from(n)));
        for (order, odd) in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]].into_iter().zip(0..) {
            let mut at = first;
            let mut nodes = [index(at); 4];
            for (node, axis) in nodes[1..].iter_mut().zip(order) {
                at[axis] += 1;
                *node = index(at);
            }
            if odd >= 3 {
                nodes.swap(0, 1);
            }
            mesh.tets.push(nodes, region);
        }
    }
    mesh.triangles = skin(&mesh);
    mesh
}

/// Faces of one tetrahedron, and of two in different regions.
fn skin(mesh: &TetMesh) -> Elements<3> {
    let mut triangles = Elements::default();
    for (key, (nodes, regions)) in faces(mesh) {
        let on = |axis: usize, value: f64| key.iter().all(|&v| mesh.vertices[v as usize][axis] == value);
        match regions[..] {
            [_] => {
                let side = (0..6).find(|&side| on(side / 2, (side % 2) as f64)).unwrap();
                triangles.push(nodes, side as i32 + 1);
            }
            [a, b] if a != b => triangles.push(nodes, 7),
            _ => {}
        }
    }
    triangles
}

/// The faces of the tetrahedra by their sorted nodes: nodes, outward of the first tetrahedron, and regions beside.
pub fn faces(mesh: &TetMesh) -> BTreeMap<[u32; 3], ([u32; 3], Vec<i32>)> {
    let mut faces = BTreeMap::new();
    for ([a, b, c, d], region) in mesh.tets.iter() {
        for nodes in [[b, c, d], [a, d, c], [a, b, d], [a, c, b]] {
            faces.entry(sorted(nodes)).or_insert_with(|| (nodes, Vec::new())).1.push(region);
        }
    }
    faces
}

pub fn sorted<const N: usize>(mut nodes: [u32; N]) -> [u32; N] {
    nodes.sort_unstable();
    nodes
}

/// Volume by region.
pub fn volumes(mesh: &TetMesh) -> BTreeMap<i32, f64> {
    let mut volumes = BTreeMap::new();
    for (nodes, region) in mesh.tets.iter() {
        let [a, b, c, d] = nodes.map(|v| mesh.vertices[v as usize]);
        *volumes.entry(region).or_insert(0.0) += volume6(a, b, c, d) / 6.0;
    }
    volumes
}

/// Area by triangle reference.
pub fn areas(mesh: &TetMesh) -> BTreeMap<i32, f64> {
    let mut areas = BTreeMap::new();
    for (nodes, reference) in mesh.triangles.iter() {
        let [a, b, c] = nodes.map(|v| mesh.vertices[v as usize]);
        *areas.entry(reference).or_insert(0.0) += norm(scale(area2(a, b, c), 0.5));
    }
    areas
}
