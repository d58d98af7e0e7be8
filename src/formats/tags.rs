//! Numbers (tags) of nodes and elements, which need not be in a row.

/// Finds the place of a tag.
pub(super) enum Tags {
    /// The tags count from this in their order.
    Row { first: usize, count: usize },
    /// Place by tag; `NONE` where there is none.
    Dense(Vec<u32>),
    /// Tags, ascending, with their places.
    Sorted(Vec<(usize, u32)>),
}

/// No place.
const NONE: u32 = u32::MAX;

impl Tags {
    /// Of these tags; else the one that is there twice.
    pub fn new(tags: &[usize]) -> Result<Self, usize> {
        let first = tags.first().copied().unwrap_or(0);
        if tags.iter().zip(first..).all(|(&tag, wanted)| tag == wanted) {
            return Ok(Self::Row { first, count: tags.len() });
        }
        let most = tags.iter().copied().max().unwrap_or(0);
        if most / 4 <= tags.len() {
            let mut place = vec![NONE; most + 1];
            for (&tag, at) in tags.iter().zip(0..) {
                if std::mem::replace(&mut place[tag], at) != NONE {
                    return Err(tag);
                }
            }
            return Ok(Self::Dense(place));
        }
        let mut sorted: Vec<(usize, u32)> = tags.iter().copied().zip(0..).collect();
        sorted.sort_unstable();
        match sorted.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            Some(pair) => Err(pair[0].0),
            None => Ok(Self::Sorted(sorted)),
        }
    }

    /// The place of a tag.
    #[inline]
    pub fn place(&self, tag: usize) -> Option<u32> {
        match self {
            Self::Row { first, count } => tag.checked_sub(*first).filter(|at| at < count).map(|at| at as u32),
            Self::Dense(place) => place.get(tag).copied().filter(|&at| at != NONE),
            Self::Sorted(sorted) => sorted.binary_search_by_key(&tag, |pair| pair.0).ok().map(|at| sorted[at].1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_are_found_however_they_are_numbered() {
        for tags in [vec![1, 2, 3], vec![9, 1, 2, 3, 4], vec![7, 1 << 40, 3, 0], vec![5, 6, 7], vec![]] {
            let found = Tags::new(&tags).unwrap();
            for (at, &tag) in tags.iter().enumerate() {
                assert_eq!(found.place(tag), Some(at as u32), "{tags:?}");
            }
            for other in [8, 11, usize::MAX] {
                assert_eq!(found.place(other), None, "{tags:?}");
            }
        }
        assert_eq!(Tags::new(&[3, 1, 2, 3]).err(), Some(3));
        assert_eq!(Tags::new(&[1 << 40, 3, 1 << 40]).err(), Some(1 << 40));
    }
}
