//! Figures on their way to another process, as words: bit for bit what they were.
use super::{Accumulator, Distribution, Figures, Lengths, RATIO_CLASSES, Statistics};
use std::collections::BTreeMap;

impl Figures {
    /// As words.
    pub fn words(&self) -> Vec<u64> {
        let Self { sums, lengths, ratios, complexity } = self;
        let counts = [sums.vertices, sums.tets, sums.triangles, sums.tagged_edges];
        let mut words = counts.map(|count| count as u64).to_vec();
        put(&mut words, [sums.volume.to_bits()]);
        put(&mut words, complexity.iter().map(|complexity| complexity.to_bits()));
        for counts in [&sums.regions, &sums.patches, &sums.curves] {
            put(&mut words, counts.iter().flat_map(|(&reference, &count)| [reference as u32 as u64, count as u64]));
        }
        for gathered in [&lengths.0, ratios] {
            let Distribution { count, min, max, argmin, classes, .. } = &gathered.found;
            put(&mut words, [*count as u64, min.to_bits(), max.to_bits(), *argmin as u64, gathered.sum.to_bits()]);
            put(&mut words, classes.iter().map(|class| class.count as u64));
        }
        words
    }

    /// Of words, which are taken from the front; none where they are not those of figures in the metric.
    pub fn of_words(from: &mut &[u64]) -> Option<Self> {
        let (numbers, rest) = from.split_first_chunk::<4>()?;
        *from = rest;
        let [vertices, tets, triangles, tagged_edges] = numbers.map(|number| number as usize);
        let [volume] = take(from)?.try_into().ok()?;
        let complexity = take(from)?.first().copied().map(f64::from_bits);
        let mut counts = || {
            let pairs = take(from)?.as_chunks().0;
            Some(pairs.iter().map(|&[reference, count]| (reference as u32 as i32, count as usize)).collect())
        };
        let [regions, patches, curves]: [BTreeMap<i32, usize>; 3] = [counts()?, counts()?, counts()?];
        let lengths = Lengths(gathered(from, Lengths::in_metric().0)?);
        let ratios = gathered(from, Accumulator::new(&RATIO_CLASSES, true))?;
        let volume = f64::from_bits(volume);
        let sums = Statistics {
            vertices,
            tets,
            triangles,
            tagged_edges,
            volume,
            regions,
            patches,
            curves,
            ..Statistics::default()
        };
        Some(Self { sums, lengths, ratios, complexity })
    }
}

/// What has been gathered, in these classes.
fn gathered(from: &mut &[u64], mut none: Accumulator<'static>) -> Option<Accumulator<'static>> {
    let [count, min, max, argmin, sum] = take(from)?.try_into().ok()?;
    let found = &mut none.found;
    [found.min, found.max, none.sum] = [min, max, sum].map(f64::from_bits);
    [found.count, found.argmin] = [count, argmin].map(|number| number as usize);
    let classes = take(from)?;
    found.classes.iter_mut().zip(classes).for_each(|(class, &count)| class.count = count as usize);
    (classes.len() == found.classes.len()).then_some(none)
}

/// Appends the length of a list, and the list.
fn put(words: &mut Vec<u64>, list: impl IntoIterator<Item = u64>) {
    let at = words.len();
    words.push(0);
    words.extend(list);
    words[at] = (words.len() - at - 1) as u64;
}

/// Takes a list from the front.
fn take<'w>(from: &mut &'w [u64]) -> Option<&'w [u64]> {
    let (&length, rest) = from.split_first()?;
    let (list, rest) = rest.split_at_checked(usize::try_from(length).ok()?)?;
    *from = rest;
    Some(list)
}

#[cfg(test)]
mod tests {
    use super::super::Part;
    use super::*;
    use crate::mesh::samples;
    use crate::metric::Sym3;
    use crate::tasks::Team;

    #[test]
    fn words_are_the_figures() {
        let mut mesh = samples::cube(3);
        mesh.tets.refs.iter_mut().step_by(2).for_each(|reference| *reference = -3);
        let metrics = vec![Sym3::IDENTITY.times(7.3); mesh.vertices.len()];
        let figures = || Figures::in_metric(Team::alone(), Part::whole(&mesh), &metrics, |_| true);
        let mut words = figures().words();
        words.push(9);
        let mut from = &words[..];
        let back = Figures::of_words(&mut from).unwrap();
        assert_eq!(from, [9]);
        assert_eq!(format!("{back:?}"), format!("{:?}", figures()));
        assert_eq!(back.and(figures()).statistics(), figures().and(figures()).statistics());
        // What is short by a word, or has other classes, is refused.
        let whole = words.len() - 1;
        assert!((0..whole).all(|length| Figures::of_words(&mut &words[..length]).is_none()));
    }
}
