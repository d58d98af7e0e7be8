use super::triangles::{Triangle, Triangles};
use super::*;
use crate::adapt::core::context::Context;
use crate::adapt::core::fill::{self, Filled};
use crate::adapt::core::ids::VertexId;
use crate::geometry::discrete::DEFAULT_RIDGE_ANGLE;
use crate::geometry::{Discrete, Model};
use crate::mesh::triangle_pair::crossing;
use crate::mesh::{TetMesh, samples};
use crate::metric::{Background, Source, Sym3};
use crate::tasks::Team;

/// What is found of a mesh for a uniform size.
fn with<T>(mesh: &TetMesh, size: f64, find: impl FnOnce(&Context) -> T) -> T {
    let (model, place) = Discrete::from_mesh(Team::alone(), mesh, DEFAULT_RIDGE_ANGLE).expect("it has a surface");
    let logs = vec![Sym3::IDENTITY.times(-2.0 * size.ln()); mesh.vertices.len()];
    let background = Background::new(mesh.vertices.clone(), mesh.tets.nodes.clone(), logs);
    let (model, source) = (Model::Discrete(model), Source::Background(background));
    let Filled { store, .. } = fill::fill(Team::alone(), mesh, &place, &source).expect("it is valid");
    find(&Context::new(store, &source, &model))
}

/// The boxes of the zone, and the triangles that are in it.
fn zone(mesh: &TetMesh, size: f64) -> (usize, usize) {
    let voids = with(mesh, size, |context| Voids::of(Team::alone(), context));
    let Some(narrow) = voids.narrow else { return (0, 0) };
    assert!(narrow.meets(&[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.0, 1.0]]));
    assert!(!narrow.meets(&[[0.0; 3], [0.1, 0.0, 0.0], [0.1, 0.0, 0.1]]));
    let triangles = narrow.triangles.into_inner().expect("nobody failed");
    (narrow.boxes.len(), triangles.len())
}

#[test]
fn walls_that_are_nearer_than_their_chords_rise() {
    let mesh = samples::rod_in_bushing(0.01, 48, 6);
    let (boxes, triangles) = zone(&mesh, 0.5);
    // Both walls: 48 · 6 quadrilaterals each.
    assert_eq!(boxes, 2 * 2 * 48 * 6);
    assert!(triangles >= boxes);
    // As fine as it is they stay where they are; a wide gap is none; and planes do not move.
    assert_eq!(zone(&samples::rod_in_bushing(0.3, 48, 6), 0.13), (0, 0));
    assert_eq!(zone(&samples::cube(4), 1.0), (0, 0));
}

#[test]
fn voids_that_are_to_come_are_known_before() {
    let come = |mesh: &TetMesh, size: f64| with(mesh, size, |context| !Voids::are_none_to_come(Team::alone(), context));
    // Chords of 0.13 rise by a thousandth; those of 2 reach across. None is narrow yet.
    let wide = samples::rod_in_bushing(0.3, 48, 6);
    assert!(!come(&wide, 0.13) && come(&wide, 2.0));
    assert_eq!(zone(&wide, 2.0), (0, 0));
    assert!(come(&samples::rod_in_bushing(0.01, 48, 6), 0.5));
    assert!(!come(&samples::cube(4), 1.0));
}

#[test]
fn triangles_are_found_as_they_come_and_go() {
    let mut seed = 3u64;
    let mut next = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut all: Vec<Triangle> = Vec::new();
    let mut triangles = Triangles::default();
    for i in 0..600u32 {
        // Of sizes from a thousandth to one.
        let (size, at) = (10f64.powf(-3.0 * next()), [0; 3].map(|_| next()));
        let corners = [0; 3].map(|_| at.map(|x| x + size * next()));
        let vertices = [3 * i, 3 * i + 2, 3 * i + 1].map(VertexId);
        all.push(Triangle { vertices, corners });
        triangles.insert(all[all.len() - 1]);
        if i % 3 == 2 {
            let gone = all.swap_remove((next() * all.len() as f64) as usize);
            triangles.remove(&gone.key());
            assert!(triangles.get(&gone.key()).is_none());
        }
    }
    assert_eq!(triangles.len(), all.len());
    let mut met = 0;
    for triangle in &all {
        assert_eq!(triangles.get(&triangle.key()).map(|t| t.corners), Some(triangle.corners));
        let others = all.iter().filter(|other| other.key() != triangle.key());
        let Triangle { vertices, corners } = triangle;
        let is_met = |other: &&Triangle| crossing((vertices, corners), (&other.vertices, &other.corners)).is_some();
        let expected = others.filter(is_met).count();
        assert_eq!(triangles.crossings(&[*triangle], |key| *key == triangle.key()), expected);
        met += expected;
    }
    assert!(met > 20, "{met}");
}

/// Vertex 5 is the last of one triangle and the first of the other; by its number it is the middle one, and the last.
#[test]
fn neighbours_at_a_vertex_do_not_cross_whatever_their_numbers() {
    let vertex = [-0.496_075_338_411_882_45, 0.037_514_438_594_134_16, 0.649_085_880_723_569_3];
    let one = Triangle {
        vertices: [4, 6, 5].map(VertexId),
        corners: [
            [-0.470_986_509_389_844_9, 0.100_706_578_088_012_87, 0.594_250_764_416_368_3],
            [-0.499_250_617_121_759_17, 0.016_418_759_675_302_704, 0.653_475_079_713_031_1],
            vertex,
        ],
    };
    let other = Triangle {
        vertices: [5, 2, 3].map(VertexId),
        corners: [
            vertex,
            [-0.499_980_233_734_038_77, -0.002_667_529_773_431_284, 0.679_799_988_667_067_9],
            [-0.496_052_664_404_195, 0.037_622_220_688_041_13, 0.659_864_998_418_824_7],
        ],
    };
    let mut triangles = Triangles::default();
    triangles.insert(other);
    assert_eq!(triangles.crossings(&[one], |_| false), 0);
}
