//! Writing bulk data of Nastran: points in large fields, elements in small ones, a property for each reference.
use super::super::sets::{Kind, Meaning, groups, meaning};
use super::super::text::Text;
use super::super::{Dataset, error};
use super::PROPERTY;
use super::card::in_16;
use crate::mesh::io::{Batch, Error};
use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::Path;

/// The greatest number that a small field holds.
const MOST: usize = 99_999_999;

/// Writes points and elements.
pub(in super::super) fn write(batch: &mut Batch, path: &Path, data: &Dataset) -> Result<Vec<String>, Error> {
    let mesh = &data.mesh;
    if mesh.vertices.len().max(mesh.tets.len() + mesh.triangles.len() + mesh.edges.len()) > MOST {
        return Err(error::at(path, "numbers", format!("more than {MOST} points or elements; write another format")));
    }
    let groups: Vec<_> = groups(data).into_iter().map(|(key, elements)| (meaning(data, key), elements)).collect();
    // A property is of one kind of element.
    let mut used: BTreeSet<i32> = BTreeSet::new();
    let own = groups
        .iter()
        .map(|(meaning, _)| Some(meaning.reference).filter(|&r| r > 0 && r as usize <= MOST && used.insert(r)));
    let own: Vec<Option<i32>> = own.collect();
    let mut free = (1..).filter(|number| !used.contains(number));
    let properties: Vec<i32> = own.into_iter().map(|own| own.or_else(|| free.next()).unwrap_or(1)).collect();
    batch.add_main(path, |to| emit(to, data, &groups, &properties))?;
    let places = mesh.vertices.as_flattened().iter().any(|&x| super::card::real(in_16(x).as_bytes()) != Ok(x));
    Ok(if places {
        vec!["coordinates are rounded to the 16 characters that they have there".into()]
    } else {
        Vec::new()
    })
}

fn emit(to: &mut dyn Write, data: &Dataset, groups: &[(Meaning, Vec<u32>)], properties: &[i32]) -> io::Result<()> {
    let (mesh, mut text) = (&data.mesh, Text::new(to));
    text.put(format_args!("$ written by geo-adapt\n"));
    for ((meaning, _), property) in groups.iter().zip(properties) {
        text.put(format_args!("$ {PROPERTY}{property} {}\n", meaning.note()));
    }
    text.put(format_args!("BEGIN BULK\n"));
    for (number, point) in (1..).zip(&mesh.vertices) {
        let [x, y, z] = point.map(in_16);
        text.put(format_args!("GRID*   {number:>16}{:16}{x:>16}{y:>16}*\n*       {z:>16}\n", ""));
        text.hand_on()?;
    }
    let mut number = 0;
    for ((meaning, elements), property) in groups.iter().zip(properties) {
        for &element in elements {
            number += 1;
            let (name, nodes): (&str, &[u32]) = match meaning.kind {
                Kind::Tetrahedra => ("CTETRA", &mesh.tets.nodes[element as usize]),
                Kind::Triangles => ("CTRIA3", &mesh.triangles.nodes[element as usize]),
                Kind::Edges => ("CROD", &mesh.edges.nodes[element as usize]),
            };
            text.put(format_args!("{name:<8}{number:>8}{property:>8}"));
            nodes.iter().for_each(|&node| text.put(format_args!("{:>8}", u64::from(node) + 1)));
            text.end_line()?;
        }
    }
    text.put(format_args!("ENDDATA\n"));
    text.finish()
}
