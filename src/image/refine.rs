//! The refinement. Each task has a list of items of its own, and gives half of it away when another thread has nothing to do. Items that
//! ended in a conflict are tried again.
//!
//! A new tetrahedron is judged by the thread that made it, which puts it into the list it works on. Faces of surfaces go first.
use super::delaunay::{Scratch, Worker, enclose};
use super::domain::Domain;
use super::list::{Counts, List};
use super::rules::{Error, Item, Limits, Part, Rules, Wish};
use super::seeds;
use super::store::{Access, Alone, NONE, Refusal, Role, Store};
use crate::mesh::adjacency::FACES;
use crate::mesh::vector::distance;
use crate::tasks::claims::Claims;
use crate::tasks::{Backend, Pool, Task};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};

/// After so many items a task looks whether another thread has nothing to do.
const BATCH: usize = 32;

/// After so many conflicts in a row a task ends, and another takes its list: the mesh is too small for so many threads.
const IN_THE_WAY: usize = 8;

/// What a thread has in hand.
#[derive(Default)]
struct Hand {
    scratch: Scratch,
    counts: Counts,
}

/// What all tasks share while the room lasts.
struct Shared<'a> {
    store: &'a Store,
    domain: &'a Domain,
    limits: &'a Limits,
    hands: &'a [Mutex<Hand>],
    /// Tasks that were spawned and have not ended.
    tasks: AtomicUsize,
    /// Items left when there was no room.
    /// Also those of tasks that were in another's way.
    left: Mutex<List>,
    full: AtomicBool,
}

/// Refines until every tetrahedron and face of the surfaces is within the limits, or can be no better.
///
/// # Errors
/// When there would be too many tetrahedra.
pub fn mesh(domain: &Domain, wish: Wish, pool: &Pool, backend: Backend) -> Result<(Store, Limits, Counts), Error> {
    let limits = Limits::new(wish, domain)?;
    let mut hands: Vec<Mutex<Hand>> = (0..pool.threads()).map(|_| Mutex::default()).collect();
    let first = hands[0].get_mut().expect("no thread has begun");
    let mut store = enclose(domain, &mut first.scratch);
    plant(domain, &limits, &mut store, first)?;
    let mut list = judge_all(domain, &limits, &store);
    while list.len() > 0 {
        let (left, full) = round(&Rules { store: &store, domain, limits: &limits }, &hands, list, pool, backend);
        if full && !store.grow((store.tet_bound() as usize).max(1 << 16)) {
            return Err(Error::Full);
        }
        list = left;
    }
    let mut counts = Counts::default();
    for hand in hands {
        counts.add(&hand.into_inner().expect("a panic would have gone on").counts);
    }
    Ok((store, limits, counts))
}

/// Inserts the first points.
fn plant(domain: &Domain, limits: &Limits, store: &mut Store, hand: &mut Hand) -> Result<(), Error> {
    let mut start = 0;
    for centre in seeds::centres(domain) {
        loop {
            let mut worker = Worker { store, domain, access: Alone, scratch: &mut hand.scratch };
            match seeds::plant(&mut worker, centre, limits.nearest, &mut start) {
                Ok(()) => break,
                // Again with more room: what is there already stays.
                Err(_) if store.grow(store.tet_bound() as usize) => {}
                Err(_) => return Err(Error::Full),
            }
        }
    }
    Ok(())
}

/// All items of the mesh so far.
fn judge_all(domain: &Domain, limits: &Limits, store: &Store) -> List {
    let rules = Rules { store, domain, limits };
    let mut list = List::default();
    for t in (0..store.tet_bound()).filter(|&t| store.nodes(t)[0] != NONE) {
        list.tets.extend(rules.tet(t));
        let neighbours = store.neighbours(t);
        list.faces.extend((0..4).filter(|&i| t < neighbours[i]).filter_map(|i| rules.face(t, i, neighbours[i])));
    }
    list
}

/// Works on a list with all threads until it is empty, or there is no room, or all got into each other's way: what is left, and whether
/// there was no room.
fn round(rules: &Rules<'_>, hands: &[Mutex<Hand>], list: List, pool: &Pool, backend: Backend) -> (List, bool) {
    let Rules { store, domain, limits } = *rules;
    let shared = Shared {
        store,
        domain,
        limits,
        hands,
        tasks: AtomicUsize::new(1),
        left: Mutex::default(),
        full: AtomicBool::new(false),
    };
    pool.scope(backend, |scope| {
        let shared = &shared;
        scope.spawn(move |task| shared.work(task, list));
    });
    (shared.left.into_inner().expect("a panic would have gone on"), shared.full.into_inner())
}

impl<'a> Shared<'a> {
    /// A task: works on its list, gives half of it away when there are too few tasks, and all of it when it is in another's way.
    fn work<'s>(&'s self, task: &Task<'_, 's>, mut list: List) {
        let mut hand =
            self.hands[task.thread()].try_lock().expect("tasks wait for nothing, so each has its thread's hand");
        if self.hands.len() == 1 {
            self.work_with(Alone, &mut hand, &mut list, task);
        } else {
            self.work_with(Claims::new(task.thread()), &mut hand, &mut list, task);
        }
        if list.len() > 0 {
            self.left.lock().expect("nothing panics under this lock").append(list);
        }
        self.tasks.fetch_sub(1, Relaxed);
    }

    fn work_with<'s, A: Access>(&'s self, access: A, hand: &mut Hand, list: &mut List, task: &Task<'_, 's>) {
        let mut worker = Worker { store: self.store, domain: self.domain, access, scratch: &mut hand.scratch };
        let counts = &mut hand.counts;
        let (mut until_look, mut in_the_way) = (BATCH, 0);
        while let Some(mut item) = list.pop() {
            let result = self.attempt(&mut worker, item, list);
            worker.access.release(self.store);
            counts.attempts += 1;
            in_the_way = if result == Err(Refusal::Conflict) { in_the_way + 1 } else { 0 };
            match result {
                Ok(Role::Inner) => counts.inner_points += 1,
                Ok(_) => counts.surface_points += 1,
                Err(Refusal::Stale) => counts.stale += 1,
                Err(Refusal::Crowded) => counts.crowded += 1,
                Err(Refusal::Lost) => counts.lost += 1,
                Err(Refusal::Encroaching) if item.patience == 0 => counts.crowded += 1,
                Err(Refusal::Encroaching) => {
                    counts.put_off += 1;
                    item.patience -= 1;
                    list.push(item);
                }
                Err(Refusal::Conflict) => {
                    counts.conflicts += 1;
                    list.push(item);
                }
                Err(Refusal::Full) => {
                    list.push(item);
                    self.full.store(true, Relaxed);
                }
            }
            if in_the_way >= IN_THE_WAY || self.full.load(Relaxed) {
                return;
            }
            if self.hands.len() == 1 {
                continue;
            }
            until_look -= 1;
            if until_look == 0 || list.len() == 0 {
                until_look = BATCH;
                list.append(std::mem::take(&mut *self.left.lock().expect("nothing panics under this lock")));
                if list.len() >= BATCH && self.tasks.load(Relaxed) < 2 * self.hands.len() {
                    let half = list.split();
                    self.tasks.fetch_add(1, Relaxed);
                    task.spawn(move |task| self.work(task, half));
                }
            }
        }
    }

    /// Inserts the point of an item, if it is still called for, and lists what came with it.
    fn attempt<A: Access>(&self, worker: &mut Worker<'_, A>, item: Item, list: &mut List) -> Result<Role, Refusal> {
        worker.claim_tet(item.tet, item.nodes)?;
        let rules = Rules { store: self.store, domain: self.domain, limits: self.limits };
        let role = match item.part {
            Part::Whole => {
                worker.dig(item.at, item.tet)?;
                self.make_way(worker, &rules, item, list)?;
                Role::Inner
            }
            Part::Face(i, beyond) => {
                let n = self.store.neighbours(item.tet)[i as usize];
                if n == NONE || !self.store.nodes(n).contains(&beyond) {
                    return Err(Refusal::Stale);
                }
                let start = if worker.in_conflict(item.tet, item.at) {
                    item.tet
                } else if worker.in_conflict(n, item.at) {
                    worker.access.claim(self.store, beyond)?;
                    n
                } else {
                    return Err(Refusal::Lost);
                };
                worker.dig(item.at, start)?;
                Role::Surface
            }
        };
        if worker.room(item.at) < self.limits.nearest {
            return Err(Refusal::Crowded);
        }
        worker.fill(item.at, role)?;
        for &t in &worker.scratch.fresh {
            rules.tet(t).into_iter().for_each(|item| list.push(item));
            let neighbours = self.store.neighbours(t);
            for i in 0..4 {
                // A face between two new ones is judged once.
                if i == 3 || t < neighbours[i] {
                    rules.face(t, i, neighbours[i]).into_iter().for_each(|item| list.push(item));
                }
            }
        }
        Ok(role)
    }

    /// Lists the faces of surfaces whose balls the new point inside would lie in: these are refined first.
    fn make_way<A: Access>(
        &self,
        worker: &Worker<'_, A>,
        rules: &Rules<'_>,
        item: Item,
        list: &mut List,
    ) -> Result<(), Refusal> {
        let store = self.store;
        let mut result = Ok(());
        for &t in &worker.scratch.cavity {
            let neighbours = store.neighbours(t);
            for i in (0..4).filter(|&i| neighbours[i] != NONE) {
                let n = neighbours[i];
                let Some(ball) = rules.surface_ball(t, i, n) else { continue };
                if distance(ball.centre, item.at) < ball.radius
                    && FACES[i].iter().all(|&k| store.role(store.nodes(t)[k]) == Role::Surface)
                {
                    if ball.radius <= self.limits.nearest {
                        return Err(Refusal::Crowded);
                    }
                    list.push(rules.face_item(t, store.nodes(t), i, n, ball.centre));
                    result = Err(Refusal::Encroaching);
                }
            }
        }
        result
    }
}
