//! Star cavities: the tetrahedra about a seed are replaced by tetrahedra that all meet in one apex.
//!
//! Insertion is a star about a new vertex (seed: an edge's shell, a face's two tetrahedra, one tetrahedron), collapse a star about
//! a neighbour of the vertex that goes (seed: its ball). Where the apex does not see a face of the cavity well, the cavity grows
//! over that face, up to a limit: this is what makes room for points on curved walls under thin layers.
use super::access::Access;
use super::commit::NewTet;
use super::ids::{FACE, TetId, VertexId};
use super::refusal::Refusal;
use super::worker::Worker;
use crate::geometry::Entity;
use crate::mesh::stamped_set::StampedSet;
use crate::mesh::vector::Vec3;
use crate::metric::Sym3;
use crate::metric::lanes::LANES;

/// What the star is built about. It decides which surface triangles go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Seed {
    /// An edge is split: the surface triangles at it go.
    Edge(VertexId, VertexId),
    /// A surface triangle is split.
    Face([VertexId; 3]),
    /// A point inside: no surface triangle goes.
    Inside,
    /// A vertex goes: the surface triangles at it go.
    Vertex(VertexId),
    /// The first vertex goes and the second moves: the surface triangles at both go.
    Pair(VertexId, VertexId),
}

impl Seed {
    fn consumes(self, face: [VertexId; 3]) -> bool {
        match self {
            Seed::Edge(a, b) => face.contains(&a) && face.contains(&b),
            Seed::Face(f) => f.iter().all(|v| face.contains(v)),
            Seed::Inside => false,
            Seed::Vertex(v) => face.contains(&v),
            Seed::Pair(v, w) => face.contains(&v) || face.contains(&w),
        }
    }

    /// Whether the vertex is the one that goes.
    fn removes(self, v: VertexId) -> bool {
        matches!(self, Seed::Vertex(w) | Seed::Pair(w, _) if w == v)
    }

    /// Whether the edge x–y of a consumed triangle stays, so that the apex joins it.
    fn keeps(self, x: VertexId, y: VertexId) -> bool {
        match self {
            Seed::Edge(a, b) => !((x == a && y == b) || (x == b && y == a)),
            Seed::Face(_) | Seed::Inside => true,
            Seed::Vertex(v) => x != v && y != v,
            Seed::Pair(v, w) => ![v, w].contains(&x) && ![v, w].contains(&y),
        }
    }
}

/// Mean ratios of a star's tetrahedra.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bounds {
    /// Below this the cavity grows, if it can. Where a tetrahedron would be inverted it always grows.
    pub wanted: f64,
    /// Below this, after growing, the star is given up.
    pub floor: f64,
}

/// A face that the apex sees.
#[derive(Clone, Copy)]
struct Seen {
    behind: TetId,
    tag: u32,
    tet: NewTet,
}

/// A face that a tetrahedron may stand on.
#[derive(Clone, Copy)]
struct CavityFace {
    t: TetId,
    behind: TetId,
    tag: u32,
    vertices: [VertexId; 4],
}

/// The vertex in the middle.
struct Apex {
    id: VertexId,
    point: Vec3,
    log: Sym3,
}

/// A star cavity in preparation.
#[derive(Default)]
pub struct Star {
    /// The cavity's tetrahedra.
    inside: StampedSet,
    linked: StampedSet,
    seen: Vec<Seen>,
    open: Vec<(TetId, usize)>,
    wanted: Vec<CavityFace>,
    /// Vertices that the apex will be joined to.
    pub link: Vec<VertexId>,
    /// Surface triangles that go (outward), with their tags.
    pub surface: Vec<([VertexId; 3], u32)>,
}

impl<A: Access> Worker<'_, '_, A> {
    /// Prepares `state.replacement` as the star of `apex` over the tetrahedra in `seeds`. The apex has its position and
    /// metric in the store. Returns the worst mean ratio of the star.
    ///
    /// The cavity grows over faces where a tetrahedron would be inverted or below `wanted`; where it cannot, and the
    /// tetrahedron is below `floor`, it is given up.
    ///
    /// # Errors
    /// `Shape` at a tetrahedron below `floor`, `Inverted` when the apex cannot see a face, `Topology` when the cavity would have to grow over a
    /// tagged face or a boundary vertex.
    pub fn build_star(&mut self, seed: Seed, apex: VertexId, seeds: &[TetId], bounds: Bounds) -> Result<f64, Refusal> {
        let mut star = std::mem::take(&mut self.state.star);
        let result = self.grow_star(&mut star, seed, apex, seeds, bounds);
        let result = result.and_then(|()| self.finish_star(&mut star, seed, apex));
        self.state.star = star;
        // A cavity that has not grown hangs together as its seeds do, and needs no test.
        let replacement = &mut self.state.replacement;
        replacement.is_ball &= replacement.old.len() > seeds.len();
        result
    }

    fn grow_star(
        &mut self,
        star: &mut Star,
        seed: Seed,
        apex: VertexId,
        seeds: &[TetId],
        bounds: Bounds,
    ) -> Result<(), Refusal> {
        star.inside.clear();
        star.seen.clear();
        star.open.clear();
        star.surface.clear();
        star.wanted.clear();
        self.state.replacement.clear();
        for &t in seeds {
            star.inside.insert(t.0);
            self.state.replacement.old.push(t);
            star.open.extend((0..4).map(|i| (t, i)));
        }
        let apex = Apex { id: apex, point: self.store.position(apex), log: self.store.log(apex) };
        loop {
            while star.wanted.len() < LANES {
                let Some((t, i)) = star.open.pop() else { break };
                self.classify_face(star, seed, apex.id, (t, i))?;
            }
            if star.wanted.is_empty() {
                return Ok(());
            }
            self.measure_faces(star, &apex, bounds)?;
        }
    }

    /// Decides what a face of the cavity is: a surface triangle that goes, a face inside, or the base of a new tetrahedron.
    fn classify_face(
        &mut self,
        star: &mut Star,
        seed: Seed,
        apex: VertexId,
        (t, i): (TetId, usize),
    ) -> Result<(), Refusal> {
        let (v, tag, behind) = (self.store.vertices(t), self.store.tags(t)[i], self.store.neighbour(t, i));
        let face = FACE[i].map(|k| v[k]);
        let interior = behind.is_some() && star.inside.contains(behind.0);
        if tag != 0 && seed.consumes(face) {
            if !interior || self.store.lists_triangle(t, behind) {
                star.surface.push(([face[0], face[2], face[1]], tag));
            }
            return Ok(());
        }
        if interior {
            return if tag == 0 { Ok(()) } else { Err(Refusal::Topology) };
        }
        let vertices = [face[0], face[1], face[2], apex];
        if face.contains(&apex) {
            star.seen.push(Seen { behind, tag, tet: NewTet { vertices, region: u32::MAX, quality: 1.0 } });
        } else {
            star.wanted.push(CavityFace { t, behind, tag, vertices });
        }
        Ok(())
    }

    /// Measures the tetrahedra on several faces. A face is good enough, or the cavity grows over it.
    fn measure_faces(&mut self, star: &mut Star, apex: &Apex, bounds: Bounds) -> Result<(), Refusal> {
        let count = star.wanted.len();
        let (store, batch) = (self.store, &mut self.state.batch);
        for lane in 0..LANES {
            let face = star.wanted[lane.min(count - 1)].vertices;
            let face = [face[0], face[1], face[2]];
            batch.set_with_sum(lane, face.map(|x| store.position(x)), &store.log_sum(face));
        }
        batch.prepare();
        let qualities = batch.shapes(apex.point, &apex.log).mean_ratios();
        for lane in (0..count).rev() {
            let quality = qualities[lane];
            let Some(CavityFace { t, behind, tag, vertices }) = star.wanted.pop() else { break };
            if behind.is_some() && star.inside.contains(behind.0) {
                // The cavity has grown over the face meanwhile.
                if tag != 0 {
                    return Err(Refusal::Topology);
                }
                continue;
            }
            let may_grow =
                behind.is_some() && tag == 0 && self.state.replacement.old.len() < self.context.limits.cavity;
            if (quality <= 0.0 || quality < bounds.wanted) && may_grow {
                self.claim_tet(behind)?;
                star.inside.insert(behind.0);
                self.state.replacement.old.push(behind);
                star.open.extend((0..4).filter(|&j| self.store.neighbour(behind, j) != t).map(|j| (behind, j)));
                continue;
            }
            if quality <= 0.0 {
                return Err(Refusal::Inverted);
            }
            if quality < bounds.floor {
                return Err(Refusal::Shape);
            }
            star.seen.push(Seen { behind, tag, tet: NewTet { vertices, region: self.store.region(t), quality } });
        }
        Ok(())
    }

    /// Makes tetrahedra of the faces that the apex sees, and new triangles of those that go. Finds the vertices that go.
    fn finish_star(&mut self, star: &mut Star, seed: Seed, apex: VertexId) -> Result<f64, Refusal> {
        let Star { inside, linked, seen, link, surface, .. } = star;
        link.clear();
        linked.clear();
        linked.insert(apex.0);
        let replacement = &mut self.state.replacement;
        replacement.is_ball = true;
        let mut worst = f64::INFINITY;
        for face in seen.iter() {
            if face.behind.is_some() && inside.contains(face.behind.0) {
                match face.tag {
                    0 => continue,
                    _ => return Err(Refusal::Topology),
                }
            }
            link.extend(face.tet.vertices.iter().copied().filter(|v| linked.insert(v.0)));
            // Faces at the apex bound the cavity too, but carry no tetrahedron.
            match face.tet.region {
                u32::MAX => replacement.is_ball = false,
                _ => {
                    worst = worst.min(face.tet.quality);
                    replacement.new.push(face.tet);
                }
            }
        }
        for &(triangle, tag) in surface.iter() {
            for k in 0..3 {
                let (x, y) = (triangle[k], triangle[(k + 1) % 3]);
                if seed.keeps(x, y) && x != apex && y != apex {
                    replacement.faces.push(([x, y, apex], tag));
                }
            }
        }
        for index in 0..replacement.old.len() {
            for v in self.store.vertices(replacement.old[index]) {
                if linked.insert(v.0) {
                    if !seed.removes(v) && self.store.entity(v) != Entity::Interior {
                        return Err(Refusal::Topology);
                    }
                    replacement.dead.push(v);
                }
            }
        }
        if replacement.new.is_empty() { Err(Refusal::Topology) } else { Ok(worst) }
    }

    /// The least length from the apex of the star that was built to its vertices, but for one of them.
    pub fn shortest_of_star(&self, apex: VertexId, but: VertexId) -> f64 {
        let others = self.state.star.link.iter().filter(|&&v| v != but);
        others.map(|&v| self.length(apex, v)).fold(f64::INFINITY, f64::min)
    }

    /// Worst kept mean ratio of the tetrahedra that would go.
    pub fn worst_old(&self) -> f64 {
        let old = self.state.replacement.old.iter().map(|&t| self.store.quality(t));
        old.fold(f64::INFINITY, f64::min)
    }
}
