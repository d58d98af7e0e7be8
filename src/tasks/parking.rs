//! Where threads are parked: each in a slot of its own, unparked one at a time.
//!
//! A thread that parks first says so, then looks once more for what it waits for. A thread that brings work first leaves it, then
//! looks whether someone is parked. Each has a sequentially consistent fence between its two steps, so at least one sees the other, and no
//! call is lost. tests/parking_protocol.rs runs this file on loom's atomics, through all orders.
use super::sync::atomic::{
    AtomicBool, AtomicUsize,
    Ordering::{Relaxed, SeqCst},
    fence,
};
use super::sync::{Condvar, Mutex, MutexGuard};

/// What a parked thread waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum For {
    /// Any task: [`Parking::unpark_one`] may choose it.
    Work,
    /// Something of its own: only [`Parking::unpark`] reaches it.
    Call,
}

/// The slots, counted from 0.
pub struct Parking {
    /// The threads that are parked for work, the last on top, since its caches are the warmest.
    idle: Mutex<Vec<usize>>,
    /// Length of `idle`, to be looked at without the lock.
    parked: AtomicUsize,
    slots: Vec<Slot>,
}

struct Slot {
    /// Written under the lock. Read without it, so that threads that run are left alone.
    is_parked: AtomicBool,
    signal: Condvar,
}

impl Parking {
    /// So many slots, all empty.
    pub fn new(count: usize) -> Self {
        let slots = (0..count).map(|_| Slot { is_parked: AtomicBool::new(false), signal: Condvar::new() }).collect();
        Self { idle: Mutex::new(Vec::new()), parked: AtomicUsize::new(0), slots }
    }

    /// Parks the thread until it is unparked; not at all if `ready` now. After this the thread looks for everything that it could have been unparked for.
    pub fn park(&self, slot: usize, reason: For, ready: impl Fn() -> bool) {
        let here = &self.slots[slot];
        let mut idle = self.lock();
        here.is_parked.store(true, Relaxed);
        if reason == For::Work {
            idle.push(slot);
            self.parked.store(idle.len(), Relaxed);
        }
        drop(idle);
        fence(SeqCst);
        if ready() {
            let mut idle = self.lock();
            self.clear(&mut idle, slot);
            return;
        }
        let mut idle = self.lock();
        while here.is_parked.load(Relaxed) {
            idle = here.signal.wait(idle).expect("nothing panics under this lock");
        }
    }

    /// Unparks a thread that is parked for work, if there is one. The work must be there already.
    pub fn unpark_one(&self) {
        fence(SeqCst);
        if self.parked.load(Relaxed) > 0 {
            let mut idle = self.lock();
            if let Some(&slot) = idle.last() {
                self.clear(&mut idle, slot);
                drop(idle);
                self.slots[slot].signal.notify_one();
            }
        }
    }

    /// Unparks the thread in this slot, if it is parked. What it waits for must be there already.
    pub fn unpark(&self, slot: usize) {
        fence(SeqCst);
        if self.slots[slot].is_parked.load(Relaxed) {
            let mut idle = self.lock();
            self.clear(&mut idle, slot);
            drop(idle);
            self.slots[slot].signal.notify_one();
        }
    }

    fn clear(&self, idle: &mut Vec<usize>, slot: usize) {
        if let Some(at) = idle.iter().rposition(|&one| one == slot) {
            idle.remove(at);
            self.parked.store(idle.len(), Relaxed);
        }
        self.slots[slot].is_parked.store(false, Relaxed);
    }

    fn lock(&self) -> MutexGuard<'_, Vec<usize>> {
        self.idle.lock().expect("nothing panics under this lock")
    }
}
