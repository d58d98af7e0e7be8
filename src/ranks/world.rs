//! The ranks of an MPI.
use super::abort::{abort, caller};
use super::{Ranks, Traffic};
use mpi::environment::{Universe, initialize_with_threading, library_version};
use mpi::point_to_point::{Destination, Source};
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives};
use mpi::{Rank, Threading, request};
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// How long a rank that was left waits for the other's exit to end the run.
const PATIENCE: Duration = Duration::from_secs(5);

/// The exit code of a rank that was left, where the other's exit did not end it.
const LEFT: i32 = 2;

/// The exit code of a panic, as Rust has it.
const PANICKED: i32 = 101;

/// The tag of all messages. One is enough: between two ranks messages keep their order, and a call has received all of its own at its end.
const TAG: i32 = 0;

/// What a rank comes for. All ranks come for the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
enum Purpose {
    Exchange,
    Gather,
    /// The end of this rank's work.
    End,
}

/// All ranks of a run, and this one's number.
pub struct World {
    /// MPI, which ends when this is dropped. None where it must not be ended in good order.
    universe: Option<Universe>,
    rank: usize,
    count: usize,
    /// The longest message of MPI that is sent, bytes.
    piece: usize,
    sent: AtomicU64,
    nanoseconds: AtomicU64,
}

impl World {
    /// Starts MPI on this thread. Collective.
    pub fn start(piece: usize) -> Result<Self, String> {
        assert!((1..=i32::MAX as usize).contains(&piece), "a piece of {piece} bytes");
        let (universe, threading) =
            initialize_with_threading(Threading::Funneled).ok_or("MPI was started before in this process")?;
        if threading < Threading::Funneled {
            return Err(format!("this MPI does not allow threads ({}): build it with them", version()));
        }
        caller::set();
        let world = universe.world();
        let number = |n: Rank| usize::try_from(n).expect("MPI counts from 0");
        let (rank, count) = (number(world.rank()), number(world.size()));
        let universe = Some(universe);
        Ok(Self { universe, rank, count, piece, sent: AtomicU64::new(0), nanoseconds: AtomicU64::new(0) })
    }

    /// Meets all ranks with a number for each, and returns their numbers for this one.
    /// Where one has come to its end the others do not return from here.
    fn meet(&self, purpose: Purpose, numbers: impl Iterator<Item = usize>) -> Vec<usize> {
        assert!(caller::is_this_thread(), "another thread than the one that started MPI calls it");
        let theirs = self.meet_any(purpose, numbers);
        if let Some(rank) = theirs.iter().position(|(theirs, _)| *theirs == Purpose::End as u64) {
            // It says what is wrong, exits, and so ends us all. Whatever was printed here would only hide that.
            thread::sleep(PATIENCE);
            eprintln!("geo-adapt: error: rank {rank} has ended its work, and rank {} still needs it", self.rank);
            abort(LEFT);
        }
        if let Some(rank) = theirs.iter().position(|(theirs, _)| *theirs != purpose as u64) {
            panic!("rank {} comes for {purpose:?}, and rank {rank} for something else", self.rank);
        }
        theirs.into_iter().map(|(_, number)| usize::try_from(number).expect("a number of this machine")).collect()
    }

    /// [`Self::meet`], with what every rank came for.
    fn meet_any(&self, purpose: Purpose, numbers: impl Iterator<Item = usize>) -> Vec<(u64, u64)> {
        let own: Vec<u64> = numbers.flat_map(|number| [purpose as u64, number as u64]).collect();
        assert!(own.len() == 2 * self.count, "{} numbers for {} ranks", own.len() / 2, self.count);
        let mut theirs = vec![0; own.len()];
        SimpleCommunicator::world().all_to_all_into(&own[..], &mut theirs[..]);
        theirs.as_chunks().0.iter().map(|&[purpose, number]| (purpose, number)).collect()
    }

    /// Sends messages to other ranks, and receives from each rank messages of these lengths.
    /// All is on its way at once, so no rank waits for another to listen.
    fn transfer(&self, messages: &[(usize, &[u8])], lengths: &[Vec<usize>]) -> Vec<Vec<Vec<u8>>> {
        let empty = |lengths: &Vec<usize>| lengths.iter().map(|&length| vec![0; length]).collect();
        let mut received: Vec<Vec<Vec<u8>>> = lengths.iter().map(empty).collect();
        let world = SimpleCommunicator::world();
        let process = |rank: usize| world.process_at_rank(Rank::try_from(rank).expect("a rank of MPI"));
        let expected = lengths.iter().flatten().copied();
        let pieces =
            messages.iter().map(|(_, bytes)| bytes.len()).chain(expected).map(|n| n.div_ceil(self.piece)).sum();
        request::multiple_scope(pieces, |scope, requests| {
            for (from, messages) in received.iter_mut().enumerate() {
                for piece in messages.iter_mut().flat_map(|bytes| bytes.chunks_mut(self.piece)) {
                    requests.add(process(from).immediate_receive_into_with_tag(scope, piece, TAG));
                }
            }
            for &(to, bytes) in messages {
                for piece in bytes.chunks(self.piece) {
                    requests.add(process(to).immediate_send_with_tag(scope, piece, TAG));
                }
            }
            requests.wait_all(&mut Vec::with_capacity(pieces));
        });
        received
    }

    /// The lengths of the messages that every rank has for this one; none of its own. `own` are those of the messages to each rank.
    fn lengths(&self, own: &[Vec<usize>]) -> Vec<Vec<usize>> {
        let counts = self.meet(Purpose::Exchange, own.iter().map(Vec::len));
        let bytes = |lengths: &Vec<usize>| lengths.iter().flat_map(|&n| (n as u64).to_le_bytes()).collect::<Vec<u8>>();
        let tables: Vec<Vec<u8>> = own.iter().map(bytes).collect();
        let others = tables.iter().enumerate().filter(|(rank, _)| *rank != self.rank);
        let sent: Vec<(usize, &[u8])> = others.map(|(rank, table)| (rank, &table[..])).collect();
        let others = counts.iter().enumerate().map(|(rank, &count)| if rank == self.rank { 0 } else { count });
        let received = self.transfer(&sent, &others.map(|count| vec![8 * count]).collect::<Vec<_>>());
        let number = |&bytes: &[u8; 8]| usize::try_from(u64::from_le_bytes(bytes)).expect("a length of this machine");
        let lengths = |table: &[u8]| table.as_chunks().0.iter().map(number).collect();
        received.iter().map(|table| lengths(&table[0])).collect()
    }

    fn count_sent(&self, messages: &[(usize, &[u8])]) {
        let bytes = messages.iter().map(|(_, bytes)| bytes.len() as u64).sum();
        self.sent.fetch_add(bytes, Ordering::Relaxed);
    }

    /// Runs a call and counts its time.
    fn timed<T>(&self, call: impl FnOnce() -> T) -> T {
        let began = Instant::now();
        let result = call();
        let nanoseconds = u64::try_from(began.elapsed().as_nanos()).unwrap_or(u64::MAX);
        self.nanoseconds.fetch_add(nanoseconds, Ordering::Relaxed);
        result
    }
}

impl Ranks for World {
    fn rank(&self) -> usize {
        self.rank
    }

    fn count(&self) -> usize {
        self.count
    }

    fn exchange(&self, messages: Vec<(usize, Vec<u8>)>) -> Vec<(usize, Vec<u8>)> {
        self.timed(|| {
            let mut own = vec![Vec::new(); self.count];
            for (to, bytes) in &messages {
                assert!(*to < self.count, "a message to rank {to} of {}", self.count);
                own[*to].push(bytes.len());
            }
            let lengths = self.lengths(&own);
            let others = messages.iter().filter(|(to, _)| *to != self.rank);
            let others: Vec<(usize, &[u8])> = others.map(|(to, bytes)| (*to, &bytes[..])).collect();
            self.count_sent(&others);
            let mut received = self.transfer(&others, &lengths);
            let to_itself = messages.into_iter().filter(|(to, _)| *to == self.rank);
            received[self.rank] = to_itself.map(|(_, bytes)| bytes).collect();
            let with_sender =
                |(from, messages): (usize, Vec<Vec<u8>>)| messages.into_iter().map(move |bytes| (from, bytes));
            received.into_iter().enumerate().flat_map(with_sender).collect()
        })
    }

    fn gather(&self, own: &[u8]) -> Vec<Vec<u8>> {
        self.timed(|| {
            let lengths = self.meet(Purpose::Gather, std::iter::repeat_n(own.len(), self.count));
            let others: Vec<(usize, &[u8])> =
                (0..self.count).filter(|&rank| rank != self.rank).map(|rank| (rank, own)).collect();
            let mut lengths: Vec<Vec<usize>> = lengths.into_iter().map(|length| vec![length]).collect();
            lengths[self.rank].clear();
            self.count_sent(&others);
            let mut received = self.transfer(&others, &lengths);
            received[self.rank] = vec![own.to_vec()];
            received.into_iter().flatten().collect()
        })
    }

    fn traffic(&self) -> Traffic {
        let nanoseconds = self.nanoseconds.load(Ordering::Relaxed);
        Traffic { sent: self.sent.load(Ordering::Relaxed), waited: nanoseconds as f64 * 1e-9 }
    }
}

impl Drop for World {
    /// Ends MPI, which waits for all ranks. Where they do not come to the end too, or this one panics, the end is not a good one.
    fn drop(&mut self) {
        if thread::panicking() {
            abort(PANICKED);
        }
        assert!(caller::is_this_thread(), "another thread than the one that started MPI ends it");
        let theirs = self.meet_any(Purpose::End, std::iter::repeat_n(0, self.count));
        if theirs.iter().any(|(purpose, _)| *purpose != Purpose::End as u64) {
            // The others wait for this process to exit.
            std::mem::forget(self.universe.take());
        }
    }
}

/// The MPI that this program is linked with, in one line.
pub fn version() -> String {
    let said = library_version().unwrap_or_default();
    said.lines().next().and_then(|line| line.split(',').next()).unwrap_or("of unknown name").trim().to_owned()
}
