//! The multiscale metric of fields whose Hessians are known.
use super::*;
use crate::mesh::samples::cube;
use crate::metric::Eigen;
use crate::tasks::{Plan, Pool};

fn options(complexity: f64) -> Options<'static> {
    Options { recovery: Recovery::Fit, norm: Norm::default(), bounds: bounds(complexity) }
}

fn bounds(complexity: f64) -> Bounds<'static> {
    Bounds {
        complexity,
        measure: Measure::AtVertices,
        gradation: None,
        limits: Limits::default(),
        fixed: None,
        by_others: None,
    }
}

fn values(mesh: &TetMesh, u: impl Fn(Vec3) -> f64) -> Vec<f64> {
    mesh.vertices.iter().map(|&p| u(p)).collect()
}

fn made(mesh: &TetMesh, u: &[f64], options: &Options) -> (Vec<Sym3>, Summary) {
    multiscale(Team::alone(), mesh, &[vec![u]], options).unwrap()
}

#[test]
fn a_quadratic_function_has_one_metric_in_every_norm() {
    let mesh = cube(5);
    let h = Sym3([-3.0, 0.5, 8.0, 1.0, 0.0, 60.0]);
    let u = values(&mesh, |p| 0.5 * h.quadratic(p) + p[1]);
    let eigen = h.eigen();
    let absolute = Sym3::from_eigen(&Eigen { values: eigen.values.map(f64::abs), ..eigen });
    // √det M = C in a cube of volume 1.
    let expected = absolute.times((1e4 / absolute.det()).cbrt()).ln();
    for norm in ["1", "2", "4", "inf"] {
        let (logs, summary) = made(&mesh, &u, &Options { norm: norm.parse().unwrap(), ..options(100.0) });
        for log in &logs {
            assert!((0..6).all(|i| (log.0[i] - expected.0[i]).abs() < 1e-3), "{norm} {log:?} {expected:?}");
        }
        assert!((summary.complexity / 100.0 - 1.0).abs() < 0.01);
        assert_eq!((summary.limited, summary.unfitted), (0, 0));
    }
}

#[test]
fn norms_weigh_the_determinant_as_theory_says() {
    let n = 10;
    let mesh = cube(n);
    // H = diag(x + 1, 1, 1); third derivatives cancel where the points around lie symmetrically.
    let u = values(&mesh, |[x, y, z]| (x + 1.0).powi(3) / 6.0 + 0.5 * (y * y + z * z));
    let at = |i: u32| ((i * (n + 1) + 5) * (n + 1) + 5) as usize;
    for (norm, exponent) in [("1", -1.0 / 5.0), ("2", -1.0 / 7.0), ("4", -1.0 / 11.0), ("inf", 0.0)] {
        let (logs, _) = made(&mesh, &u, &Options { norm: norm.parse().unwrap(), ..options(3e4) });
        let (here, there) = (logs[at(3)].exp(), logs[at(7)].exp());
        let ratio = (1.7f64 / 1.3).powf(exponent);
        assert!((there.0[2] / here.0[2] / ratio - 1.0).abs() < 1e-9, "{norm}");
        assert!((there.0[0] / here.0[0] / (ratio * 1.7 / 1.3) - 1.0).abs() < 1e-9, "{norm}");
    }
}

#[test]
fn limits_and_gradation_keep_the_complexity() {
    let mesh = cube(9);
    let u = values(&mesh, |[x, y, z]| (40.0 * (x + 0.3 * y - 0.6)).tanh() + 0.1 * z * z);
    let limits = Limits { hmin: Some(0.02), hmax: Some(0.2), aspect_ratio: Some(3.0) };
    for recovery in [Recovery::Fit, Recovery::L2] {
        for gradation in [None, Some(1.5)] {
            for measure in [Measure::AtVertices, Measure::Between] {
                let options = Options {
                    recovery,
                    bounds: Bounds { gradation, limits, measure, ..bounds(4000.0) },
                    ..options(4000.0)
                };
                let (logs, summary) = made(&mesh, &u, &options);
                let found = measure.of(Team::alone(), &mesh, &logs);
                assert!((found / 4000.0 - 1.0).abs() < 0.01 && found == summary.complexity, "{found}");
                assert!(summary.limited > 0);
                assert!(gradation.is_none() || summary.complexity_before_gradation < 0.99 * found);
                for h in logs.iter().map(|log| log.exp().sizes()) {
                    assert!(h[2] > 0.02 * (1.0 - 1e-9) && h[0] < 0.2 * (1.0 + 1e-9) && h[0] / h[2] < 3.0001, "{h:?}");
                }
            }
        }
    }
}

#[test]
fn sensors_are_intersected_whatever_their_units() {
    let mesh = cube(6);
    let (u, v) =
        (values(&mesh, |p| p[0] * p[0] + 1e-3 * p[1] * p[1]), values(&mesh, |p| 7e6 * p[2] * p[2] + 1e4 * p[1] * p[1]));
    let (logs, _) = multiscale(Team::alone(), &mesh, &[vec![&u], vec![&v]], &options(500.0)).unwrap();
    let m = logs[100].exp();
    // Each alone has the same greatest eigenvalue, along x and along z.
    assert!((m.0[0] / m.0[5]).ln().abs() < 0.5 && m.0[2] < 0.1 * m.0[0], "{m:?}");
    let large = values(&mesh, |p| 1e-5 * (7e6 * p[2] * p[2] + 1e4 * p[1] * p[1]) + 12.0);
    let (other, _) = multiscale(Team::alone(), &mesh, &[vec![&u], vec![&large]], &options(500.0)).unwrap();
    assert!(logs.iter().zip(&other).all(|(a, b)| (0..6).all(|i| (a.0[i] - b.0[i]).abs() < 1e-4)));
}

#[test]
fn steps_are_averaged() {
    let mesh = cube(6);
    let u = values(&mesh, |p| p[0] * p[0] - 3.0 * p[1] * p[1] + 2.0 * p[2] * p[2] * p[0]);
    let minus: Vec<f64> = u.iter().map(|x| -x).collect();
    let (alone, _) = made(&mesh, &u, &options(500.0));
    let (both, _) = multiscale(Team::alone(), &mesh, &[vec![&u, &minus, &u]], &options(500.0)).unwrap();
    assert!(alone.iter().zip(&both).all(|(a, b)| (0..6).all(|i| (a.0[i] - b.0[i]).abs() < 1e-9)));
    // |H| of two steps that are curved along x and along y by 1 and by 3: their mean is diag(½, 3/2, 1).
    let (first, second) = (
        values(&mesh, |p| 0.5 * (p[0] * p[0] + p[2] * p[2])),
        values(&mesh, |p| 0.5 * (3.0 * p[1] * p[1] - p[2] * p[2])),
    );
    let (logs, _) = multiscale(Team::alone(), &mesh, &[vec![&first, &second]], &options(500.0)).unwrap();
    let m = logs[17].exp();
    assert!((m.0[2] / m.0[0] - 3.0).abs() < 1e-9 && (m.0[5] / m.0[0] - 2.0).abs() < 1e-9, "{m:?}");
}

#[test]
fn what_tells_no_size_is_refused() {
    let mut mesh = cube(5);
    mesh.vertices.iter_mut().for_each(|p| p[2] *= 1e-4);
    let of = |u: &[f64], options: &Options| multiscale(Team::alone(), &mesh, &[vec![u]], options).unwrap_err();
    for u in
        [values(&mesh, |_| 0.0), values(&mesh, |_| 3.7), values(&mesh, |p| 1e5 + 3.0 * p[0] - 7.0 * p[1] + 1e3 * p[2])]
    {
        assert_eq!(of(&u, &options(100.0)), Error::Flat { sensor: 0 });
    }
    let mut u = values(&mesh, |p| p[0] * p[0]);
    let limits = Limits { hmin: Some(0.1), ..Limits::default() };
    let Error::Unreachable { nearest, .. } =
        of(&u, &Options { bounds: Bounds { limits, ..bounds(1e5) }, ..options(1e5) })
    else {
        panic!()
    };
    assert!(nearest < 1.0, "{nearest}");
    u[17] = f64::NAN;
    assert_eq!(of(&u, &options(100.0)), Error::NotFinite { sensor: 0, step: 0, vertex: 17 });
    assert_eq!(multiscale(Team::alone(), &mesh, &[], &options(1.0)).unwrap_err(), Error::Nothing);
}

#[test]
fn the_same_on_any_number_of_threads() {
    let mesh = cube(14);
    let (u, v) =
        (values(&mesh, |[x, y, z]| (5.0 * x * y).sin() + z), values(&mesh, |[x, y, z]| (9.0 * (z - x * y)).tanh()));
    let options = Options { bounds: Bounds { gradation: Some(1.4), ..bounds(3000.0) }, ..options(3000.0) };
    let of = |team: Team<'_>| multiscale(team, &mesh, &[vec![&u, &v], vec![&v]], &options).unwrap();
    let alone = of(Team::alone());
    let pool = Pool::new(3).unwrap();
    assert!(of(Team::new(&pool, Plan::default())) == alone);
}

#[test]
fn what_is_fixed_holds_whatever_the_complexity() {
    let mesh = cube(9);
    let u = values(&mesh, |[x, y, z]| (9.0 * (x + 0.3 * y - 0.6)).tanh() + 0.1 * z * z);
    let size = |p: &Vec3| if p[2] < 0.2 { 0.04 } else { 1.7 };
    let fixed: Vec<Sym3> = mesh.vertices.iter().map(|p| Sym3::ZERO.plus_identity(-2.0 * f64::ln(size(p)))).collect();
    for gradation in [None, Some(1.5)] {
        let bounds = Bounds { gradation, fixed: Some(&fixed), ..bounds(9000.0) };
        let (logs, summary) = made(&mesh, &u, &Options { bounds, ..options(9000.0) });
        assert!((summary.complexity / 9000.0 - 1.0).abs() < 0.01, "{}", summary.complexity);
        for (log, p) in logs.iter().zip(&mesh.vertices) {
            assert!(log.exp().sizes()[0] < size(p) * (1.0 + 1e-6), "{p:?}");
        }
    }
    // Where it asks for more by itself, no scale will do.
    let bounds = Bounds { fixed: Some(&fixed), ..bounds(100.0) };
    let error = multiscale(Team::alone(), &mesh, &[vec![&u]], &Options { bounds, ..options(100.0) }).unwrap_err();
    assert!(matches!(error, Error::Unreachable { nearest, .. } if nearest > 1000.0), "{error}");
}
