//! A loop or scope within a task. Its tasks have a queue of their own, so that the thread which waits for them runs these and no others.
//! Other threads are called to help through the back-end.
use super::core::Core;
use super::group::Group;
use super::job::{Job, Lane, Queue, Submit};
use super::parking::For;
use super::place::Place;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard};

/// The queue of a nested group.
pub struct Nested {
    state: Mutex<State>,
    /// Slot of who waits.
    waiter: usize,
}

struct State {
    jobs: VecDeque<Job>,
    /// Calls for help that have not been answered by an empty queue yet.
    calls: usize,
}

impl Nested {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().expect("nothing panics under this lock")
    }
}

/// The queue as one thread sees it.
struct Side<'a> {
    nested: &'a Arc<Nested>,
    /// The thread that runs tasks here while it waits; none for a thread without an id.
    thread: Option<usize>,
    core: &'a Core,
    base: &'a dyn Submit,
}

/// Calls `body` with the queue of a new group within the task at `place`, and waits for the tasks that it puts there.
pub fn run(core: &Core, base: &dyn Submit, place: Place, group: &Group, body: &mut dyn FnMut(&dyn Queue)) {
    let state = State { jobs: VecDeque::new(), calls: 0 };
    let nested = Arc::new(Nested { state: Mutex::new(state), waiter: group.waiter() });
    let side = Side { nested: &nested, thread: place.thread, core, base };
    body(&side);
    side.wait(group);
}

/// Runs tasks of the nested group, the oldest first, until there is none in its queue.
pub fn help(nested: &Arc<Nested>, lane: &Lane<'_>) {
    let side = Side { nested, thread: Some(lane.thread), core: lane.core, base: lane.base };
    let lane = Lane { queue: &side, ..*lane };
    loop {
        let mut state = nested.lock();
        let Some(job) = state.jobs.pop_front() else {
            state.calls -= 1;
            return;
        };
        drop(state);
        job.run(&lane);
    }
}

impl Queue for Side<'_> {
    fn push(&self, job: Job) {
        let mut state = self.nested.lock();
        state.jobs.push_back(job);
        let call = state.calls < self.core.threads;
        state.calls += usize::from(call);
        drop(state);
        self.core.parking.unpark(self.nested.waiter);
        if call {
            self.base.submit(Job::help(Arc::clone(self.nested)));
        }
    }

    fn wait(&self, group: &Group) {
        let Some(thread) = self.thread else { return group.sleep(self.core) };
        let lane = Lane { thread, core: self.core, queue: self, base: self.base };
        while !group.is_done() {
            let job = self.nested.lock().jobs.pop_back();
            match job {
                Some(job) => job.run(&lane),
                None => {
                    let ready = || group.is_done() || !self.nested.lock().jobs.is_empty();
                    self.core.parking.park(self.nested.waiter, For::Call, ready);
                }
            }
        }
    }
}
