use super::*;
use crate::geometry::Evaluate;
use crate::mesh::vector::{distance, norm};
use std::path::Path;

fn model(name: &str) -> OcctModel {
    OcctModel::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("geometry").join(name)).expect("a model of our own")
}

fn of(name: &str) -> (OcctModel, Surface) {
    let model = model(name);
    let options = Options::new(model.topology().diagonal());
    let surface = triangulate(Team::alone(), &model, &options, &|| true).expect("nobody stops it");
    (model, surface)
}

/// Closed, without crossings, every face and edge there, each point on its entity; the volumes within a share.
fn check(name: &str, share: f64) -> Surface {
    let (model, surface) = of(name);
    let found = report(&model, &surface);
    assert_eq!([found.bad_edges, found.open_edges, found.lost_pieces, found.flat], [0; 4], "{name}");
    assert!(surface.crossings.is_empty() && surface.missing.is_empty() && surface.rough.is_empty(), "{name}");
    for [volume, exact] in &found.volumes {
        assert!((volume / exact - 1.0).abs() < share, "{name}: {volume} {exact}");
    }
    let topology = model.topology();
    let near = 1e-9 * topology.diagonal() + 2.0 * topology.tolerance;
    let mut on = model.evaluator();
    for (point, place) in surface.points.iter().zip(&surface.places) {
        let there = match *place {
            Place::Vertex(v) => topology.vertices[v as usize].point,
            Place::Edge(e, t) => on.edge_frame(e, t).point,
            Place::Face(f, uv) => on.face_frame(f, uv).point,
        };
        assert!(distance(*point, there) <= near, "{name}: {place:?}");
    }
    surface
}

/// Points less edges plus triangles, of the points that triangles have.
fn euler(surface: &Surface) -> i64 {
    let mut points: Vec<u32> = surface.triangles.iter().flatten().copied().collect();
    points.sort_unstable();
    points.dedup();
    points.len() as i64 - surface.triangles.len() as i64 / 2
}

#[test]
fn a_sphere_has_two_poles_and_a_seam() {
    let surface = check("sphere.step", 0.12);
    assert_eq!(euler(&surface), 2);
    // Both poles are corners of triangles, on several sides.
    for pole in 0..2 {
        let at = |t: &&[u32; 3]| t.contains(&pole);
        assert!(surface.triangles.iter().filter(at).count() >= 5);
    }
    assert_eq!(surface.sides, [[Some(0), None]]);
}

#[test]
fn a_torus_has_two_seams() {
    assert_eq!(euler(&check("torus.step", 0.12)), 0);
}

#[test]
fn an_apex_and_closed_cylinders() {
    for (name, characteristic) in
        [("cone.step", 2), ("cylinder.step", 2), ("zoo/capsule.step", 2), ("zoo/partial-torus.step", 2)]
    {
        assert_eq!(euler(&check(name, 0.12)), characteristic, "{name}");
    }
}

#[test]
fn solids_share_the_faces_between_them() {
    let surface = check("two-materials.step", 1e-9);
    let both = surface.sides.iter().filter(|sides| sides[0].is_some() && sides[1].is_some()).count();
    assert_eq!(both, 1);
    check("zoo/three-regions.step", 0.1);
}

#[test]
fn splines_threads_of_edges_and_tiny_faces() {
    for name in [
        "wing.step",
        "zoo/onera-m6.step",
        "zoo/screw.step",
        "zoo/cusps.step",
        "zoo/near-tangent.step",
        "zoo/sliver-steps.step",
    ] {
        check(name, 0.1);
    }
}

/// The side of its pylon is a strip whose lines of u and v meet at 13 degrees: in an upright plane its triangles folded in space.
#[test]
fn parameters_that_are_skew_do_not_fold() {
    check("aircraft/transport-half.step", 0.1);
}

/// Bridges of 0.0002 beside a round hole: its chords were off their arcs by fifty times as much.
#[test]
fn chords_are_nearer_to_their_arcs_than_to_what_lies_behind() {
    let surface = check("zoo/bridged-plate.step", 0.05);
    assert!(proximity::too_near(Team::alone(), &surface, &surface.off, &|| true).is_empty());
    // What is no nearer than its neighbours stays as it is.
    assert!(surface.triangles.len() < 4000, "{}", surface.triangles.len());
}

#[test]
fn bodies_that_touch_in_an_edge_are_divided_alike() {
    let surface = check("zoo/knife-edge.brep", 1e-9);
    let mut twins = 0;
    for chain in &surface.chains {
        for other in surface.chains.iter().filter(|other| *other != chain && other.len() == chain.len()) {
            let at = |p: &u32| surface.points[*p as usize];
            twins += usize::from(chain.iter().all(|p| other.iter().any(|q| at(p) == at(q))));
        }
    }
    assert!(twins >= 2);
}

#[test]
fn who_says_no_gets_none() {
    let model = model("sphere.step");
    let options = Options::new(model.topology().diagonal());
    assert!(triangulate(Team::alone(), &model, &options, &|| false).is_none());
}

#[test]
fn finer_is_finer() {
    let model = model("sphere.step");
    let mut options = Options::new(model.topology().diagonal());
    let of = |options: &Options| triangulate(Team::alone(), &model, options, &|| true).expect("nobody stops it");
    let coarse = of(&options).triangles.len();
    options.segments = 6.0;
    let surface = of(&options);
    assert!(surface.triangles.len() > 5 * coarse);
    let found = report(&model, &surface);
    assert!((found.volumes[0][0] / found.volumes[0][1] - 1.0).abs() < 0.012, "{:?}", found.volumes);
    let normal = |t: &[u32; 3]| {
        crate::mesh::vector::area2(
            surface.points[t[0] as usize],
            surface.points[t[1] as usize],
            surface.points[t[2] as usize],
        )
    };
    assert!(surface.triangles.iter().all(|t| norm(normal(t)) > 0.0));
}

#[test]
fn borders_alone_are_closed_and_look_the_right_way() {
    for name in ["cube.step", "filleted-block.step", "zoo/perforated-plate.step"] {
        let model = model(name);
        let options = Options::new(model.topology().diagonal());
        let twins = Twins::of(&model);
        let points = Points::new(&model, edges::divided(&model, &options, &twins), twins);
        let mut on = model.evaluator();
        for face in 0..model.topology().faces.len() as u32 {
            let outline = outline::outline(&model, &mut on, &points, face, options.segments).expect("a border");
            let own = Patch::new(&mut on, face, &outline, &points).expect("a sound border");
            let area = |patch: &Patch| {
                patch.triangles.iter().fold([0.0; 3], |sum, t| {
                    let [p, q, r] = t.map(|c| patch.at[c as usize]);
                    crate::mesh::vector::add(sum, crate::mesh::vector::area2(p, q, r))
                })
            };
            // The area of a border as a vector is the same whatever lies between.
            for other in [rough::patch(&mut on, face, &outline, &points), rough::cut_off(&outline, &points)] {
                let other = other.expect("triangles");
                assert!(
                    distance(area(&own), area(&other)) < 1e-9 * norm(area(&own)).max(options.greatest),
                    "{name} {face}"
                );
            }
        }
    }
}
