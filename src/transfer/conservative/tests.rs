use super::*;
use crate::mesh::samples::{cube, with_boundary};
use crate::mesh::vector::{Vec3, norm};
use crate::tasks::{Plan, Pool};

fn locator(mesh: &TetMesh) -> Locator {
    Locator::new(mesh.vertices.clone(), mesh.tets.nodes.clone())
}

/// A cube whose inner vertices are moved by up to a quarter of a cell, and whose cells are thin in z near z = 0.
fn moved(n: u32, thin: i32) -> TetMesh {
    let mut mesh = cube(n);
    let step = 1.0 / f64::from(n);
    for p in &mut mesh.vertices {
        let q = *p;
        for i in 0..3 {
            if q[i] > 0.0 && q[i] < 1.0 {
                p[i] +=
                    0.24 / f64::from(thin) * step * (97.0 * q[(i + 1) % 3] + 31.0 * q[(i + 2) % 3] + 7.0 * q[i]).sin();
            }
        }
        p[2] = p[2].powi(thin);
    }
    mesh
}

/// A ball: the cube [−1, 1]³ blown up.
fn ball(n: u32) -> TetMesh {
    let mesh = cube(n);
    let blown = |p: &Vec3| {
        let q = p.map(|x| 2.0 * x - 1.0);
        let far = q.iter().fold(0.0f64, |far, x| far.max(x.abs()));
        if far == 0.0 { q } else { q.map(|x| x * far / norm(q)) }
    };
    with_boundary(mesh.vertices.iter().map(blown).collect(), mesh.tets.nodes)
}

fn at(mesh: &TetMesh, f: impl Fn(Vec3) -> [f64; 2]) -> Vec<f64> {
    mesh.vertices.iter().flat_map(|&p| f(p)).collect()
}

fn brought(team: Team<'_>, old: &TetMesh, new: &TetMesh, values: &[f64], keep: Keep) -> Conserved {
    let locator = locator(old);
    let places = Places::of(team, &locator, &new.vertices);
    conservative(team, &locator, new, &places, 2, values, keep).unwrap()
}

fn linear(p: Vec3) -> [f64; 2] {
    [3.0 + p[0] - 2.0 * p[1] + 5.0 * p[2], 1e3 - p[0]]
}

fn smooth(p: Vec3) -> [f64; 2] {
    [(3.0 * p[0]).sin() + (5.0 * p[1] * p[2]).cos(), if p[0] + p[1] > 0.9 { 7.0 } else { 2.0 }]
}

#[test]
fn a_linear_field_stays_itself() {
    for (old, new) in [(cube(5), moved(7, 1)), (moved(6, 3), moved(4, 2)), (moved(5, 4), cube(6))] {
        let found = brought(Team::alone(), &old, &new, &at(&old, linear), Keep::Mean);
        for (found, expected) in found.values.iter().zip(at(&new, linear)) {
            assert!((found - expected).abs() < 1e-12 * expected.abs().max(1.0), "{found} {expected}");
        }
        assert_eq!((found.partly, found.outside), (0, 0));
        assert!((found.common - 1.0).abs() < 1e-13);
    }
}

#[test]
fn the_same_mesh_gives_the_same_field() {
    let mesh = moved(5, 2);
    let values = at(&mesh, smooth);
    let found = brought(Team::alone(), &mesh, &mesh, &values, Keep::Mean);
    assert!(found.values.iter().zip(&values).all(|(a, b)| (a - b).abs() < 1e-12));
}

#[test]
fn integrals_stay_and_no_extremum_is_new() {
    let (a, b) = (moved(8, 2), moved(7, 1));
    let first = at(&a, smooth);
    let (_, start) = measure(Team::alone(), &a, 2, &first);
    let mut values = first;
    for _ in 0..5 {
        for (old, new) in [(&a, &b), (&b, &a)] {
            let found = brought(Team::alone(), old, new, &values, Keep::Mean);
            for c in 0..2 {
                let (was, is) = (found.before[c], found.after[c]);
                assert!(((is.mass - start[c].mass) / start[c].mass).abs() < 1e-13, "{was:?} {is:?}");
                assert!(is.least >= was.least && is.greatest <= was.greatest, "{was:?} {is:?}");
                // Nothing but rounding is left to the last correction.
                assert!(found.corrected[c].abs() < 1e-12);
            }
            values = found.values;
        }
    }
}

#[test]
fn each_value_lies_between_those_nearby() {
    let (old, new) = (moved(8, 1), moved(9, 1));
    let found = brought(Team::alone(), &old, &new, &at(&old, smooth), Keep::Mean);
    // Far from the step nothing of it is seen.
    for (p, row) in new.vertices.iter().zip(found.values.chunks(2)) {
        let from_step = (p[0] + p[1] - 0.9).abs();
        if from_step > 0.9 {
            assert_eq!(row[1], smooth(*p)[1], "{p:?}");
        }
    }
}

#[test]
fn between_two_meshes_of_a_ball_the_mean_stays() {
    let (a, b) = (ball(8), ball(5));
    let start = at(&a, |p| [2.0 + p[0] * p[1] + p[2], 1e6]);
    let (_, first) = measure(Team::alone(), &a, 2, &start);
    for keep in [Keep::Mean, Keep::Mass] {
        let mut values = start.clone();
        for round in 0..5 {
            for (old, new) in [(&a, &b), (&b, &a)] {
                let found = brought(Team::alone(), old, new, &values, keep);
                let [v, w] = found.volumes;
                assert!((v / w - 1.0).abs() > 0.01 && found.partly > 0);
                for c in 0..2 {
                    let (was, is) = (found.before[c], found.after[c]);
                    assert!(is.least >= was.least && is.greatest <= was.greatest, "{was:?} {is:?}");
                    let ratio = if keep == Keep::Mass && c == 0 { 1.0 } else { w / v };
                    assert!((is.mass / was.mass - ratio).abs() < 1e-13, "{round} {c} {keep:?} {was:?} {is:?}");
                }
                assert!(found.values.chunks(2).all(|row| row[1] == 1e6));
                values = found.values;
            }
        }
        let (_, last) = measure(Team::alone(), &a, 2, &values);
        assert!((0..2).all(|c| ((last[c].mass - first[c].mass) / first[c].mass).abs() < 1e-12), "{first:?} {last:?}");
    }
}

#[test]
fn what_the_field_counts_from_makes_no_difference() {
    let (a, b) = (ball(6), ball(5));
    let field = |offset: f64| at(&a, move |p| [p[0] * p[2] + offset, p[1] + offset]);
    let near = brought(Team::alone(), &a, &b, &field(0.0), Keep::Mean);
    let far = brought(Team::alone(), &a, &b, &field(1024.0), Keep::Mean);
    assert!(near.values.iter().zip(&far.values).all(|(x, y)| (y - x - 1024.0).abs() < 1e-10));
}

#[test]
fn what_lies_outside_has_the_nearest_values() {
    let (old, mut new) = (cube(4), cube(3));
    new.vertices.iter_mut().for_each(|p| p[0] = 3.0 * p[0] - 1.0);
    let values = at(&old, |p| [p[0], p[1]]);
    let found = brought(Team::alone(), &old, &new, &values, Keep::Mass);
    assert_eq!(found.outside, 2 * new.tets.len() / 3);
    assert!((found.common - 1.0).abs() < 1e-13 && (found.volumes[1] - 3.0).abs() < 1e-13);
    assert!(found.values.iter().all(|x| (0.0..=1.0).contains(x)));
    // A vertex of no tetrahedron, too.
    new.vertices.push([0.5, 0.25, 9.0]);
    let found = brought(Team::alone(), &old, &new, &values, Keep::Mean);
    let last = &found.values[found.values.len() - 2..];
    assert!((last[0] - 0.5).abs() < 1e-14 && (last[1] - 0.25).abs() < 1e-14, "{last:?}");
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let (a, b) = (ball(9), ball(10));
    let values = at(&a, smooth);
    let alone = brought(Team::alone(), &a, &b, &values, Keep::Mean);
    for threads in [2, 3] {
        let pool = Pool::new(threads).unwrap();
        let found = brought(Team::new(&pool, Plan::default()), &a, &b, &values, Keep::Mean);
        assert!(found.values == alone.values && found.after == alone.after && found.common == alone.common);
    }
}

#[test]
fn an_inverted_tetrahedron_is_refused() {
    let (old, mut new) = (cube(2), cube(2));
    new.tets.nodes[3].swap(0, 1);
    let locator = locator(&old);
    let places = Places::of(Team::alone(), &locator, &new.vertices);
    let values = at(&old, smooth);
    let error = conservative(Team::alone(), &locator, &new, &places, 2, &values, Keep::Mean).unwrap_err();
    assert_eq!(error, Error::Inverted { mesh: Which::New, tet: 3 });
}
