//! What must rest so that the others hang together by faces.
use super::Random;
use crate::decomposition::manifold::resting;
use crate::mesh::adjacency::{EDGES, FACES, MatchedFaces, sorted2, sorted3};
use crate::mesh::samples::cube;
use crate::tasks::Team;
use std::collections::BTreeMap;

fn rests(tets: &[[u32; 4]], vertices: usize) -> Vec<bool> {
    resting(tets, vertices, &MatchedFaces::of(Team::alone(), tets))
}

/// Whether about each vertex and each edge all tetrahedra hang together by faces there: by brute force.
fn hangs_together(tets: &[[u32; 4]]) -> bool {
    let mut at: BTreeMap<Vec<u32>, Vec<[u32; 4]>> = BTreeMap::new();
    for nodes in tets {
        nodes.iter().for_each(|&v| at.entry(vec![v]).or_default().push(*nodes));
        EDGES.iter().for_each(|&[i, j]| {
            at.entry(sorted2([nodes[i], nodes[j]]).to_vec()).or_default().push(*nodes);
        });
    }
    at.iter().all(|(nodes, around)| {
        let faces = |tet: &[u32; 4]| {
            let faces = FACES.map(|face| sorted3(face.map(|k| tet[k])));
            faces.into_iter().filter(|face| nodes.iter().all(|v| face.contains(v))).collect::<Vec<_>>()
        };
        let (mut reached, mut next) = (vec![around[0]], 0);
        while next < reached.len() {
            let here = faces(&reached[next]);
            next += 1;
            for tet in around {
                if !reached.contains(tet) && faces(tet).iter().any(|face| here.contains(face)) {
                    reached.push(*tet);
                }
            }
        }
        reached.len() == around.len()
    })
}

#[test]
fn nothing_rests_in_a_ball() {
    let mesh = cube(3);
    assert!(!rests(&mesh.tets.nodes, mesh.vertices.len()).contains(&true));
    assert!(rests(&[], 0).is_empty());
    assert_eq!(rests(&[[0, 1, 2, 3]], 4), [false]);
}

#[test]
fn of_two_that_touch_one_rests() {
    // In a vertex, in an edge, in a face, and not at all.
    assert_eq!(rests(&[[0, 1, 2, 3], [3, 4, 5, 6]], 7).iter().filter(|rests| **rests).count(), 1);
    assert_eq!(rests(&[[0, 1, 2, 3], [2, 3, 4, 5]], 6).iter().filter(|rests| **rests).count(), 1);
    assert_eq!(rests(&[[0, 1, 2, 3], [3, 2, 1, 4]], 5), [false; 2]);
    assert_eq!(rests(&[[0, 1, 2, 3], [4, 5, 6, 7]], 8), [false; 2]);
}

#[test]
fn the_fewer_rest() {
    // Two that share a face, and one that touches both in a vertex of it.
    assert_eq!(rests(&[[1, 5, 6, 7], [0, 1, 2, 3], [2, 1, 0, 4]], 8), [true, false, false]);
}

#[test]
fn an_edge_between_two_that_hang_together_elsewhere() {
    // Two opposite tetrahedra of the six about an edge are left out: about its ends the others may hang together, about it they do not.
    let mesh = cube(3);
    let diagonal = [16 + 4 + 1, 2 * (16 + 4 + 1)];
    let about = |t: &&[u32; 4]| diagonal.iter().all(|v| t.contains(v));
    let shell: Vec<[u32; 4]> = mesh.tets.nodes.iter().filter(about).copied().collect();
    assert_eq!(shell.len(), 6);
    let mut left = mesh.tets.nodes.clone();
    let first = shell[0];
    let opposite = *shell.iter().find(|t| t.iter().filter(|v| first.contains(v)).count() == 2).unwrap();
    left.retain(|t| *t != first && *t != opposite);
    assert!(!hangs_together(&left));
    let rests = rests(&left, mesh.vertices.len());
    let live: Vec<[u32; 4]> = left.iter().zip(&rests).filter(|(_, rests)| !**rests).map(|(t, _)| *t).collect();
    assert!(rests.contains(&true) && hangs_together(&live) && 10 * live.len() > 9 * left.len());
}

#[test]
fn all_hang_together_by_faces_whatever_is_taken_out() {
    let mesh = cube(4);
    let mut random = Random(9);
    for share in [2, 3, 5, 10] {
        for _ in 0..5 {
            let mut tets = mesh.tets.nodes.clone();
            tets.retain(|_| random.below(share) != 0);
            assert!(!hangs_together(&tets));
            let rests = rests(&tets, mesh.vertices.len());
            let live: Vec<[u32; 4]> = tets.iter().zip(&rests).filter(|(_, rests)| !**rests).map(|(t, _)| *t).collect();
            assert!(!live.is_empty() && hangs_together(&live), "one of {share}");
        }
    }
}
