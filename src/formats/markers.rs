//! Boundaries of formats that have names alone: from references to names and back.
use crate::geometry::Label;
use std::collections::{BTreeMap, BTreeSet};

/// What is said of a marker in a comment of our own files.
const NOTE: &str = "geo-adapt: reference ";

/// Names for the references of triangles, without characters that a list of SU2's configuration gives a meaning; each reference its name,
/// or its number. References of the same name share it; notices tell of that, and of names that were changed.
pub(super) fn tags(references: &BTreeSet<i32>, labels: &BTreeMap<i32, Label>) -> (BTreeMap<i32, String>, Vec<String>) {
    let (mut tags, mut notices) = (BTreeMap::new(), Vec::new());
    // What a tag stands for, and whether that is a name and not a number.
    let mut taken: BTreeMap<String, (String, bool)> = BTreeMap::new();
    for reference in references {
        let name = labels.get(reference).and_then(|label| label.name.clone()).filter(|name| !name.trim().is_empty());
        let is_name = name.is_some();
        let meant = (name.unwrap_or_else(|| reference.to_string()), is_name);
        let is_odd = |c: char| c.is_whitespace() || c.is_control() || "=%,(){}<>\"'".contains(c);
        let mut tag: String = meant.0.trim().chars().map(|c| if is_odd(c) { '_' } else { c }).collect();
        if taken.get(&tag).is_some_and(|other| *other != meant) {
            tag = format!("{tag}_{reference}");
        }
        let other = taken.insert(tag.clone(), meant.clone());
        let (meant, _) = meant;
        match other {
            None if tag != meant => notices.push(format!("'{meant}' is written as {tag}")),
            None => {}
            Some(_) => {
                notices.push(format!("reference {reference} is called {meant} as another is: they become one marker"))
            }
        }
        tags.insert(*reference, tag);
    }
    (tags, notices)
}

/// What a comment says of a marker.
pub(super) fn note(reference: i32, tag: &str) -> String {
    format!("{NOTE}{reference} is the marker {tag}")
}

/// The reference and the marker of such a comment.
pub(super) fn noted(comment: &[u8]) -> Option<(i32, &str)> {
    let text = std::str::from_utf8(comment).ok()?.trim().strip_prefix(NOTE)?;
    let (reference, tag) = text.split_once(" is the marker ")?;
    Some((reference.parse().ok()?, tag))
}

/// References for markers: those that comments tell, the number that a tag is, else the next free one from 1.
pub(super) fn references(tags: &[String], noted: &BTreeMap<String, i32>) -> Vec<i32> {
    let known = |tag: &String| {
        noted.get(tag).copied().or_else(|| tag.parse().ok().filter(|&number: &i32| number.to_string() == *tag))
    };
    let mut found: Vec<Option<i32>> = Vec::with_capacity(tags.len());
    let mut used = BTreeSet::new();
    for tag in tags {
        found.push(known(tag).filter(|&reference| used.insert(reference)));
    }
    let mut free = (1..).filter(|reference| !used.contains(reference));
    found.into_iter().map(|reference| reference.or_else(|| free.next()).unwrap_or(i32::MAX)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(names: &[(i32, &str)]) -> BTreeMap<i32, Label> {
        names.iter().map(|&(r, name)| (r, Label { name: Some(name.into()), colour: None })).collect()
    }

    #[test]
    fn tags_are_unique_and_plain() {
        let names = labels(&[
            (1, "wing"),
            (2, "far field"),
            (3, "far_field"),
            (4, "wing"),
            (5, "7"),
            (9, "7"),
            (6, "6 "),
            (8, " "),
        ]);
        let (tags, notices) = tags(&BTreeSet::from([1, 2, 3, 4, 5, 7, 8, -2]), &names);
        let all: Vec<_> = tags.iter().map(|(&r, tag)| (r, tag.as_str())).collect();
        let wanted = [
            (-2, "-2"),
            (1, "wing"),
            (2, "far_field"),
            (3, "far_field_3"),
            (4, "wing"),
            (5, "7"),
            (7, "7_7"),
            (8, "8"),
        ];
        assert_eq!(all, wanted);
        assert!(notices.iter().any(|n| n.contains("reference 4 is called wing")), "{notices:?}");
        assert!(notices.iter().any(|n| n.contains("'far field' is written as far_field")), "{notices:?}");
    }

    #[test]
    fn references_are_those_told_or_free() {
        let tags = ["a", "3", "b", "1", "03", "c"].map(String::from);
        let noted = BTreeMap::from([("b".into(), 2), ("c".into(), 3)]);
        assert_eq!(references(&tags, &noted), [4, 3, 2, 1, 5, 6]);
        assert_eq!(super::noted(note(-7, "wing tip").as_bytes()), Some((-7, "wing tip")));
        assert_eq!(super::noted(b"geo-adapt: reference x is the marker y"), None);
    }
}
