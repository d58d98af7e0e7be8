//! What is made of [`Ranks::gather`]. All of it is collective.
use super::Ranks;

/// What goes before the text of an error, so that an empty text is an error too.
const IS_ERROR: u8 = 1;

/// The result of this rank where no rank has an error, and else on every rank the error of the lowest rank that has one, with
/// "rank N: " before it where there are several ranks. After it either all ranks go on or all of them return.
///
/// # Errors
/// The one that was agreed on.
pub fn agree<T>(ranks: &dyn Ranks, own: Result<T, String>) -> Result<T, String> {
    let said = match &own {
        Ok(_) => Vec::new(),
        Err(text) => [&[IS_ERROR], text.as_bytes()].concat(),
    };
    let all = ranks.gather(&said);
    let Some((rank, error)) = all.iter().enumerate().find(|(_, said)| !said.is_empty()) else { return own };
    let text = String::from_utf8_lossy(&error[1..]);
    Err(if ranks.count() > 1 { format!("rank {rank}: {text}") } else { text.into_owned() })
}

/// The bytes of rank 0 on every rank. What the others give is not looked at.
pub fn broadcast(ranks: &dyn Ranks, bytes: &[u8]) -> Vec<u8> {
    let own = if ranks.rank() == 0 { bytes } else { &[] };
    ranks.gather(own).swap_remove(0)
}

/// The sums over all ranks, one for each of the terms: exact, so they are the same however the work is cut.
///
/// # Panics
/// Where ranks have different numbers of terms, and where a sum does not fit.
pub fn sum(ranks: &dyn Ranks, own: &[u64]) -> Vec<u64> {
    let own: Vec<[u8; 8]> = own.iter().map(|term| term.to_le_bytes()).collect();
    let add = |a: u64, b: u64| a.checked_add(b).expect("a sum over all ranks fits into 64 bits");
    sums(ranks, &own, u64::from_le_bytes, add)
}

/// The sums over all ranks, one for each of the terms, added from rank 0 on: the same bits on every rank and in every run with as many
/// ranks. With another number of ranks they are rounded otherwise: bits that must not depend on it are summed over parts of the
/// mesh, which are gathered first.
///
/// # Panics
/// Where ranks have different numbers of terms.
pub fn sum_reals(ranks: &dyn Ranks, own: &[f64]) -> Vec<f64> {
    let own: Vec<[u8; 8]> = own.iter().map(|term| term.to_le_bytes()).collect();
    sums(ranks, &own, f64::from_le_bytes, |a, b| a + b)
}

/// The terms of all ranks, added from rank 0 on.
fn sums<T: Copy>(ranks: &dyn Ranks, own: &[[u8; 8]], read: fn([u8; 8]) -> T, add: fn(T, T) -> T) -> Vec<T> {
    let all = ranks.gather(own.as_flattened());
    let terms = |bytes: &[u8]| bytes.as_chunks().0.iter().map(|&term| read(term)).collect::<Vec<T>>();
    let mut total = terms(&all[0]);
    for (rank, bytes) in all.iter().enumerate().skip(1) {
        let added = terms(bytes);
        assert!(added.len() == total.len(), "rank {rank} has {} terms, rank 0 has {}", added.len(), total.len());
        total.iter_mut().zip(added).for_each(|(sum, term)| *sum = add(*sum, term));
    }
    total
}

#[cfg(test)]
mod tests {
    use super::super::{Alone, Traffic};
    use super::*;

    /// Rank 1 of several, of which the others are known to say this.
    struct Scripted(Vec<Vec<u8>>);

    impl Ranks for Scripted {
        fn rank(&self) -> usize {
            1
        }

        fn count(&self) -> usize {
            self.0.len()
        }

        fn exchange(&self, _: Vec<(usize, Vec<u8>)>) -> Vec<(usize, Vec<u8>)> {
            unreachable!("all is made of gather")
        }

        fn gather(&self, own: &[u8]) -> Vec<Vec<u8>> {
            let mut all = self.0.clone();
            all[1] = own.to_vec();
            all
        }

        fn traffic(&self) -> Traffic {
            Traffic::default()
        }
    }

    #[test]
    fn all_get_the_error_of_the_lowest_rank() {
        let fine = Scripted(vec![vec![]; 3]);
        assert_eq!(agree(&fine, Ok(7)), Ok(7));
        assert_eq!(agree::<()>(&fine, Err("no file".to_owned())), Err("rank 1: no file".to_owned()));
        assert_eq!(agree::<()>(&fine, Err(String::new())), Err("rank 1: ".to_owned()));
        let wrong = Scripted(vec![b"\x01full".to_vec(), vec![], b"\x01other".to_vec()]);
        assert_eq!(agree(&wrong, Ok(7)), Err("rank 0: full".to_owned()));
        assert_eq!(agree::<()>(&wrong, Err("mine".to_owned())), Err("rank 0: full".to_owned()));
    }

    #[test]
    fn one_process_has_its_own_error_alone() {
        assert_eq!(agree(&Alone, Ok(1)), Ok(1));
        assert_eq!(agree::<()>(&Alone, Err("no file".to_owned())), Err("no file".to_owned()));
    }

    #[test]
    fn reals_are_added_from_rank_0_on() {
        let bytes = |terms: &[f64]| terms.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
        let ranks = Scripted(vec![bytes(&[1e16, 1.0]), vec![], bytes(&[-1e16, 3.0])]);
        // In another order the first were 1.
        assert_eq!(sum_reals(&ranks, &[1.0, 2.0]), [0.0, 6.0]);
        assert_eq!(sum_reals(&Alone, &[-0.0])[0].to_bits(), (-0.0f64).to_bits());
    }

    #[test]
    fn counts_are_added_exactly() {
        let bytes = |terms: &[u64]| terms.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
        let ranks = Scripted(vec![bytes(&[1 << 62, 0]), vec![], bytes(&[5, 6])]);
        assert_eq!(sum(&ranks, &[1 << 60, 1]), [(1 << 62) + (1 << 60) + 5, 7]);
        assert_eq!(sum(&Alone, &[]), [0; 0]);
    }

    #[test]
    #[should_panic(expected = "rank 1 has 1 terms, rank 0 has 0")]
    fn ranks_with_other_numbers_of_terms_are_a_mistake() {
        sum(&Scripted(vec![vec![]; 2]), &[1]);
    }

    #[test]
    fn rank_0_is_heard() {
        assert_eq!(broadcast(&Scripted(vec![b"this".to_vec(), vec![]]), b"not this"), b"this");
        assert_eq!(broadcast(&Alone, b"this"), b"this");
    }
}
