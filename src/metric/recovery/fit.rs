//! Recovery by a quadratic function for each vertex, fitted to the values of its neighbours and theirs.
use super::limiter::{self, Limiter};
use super::quadratic::{Fitted, Quadratic};
use super::rings::Rings;
use super::{extrapolate, l2};
use crate::mesh::TetMesh;
use crate::mesh::stamped_set::StampedSet;
use crate::mesh::vector::{Vec3, sub};
use crate::mesh::vertex_neighbours::VertexNeighbours;
use crate::metric::Sym3;
use crate::tasks::{GRAIN, Team};
use std::ops::Range;

/// Vertices a task: one takes some microseconds.
const VERTICES: usize = GRAIN / 16;

/// With so many neighbours they alone are fitted. With fewer of them, or a poor fit, their neighbours are taken too. On meshes adapted to
/// the scalars of cases/convergence (complexity 8000) that lowers the error by 1 to 4 % against two rings always, and by 27 % at a jump,
/// which is then in fewer layers.
const ENOUGH: usize = 14;

/// Below this quality of a fit another ring is taken.
const GOOD: f64 = 0.05;

/// Below this quality a fit to three rings is not used.
const USABLE: f64 = 1e-3;

/// The Hessian of a field at the vertices, (n,) from values (n,), and at how many it is that of the neighbours. For quadratic functions it is
/// right to rounding at every vertex with a usable fit, on the boundary as inside. With a limiter, vertices at jumps have the |H| that the
/// limiter gives.
pub fn hessians(
    team: Team<'_>,
    mesh: &TetMesh,
    rings: &Rings,
    values: &[f64],
    limiter: Option<Limiter>,
) -> (Vec<Sym3>, usize) {
    let around = || Around::new(&mesh.vertices, rings.around(), values, limiter);
    let fitted = team.map_with(VERTICES, values.len(), around, |around, vertex| around.hessian(vertex as u32));
    let count = |range: Range<usize>| fitted[range].iter().filter(|(hessian, _)| hessian.is_none()).count();
    let unfitted = team.chunks(GRAIN, fitted.len(), count).into_iter().sum();
    if unfitted == 0 && limiter.is_none() {
        return (team.map(GRAIN, fitted.len(), |v| fitted[v].0.unwrap_or(Sym3::ZERO)), 0);
    }
    let mut found: Vec<Option<Sym3>> = team.map(GRAIN, fitted.len(), |v| fitted[v].0);
    if limiter.is_some() {
        let is_jump = team.map(GRAIN, fitted.len(), |v| fitted[v].1);
        limiter::average(team, rings, &mut found, &is_jump);
    }
    drop(fitted);
    if unfitted == 0 {
        return (team.map(GRAIN, found.len(), |v| found[v].unwrap_or(Sym3::ZERO)), 0);
    }
    let filled = extrapolate::fill(team, rings, found);
    // A mesh of a few cells has no fit at all.
    let projected = if filled.contains(&None) { l2::hessians(team, mesh, rings, values) } else { Vec::new() };
    (team.map(GRAIN, filled.len(), |v| filled[v].unwrap_or_else(|| projected[v])), unfitted)
}

/// What one task works with: what is known of the vertices around those that are fitted, by the places of the lists.
pub(in crate::metric) struct Around<'a> {
    points: &'a [Vec3],
    neighbours: &'a VertexNeighbours,
    values: &'a [f64],
    limiter: Option<Limiter>,
    seen: StampedSet,
    /// The vertices around the one in hand, ring by ring.
    stencil: Vec<u32>,
    fit: Quadratic,
    /// Least and greatest value of the points, from that of the vertex.
    span: [f64; 2],
}

/// How many rings around a vertex a fit may need.
pub(in crate::metric) const RINGS: usize = 3;

impl<'a> Around<'a> {
    /// Of vertices at these points, with their neighbours and values. Neighbours are known of all that are nearer than [`RINGS`] edges, points and
    /// values of those so near too.
    pub fn new(
        points: &'a [Vec3],
        neighbours: &'a VertexNeighbours,
        values: &'a [f64],
        limiter: Option<Limiter>,
    ) -> Self {
        let fit = Quadratic::telling(limiter.is_some());
        let (seen, stencil) = (StampedSet::default(), Vec::new());
        Self { points, neighbours, values, limiter, seen, stencil, fit, span: [0.0; 2] }
    }

    /// The Hessian, none where the points do not determine it, and whether it is one at a jump.
    pub fn hessian(&mut self, vertex: u32) -> (Option<Sym3>, bool) {
        self.seen.clear();
        self.seen.insert(vertex);
        self.stencil.clear();
        self.fit.start();
        self.span = [0.0; 2];
        let good = |fitted: &Fitted| fitted.quality > GOOD;
        let mut last = self.grow(vertex, 0..0);
        let few = self.stencil.len() < ENOUGH;
        let near = if few && self.limiter.is_none() { None } else { self.fit.fit().filter(good) };
        let near_step = self.step();
        if let Some(fitted) = near.filter(|_| !few) {
            return self.limited(fitted, near_step);
        }
        last = self.grow(vertex, last);
        if let Some(wide) = self.fit.fit().filter(good) {
            return match (self.limiter, near) {
                (Some(limiter), Some(near)) if limiter.prefers(&near, &wide, self.step()) => {
                    self.limited(near, near_step)
                }
                _ => self.limited(wide, self.step()),
            };
        }
        self.grow(vertex, last);
        let fitted = self.fit.fit().filter(|fitted| fitted.quality > USABLE);
        fitted.map_or((None, false), |fitted| self.limited(fitted, self.step()))
    }

    /// By how much the values of the points differ.
    fn step(&self) -> f64 {
        self.span[1] - self.span[0]
    }

    #[inline]
    fn limited(&self, fitted: Fitted, step: f64) -> (Option<Sym3>, bool) {
        let sharpened = self.limiter.and_then(|limiter| limiter.sharpened(&fitted, step));
        (Some(sharpened.unwrap_or(fitted.hessian)), sharpened.is_some())
    }

    /// Adds the neighbours of the last ring, given by its places in the stencil (empty: of the vertex itself); returns those of the new one.
    fn grow(&mut self, vertex: u32, last: std::ops::Range<usize>) -> std::ops::Range<usize> {
        let start = self.stencil.len();
        if start == 0 {
            self.add(vertex, vertex);
        }
        for at in last {
            self.add(vertex, self.stencil[at]);
        }
        start..self.stencil.len()
    }

    /// Adds the neighbours of `other`.
    #[inline]
    fn add(&mut self, vertex: u32, other: u32) {
        let (p, value) = (self.points[vertex as usize], self.values[vertex as usize]);
        for &near in self.neighbours.of_vertex(other) {
            if self.seen.insert(near) {
                self.stencil.push(near);
                let [x, y, z] = sub(self.points[near as usize], p);
                let rise = self.values[near as usize] - value;
                self.span = [self.span[0].min(rise), self.span[1].max(rise)];
                self.fit.push([x, y, z, rise]);
            }
        }
    }
}
