//! A range of vertices with all tetrahedra at them.
use super::blocks::Blocks;
use super::numbering::Numbering;
use crate::mesh::io::Error;
use crate::mesh::io::slices::MeshReader;
use crate::tasks::{GRAIN, Team};
use std::ops::Range;

/// A tetrahedron with its number, and its entries in the rows of the vertices.
const OF_TET: usize = 20 + 16;

/// A vertex: number, coordinates and metric, and where its row begins.
const OF_VERTEX: usize = 4 + 24 + 48 + 4;

/// A vertex of the range for each thread, while the rows are made.
const OF_OWN: usize = 4;

/// Most threads that make rows: each of them has some entries a vertex.
const MAKERS: usize = 26;

/// A vertex of another range while it is numbered: in the list, in the table, and while that grows.
const OF_OTHER: usize = 4 + 24;

/// Tetrahedra that are read by a task.
const READ: usize = 1 << 14;

/// Tasks a thread whose tetrahedra wait to be joined, where there is room for them.
const AT_ONCE: usize = 4;

/// The share of the room for tetrahedra that wait.
const WAITING: usize = 8;

/// Vertices a tetrahedron, about: what a first range is guessed by.
const PER_TET: usize = 5;

/// Calls `f` with range after range of the vertices of a mesh, each of which fits into so many bytes less what `f` said last that it holds by
/// now. A range that turns out not to fit is halved; one vertex is taken whatever it takes.
///
/// # Errors
/// Those of reading, and of `f`.
pub fn each_range<E: From<Error>>(
    team: Team<'_>,
    mesh: &MeshReader,
    blocks: &Blocks,
    bytes: usize,
    mut f: impl FnMut(&Ranged) -> Result<usize, E>,
) -> Result<(), E> {
    let vertices = mesh.counts().vertices;
    let most = (bytes / (2 * (OF_TET * PER_TET + OF_VERTEX))).clamp(1, vertices.max(1));
    let (mut size, mut begin, mut held) = (most, 0, 0);
    while begin < vertices {
        let own = begin..vertices.min(begin + size);
        let Some(ranged) = Ranged::read(team, mesh, blocks, &own, bytes.saturating_sub(held))? else {
            size = own.len().div_ceil(2);
            continue;
        };
        held = f(&ranged)?;
        begin = own.end;
        // What did not fit may have been an exception.
        size = (size + size.div_ceil(8)).min(most);
    }
    Ok(())
}

/// A range of vertices with all tetrahedra at them.
pub struct Ranged {
    /// By places in `numbers`.
    pub tets: Vec<[u32; 4]>,
    /// Their numbers in the file.
    pub tet_numbers: Vec<u32>,
    /// The numbers of all their vertices in the mesh, and of those of the range, ascending.
    pub numbers: Vec<u32>,
    /// Places in `numbers` of the vertices of the range.
    pub own: Range<u32>,
}

impl Ranged {
    /// Reads the tetrahedra; none when they do not fit into so many bytes.
    fn read(
        team: Team<'_>,
        mesh: &MeshReader,
        blocks: &Blocks,
        own: &Range<usize>,
        room: usize,
    ) -> Result<Option<Self>, Error> {
        let fits = |tets: usize, vertices: usize, others: usize| {
            let of_threads = OF_OWN * own.len() * team.threads().min(MAKERS);
            own.len() == 1 || of_threads + OF_TET * tets + OF_VERTEX * vertices + OF_OTHER * others <= room
        };
        let is_own = |v: u32| own.contains(&(v as usize));
        let (mut tets, mut tet_numbers) = (Vec::new(), Vec::new());
        let at_once = (room / WAITING / (READ * 20)).clamp(1, AT_ONCE * team.threads());
        for ranges in blocks.with(own, READ.max(blocks.size)).chunks(at_once) {
            let parts = team.chunks(1, ranges.len(), |index| -> Result<_, Error> {
                let range = ranges[index.start].clone();
                let read = mesh.tets(Team::alone(), range.clone())?.nodes;
                let at = (range.start as u32..).zip(read).filter(|(_, nodes)| nodes.iter().any(|&v| is_own(v)));
                Ok(at.unzip::<u32, [u32; 4], Vec<_>, Vec<_>>())
            });
            for part in parts {
                let (part_numbers, part) = part?;
                tet_numbers.extend(part_numbers);
                tets.extend(part);
            }
            if !fits(tets.len(), own.len(), 0) {
                return Ok(None);
            }
        }
        let others = tets.as_flattened().iter().copied().filter(|&v| !is_own(v));
        let Some(others) = Numbering::of_at_most(others, |others| fits(tets.len(), own.len() + others, others)) else {
            return Ok(None);
        };
        let below = others.numbers.partition_point(|&v| (v as usize) < own.start) as u32;
        let count = own.len() as u32;
        team.fill(GRAIN, tets.as_flattened_mut(), |_, nodes| {
            for v in nodes {
                *v = match *v {
                    v if is_own(v) => v - own.start as u32 + below,
                    v => {
                        let place = others.place(v);
                        if place < below { place } else { place + count }
                    }
                };
            }
        });
        let others = others.into_numbers();
        let (before, after) = others.split_at(below as usize);
        let numbers = before.iter().copied().chain(own.start as u32..own.end as u32).chain(after.iter().copied());
        let numbers = numbers.collect();
        Ok(Some(Self { tets, tet_numbers, numbers, own: below..below + count }))
    }
}
