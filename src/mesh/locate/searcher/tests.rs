use super::super::super::samples::cube;
use super::*;

/// The answer by trying all tetrahedra.
fn by_all(locator: &Locator, p: Vec3) -> (u32, [f64; 4], f64) {
    let tets = 0..locator.tets().len() as u32;
    let held = tets.clone().find_map(|tet| locator.holds(tet, p));
    let nearest = || {
        let all = tets.map(|tet| locator.nearest_in(tet, p));
        all.reduce(|best, found| if found.distance < best.distance { found } else { best }).unwrap()
    };
    let found = held.unwrap_or_else(nearest);
    // A vertex has all the weight.
    let corner = locator.corners(found.tet).iter().position(|&x| x == p);
    let weights = corner.map_or(found.weights, |at| std::array::from_fn(|i| if i == at { 1.0 } else { 0.0 }));
    (found.tet, weights, found.distance)
}

/// Points on vertices, edges and faces, some of them off by rounding, and around.
fn points(locator: &Locator) -> Vec<Vec3> {
    let mut found = vec![[0.5; 3], [-0.3, 0.4, 0.5], [1.5, 1.25, -0.25], [0.31, 0.57, 0.73]];
    let mix = |x: &[Vec3], w: &[f64]| x.iter().zip(w).fold([0.0; 3], |sum, (&x, &w)| add(sum, scale(x, w)));
    for tet in (0..locator.tets().len() as u32).step_by(3) {
        let x = locator.corners(tet);
        found.push(x[tet as usize % 4]);
        found.push(mix(&x[..2], &[0.5, 0.5]));
        found.push(mix(&x[1..], &[0.2, 0.5, 0.3]));
        found.push(mix(&x, &[1e-13, 0.7, 0.3, -1e-13]));
        found.push(mix(&x, &[0.4, 0.3, 0.2, 0.1]));
        found.push(mix(&x, &[1.2, -0.1, -0.1, 0.0]));
    }
    found
}

fn check(locator: &Locator) {
    let size = Size::of_vertices(locator.vertices());
    let mut walking = Searcher::new(locator, &size);
    let (mut held, mut outside) = (0, 0);
    for (i, p) in points(locator).into_iter().enumerate() {
        let expected = by_all(locator, p);
        let mut elsewhere = Searcher::new(locator, &size);
        elsewhere.hint = (i * 7919 % locator.tets().len()) as u32;
        for searcher in [&mut walking, &mut elsewhere] {
            let found = searcher.locate(p);
            assert_eq!((found.tet, found.weights, found.distance), expected, "{i} {p:?}");
        }
        held += usize::from(expected.2 == 0.0);
        outside += usize::from(expected.2 > 1e-3);
    }
    assert!(held > 500 && outside > 20, "{held} {outside}");
}

/// All tetrahedra of the cube but some.
fn without(n: u32, is_missing: impl Fn(Vec3) -> bool) -> TetMesh {
    let mut mesh = cube(n);
    let middle = |tet: &[u32; 4]| tet.iter().fold([0.0; 3], |s, &v| add(s, scale(mesh.vertices[v as usize], 0.25)));
    mesh.tets.nodes = mesh.tets.nodes.iter().copied().filter(|tet| !is_missing(middle(tet))).collect();
    mesh
}

#[test]
fn the_lowest_of_all_is_found_from_wherever_it_begins() {
    let whole = cube(6);
    check(&Locator::new(whole.vertices, whole.tets.nodes));
}

#[test]
fn around_a_hole_and_where_parts_touch_at_an_edge() {
    let hollow = without(5, |p| p.iter().all(|&x| (0.2..0.8).contains(&x)));
    check(&Locator::new(hollow.vertices, hollow.tets.nodes));
    // Like a chess board: the parts meet at edges and at a vertex alone.
    let board = without(6, |p| p.iter().filter(|&&x| x < 0.5).count() % 2 == 1);
    check(&Locator::new(board.vertices, board.tets.nodes));
}

#[test]
fn in_thin_layers_and_far_from_the_origin() {
    let mut layers = cube(6);
    for p in &mut layers.vertices {
        *p = [0.8 * p[0] - 0.6 * p[1], 0.6 * p[0] + 0.8 * p[1] + 3e-6 * p[2] * p[2], 1e-5 * p[2] + 0.3 * p[0]];
    }
    check(&Locator::new(layers.vertices.clone(), layers.tets.nodes.clone()));
    for p in &mut layers.vertices {
        *p = add(scale(*p, 50.0), [1e4, -2e3, 3e3]);
    }
    check(&Locator::new(layers.vertices, layers.tets.nodes));
}

#[test]
fn flat_tetrahedra_hold_nothing() {
    let square = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let flat = Locator::new(square, vec![[0, 1, 2, 3]]);
    let found = Searcher::new(&flat, &Size::of_vertices(flat.vertices())).locate([0.5, 0.25, 2.0]);
    assert!((found.distance - 2.0).abs() < 1e-14);
    assert_eq!(Searcher::new(&flat, &Size::of_vertices(flat.vertices())).locate([f64::NAN; 3]).tet, 0);
}
