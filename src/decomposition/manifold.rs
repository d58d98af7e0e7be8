//! A part of a mesh may hang together in vertices or edges alone, where the kernel asks for faces. Some of its tetrahedra rest then.
use crate::mesh::adjacency::{FACES, MatchedFaces, NONE, sorted2};
use crate::tasks::{Rows, Team};
use std::collections::HashMap;

/// Which tetrahedra must rest, so that about each vertex and each edge all others hang together by faces.
pub fn resting(tets: &[[u32; 4]], vertices: usize, faces: &MatchedFaces) -> Vec<bool> {
    let mut rests = vec![false; tets.len()];
    let at = Rows::at_nodes(Team::alone(), tets, vertices);
    let mut asked: Vec<u32> = open_vertices(tets, vertices, faces);
    while !asked.is_empty() {
        let state = State { tets, faces, at: &at, rests: &rests };
        let mut found: Vec<u32> = asked.iter().flat_map(|&v| state.apart_at(v)).collect();
        if found.is_empty() {
            found = state.apart_about_edges();
        }
        found.sort_unstable();
        found.dedup();
        found.iter().for_each(|&t| rests[t as usize] = true);
        // Their vertices have come to the boundary.
        asked = found.iter().flat_map(|&t| tets[t as usize]).collect();
        asked.sort_unstable();
        asked.dedup();
    }
    rests
}

/// The vertices of faces with one tetrahedron.
fn open_vertices(tets: &[[u32; 4]], vertices: usize, faces: &MatchedFaces) -> Vec<u32> {
    let mut is_open = vec![false; vertices];
    for (nodes, neighbours) in tets.iter().zip(&faces.neighbours) {
        for (face, _) in FACES.iter().zip(neighbours).filter(|(_, n)| **n == NONE) {
            face.iter().for_each(|&k| is_open[nodes[k] as usize] = true);
        }
    }
    (0..vertices as u32).filter(|&v| is_open[v as usize]).collect()
}

struct State<'a> {
    tets: &'a [[u32; 4]],
    faces: &'a MatchedFaces,
    at: &'a Rows,
    rests: &'a [bool],
}

impl State<'_> {
    /// The tetrahedron behind a face, if it does not rest.
    fn behind(&self, t: u32, i: usize) -> Option<u32> {
        let n = self.faces.neighbours[t as usize][i];
        (n != NONE && !self.rests[n as usize]).then_some(n)
    }

    /// The tetrahedra at a vertex that do not hang together by faces with the most of them.
    fn apart_at(&self, v: u32) -> Vec<u32> {
        let live = self.at.row(v as usize).iter().copied().filter(|&t| !self.rests[t as usize]);
        self.apart(live.collect(), |nodes, i| nodes[i] != v)
    }

    /// The same about all edges of more than two faces on the boundary.
    fn apart_about_edges(&self) -> Vec<u32> {
        let mut count: HashMap<[u32; 2], u32> = HashMap::new();
        for t in (0..self.tets.len() as u32).filter(|&t| !self.rests[t as usize]) {
            let nodes = self.tets[t as usize];
            for face in (0..4).filter(|&i| self.behind(t, i).is_none()).map(|i| FACES[i].map(|k| nodes[k])) {
                for [i, j] in [[0, 1], [1, 2], [0, 2]] {
                    *count.entry(sorted2([face[i], face[j]])).or_default() += 1;
                }
            }
        }
        let mut several: Vec<[u32; 2]> =
            count.into_iter().filter(|(_, count)| *count > 2).map(|(edge, _)| edge).collect();
        several.sort_unstable();
        let about = |[a, b]: [u32; 2]| {
            let live = self.at.row(a as usize).iter().copied().filter(|&t| !self.rests[t as usize]);
            let about = live.filter(|&t| self.tets[t as usize].contains(&b)).collect();
            self.apart(about, |nodes, i| nodes[i] != a && nodes[i] != b)
        };
        several.into_iter().flat_map(about).collect()
    }

    /// Of some tetrahedra those that do not hang together with the most of them by faces that count.
    fn apart(&self, tets: Vec<u32>, counts: impl Fn(&[u32; 4], usize) -> bool) -> Vec<u32> {
        let mut group = vec![usize::MAX; tets.len()];
        let mut sizes = Vec::new();
        for first in 0..tets.len() {
            if group[first] != usize::MAX {
                continue;
            }
            let (own, mut open, mut size) = (sizes.len(), vec![first], 0);
            group[first] = own;
            while let Some(at) = open.pop() {
                size += 1;
                let nodes = &self.tets[tets[at] as usize];
                for n in (0..4).filter(|&i| counts(nodes, i)).filter_map(|i| self.behind(tets[at], i)) {
                    // The tetrahedra at a vertex are in increasing order.
                    if let Ok(n) = tets.binary_search(&n)
                        && group[n] == usize::MAX
                    {
                        group[n] = own;
                        open.push(n);
                    }
                }
            }
            sizes.push(size);
        }
        let most = (0..sizes.len()).rev().max_by_key(|&own| sizes[own]);
        tets.into_iter().zip(group).filter(|(_, own)| Some(*own) != most).map(|(t, _)| t).collect()
    }
}

/// The nodes of the faces that have one tetrahedron and no triangle.
pub fn open_faces<'a>(
    tets: &'a [[u32; 4]],
    neighbours: &'a [[u32; 4]],
    has_triangle: impl Fn(usize, usize) -> bool + 'a,
) -> impl Iterator<Item = [u32; 3]> + 'a {
    let sides = (0..tets.len()).flat_map(|t| [0, 1, 2, 3].map(|i| (t, i)));
    let open = sides.filter(move |&(t, i)| neighbours[t][i] == NONE && !has_triangle(t, i));
    open.map(|(t, i)| FACES[i].map(|k| tets[t][k]))
}
