//! The triangles that the tetrahedra must have as faces, with those at each vertex; they are split where points are added.

/// End of a list.
const END: u32 = u32::MAX;

/// Triangles, each with the input triangle that it comes from.
#[derive(Clone, Debug, Default)]
pub struct Triangles {
    /// Vertices of each triangle, in the orientation of the input.
    pub nodes: Vec<[u32; 3]>,
    /// Input triangle of each.
    pub source: Vec<u32>,
    /// First corner (3 · triangle + place) at each vertex, and the next one after each corner.
    head: Vec<u32>,
    next: Vec<u32>,
    /// Number of triangles at each vertex.
    degree: Vec<u32>,
}

impl Triangles {
    /// The triangles between `points` vertices (all indices are below it).
    pub fn new(points: usize, triangles: &[[u32; 3]]) -> Self {
        let mut s = Self { head: vec![END; points], degree: vec![0; points], ..Self::default() };
        s.nodes.reserve(triangles.len());
        for (i, &t) in triangles.iter().enumerate() {
            s.push(t, i as u32);
        }
        s
    }

    /// The first two triangles with the same vertices.
    pub fn first_repeated(&self) -> Option<[u32; 2]> {
        let mut near: Vec<([u32; 3], u32)> = Vec::new();
        for u in 0..self.head.len() as u32 {
            near.clear();
            // Each triangle is compared at its first vertex.
            near.extend(
                self.at(u)
                    .map(|t| (crate::mesh::adjacency::sorted3(self.nodes[t as usize]), t))
                    .filter(|n| n.0[0] == u),
            );
            near.sort_unstable();
            if let Some(pair) = near.windows(2).find(|p| p[0].0 == p[1].0) {
                return Some([pair[0].1, pair[1].1]);
            }
        }
        None
    }

    /// Makes room for one more vertex.
    pub fn push_vertex(&mut self) {
        self.head.push(END);
        self.degree.push(0);
    }

    fn push(&mut self, nodes: [u32; 3], source: u32) -> u32 {
        let t = self.nodes.len() as u32;
        self.nodes.push(nodes);
        self.source.push(source);
        for (k, v) in nodes.into_iter().enumerate() {
            self.next.push(self.head[v as usize]);
            self.head[v as usize] = 3 * t + k as u32;
            self.degree[v as usize] += 1;
        }
        t
    }

    /// Puts vertex `new` in the place of `old` in triangle t.
    fn exchange(&mut self, t: u32, old: u32, new: u32) {
        let Some(k) = self.nodes[t as usize].iter().position(|&v| v == old) else { return };
        let corner = 3 * t + k as u32;
        let after = self.next[corner as usize];
        let mut c = self.head[old as usize];
        if c == corner {
            self.head[old as usize] = after;
        }
        while c != END {
            let n = self.next[c as usize];
            if n == corner {
                self.next[c as usize] = after;
                break;
            }
            c = n;
        }
        self.degree[old as usize] -= 1;
        self.nodes[t as usize][k] = new;
        self.next[corner as usize] = self.head[new as usize];
        self.head[new as usize] = corner;
        self.degree[new as usize] += 1;
    }

    /// Number of triangles at v.
    pub fn degree(&self, v: u32) -> u32 {
        self.degree[v as usize]
    }

    /// The triangles at v.
    pub fn at(&self, v: u32) -> impl Iterator<Item = u32> + '_ {
        let mut corner = self.head[v as usize];
        std::iter::from_fn(move || {
            (corner != END).then(|| {
                let t = corner / 3;
                corner = self.next[corner as usize];
                t
            })
        })
    }

    /// A triangle with the edge (u, v).
    pub fn with_edge(&self, u: u32, v: u32) -> Option<u32> {
        let (u, v) = if self.degree(u) <= self.degree(v) { (u, v) } else { (v, u) };
        self.at(u).find(|&t| self.nodes[t as usize].contains(&v))
    }

    /// The triangle with these vertices.
    pub fn with_nodes(&self, f: [u32; 3]) -> Option<u32> {
        let u = f.into_iter().min_by_key(|&v| self.degree(v))?;
        self.at(u).find(|&t| f.iter().all(|v| self.nodes[t as usize].contains(v)))
    }

    /// The same for a face that may have a ghost.
    pub fn with_nodes_or_ghost(&self, f: [u32; 3]) -> Option<u32> {
        if f.contains(&u32::MAX) { None } else { self.with_nodes(f) }
    }

    /// Splits every triangle at the edge (u, v) by vertex m on it; appends the triangles, old and new, to `changed`.
    pub fn split_edge(&mut self, u: u32, v: u32, m: u32, changed: &mut Vec<u32>) {
        let first = changed.len();
        changed.extend(self.at(u).filter(|&t| self.nodes[t as usize].contains(&v)));
        for k in first..changed.len() {
            let t = changed[k];
            let other = self.nodes[t as usize].map(|n| if n == u { m } else { n });
            self.exchange(t, v, m);
            let new = self.push(other, self.source[t as usize]);
            changed.push(new);
        }
    }

    /// Splits triangle t in three by vertex m in it; appends the three to `changed`.
    pub fn split_triangle(&mut self, t: u32, m: u32, changed: &mut Vec<u32>) {
        let [a, b, c] = self.nodes[t as usize];
        let source = self.source[t as usize];
        self.exchange(t, c, m);
        changed.push(t);
        changed.push(self.push([b, c, m], source));
        changed.push(self.push([c, a, m], source));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splits_keep_the_lists() {
        // Three triangles at one edge.
        let mut s = Triangles::new(5, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
        s.push_vertex();
        let mut changed = Vec::new();
        s.split_edge(0, 1, 5, &mut changed);
        assert_eq!((changed.len(), s.nodes.len(), s.degree(5), s.degree(2), s.degree(0)), (6, 6, 6, 2, 3));
        assert!(s.with_edge(0, 1).is_none() && s.with_edge(1, 5).is_some() && s.with_nodes([4, 5, 0]).is_some());
        s.push_vertex();
        let t = s.with_nodes([0, 5, 2]).unwrap();
        s.split_triangle(t, 6, &mut changed);
        assert_eq!((s.degree(6), s.degree(5)), (3, 7));
        for v in 0..7 {
            assert_eq!(s.at(v).count() as u32, s.degree(v));
            assert!(s.at(v).all(|t| s.nodes[t as usize].contains(&v)));
        }
        // The sum of the directed area is that of the input: each half keeps its orientation.
        let directed = |u, v| s.nodes.iter().any(|t| (0..3).any(|k| (t[k], t[(k + 1) % 3]) == (u, v)));
        assert!(directed(0, 5) && directed(5, 1) && directed(5, 0));
    }
}
