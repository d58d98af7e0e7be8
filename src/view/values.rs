//! Numbers to colour by: qualities of elements, fields at vertices.
use crate::mesh::io::FieldKind;
use crate::mesh::vector::{area2, dot, norm, scale, sub};
use crate::mesh::{Elements, TetMesh};
use crate::metric::{Sym3, mean_ratios};
use crate::tasks::{GRAIN, Team};

/// A number at each vertex.
pub struct ScalarField {
    /// What it is.
    pub name: String,
    /// The values, shape (vertices,); NaN where there is none.
    pub values: Vec<f32>,
    /// Least and greatest.
    pub range: [f32; 2],
    /// Whether it is better seen by its logarithm.
    pub logarithmic: bool,
}

impl ScalarField {
    /// Values spread over so many times the least are shown by their logarithm.
    const WIDE: f32 = 1e3;

    /// Of values.
    pub fn new(team: Team<'_>, name: String, values: Vec<f32>) -> Self {
        let parts = team.chunks(GRAIN, values.len(), |range| {
            values[range]
                .iter()
                .filter(|x| x.is_finite())
                .fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], &x| [low.min(x), high.max(x)])
        });
        let all = |[low, high]: [f32; 2], part: [f32; 2]| [low.min(part[0]), high.max(part[1])];
        let range = parts.into_iter().fold([f32::INFINITY, f32::NEG_INFINITY], all);
        let range = if range[0] <= range[1] { range } else { [0.0, 0.0] };
        Self { name, values, range, logarithmic: range[0] > 0.0 && range[1] > Self::WIDE * range[0] }
    }

    /// A field of such a kind, shape (vertices, values of the kind): scalars as they are, lengths of vectors, Frobenius norms of tensors.
    pub fn of_values(team: Team<'_>, name: &str, kind: FieldKind, values: &[f64]) -> Self {
        let width = kind.values();
        let lengths = team.map(GRAIN, values.len() / width, |v| {
            let length = match (kind, &values[v * width..][..width]) {
                (FieldKind::Scalar, row) => row[0],
                // Off the diagonal each stands for two.
                (FieldKind::SymmetricTensor, &[xx, xy, yy, xz, yz, zz]) => {
                    (xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + xz * xz + yz * yz)).sqrt()
                }
                (_, row) => row.iter().map(|x| x * x).sum::<f64>().sqrt(),
            };
            length as f32
        });
        let name = if kind == FieldKind::Scalar { name.to_owned() } else { format!("|{name}|") };
        Self::new(team, name, lengths)
    }

    /// What a metric asks for: the mean size det(M)^(−1/6), and the ratio of the greatest size to the least.
    pub fn of_metric(team: Team<'_>, logs: &[Sym3]) -> [Self; 2] {
        let sizes = team.map(GRAIN, logs.len(), |v| (-logs[v].trace() / 6.0).exp() as f32);
        let ratios = team.map(GRAIN, logs.len(), |v| {
            let values = logs[v].eigen().values;
            let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| (l.min(x), h.max(x)));
            (0.5 * (high - low)).exp() as f32
        });
        [Self::new(team, "size".into(), sizes), Self::new(team, "aspect".into(), ratios)]
    }

    /// Where a value lies between the ends, from 0 to 1; NaN where there is none.
    pub fn place(value: f32, [low, high]: [f32; 2], logarithmic: bool) -> f32 {
        let (value, low, high) = if logarithmic {
            let floor = f32::MIN_POSITIVE;
            (value.max(floor).ln(), low.max(floor).ln(), high.max(floor).ln())
        } else {
            (value, low, high)
        };
        if value.is_nan() {
            f32::NAN
        } else if high > low {
            ((value - low) / (high - low)).clamp(0.0, 1.0)
        } else {
            0.5
        }
    }
}

/// Mean ratios of the tetrahedra in the metric of ln M at the vertices, else in space; 0 for those that are not positive.
pub fn of_tets(team: Team<'_>, mesh: &TetMesh, logs: Option<&[Sym3]>) -> Vec<f32> {
    let tets = &mesh.tets.nodes;
    team.collect(GRAIN, tets.len(), |range, found| {
        let corners = |tet: &[u32; 4]| {
            let log = |v: u32| logs.map_or(Sym3::ZERO, |logs| logs[v as usize]);
            (tet.map(|v| mesh.vertices[v as usize]), tet.map(log))
        };
        mean_ratios(tets[range].iter(), corners, |_, ratio| found.push(ratio as f32));
    })
}

/// Mean ratios 4√3 A/Σl² of triangles, in the mean metric of their corners, else in space.
pub fn of_triangles(team: Team<'_>, mesh: &TetMesh, triangles: &Elements<3>, logs: Option<&[Sym3]>) -> Vec<f32> {
    team.map(GRAIN, triangles.len(), |t| {
        let nodes = triangles.nodes[t];
        let [a, b, c] = nodes.map(|v| mesh.vertices[v as usize]);
        let edges = [sub(b, a), sub(c, b), sub(a, c)];
        let ratio = match logs {
            None => 2.0 * 3.0f64.sqrt() * norm(area2(a, b, c)) / edges.iter().map(|&e| dot(e, e)).sum::<f64>(),
            Some(logs) => {
                let sum = nodes.iter().fold(Sym3::ZERO, |sum, &v| sum.plus(logs[v as usize]));
                let root = sum.times(1.0 / 6.0).exp();
                let [e, f, g] = edges.map(|e| root.apply(e));
                let area = norm(area2([0.0; 3], e, scale(g, -1.0)));
                2.0 * 3.0f64.sqrt() * area / (dot(e, e) + dot(f, f) + dot(g, g))
            }
        };
        if ratio.is_finite() { ratio as f32 } else { 0.0 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    #[test]
    fn equilateral_triangles_are_the_best_and_a_metric_changes_which_are() {
        let height = 0.75f64.sqrt();
        let mut mesh = cube(1);
        mesh.vertices[0] = [0.0; 3];
        mesh.vertices[1] = [1.0, 0.0, 0.0];
        mesh.vertices[2] = [0.5, height, 0.0];
        mesh.vertices[3] = [0.5, 0.1 * height, 0.0];
        let triangles = Elements { nodes: vec![[0, 1, 2], [0, 1, 3]], refs: vec![1, 1] };
        let alone = of_triangles(Team::alone(), &mesh, &triangles, None);
        assert!((alone[0] - 1.0).abs() < 1e-6 && alone[1] < 0.3, "{alone:?}");
        let logs = vec![Sym3::diagonal(0.0, 2.0 * 10.0f64.ln(), 0.0); mesh.vertices.len()];
        let flat = of_triangles(Team::alone(), &mesh, &triangles, Some(&logs));
        assert!((flat[1] - 1.0).abs() < 1e-6 && flat[0] < 0.3, "{flat:?}");
    }

    #[test]
    fn fields_of_all_kinds_become_one_number() {
        let tensors = [[0.0, 3.0, 0.0, 0.0, 0.0, 0.0]; 2].concat();
        let found = [
            (FieldKind::Scalar, vec![-2.0, 3.0]),
            (FieldKind::Vector, vec![3.0, 4.0, 0.0, 0.0, 0.0, 1.0]),
            (FieldKind::SymmetricTensor, tensors),
        ]
        .map(|(kind, values)| ScalarField::of_values(Team::alone(), "u", kind, &values));
        assert_eq!(found.each_ref().map(|f| f.name.as_str()), ["u", "|u|", "|u|"]);
        assert_eq!(found[0].range, [-2.0, 3.0]);
        assert_eq!(found[1].values, [5.0, 1.0]);
        assert!((found[2].values[0] - 18.0f32.sqrt()).abs() < 1e-6);
    }

    #[test]
    fn sizes_of_a_metric() {
        let logs = [Sym3::diagonal(0.0, 0.0, -2.0 * 8.0f64.ln())];
        let [size, aspect] = ScalarField::of_metric(Team::alone(), &logs);
        assert!((size.values[0] - 2.0).abs() < 1e-6 && (aspect.values[0] - 8.0).abs() < 1e-5);
    }

    #[test]
    fn places_between_the_ends() {
        assert_eq!(ScalarField::place(2.0, [1.0, 3.0], false), 0.5);
        assert!((ScalarField::place(10.0, [1.0, 100.0], true) - 0.5).abs() < 1e-6);
        assert!(ScalarField::place(f32::NAN, [0.0, 1.0], false).is_nan());
        assert_eq!(ScalarField::place(7.0, [7.0, 7.0], false), 0.5);
    }
}
