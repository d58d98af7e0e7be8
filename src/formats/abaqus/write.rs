//! Writing a mesh of Abaqus and CalculiX: a set of elements for each name, and comments that keep references and names as they are.
use super::super::Dataset;
use super::super::sets::{Kind, Meaning, groups, meaning};
use super::super::text::Text;
use crate::mesh::io::{Batch, Error};
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

/// Most characters of the name of a set; Abaqus allows 80.
const MOST: usize = 60;

/// Names of sets that are taken, in capitals, with what they stand for.
type Taken = BTreeMap<String, (Kind, String)>;

/// The name of a set: a word that begins with a letter. References of the same name share it.
fn set(meaning: &Meaning, taken: &mut Taken) -> String {
    let Meaning { kind, reference, name } = meaning;
    let called = name.clone().unwrap_or_else(|| format!("{}_{reference}", kind.unnamed()).replace('-', "minus_"));
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let mut word: String = called.chars().take(MOST).map(|c| if is_plain(c) { c } else { '_' }).collect();
    if !word.starts_with(|c: char| c.is_ascii_alphabetic()) {
        word = format!("{}_{word}", kind.unnamed());
    }
    let meant = (*kind, called);
    let first = word.clone();
    let mut number = 1;
    while taken.get(&word.to_ascii_uppercase()).is_some_and(|other| *other != meant) {
        number += 1;
        word = format!("{first}_{number}");
    }
    taken.insert(word.to_ascii_uppercase(), meant);
    word
}

/// Writes nodes and elements.
pub(in super::super) fn write(batch: &mut Batch, path: &Path, data: &Dataset) -> Result<Vec<String>, Error> {
    let mut taken = Taken::new();
    let mut blocks = Vec::new();
    let mut notices = Vec::new();
    for (key, elements) in groups(data) {
        let meaning = meaning(data, key);
        let word = set(&meaning, &mut taken);
        if let Some(name) = meaning.name.as_ref().filter(|name| **name != word) {
            notices.push(format!("'{name}' is written as {word}"));
        }
        blocks.push((meaning, word, elements));
    }
    batch.add_main(path, |to| emit(to, data, &blocks))?;
    Ok(notices)
}

fn emit(to: &mut dyn Write, data: &Dataset, blocks: &[(Meaning, String, Vec<u32>)]) -> io::Result<()> {
    let (mesh, mut text) = (&data.mesh, Text::new(to));
    text.put(format_args!("** written by geo-adapt\n*NODE\n"));
    for (number, [x, y, z]) in (1..).zip(&mesh.vertices) {
        text.put(format_args!("{number}, {x:?}, {y:?}, {z:?}\n"));
        text.hand_on()?;
    }
    let mut number = 0;
    for (meaning, word, elements) in blocks {
        let kind = match meaning.kind {
            Kind::Tetrahedra => "C3D4",
            Kind::Triangles => "S3",
            Kind::Edges => "T3D2",
        };
        text.put(format_args!("** {}\n*ELEMENT, TYPE={kind}, ELSET={word}\n", meaning.note()));
        for &element in elements {
            number += 1;
            text.put(format_args!("{number}"));
            let nodes: &[u32] = match meaning.kind {
                Kind::Tetrahedra => &mesh.tets.nodes[element as usize],
                Kind::Triangles => &mesh.triangles.nodes[element as usize],
                Kind::Edges => &mesh.edges.nodes[element as usize],
            };
            nodes.iter().for_each(|&node| text.put(format_args!(", {}", u64::from(node) + 1)));
            text.end_line()?;
        }
    }
    text.finish()
}
