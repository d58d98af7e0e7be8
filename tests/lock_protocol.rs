//! The locks of the kernel hold in every order of two threads, and for every value that a load may have by the memory model:
//! loom runs through them all. The lock words are the kernel's own file on loom's atomics; the records about them, relaxed
//! like the store's, are modelled here with the kernel's way of writing, killing and reading them.
use loom::sync;
use loom::sync::Arc;
use loom::sync::atomic::{AtomicU32, Ordering::Relaxed};
use loom::thread;

#[path = "../src/tasks/lock.rs"]
mod lock;
use lock::Claim;

const NONE: u32 = u32::MAX;

/// Lock words of some vertices and the records of two tetrahedra, here of two vertices each.
struct Store {
    locks: Vec<AtomicU32>,
    tets: [[AtomicU32; 2]; 2],
}

impl Store {
    fn new(vertices: usize, tets: [[u32; 2]; 2]) -> Self {
        Self {
            locks: (0..vertices).map(|_| AtomicU32::new(0)).collect(),
            tets: tets.map(|tet| tet.map(AtomicU32::new)),
        }
    }

    fn peek(&self, t: usize) -> [u32; 2] {
        [self.tets[t][0].load(Relaxed), self.tets[t][1].load(Relaxed)]
    }

    fn write(&self, t: usize, vertices: [u32; 2]) {
        for i in 0..2 {
            self.tets[t][i].store(vertices[i], Relaxed);
        }
    }

    /// Claims all or, after giving back what it has, nothing.
    fn claim_all(&self, owner: u32, vertices: &[u32]) -> bool {
        for (n, &v) in vertices.iter().enumerate() {
            match lock::claim(&self.locks[v as usize], owner) {
                Claim::Taken => {}
                Claim::Held => panic!("claimed once only"),
                Claim::Refused => {
                    self.release_all(&vertices[..n]);
                    return false;
                }
            }
        }
        true
    }

    fn release_all(&self, vertices: &[u32]) {
        vertices.iter().for_each(|&v| lock::release(&self.locks[v as usize]));
    }
}

#[test]
fn what_is_written_under_two_locks_is_whole_for_who_gets_one_of_them() {
    loom::model(|| {
        // Both threads count in the record of an edge; they claim its ends in opposite order, and give up on conflict.
        let store = Arc::new(Store::new(2, [[0, 0], [0, 0]]));
        let work = |owner: u32, order: [u32; 2]| {
            let store = Arc::clone(&store);
            move || {
                let done = store.claim_all(owner, &order);
                if done {
                    let [a, b] = store.peek(0);
                    assert_eq!(a, b, "half of another thread's work is seen");
                    store.write(0, [a + 1, b + 1]);
                    store.release_all(&order);
                }
                u32::from(done)
            }
        };
        let first = thread::spawn(work(1, [0, 1]));
        let second = work(2, [1, 0])();
        let done = first.join().unwrap() + second;
        assert_eq!(store.peek(0), [done; 2], "a count was lost");
        // All was given back: nothing stays locked, whoever gave up.
        assert!(store.claim_all(3, &[0, 1]));
    });
}

#[test]
fn a_claim_repeated_by_its_owner_is_held_and_another_is_refused() {
    loom::model(|| {
        let word = AtomicU32::new(0);
        assert_eq!(lock::claim(&word, 1), Claim::Taken);
        assert_eq!(lock::claim(&word, 1), Claim::Held);
        assert_eq!(lock::claim(&word, 2), Claim::Refused);
        lock::release(&word);
        assert_eq!(lock::claim(&word, 2), Claim::Taken);
    });
}

/// Kills the tetrahedron (0, 1) under its locks and uses its id again as (2, 3), later, as a thread does with its free ids.
fn kill_and_use_again(store: &Store) {
    if store.claim_all(1, &[0, 1]) {
        store.write(0, [NONE, NONE]);
        store.release_all(&[0, 1]);
        if store.claim_all(1, &[2, 3]) {
            store.write(0, [2, 3]);
            store.release_all(&[2, 3]);
        }
    }
}

#[test]
fn a_moving_tetrahedron_that_is_claimed_is_whole() {
    loom::model(|| {
        let store = Arc::new(Store::new(4, [[0, 1], [NONE, NONE]]));
        let other = Arc::clone(&store);
        let writer = thread::spawn(move || kill_and_use_again(&other));
        // Worker::claim_moving_tet
        let seen = store.peek(0);
        if !seen.contains(&NONE) && store.claim_all(2, &seen) {
            if store.peek(0) == seen {
                assert!(seen == [0, 1] || seen == [2, 3], "a mixture {seen:?} was claimed");
                assert_eq!(store.peek(0), seen, "it moves though it is claimed");
            }
            store.release_all(&seen);
        }
        writer.join().unwrap();
    });
}

#[test]
fn a_guess_that_shows_a_held_vertex_has_it() {
    loom::model(|| {
        let store = Arc::new(Store::new(4, [[0, 1], [NONE, NONE]]));
        let other = Arc::clone(&store);
        let writer = thread::spawn(move || kill_and_use_again(&other));
        // Worker::tet_with_edge: the edge's end 1 is held, the guess is not.
        if store.claim_all(2, &[1]) {
            let alive = store.peek(0)[1] == 1;
            // If it is there it stays: nobody can kill it now. If it is not, it does not come back.
            assert_eq!(store.peek(0)[1] == 1, alive);
            if alive {
                assert_eq!(store.peek(0), [0, 1], "vertex 1 was seen in a tetrahedron that is not there");
            }
            store.release_all(&[1]);
        }
        writer.join().unwrap();
    });
}
