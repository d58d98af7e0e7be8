//! A piece as bytes: on a disk, or on the way to another process. Only this program reads them, on machines of one kind.
use super::piece::Piece;
use crate::geometry::Entity;
use crate::mesh::Elements;
use bytemuck::Pod;

/// The first bytes of every piece.
const MAGIC: u64 = u64::from_le_bytes(*b"geopiec1");

/// An odd number with well mixed bits.
const FACTOR: u64 = 0x9E37_79B9_7F4A_7C15;

/// The kinds of entities, in the two highest bits of their numbers.
const KIND: u32 = 30;

/// The bytes of a piece.
pub fn encoded(piece: &Piece) -> Vec<u8> {
    let Piece { mesh, place, logs, ids, marks, halves, cuts } = piece;
    let mut bytes = Vec::with_capacity(16 * mesh.tets.len() + 4 * mesh.tets.len() + 180 * ids.len() + 4096);
    put(&mut bytes, &[MAGIC]);
    put(&mut bytes, ids);
    put(&mut bytes, &mesh.vertices);
    put(&mut bytes, &mesh.vertex_refs);
    put(&mut bytes, &place.entities.iter().map(|&entity| number(entity)).collect::<Vec<_>>());
    put(&mut bytes, &place.parameters);
    // Most are where their vertices are.
    let moved = (0u32..).zip(mesh.vertices.iter().zip(&place.projected)).filter(|(_, (at, projected))| at != projected);
    let (moved, projected): (Vec<u32>, Vec<_>) = moved.map(|(v, (_, projected))| (v, *projected)).unzip();
    put(&mut bytes, &moved);
    put(&mut bytes, &projected);
    put(&mut bytes, logs);
    put(&mut bytes, marks);
    put(&mut bytes, &mesh.tets.nodes);
    put(&mut bytes, &mesh.tets.refs);
    put(&mut bytes, &mesh.triangles.nodes);
    put(&mut bytes, &mesh.triangles.refs);
    put(&mut bytes, &place.faces);
    put(&mut bytes, &halves.iter().map(|&half| u8::from(half)).collect::<Vec<_>>());
    put(&mut bytes, cuts);
    put(&mut bytes, &mesh.edges.nodes);
    put(&mut bytes, &mesh.edges.refs);
    put(&mut bytes, &mesh.required_vertices);
    put(&mut bytes, &mesh.required_edges);
    put(&mut bytes, &mesh.required_triangles);
    put(&mut bytes, &place.ridges.iter().map(|&([a, b], curve)| [a, b, curve]).collect::<Vec<_>>());
    let sum = checksum(&bytes);
    bytes.extend_from_slice(&sum.to_ne_bytes());
    bytes
}

/// The piece of these bytes; none where they are not those of a piece.
pub fn decoded(bytes: &[u8]) -> Option<Piece> {
    let (mut rest, sum) = bytes.split_last_chunk()?;
    if checksum(rest) != u64::from_ne_bytes(*sum) {
        return None;
    }
    let from = &mut rest;
    if take::<u64>(from)? != [MAGIC] {
        return None;
    }
    let mut piece = Piece { ids: take(from)?, ..Piece::default() };
    piece.mesh.vertices = take(from)?;
    piece.mesh.vertex_refs = take(from)?;
    piece.place.entities = take(from)?.into_iter().map(entity).collect();
    piece.place.parameters = take(from)?;
    let moved: Vec<u32> = take(from)?;
    piece.place.projected.clone_from(&piece.mesh.vertices);
    for (v, at) in moved.into_iter().zip(take(from)?) {
        *piece.place.projected.get_mut(v as usize)? = at;
    }
    piece.logs = take(from)?;
    piece.marks = take(from)?;
    piece.mesh.tets = Elements { nodes: take(from)?, refs: take(from)? };
    piece.mesh.triangles = Elements { nodes: take(from)?, refs: take(from)? };
    piece.place.faces = take(from)?;
    piece.halves = take::<u8>(from)?.into_iter().map(|half| half == 1).collect();
    piece.cuts = take(from)?;
    piece.mesh.edges = Elements { nodes: take(from)?, refs: take(from)? };
    piece.mesh.required_vertices = take(from)?;
    piece.mesh.required_edges = take(from)?;
    piece.mesh.required_triangles = take(from)?;
    piece.place.ridges = take::<[u32; 3]>(from)?.into_iter().map(|[a, b, curve]| ([a, b], curve)).collect();
    (rest.is_empty() && is_sound(&piece)).then_some(piece)
}

/// Whether all lists of a piece fit together.
fn is_sound(Piece { mesh, place, logs, ids, marks, halves, cuts }: &Piece) -> bool {
    fn are_below<'a>(numbers: impl IntoIterator<Item = &'a u32>, end: usize) -> bool {
        numbers.into_iter().max().is_none_or(|&greatest| (greatest as usize) < end)
    }
    let (vertices, triangles) = (ids.len(), mesh.triangles.nodes.len());
    let of_vertices = [
        mesh.vertices.len(),
        mesh.vertex_refs.len(),
        place.entities.len(),
        place.parameters.len(),
        logs.len(),
        marks.len(),
    ];
    let of_triangles = [mesh.triangles.refs.len(), place.faces.len(), halves.len()];
    let ridges = || place.ridges.iter().flat_map(|(nodes, _)| nodes);
    of_vertices.iter().all(|&length| length == vertices)
        && of_triangles.iter().all(|&length| length == triangles)
        && mesh.tets.refs.len() == mesh.tets.nodes.len()
        && mesh.edges.refs.len() == mesh.edges.nodes.len()
        && are_below(mesh.tets.nodes.as_flattened(), vertices)
        && are_below(mesh.triangles.nodes.as_flattened(), vertices)
        && are_below(mesh.edges.nodes.as_flattened(), vertices)
        && are_below(cuts.as_flattened(), vertices)
        && are_below(ridges(), vertices)
        && are_below(&mesh.required_vertices, vertices)
        && are_below(&mesh.required_edges, mesh.edges.nodes.len())
        && are_below(&mesh.required_triangles, triangles)
}

/// A sum that changes when any of the bytes does. A disk may return something else than was written.
fn checksum(bytes: &[u8]) -> u64 {
    let mix = |sum: u64, word: u64| (sum.rotate_left(5) ^ word).wrapping_mul(FACTOR);
    // Four sums at a time, as each step of one waits for the last.
    let mut sums = [1, 2, 3, bytes.len() as u64];
    let (blocks, rest) = bytes.as_chunks::<32>();
    for block in blocks {
        let (words, _) = block.as_chunks::<8>();
        sums.iter_mut().zip(words).for_each(|(sum, word)| *sum = mix(*sum, u64::from_ne_bytes(*word)));
    }
    let sum = rest.iter().fold(0, |sum, &byte| mix(sum, u64::from(byte)));
    sums.into_iter().fold(sum, mix)
}

/// Appends the length of a list in bytes, and the list.
pub fn put<T: Pod>(bytes: &mut Vec<u8>, list: &[T]) {
    let list: &[u8] = bytemuck::cast_slice(list);
    bytes.extend_from_slice(&(list.len() as u64).to_ne_bytes());
    bytes.extend_from_slice(list);
}

/// Takes a list from the front.
pub fn take<T: Pod>(from: &mut &[u8]) -> Option<Vec<T>> {
    let (length, rest) = from.split_first_chunk()?;
    let length = usize::try_from(u64::from_ne_bytes(*length)).ok()?;
    let (list, rest) = rest.split_at_checked(length)?;
    *from = rest;
    (length % size_of::<T>() == 0).then(|| bytemuck::pod_collect_to_vec(list))
}

fn number(entity: Entity) -> u32 {
    match entity {
        Entity::Vertex(vertex) => vertex,
        Entity::Edge(edge) => (1 << KIND) | edge,
        Entity::Face(face) => (2 << KIND) | face,
        Entity::Interior => 3 << KIND,
    }
}

fn entity(number: u32) -> Entity {
    let own = number & ((1 << KIND) - 1);
    match number >> KIND {
        0 => Entity::Vertex(own),
        1 => Entity::Edge(own),
        2 => Entity::Face(own),
        _ => Entity::Interior,
    }
}
