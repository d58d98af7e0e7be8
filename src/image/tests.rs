//! What holds in the store whatever the threads did: checked after whole runs.
use super::circumsphere;
use super::nrrd::{Image, Kind};
use super::rules::Rules;
use super::store::{NONE, Role, Store};
use super::*;
use crate::mesh::adjacency::FACES;
use crate::mesh::predicate::is_positive;
use crate::mesh::vector::{distance, norm, sub, volume6};
use crate::tasks::{Backend, Pool};

/// A ball of label 2 within one of label 1, off the middle.
fn balls() -> Domain {
    let index = (0..20 * 20 * 20).map(|voxel| [voxel % 20, voxel / 20 % 20, voxel / 400].map(f64::from));
    let label = |p: [f64; 3]| {
        let inner = norm(sub(p, [8.0, 9.0, 9.5])) < 4.0;
        if inner { 2.0 } else { f64::from(u8::from(norm(sub(p, [9.5; 3])) < 8.0)) }
    };
    let frame = Frame::of_spacings([1.0; 3]).unwrap();
    Domain::new(&Image::new([20; 3], frame, Kind::Int8, index.map(label)), None).unwrap()
}

/// Neighbours know each other, all is positive, Delaunay, and fills the box; nothing is locked; no item is left.
fn check(store: &Store, domain: &Domain, limits: &Limits) {
    let rules = Rules { store, domain, limits };
    let mut volume = 0.0;
    for t in (0..store.tet_bound()).filter(|&t| store.nodes(t)[0] != NONE) {
        let nodes = store.nodes(t);
        let corners = store.corners(nodes);
        assert!(is_positive(corners));
        assert_eq!(store.region(t), domain.region(circumsphere::centre(corners)));
        let [a, b, c, d] = corners;
        volume += volume6(a, b, c, d) / 6.0;
        for (i, n) in store.neighbours(t).into_iter().enumerate() {
            let face = FACES[i].map(|k| nodes[k]);
            if n == NONE {
                assert!(face.iter().all(|&v| store.role(v) == Role::Corner));
                continue;
            }
            let there = store.nodes(n);
            let back = store.neighbours(n).iter().position(|&back| back == t).expect("a neighbour knows it");
            assert!(face.iter().all(|v| there.contains(v)) && !face.contains(&there[back]));
            assert!(!circumsphere::contains(corners, store.at(there[back])), "not Delaunay");
            // What is still to be refined has no room for another vertex.
            if let Some(item) = rules.face(t, i, n) {
                assert!(distance(item.at, store.at(face[0])) < 1.0001 * limits.nearest);
            }
        }
        assert!(rules.tet(t).is_none(), "a tetrahedron above the limits");
    }
    let side = |i: usize| {
        let margin = distance(domain.low, domain.high);
        domain.high[i] - domain.low[i] + 2.0 * margin
    };
    let box_volume = side(0) * side(1) * side(2);
    assert!((volume - box_volume).abs() < 1e-9 * box_volume, "{volume} of {box_volume}");
    assert!((0..store.point_bound()).all(|v| store.is_free(v)), "a vertex was not given back");
}

#[test]
fn the_store_is_whole_after_any_number_of_threads() {
    let domain = balls();
    for threads in [1, 2, 3, 8] {
        let pool = Pool::new(threads).unwrap();
        for (backend, size) in [(Backend::Stealing, 1.5), (Backend::Rayon, 3.0)] {
            let wish = Wish { size: Some(size), ..Wish::default() };
            let (store, limits, counts) = mesh(&domain, wish, &pool, backend).unwrap();
            check(&store, &domain, &limits);
            assert_eq!(counts.lost, 0);
            assert_eq!(counts.crowded, 0);
            let done = counts.surface_points + counts.inner_points;
            assert_eq!(counts.attempts, done + counts.conflicts + counts.stale + counts.put_off);
        }
    }
}

#[test]
fn one_thread_does_the_same_twice() {
    let (domain, pool) = (balls(), Pool::new(1).unwrap());
    let once = || {
        let (store, limits, counts) = mesh(&domain, Wish::default(), &pool, Backend::default()).unwrap();
        (Extracted::new(&store, &domain, &limits).mesh, counts)
    };
    let (first, second) = (once(), once());
    assert_eq!(first, second);
    assert_eq!(first.1.conflicts, 0);
}

#[test]
fn a_store_without_room_grows() {
    // 65536 tetrahedra at first: this needs more.
    let domain = balls();
    for threads in [1, 3] {
        let wish = Wish { size: Some(0.45), ..Wish::default() };
        let (store, limits, _) = mesh(&domain, wish, &Pool::new(threads).unwrap(), Backend::default()).unwrap();
        assert!(store.tet_bound() > 1 << 16);
        check(&store, &domain, &limits);
    }
}

#[test]
fn the_heaviest_label_wins_and_the_lower_at_a_tie() {
    let frame = Frame::of_spacings([1.0, 2.0, 1.0]).unwrap();
    let image = Image::new([3, 1, 1], frame, Kind::Int16, [-4.0, 6.0, 0.0]);
    let domain = Domain::new(&image, None).unwrap();
    let reference = |x: f64, y: f64| domain.reference(domain.region([x, y, 0.0]));
    assert_eq!([reference(0.0, 0.0), reference(0.4, 0.0), reference(0.6, 0.0), reference(1.4, 0.0)], [-4, -4, 6, 6]);
    assert_eq!([reference(1.6, 0.0), reference(-0.4, 0.0), reference(-0.6, 0.0)], [0, -4, 0]);
    assert_eq!(
        [reference(0.0, 0.9), reference(0.0, 1.1), reference(0.0, f64::NAN), reference(1e30, 0.0)],
        [-4, 0, 0, 0]
    );
    let tie = domain.region([0.5, 0.0, 0.0]);
    assert_eq!(tie, domain.region([0.0; 3]).min(domain.region([1.0, 0.0, 0.0])));
    // From far away, and the same from either end.
    let [near, far] = [([1.0, 0.0, 0.0], domain.region([1.0, 0.0, 0.0])), ([1e20, 0.0, 0.0], 0)];
    let crossing = domain.crossing(near, far);
    assert!((crossing[0] - 1.5).abs() < 1e-3, "{crossing:?}");
    assert_eq!(crossing, domain.crossing(far, near));
}

#[test]
fn a_grey_image_is_linear_between_voxels() {
    let image = Image::new([2, 1, 1], Frame::of_spacings([1.0; 3]).unwrap(), Kind::Double, [10.0, 0.0]);
    let domain = Domain::new(&image, Some(2.5)).unwrap();
    let crossing = domain.crossing(([0.0; 3], 1), ([1.0, 0.0, 0.0], 0));
    assert!((crossing[0] - 0.75).abs() < 1e-3);
    // At the border half a voxel.
    let border = domain.crossing(([0.0; 3], 1), ([-1.0, 0.0, 0.0], 0));
    assert!((border[0] + 0.5).abs() < 1e-3);
}
