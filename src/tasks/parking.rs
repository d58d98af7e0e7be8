//! Where threads sleep: a seat a thread, woken one at a time.
//!
//! A thread that goes to sleep first says so, then looks once more for what it waits for. A thread that brings work first leaves it, then
//! looks whether someone sleeps. Each has a sequentially consistent fence between its two steps, so at least one sees the other, and no
//! call is lost. tests/sleep_protocol.rs runs this file on loom's atomics, through all orders.
use super::sync::atomic::{
    AtomicBool, AtomicUsize,
    Ordering::{Relaxed, SeqCst},
    fence,
};
use super::sync::{Condvar, Mutex, MutexGuard};

/// What a sleeper waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum For {
    /// Any task: [`Seats::wake_one`] may choose it.
    Work,
    /// Something of its own: only [`Seats::wake`] reaches it.
    Call,
}

/// Seats, counted from 0.
pub struct Seats {
    /// The threads that sleep for work, the last to fall asleep on top, since its caches are the warmest.
    idle: Mutex<Vec<usize>>,
    /// Length of `idle`, to be looked at without the lock.
    sleepers: AtomicUsize,
    seats: Vec<Seat>,
}

struct Seat {
    /// Written under the lock. Read without it, so that threads that are awake are left alone.
    asleep: AtomicBool,
    bell: Condvar,
}

impl Seats {
    /// So many seats, all empty.
    pub fn new(seats: usize) -> Self {
        let seats = (0..seats).map(|_| Seat { asleep: AtomicBool::new(false), bell: Condvar::new() }).collect();
        Self { idle: Mutex::new(Vec::new()), sleepers: AtomicUsize::new(0), seats }
    }

    /// Sleeps until woken; not at all if `ready` now. After this the thread looks for everything that it could have been woken for.
    pub fn sleep(&self, seat: usize, reason: For, ready: impl Fn() -> bool) {
        let chair = &self.seats[seat];
        let mut idle = self.lock();
        chair.asleep.store(true, Relaxed);
        if reason == For::Work {
            idle.push(seat);
            self.sleepers.store(idle.len(), Relaxed);
        }
        drop(idle);
        fence(SeqCst);
        if ready() {
            let mut idle = self.lock();
            self.rouse(&mut idle, seat);
            return;
        }
        let mut idle = self.lock();
        while chair.asleep.load(Relaxed) {
            idle = chair.bell.wait(idle).expect("nothing panics under this lock");
        }
    }

    /// Wakes a thread that sleeps for work, if there is one. The work must be there already.
    pub fn wake_one(&self) {
        fence(SeqCst);
        if self.sleepers.load(Relaxed) > 0 {
            let mut idle = self.lock();
            if let Some(&seat) = idle.last() {
                self.rouse(&mut idle, seat);
                drop(idle);
                self.seats[seat].bell.notify_one();
            }
        }
    }

    /// Wakes the thread on this seat, if it sleeps. What it waits for must be there already.
    pub fn wake(&self, seat: usize) {
        fence(SeqCst);
        if self.seats[seat].asleep.load(Relaxed) {
            let mut idle = self.lock();
            self.rouse(&mut idle, seat);
            drop(idle);
            self.seats[seat].bell.notify_one();
        }
    }

    fn rouse(&self, idle: &mut Vec<usize>, seat: usize) {
        if let Some(at) = idle.iter().rposition(|&one| one == seat) {
            idle.remove(at);
            self.sleepers.store(idle.len(), Relaxed);
        }
        self.seats[seat].asleep.store(false, Relaxed);
    }

    fn lock(&self) -> MutexGuard<'_, Vec<usize>> {
        self.idle.lock().expect("nothing panics under this lock")
    }
}
