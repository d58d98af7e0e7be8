//! A part of a mesh may hang together in vertices or edges alone, where the kernel asks for faces. Some of its tetrahedra rest then.
use crate::mesh::adjacency::{FACES, MatchedFaces, NONE, sorted2};
use crate::tasks::{Rows, Team};

/// Which tetrahedra must rest, so that about each vertex and each edge all others hang together by faces.
pub fn resting(tets: &[[u32; 4]], vertices: usize, faces: &MatchedFaces) -> Vec<bool> {
    let is_open = on_open_faces(tets, vertices, faces);
    let mut state = State { tets, faces, is_open, rests: vec![false; tets.len()] };
    // About a vertex or an edge inside all hang together.
    let mut asked = state.is_open.clone();
    loop {
        let mut found = state.apart_at(&asked);
        if found.is_empty() {
            found = state.apart_about_edges();
        }
        if found.is_empty() {
            return state.rests;
        }
        // Their vertices have come to the boundary.
        asked.fill(false);
        for t in found.into_iter().map(|t| t as usize) {
            state.rests[t] = true;
            tets[t].iter().for_each(|&v| asked[v as usize] = true);
        }
        state.is_open.iter_mut().zip(&asked).for_each(|(is_open, asked)| *is_open |= asked);
    }
}

/// Whether each vertex is one of a face with one tetrahedron.
fn on_open_faces(tets: &[[u32; 4]], vertices: usize, faces: &MatchedFaces) -> Vec<bool> {
    let mut is_open = vec![false; vertices];
    for (nodes, neighbours) in tets.iter().zip(&faces.neighbours) {
        for (face, _) in FACES.iter().zip(neighbours).filter(|(_, n)| **n == NONE) {
            face.iter().for_each(|&k| is_open[nodes[k] as usize] = true);
        }
    }
    is_open
}

struct State<'a> {
    tets: &'a [[u32; 4]],
    faces: &'a MatchedFaces,
    /// Whether each vertex is on the boundary, or one of what rests.
    is_open: Vec<bool>,
    rests: Vec<bool>,
}

impl State<'_> {
    /// The tetrahedron behind a face, if it does not rest.
    fn behind(&self, t: u32, i: usize) -> Option<u32> {
        let n = self.faces.neighbours[t as usize][i];
        (n != NONE && !self.rests[n as usize]).then_some(n)
    }

    /// For each vertex that is asked for the tetrahedra that do not rest, in increasing order.
    fn around(&self, asked: &[bool]) -> Rows {
        let key = |t: usize| {
            let rests = self.rests[t];
            self.tets[t].map(|v| if !rests && asked[v as usize] { v } else { Rows::NOWHERE })
        };
        Rows::by_key::<4>(Team::alone(), asked.len(), self.tets.len(), key)
    }

    /// The tetrahedra at each of some vertices that do not hang together by faces with the most of them.
    fn apart_at(&self, asked: &[bool]) -> Vec<u32> {
        let (around, mut groups, mut apart) = (self.around(asked), Groups::default(), Vec::new());
        for v in (0..asked.len()).filter(|&v| asked[v]) {
            groups.tets.clear();
            groups.tets.extend(around.row(v).iter().map(|entry| entry / 4));
            groups.add_apart(self, |nodes, i| nodes[i] as usize != v, &mut apart);
        }
        apart
    }

    /// The same about all edges of more than two faces on the boundary.
    fn apart_about_edges(&self) -> Vec<u32> {
        let edges = self.edges_of_many_faces();
        if edges.is_empty() {
            return Vec::new();
        }
        let mut asked = vec![false; self.is_open.len()];
        edges.iter().for_each(|&[a, _]| asked[a as usize] = true);
        let (around, mut groups, mut apart) = (self.around(&asked), Groups::default(), Vec::new());
        for [a, b] in edges {
            let at = around.row(a as usize).iter().map(|entry| entry / 4);
            groups.tets.clear();
            groups.tets.extend(at.filter(|&t| self.tets[t as usize].contains(&b)));
            groups.add_apart(self, |nodes, i| nodes[i] != a && nodes[i] != b, &mut apart);
        }
        apart
    }

    /// The edges of more than two faces on the boundary, ascending.
    fn edges_of_many_faces(&self) -> Vec<[u32; 2]> {
        let mut edges = Vec::new();
        for (t, nodes) in self.tets.iter().enumerate() {
            let open = nodes.iter().filter(|&&v| self.is_open[v as usize]).count();
            if open < 3 || self.rests[t] {
                continue;
            }
            for face in (0..4).filter(|&i| self.behind(t as u32, i).is_none()).map(|i| FACES[i].map(|k| nodes[k])) {
                edges.extend([[0, 1], [1, 2], [0, 2]].map(|[i, j]| sorted2([face[i], face[j]])));
            }
        }
        edges.sort_unstable();
        edges.chunk_by(|a, b| a == b).filter(|same| same.len() > 2).map(|same| same[0]).collect()
    }
}

/// Finds which tetrahedra hang together. Allocated once.
#[derive(Default)]
struct Groups {
    /// In increasing order.
    tets: Vec<u32>,
    /// Of each tetrahedron.
    group: Vec<usize>,
    /// Of each group.
    sizes: Vec<usize>,
    open: Vec<usize>,
}

impl Groups {
    /// Adds those that do not hang together with the most of them by faces that count.
    fn add_apart(&mut self, state: &State, counts: impl Fn(&[u32; 4], usize) -> bool, apart: &mut Vec<u32>) {
        let Self { tets, group, sizes, open } = self;
        group.clear();
        group.resize(tets.len(), usize::MAX);
        sizes.clear();
        for first in 0..tets.len() {
            if group[first] != usize::MAX {
                continue;
            }
            let (own, mut size) = (sizes.len(), 0);
            group[first] = own;
            open.push(first);
            while let Some(at) = open.pop() {
                size += 1;
                let nodes = &state.tets[tets[at] as usize];
                for n in (0..4).filter(|&i| counts(nodes, i)).filter_map(|i| state.behind(tets[at], i)) {
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
        if sizes.len() > 1 {
            let most = (0..sizes.len()).rev().max_by_key(|&own| sizes[own]);
            let others = tets.iter().zip(&*group).filter(|(_, own)| Some(**own) != most);
            apart.extend(others.map(|(t, _)| *t));
        }
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
