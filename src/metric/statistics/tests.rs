use super::*;
use crate::mesh::adjacency::unique_edges;
use crate::mesh::samples::cube;
use std::collections::BTreeSet;

#[test]
fn classes_and_bounds() {
    let d = Distribution::of(&[0.5, 1.0, 1.5, -2.0, 9.0], &[0.0, 1.0, 2.0, f64::INFINITY], false);
    // −2 counts in the first class.
    assert_eq!(d.classes.iter().map(|class| class.count).collect::<Vec<_>>(), [2, 2, 1]);
    assert_eq!((d.count, d.min, d.max, d.mean, d.argmin), (5, -2.0, 9.0, 2.0, 3));
    assert_eq!((d.classes[2].low, d.classes[2].high), (Some(2.0), None));
    let d = Distribution::of(&[0.5, 1.0, 1.5], &[0.0, 1.0, 2.0], true);
    assert_eq!(d.classes.iter().map(|class| class.count).collect::<Vec<_>>(), [2, 1]);
    assert_eq!(Distribution::of(&[], &[0.0, 1.0], true).count, 0);
}

#[test]
fn figures_of_a_cube() {
    let n = 4;
    let mesh = cube(n);
    // Sizes 1/n: edges of length 1, √2 (face diagonals; in the class above by rounding or not) and √3.
    let metrics = vec![Sym3::IDENTITY.times(f64::from(n * n) * 0.99); mesh.vertices.len()];
    let statistics = Statistics::in_metric(Team::alone(), &mesh, &metrics);
    let figures = statistics.metric.clone().unwrap();
    assert!((figures.complexity - (f64::from(n) * 0.99f64.sqrt()).powi(3)).abs() < 1e-9);
    assert!((figures.vertices_per_complexity * figures.complexity - 125.0).abs() < 1e-9);
    let (axis, face, body) = (3 * 4 * 25, 3 * 16 * 5, 64);
    let share = f64::from(axis + face) / f64::from(axis + face + body);
    assert!((figures.unit_edges - share).abs() < 1e-12, "{figures:?}");
    assert!((statistics.volume - 1.0).abs() < 1e-12);
    assert_eq!(statistics.patches, (1..=6).map(|side| (side, 32)).collect());
    assert_eq!((statistics.regions[&1], statistics.tets), (384, 384));
    // All tetrahedra are alike.
    let ratios = &statistics.mean_ratios;
    assert!((ratios.min - ratios.max).abs() < 1e-12 && (ratios.min - ratios.mean).abs() < 1e-12);
    let alone = Statistics::in_space(Team::alone(), &mesh);
    assert!((alone.mean_ratios.mean - ratios.mean).abs() < 1e-12 && alone.metric.is_none());
    assert!((alone.edge_lengths.min - 0.25).abs() < 1e-15 && alone.edge_lengths.classes.is_empty());
}

/// A cube in parts, each with copies of its vertices: the tetrahedra dealt out by `of`, edges and vertices counted where they come first.
fn parts(mesh: &TetMesh, metrics: &[Sym3], count: usize, of: impl Fn(usize) -> usize) -> Vec<Figures> {
    let (mut seen, mut known) = (BTreeSet::new(), BTreeSet::new());
    let of_part = |part: usize| {
        let mut local = BTreeMap::new();
        let (mut tets, mut global) = (Elements::default(), Vec::new());
        for (_, (nodes, reference)) in mesh.tets.iter().enumerate().filter(|(t, _)| of(*t) == part) {
            let place = |v| {
                *local.entry(v).or_insert_with(|| {
                    global.push(v);
                    global.len() as u32 - 1
                })
            };
            tets.push(nodes.map(place), reference);
        }
        let name = |[a, b]: [u32; 2]| {
            let [a, b] = [global[a as usize], global[b as usize]];
            [a.min(b), a.max(b)]
        };
        let own: BTreeSet<[u32; 2]> = unique_edges(&tets.nodes).into_iter().map(name).collect();
        let own: BTreeSet<_> = own.into_iter().filter(|edge| seen.insert(*edge)).collect();
        let vertices: Vec<_> = global.iter().map(|&v| mesh.vertices[v as usize]).collect();
        let metrics: Vec<_> = global.iter().map(|&v| metrics[v as usize]).collect();
        let own_vertices = global.iter().filter(|&&v| known.insert(v)).count();
        let mut triangles = mesh.triangles.clone();
        if part > 0 {
            triangles = Elements::default();
        }
        let part =
            Part { vertices: &vertices, own_vertices, tets: &tets, triangles: &triangles, edges: &Elements::default() };
        Figures::in_metric(Team::alone(), part, &metrics, |edge| own.contains(&name(edge)))
    };
    (0..count).map(of_part).collect()
}

#[test]
fn parts_have_the_figures_of_the_whole() {
    let mesh = cube(5);
    let size = |x: &Vec3| Sym3::diagonal(20.0 + 9.0 * x[0], 10.0 + 30.0 * x[1] * x[2], 40.0);
    let metrics: Vec<_> = mesh.vertices.iter().map(size).collect();
    let whole = Statistics::in_metric(Team::alone(), &mesh, &metrics);
    let near = |a: f64, b: f64| (a - b).abs() < 1e-12 * b.abs();
    let n = mesh.tets.len();
    for count in [1, 2, 7] {
        for dealt in [|t: usize, n: usize, count: usize| t * count / n, |t, _, count| t % count] {
            let figures = parts(&mesh, &metrics, count, |t| dealt(t, n, count));
            let found = figures.into_iter().reduce(Figures::and).unwrap().statistics();
            assert_eq!((found.vertices, found.tets, found.triangles), (whole.vertices, n, whole.triangles));
            assert_eq!((&found.regions, &found.patches), (&whole.regions, &whole.patches));
            for (found, whole) in [(&found.edge_lengths, &whole.edge_lengths), (&found.mean_ratios, &whole.mean_ratios)]
            {
                assert_eq!((found.count, &found.classes), (whole.count, &whole.classes));
                assert!(near(found.min, whole.min) && near(found.max, whole.max) && near(found.mean, whole.mean));
            }
            let (found_metric, metric) = (found.metric.unwrap(), whole.metric.as_ref().unwrap());
            assert!(near(found.volume, whole.volume) && near(found_metric.complexity, metric.complexity));
            assert!(near(found_metric.vertices_per_complexity, metric.vertices_per_complexity));
            assert_eq!(found_metric.unit_edges, metric.unit_edges);
        }
    }
}

/// The place of the least value counts through the parts.
#[test]
fn the_worst_tetrahedron_is_found_in_a_later_part() {
    let mut mesh = cube(2);
    mesh.vertices[0] = [0.3, 0.2, 0.2];
    let metrics = vec![Sym3::IDENTITY; mesh.vertices.len()];
    let whole = Statistics::in_metric(Team::alone(), &mesh, &metrics).mean_ratios;
    // In order, but the part of the worst one is not the first.
    let first = whole.argmin.max(1);
    let figures = parts(&mesh, &metrics, 2, |t| usize::from(t >= first));
    let found = figures.into_iter().reduce(Figures::and).unwrap().statistics().mean_ratios;
    assert_eq!((found.argmin, found.min), (whole.argmin, whole.min));
}
