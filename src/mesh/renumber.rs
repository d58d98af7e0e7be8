//! Numbers from 0 on for the nodes of some elements.

/// A node that no element has.
const NONE: u32 = u32::MAX;

/// Numbers nodes anew, from 0 on in their order. Returns the numbers that they had, shape (n,), ascending.
pub fn renumbered(lists: &mut [&mut [u32]]) -> Vec<u32> {
    let nodes = || lists.iter().flat_map(|list| list.iter().copied());
    let least = nodes().min().unwrap_or(0);
    let span = nodes().max().map_or(0, |greatest| (greatest - least) as usize + 1);
    if span > lists.iter().map(|list| list.len()).sum() {
        return renumbered_far(lists);
    }
    // They lie close together, as in most files: a place for each number between.
    let mut place = vec![NONE; span];
    nodes().for_each(|v| place[(v - least) as usize] = 0);
    let is_used = place.iter().zip(least..).filter(|(place, _)| **place == 0);
    let numbers: Vec<u32> = is_used.map(|(_, v)| v).collect();
    numbers.iter().zip(0..).for_each(|(v, at)| place[(v - least) as usize] = at);
    lists.iter_mut().flat_map(|list| list.iter_mut()).for_each(|v| *v = place[(*v - least) as usize]);
    numbers
}

/// The same of numbers far apart.
fn renumbered_far(lists: &mut [&mut [u32]]) -> Vec<u32> {
    let mut numbers: Vec<u32> = lists.iter().flat_map(|list| list.iter().copied()).collect();
    numbers.sort_unstable();
    numbers.dedup();
    let place = |v: u32| numbers.partition_point(|&number| number < v) as u32;
    lists.iter_mut().flat_map(|list| list.iter_mut()).for_each(|v| *v = place(*v));
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_keep_their_order() {
        for step in [1, 1000] {
            let mut lists =
                [vec![5, 9, 7], vec![9, 6]].map(|list| list.into_iter().map(|v| v * step).collect::<Vec<u32>>());
            let [a, b] = &mut lists;
            assert_eq!(renumbered(&mut [a, b]), [5 * step, 6 * step, 7 * step, 9 * step]);
            assert_eq!(lists, [vec![0, 3, 2], vec![3, 1]]);
        }
        assert!(renumbered(&mut []).is_empty() && renumbered(&mut [&mut []]).is_empty());
    }
}
