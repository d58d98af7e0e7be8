//! What must be known of all pieces to number their vertices as one mesh: the boundary of each with all that is listed of it, and how many
//! vertices it has inside.
use super::bytes::{decoded, encoded, put, take};
use super::join::Joined;
use super::maps::Map;
use super::piece::{Piece, SHARED};
use super::split::split_vertices;
use crate::geometry::Entity;
use crate::mesh::adjacency::{TriangleIndex, sorted3};
use crate::tasks::Team;

/// A piece's outline.
#[derive(Default)]
pub struct Outline {
    /// Its listed vertices, those on the model or required, with its triangles, ridges and required entities, and no tetrahedra. Its cuts are
    /// the triangles with tetrahedra on both sides.
    pub skin: Piece,
    /// Its other vertices that are shared, in their order.
    pub shared: Vec<u64>,
    /// How many others it has.
    pub own: u64,
    /// Tetrahedra.
    pub tets: u64,
}

/// For each vertex whether it is listed.
fn listed(piece: &Piece) -> Vec<bool> {
    let mut listed: Vec<bool> = piece.place.entities.iter().map(|entity| *entity != Entity::Interior).collect();
    let mesh = &piece.mesh;
    let ends = mesh.edges.nodes.iter().flatten().chain(mesh.triangles.nodes.iter().flatten());
    ends.chain(&mesh.required_vertices).for_each(|&v| listed[v as usize] = true);
    listed
}

impl Outline {
    /// Of a piece.
    pub fn of(piece: &Piece) -> Self {
        let listed = listed(piece);
        let mut skin = split_vertices(piece, &listed);
        let mesh = &piece.mesh;
        let index = TriangleIndex::new(Team::alone(), &mesh.triangles.nodes, mesh.vertices.len());
        let mut sides = vec![0u8; mesh.triangles.len()];
        index.sides(Team::alone(), &mesh.tets.nodes).iter().for_each(|side| sides[side.triangle as usize] += 1);
        let inner = (0..sides.len()).filter(|&t| sides[t] > 1 || piece.halves[t]);
        skin.cuts = inner.map(|t| sorted3(skin.mesh.triangles.nodes[t])).collect();
        let inner = || (0..piece.ids.len()).filter(|&v| !listed[v]);
        let is_shared = |v: &usize| piece.marks[*v] & SHARED != 0;
        let shared: Vec<u64> = inner().filter(is_shared).map(|v| piece.ids[v]).collect();
        let own = (inner().count() - shared.len()) as u64;
        Self { skin, shared, own, tets: piece.len() as u64 }
    }

    /// As bytes.
    pub fn encoded(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        put(&mut bytes, &encoded(&self.skin));
        put(&mut bytes, &self.shared);
        put(&mut bytes, &[self.own, self.tets]);
        bytes
    }

    /// From the front of some bytes.
    pub fn decoded(from: &mut &[u8]) -> Option<Self> {
        let skin = decoded(&take::<u8>(from)?)?;
        let shared = take(from)?;
        let [own, tets] = take(from)?.try_into().ok()?;
        Some(Self { skin, shared, own, tets })
    }
}

/// The numbers of all vertices in the whole mesh: first those that are listed, then piece after piece those inside, its own before those that
/// a later piece has too.
pub struct Numbering {
    /// The listed vertices, with all triangles, ridges and required entities.
    pub skin: Piece,
    /// For each piece the numbers of its listed vertices.
    listed: Vec<Vec<u32>>,
    /// The numbers of all shared vertices.
    shared: Map<u64, u32>,
    /// For each piece its first number inside, and its first tetrahedron; and behind the last.
    first: Vec<[u64; 2]>,
}

/// The vertices of a piece in the whole mesh.
pub struct Numbers {
    /// For each vertex its number.
    pub numbers: Vec<u32>,
    /// The vertices that this piece writes, in the order of their numbers, which follow each other.
    pub written: Vec<u32>,
    /// The first of their numbers.
    pub first: usize,
    /// The number of the first tetrahedron.
    pub first_tet: usize,
}

impl Numbering {
    /// Of outlines in the order of their pieces.
    pub fn of(outlines: Vec<Outline>) -> Self {
        let mut skin = Joined::default();
        let listed: Vec<Vec<u32>> = outlines.iter().map(|outline| skin.add(&outline.skin)).collect();
        // A vertex may be listed in one piece, as an end of a required edge, and not in another, which has only this end of the edge.
        let (skin, mut shared) = skin.finish();
        let mut next = [skin.ids.len() as u64, 0];
        let mut first = vec![next];
        for Outline { shared: ids, own, tets, .. } in outlines {
            next[0] += own;
            for id in ids {
                shared.entry(id).or_insert_with(|| {
                    next[0] += 1;
                    next[0] as u32 - 1
                });
            }
            next[1] += tets;
            first.push(next);
        }
        Self { skin, listed, shared, first }
    }

    /// Vertices of the whole mesh.
    pub fn vertices(&self) -> usize {
        self.first.last().map_or(0, |first| first[0] as usize)
    }

    /// Tetrahedra of the whole mesh.
    pub fn tets(&self) -> usize {
        self.first.last().map_or(0, |first| first[1] as usize)
    }

    /// The numbers of the vertices of a piece, which is the one of this index in the order of the outlines.
    pub fn of_piece(&self, index: usize, piece: &Piece) -> Numbers {
        let [first, first_tet] = self.first[index].map(|first| first as usize);
        let is_listed = listed(piece);
        let mut numbers = vec![u32::MAX; piece.ids.len()];
        let mut of_listed = self.listed[index].iter();
        let (mut written, mut shared) = (Vec::new(), Vec::new());
        for v in 0..numbers.len() {
            if is_listed[v] {
                numbers[v] = of_listed.next().copied().unwrap_or(u32::MAX);
            } else if piece.marks[v] & SHARED != 0 {
                shared.push(v as u32);
            } else {
                numbers[v] = (first + written.len()) as u32;
                written.push(v as u32);
            }
        }
        for v in shared {
            let number = self.shared[&piece.ids[v as usize]];
            numbers[v as usize] = number;
            if number as usize == first + written.len() {
                written.push(v);
            }
        }
        Numbers { numbers, written, first, first_tet }
    }
}
