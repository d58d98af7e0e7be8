use super::*;
use proptest::prelude::*;

/// Area, and whether each inner edge is shared by two triangles that know each other.
fn checked(points: &[Point], region: &Region) -> f64 {
    let mut area = 0.0;
    for (t, corners) in region.triangles.iter().enumerate() {
        let [a, b, c] = corners.map(|v| points[v as usize]);
        assert!(turn(a, b, c) > 0.0);
        area += 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]));
        for i in 0..3 {
            let u = region.beside[t][i];
            if u == NONE {
                assert_ne!(region.fixed[t][i], NONE, "an open edge without a segment");
                continue;
            }
            let j = region.beside[u as usize].iter().position(|&x| x == t as u32).expect("knows its neighbour");
            assert_eq!(region.triangles[u as usize][(j + 1) % 3], corners[(i + 2) % 3]);
            assert_eq!(region.triangles[u as usize][(j + 2) % 3], corners[(i + 1) % 3]);
            assert_eq!(region.fixed[u as usize][j], region.fixed[t][i]);
            if region.fixed[t][i] == NONE {
                let d = region.triangles[u as usize][j];
                assert!(in_circle(a, b, c, points[d as usize]) <= 0.0, "not Delaunay");
            }
        }
    }
    area
}

/// Loops one after another.
fn bounded(points: &[Point], loops: &[std::ops::Range<u32>]) -> Result<Region, Conflict> {
    let mut plane = Plane::new(points)?;
    let mut segment = 0;
    for range in loops {
        let count = range.end - range.start;
        for k in 0..count {
            let ends = [range.start + k, range.start + (k + 1) % count];
            assert_eq!(plane.constrain(ends, segment)?, None);
            segment += 1;
        }
    }
    Ok(plane.region(|_| true))
}

fn area_of(loop_: &[Point]) -> f64 {
    let next = loop_.iter().cycle().skip(1);
    0.5 * loop_.iter().zip(next).map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum::<f64>()
}

#[test]
fn points_on_one_circle_and_on_a_grid() {
    let circle: Vec<Point> = (0..60).map(|k| (f64::from(k) * std::f64::consts::TAU / 60.0).sin_cos().into()).collect();
    let round = bounded(&circle, std::slice::from_ref(&(0..60))).unwrap();
    assert_eq!(round.triangles.len(), 58);
    assert!((checked(&circle, &round) - area_of(&circle).abs()).abs() < 1e-12);
    let grid: Vec<Point> = (0..81).map(|k| [f64::from(k % 9), f64::from(k / 9)]).collect();
    let mut plane = Plane::new(&grid).unwrap();
    // The border in pieces: a longer one would run through points.
    let border: Vec<u32> = (0..8)
        .chain((0..8).map(|k| 8 + 9 * k))
        .chain((1..9).rev().map(|k| 72 + k))
        .chain((1..9).rev().map(|k| 9 * k))
        .collect();
    for (k, &from) in border.iter().enumerate() {
        plane.constrain([from, border[(k + 1) % border.len()]], k as u32).unwrap();
    }
    let region = plane.region(|_| true);
    assert_eq!(region.triangles.len(), 128);
    assert_eq!(checked(&grid, &region), 64.0);
}

#[test]
fn conflicts_are_told() {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    assert_eq!(Plane::new(&[square[0], square[1], square[0]]).unwrap_err(), Conflict::Equal(0, 2));
    assert_eq!(Plane::new(&[[f64::NAN, 0.0]]).unwrap_err(), Conflict::Lost);
    let mut plane = Plane::new(&square).unwrap();
    plane.constrain([0, 2], 7).unwrap();
    assert_eq!(plane.constrain([1, 3], 8), Err(Conflict::Cross(8, 7)));
    assert_eq!(plane.constrain([2, 0], 9), Ok(Some(7)));
    let row = [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [0.2, 0.7]];
    let mut plane = Plane::new(&row).unwrap();
    assert_eq!(plane.constrain([0, 2], 3), Err(Conflict::Touch { point: 1, segment: 3 }));
    assert!(Plane::new(&[]).is_ok());
}

#[test]
fn each_point_comes_after_the_one_that_it_is_looked_for_from() {
    for count in [0, 1, 2, 3, 8, 13, 100] {
        let order: Vec<_> = super::bisecting(count).collect();
        let place = |number: u32| order.iter().position(|o| o.0 == number).expect("all are there");
        assert_eq!(order.len(), count);
        assert!(order.iter().all(|&(number, before)| number == 0 || place(before) < place(number)));
    }
}

#[test]
fn a_slit_and_a_point_inside_stay() {
    let points = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [1.0, 2.0], [3.0, 2.0], [2.0, 1.0]];
    let mut plane = Plane::new(&points).unwrap();
    for k in 0..4 {
        plane.constrain([k, (k + 1) % 4], k).unwrap();
    }
    plane.constrain([4, 5], 9).unwrap();
    let region = plane.region(|segment| segment != 9);
    assert_eq!(checked(&points, &region), 16.0);
    assert_eq!(region.fixed.iter().flatten().filter(|&&s| s == 9).count(), 2);
    assert!(region.triangles.iter().flatten().any(|&v| v == 6));
}

/// A polygon about the origin, star-shaped: radii at equal angles; rounded to a coarse lattice half of the time.
fn star(radii: &[f64], from: f64, at: Point, is_coarse: bool) -> Vec<Point> {
    let count = radii.len() as f64;
    let place = |x: f64| if is_coarse { (64.0 * x).round() / 64.0 } else { x };
    let corner = |(k, r): (usize, &f64)| {
        let (sin, cos) = (k as f64 * std::f64::consts::TAU / count).sin_cos();
        [place(at[0] + (from + r) * cos), place(at[1] + (from + r) * sin)]
    };
    radii.iter().enumerate().map(corner).collect()
}

proptest! {
    #[test]
    fn stars_with_holes(
        outer in prop::collection::vec(0.0..4.0f64, 3..80),
        holes in prop::collection::vec(prop::collection::vec(0.0..0.05f64, 3..12), 0..4),
        offset in -1e3..1e3f64, is_coarse in any::<bool>(), stretch in 1e-6..1e6f64,
    ) {
        let centre = [offset, -0.7 * offset];
        let mut points = star(&outer, 4.0, centre, is_coarse);
        let mut expected = area_of(&points);
        let mut loops: Vec<_> = std::iter::once(0..points.len() as u32).collect();
        for (k, hole) in holes.iter().enumerate() {
            let (sin, cos) = (k as f64).sin_cos();
            let first = points.len() as u32;
            let hole = star(hole, 0.1, [centre[0] + 0.6 * cos, centre[1] + 0.6 * sin], false);
            expected -= area_of(&hole);
            points.extend(hole);
            loops.push(first..points.len() as u32);
        }
        points.iter_mut().for_each(|p| p[0] *= stretch);
        if let Ok(region) = bounded(&points, &loops) {
            let area = checked(&points, &region) / stretch;
            prop_assert!((area - expected).abs() < 1e-9 * (1.0 + offset.abs()) * 100.0, "{area} {expected}");
            // A triangulation of a polygon with holes has so many triangles.
            prop_assert_eq!(region.triangles.len() + 2, points.len() + 2 * holes.len());
        } else {
            // Three corners of so coarse a lattice may be in a row, or a triangle about no centre.
            prop_assert!(is_coarse || outer.len() < 5);
        }
    }

    #[test]
    fn any_segments_end_in_an_edge_or_in_a_conflict(
        lattice in prop::collection::vec((0..12u32, 0..12u32), 3..60), ends in prop::collection::vec((0..60usize, 0..60usize), 1..60),
    ) {
        let mut points: Vec<Point> = lattice.iter().map(|&(x, y)| [f64::from(x), f64::from(y)]).collect();
        points.sort_by(|a, b| a.partial_cmp(b).unwrap());
        points.dedup();
        let mut plane = Plane::new(&points).unwrap();
        let mut kept: Vec<[usize; 2]> = Vec::new();
        let crosses = |p: [usize; 2], q: [usize; 2]| {
            let [a, b, c, d] = [p[0], p[1], q[0], q[1]].map(|v| points[v]);
            turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0
        };
        let holds_point = |p: [usize; 2]| (0..points.len()).any(|v| {
            let [a, b, c] = [p[0], p[1], v].map(|v| points[v]);
            v != p[0] && v != p[1] && turn(a, b, c) == 0.0
                && (a[0] - c[0]) * (b[0] - c[0]) + (a[1] - c[1]) * (b[1] - c[1]) < 0.0
        });
        for (k, (p, q)) in ends.into_iter().enumerate() {
            let ends = [p % points.len(), q % points.len()];
            let is_free = ends[0] != ends[1] && !holds_point(ends) && kept.iter().all(|&other| !crosses(ends, other));
            let done = plane.constrain(ends.map(|v| v as u32), k as u32);
            prop_assert_eq!(done.is_ok(), is_free, "{:?} {:?}", ends, done);
            if is_free {
                kept.push(ends);
            }
        }
        for ends in kept {
            let [a, b] = ends.map(|v| v as u32 + 4);
            prop_assert!(plane.edge(a, b).is_some());
        }
    }
}

/// Products of these are no doubles any more: signs of determinants contradict each other, and edges are flipped to and fro.
#[test]
fn coordinates_that_have_no_exact_predicates_end_all_the_same() {
    let mut random = 7u64;
    for exponent in [-1, -40, -60, -79, -81, -90, -120, -150, -160] {
        for _ in 0..40 {
            let points: Vec<Point> = (0..40)
                .map(|_| {
                    [0, 1].map(|_| {
                        random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                        ((random >> 33) as f64 / (1u64 << 31) as f64)
                            * 10f64.powi(if random & 1 << 40 == 0 { 0 } else { exponent })
                    })
                })
                .collect();
            if let Ok(mut plane) = Plane::new(&points) {
                let _ = plane.constrain([0, 20], 1);
            }
        }
    }
}
