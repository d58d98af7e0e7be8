//! Grading does what the formula says, once, alike on any number of threads.
use super::*;
use crate::mesh::samples::cube;
use crate::mesh::vector::{distance, norm, sub};
use crate::tasks::{Plan, Pool};
use proptest::prelude::*;

const RATIO: f64 = 1.5;

fn sizes(logs: &[Sym3]) -> Vec<[f64; 3]> {
    logs.iter().map(|log| log.eigen().values.map(|x| (-0.5 * x).exp())).collect()
}

/// The greatest share by which a metric exceeds what its neighbours allow, straight from the formula.
fn excess(mesh: &TetMesh, logs: &[Sym3], ratio: f64) -> f64 {
    let around = VertexNeighbours::of(Team::alone(), &mesh.tets.nodes, mesh.vertices.len());
    let mut greatest = f64::NEG_INFINITY;
    for p in 0..logs.len() as u32 {
        let m = logs[p as usize].exp();
        let eigen = logs[p as usize].eigen();
        for &q in around.of_vertex(p) {
            let e = sub(mesh.vertices[q as usize], mesh.vertices[p as usize]);
            let length = m.quadratic(e).sqrt();
            let values = eigen.values.map(|x| {
                let lambda = x.exp();
                let own = 1.0 + lambda.sqrt() * norm(e) * ratio.ln();
                lambda * (own.powf(0.125) * (1.0 + length * ratio.ln()).powf(0.875)).powi(-2)
            });
            let grown = Sym3::from_eigen(&super::super::Eigen { values, ..eigen });
            let relative = grown.congruent(&logs[q as usize].times(-0.5).exp());
            greatest = greatest.max(relative.eigen().values[2] - 1.0);
        }
    }
    greatest
}

/// A fine spot in a coarse cube.
fn spot(n: u32, at: Vec3, metric: Sym3) -> (TetMesh, Vec<Sym3>) {
    let mesh = cube(n);
    let coarse = Sym3::IDENTITY.ln();
    let nearest = |&p: &Vec3| if distance(p, at) < 1e-9 { metric.ln() } else { coarse };
    let logs = mesh.vertices.iter().map(nearest).collect();
    (mesh, logs)
}

#[test]
fn sizes_grow_from_a_fine_vertex() {
    let (mesh, mut logs) = spot(8, [0.5; 3], Sym3::IDENTITY.times(1e6));
    let before = logs.clone();
    assert!(excess(&mesh, &logs, RATIO) > 100.0);
    let graded = grade(Team::alone(), &mesh, &mut logs, RATIO);
    assert!(graded.changed > 400 && graded.updates >= graded.changed && graded.rounds < 60, "{graded:?}");
    assert!(excess(&mesh, &logs, RATIO) < 2.0 * TOLERANCE);
    // Isotropic growth: h(q) = h(p) + |e| ln r, along the shortest way.
    let at = mesh.vertices.iter().position(|&p| p == [0.5, 0.5, 0.75]).unwrap();
    let exact = 1e-3 + 0.25 * RATIO.ln();
    for h in sizes(&logs)[at] {
        assert!((h / exact - 1.0).abs() < TOLERANCE, "{h} {exact}");
    }
    // Nothing is coarser than before, and what stays does so to the last bit.
    let unchanged = logs.iter().zip(&before).filter(|(a, b)| a == b).count();
    assert_eq!(unchanged + graded.changed, logs.len());
    for (now, before) in sizes(&logs).into_iter().zip(sizes(&before)) {
        assert!((0..3).all(|i| now[i] <= before[i] * (1.0 + 1e-12)));
    }
}

#[test]
fn a_graded_metric_stays_to_the_last_bit() {
    let layer = Sym3::from_sizes([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [-0.8, 0.0, 0.6]], [1.0, 1e-2, 1e-5]);
    let (mesh, mut logs) = spot(6, [0.5; 3], layer);
    grade(Team::alone(), &mesh, &mut logs, RATIO);
    assert!(logs.iter().flat_map(|log| log.0).all(f64::is_finite));
    assert!(excess(&mesh, &logs, RATIO) < 2.0 * TOLERANCE);
    let once = logs.clone();
    assert_eq!(grade(Team::alone(), &mesh, &mut logs, RATIO), Graded::default());
    assert_eq!(logs, once);
    // A slower growth changes it again, a faster one does not.
    assert_eq!(grade(Team::alone(), &mesh, &mut logs, 3.0), Graded::default());
    assert!(grade(Team::alone(), &mesh, &mut logs, 1.2).changed > 0);
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let mesh = cube(9);
    let wave = |p: &Vec3| {
        let s = (7.0 * p[0] + 3.0 * p[1]).sin();
        let (c, d) = ((5.0 * p[2]).cos(), (5.0 * p[2]).sin());
        Sym3::from_sizes([[c, d, 0.0], [-d, c, 0.0], [0.0, 0.0, 1.0]], [10f64.powf(2.0 * s - 2.0), 0.3, 1.0]).ln()
    };
    let field: Vec<Sym3> = mesh.vertices.iter().map(wave).collect();
    let mut alone = field.clone();
    let graded = grade(Team::alone(), &mesh, &mut alone, RATIO);
    assert!(graded.changed > 500);
    for threads in [2, 3, 8] {
        let pool = Pool::new(threads).unwrap();
        let mut logs = field.clone();
        assert_eq!(grade(Team::new(&pool, Plan::default()), &mesh, &mut logs, RATIO), graded);
        assert_eq!(logs, alone, "{threads} threads");
    }
}

#[test]
fn the_growth_that_is_there_is_measured() {
    let (mesh, mut logs) = spot(6, [0.5; 3], Sym3::diagonal(1e4, 1e2, 1e6));
    let fast = measure(Team::alone(), &mesh, &logs);
    assert!(fast.greatest > 10.0 && fast.least == 1.0 && fast.median == 1.0, "{fast:?}");
    grade(Team::alone(), &mesh, &mut logs, RATIO);
    let graded = measure(Team::alone(), &mesh, &logs);
    assert!((graded.greatest / RATIO - 1.0).abs() < 2e-3, "{graded:?}");
    // The ratio that is found is one that leaves all as it is.
    let again = logs.clone();
    assert_eq!(grade(Team::alone(), &mesh, &mut logs, graded.greatest), Graded::default());
    assert_eq!(logs, again);
    assert_eq!(measure(Team::alone(), &mesh, &vec![Sym3::ZERO; logs.len()]).greatest, 1.0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn random_metrics_are_graded_once(
        metrics in prop::collection::vec(super::super::random::spd(13.815_510_557_964_274), 27),
        ratio in 1.1..3.0f64,
    ) {
        let mesh = cube(2);
        let mut logs: Vec<Sym3> = metrics.iter().map(Sym3::ln).collect();
        let before: Vec<f64> = logs.iter().map(Sym3::trace).collect();
        let graded = grade(Team::alone(), &mesh, &mut logs, ratio);
        prop_assert!(graded.rounds < 1000, "{:?}", graded);
        prop_assert!(logs.iter().flat_map(|log| log.0).all(f64::is_finite));
        prop_assert!(logs.iter().zip(before).all(|(log, before)| log.trace() >= before));
        let once = logs.clone();
        prop_assert_eq!(grade(Team::alone(), &mesh, &mut logs, ratio).updates, 0);
        prop_assert_eq!(&logs, &once);
    }
}
