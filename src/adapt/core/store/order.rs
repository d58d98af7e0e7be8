//! Renumbering along a space-filling curve: what is near in space comes near in memory, and dead records go.
//!
//! Tetrahedra are most of the memory. They are moved by halves of their records, through a list half as large as they are.
use super::fetch::fetch;
use super::{PlaceRecord, ROOM, Store, TetRecord, VertexRecord, rehouse, roomy};
use crate::adapt::core::ids::{TetId, VertexId};
use crate::adapt::core::numbering::{by_first, inverse};
use crate::geometry::Entity;
use crate::mesh::hilbert;
use crate::tasks::{GRAIN, Rows, Team};
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, AtomicUsize, Ordering::Relaxed};

/// A tetrahedron is left at a vertex that has gone: the mesh hung together there otherwise than by faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Torn;

/// Memory is given back when at least one in so many records is dead.
const DEAD: usize = 8;

/// Records are asked for when they are so many places ahead.
const AHEAD: usize = 12;

impl Store {
    /// Numbers the mesh along the Hilbert curve; returns for each old vertex id the new one (`NONE` for dead ones). Blocks of ids
    /// that were taken before mean nothing any more. Between sweeps only.
    ///
    /// # Errors
    /// [`Torn`], and nothing is done, where a tetrahedron has a dead vertex.
    pub fn reorder(&mut self, team: Team<'_>) -> Result<Vec<VertexId>, Torn> {
        if self.ordered == Some(self.clock()) {
            return Ok((0..self.vertex_bound() as u32).map(VertexId).collect());
        }
        let bounds = [self.vertex_bound(), self.tet_bound()];
        let vertices = self.vertices_along_curve(team);
        let number = inverse(team, &vertices, bounds[0], VertexId);
        let tets = self.tets_by_first(team, &number, vertices.len())?;
        let tet_number = inverse(team, &tets, bounds[1], TetId);
        self.move_vertices(team, &vertices, &number);
        self.move_tets(team, &tets, &number, &tet_number);
        self.next_vertex = AtomicUsize::new(vertices.len());
        self.next_tet = AtomicUsize::new(tets.len());
        if tets.len() < bounds[1] - bounds[1] / DEAD {
            rehouse(team, &mut self.tets, tets.len(), 2 * tets.len() + 6 * ROOM);
        }
        self.note_order();
        Ok(number)
    }

    /// Notes that the ids are in the order of the curve, until the next sweep.
    pub fn note_order(&mut self) {
        self.ordered = Some(self.clock());
    }

    /// The live vertices in the order of the curve.
    fn vertices_along_curve(&self, team: Team<'_>) -> Vec<u32> {
        let live = team.collect(GRAIN, self.vertex_bound(), |range, live| {
            live.extend(self.live_vertices_in(range).map(|v| v.0));
        });
        let order = hilbert::order(team, live.len(), |i| self.position(VertexId(live[i])));
        team.map(GRAIN, order.len(), |i| live[order[i] as usize])
    }

    /// The live tetrahedra in the order of their first vertex by its new number.
    fn tets_by_first(&self, team: Team<'_>, number: &[VertexId], vertices: usize) -> Result<Vec<u32>, Torn> {
        let torn = AtomicBool::new(false);
        let tets = by_first(team, self.tet_bound(), vertices, |t| {
            let of = self.unlocked_vertices(TetId(t as u32));
            if !of[0].is_some() {
                return Rows::NOWHERE;
            }
            let numbers = of.map(|v| number.get(v.index()).map_or(VertexId::NONE.0, |number| number.0));
            if numbers.contains(&VertexId::NONE.0) {
                torn.store(true, Relaxed);
            }
            numbers.into_iter().min().unwrap_or(Rows::NOWHERE)
        });
        if torn.into_inner() { Err(Torn) } else { Ok(tets) }
    }

    /// Brings the vertices into an order, with the ridges renumbered; they do not know their tetrahedra then.
    fn move_vertices(&mut self, team: Team<'_>, order: &[u32], number: &[VertexId]) {
        let many_dead = order.len() < self.vertex_bound() - self.vertex_bound() / DEAD;
        let room = if many_dead { 2 * order.len() + ROOM } else { self.vertices.len() };
        let mut vertices: Vec<VertexRecord> = roomy(order.len(), room);
        team.fill(GRAIN, &mut vertices[..order.len()], |start, chunk| {
            for (new, (to, &old)) in (start..).zip(chunk.iter_mut().zip(&order[start..])) {
                fetch_ahead(&self.vertices, order, new, AHEAD);
                *to = self.vertices[old as usize].moved();
            }
        });
        self.vertices = vertices;
        self.owners = Vec::new();
        let mut places: Vec<PlaceRecord> = roomy(order.len(), self.vertices.len());
        self.owners = roomy(order.len(), places.len());
        // There is room for as many vertices as the shortest of the three holds.
        places.truncate(self.owners.len());
        self.vertices.truncate(self.owners.len());
        team.fill(GRAIN, &mut places[..order.len()], |start, chunk| {
            for (new, (to, &old)) in (start..).zip(chunk.iter_mut().zip(&order[start..])) {
                fetch_ahead(&self.places, order, new, AHEAD);
                *to = self.places[old as usize].moved(number);
            }
        });
        self.places = places;
        for ridge in self.corners.iter().flatten() {
            ridge.other.store(number[ridge.other.load(Relaxed) as usize].0, Relaxed);
        }
    }

    /// Brings the tetrahedra into an order, renumbered, and tells the vertices the first of their tetrahedra.
    fn move_tets(&mut self, team: Team<'_>, order: &[u32], number: &[VertexId], tet_number: &[TetId]) {
        let Self { tets, vertices, .. } = self;
        let renumbered = |n: u32| if n == TetId::NONE.0 { n } else { tet_number[n as usize].0 };
        // The list holds one half, then the other: a second list would be new memory, which the system fills with zeroes first.
        let mut halves = team.map(GRAIN, order.len(), |new| {
            fetch_ahead(tets, order, new, 2 * AHEAD);
            if let Some(&next) = order.get(new + AHEAD) {
                let TetRecord { vertices, neighbours, .. } = &tets[next as usize];
                load(vertices).iter().for_each(|v| fetch(number.as_ptr().wrapping_add(*v as usize)));
                load(neighbours).iter().for_each(|n| fetch(tet_number.as_ptr().wrapping_add(*n as usize)));
            }
            let TetRecord { vertices, neighbours, .. } = &tets[order[new] as usize];
            (load(vertices).map(|v| number[v as usize].0), load(neighbours).map(renumbered))
        });
        team.fill(GRAIN, &mut tets[..order.len()], |start, chunk| {
            for (tet, (to, (of, neighbours))) in (start as u32..).zip(chunk.iter_mut().zip(&halves[start..])) {
                (to.vertices, to.neighbours) = (of.map(AtomicU32::new), neighbours.map(AtomicU32::new));
                for v in *of {
                    let first = &vertices[v as usize].tet;
                    if tet < first.load(Relaxed) {
                        first.fetch_min(tet, Relaxed);
                    }
                }
            }
        });
        team.remap(GRAIN, &mut halves, order.len(), |new| {
            fetch_ahead(tets, order, new, AHEAD);
            let TetRecord { tags, region, quality, stamp, moved, .. } = &tets[order[new] as usize];
            (load(tags), [region, quality, stamp, moved].map(|field| field.load(Relaxed)))
        });
        team.fill(GRAIN, &mut tets[..order.len()], |start, chunk| {
            for (to, (tags, fields)) in chunk.iter_mut().zip(&halves[start..]) {
                to.tags = tags.map(AtomicU32::new);
                [to.region, to.quality, to.stamp, to.moved] = fields.map(AtomicU32::new);
            }
        });
    }
}

/// Asks for the record that is moved to the place so many behind this one.
#[inline(always)]
fn fetch_ahead<T>(records: &[T], order: &[u32], new: usize, ahead: usize) {
    if let Some(&old) = order.get(new + ahead) {
        fetch(&raw const records[old as usize]);
    }
}

fn load<const N: usize>(from: &[AtomicU32; N]) -> [u32; N] {
    std::array::from_fn(|i| from[i].load(Relaxed))
}

fn copy<const N: usize>(from: &[AtomicU64; N]) -> [AtomicU64; N] {
    std::array::from_fn(|i| AtomicU64::new(from[i].load(Relaxed)))
}

impl VertexRecord {
    /// The same elsewhere: free, without a tetrahedron.
    fn moved(&self) -> Self {
        Self {
            position: copy(&self.position),
            log: copy(&self.log),
            metric: copy(&self.metric),
            lock: AtomicU32::new(0),
            tet: AtomicU32::new(TetId::NONE.0),
        }
    }
}

impl PlaceRecord {
    /// The same elsewhere, with its ridges renumbered.
    fn moved(&self, number: &[VertexId]) -> Self {
        let entity = self.entity.load(Relaxed);
        let renumbered = |end: u32| if end == VertexId::NONE.0 { end } else { number[end as usize].0 };
        let ridge = load(&self.ridge);
        // A corner has the number of its list there.
        let ridge = if matches!(super::unpack(entity), Entity::Edge(_)) { ridge.map(renumbered) } else { ridge };
        Self {
            parameters: copy(&self.parameters),
            ridge: ridge.map(AtomicU32::new),
            entity: AtomicU32::new(entity),
            hint: AtomicU32::new(self.hint.load(Relaxed)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapt::extract::extract;
    use crate::adapt::references::References;
    use crate::adapt::tests::bench::{Bench, Shape, sample};

    #[test]
    fn a_mesh_with_a_tetrahedron_at_a_dead_vertex_is_not_taken_out() {
        let sample = sample(Shape::Cube, 2, 0.5);
        let bench = Bench::new(&sample, 1, 3);
        let refs = References::of(Team::alone(), &sample.mesh, &sample.place, &sample.model);
        let taken = || extract(Team::alone(), &bench.context, &sample.mesh, &refs, &[]);
        assert_eq!(taken().map(|taken| taken.mesh.tets.len()), Ok(sample.mesh.tets.len()));
        bench.context.store.set_tet_of(VertexId(5), TetId::NONE);
        assert_eq!(taken().map(|taken| taken.mesh.tets.len()), Err(Torn));
    }

    #[test]
    fn a_tetrahedron_at_a_dead_vertex_is_told_and_nothing_is_moved() {
        let sample = sample(Shape::Cube, 2, 0.5);
        let mut bench = Bench::new(&sample, 1, 3);
        let store = &mut bench.context.store;
        let before: Vec<_> = store.live_tets().map(|t| store.vertices(t)).collect();
        let (v, t) = (VertexId(5), store.tet_of(VertexId(5)));
        store.set_tet_of(v, TetId::NONE);
        store.tick();
        assert_eq!(store.reorder(Team::alone()), Err(Torn));
        store.set_tet_of(v, t);
        assert!(store.live_tets().map(|t| store.vertices(t)).eq(before));
        bench.check("a refused renumbering");
        bench.context.store.tick();
        assert!(bench.context.store.reorder(Team::alone()).is_ok());
    }
}
