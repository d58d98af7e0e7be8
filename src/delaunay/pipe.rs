//! Recovery of an edge that flips from its ends do not reach: all that it crosses is looked at, and flips that leave less of it
//! are kept.
use super::Error;
use super::flips::Goal;
use super::recovery::Recovery;
use crate::mesh::vector::{cross, dot, sub, volume6};

/// Takes `share` if it is nearer to one half.
fn closer(best: &mut f64, share: f64) {
    if (share - 0.5).abs() < (*best - 0.5).abs() {
        *best = share;
    }
}

/// What a segment crosses: faces in their inside, edges in their inside.
#[derive(Default)]
pub struct Pipe {
    pub faces: Vec<[u32; 3]>,
    pub edges: Vec<[u32; 2]>,
}

impl Recovery<'_> {
    /// As `recover_edge`, with every flip in the pipe of the edge: one that lowers the number of crossings is kept, one that
    /// leaves it the same a few times.
    pub fn recover_edge_by_pipe(&mut self, a: u32, b: u32, depth: u32) -> Result<bool, Error> {
        self.begin_flips();
        let mut sideways = 0;
        let Some(mut pipe) = self.pipe(a, b)? else { return Ok(true) };
        for _ in 0..300 {
            let Some(less) = self.narrow(a, b, &pipe, depth, &mut sideways)? else { break };
            match less {
                None => return Ok(true),
                Some(next) => pipe = next,
            }
        }
        self.undo(0);
        Ok(false)
    }

    /// One flip that makes the pipe smaller, and the new pipe (inner `None` when the edge is there); `None` if there is no such.
    fn narrow(
        &mut self,
        a: u32,
        b: u32,
        pipe: &Pipe,
        depth: u32,
        sideways: &mut u32,
    ) -> Result<Option<Option<Pipe>>, Error> {
        let count = |p: &Pipe| p.faces.len() + p.edges.len();
        let mut edges: Vec<[u32; 2]> = pipe.edges.clone();
        for f in &pipe.faces {
            edges.extend((0..3).map(|k| [f[k].min(f[(k + 1) % 3]), f[k].max(f[(k + 1) % 3])]));
        }
        edges.sort_unstable();
        edges.dedup();
        let mut tries: Vec<(usize, bool)> = (0..edges.len()).map(|k| (k, true)).collect();
        tries.extend((0..pipe.faces.len()).map(|k| (k, false)));
        let begin = if tries.is_empty() { 0 } else { self.mesh.below(tries.len() as u32) as usize };
        let mut same: Option<(usize, bool)> = None;
        for n in 0..tries.len().min(40) {
            let (k, is_edge) = tries[(begin + n) % tries.len()];
            let mark = self.journal.mark();
            if !self.try_one(a, b, pipe, &edges, (k, is_edge), depth) {
                continue;
            }
            let Some(now) = self.pipe(a, b)? else { return Ok(Some(None)) };
            if count(&now) < count(pipe) {
                return Ok(Some(Some(now)));
            }
            if count(&now) == count(pipe) && same.is_none() {
                same = Some((k, is_edge));
            }
            self.undo(mark);
        }
        if let Some(one) = same
            && *sideways < 20
        {
            *sideways += 1;
            if self.try_one(a, b, pipe, &edges, one, depth) {
                return Ok(Some(self.pipe(a, b)?));
            }
        }
        Ok(None)
    }

    fn try_one(
        &mut self,
        a: u32,
        b: u32,
        pipe: &Pipe,
        edges: &[[u32; 2]],
        (k, is_edge): (usize, bool),
        depth: u32,
    ) -> bool {
        self.budget = 30 * (depth * depth + 1);
        if is_edge {
            let [p, q] = edges[k];
            return self.surface.with_edge(p, q).is_none() && self.remove_edge(p, q, depth, Goal::Edge(a, b));
        }
        let Some(&f) = pipe.faces.get(k) else { return false };
        let Some(t) = self.find_facet(f) else { return false };
        let place = (0..4).find(|&i| !f.contains(&self.mesh.nodes[t as usize][i]));
        place.is_some_and(|i| self.flip_face(t, i))
    }

    /// Share of the way from a to b at which it crosses something, nearest to the middle; half, where that is near an end.
    pub fn crossing_place(&mut self, a: u32, b: u32) -> f64 {
        let Ok(Some(pipe)) = self.pipe(a, b) else { return 0.5 };
        let (p, q) = (self.mesh.point(a), self.mesh.point(b));
        let mut best = 2.0;
        for f in &pipe.faces {
            let [x, y, z] = f.map(|v| self.mesh.point(v));
            let (above, below) = (volume6(x, y, z, p).abs(), volume6(x, y, z, q).abs());
            closer(&mut best, above / (above + below));
        }
        for e in &pipe.edges {
            // Where both lines are closest.
            let (u, v) = (sub(q, p), sub(self.mesh.point(e[1]), self.mesh.point(e[0])));
            let w = sub(self.mesh.point(e[0]), p);
            let n = cross(u, v);
            closer(&mut best, dot(cross(w, v), n) / dot(n, n));
        }
        if (0.15..0.85).contains(&best) { best } else { 0.5 }
    }

    /// What the segment crosses, `None` when it is an edge.
    pub fn pipe(&mut self, a: u32, b: u32) -> Result<Option<Pipe>, Error> {
        if self.has_edge(a, b) {
            return Ok(None);
        }
        let mut tets = std::mem::take(&mut self.tets);
        self.mesh.star(a, &mut tets);
        let mut pipe = Pipe::default();
        let mut fault = None;
        let mut next = 0;
        'flood: while next < tets.len() {
            let t = tets[next];
            next += 1;
            if self.mesh.is_ghost(t) {
                continue;
            }
            for i in 0..4 {
                let f = self.mesh.face(t, i);
                if !self.segment_meets_triangle(a, b, f) {
                    continue;
                }
                let side = [0, 1, 2].map(|k| self.mesh.orient(a, b, f[k], f[(k + 1) % 3]) == 0.0);
                let protected = match side {
                    [false, false, false] => {
                        pipe.faces.push(crate::mesh::adjacency::sorted3(f));
                        self.surface
                            .with_nodes(f)
                            .is_some()
                            .then(|| self.crossing(self.surface.with_edge(a, b), &f, self.middle(a, b)))
                    }
                    _ if side.iter().filter(|&&z| z).count() == 1 => {
                        let k = side.iter().position(|&z| z).unwrap_or(0);
                        let (p, q) = (f[k], f[(k + 1) % 3]);
                        pipe.edges.push([p.min(q), p.max(q)]);
                        let own = self.surface.with_edge(p, q).is_some();
                        own.then(|| self.crossing(self.surface.with_edge(a, b), &[p, q], self.middle(a, b)))
                    }
                    _ => {
                        let k = (0..3).find(|&k| side[k] && side[(k + 2) % 3]).unwrap_or(0);
                        Some(self.touching(self.surface.with_edge(a, b), f[k]))
                    }
                };
                if protected.is_some() {
                    fault = protected;
                    break 'flood;
                }
                let o = self.mesh.across[t as usize][i] >> 2;
                if self.mesh.see(o) {
                    tets.push(o);
                }
            }
        }
        self.tets = tets;
        if let Some(error) = fault {
            return Err(error);
        }
        // A face is seen from both sides, an edge from all of its faces.
        pipe.faces.sort_unstable();
        pipe.faces.dedup();
        pipe.edges.sort_unstable();
        pipe.edges.dedup();
        Ok(Some(pipe))
    }
}
