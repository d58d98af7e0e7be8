//! Version 2.2: one list of nodes, one of elements, each with its physical group and its entity.
use super::super::tags::Tags;
use super::source::Source;
use super::v4::refused;
use super::{LINE, POINT, QUADRILATERAL, Raw, TETRAHEDRON, TRIANGLE, kind_of};
use crate::mesh::io::Error;
use crate::mesh::stack::Cell;
use std::collections::{BTreeMap, BTreeSet};

/// Number and coordinates of each node.
pub(super) fn nodes(source: &mut Source, raw: &mut Raw) -> Result<(), Error> {
    let line = source.scan.line().unwrap_or_default();
    let count = source.scan.count(line)?;
    if count > u32::MAX as usize {
        return Err(source.fail("there are too many nodes; at most 2^32 - 1 are supported"));
    }
    let room = source.room(count, 4);
    raw.mesh.vertices.reserve_exact(room);
    let mut tags = Vec::with_capacity(room);
    for _ in 0..count {
        tags.push(tag(source)?);
        raw.mesh.vertices.push(source.point()?);
    }
    raw.mesh.vertex_refs = vec![0; raw.mesh.vertices.len()];
    raw.nodes =
        Tags::new(&tags).map_err(|tag| source.fail(format!("node {tag} is there twice; number the nodes again")))?;
    Ok(())
}

fn tag(source: &mut Source) -> Result<usize, Error> {
    let value = source.int()?;
    usize::try_from(value).map_err(|_| source.fail(format!("{value} is no number of a node or element")))
}

/// Physical group and entity of each element: lines, triangles, quadrilaterals, tetrahedra, the other cells.
#[derive(Default)]
struct Groups([Vec<[i64; 2]>; 5]);

/// Elements: in a text number, type and tags of each; in binary files blocks of the same type.
pub(super) fn elements(source: &mut Source, raw: &mut Raw) -> Result<(), Error> {
    let line = source.scan.line().unwrap_or_default();
    let count = source.scan.count(line)?;
    let mut groups = Groups::default();
    let mut done = 0;
    while done < count {
        if source.is_text() {
            let number = tag(source)?;
            let (kind, tags) = (source.int()?, source.int()?);
            element(source, raw, &mut groups, (number, kind, tags))?;
            done += 1;
        } else {
            let (kind, follow, tags) = (source.int()?, source.int()?, source.int()?);
            if follow < 1 {
                return Err(source.fail(format!("a block of {follow} elements; write the file again")));
            }
            for _ in 0..follow {
                let number = tag(source)?;
                element(source, raw, &mut groups, (number, kind, tags))?;
            }
            done = done.saturating_add(follow as usize);
        }
    }
    let (mesh, stack, of_entity) = (&mut raw.mesh, &mut raw.stack, &mut raw.of_entity);
    let [lines, triangles, quads, tets, cells] = groups.0;
    let mut references = |dimension: i64, pairs: &[[i64; 2]]| {
        let (found, known) = references(pairs).map_err(|number| {
            source.fail(format!("the number {number} of an entity or group does not fit 32 bits; renumber them"))
        })?;
        of_entity.extend(known.into_iter().map(|(entity, group)| ((dimension, entity), group)));
        Ok::<_, Error>(found)
    };
    mesh.edges.refs = references(1, &lines)?;
    let mut faces = references(2, &[triangles, quads].concat())?;
    stack.quads.refs = faces.split_off(mesh.triangles.nodes.len());
    mesh.triangles.refs = faces;
    let mut all = references(3, &[tets, cells].concat())?;
    let of_cells = all.split_off(mesh.tets.nodes.len());
    stack.cells.iter_mut().zip(of_cells).for_each(|(cell, reference)| cell.reference = reference);
    mesh.tets.refs = all;
    Ok(())
}

fn element(source: &mut Source, raw: &mut Raw, groups: &mut Groups, head: (usize, i64, i64)) -> Result<(), Error> {
    let (number, kind, tags) = head;
    let mut group = [0; 2];
    for place in 0..tags.max(0) {
        let tag = source.int()?;
        if let Some(slot) = group.get_mut(place as usize) {
            *slot = tag;
        }
    }
    let of = match kind {
        LINE => {
            raw.mesh.edges.nodes.push(nodes_of(source, raw)?);
            0
        }
        TRIANGLE => {
            raw.mesh.triangles.nodes.push(nodes_of(source, raw)?);
            1
        }
        QUADRILATERAL => {
            raw.stack.quads.nodes.push(nodes_of(source, raw)?);
            2
        }
        TETRAHEDRON => {
            raw.mesh.tets.nodes.push(nodes_of(source, raw)?);
            raw.tets.push(number);
            3
        }
        POINT => {
            source.int()?;
            return Ok(());
        }
        _ => {
            let of = kind_of(kind).ok_or_else(|| refused(source, kind))?;
            let nodes = (0..of.corners()).map(|_| node(source, raw)).collect::<Result<Vec<u32>, _>>()?;
            raw.stack.cells.push(Cell::new(of, &nodes, 0));
            raw.cells.push(number);
            4
        }
    };
    groups.0[of].push(group);
    Ok(())
}

fn node(source: &mut Source, raw: &Raw) -> Result<u32, Error> {
    let tag = tag(source)?;
    raw.nodes.place(tag).ok_or_else(|| source.fail(format!("there is no node {tag}")))
}

fn nodes_of<const N: usize>(source: &mut Source, raw: &Raw) -> Result<[u32; N], Error> {
    let mut nodes = [0; N];
    for slot in &mut nodes {
        *slot = node(source, raw)?;
    }
    Ok(nodes)
}

/// References of elements by their pairs of physical group and entity, and the groups of the references; else the number that does not fit.
///
/// A reference is the entity where that tells the group too; else the group where that tells the entity (programs that know no entities
/// write 0 or 1 for all); else each pair gets a number, from 1.
type Found = (Vec<i32>, BTreeMap<i64, i64>);
fn references(pairs: &[[i64; 2]]) -> Result<Found, i64> {
    let distinct: BTreeSet<[i64; 2]> = pairs.iter().copied().collect();
    let of_entity: BTreeMap<i64, i64> = distinct.iter().map(|&[group, entity]| (entity, group)).collect();
    let of_group: BTreeMap<i64, i64> = distinct.iter().map(|&[group, entity]| (group, entity)).collect();
    let number: BTreeMap<[i64; 2], i64> =
        if of_entity.len() == distinct.len() && (distinct.len() > 1 || !of_entity.contains_key(&0)) {
            distinct.iter().map(|&pair| (pair, pair[1])).collect()
        } else if of_group.len() == distinct.len() {
            distinct.iter().map(|&pair| (pair, pair[0])).collect()
        } else {
            distinct.iter().copied().zip(1..).collect()
        };
    if let Some(&wrong) = number.values().find(|&&number| i32::try_from(number).is_err()) {
        return Err(wrong);
    }
    let mut last = ([0; 2], 0);
    let mut found = Vec::with_capacity(pairs.len());
    for pair in pairs {
        if found.is_empty() || last.0 != *pair {
            last = (*pair, number[pair] as i32);
        }
        found.push(last.1);
    }
    let groups = number.iter().filter(|(pair, _)| pair[0] != 0).map(|(pair, &number)| (number, pair[0])).collect();
    Ok((found, groups))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reference_is_the_entity_or_the_group_or_the_pair() {
        let of = |pairs: &[[i64; 2]]| references(pairs).unwrap();
        assert_eq!(of(&[[7, 1], [7, 2], [0, 3]]), (vec![1, 2, 3], BTreeMap::from([(1, 7), (2, 7)])));
        assert_eq!(of(&[[7, 1], [8, 1]]), (vec![7, 8], BTreeMap::from([(7, 7), (8, 8)])));
        assert_eq!(of(&[[7, 0]]), (vec![7], BTreeMap::from([(7, 7)])));
        assert_eq!(of(&[[7, 1], [8, 1], [7, 2]]), (vec![1, 3, 2], BTreeMap::from([(1, 7), (2, 7), (3, 8)])));
        assert_eq!(of(&[]), (vec![], BTreeMap::new()));
        assert_eq!(references(&[[1 << 40, 0]]), Err(1 << 40));
    }
}
