//! |H| of a sensor, slice by slice of the vertices.
use super::local::Local;
use super::mesh::Mesh;
use super::{Error, SLICE, Sizes, Step, each_slice};
use crate::mesh::ranges::{Column, Scratch};
use crate::metric::Sym3;
use crate::metric::multiscale;
use crate::metric::multiscale::sensor::{Bounds, Span};
use crate::metric::recovery::extrapolate;
use crate::metric::recovery::fit::{Around, RINGS};
use crate::tasks::Team;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// What is found of a sensor, as [`multiscale::sensor::Absolute`] has it in memory.
pub(super) struct Absolute {
    /// |H| at the vertices; the mean over the steps.
    pub hessians: Column<Sym3>,
    /// Eigenvalues below this are rounding.
    pub floor: f64,
    /// Vertices that took the Hessian of their neighbours, the most in a step.
    pub unfitted: usize,
}

/// |H| of a sensor with these steps; `number` is for errors.
pub(super) fn absolute(
    team: Team<'_>,
    mesh: &Mesh,
    (number, steps): (usize, &[Step<'_>]),
    sizes: &Sizes,
    scratch: &Scratch,
) -> Result<Absolute, Error> {
    let (mean, hessians, values) = (scratch.column()?, scratch.column()?, scratch.column()?);
    let (mut unfitted, mut span) = (0, Span::default());
    for (place, step) in steps.iter().enumerate() {
        let bounds = each_slice(team, SLICE, mesh.vertices, |range| {
            let slice = step.file.fields(Team::alone(), range.clone())?.component(step.component).unwrap_or_default();
            values.write(range.start, &slice)?;
            let not_finite = |vertex| multiscale::Error::NotFinite { sensor: number, step: place, vertex };
            Ok(Bounds::of(range.start, &slice).map_err(not_finite)?)
        })?;
        span = span.and(bounds.into_iter().fold(Bounds::NONE, Bounds::and));
        let without = each_slice(team, sizes.vertices, mesh.vertices, |own| fit(mesh, &values, &hessians, own, sizes))?;
        let without = without.concat();
        unfitted = unfitted.max(without.len());
        fill(team, mesh, &hessians, without)?;
        each_slice(team, SLICE, mesh.vertices, |range| {
            let mut slice: Vec<Sym3> = hessians.read(range.clone())?;
            slice.iter_mut().for_each(|h| *h = h.magnitude());
            if place > 0 {
                let sums: Vec<Sym3> = mean.read(range.clone())?;
                slice.iter_mut().zip(sums).for_each(|(h, sum)| *h = sum.plus(*h));
            }
            Ok(mean.write(range.start, &slice)?)
        })?;
    }
    let (share, is_curved) = (1.0 / steps.len().max(1) as f64, AtomicBool::new(false));
    each_slice(team, SLICE, mesh.vertices, |range| {
        let mut slice: Vec<Sym3> = mean.read(range.clone())?;
        slice.iter_mut().for_each(|sum| *sum = sum.times(share));
        if !is_curved.load(Relaxed) && has_curved(mesh, span, range.clone(), &slice, sizes)? {
            is_curved.store(true, Relaxed);
        }
        Ok(mean.write(range.start, &slice)?)
    })?;
    match is_curved.into_inner() {
        true => Ok(Absolute { hessians: mean, floor: span.floor(mesh.diameter), unfitted }),
        false => Err(multiscale::Error::Flat { sensor: number }.into()),
    }
}

/// The vertices of a range, by their numbers.
fn numbers(range: &Range<usize>) -> Vec<u32> {
    (range.start as u32..range.end as u32).collect()
}

/// A range in two halves.
fn halves(range: &Range<usize>) -> [Range<usize>; 2] {
    let middle = range.start.midpoint(range.end);
    [range.start..middle, middle..range.end]
}

/// Fits Hessians at a range of vertices. Returns those whose points do not determine one.
fn fit(
    mesh: &Mesh,
    values: &Column<f64>,
    hessians: &Column<Sym3>,
    own: Range<usize>,
    sizes: &Sizes,
) -> Result<Vec<u32>, Error> {
    let numbers = numbers(&own);
    let Some(local) = Local::read(mesh, &numbers, RINGS, sizes.task)? else {
        let [first, second] = halves(&own);
        let mut without = fit(mesh, values, hessians, first, sizes)?;
        without.extend(fit(mesh, values, hessians, second, sizes)?);
        return Ok(without);
    };
    let values = values.at(&local.numbering.numbers)?;
    let mut around = Around::new(&local.points, &local.around, &values, None);
    let mut without = Vec::new();
    let fitted = numbers.iter().map(|&v| {
        around.hessian(local.numbering.place(v)).0.unwrap_or_else(|| {
            without.push(v);
            Sym3::ZERO
        })
    });
    let fitted: Vec<Sym3> = fitted.collect();
    hessians.write(own.start, &fitted)?;
    Ok(without)
}

/// Fills the Hessians of these vertices, which ascend, by those of their neighbours, ring by ring.
fn fill(team: Team<'_>, mesh: &Mesh, hessians: &Column<Sym3>, mut unknown: Vec<u32>) -> Result<(), Error> {
    while !unknown.is_empty() {
        let filled = each_slice(team, SLICE, unknown.len(), |range| {
            let vertices = &unknown[range];
            let around = mesh.neighbours.around(vertices)?;
            let is_known = |v: &u32| unknown.binary_search(v).is_err();
            let mut near: Vec<u32> = around.entries.iter().copied().filter(is_known).collect();
            near.sort_unstable();
            near.dedup();
            let known = hessians.at(&near)?;
            let rows = vertices.iter().zip(around.rows());
            Ok(rows
                .filter_map(|(&vertex, row)| {
                    let known = row.iter().filter_map(|v| near.binary_search(v).ok().map(|at| known[at]));
                    extrapolate::mean(known).map(|mean| (vertex, mean))
                })
                .collect::<Vec<_>>())
        })?;
        let (vertices, means): (Vec<u32>, Vec<Sym3>) = filled.concat().into_iter().unzip();
        if vertices.is_empty() {
            break;
        }
        hessians.replace(&vertices, &means)?;
        unknown.retain(|v| vertices.binary_search(v).is_err());
    }
    // A vertex that no tetrahedron has keeps zero. In memory others have an L2 projection.
    let around = mesh.neighbours.around(&unknown)?;
    match unknown.iter().zip(around.rows()).find(|(_, row)| !row.is_empty()) {
        Some((&vertex, _)) => Err(Error::TooFew { vertex }),
        None => Ok(()),
    }
}

/// Whether a field with these |H| at a range of vertices bends there.
fn has_curved(mesh: &Mesh, span: Span, own: Range<usize>, hessians: &[Sym3], sizes: &Sizes) -> Result<bool, Error> {
    let vertices = numbers(&own);
    let Some(local) = Local::read(mesh, &vertices, 1, sizes.task)? else {
        let [first, second] = halves(&own);
        let (here, there) = hessians.split_at(first.len());
        return Ok(has_curved(mesh, span, first, here, sizes)? || has_curved(mesh, span, second, there, sizes)?);
    };
    Ok(vertices.iter().zip(hessians).any(|(&v, &hessian)| {
        let place = local.numbering.place(v);
        span.is_curved(&local.points, (place as usize, hessian), local.around.of_vertex(place))
    }))
}
