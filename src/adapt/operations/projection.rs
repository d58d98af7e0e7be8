//! Projection of boundary vertices for which there was no room on the model when they were made.
use super::collapse::onto_end::CollapseScratch;
use crate::adapt::core::access::Access;
use crate::adapt::core::ids::{TetId, VertexId};
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::star::{Bounds, Seed};
use crate::adapt::core::vertex_moves::{Placed, VertexState};
use crate::adapt::core::worker::Worker;
use crate::adapt::schedule::Operation;
use crate::mesh::vector::{Vec3, add, distance, lerp, norm, scale};

/// Halvings of the way to the model within one attempt.
const HALVINGS: u32 = 5;

/// A vertex nearer to its entity than this share of its distance from the origin is on it: projections round by as much.
const ARRIVED: f64 = 1e-15;

/// Removes boundary vertices that never arrived on the model. The items are what a sweep of [`Project`] just before has left over, so no
/// id stands for another vertex by now.
pub struct RemoveUnprojected {
    /// Whether a neighbour on the surface goes where the vertex itself cannot. The vertex stays unprojected: there may be room for it then.
    pub or_neighbour: bool,
}

impl Operation for RemoveUnprojected {
    type Item = VertexId;
    type Scratch = CollapseScratch;
    const WHOLE_BALLS: bool = true;

    fn attempt<A: Access>(
        &self,
        worker: &mut Worker<'_, '_, A>,
        scratch: &mut CollapseScratch,
        item: VertexId,
    ) -> Result<(), Refusal> {
        let removed = worker.claim_live(item).and_then(|()| worker.remove(scratch, item, 0.0));
        if !removed.is_err_and(|refusal| !matches!(refusal, Refusal::Conflict | Refusal::Stale)) {
            return removed;
        }
        let result = if self.or_neighbour { worker.remove_neighbour(scratch, item) } else { removed };
        if result != Err(Refusal::Conflict) {
            worker.state.unprojected.push(item);
        }
        result
    }
}

/// Moves boundary vertices that are not on the model there.
pub struct Project;

impl Operation for Project {
    type Item = VertexId;
    type Scratch = ();
    const WHOLE_BALLS: bool = true;

    fn attempt<A: Access>(
        &self,
        worker: &mut Worker<'_, '_, A>,
        _scratch: &mut (),
        item: VertexId,
    ) -> Result<(), Refusal> {
        let result = worker.project(item);
        if result.is_err_and(|refusal| !matches!(refusal, Refusal::Conflict | Refusal::Stale)) {
            worker.state.unprojected.push(item);
        }
        result
    }
}

impl<A: Access> Worker<'_, '_, A> {
    /// Removes the first neighbour of a vertex on the surface that can go.
    fn remove_neighbour(&mut self, scratch: &mut CollapseScratch, v: VertexId) -> Result<(), Refusal> {
        let mut ball = std::mem::take(&mut self.state.ball);
        let gathered = self.gather_ball(v, &mut ball);
        let neighbours = self.neighbours_on_surface(v, &ball.tets);
        self.state.ball = ball;
        gathered?;
        let mut result = Err(Refusal::Shape);
        for w in neighbours {
            result = self.claim_live(w).and_then(|()| self.remove(scratch, w, 0.0));
            if !is_refused(result) {
                break;
            }
        }
        result
    }

    /// Moves an unprojected vertex to where it belongs on its entity, or to another point of it between its neighbours there, with a cavity
    /// that grows where it must. If that fails, the vertex goes as far towards the first point as no tetrahedron is inverted, by up to five
    /// halvings of the way.
    /// Refused as `Inverted` while it has not arrived; then it is tried again after reconnection.
    pub fn project(&mut self, v: VertexId) -> Result<(), Refusal> {
        self.claim_live(v)?;
        self.context.required.check_move(v)?;
        let mut ball = std::mem::take(&mut self.state.ball);
        let result = self.gather_ball(v, &mut ball).and_then(|()| self.project_ball(v, &ball.tets));
        self.state.ball = ball;
        result
    }

    fn project_ball(&mut self, v: VertexId, ball: &[TetId]) -> Result<(), Refusal> {
        let start = self.store.position(v);
        let goal = self.place(self.store.entity(v), start, &[v]);
        if has_arrived(start, goal) {
            // Smoothing has put it on the model already, or the id belongs to another vertex now.
            return Ok(());
        }
        let folded = self.folded_at(v, ball);
        let mut arrived = self.arrive(v, ball, (goal, folded));
        if is_refused(arrived) {
            let closest = self.closest(self.store.entity(v), start, &[v]);
            if closest.point != goal.point {
                arrived = self.arrive(v, ball, (closest, folded));
            }
        }
        if is_refused(arrived) {
            for point in self.between_neighbours(v, ball) {
                let place = self.place(self.store.entity(v), point, &[v]);
                arrived = self.arrive(v, ball, (place, folded));
                if !is_refused(arrived) {
                    break;
                }
            }
        }
        if is_refused(arrived) { self.approach(v, ball, (goal, folded)) } else { arrived }
    }

    /// Moves the vertex to a place on the model, with a cavity that grows where it must.
    fn arrive(&mut self, v: VertexId, ball: &[TetId], (place, folded): (Placed, usize)) -> Result<(), Refusal> {
        let to = self.state_at(place, self.store.hint(v));
        self.with_vertex_at(v, &to, |worker| {
            worker.build_star(Seed::Vertex(v), v, ball, Bounds::default())?;
            worker.state.replacement.keeps_surface = true;
            if worker.folded_of_star() > folded { Err(Refusal::Normal) } else { worker.commit() }
        })
    }

    /// Where a vertex may go when the closest point on the model is out of reach, since it lies beyond the triangles at the vertex: to the mean
    /// of its neighbours on the surface, or half way from there to one of them.
    fn between_neighbours(&mut self, v: VertexId, ball: &[TetId]) -> Vec<Vec3> {
        let others = self.neighbours_on_surface(v, ball);
        if others.is_empty() {
            // In a part of a larger mesh the vertex' ridge edges may all be elsewhere.
            return Vec::new();
        }
        let sum = others.iter().fold([0.0; 3], |sum, &x| add(sum, self.store.position(x)));
        let mean = scale(sum, 1.0 / others.len() as f64);
        let halfway = others.iter().map(|&x| lerp(mean, self.store.position(x), 0.5));
        std::iter::once(mean).chain(halfway).collect()
    }

    /// The neighbours of a vertex on the surface; of one on an edge of the model, those along it.
    fn neighbours_on_surface(&mut self, v: VertexId, ball: &[TetId]) -> Vec<VertexId> {
        if self.store.dimension(v) == 1 {
            return self.store.ridge(v).into_iter().filter(|x| x.is_some()).collect();
        }
        let mut triangles = std::mem::take(&mut self.state.star.surface);
        triangles.clear();
        self.list_surface(v, ball, &mut triangles);
        let corners = triangles.iter().flat_map(|(corners, _)| corners).copied();
        let mut others: Vec<VertexId> = corners.filter(|&x| x != v).collect();
        self.state.star.surface = triangles;
        others.sort_unstable();
        others.dedup();
        others
    }

    /// How many surface triangles at a vertex are folded: there must never be more. The surface would pass through what is across a void, or
    /// beyond the cuts of a part, which sees nothing there.
    fn folded_at(&mut self, v: VertexId, ball: &[TetId]) -> usize {
        let mut triangles = std::mem::take(&mut self.state.star.surface);
        triangles.clear();
        self.list_surface(v, ball, &mut triangles);
        let folded = self.folded(&triangles);
        self.state.star.surface = triangles;
        folded
    }

    /// The same of the triangles that come with `state.replacement`.
    fn folded_of_star(&mut self) -> usize {
        let triangles = std::mem::take(&mut self.state.replacement.faces);
        let folded = self.folded(&triangles);
        self.state.replacement.faces = triangles;
        folded
    }

    fn approach(&mut self, v: VertexId, ball: &[TetId], (goal, folded): (Placed, usize)) -> Result<(), Refusal> {
        let VertexState { placed, hint, .. } = self.vertex_state(v);
        let mut step = 0.5;
        for _ in 0..HALVINGS {
            let point = lerp(placed.point, goal.point, step);
            if self.is_positive_at(v, point, ball) {
                let to = self.state_at(Placed { point, ..placed }, hint);
                match self.move_unmeasured(v, &to, ball, |worker| worker.folded_at(v, ball) <= folded) {
                    Ok(()) => break,
                    // Nearer to where it was it may keep out of what is across a void.
                    Err(Refusal::Crossing | Refusal::Normal) => {}
                    Err(refusal) => return Err(refusal),
                }
            }
            step *= 0.5;
        }
        self.remeasure(ball);
        Err(Refusal::Inverted)
    }
}

/// Whether it cannot be done, now or in another round.
fn is_refused(result: Result<(), Refusal>) -> bool {
    result.is_err_and(|refusal| refusal != Refusal::Conflict)
}

fn has_arrived(point: Vec3, goal: Placed) -> bool {
    distance(point, goal.point) <= ARRIVED * norm(point)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapt::core::access::Exclusive;
    use crate::adapt::tests::bench::{Bench, Random, Shape, sample};
    use crate::geometry::Entity;

    fn is_on_model(worker: &mut Worker<'_, '_, Exclusive>, v: VertexId) -> bool {
        let point = worker.store.position(v);
        distance(point, worker.place(worker.store.entity(v), point, &[v]).point) < 1e-9
    }

    /// Pushes a vertex off the model where its tetrahedra stay positive, and projects it. Returns whether its closest point was out of reach, and
    /// whether it arrived; none where it was not pushed.
    fn push(bench: &mut Bench<'_>, v: VertexId, by: Vec3) -> Option<(bool, bool)> {
        let mut worker = Worker::new(&bench.context, &mut bench.states[0], Exclusive);
        let mut ball = std::mem::take(&mut worker.state.ball);
        worker.gather_ball(v, &mut ball).unwrap();
        let VertexState { placed, hint, .. } = worker.vertex_state(v);
        let point = add(placed.point, by);
        if !worker.is_positive_at(v, point, &ball.tets) {
            return None;
        }
        let to = worker.state_at(Placed { point, ..placed }, hint);
        worker.move_unmeasured(v, &to, &ball.tets, |_| true).unwrap();
        worker.remeasure(&ball.tets);
        let goal = worker.place(placed.entity, point, &[v]);
        let is_out_of_reach = is_refused(worker.arrive(v, &ball.tets, (goal, 0)));
        let has_arrived = !is_out_of_reach || worker.project_ball(v, &ball.tets).is_ok();
        worker.state.ball = ball;
        assert_eq!(has_arrived, is_on_model(&mut worker, v));
        Some((is_out_of_reach, has_arrived))
    }

    #[test]
    fn a_vertex_whose_closest_point_is_out_of_reach_goes_between_its_neighbours() {
        for shape in [Shape::Cube, Shape::Round] {
            let sample = sample(shape, 4, 0.4);
            let mut bench = Bench::new(&sample, 1, 1);
            let mut random = Random(1);
            let (mut out_of_reach, mut arrived) = (0, 0);
            for _ in 0..20 {
                let store = &bench.context.store;
                let vertices: Vec<_> =
                    store.live_vertices().filter(|&v| [1, 2].contains(&store.dimension(v))).collect();
                for v in vertices {
                    if !bench.context.store.is_vertex(v) {
                        continue;
                    }
                    let by = [(); 3].map(|()| 0.2 * (random.below(1001) as f64 / 500.0 - 1.0));
                    if let Some((true, has_arrived)) = push(&mut bench, v, by) {
                        out_of_reach += 1;
                        arrived += usize::from(has_arrived);
                    }
                }
            }
            assert!(out_of_reach > 10 && 2 * arrived > out_of_reach, "{shape:?}: {arrived} of {out_of_reach}");
        }
    }

    /// Vertices that are left, and whether it still waits, after the removal of a vertex that cannot go.
    fn left(or_neighbour: bool) -> (usize, bool) {
        let sample = sample(Shape::Round, 4, 0.4);
        let mut bench = Bench::new(&sample, 1, 1);
        let store = &bench.context.store;
        let corner = store.live_vertices().find(|&v| matches!(store.entity(v), Entity::Vertex(_))).expect("eight");
        let mut worker = Worker::new(&bench.context, &mut bench.states[0], Exclusive);
        let operation = RemoveUnprojected { or_neighbour };
        let result = operation.attempt(&mut worker, &mut CollapseScratch::default(), corner);
        assert_eq!(result.is_ok(), or_neighbour);
        let waits = worker.state.unprojected.contains(&corner);
        bench.check("the removal");
        (bench.context.store.live_vertices().count(), waits)
    }

    #[test]
    fn a_neighbour_goes_where_an_unprojected_vertex_cannot() {
        let (all, waits) = left(false);
        assert!(waits);
        assert_eq!(left(true), (all - 1, true));
    }
}
