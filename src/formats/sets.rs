//! Elements by reference for formats that group them in sets or properties (Abaqus, Nastran), and what comments of our own files say of
//! these: `geo-adapt: triangles 7 called wing`.
use super::Dataset;
use crate::geometry::{Label, Names};
use std::collections::BTreeMap;

/// What a comment of ours begins with.
const NOTE: &str = "geo-adapt: ";

/// Elements of a dimension.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    Edges,
    Triangles,
    Tetrahedra,
}

impl Kind {
    pub const ALL: [Self; 3] = [Self::Tetrahedra, Self::Triangles, Self::Edges];

    fn word(self) -> &'static str {
        match self {
            Self::Edges => "edges",
            Self::Triangles => "triangles",
            Self::Tetrahedra => "tetrahedra",
        }
    }

    /// What one of the references without a name is called.
    pub fn unnamed(self) -> &'static str {
        match self {
            Self::Edges => "edge",
            Self::Triangles => "surface",
            Self::Tetrahedra => "region",
        }
    }

    fn labels(self, names: &Names) -> &BTreeMap<i32, Label> {
        match self {
            Self::Edges => &names.edges,
            Self::Triangles => &names.triangles,
            Self::Tetrahedra => &names.tetrahedra,
        }
    }

    fn labels_mut(self, names: &mut Names) -> &mut BTreeMap<i32, Label> {
        match self {
            Self::Edges => &mut names.edges,
            Self::Triangles => &mut names.triangles,
            Self::Tetrahedra => &mut names.tetrahedra,
        }
    }

    /// Calls a reference so.
    pub fn call(self, names: &mut Names, reference: i32, name: String) {
        self.labels_mut(names).insert(reference, Label { name: Some(name), colour: None });
    }
}

/// What a set or a property stands for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Meaning {
    pub kind: Kind,
    pub reference: i32,
    pub name: Option<String>,
}

impl Meaning {
    /// What a comment says of it.
    pub fn note(&self) -> String {
        let Self { kind, reference, name } = self;
        let name = name.as_ref().map_or(String::new(), |name| format!(" called {name}"));
        format!("{NOTE}{} {reference}{name}", kind.word())
    }

    /// By such a comment.
    pub fn noted(comment: &str) -> Option<Self> {
        let (word, rest) = comment.trim().strip_prefix(NOTE)?.split_once(' ')?;
        let kind = Kind::ALL.into_iter().find(|kind| kind.word() == word)?;
        let (reference, name) = match rest.split_once(" called ") {
            Some((reference, name)) => (reference, Some(name.to_owned())),
            None => (rest, None),
        };
        Some(Self { kind, reference: reference.parse().ok()?, name })
    }
}

/// The references of a mesh with their elements, by kind and reference.
pub(super) fn groups(data: &Dataset) -> BTreeMap<(Kind, i32), Vec<u32>> {
    let mesh = &data.mesh;
    let mut groups: BTreeMap<(Kind, i32), Vec<u32>> = BTreeMap::new();
    let all =
        [(Kind::Tetrahedra, &mesh.tets.refs), (Kind::Triangles, &mesh.triangles.refs), (Kind::Edges, &mesh.edges.refs)];
    for (kind, refs) in all {
        for (element, &reference) in (0..).zip(refs) {
            groups.entry((kind, reference)).or_default().push(element);
        }
    }
    groups
}

/// What a group stands for. A name is one line.
pub(super) fn meaning(data: &Dataset, (kind, reference): (Kind, i32)) -> Meaning {
    let name = kind.labels(&data.names).get(&reference).and_then(|label| label.name.as_deref());
    let name = name.map(|name| name.replace(char::is_control, " ").trim().to_owned()).filter(|name| !name.is_empty());
    Meaning { kind, reference, name }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_tell_what_they_are_told() {
        for name in [None, Some("wing tip".to_owned()), Some("so called called".to_owned())] {
            let meaning = Meaning { kind: Kind::Triangles, reference: -7, name };
            assert_eq!(Meaning::noted(&format!("  {} ", meaning.note())), Some(meaning));
        }
        for other in [
            "",
            "geo-adapt: ",
            "geo-adapt: triangles",
            "geo-adapt: cells 3",
            "geo-adapt: edges x called y",
            "triangles 3",
        ] {
            assert_eq!(Meaning::noted(other), None, "{other}");
        }
    }
}
