//! The one way to change the topology: a set of tetrahedra is replaced by another with the same boundary.
//!
//! Every operation ends here. The faces of the old and the new tetrahedra are matched before anything is written:
//! a replacement that would leave a hole, a doubled face or a surface triangle without a tag is refused, and the mesh stays as it was.
use super::access::Access;
use super::ids::{FACE, TetId, VertexId, place_of};
use super::refusal::Refusal;
use super::voids::Guarded;
use super::worker::Worker;

/// A tetrahedron to be made.
#[derive(Clone, Copy, Debug)]
pub struct NewTet {
    /// Vertices, in positive order.
    pub vertices: [VertexId; 4],
    /// Region.
    pub region: u32,
    /// Mean ratio.
    pub quality: f64,
}

/// What is replaced by what.
#[derive(Default)]
pub struct Replacement {
    /// Tetrahedra that go.
    pub old: Vec<TetId>,
    /// Tetrahedra that come.
    pub new: Vec<NewTet>,
    /// Tagged faces inside the cavity or on the new surface.
    pub faces: Vec<([VertexId; 3], u32)>,
    /// Vertices that go.
    pub dead: Vec<VertexId>,
    /// Whether declared faces may be boundary triangles that were there before, since a vertex of theirs only moves.
    pub keeps_surface: bool,
    /// Whether those that come are all that one of their vertices will have: then they must hang together by their faces.
    pub is_ball: bool,
    links: Vec<[Link; 4]>,
    ids: Vec<TetId>,
    /// Of those that come, which are reached from the first by their faces, and from which it is still to go on.
    reached: Vec<bool>,
    next: Vec<u32>,
}

impl Replacement {
    /// Empties all lists.
    pub fn clear(&mut self) {
        self.old.clear();
        self.new.clear();
        self.faces.clear();
        self.dead.clear();
        self.keeps_surface = false;
        self.is_ball = false;
    }

    /// Whether those that come hang together by their faces. A cavity in a mesh that overlaps itself may have grown around to where it began.
    fn hangs_together(&mut self) -> bool {
        let Self { links, reached, next, .. } = self;
        reached.clear();
        reached.resize(links.len(), false);
        next.clear();
        next.extend(0..links.len().min(1) as u32);
        let mut count = 0;
        while let Some(tet) = next.pop() {
            if !std::mem::replace(&mut reached[tet as usize], true) {
                count += 1;
                next.extend(links[tet as usize].iter().filter_map(|link| match link {
                    Link::Inside { index, .. } => Some(*index),
                    Link::Surface { .. } | Link::Outside { .. } => None,
                }));
            }
        }
        count == links.len()
    }
}

/// What is known of a face while old and new are matched.
#[derive(Clone, Copy, Default)]
pub struct FaceSlot {
    seen: Seen,
    /// The tetrahedron on the other side: outside (an id), or new (an index).
    tet: u32,
    local: u8,
    tag: u32,
}

#[derive(Clone, Copy, Default, PartialEq)]
enum Seen {
    #[default]
    Never,
    /// On the cavity's boundary, not yet taken by a new tetrahedron.
    Boundary,
    /// Declared as tagged, not yet a face of a new tetrahedron.
    Declared,
    /// A face of one new tetrahedron, untagged: must find its second.
    Half,
    /// A face of one new tetrahedron, tagged: surface, unless a second comes.
    TaggedHalf,
    /// Nothing more may come.
    Complete,
}

/// What lies behind a face of a new tetrahedron.
#[derive(Clone, Copy)]
enum Link {
    Surface { tag: u32 },
    Outside { tet: TetId, local: u8, tag: u32 },
    Inside { index: u32, tag: u32 },
}

impl<A: Access> Worker<'_, '_, A> {
    /// Carries out `state.replacement`. All vertices of the old and new tetrahedra must be claimed.
    ///
    /// # Errors
    /// `Geometry` when something required would go, or a part of a larger mesh would get a face or a surface edge that another part may have too,
    /// `Topology` when old and new tetrahedra have different boundaries or the new ball of a vertex would fall apart, `Full` when there are no
    /// more ids, `Crossing` when the boundary would pass through itself. The mesh is unchanged then.
    pub fn commit(&mut self) -> Result<(), Refusal> {
        let Replacement { old, new, dead, .. } = &self.state.replacement;
        let stays = |a, b| new.iter().any(|tet| tet.vertices.contains(&a) && tet.vertices.contains(&b));
        self.context.required.check(self.store, old, dead, stays)?;
        if self.context.required.is_part() && self.joins_held() {
            return Err(Refusal::Geometry);
        }
        self.enter_old_faces()?;
        self.match_new_faces()?;
        if self.state.replacement.is_ball && !self.state.replacement.hangs_together() {
            return Err(Refusal::Topology);
        }
        let guarded = self.guard_surface()?;
        self.number_new_tets()?;
        self.write_new_tets();
        self.note_surface(guarded);
        Ok(())
    }

    /// Whether a new face has only vertices that must not move, or a new edge of the surface has: in a part of a larger mesh another part may
    /// have the same, and then three tetrahedra would share a face.
    fn joins_held(&self) -> bool {
        let Replacement { old, new, faces, .. } = &self.state.replacement;
        let was_there =
            |of: &[VertexId]| old.iter().map(|&t| self.store.vertices(t)).any(|tet| of.iter().all(|v| tet.contains(v)));
        let is_new = |of: &[VertexId]| of.iter().all(|&v| self.context.is_frozen(v)) && !was_there(of);
        new.iter().any(|tet| FACE.iter().any(|face| is_new(&face.map(|k| tet.vertices[k]))))
            || faces.iter().any(|&([a, b, c], _)| [[a, b], [b, c], [c, a]].iter().any(|edge| is_new(edge)))
    }

    /// Enters the cavity's boundary faces and the declared ones into the face map.
    fn enter_old_faces(&mut self) -> Result<(), Refusal> {
        let state = &mut *self.state;
        // Each face of a new tetrahedron is that of another one or of the boundary, which has about twice as many faces as old tetrahedra.
        state.face_map.clear(2 * (state.replacement.old.len() + state.replacement.new.len()) + 2);
        state.set.clear();
        for &t in &state.replacement.old {
            state.set.insert(t.0);
        }
        for &t in &state.replacement.old {
            let (v, n, tags) = (self.store.vertices(t), self.store.neighbours(t), self.store.tags(t));
            for i in 0..4 {
                if n[i].is_some() && state.set.contains(n[i].0) {
                    continue;
                }
                let (slot, new) = state.face_map.entry(FACE[i].map(|k| v[k].0));
                if !new {
                    return Err(Refusal::Topology);
                }
                *slot = FaceSlot { seen: Seen::Boundary, tet: n[i].0, local: 0, tag: tags[i] };
                if n[i].is_some() {
                    let back = self.store.neighbours(n[i]);
                    slot.local = place_of(t, back) as u8;
                    debug_assert_eq!(back[usize::from(slot.local)], t, "neighbours know each other");
                }
            }
        }
        let keeps = state.replacement.keeps_surface;
        let mut doubled = false;
        state.replacement.faces.retain(|&(face, tag)| {
            let (slot, new) = state.face_map.entry(face.map(|v| v.0));
            if new {
                *slot = FaceSlot { seen: Seen::Declared, tag, ..FaceSlot::default() };
                return true;
            }
            doubled |= !(keeps && slot.seen == Seen::Boundary && slot.tag == tag && !TetId(slot.tet).is_some());
            false
        });
        if doubled { Err(Refusal::Topology) } else { Ok(()) }
    }

    /// Finds what lies behind each face of each new tetrahedron.
    fn match_new_faces(&mut self) -> Result<(), Refusal> {
        let state = &mut *self.state;
        let Replacement { new, links, faces, old, .. } = &mut state.replacement;
        links.clear();
        let (mut halves, mut declared) = (0usize, faces.len());
        let mut outside_taken = 0usize;
        for (index, tet) in new.iter().enumerate() {
            let mut link = [Link::Surface { tag: 0 }; 4];
            for i in 0..4 {
                let (slot, _) = state.face_map.entry(FACE[i].map(|k| tet.vertices[k].0));
                let tag = slot.tag;
                match slot.seen {
                    Seen::Never => {
                        *slot = FaceSlot { seen: Seen::Half, tet: index as u32, local: i as u8, tag: 0 };
                        halves += 1;
                    }
                    Seen::Declared => {
                        *slot = FaceSlot { seen: Seen::TaggedHalf, tet: index as u32, local: i as u8, tag };
                        declared -= 1;
                        link[i] = Link::Surface { tag };
                    }
                    Seen::Half | Seen::TaggedHalf => {
                        halves -= usize::from(slot.seen == Seen::Half);
                        slot.seen = Seen::Complete;
                        link[i] = Link::Inside { index: slot.tet, tag };
                        let back = Link::Inside { index: index as u32, tag };
                        match slot.tet as usize == index {
                            true => return Err(Refusal::Topology),
                            false => links[slot.tet as usize][usize::from(slot.local)] = back,
                        }
                    }
                    Seen::Boundary => {
                        slot.seen = Seen::Complete;
                        let outside = TetId(slot.tet);
                        link[i] = match outside.is_some() {
                            true => Link::Outside { tet: outside, local: slot.local, tag },
                            false => Link::Surface { tag },
                        };
                        outside_taken += usize::from(outside.is_some());
                    }
                    Seen::Complete => return Err(Refusal::Topology),
                }
            }
            links.push(link);
        }
        let outside_all = old.iter().flat_map(|&t| self.store.neighbours(t));
        let outside_all = outside_all.filter(|n| n.is_some() && !state.set.contains(n.0)).count();
        if halves == 0 && declared == 0 && outside_taken == outside_all { Ok(()) } else { Err(Refusal::Topology) }
    }

    /// Holds the new boundary against what is near it across a void.
    fn guard_surface(&mut self) -> Result<Guarded, Refusal> {
        let links = std::mem::take(&mut self.state.replacement.links);
        let result = self.guard_replacement(|index, i| matches!(links[index][i], Link::Surface { .. }));
        self.state.replacement.links = links;
        result
    }

    /// Gives the new tetrahedra ids: those of the old ones first.
    fn number_new_tets(&mut self) -> Result<(), Refusal> {
        let state = &mut *self.state;
        let Replacement { old, new, ids, .. } = &mut state.replacement;
        state.id_pool.provide_tets(self.store, new.len().saturating_sub(old.len()))?;
        ids.clear();
        ids.extend(old.iter().take(new.len()));
        while ids.len() < new.len() {
            ids.push(state.id_pool.tet());
        }
        Ok(())
    }

    fn write_new_tets(&mut self) {
        let state = &mut *self.state;
        let Replacement { old, new, links, ids, dead, .. } = &mut state.replacement;
        for (tet, &id) in new.iter().zip(&*ids) {
            self.store.write_tet(id, tet.vertices, tet.region, tet.quality);
            for v in tet.vertices {
                self.store.set_tet_of(v, id);
            }
        }
        for (link, &id) in links.iter().zip(&*ids) {
            for i in 0..4 {
                match link[i] {
                    Link::Surface { tag } => self.store.set_tag(id, i, tag),
                    Link::Inside { index, tag } => {
                        self.store.set_neighbour(id, i, ids[index as usize]);
                        self.store.set_tag(id, i, tag);
                    }
                    Link::Outside { tet, local, tag } => {
                        self.store.set_neighbour(id, i, tet);
                        self.store.set_tag(id, i, tag);
                        self.store.set_neighbour(tet, usize::from(local), id);
                    }
                }
            }
        }
        for &t in old.iter().skip(new.len()) {
            self.store.kill_tet(t);
            state.id_pool.free_tet(t);
        }
        for &v in &*dead {
            self.store.set_tet_of(v, TetId::NONE);
            state.id_pool.free_vertex(v);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapt::core::access::Exclusive;
    use crate::adapt::tests::bench::{Bench, Shape, sample};
    use crate::geometry::Entity;

    #[test]
    fn the_new_ball_of_a_vertex_must_hang_together() {
        let sample = sample(Shape::Cube, 3, 0.5);
        let mut bench = Bench::new(&sample, 1, 3);
        bench.context.store.tick();
        let store = &bench.context.store;
        let v = store.live_vertices().find(|&v| store.entity(v) == Entity::Interior).expect("a vertex inside");
        let ball: Vec<TetId> = store.live_tets().filter(|&t| store.vertices(t).contains(&v)).collect();
        let first = ball[0];
        let are_neighbours = |t: TetId| store.neighbours(first).contains(&t);
        let beside = *ball[1..].iter().find(|&&t| are_neighbours(t)).expect("a neighbour at the vertex");
        let apart = *ball[1..].iter().find(|&&t| !are_neighbours(t)).expect("another one at the vertex");
        let mut worker = Worker::new(&bench.context, &mut bench.states[0], Exclusive);
        // They are replaced by themselves.
        for (other, is_ball, result) in
            [(apart, true, Err(Refusal::Topology)), (apart, false, Ok(())), (beside, true, Ok(()))]
        {
            let replacement = &mut worker.state.replacement;
            replacement.clear();
            replacement.is_ball = is_ball;
            for t in [first, other] {
                let (vertices, region, quality) = (store.vertices(t), store.region(t), store.quality(t));
                replacement.old.push(t);
                replacement.new.push(NewTet { vertices, region, quality });
            }
            assert_eq!(worker.commit(), result);
        }
        bench.check("tetrahedra that were replaced by themselves");
    }
}
