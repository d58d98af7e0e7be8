//! Names as OpenFOAM has them.
use crate::geometry::Label;
use std::collections::{BTreeMap, BTreeSet};

/// A word for each reference, by its name where it has one; no two are the same.
pub(super) fn words(
    references: &BTreeSet<i32>,
    labels: &BTreeMap<i32, Label>,
    unnamed: fn(i32) -> String,
) -> BTreeMap<i32, String> {
    let mut taken = BTreeSet::new();
    let mut words = BTreeMap::new();
    for &reference in references {
        let name = labels.get(&reference).and_then(|label| label.name.as_deref());
        let mut word = name.map_or_else(|| unnamed(reference), word);
        if !taken.insert(word.clone()) {
            word = format!("{word}_{reference}");
            while !taken.insert(word.clone()) {
                word.push('_');
            }
        }
        words.insert(reference, word);
    }
    words
}

/// A name as OpenFOAM's words are: of letters, digits and few other signs, not beginning like a number.
fn word(name: &str) -> String {
    let fits = |c: char| if c.is_ascii_alphanumeric() || c == '_' || c == '.' { c } else { '_' };
    let word: String = name.chars().map(fits).collect();
    if word.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') { word } else { format!("_{word}") }
}
