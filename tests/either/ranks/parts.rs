//! What a rank does in a test. A rank that finds something wrong panics, and so ends the run with an exit code that is not 0.
use super::PART;
use geo_adapt::ranks::{Ranks, abort, agree, broadcast, start, start_in_pieces, sum, sum_reals};
use std::time::{Duration, Instant};

/// Plays the part that the environment names, and nothing where it names none.
#[test]
fn play() {
    let Ok(part) = std::env::var(PART) else { return };
    match part.as_str() {
        "start" => match start() {
            Ok(ranks) => println!("rank {} of {} started", ranks.rank(), ranks.count()),
            Err(error) => println!("{error}"),
        },
        "exchange" => exchange(&*start().unwrap()),
        "pieces" => exchange(&*start_in_pieces(1000).unwrap()),
        "large" => large(&*start().unwrap()),
        "agree" => errors(&*start().unwrap()),
        "together" => together(&*start().unwrap()),
        other => fail(&*start().unwrap(), other),
    }
}

/// Random numbers, the same on every rank for one seed (splitmix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }
}

/// The messages of one rank to another in a round: none, one or many; empty, short, long.
fn messages(round: usize, from: usize, to: usize) -> Vec<Vec<u8>> {
    let mut random = Random((round * 10_000 + from * 100 + to) as u64);
    let count = [0, 1, 7, 300][random.next() as usize % 4];
    let message = |k: usize| {
        let most = if k == 0 && round.is_multiple_of(4) { 5_000_000 } else { 5000 };
        let length = [0, 1, 1000, random.next() as usize % most][random.next() as usize % 4];
        let mut bytes = Vec::with_capacity(length + 8);
        while bytes.len() < length {
            bytes.extend(random.next().to_le_bytes());
        }
        bytes.truncate(length);
        bytes
    };
    (0..count).map(message).collect()
}

/// Every rank knows what every other says, and so what it must hear.
fn exchange(ranks: &dyn Ranks) {
    let (own, count) = (ranks.rank(), ranks.count());
    let mut sent = 0;
    for round in 0..24 {
        // Given in an order of its own: what counts is that of the messages to one rank.
        let mut to_say: Vec<_> = (0..count).rev().map(|to| (to, messages(round, own, to).into_iter())).collect();
        let mut said = Vec::new();
        while !to_say.is_empty() {
            to_say.retain_mut(|(to, messages)| messages.next().map(|bytes| said.push((*to, bytes))).is_some());
        }
        sent += said.iter().filter(|(to, _)| *to != own).map(|(_, bytes)| bytes.len() as u64).sum::<u64>();
        let heard = ranks.exchange(said);
        let expected =
            (0..count).flat_map(|from| messages(round, from, own).into_iter().map(move |bytes| (from, bytes)));
        let expected: Vec<_> = expected.collect();
        // Not by assert_eq: it would print megabytes.
        assert!(heard.len() == expected.len(), "round {round}: {} messages of {}", heard.len(), expected.len());
        for (k, (heard, expected)) in heard.iter().zip(&expected).enumerate() {
            assert!(heard == expected, "round {round}, message {k}: from {}, not {}, or damaged", heard.0, expected.0);
        }
    }
    assert_eq!(ranks.traffic().sent, sent);
    assert!(sent > 1_000_000 && ranks.traffic().waited > 0.0, "{:?}", ranks.traffic());
    println!("rank {own} of {count} heard all");
}

/// More bytes in one message than MPI's count can say.
fn large(ranks: &dyn Ranks) {
    let length = (1usize << 31) + 12_345;
    let (own, count) = (ranks.rank(), ranks.count());
    let mut bytes = vec![own as u8; if own == 0 { length } else { 0 }];
    if own == 0 {
        (0..length).step_by(4096).for_each(|k| bytes[k] = (k >> 12) as u8);
    }
    let heard = ranks.exchange(vec![((own + 1) % count, bytes)]);
    assert!(heard.len() == 1 && heard[0].0 == (own + count - 1) % count);
    let bytes = &heard[0].1;
    assert_eq!(bytes.len(), if own == 1 { length } else { 0 });
    assert!((0..bytes.len()).step_by(4096).all(|k| bytes[k] == (k >> 12) as u8));
    assert_eq!(bytes.iter().skip(1).step_by(4096).filter(|&&byte| byte != 0).count(), 0);
    println!("rank {own} of {count} heard all");
}

/// One rank has an error, then two, then none.
fn errors(ranks: &dyn Ranks) {
    let own = ranks.rank();
    let with_error = |wrong: &[usize]| {
        let result = if wrong.contains(&own) { Err(format!("file {own} is damaged")) } else { Ok(own) };
        agree(ranks, result)
    };
    assert_eq!(with_error(&[]), Ok(own));
    assert_eq!(with_error(&[2]), Err("rank 2: file 2 is damaged".to_owned()));
    assert_eq!(with_error(&[2, 1]), Err("rank 1: file 1 is damaged".to_owned()));
    assert_eq!(with_error(&[]), Ok(own));
    println!("rank {own} of {} heard all", ranks.count());
}

fn together(ranks: &dyn Ranks) {
    let (own, count) = (ranks.rank(), ranks.count());
    let all = ranks.gather(&vec![own as u8; 1000 * own]);
    assert_eq!(all, (0..count).map(|rank| vec![rank as u8; 1000 * rank]).collect::<Vec<_>>());
    let expected = (0..count as u64).sum::<u64>();
    assert_eq!(sum(ranks, &[own as u64, 1, u64::from(own == 0) * (1 << 63)]), [expected, count as u64, 1 << 63]);
    // In the order of ranks: (1 + 1e16) + 1e16 is not what other orders give.
    let terms = [1.0, 1e16, -1e16];
    assert_eq!(sum_reals(ranks, &[terms[own % 3]]), [terms.iter().take(count).sum::<f64>()]);
    assert_eq!(broadcast(ranks, format!("of rank {own}").as_bytes()), b"of rank 0");
    println!("rank {own} of {count} heard all");
}

/// Something happens to rank 1, for which the others wait. None comes to the end of this.
fn fail(ranks: &dyn Ranks, how: &str) {
    let own = ranks.rank();
    let pids = ranks.gather(&std::process::id().to_le_bytes());
    if own == 0 {
        let pids = pids.iter().map(|pid| u32::from_le_bytes(pid[..].try_into().unwrap()));
        pids.for_each(|pid| println!("process {pid}"));
    }
    // Nobody fails before this is said.
    ranks.gather(&[]);
    if own != 1 {
        ranks.exchange(Vec::new());
        unreachable!("rank 1 does not come");
    }
    match how {
        "killed" => {
            // SAFETY: a signal to this process itself.
            unsafe { libc::kill(libc::getpid(), libc::SIGKILL) };
            std::thread::sleep(Duration::from_secs(60));
        }
        "exits" => std::process::exit(5),
        "aborts" => abort(7),
        "aborts on a thread" => std::thread::scope(|scope| drop(scope.spawn(|| abort(7)))),
        "panics" => panic!("rank 1 has a mistake"),
        "other call" => drop(ranks.gather(&[])),
        // As a function that returns an error with `?`: what was wrong is said after its values are dropped.
        "leaves" => {}
        other => panic!("no part {other}"),
    }
}

/// The part of a rank that returns an error without asking the others.
#[test]
fn leave() {
    let Ok(part) = std::env::var(PART) else { return };
    assert_eq!(part, "leaves");
    let began = Instant::now();
    fail(&*start().unwrap(), &part);
    assert!(began.elapsed() < Duration::from_secs(30));
    // Others are still running, and must leave us the time to say it.
    std::thread::sleep(Duration::from_millis(300));
    eprintln!("rank 1 found no file");
    std::process::exit(4);
}
