use super::*;
use crate::mesh::adjacency::FACES;
use crate::mesh::vector::{add, lerp, scale, volume6};
use proptest::prelude::*;

fn point(x: &[Vec3; 4], weights: Lambda) -> Vec3 {
    x.iter().zip(weights).fold([0.0; 3], |sum, (&p, w)| add(sum, scale(p, w)))
}

fn turned(mut x: [Vec3; 4]) -> [Vec3; 4] {
    if volume6(x[0], x[1], x[2], x[3]) < 0.0 {
        x.swap(0, 1);
    }
    x
}

fn tet(c: [f64; 12]) -> [Vec3; 4] {
    turned([[c[0], c[1], c[2]], [c[3], c[4], c[5]], [c[6], c[7], c[8]], [c[9], c[10], c[11]]])
}

/// Volume by cutting polygons: each face of either is cut by the planes of the other and made a pyramid over a point.
fn volume_by_faces(x: &[Vec3; 4], y: &[Vec3; 4]) -> f64 {
    let mut six = 0.0;
    for (of, by) in [(x, y), (y, x)] {
        for face in FACES {
            let mut polygon: Vec<Vec3> = face.iter().map(|&i| of[i]).collect();
            for plane in FACES {
                let [p, q, r] = plane.map(|i| by[i]);
                let height = |v: Vec3| -volume6(p, q, r, v);
                let mut kept = Vec::new();
                for (i, &v) in polygon.iter().enumerate() {
                    let w = polygon[(i + 1) % polygon.len()];
                    let (at_v, at_w) = (height(v), height(w));
                    if at_v >= 0.0 {
                        kept.push(v);
                    }
                    if (at_v < 0.0) != (at_w < 0.0) {
                        kept.push(lerp(v, w, at_v / (at_v - at_w)));
                    }
                }
                polygon = kept;
                if polygon.is_empty() {
                    break;
                }
            }
            for i in 1..polygon.len().saturating_sub(1) {
                six -= volume6(polygon[0], polygon[i], polygon[i + 1], x[0]);
            }
        }
    }
    six / 6.0
}

fn volume(x: &[Vec3; 4]) -> f64 {
    volume6(x[0], x[1], x[2], x[3]) / 6.0
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn the_volume_is_that_of_the_polygons(
        x in prop::array::uniform12(-1.0..1.0f64),
        y in prop::array::uniform12(-1.0..1.0f64),
        flat in 0.001..1.0f64,
    ) {
        let thin = |x: [Vec3; 4]| x.map(|p| [p[0], p[1], flat * p[2]]);
        let (x, y) = (thin(tet(x)), thin(tet(y)));
        let (Some(planes), true) = (Planes::of(y), volume(&x) > 0.0) else { return Ok(()) };
        let piece = planes.clip(&x);
        let expected = volume_by_faces(&x, &y);
        prop_assert!((piece.share * volume(&x) - expected).abs() < 1e-13 * flat, "{} {expected}", piece.share * volume(&x));
        if piece.share > 1e-9 {
            // The piece of y in x has the same centroid.
            let Some(other) = Planes::of(x) else { return Ok(()) };
            let back = other.clip(&y);
            let (p, q) = (point(&y, piece.centroid()), point(&x, back.centroid()));
            prop_assert!((0..3).all(|i| (p[i] - q[i]).abs() < 1e-9), "{p:?} {q:?}");
        }
    }

    #[test]
    fn pieces_of_the_parts_sum_up(
        x in prop::array::uniform12(-1.0..1.0f64),
        y in prop::array::uniform12(-1.0..1.0f64),
        w in prop::array::uniform4(0.01..1.0f64),
    ) {
        let (x, y) = (tet(x), tet(y));
        prop_assume!(volume(&x) > 1e-4 && volume(&y) > 1e-4);
        let Some(planes) = Planes::of(y) else { return Ok(()) };
        let whole = planes.clip(&x);
        // Four tetrahedra about a point inside x.
        let sum: f64 = w.iter().sum();
        let middle = point(&x, w.map(|w| w / sum));
        let (mut parts, mut beyond) = (0.0, 0);
        for i in 0..4 {
            let mut part = x;
            part[i] = middle;
            let piece = planes.clip(&part);
            parts += piece.share * volume(&part);
            beyond |= piece.beyond;
        }
        prop_assert!((parts - whole.share * volume(&x)).abs() < 1e-13);
        prop_assert!(whole.share < 1e-9 || beyond == whole.beyond, "{beyond:b} {:b}", whole.beyond);
        // And four about one inside y.
        let middle = point(&y, w.map(|w| w / sum));
        let mut parts = 0.0;
        for i in 0..4 {
            let mut part = y;
            part[i] = middle;
            parts += Planes::of(part).expect("it has a volume").clip(&x).share;
        }
        prop_assert!((parts - whole.share).abs() < 1e-11, "{parts} {}", whole.share);
    }
}

const UNIT: [Vec3; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn shifted(by: Vec3) -> [Vec3; 4] {
    UNIT.map(|p| add(p, by))
}

#[test]
fn the_same_tetrahedron_is_whole_and_ends_there() {
    for corners in [[0, 1, 2, 3], [1, 2, 0, 3], [3, 2, 1, 0]] {
        let piece = Planes::of(UNIT).unwrap().clip(&corners.map(|i| UNIT[i]));
        assert_eq!((piece.share, piece.beyond, piece.centroid()), (1.0, 0, [0.25; 4]));
    }
    // Also at an odd place, where barycentric coordinates are rounded.
    let odd =
        UNIT.map(|p| [0.3 + p[0] / 7.0 + p[1] / 30.0, 1.0 / 3.0 + p[1] / 11.0 - p[0] / 40.0, 17.1 + p[2] / 1300.0]);
    let piece = Planes::of(odd).unwrap().clip(&odd);
    assert!((piece.share - 1.0).abs() < 1e-15 && piece.beyond == 0, "{piece:?}");
}

#[test]
fn what_only_touches_has_no_share() {
    let planes = Planes::of(UNIT).unwrap();
    // A corner, an edge, the face x + y + z = 1, and two faces of x = 0 from either side.
    let mirrored = turned(UNIT.map(|p| [1.0 - p[0], 1.0 - p[1], 1.0 - p[2]].map(|x| x * 1.0)));
    let across = turned(UNIT.map(|p| [-p[0], p[1], p[2]]));
    let face = turned([UNIT[1], UNIT[2], UNIT[3], [1.0; 3]]);
    for other in [shifted([1.0, 0.0, 0.0]), shifted([0.0, 0.0, -1.0]), across, face] {
        let piece = planes.clip(&other);
        assert_eq!((piece.share, piece.beyond), (0.0, 0), "{other:?}");
    }
    assert!(planes.clip(&mirrored).share <= 1.0);
}

#[test]
fn a_half_goes_on_beyond_the_face() {
    let planes = Planes::of(UNIT).unwrap();
    // Half of a box's part across x = 0: symmetric about that plane.
    let x = turned(
        [[-1.0, 0.1, 0.1], [1.0, 0.1, 0.1], [0.0, 0.3, 0.1], [0.0, 0.1, 0.3]].map(|p: Vec3| [0.2 * p[0], p[1], p[2]]),
    );
    let piece = planes.clip(&x);
    assert!((piece.share - 0.5).abs() < 1e-14, "{piece:?}");
    assert_eq!(piece.beyond, 0b10);
}

#[test]
fn flat_ones_have_no_planes() {
    assert!(Planes::of([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]]).is_none());
    assert!(Planes::of([[0.5; 3]; 4]).is_none());
    let flat = [[0.1, 0.1, 0.1], [0.2, 0.1, 0.1], [0.1, 0.2, 0.1], [5.0, 5.0, 0.1]];
    let piece = Planes::of(UNIT).unwrap().clip(&flat);
    assert!(piece.share <= 1.0 && piece.share >= 0.0);
}
