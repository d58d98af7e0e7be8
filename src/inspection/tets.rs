//! The tetrahedra by themselves, in their order.
use super::points::Source;
use super::{Error, Sizes};
use crate::mesh::Elements;
use crate::mesh::ranges::{Bits, Blocks, Classes, Numbering};
use crate::mesh::validity::{Found, check_tet};
use crate::metric::Figures;
use crate::metric::statistics::Part;
use crate::tasks::Team;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// What is found at a slice.
struct Slice {
    found: Found,
    bits: Vec<Bits>,
    figures: Figures,
}

/// Checks and measures all tetrahedra, a slice a task. Returns the flaws in their order, the index of the blocks and the figures.
pub(super) fn check(team: Team<'_>, source: &Source<'_>, sizes: &Sizes) -> Result<(Found, Blocks, Figures), Error> {
    let counts = source.mesh.counts();
    let classes = Classes::of(counts.vertices);
    let failed = AtomicBool::new(false);
    let slices = team.chunks(sizes.slice, counts.tets, |range| {
        // What comes after an error is not asked for any more.
        let slice = (!failed.load(Relaxed)).then(|| Slice::of(source, sizes.block, classes, range));
        if let Some(Err(_)) = slice {
            failed.store(true, Relaxed);
        }
        slice
    });
    let (mut found, mut bits, mut figures) = (Found::default(), Vec::new(), None::<Figures>);
    for slice in slices {
        let Some(slice) = slice.transpose()? else { continue };
        found = found.and(slice.found);
        bits.extend(slice.bits);
        figures = Some(match figures {
            Some(before) => before.and(slice.figures),
            None => slice.figures,
        });
    }
    let none = || {
        let (tets, triangles, edges) = (Elements::default(), Elements::default(), Elements::default());
        source.figures(Part { vertices: &[], own_vertices: 0, tets: &tets, triangles: &triangles, edges: &edges }, None)
    };
    let blocks = Blocks { classes, size: sizes.block, tets: counts.tets, bits };
    Ok((found, blocks, figures.unwrap_or_else(none)))
}

impl Slice {
    fn of(source: &Source<'_>, block: usize, classes: Classes, range: Range<usize>) -> Result<Self, Error> {
        let team = Team::alone();
        let start = range.start;
        let mut tets = source.mesh.tets(team, range)?;
        let bits = tets.nodes.chunks(block).map(|block| classes.bits(block)).collect();
        let numbering = Numbering::of(tets.nodes.iter().flatten().copied());
        for node in tets.nodes.as_flattened_mut() {
            *node = numbering.place(*node);
        }
        let numbers = numbering.into_numbers();
        let points = source.points(team, &numbers)?;
        let metrics = source.metrics(team, &numbers, &points)?;
        let mut found = Found::default();
        for (t, nodes) in (start..).zip(&tets.nodes) {
            let [of_mesh, here] = [nodes.map(|v| numbers[v as usize]), *nodes];
            check_tet(&mut found, t, of_mesh, here.map(|v| points[v as usize]));
        }
        let part = Part {
            vertices: &points,
            own_vertices: 0,
            tets: &tets,
            triangles: &Elements::default(),
            edges: &Elements::default(),
        };
        let figures = source.figures(part, metrics.as_deref());
        Ok(Self { found, bits, figures })
    }
}
