use super::*;
use crate::mesh::samples::cube;

fn write(name: &str, kind: FieldKind, values: Vec<f64>) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    let per_vertex = if kind == FieldKind::Scalar { 1 } else { 6 };
    let solution = Solution { vertices: values.len() / per_vertex, fields: vec![SolutionField { kind, values }] };
    io::write_solution(&path, &solution).unwrap();
    (folder, path)
}

#[test]
fn complexity_of_a_constant_metric() {
    let mesh = cube(3);
    let mut metrics = vec![Sym3::diagonal(4.0, 9.0, 25.0); mesh.vertices.len()];
    assert!((complexity(Team::alone(), &mesh, &metrics) - 30.0).abs() < 1e-12);
    let logs: Vec<Sym3> = metrics.iter().map(Sym3::ln).collect();
    assert!((complexity_of_logs(Team::alone(), &mesh, &logs) - 30.0).abs() < 1e-12);
    let factor = scale_to_complexity(Team::alone(), &mesh, &mut metrics, 240.0);
    assert!((factor - 4.0).abs() < 1e-12);
    assert!((complexity(Team::alone(), &mesh, &metrics) - 240.0).abs() < 1e-10);
}

#[test]
fn the_integral_between_vertices_is_exact() {
    let mesh = cube(1);
    // √det M = e^(x/5 + y), whose integral is the product of two; sizes differ by less than a factor of 2.
    let log = |p: [f64; 3]| Sym3::diagonal(1.0, 1.0, 0.0).times(0.2 * p[0] + p[1]);
    let logs: Vec<Sym3> = mesh.vertices.iter().map(|&p| log(p)).collect();
    let exact = (0.2f64.exp() - 1.0) / 0.2 * (1f64.exp() - 1.0);
    let found = complexity_between(Team::alone(), &mesh, &logs);
    assert!((found / exact - 1.0).abs() < 1e-13, "{found} {exact}");
    assert!(complexity_of_logs(Team::alone(), &mesh, &logs) > 1.05 * exact, "the sum over the vertices is off here");
    // Sizes that differ by 1e12: finite, and below the greatest value.
    let steep = mean_exponential([0.0, -3.0, 27.0, 82.9]);
    assert!(steep > 0.0 && steep < 82.9f64.exp(), "{steep}");
    assert_eq!(mean_exponential([0.0; 4]), 1.0);
}

/// Sizes grow with the distance between vertices that are far apart, by the mean over 1.06 at most.
#[test]
fn a_coarse_mesh_has_the_complexity_of_sizes_that_grow_in_proportion() {
    let mesh = cube(1);
    let found = |log: &dyn Fn(f64) -> Sym3, axis: usize| {
        let logs: Vec<Sym3> = mesh.vertices.iter().map(|p| log(p[axis])).collect();
        complexity_between(Team::alone(), &mesh, &logs)
    };
    for first in [1e-1, 1e-3, 1e-6] {
        // h = first + x: ∫ h⁻³ = (first⁻² − (1 + first)⁻²)/2.
        let exact = 0.5 * (f64::powi(first, -2) - f64::powi(1.0 + first, -2));
        let share = found(&|x| Sym3::ZERO.plus_identity(-2.0 * (first + x).ln()), 0) / exact;
        assert!((0.99..1.2).contains(&share), "{first}: {share}");
        // A layer, turned; its size across is the least everywhere.
        let directions = [[0.8, 0.6, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.0, 1.0]];
        let exact = ((1.0 + first) / first).ln() / 6.0;
        let share = found(&|z| Sym3::from_sizes(directions, [3.0, 2.0, first + z]).ln(), 2) / exact;
        assert!((0.99..1.07).contains(&share), "{first}: {share}");
    }
}

#[test]
fn what_was_written_is_read() {
    let field = Field { metrics: vec![Sym3([4.0, 0.5, 9.0, 0.25, -1.0, 25.0]), Sym3::IDENTITY] };
    let folder = tempfile::tempdir().unwrap();
    for name in ["m.sol", "m.solb"] {
        let path = folder.path().join(name);
        field.write(&path).unwrap();
        assert_eq!(Field::read(&path, 2).unwrap().content, field);
    }
}

#[test]
fn scalars_are_isotropic_sizes() {
    let (_folder, path) = write("sizes.sol", FieldKind::Scalar, vec![0.5, 2.0]);
    let Read { content, notices } = Field::read(&path, 2).unwrap();
    assert_eq!(content.metrics, [Sym3::diagonal(4.0, 4.0, 4.0), Sym3::diagonal(0.25, 0.25, 0.25)]);
    assert!(notices[0].contains("isotropic sizes, from 0.5000 to 2.0000"), "{notices:?}");
    let logs = Field::read_logs(Team::alone(), &path, 2).unwrap().content;
    for (log, h) in logs.iter().zip([0.5, 2.0]) {
        assert!(log.sizes_of_log().iter().all(|size| (size / h - 1.0).abs() < 1e-14), "{log:?}");
    }
}

#[test]
fn errors_name_file_vertex_and_remedy() {
    for wrong in [0.0, -2.0, 1e200] {
        let (_folder, path) = write("scalar.solb", FieldKind::Scalar, vec![1.0, wrong]);
        let message = Field::read(&path, 2).unwrap_err().to_string();
        assert!(message.contains("scalar.solb: the size of vertex 2 is ") && message.contains("--field"), "{message}");
    }

    let values = [[1.0, 0.0, 1.0, 0.0, 0.0, 1.0], [1.0, 2.0, 1.0, 0.0, 0.0, 1.0]].concat();
    let (_folder, path) = write("indefinite.solb", FieldKind::SymmetricTensor, values);
    let message = Field::read(&path, 2).unwrap_err().to_string();
    assert!(message.contains("indefinite.solb: metric of vertex 2 is not positive definite"), "{message}");
    assert!(message.contains("(eigenvalues -1.000e0, 1.000e0, 3.000e0)"), "{message}");

    let message = Field::read(&path, 5).unwrap_err().to_string();
    assert!(message.contains("metric at 2 vertices, but the mesh has 5"), "{message}");
}
