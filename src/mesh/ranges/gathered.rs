//! What is known of single vertices, for some of them, from a file.
use crate::tasks::{GRAIN, Team};
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Vertices that are read though nobody asks for them, where those on both sides are asked for: to read them takes less than a call.
const GAP: u32 = 32;

/// Most vertices that are read at once.
const MOST: u32 = 1 << 13;

/// The places, in runs, of these items, which ascend: those of a run are near enough each other to be read at once.
pub fn runs(items: &[u32]) -> impl Iterator<Item = Range<usize>> + '_ {
    let mut begin = 0;
    std::iter::from_fn(move || {
        let &first = items.get(begin)?;
        let together = |pair: &[u32]| pair[1] - pair[0] <= GAP && pair[1] - first < MOST;
        let end = begin + 1 + items[begin..].windows(2).take_while(|pair| together(pair)).count();
        let run = begin..end;
        begin = end;
        Some(run)
    })
}

/// What `read` gives for each of these vertices, shape (n,), which are in ascending order; `none` is any value, to make room with.
///
/// # Errors
/// Those of `read`; of several the one of the first vertex.
pub fn gathered<T: Copy + Send, E: Send>(
    team: Team<'_>,
    nodes: &[u32],
    none: T,
    read: impl Fn(Range<usize>) -> Result<Vec<T>, E> + Sync,
) -> Result<Vec<T>, E> {
    let mut found = vec![none; nodes.len()];
    let failed: Mutex<Option<(usize, E)>> = Mutex::new(None);
    team.fill(GRAIN, &mut found, |start, found| {
        let nodes = &nodes[start..start + found.len()];
        for places in runs(nodes) {
            let (nodes, first) = (&nodes[places.clone()], nodes[places.start]);
            match read(first as usize..nodes[nodes.len() - 1] as usize + 1) {
                Ok(values) => {
                    let slots = found[places].iter_mut().zip(nodes);
                    slots.for_each(|(slot, &v)| *slot = values[(v - first) as usize]);
                }
                Err(error) => {
                    let mut failed = failed.lock().unwrap_or_else(PoisonError::into_inner);
                    if failed.as_ref().is_none_or(|(before, _)| start < *before) {
                        *failed = Some((start, error));
                    }
                    return;
                }
            }
        }
    });
    match failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some((_, error)) => Err(error),
        None => Ok(found),
    }
}
