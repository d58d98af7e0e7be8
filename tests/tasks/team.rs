//! What a team makes of many items does not depend on its threads.
use crate::each_plan;
use geo_adapt::tasks::{Pool, Rows, Team};

/// Numbers in no order, some of them more than once.
fn scattered(count: u32, below: u32) -> impl Fn(usize) -> u32 {
    move |item| ((item as u32).wrapping_mul(2_654_435_761) >> 7) % count % below
}

fn each_team(grain: usize, mut test: impl FnMut(Team<'_>)) {
    test(Team::alone());
    each_plan(grain, |pool: &Pool, plan| test(Team::new(pool, plan)));
}

#[test]
fn lists_are_in_the_order_of_their_items() {
    let value = scattered(u32::MAX, 1000);
    each_team(1, |team| {
        for items in [0, 1, 7, 64, 3001] {
            assert!(team.map(64, items, &value).into_iter().eq((0..items).map(&value)));
            let odd = |item: &usize| value(*item) % 2 == 1;
            let found = team.collect(64, items, |range, found| found.extend(range.filter(odd)));
            assert!(found.into_iter().eq((0..items).filter(odd)));
            let mut slice = vec![0; items];
            team.fill(64, &mut slice, |start, chunk| (start..).zip(chunk).for_each(|(item, slot)| *slot += item));
            assert!(slice.iter().copied().eq(0..items));
            let parts = [&slice[..items / 3], &[], &slice[items / 3..]];
            assert_eq!(team.join_slices(parts.into_iter()), slice);
        }
    });
}

#[test]
fn sums_are_the_same_to_the_bit() {
    let sum = |team: Team<'_>| team.sum(100, 10_007, |range| range.map(|i| 1.0 / (1.0 + i as f64)).sum()).to_bits();
    each_team(1, |team| assert_eq!(sum(team), sum(Team::alone())));
}

#[test]
fn sorted_as_by_one_thread() {
    for (count, below) in [(0, 1), (1, 1), (600, 7), (5000, 5000), (10_000, 300)] {
        let value = scattered(u32::MAX, below);
        let items: Vec<(u32, usize)> = (0..count).map(|item| (value(item), item)).collect();
        let mut expected = items.clone();
        expected.sort_unstable();
        each_team(1, |team| {
            let mut sorted = items.clone();
            team.sort(&mut sorted);
            assert_eq!(sorted, expected);
            // Backwards, and what is in order already.
            team.sort_by(&mut sorted, |a, b| b.cmp(a));
            assert!(sorted.iter().eq(expected.iter().rev()));
            team.sort_by(&mut sorted, |a, b| b.cmp(a));
            assert!(sorted.iter().eq(expected.iter().rev()));
        });
    }
}

#[test]
fn rows_hold_the_entries_of_their_keys() {
    const KEYS: usize = 37;
    let key = scattered(u32::MAX, KEYS as u32 + 3);
    // Every third entry, and a few keys too high, go nowhere.
    let kept = |entry: usize| !entry.is_multiple_of(3) && key(entry) < KEYS as u32;
    for items in [0, 5, 20_000] {
        each_team(1, |team| {
            let rows = Rows::by_key::<2>(team, KEYS, items, |item| {
                [2 * item, 2 * item + 1].map(|entry| if kept(entry) { key(entry) } else { Rows::NOWHERE })
            });
            assert_eq!(rows.len(), KEYS);
            let of_key = |of: usize| {
                (0..2 * items).filter(|&e| kept(e) && key(e) as usize == of).map(|e| e as u32).collect::<Vec<_>>()
            };
            for of in 0..KEYS {
                assert!(rows.row(of) == of_key(of), "key {of}");
            }
            assert!(rows.into_entries().into_iter().eq((0..KEYS).flat_map(of_key)));
            // The same by the elements of nodes: each entry is an element.
            let nodes: Vec<[u32; 2]> =
                (0..items).map(|item| [key(2 * item), key(2 * item + 1)].map(|k| k % KEYS as u32)).collect();
            let rows = Rows::at_nodes(team, &nodes, KEYS);
            for of in 0..KEYS as u32 {
                let expected =
                    nodes.iter().zip(0..).flat_map(|(pair, i)| pair.iter().filter(move |&&n| n == of).map(move |_| i));
                assert!(rows.row(of as usize).iter().copied().eq(expected), "node {of}");
            }
        });
    }
}
