//! What is near former cuts is measured apart.
use super::{centroids, sample};
use crate::decomposition::cuts::Tree;
use crate::decomposition::former::{AtCut, Felt, NearCuts, Quality};
use crate::decomposition::outline::{Numbering, Outline};
use crate::decomposition::piece::Piece;
use crate::decomposition::slices::{Measured, Slice};
use crate::decomposition::split::split;
use crate::mesh::adjacency::unique_edges;
use crate::metric::statistics::Statistics;
use crate::metric::{Eigen, Sym3};
use crate::tasks::Team;

/// One plane.
fn cut(axis: usize, at: f64) -> Tree {
    Tree::Plane(axis, at, Box::new([Tree::Part(0), Tree::Part(1)]))
}

/// Measures pieces, each with the cuts that it has felt; those from the second on by way of bytes.
fn measured(pieces: &[Piece], felt: &[&[(u32, Tree)]]) -> (Statistics, NearCuts) {
    let numbering = Numbering::of(pieces.iter().map(Outline::of).collect());
    let mut all = Measured::default();
    for (at, (piece, felt)) in pieces.iter().zip(felt).enumerate() {
        let mut slice = Slice::of(piece.clone(), &numbering.of_piece(at, piece), Felt::of(felt));
        if at == 0 {
            all.add(&mut slice);
            continue;
        }
        let mut of_other = Measured::default();
        of_other.add(&mut slice);
        let bytes = of_other.encoded();
        all.add_encoded(&bytes).unwrap();
        assert!(Measured::default().add_encoded(&bytes[..bytes.len() - 8]).is_err());
    }
    all.statistics()
}

#[test]
fn what_is_near_a_cut_is_measured_apart_and_each_edge_once() {
    let (_, _, mut whole) = sample(10, 0.1);
    // So that ratios and lengths differ from place to place; a unit length is 0.11 along x everywhere.
    let [x, reach] = [0.23, 0.11f64];
    for (log, at) in whole.logs.iter_mut().zip(&whole.mesh.vertices) {
        *log = Sym3::diagonal(-2.0 * reach.ln(), 4.0 + at[1], 4.0 + 2.0 * at[0]);
    }
    let is_near = |place: f64| (place - x).abs() <= reach;
    // Two pieces around the cut, which share edges at it, and one that no cut has touched.
    let owner = |at: [f64; 3]| if at[0] > 0.6 { 2 } else { u32::from(at[1] > 0.5) };
    let owners: Vec<u32> = centroids(&whole).into_iter().map(owner).collect();
    let pieces = split(&whole, &owners, 3, |_, _| false);
    let felt = [(4, cut(0, x))];
    let (statistics, near) = measured(&pieces, &[&felt, &felt, &[]]);
    let [untouched, around, at_cuts] = [near.untouched, near.around, near.at_cuts].map(Option::unwrap);
    let count = |of: &dyn Fn(u32) -> bool| owners.iter().filter(|owner| of(**owner)).count();
    assert_eq!([untouched.tets, around.tets], [count(&|owner| owner == 2), count(&|owner| owner < 2)]);
    assert_eq!(at_cuts.tets, centroids(&whole).iter().filter(|at| is_near(at[0])).count());
    let edges = |nodes: &[[u32; 4]]| unique_edges(nodes);
    let all = edges(&whole.mesh.tets.nodes);
    // An edge of both lies around the cut.
    let of_near: Vec<[u32; 4]> =
        whole.mesh.tets.nodes.iter().zip(&owners).filter(|(_, owner)| **owner < 2).map(|(nodes, _)| *nodes).collect();
    assert_eq!([around.edges, around.edges + untouched.edges], [edges(&of_near).len(), all.len()]);
    let middle = |[a, b]: [u32; 2]| [a, b].map(|v| whole.mesh.vertices[v as usize][0]).iter().sum::<f64>() / 2.0;
    assert_eq!(at_cuts.edges, all.iter().filter(|edge| is_near(middle(**edge))).count());
    // Together they are the whole.
    let ratios = &statistics.mean_ratios;
    let joined = |of: fn(&Quality) -> (usize, f64)| {
        let [(m, a), (n, b)] = [of(&untouched), of(&around)];
        (m as f64 * a + n as f64 * b) / (m + n) as f64
    };
    assert!((joined(|quality| (quality.tets, quality.mean_ratio)) - ratios.mean).abs() < 1e-12);
    assert_eq!(untouched.least_ratio.min(around.least_ratio), ratios.min);
    let unit = statistics.metric.as_ref().unwrap().unit_edges;
    assert!((joined(|quality| (quality.edges, quality.unit_edges)) - unit).abs() < 1e-12);
    // And the same as of the mesh in one piece.
    let metrics: Vec<Sym3> = whole.logs.iter().map(Sym3::exp).collect();
    let known = Statistics::in_metric(Team::alone(), &whole.mesh, &metrics);
    assert_eq!((statistics.tets, statistics.edge_lengths.count), (known.tets, known.edge_lengths.count));
    assert_eq!(unit, known.metric.unwrap().unit_edges);
}

#[test]
fn without_a_cut_all_is_untouched() {
    let (_, _, whole) = sample(4, 0.2);
    let (statistics, near) = measured(&[whole], &[&[]]);
    assert_eq!((near.around, near.at_cuts), (None, None));
    assert_eq!(near.untouched.unwrap().tets, statistics.tets);
}

/// A unit length is that of the metric across the cut, whatever its directions are.
#[test]
fn a_unit_length_is_measured_across_the_cut() {
    let log = Sym3::diagonal(-1.0, 3.0, 5.0).congruent(&Sym3::from_eigen(&Eigen {
        values: [0.3, 1.0, 1.2],
        vectors: [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]],
    }));
    let metric = log.exp();
    for axis in 0..3 {
        // The farthest point of the unit ball along the axis: where the gradient of its form is along it.
        let mut along = [0.0; 3];
        along[axis] = 1.0;
        let way = metric.solve(along);
        let farthest = way[axis] / metric.quadratic(way).sqrt();
        let felt = [(1, cut(axis, 2.0))];
        for (share, is_near) in [(0.99, true), (-0.99, true), (1.01, false), (-1.01, false)] {
            let mut at = [7.0; 3];
            at[axis] = 2.0 + share * farthest;
            assert_eq!(AtCut::of(Felt::of(&felt), &[at], &[metric]).is_near([0]), is_near, "{axis} {share}");
        }
    }
}

#[test]
fn a_plane_ends_at_those_before_it() {
    // Above x = 0 there is a plane at y = 0, and below none.
    let tree =
        Tree::Plane(0, 0.0, Box::new([Tree::Part(0), Tree::Plane(1, 0.0, Box::new([Tree::Part(1), Tree::Part(2)]))]));
    let near = |at| tree.is_near(at, [0.1; 3]);
    assert!(near([3.0, 0.05, 0.0]) && near([3.0, -0.05, 0.0]) && near([0.05, 3.0, 0.0]) && near([-0.05, 3.0, 0.0]));
    assert!(!near([-3.0, 0.05, 0.0]) && !near([3.0, 0.2, 0.0]));
}
