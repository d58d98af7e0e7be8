//! Parts of the old mesh: the tetrahedra about cells of space.
use super::Error;
use super::stored::{NOTHING, Slice, Stored, bounds_of, joined, touch};
use crate::mesh::adjacency::MatchedFaces;
use crate::mesh::box_tree::{Bounds, BoxTree};
use crate::mesh::locate::Locator;
use crate::mesh::ranges::{Bins, Scratch};
use crate::mesh::{Elements, TetMesh};
use crate::tasks::Team;
use std::sync::Arc;

/// Slices a thread whose tetrahedra wait to be dealt.
const AT_ONCE: usize = 2;

/// Tetrahedra that are asked together which cells they may be in: where they are near each other, these are few.
const TOGETHER: usize = 64;

/// Cells that are gone through one by one.
const FEW: usize = 16;

/// A tetrahedron of the old mesh.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct Tet {
    number: u32,
    nodes: [u32; 4],
}

/// Deals out the tetrahedra to all boxes that theirs touch, a bin a box, in the order of their numbers. A box may get some that do not touch it.
pub(super) fn deal(
    team: Team<'_>,
    old: &Stored<'_>,
    boxes: &[Bounds],
    size: usize,
    scratch: &Scratch,
) -> Result<Bins<Tet>, Error> {
    let mut bins = Bins::new(scratch, boxes.len())?;
    if boxes.is_empty() {
        return Ok(bins);
    }
    let tree = BoxTree::on(team, boxes.len(), |item| boxes[item as usize]);
    let (tets, together) = (old.counts().tets, size * AT_ONCE * team.threads());
    for start in (0..tets).step_by(together) {
        let count = together.min(tets - start);
        let parts = team.chunks(size, count, |range| -> Result<_, Error> {
            let range = start + range.start..start + range.end;
            let nodes = old.tets(range.clone())?;
            let slice = old.slice(nodes.clone())?;
            Ok(dealt(&slice, &tree, boxes, |t| Tet { number: (range.start + t) as u32, nodes: nodes[t] }))
        });
        for part in parts {
            for (bin, tet) in part? {
                bins.put(bin as usize, tet)?;
            }
        }
    }
    Ok(bins)
}

/// The tetrahedra of a slice with the boxes that theirs touch.
fn dealt(slice: &Slice, tree: &BoxTree, boxes: &[Bounds], tet: impl Fn(usize) -> Tet) -> Vec<(u32, Tet)> {
    let (mut found, mut own, mut near) = (Vec::with_capacity(2 * slice.nodes.len()), Vec::new(), Vec::new());
    for start in (0..slice.nodes.len()).step_by(TOGETHER) {
        let range = start..slice.nodes.len().min(start + TOGETHER);
        own.clear();
        own.extend(range.clone().map(|t| bounds_of(slice.corners(t))));
        let all = own.iter().copied().fold(NOTHING, joined);
        near.clear();
        tree.overlapping(&all, |bin| near.push(bin));
        for (t, own) in range.zip(&own) {
            if near.len() > FEW {
                tree.overlapping(own, |bin| found.push((bin, tet(t))));
            } else {
                let touched = near.iter().filter(|&&bin| touch(own, &boxes[bin as usize]));
                found.extend(touched.map(|&bin| (bin, tet(t))));
            }
        }
    }
    found
}

/// A part of the old mesh.
pub(super) struct Part {
    /// Of the part; its tetrahedra and vertices are in the order of the mesh.
    pub locator: Locator,
    /// Numbers of the tetrahedra in the mesh, ascending.
    pub tets: Vec<u32>,
    /// Numbers of the vertices in the mesh, ascending.
    pub vertices: Vec<u32>,
}

/// What came of reading a part.
pub(super) enum Read {
    /// The part.
    Part(Part),
    /// There is no tetrahedron.
    Nothing,
    /// There are too many.
    TooMany,
}

impl Part {
    /// All tetrahedra of a bin that touch a box, and maybe others, if they are no more than `fits` likes.
    ///
    /// # Errors
    /// When the scratch folder cannot be read.
    pub fn read(
        old: &Stored<'_>,
        (bins, bin): (&Bins<Tet>, usize),
        within: &Bounds,
        fits: impl Fn(usize) -> bool,
    ) -> Result<Read, Error> {
        let is_whole = fits(bins.count(bin));
        let mut all = Vec::with_capacity(if is_whole { bins.count(bin) } else { 0 });
        bins.each_chunk(bin, |tets| -> Result<bool, Error> {
            if is_whole {
                all.extend_from_slice(tets);
                return Ok(true);
            }
            let slice = old.slice(tets.iter().map(|tet| tet.nodes).collect())?;
            all.extend((0..tets.len()).filter(|&t| touch(&bounds_of(slice.corners(t)), within)).map(|t| tets[t]));
            Ok(fits(all.len()))
        })?;
        if !is_whole && !fits(all.len()) {
            return Ok(Read::TooMany);
        }
        if all.is_empty() {
            return Ok(Read::Nothing);
        }
        let (tets, nodes) = (all.iter().map(|tet| tet.number).collect(), all.iter().map(|tet| tet.nodes).collect());
        drop(all);
        let Slice { nodes, numbers: vertices, points } = old.slice(nodes)?;
        let faces = MatchedFaces::of(Team::alone(), &nodes);
        let tets_of_mesh = Elements { nodes, refs: Vec::new() };
        let mesh = TetMesh { vertices: points, tets: tets_of_mesh, ..TetMesh::default() };
        Ok(Read::Part(Self { locator: Locator::on(Team::alone(), Arc::new(mesh), faces), tets, vertices }))
    }
}
