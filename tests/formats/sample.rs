//! A small dataset with everything that formats carry.
use geo_adapt::formats::{self, Dataset, Format, NamedField, Options};
use geo_adapt::geometry::Label;
use geo_adapt::mesh::io::FieldKind;
use geo_adapt::mesh::samples::cube;
use geo_adapt::mesh::{Elements, TetMesh};
use geo_adapt::tasks::Team;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A field of a kind, with values that need all their digits.
pub fn field(name: &str, kind: FieldKind, vertices: usize) -> NamedField {
    let value = |index: usize| (index as f64 + 0.1).sin() * 10_f64.powi(index as i32 % 40 - 20);
    NamedField { name: name.into(), kind, values: (0..vertices * kind.values()).map(value).collect() }
}

/// Labels with names.
pub fn labels(names: &[(i32, &str)]) -> BTreeMap<i32, Label> {
    names.iter().map(|&(reference, name)| (reference, Label { name: Some(name.into()), colour: None })).collect()
}

/// A cube of two regions with names for its boundaries, edges and regions, and a field of each kind.
pub fn dataset() -> Dataset {
    of_cube(2)
}

fn of_cube(n: u32) -> Dataset {
    let mut mesh = cube(n);
    for (x, point) in mesh.vertices.iter_mut().enumerate() {
        point.iter_mut().for_each(|p| *p = *p / 3.0 + 1e-9 * x as f64);
    }
    mesh.tets.refs.iter_mut().skip(5).for_each(|region| *region = 4);
    for reference in &mut mesh.triangles.refs {
        *reference = [0, 11, 3, 7, 8, 21, 6][*reference as usize];
    }
    for (reference, nodes) in [(5, [0, 1]), (5, [1, 2]), (9, [2, 5])] {
        mesh.edges.push(nodes, reference);
    }
    let vertices = mesh.vertices.len();
    let mut data = Dataset { mesh, ..Dataset::default() };
    data.names.triangles = labels(&[(3, "wing"), (7, "far-field"), (21, "symmetry"), (11, "42")]);
    data.names.edges = labels(&[(5, "leading edge")]);
    data.names.tetrahedra = labels(&[(4, "fluid"), (1, "solid & <more>")]);
    data.fields = vec![
        field("Mach", FieldKind::Scalar, vertices),
        field("Momentum", FieldKind::Vector, vertices),
        field("Reynolds Stress", FieldKind::SymmetricTensor, vertices),
        field("grad u", FieldKind::Tensor, vertices),
    ];
    data
}

/// Triangles alone.
pub fn surface() -> Dataset {
    let mut data = of_cube(1);
    data.mesh.tets = Elements::default();
    data.names.tetrahedra.clear();
    data.fields.truncate(2);
    data
}

/// The mesh with elements in the order of their references: formats that group them keep no other.
pub fn sorted(mut mesh: TetMesh) -> TetMesh {
    fn sort<const N: usize>(elements: &mut Elements<N>) {
        let mut all: Vec<_> = elements.iter().collect();
        all.sort_by_key(|&(_, reference)| reference);
        *elements = Elements::default();
        all.into_iter().for_each(|(nodes, reference)| elements.push(nodes, reference));
    }
    sort(&mut mesh.tets);
    sort(&mut mesh.triangles);
    sort(&mut mesh.edges);
    mesh
}

/// A folder for files.
pub struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    /// Empty.
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    /// A file in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a dataset.
    pub fn write(&self, name: &str, data: &Dataset, text: bool) -> (PathBuf, Vec<String>) {
        let path = self.path(name);
        let notices = formats::write_on(Team::alone(), &path, data, Options { text }).unwrap();
        (path, notices)
    }

    /// Writes a text.
    pub fn text(&self, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, text).unwrap();
        path
    }
}

/// Reads a dataset.
pub fn read(path: &Path) -> Dataset {
    formats::read(path).unwrap().content
}

/// The error of reading bytes as a file of such a name, without that name.
pub fn refusal(name: &str, bytes: impl AsRef<[u8]>) -> String {
    let path = Path::new(name);
    let error =
        formats::read_bytes(Format::of(path).unwrap(), path, bytes.as_ref()).expect_err("the file should be refused");
    let text = error.to_string();
    text.strip_prefix(&format!("{name}: ")).unwrap_or_else(|| panic!("{text} does not name the file")).to_owned()
}

/// The mean of the values of two cells at a vertex, with the squares of the distances of their centroids.
pub fn by_distance([(a, far_a), (b, far_b)]: [(f64, f64); 2]) -> f64 {
    let (from_a, from_b) = (far_a.sqrt().recip(), far_b.sqrt().recip());
    (a * from_a + b * from_b) / (from_a + from_b)
}

/// Whether these are the values at the vertices (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, -2) of two cells with 1 above and 4 below;
/// `carried`: with a boundary triangle between them, to whose vertices the values of the cells are carried on.
pub fn is_of_both(values: &[f64], carried: bool) -> bool {
    let corner = |above, below| by_distance([(above, 0.1875), (below, 0.375)]);
    let side = |above, below| by_distance([(above, 0.6875), (below, 0.875)]);
    let mut at = [corner(1.0, 4.0), side(1.0, 4.0), side(1.0, 4.0), 1.0, 4.0];
    for _ in 0..if carried { 2 } else { 0 } {
        let base = at[0] + at[1] + at[2];
        let left = [1.0 - 0.25 * (base + at[3]), 4.0 - 0.25 * (base + at[4])];
        at[0] += corner(left[0], left[1]);
        at[1] += side(left[0], left[1]);
        at[2] = at[1];
    }
    values.len() == 5 && values.iter().zip(at).all(|(a, b)| (a - b).abs() < 1e-14)
}
