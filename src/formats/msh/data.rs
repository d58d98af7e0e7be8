//! Values at nodes and elements.
use super::super::NamedField;
use super::super::cells::cells_to_vertices;
use super::super::error;
use super::super::tags::Tags;
use super::Raw;
use super::source::Source;
use crate::mesh::io::{Error, FieldKind};
use crate::tasks::Team;

/// A view as it stands in the file.
pub(super) struct View {
    name: String,
    at_nodes: bool,
    width: usize,
    tags: Vec<usize>,
    values: Vec<f64>,
}

/// Reads a section: texts (the first is the name), numbers (the time), whole numbers (step, values an item, items), then the items.
pub(super) fn view(source: &mut Source, at_nodes: bool) -> Result<View, Error> {
    let mut name = None;
    for _ in 0..count(source)? {
        let line = source.scan.line().ok_or_else(|| source.scan.fail("the file is cut off"))?;
        name.get_or_insert_with(|| String::from_utf8_lossy(line).trim_matches('"').to_owned());
    }
    for _ in 0..count(source)? {
        source.scan.line().ok_or_else(|| source.scan.fail("the file is cut off"))?;
    }
    let mut numbers = [0; 3];
    for place in 0..count(source)? {
        let number = count(source)?;
        if let Some(slot) = numbers.get_mut(place) {
            *slot = number;
        }
    }
    let [_, width, items] = numbers;
    if width == 0 || width > 1 << 16 {
        return Err(source.scan.fail(format!("{width} values an item cannot be")));
    }
    let room = source.room(items, 1 + width);
    let (mut tags, mut values) = (Vec::with_capacity(room), Vec::with_capacity(room.saturating_mul(width)));
    for _ in 0..items {
        let tag = source.int()?;
        tags.push(usize::try_from(tag).map_err(|_| source.fail(format!("{tag} is no number of a node or element")))?);
        for _ in 0..width {
            values.push(source.real()?);
        }
    }
    Ok(View { name: name.unwrap_or_default(), at_nodes, width, tags, values })
}

/// A count in a line of its own.
fn count(source: &mut Source) -> Result<usize, Error> {
    let line = source.scan.line().unwrap_or_default();
    source.scan.count(line)
}

impl View {
    /// Makes a field of it, of the last step where there are several. Values of elements become means at the vertices.
    pub fn resolve(self, raw: &mut Raw, fields: &mut Vec<NamedField>) {
        let Raw { mesh, stack, nodes, tets, cells, notices, .. } = raw;
        let name = error::short(&self.name);
        let of_cells = if self.at_nodes { None } else { Some(Tags::new(&[&tets[..], cells].concat())) };
        let count = tets.len() + cells.len();
        let (places, items) = match &of_cells {
            None => (&*nodes, mesh.vertices.len()),
            Some(Ok(tags)) if count > 0 => (tags, count),
            _ => {
                notices.push(format!("{name}: its elements are not told apart, it is left out"));
                return;
            }
        };
        let mut all = vec![f64::NAN; items * self.width];
        let mut found = 0;
        for (tag, row) in self.tags.iter().zip(self.values.chunks_exact(self.width)) {
            if let Some(place) = places.place(*tag) {
                let to = &mut all[place as usize * self.width..][..self.width];
                found += usize::from(to[0].is_nan());
                to.copy_from_slice(row);
            }
        }
        if found < items {
            let what = if self.at_nodes { "nodes" } else { "cells" };
            notices.push(format!("{name}: values at {found} of {items} {what}, it is left out"));
            return;
        }
        if !self.at_nodes {
            all = if stack.is_empty() { all } else { stack.spread(all, self.width) };
            all = cells_to_vertices(Team::alone(), mesh, &all, self.width);
            notices.push(format!("{name} was given at elements: its mean about each vertex is taken"));
        }
        let is_symmetric = |t: &[f64; 9]| t[1] == t[3] && t[2] == t[6] && t[5] == t[7];
        let kind = match self.width {
            1 => FieldKind::Scalar,
            3 => FieldKind::Vector,
            9 if all.as_chunks().0.iter().all(is_symmetric) => FieldKind::SymmetricTensor,
            9 => FieldKind::Tensor,
            width => {
                notices.push(format!("{name}: {width} values an item, it is left out"));
                return;
            }
        };
        if kind == FieldKind::SymmetricTensor {
            all = all.as_chunks::<9>().0.iter().flat_map(|t| [t[0], t[1], t[4], t[2], t[5], t[8]]).collect();
        }
        let field = NamedField { name: self.name, kind, values: all };
        match fields.iter_mut().find(|other| other.name == field.name) {
            Some(other) => *other = field,
            None => fields.push(field),
        }
    }
}
