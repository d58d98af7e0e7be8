//! The apex of a cone, where the surface has no normal.

use crate::common::adapting::Workplace;
use geo_adapt::mesh::io;
use geo_adapt::mesh::vector::{Vec3, sub};
use geo_adapt::metric::Sym3;

/// `bootstrap` makes a fine ring of triangles about the apex. Its vertices can only go at the price of a bad tetrahedron.
#[test]
fn the_fine_ring_about_an_apex_goes_where_sizes_are_coarse() {
    let work = Workplace::new();
    let (model, start) = work.coarse_start("cone.step");
    // The length of the shortest edge at the apex, in the metric there.
    let shortest = |vertices: &[Vec3], metrics: &[Sym3]| {
        let apex = (0..vertices.len()).max_by(|&i, &j| vertices[i][2].total_cmp(&vertices[j][2])).unwrap();
        let lengths = vertices.iter().map(|&p| metrics[apex].quadratic(sub(p, vertices[apex])).sqrt());
        lengths.filter(|&length| length > 0.0).fold(f64::INFINITY, f64::min)
    };
    let mesh = io::read_mesh(&start).unwrap().content;
    assert!(shortest(&mesh.vertices, &vec![Sym3::diagonal(100.0, 100.0, 100.0); mesh.vertices.len()]) < 0.01);
    for (sizes, complexity) in [([0.1, 0.1, 0.1], 1757.6), ([0.02, 0.1, 0.1], 1352.0), ([0.1, 0.1, 0.1], 3860.0)] {
        let [x, y, z] = sizes.map(|h: f64| h.powi(-2));
        let metric = work.metric(&mesh, |_| Sym3::diagonal(x, y, z));
        let found =
            work.adapt(&start, &["--cad", &model, "--metric", &metric, "--complexity", &complexity.to_string()]);
        let least = &found.report["statistics"]["mean_ratios"]["min"];
        let shortest = shortest(&found.mesh.vertices, &found.metrics);
        assert!(shortest > 0.1 && least.as_f64() > Some(0.2), "{shortest} {least}");
    }
}
