//! Results keep the order of the items, whatever the threads.
use crate::each_plan;
use geo_adapt::tasks::{Plan, Pool};

#[test]
fn mapped_chunks_are_in_order() {
    each_plan(7, |pool, plan| {
        for items in [0, 1, 7, 8, 1000] {
            let chunks = pool.map_chunks(plan, items, |_, range| range);
            assert_eq!(chunks.len(), items.div_ceil(7));
            assert_eq!(chunks.into_iter().flatten().collect::<Vec<_>>(), (0..items).collect::<Vec<_>>());
        }
    });
}

#[test]
fn collected_items_are_in_order() {
    let kept = |item: usize| item.wrapping_mul(2_654_435_761).is_multiple_of(3);
    let wanted: Vec<_> = (0..5000).filter(|&item| kept(item)).collect();
    each_plan(64, |pool, plan| {
        let found = pool.collect(plan, 5000, |_, range, found| found.extend(range.filter(|&item| kept(item))));
        assert_eq!(found, wanted, "{plan:?}");
    });
}

#[test]
fn sums_of_floats_are_the_same_to_the_bit() {
    let sum = |pool: &Pool, plan| -> f64 {
        pool.map_chunks(plan, 10_000, |_, range| range.map(|i| 1.0 / (1.0 + i as f64)).sum::<f64>()).iter().sum()
    };
    let wanted = sum(&Pool::new(1).unwrap(), Plan::of_grain(100)).to_bits();
    each_plan(100, |pool, plan| assert_eq!(sum(pool, plan).to_bits(), wanted, "{plan:?}"));
}

#[test]
fn slices_are_changed_chunk_by_chunk() {
    each_plan(9, |pool, plan| {
        let mut items = vec![0; 100];
        pool.for_each_chunk_mut(plan, &mut items, |_, start, chunk| {
            chunk.iter_mut().enumerate().for_each(|(i, item)| *item += start + i);
        });
        assert_eq!(items, (0..100).collect::<Vec<_>>());
    });
}

#[test]
fn each_thread_has_its_state() {
    each_plan(3, |pool, plan| {
        let mut states = vec![Vec::new(); pool.threads()];
        pool.task_for_with(plan, 200, &mut states, |state, thread, range| {
            state.extend(range.map(|item| (item, thread)))
        });
        for (thread, state) in states.iter().enumerate() {
            assert!(state.iter().all(|&(_, by)| by == thread));
        }
        let mut items: Vec<_> = states.into_iter().flatten().map(|(item, _)| item).collect();
        items.sort_unstable();
        assert_eq!(items, (0..200).collect::<Vec<_>>(), "{plan:?}");
    });
}
