//! Version 4.1: nodes and elements in blocks by entity.
use super::super::tags::Tags;
use super::source::Source;
use super::{LINE, POINT, QUADRILATERAL, Raw, TETRAHEDRON, TRIANGLE, kind_of};
use crate::mesh::io::Error;
use crate::mesh::stack::Cell;
use crate::mesh::{OnEdge, OnFace, OnVertex};

/// Entities: box, physical groups, boundary. The first group gives the entity its name.
pub(super) fn entities(source: &mut Source, raw: &mut Raw) -> Result<(), Error> {
    let counts = [source.size()?, source.size()?, source.size()?, source.size()?];
    for (dimension, count) in (0_i64..).zip(counts) {
        for _ in 0..count {
            let entity = source.int()?;
            // A point is one, the others have a box.
            for _ in 0..if dimension == 0 { 3 } else { 6 } {
                source.real()?;
            }
            for place in 0..source.size()? {
                let group = source.int()?;
                if place == 0 {
                    raw.of_entity.insert((dimension, entity), group.abs());
                }
            }
            if dimension > 0 {
                for _ in 0..source.size()? {
                    source.int()?;
                }
            }
        }
    }
    Ok(())
}

/// Blocks of nodes: entity, whether parameters follow, then all tags and all coordinates.
pub(super) fn nodes(source: &mut Source, raw: &mut Raw) -> Result<(), Error> {
    let (blocks, total) = (source.size()?, source.size()?);
    let _least_and_most = [source.size()?, source.size()?];
    let room = source.room(total, 3);
    raw.mesh.vertices.reserve_exact(room);
    let mut tags = Vec::with_capacity(room);
    for _ in 0..blocks {
        let (dimension, entity, parametric) = (source.int()?, source.int()?, source.int()? != 0);
        let count = source.size()?;
        for _ in 0..count {
            tags.push(source.size()?);
        }
        for _ in 0..count {
            let point = source.point()?;
            let vertex = raw.mesh.vertices.len() as u32;
            raw.mesh.vertices.push(point);
            place(source, raw, (dimension, entity, parametric), vertex)?;
        }
        if raw.mesh.vertices.len() > u32::MAX as usize {
            return Err(source.fail("there are too many nodes; at most 2^32 - 1 are supported"));
        }
    }
    raw.mesh.vertex_refs = vec![0; raw.mesh.vertices.len()];
    raw.nodes =
        Tags::new(&tags).map_err(|tag| source.fail(format!("node {tag} is there twice; number the nodes again")))?;
    Ok(())
}

/// Where a node is on its entity. In a text parameters may be missing.
fn place(source: &mut Source, raw: &mut Raw, entity: (i64, i64, bool), vertex: u32) -> Result<(), Error> {
    let (dimension, id, parametric) = entity;
    let id =
        i32::try_from(id).map_err(|_| source.fail(format!("the number {id} of an entity does not fit 32 bits")))?;
    let mut parameters = [None; 3];
    for parameter in parameters.iter_mut().take(if parametric { dimension.clamp(0, 3) as usize } else { 0 }) {
        *parameter = if source.is_text() { source.scan.real_here()? } else { Some(source.real()?) };
    }
    let to = &mut raw.mesh.association;
    match (dimension, parameters) {
        (0, _) => to.vertices.push(OnVertex { vertex, id }),
        (1, [Some(t), ..]) => to.edges.push(OnEdge { vertex, id, t, r: 0.0 }),
        (2, [Some(u), Some(v), _]) => to.faces.push(OnFace { vertex, id, uv: [u, v], r: 0.0 }),
        _ => {}
    }
    Ok(())
}

/// Blocks of elements: entity and type, then tag and nodes of each.
pub(super) fn elements(source: &mut Source, raw: &mut Raw) -> Result<(), Error> {
    let blocks = source.size()?;
    let _total_least_and_most = [source.size()?, source.size()?, source.size()?];
    for _ in 0..blocks {
        let (_, entity, kind) = (source.int()?, source.int()?, source.int()?);
        let count = source.size()?;
        let reference = i32::try_from(entity)
            .map_err(|_| source.fail(format!("the number {entity} of an entity does not fit 32 bits")))?;
        let room = source.room(count, 1);
        if kind == TETRAHEDRON {
            raw.tets.reserve(room / 5 + 1);
            raw.mesh.tets.nodes.reserve(room / 5 + 1);
        }
        for _ in 0..count {
            let tag = source.size()?;
            match kind {
                LINE => {
                    let nodes = element(source, raw)?;
                    raw.mesh.edges.push(nodes, reference);
                }
                TRIANGLE => {
                    let nodes = element(source, raw)?;
                    raw.mesh.triangles.push(nodes, reference);
                }
                QUADRILATERAL => {
                    let nodes = element(source, raw)?;
                    raw.stack.quads.push(nodes, reference);
                }
                TETRAHEDRON => {
                    let nodes = element(source, raw)?;
                    raw.mesh.tets.push(nodes, reference);
                    raw.tets.push(tag);
                }
                POINT => {
                    source.size()?;
                }
                _ => {
                    let of = kind_of(kind).ok_or_else(|| refused(source, kind))?;
                    let nodes = (0..of.corners()).map(|_| node(source, raw)).collect::<Result<Vec<u32>, _>>()?;
                    raw.stack.cells.push(Cell::new(of, &nodes, reference));
                    raw.cells.push(tag);
                }
            }
        }
    }
    Ok(())
}

/// The nodes of an element.
fn element<const N: usize>(source: &mut Source, raw: &Raw) -> Result<[u32; N], Error> {
    let mut nodes = [0; N];
    for slot in &mut nodes {
        *slot = node(source, raw)?;
    }
    Ok(nodes)
}

fn node(source: &mut Source, raw: &Raw) -> Result<u32, Error> {
    let tag = source.size()?;
    raw.nodes.place(tag).ok_or_else(|| source.fail(format!("there is no node {tag}")))
}

/// An element that we do not have.
pub(super) fn refused(source: &Source, kind: i64) -> Error {
    let name = match kind {
        8..=14 => " (of second order)",
        _ => "",
    };
    source.fail(format!(
        "elements of type {kind}{name}: only cells, faces and lines of the first order are read; split the others"
    ))
}
