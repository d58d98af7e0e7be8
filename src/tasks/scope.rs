//! Tasks spawned one by one.
use super::group::Group;
use super::in_place::InPlace;
use super::job::{Job, Lane, Queue};
use super::place;
use std::marker::PhantomData;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Spawns tasks and waits for them; see [`super::Pool::scope`]. Tasks may borrow what lives longer than `'scope`.
pub struct Scope<'l, 'scope> {
    queue: &'l dyn Queue,
    group: &'l Group,
    /// With one thread, where spawned tasks run at once.
    in_place: Option<&'l InPlace<'l>>,
    /// Makes the lifetime invariant.
    scope: PhantomData<fn(&'scope ()) -> &'scope ()>,
}

/// What a task knows of itself.
pub struct Task<'l, 'scope> {
    lane: &'l Lane<'l>,
    group: &'l Group,
    scope: PhantomData<fn(&'scope ()) -> &'scope ()>,
}

impl<'l, 'scope> Scope<'l, 'scope> {
    pub(super) fn new(queue: &'l dyn Queue, group: &'l Group, in_place: Option<&'l InPlace<'l>>) -> Self {
        Self { queue, group, in_place, scope: PhantomData }
    }

    /// Spawns a task. It may have begun, or even ended, when this returns.
    pub fn spawn<F>(&self, f: F)
    where
        F: FnOnce(&Task<'_, 'scope>) + Send + 'scope,
    {
        let Some(in_place) = self.in_place else { return spawn(self.group, self.queue, f) };
        let lane = in_place.lane();
        if let Err(panic) = catch_unwind(AssertUnwindSafe(|| call(f, &lane, self.group))) {
            self.group.fail(panic);
        }
        in_place.wait(self.group);
    }

    /// Waits until all tasks of the scope have ended, those spawned by tasks too. For the body only: a task cannot wait for itself.
    ///
    /// # Panics
    /// When one of them did.
    pub fn wait_all(&self) {
        self.queue.wait(self.group);
        self.group.resume();
    }
}

impl<'scope> Task<'_, 'scope> {
    /// Id of the thread that runs it, the same for its whole length.
    pub fn thread(&self) -> usize {
        self.lane.thread
    }

    /// Spawns another task of the scope. It does not begin on this thread before this task has ended.
    pub fn spawn<F>(&self, f: F)
    where
        F: FnOnce(&Task<'_, 'scope>) + Send + 'scope,
    {
        spawn(self.group, self.lane.queue, f);
    }
}

fn spawn<'scope, F>(group: &Group, queue: &dyn Queue, f: F)
where
    F: FnOnce(&Task<'_, 'scope>) + Send + 'scope,
{
    /// The group, for the task itself.
    struct Of(*const Group);
    // SAFETY: a group is Sync.
    unsafe impl Send for Of {}
    let of = Of(group);
    group.add();
    let run = move |lane: &Lane<'_>| {
        let of: Of = of;
        // SAFETY: the group stays until this task is counted, which is after this closure.
        call(f, lane, unsafe { &*of.0 });
    };
    // SAFETY: `Pool::scope` does not return before the group is done, whatever its body does, and 'scope is longer than that call.
    queue.push(unsafe { Job::once(Box::new(run), group) });
}

fn call<'scope, F: FnOnce(&Task<'_, 'scope>)>(f: F, lane: &Lane<'_>, group: &Group) {
    let _in_task = place::mark(true);
    f(&Task { lane, group, scope: PhantomData });
}
