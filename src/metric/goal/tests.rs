//! What the metric of a goal promises: Q term by term, its scale, and what is refused.
use super::{Boundary, Derivative, Error, Fluid, Gas, Goal, NORM, Variables, Viscosity, Weight};
use crate::mesh::TetMesh;
use crate::mesh::samples::cube;
use crate::mesh::vector::Vec3;
use crate::metric::multiscale::{self, Bounds, Measure, Options};
use crate::metric::recovery::{Recovery, Rings};
use crate::metric::{Limits, Sym3};
use crate::tasks::{Plan, Pool, Team};

fn goal(mesh: &TetMesh, boundary: Boundary) -> Goal<'_> {
    Goal::new(Team::alone(), mesh, Recovery::Fit, boundary)
}

fn on<T>(mesh: &TetMesh, f: impl Fn(Vec3) -> T) -> Vec<T> {
    mesh.vertices.iter().map(|&p| f(p)).collect()
}

fn options<'f>(complexity: f64, hmax: f64) -> Options<'f> {
    let limits = Limits { hmin: None, hmax: Some(hmax), aspect_ratio: None };
    let bounds =
        Bounds { complexity, measure: Measure::AtVertices, gradation: None, limits, fixed: None, by_others: None };
    Options { recovery: Recovery::Fit, norm: NORM, bounds }
}

fn close(found: &Sym3, wanted: &Sym3, tolerance: f64) -> bool {
    let size = wanted.0.iter().fold(f64::MIN_POSITIVE, |a, x| a.max(x.abs()));
    (0..6).all(|i| (found.0[i] - wanted.0[i]).abs() <= tolerance * size)
}

/// Of both signs, so that |H| is not H.
const BENT: Sym3 = Sym3([3.0, 1.0, -2.0, 0.5, 0.0, 1.0]);

#[test]
fn a_quadratic_field_counts_by_its_weight() {
    let mesh = cube(6);
    let field = on(&mesh, |p| 2.0 + p[0] - p[2] + 0.5 * BENT.quadratic(p));
    let weight = |p: Vec3| 1.0 + p[0] * p[1];
    let mut sum = goal(&mesh, Boundary::Own);
    sum.add(Weight::Given(&on(&mesh, weight)), &field).unwrap();
    sum.add(Weight::Given(&on(&mesh, |_| 0.5)), &on(&mesh, |p| p[2] * p[2])).unwrap();
    // A linear field asks for nothing.
    sum.add(Weight::Given(&on(&mesh, |_| 1e6)), &on(&mesh, |p| p[1])).unwrap();
    assert_eq!(sum.terms(), 3);
    for (&p, q) in mesh.vertices.iter().zip(sum.sum()) {
        let wanted = BENT.magnitude().times(weight(p)).plus(Sym3::diagonal(0.0, 0.0, 1.0));
        assert!(close(q, &wanted, 1e-8), "{p:?}: {q:?} for {wanted:?}");
    }
}

#[test]
fn weights_on_the_boundary_are_no_greater_than_inside() {
    let mesh = cube(5);
    let rings = Rings::of(Team::alone(), &mesh);
    let mut sum = goal(&mesh, Boundary::Inside);
    // A weight that is singular on the side x = 0.
    sum.add(Weight::Given(&on(&mesh, |p| 1.0 / (p[0] + 1e-6))), &on(&mesh, |p| p[0] * p[0])).unwrap();
    let inside = sum.sum().iter().enumerate().filter(|&(v, _)| rings.is_inside(v as u32));
    let most = inside.map(|(_, q)| q.0[0]).fold(0.0, f64::max);
    assert!((most / 10.0 - 1.0).abs() < 1e-4, "{most}");
    assert!(sum.sum().iter().all(|q| q.0[0] <= most * (1.0 + 1e-9)));
}

#[test]
fn the_metric_is_q_by_its_determinant_to_the_fifth_root() {
    let mesh = cube(8);
    let weight = |p: Vec3| (2.0 * p[0] - p[1]).exp();
    let mut sum = goal(&mesh, Boundary::Own);
    sum.add(Weight::Given(&on(&mesh, weight)), &on(&mesh, |p| 0.5 * BENT.quadratic(p))).unwrap();
    let (logs, summary) = sum.metric(&options(20_000.0, 1.0)).unwrap();
    assert!((summary.complexity / 20_000.0 - 1.0).abs() < 0.01, "{summary:?}");
    let unscaled = |p: Vec3| {
        let q = BENT.magnitude().times(weight(p));
        q.times(q.det().powf(-0.2))
    };
    let scale = logs[0].exp().0[0] / unscaled(mesh.vertices[0]).0[0];
    for (&p, log) in mesh.vertices.iter().zip(&logs) {
        assert!(close(&log.exp(), &unscaled(p).times(scale), 1e-7), "{p:?}");
    }
}

#[test]
fn derivatives_of_an_adjoint_count_in_absolute_value() {
    let mesh = cube(6);
    // λ = x² - 3 y² + x z: ∂x = 2x + z, ∂xx = 2, ∂yy = -6, ∂xz = 1.
    let adjoint = on(&mesh, |p| p[0] * p[0] - 3.0 * p[1] * p[1] + p[0] * p[2]);
    let coefficients: Vec<(Derivative, f64)> =
        [("xx", 0.5), ("yy", -2.0), ("zx", 1.0)].map(|(name, c)| (name.parse().unwrap(), c)).into();
    let mut sum = goal(&mesh, Boundary::Own);
    let field = on(&mesh, |p| 0.5 * p[1] * p[1]);
    sum.add(Weight::Adjoint(&adjoint, &coefficients), &field).unwrap();
    assert!(sum.sum().iter().all(|q| (q.0[2] - 14.0).abs() < 1e-7));
    // A first derivative is right to rounding where λ is linear.
    let mut sum = goal(&mesh, Boundary::Own);
    let slope = [("y".parse().unwrap(), -3.0)];
    sum.add(Weight::Adjoint(&on(&mesh, |p| 7.0 + 2.0 * p[1]), &slope), &field).unwrap();
    assert!(sum.sum().iter().all(|q| (q.0[2] - 6.0).abs() < 1e-9));
    for wrong in ["", "w", "xyz", "x y", "X"] {
        assert!(wrong.parse::<Derivative>().unwrap_err().contains("xx, xy"), "{wrong}");
    }
    assert_eq!("zy".parse::<Derivative>().unwrap().to_string(), "zy");
}

const GAMMA: f64 = 1.4;

/// A smooth state in primitive variables.
fn state([x, y, z]: Vec3) -> [f64; 5] {
    [
        1.0 + 0.2 * (x + 0.5 * y).sin(),
        0.5 + 0.1 * (y - z).cos(),
        0.2 * (x * z).sin(),
        -0.1 * (x + y + z).cos(),
        0.8 + 0.1 * (z + 0.3 * x).sin(),
    ]
}

fn conservative([density, u, v, w, pressure]: [f64; 5]) -> [f64; 5] {
    let energy = pressure / (GAMMA - 1.0) + 0.5 * density * (u * u + v * v + w * w);
    [density, density * u, density * v, density * w, energy]
}

/// Flux k of Euler's equations in direction d.
fn flux(d: usize, k: usize, p: Vec3) -> f64 {
    let primitive = state(p);
    let conserved = conservative(primitive);
    let (speed, pressure) = (primitive[d + 1], primitive[4]);
    let push = if k == d + 1 { pressure } else { 0.0 };
    if k == 4 { speed * (conserved[4] + pressure) } else { speed * conserved[k] + push }
}

/// Second derivatives by central differences.
fn bends(f: impl Fn(Vec3) -> f64, p: Vec3) -> Sym3 {
    let h = 1e-3;
    let at = |steps: [f64; 3]| f(std::array::from_fn(|i| p[i] + h * steps[i]));
    let unit = |i: usize, s: f64| std::array::from_fn::<f64, 3, _>(|k| if k == i { s } else { 0.0 });
    let both = |i: usize, a: f64, j: usize, b: f64| std::array::from_fn::<f64, 3, _>(|k| unit(i, a)[k] + unit(j, b)[k]);
    let second = |i: usize, j: usize| {
        (at(both(i, 1.0, j, 1.0)) - at(both(i, 1.0, j, -1.0)) - at(both(i, -1.0, j, 1.0)) + at(both(i, -1.0, j, -1.0)))
            / (4.0 * h * h)
    };
    Sym3([second(0, 0), second(0, 1), second(1, 1), second(0, 2), second(1, 2), second(2, 2)])
}

#[test]
fn the_fluxes_of_euler_are_those_of_finite_differences() {
    let mesh = cube(16);
    // ∂_d λ_k.
    let slopes: [Vec3; 5] =
        [[1.0, -0.5, 0.3], [0.2, 0.7, -1.0], [-0.4, 1.5, 0.6], [0.9, 0.1, -0.8], [0.5, -0.25, 0.75]];
    let adjoint = on(&mesh, |p| slopes.map(|slope| slope[0] * p[0] + slope[1] * p[1] + slope[2] * p[2]));
    let gas = Gas { gamma: GAMMA, viscosity: None };
    let made = |variables: Variables, primal: Vec<[f64; 5]>| {
        let mut sum = goal(&mesh, Boundary::Own);
        sum.add_flow(&gas, variables, &primal, &adjoint).unwrap();
        sum.sum().to_vec()
    };
    let found = made(Variables::Primitive, on(&mesh, state));
    let same = made(Variables::Conservative, on(&mesh, |p| conservative(state(p))));
    assert!(found.iter().zip(&same).all(|(a, b)| close(a, b, 1e-6)));
    let deep = |p: &Vec3| p.iter().all(|x| (0.2..0.8).contains(x));
    for (&p, q) in mesh.vertices.iter().zip(&found).filter(|(p, _)| deep(p)) {
        let mut wanted = Sym3::ZERO;
        for (k, slope) in slopes.iter().enumerate() {
            for (d, slope) in slope.iter().enumerate() {
                wanted = wanted.plus(bends(|p| flux(d, k, p), p).magnitude().times(slope.abs()));
            }
        }
        // |H| is not smooth where an eigenvalue is zero.
        assert!(close(q, &wanted, 0.03), "{p:?}: {q:?} for {wanted:?}");
    }
}

#[test]
fn the_fluxes_of_constant_density_are_those_of_finite_differences() {
    let mesh = cube(16);
    let slopes: [Vec3; 4] = [[0.2, 0.7, -1.0], [-0.4, 1.5, 0.6], [0.9, 0.1, -0.8], [1.0, -0.5, 0.3]];
    let adjoint = on(&mesh, |p| slopes.map(|slope| slope[0] * p[0] + slope[1] * p[1] + slope[2] * p[2]));
    let density = 2.5;
    // Velocity and pressure of the state above.
    let flow = |p: Vec3| -> [f64; 4] { std::array::from_fn(|k| state(p)[k + 1]) };
    let mut sum = goal(&mesh, Boundary::Own);
    sum.add_incompressible(Fluid { density, viscosity: 0.0 }, &on(&mesh, flow), &adjoint).unwrap();
    let flux = |d: usize, k: usize, p: Vec3| {
        let u = flow(p);
        let push = if k == d { u[3] / density } else { 0.0 };
        if k == 3 { u[d] } else { u[d] * u[k] + push }
    };
    let deep = |p: &Vec3| p.iter().all(|x| (0.2..0.8).contains(x));
    for (&p, q) in mesh.vertices.iter().zip(sum.sum()).filter(|(p, _)| deep(p)) {
        let mut wanted = Sym3::ZERO;
        for (k, slope) in slopes.iter().enumerate() {
            for (d, slope) in slope.iter().enumerate() {
                wanted = wanted.plus(bends(|p| flux(d, k, p), p).magnitude().times(slope.abs()));
            }
        }
        // |H| is not smooth where an eigenvalue is zero.
        assert!(close(q, &wanted, 0.03), "{p:?}: {q:?} for {wanted:?}");
    }
}

#[test]
fn friction_at_constant_density_counts_by_the_second_derivatives_of_the_adjoint() {
    let mesh = cube(5);
    // The velocity is quadratic, and at its size the fluxes are next to nothing beside it.
    let of = [Sym3::diagonal(1.0, 0.5, -1.0), Sym3::diagonal(0.0, 2.0, 0.0), Sym3([0.0, 1.0, 0.0, 0.0, 0.0, -3.0])];
    let size = 1e-6;
    let primal = on(&mesh, |p| {
        let [u, v, w] = of.map(|h| size * 0.5 * h.quadratic(p));
        [u, v, w, 0.0]
    });
    let bent = [Sym3::diagonal(1.0, -2.0, 0.5), Sym3([0.5, 9.0, -1.5, 9.0, 9.0, 0.0]), Sym3::diagonal(0.0, 0.25, 1.0)];
    let adjoint = on(&mesh, |p| {
        let [a, b, c] = bent.map(|h| 0.5 * h.quadratic(p));
        [a, b, c, 0.0]
    });
    let viscosity = 10.0;
    let mut sum = goal(&mesh, Boundary::Own);
    sum.add_incompressible(Fluid { density: 1.0, viscosity }, &primal, &adjoint).unwrap();
    let wanted = of
        .iter()
        .zip([3.5, 2.0, 1.25])
        .fold(Sym3::ZERO, |sum, (h, weight)| sum.plus(h.magnitude().times(size * viscosity * weight)));
    assert!(sum.sum().iter().all(|q| close(q, &wanted, 1e-3)), "{:?} for {wanted:?}", sum.sum()[0]);
    let mut broken = adjoint.clone();
    broken[7][3] = f64::NAN;
    let refused = goal(&mesh, Boundary::Own).add_incompressible(Fluid { density: 1.0, viscosity }, &primal, &broken);
    assert_eq!(refused, Err(Error::NotFinite { vertex: 7 }));
}

#[test]
fn viscous_terms_are_second_derivatives_of_the_adjoint_in_absolute_value() {
    let mesh = cube(5);
    // Quadratic velocities and pressure at constant density: their Hessians are met, and so are those of the adjoints.
    let of = [Sym3::diagonal(1.0, 0.5, -1.0), Sym3::diagonal(0.0, 2.0, 0.0), Sym3([0.0, 1.0, 0.0, 0.0, 0.0, -3.0])];
    let heat = Sym3::diagonal(0.5, -0.25, 0.0);
    let primal = on(&mesh, |p| {
        let [u, v, w] = of.map(|h| 0.1 * h.quadratic(p));
        [1.0, u, v, w, 2.0 + 0.1 * heat.quadratic(p)]
    });
    let bent: [Sym3; 4] = [
        Sym3([1.0, -2.0, 0.5, 0.25, 0.0, -1.0]),
        Sym3([0.5, 0.5, -1.5, 1.0, -0.75, 0.0]),
        Sym3([0.0, 0.25, 1.0, -0.5, 2.0, 0.5]),
        Sym3([1.0, 0.5, -0.5, 0.0, 1.5, 1.0]),
    ];
    let adjoint = on(&mesh, |p| {
        let [a, b, c, d] = bent.map(|h| 0.5 * h.quadratic(p));
        [0.0, a, b, c, d]
    });
    let (mu, prandtl) = (0.01, 0.72);
    let made = |viscosity| {
        let mut sum = goal(&mesh, Boundary::Own);
        sum.add_flow(&Gas { gamma: GAMMA, viscosity }, Variables::Primitive, &primal, &adjoint).unwrap();
        sum.sum().to_vec()
    };
    let (inviscid, viscous) = (made(None), made(Some(Viscosity { mu, prandtl })));
    for (v, (a, b)) in inviscid.iter().zip(&viscous).enumerate() {
        let speed = [primal[v][1], primal[v][2], primal[v][3]];
        let energy = &bent[3];
        let mut wanted = Sym3::ZERO;
        for j in 0..3 {
            // μ(Σ_d ∂_dd + ⅓ ∂_j ∂_k) of λ_k, and of u_k λ_4.
            let mut weight = 0.0;
            for d in 0..3 {
                weight += bent[j].at(d, d).abs() + (speed[j] * energy.at(d, d)).abs();
                weight += (bent[d].at(j, d).abs() + (speed[d] * energy.at(j, d)).abs()) / 3.0;
            }
            wanted = wanted.plus(of[j].times(0.2).magnitude().times(mu * weight));
        }
        let diagonal: f64 = (0..3).map(|d| energy.at(d, d).abs()).sum();
        let conductivity = mu * GAMMA / ((GAMMA - 1.0) * prandtl);
        wanted = wanted.plus(heat.times(0.2).magnitude().times(conductivity * diagonal));
        assert!(close(&b.plus(a.times(-1.0)), &wanted, 1e-6), "{v}");
    }
}

#[test]
fn what_is_no_goal_is_refused() {
    let mesh = cube(3);
    let field = on(&mesh, |p| p[0] * p[0]);
    let one = on(&mesh, |_| 1.0);
    let mut sum = goal(&mesh, Boundary::Inside);
    let mut negative = one.clone();
    negative[5] = -1.0;
    assert_eq!(sum.add(Weight::Given(&negative), &field), Err(Error::Weight { vertex: 5, value: -1.0 }));
    negative[5] = f64::NAN;
    assert!(matches!(sum.add(Weight::Given(&negative), &field), Err(Error::Weight { vertex: 5, .. })));
    assert_eq!(sum.add(Weight::Given(&one), &negative), Err(Error::NotFinite { vertex: 5 }));
    let slope = [(Derivative::First(0), 1.0)];
    assert_eq!(sum.add(Weight::Adjoint(&negative, &slope), &field), Err(Error::NotFinite { vertex: 5 }));
    let gas = Gas { gamma: GAMMA, viscosity: None };
    let adjoint = on(&mesh, |_| [0.0; 5]);
    let mut primal = on(&mesh, state);
    primal[7][0] = -0.5;
    let refused = sum.add_flow(&gas, Variables::Primitive, &primal, &adjoint);
    assert!(matches!(refused, Err(Error::State { vertex: 7, density: -0.5, .. })), "{refused:?}");
    primal[7][0] = f64::INFINITY;
    assert_eq!(sum.add_flow(&gas, Variables::Primitive, &primal, &adjoint), Err(Error::NotFinite { vertex: 7 }));
    let metric = |terms: &[(&[f64], &[f64])], complexity| {
        let mut sum = goal(&mesh, Boundary::Inside);
        terms.iter().for_each(|(weight, field)| sum.add(Weight::Given(weight), field).unwrap());
        sum.metric(&options(complexity, 0.1)).map(drop)
    };
    assert_eq!(metric(&[], 100.0), Err(Error::Nothing));
    assert_eq!(metric(&[(&one, &on(&mesh, |p| p[1]))], 100.0), Err(Error::Flat));
    assert_eq!(metric(&[(&on(&mesh, |_| 0.0), &field)], 100.0), Err(Error::Flat));
    let coarse = metric(&[(&one, &field)], 1.0);
    assert!(matches!(coarse, Err(Error::Metric(multiscale::Error::Unreachable { .. }))), "{coarse:?}");
}

#[test]
fn the_same_on_any_number_of_threads() {
    let mesh = cube(14);
    let (primal, adjoint) = (on(&mesh, state), on(&mesh, |p| state([p[1], p[2], p[0]])));
    let gas = Gas { gamma: GAMMA, viscosity: Some(Viscosity { mu: 0.1, prandtl: 0.72 }) };
    let made = |team: Team<'_>| {
        let mut sum = Goal::new(team, &mesh, Recovery::Fit, Boundary::Inside);
        sum.add_flow(&gas, Variables::Primitive, &primal, &adjoint).unwrap();
        sum.metric(&options(5000.0, 1.0)).unwrap().0
    };
    let alone = made(Team::alone());
    for threads in [2, 3] {
        let pool = Pool::new(threads).unwrap();
        assert!(made(Team::new(&pool, Plan::default())) == alone, "{threads} threads");
    }
}
