//! What recovery promises: quadratics exactly, everywhere, on stretched meshes too.
use super::{Recovery, Rings};
use crate::mesh::TetMesh;
use crate::mesh::samples::cube;
use crate::mesh::vector::Vec3;
use crate::metric::{Eigen, Sym3};
use crate::tasks::{Plan, Pool, Team};

/// A cube whose inner vertices are moved, then stretched by `stretch`.
fn stretched(n: u32, stretch: &Sym3) -> (TetMesh, Vec<Vec3>) {
    let mut mesh = cube(n);
    let before: Vec<Vec3> = mesh
        .vertices
        .iter()
        .enumerate()
        .map(|(v, &p)| {
            let inside = p.iter().all(|&x| x > 0.0 && x < 1.0);
            let jitter = |k: u64| {
                ((v as u64 * 3 + k).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40) as f64 / f64::from(1 << 24) - 0.5
            };
            let size = if inside { 0.5 / f64::from(n) } else { 0.0 };
            std::array::from_fn(|i| p[i] + size * jitter(i as u64))
        })
        .collect();
    mesh.vertices = before.iter().map(|&p| stretch.apply(p)).collect();
    (mesh, before)
}

#[test]
fn fits_meet_quadratics_at_all_vertices() {
    let oblique = [[2.0, -1.0, 2.0], [2.0, 2.0, -1.0], [-1.0, 2.0, 2.0]].map(|v| v.map(|x| x / 3.0));
    let stretches = [
        Sym3::IDENTITY,
        Sym3::diagonal(1.0, 1.0, 1e-3),
        Sym3::from_eigen(&Eigen { values: [1.0, 0.03, 1e-3], vectors: oblique }),
        Sym3::from_eigen(&Eigen { values: [1e4, 1e4, 1e1], vectors: oblique }),
    ];
    for stretch in stretches {
        for (constant, g, h) in [
            (3.0, [0.0; 3], Sym3::ZERO),
            (-1.0, [2.0, -3.0, 0.5], Sym3::ZERO),
            (1.0, [0.3, 0.2, 0.1], Sym3([1.0, 0.5, -2.0, 0.25, 1.5, 3.0])),
        ] {
            let (mesh, before) = stretched(4, &stretch);
            let value = |&[x, y, z]: &Vec3| constant + g[0] * x + g[1] * y + g[2] * z + 0.5 * h.quadratic([x, y, z]);
            let values: Vec<f64> = before.iter().map(value).collect();
            let rings = Rings::of(Team::alone(), &mesh);
            let (found, unfitted) = Recovery::Fit.hessians(Team::alone(), &mesh, &rings, &values);
            assert_eq!(unfitted, 0);
            let worst = found.iter().map(|found| {
                // In the coordinates before the stretch.
                let found = found.congruent(&stretch);
                (0..6).map(|i| (found.0[i] - h.0[i]).abs()).fold(0.0, f64::max)
            });
            let worst = worst.fold(0.0, f64::max);
            assert!(worst < 1e-8, "{worst:e} with {stretch:?} and {h:?}");
        }
    }
}

#[test]
fn a_few_cells_have_a_hessian_all_the_same() {
    // One tetrahedron a layer, and cubes of one and two cells: too little for a fit, or just enough.
    for n in [1, 2] {
        let mesh = cube(n);
        let values: Vec<f64> = mesh.vertices.iter().map(|p| p[0] * p[0] + p[1]).collect();
        let rings = Rings::of(Team::alone(), &mesh);
        for recovery in [Recovery::Fit, Recovery::L2] {
            let (found, _) = recovery.hessians(Team::alone(), &mesh, &rings, &values);
            assert!(found.iter().all(|h| h.0.iter().all(|x| x.is_finite())), "{n} {recovery:?}");
        }
        if n == 2 {
            let (found, _) = Recovery::Fit.hessians(Team::alone(), &mesh, &rings, &values);
            assert!(found.iter().all(|h| (h.0[0] - 2.0).abs() < 1e-9 && h.0[2].abs() < 1e-9), "{found:?}");
        }
    }
}

#[test]
fn a_smooth_function_is_met_the_better_the_finer() {
    let u = |[x, y, z]: Vec3| (2.0 * x).sin() * (1.5 * y).cos() + z * z * z;
    let exact = |[x, y, z]: Vec3| {
        let (s, c, s2, c2) = ((2.0 * x).sin(), (2.0 * x).cos(), (1.5 * y).sin(), (1.5 * y).cos());
        Sym3([-4.0 * s * c2, -3.0 * c * s2, -2.25 * s * c2, 0.0, 0.0, 6.0 * z])
    };
    let error = |recovery: Recovery, n: u32, inside: bool| {
        let (mesh, _) = stretched(n, &Sym3::IDENTITY);
        let values: Vec<f64> = mesh.vertices.iter().map(|&p| u(p)).collect();
        let rings = Rings::of(Team::alone(), &mesh);
        let (found, _) = recovery.hessians(Team::alone(), &mesh, &rings, &values);
        let off = (0u32..).zip(&mesh.vertices).zip(&found).filter(|((v, _), _)| !inside || rings.is_inside(*v));
        let off = off.map(|((_, &p), h)| (0..6).map(|i| (h.0[i] - exact(p).0[i]).abs()).fold(0.0, f64::max));
        off.fold(0.0, f64::max)
    };
    // Of first order at the boundary, where the points lie on one side.
    let [coarse, fine] = [8, 16].map(|n| error(Recovery::Fit, n, false));
    assert!(fine < 0.65 * coarse && fine < 1.0, "{coarse} {fine}");
    assert!(error(Recovery::Fit, 16, true) < error(Recovery::L2, 16, true));
}

#[test]
fn the_same_on_any_number_of_threads() {
    let (mesh, before) = stretched(14, &Sym3::diagonal(1.0, 2.0, 0.1));
    let values: Vec<f64> = before.iter().map(|p| (7.0 * p[0]).sin() * p[1] + p[2]).collect();
    for recovery in [Recovery::Fit, Recovery::L2] {
        let found = |team: Team<'_>| recovery.hessians(team, &mesh, &Rings::of(team, &mesh), &values).0;
        let alone = found(Team::alone());
        for threads in [2, 3] {
            let pool = Pool::new(threads).unwrap();
            assert!(found(Team::new(&pool, Plan::default())) == alone, "{recovery:?} on {threads} threads");
        }
    }
}

#[test]
fn smooth_fields_have_no_jumps() {
    let (mesh, before) = stretched(5, &Sym3::diagonal(1.0, 1.0, 1e-3));
    let values: Vec<f64> = before.iter().map(|&[x, y, z]| (x + 0.5 * y).sin() + z * z).collect();
    let rings = Rings::of(Team::alone(), &mesh);
    let [fit, jumps] =
        [Recovery::Fit, Recovery::Jumps].map(|how| how.hessians(Team::alone(), &mesh, &rings, &values).0);
    assert_eq!(fit, jumps, "bit for bit");
}

#[test]
fn a_jump_is_sharper_and_no_wider() {
    let (mesh, before) = stretched(8, &Sym3::diagonal(1e-2, 1.0, 1.0));
    let values: Vec<f64> =
        before.iter().map(|p| if p[0] + 0.6 * p[1] - 0.3 * p[2] > 0.62 { 3.0 } else { 0.0 }).collect();
    let rings = Rings::of(Team::alone(), &mesh);
    let hessians = |how: Recovery, team| how.hessians(team, &mesh, &rings, &values).0;
    let [fit, jumps] = [Recovery::Fit, Recovery::Jumps].map(|how| hessians(how, Team::alone()));
    // (A jump along the layers of the mesh would be a parabola to three of them.)
    let crosses = |v: u32| rings.neighbours(v).iter().any(|&other| values[other as usize] != values[v as usize]);
    let (mut ratios, mut beside) = (Vec::new(), 0);
    for v in 0..values.len() as u32 {
        let at = v as usize;
        let absolute = |hessian: &Sym3| hessian.eigen().values.map(f64::abs);
        let [of_fit, of_jumps] =
            [&fit[at], &jumps[at]].map(|hessian| absolute(hessian).into_iter().fold(0.0, f64::max));
        if crosses(v) {
            ratios.push(of_jumps / of_fit);
        } else if rings.is_inside(v) {
            assert!(of_jumps <= of_fit, "{:?}: {of_jumps} above {of_fit}", mesh.vertices[at]);
            beside += 1;
        }
    }
    ratios.sort_by(f64::total_cmp);
    assert!(beside > 100 && ratios.len() > 100);
    assert!(ratios[ratios.len() / 2] > 1.2, "median {}", ratios[ratios.len() / 2]);
    let pool = Pool::new(3).unwrap();
    assert_eq!(hessians(Recovery::Jumps, Team::new(&pool, Plan::default())), jumps, "bit for bit on three threads");
}
