//! A watertight triangulation of a CAD shape: edges are divided once, faces are triangulated in the plane of their parameters between them.
mod check;
mod edges;
mod outline;
mod patch;
pub mod plane;
mod points;
mod proximity;
mod rough;
#[cfg(test)]
mod tests;
mod twins;
mod whole;

pub use check::{Report, report};
pub use points::Place;
pub use whole::ENOUGH;

use crate::geometry::{Geometry, OcctModel};
use crate::mesh::vector::Vec3;
use crate::tasks::Team;
use outline::{Outline, Segment};
use patch::Patch;
use plane::{Conflict, NONE};
use points::Points;
use std::collections::BTreeSet;
use twins::Twins;

/// How fine the triangles are.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Segments for a radian of curvature.
    pub segments: f64,
    /// Greatest length of an edge, model units.
    pub greatest: f64,
    /// Edges as short as this are not divided further, model units.
    pub least: f64,
    /// By how much lengths may grow over a unit of length.
    pub growth: f64,
    /// Rounds of division where triangles cross, at most.
    pub rounds: usize,
}

impl Options {
    /// For a model with this diagonal of its box.
    pub fn new(diagonal: f64) -> Self {
        Self { segments: 1.5, greatest: diagonal / 8.0, least: 1e-5 * diagonal, growth: 0.5, rounds: 12 }
    }

    /// The same with sizes divided by `ratio`.
    pub fn finer(self, ratio: f64) -> Self {
        Self { segments: ratio * self.segments, greatest: self.greatest / ratio, ..self }
    }
}

/// A size that is wanted about a point of a face.
#[derive(Clone, Copy, Debug)]
pub struct Wish {
    /// The point.
    pub at: Vec3,
    /// Length of the edges there.
    pub size: f64,
    /// How far that holds; beyond it grows.
    pub radius: f64,
}

/// The triangulation of a shape.
#[derive(Clone, Debug, Default)]
pub struct Surface {
    /// Coordinates, model units: first those of the model's vertices and edges.
    pub points: Vec<Vec3>,
    /// What each point lies on, with parameters.
    pub places: Vec<Place>,
    /// Triangles. They look out of the solid; of a face between two, out of the first of its `sides`.
    pub triangles: Vec<[u32; 3]>,
    /// The face of each triangle.
    pub faces: Vec<u32>,
    /// For each face the solids behind and before its triangles.
    pub sides: Vec<[Option<u32>; 2]>,
    /// For each edge its points, by parameter; nothing of a degenerate edge.
    pub chains: Vec<Vec<u32>>,
    /// Faces that are triangulated by their border alone, since that crosses itself in the plane of the parameters.
    pub rough: Vec<u32>,
    /// Faces without triangles.
    pub missing: Vec<u32>,
    /// Pairs of triangles that cross.
    pub crossings: Vec<[u32; 2]>,
    /// How many triangles are flat to rounding.
    pub flat: usize,
    /// How many triangles look away from their face.
    pub turned: usize,
    /// For each triangle about how far it is off its face.
    pub off: Vec<f64>,
}

impl Surface {
    /// What is wrong with it: fewer is better.
    fn faults(&self) -> (usize, usize) {
        (self.missing.len(), self.crossings.len() + self.flat + self.turned)
    }
}

/// A face at work.
#[derive(Default)]
struct Face {
    segments: Vec<Segment>,
    patch: Option<Patch>,
    wishes: Vec<Wish>,
    barred: BTreeSet<[u32; 2]>,
    /// Rounds in which its border was in conflict.
    conflicts: usize,
    /// Rounds in which triangles looked away.
    turned: usize,
    is_rough: bool,
}

/// Rounds of all faces at most.
const ROUNDS: usize = 40;
/// Rounds in which the border of a face may be in conflict.
const CONFLICTS: usize = 9;
/// Rounds in which triangles of a face may look away.
const TURNED: usize = 3;

/// Further attempts: by how much finer curvature is followed, and how much faster sizes grow.
const ATTEMPTS: [(f64, f64); 7] =
    [(1.2, 1.4), (1.5, 0.8), (0.85, 1.0), (1.0, 0.7), (0.85, 1.6), (0.7, 1.0), (2.0, 1.0)];
/// No further attempt is made where the first has more triangles.
const LARGE: usize = 20_000;
/// So many pairs that cross are a fault of the model: no division helps.
const MANY: usize = 3_000;
/// Division ends where more triangles are too near to others than so many, and twice those at first.
const NEAR: usize = 40;
/// Wishes of a face at most.
const WISHES: usize = 256;

/// What is to be done finer.
#[derive(Default)]
struct Asked {
    pieces: Vec<(u32, u32)>,
    faces: BTreeSet<u32>,
}

/// Whether to go on: no once the time is over.
pub type GoOn<'a> = &'a (dyn Fn() -> bool + Sync);

/// Triangulates all faces of a model. Where triangles cross in the end, which finer ones do not cure where faces touch, other sizes are tried:
/// what crosses least is kept. None where `go_on` said no.
pub fn triangulate(team: Team<'_>, model: &OcctModel, options: &Options, go_on: GoOn<'_>) -> Option<Surface> {
    let mut best = attempt(team, model, options, go_on)?;
    for (finer, growth) in ATTEMPTS {
        if best.faults().1 == 0 || best.triangles.len() > LARGE || best.crossings.len() > MANY {
            break;
        }
        let other = attempt(
            team,
            model,
            &Options { segments: finer * options.segments, growth: growth * options.growth, ..*options },
            go_on,
        )?;
        if other.faults() < best.faults() {
            best = other;
        }
    }
    Some(best)
}

/// One attempt: what has the fewest faults of all rounds.
fn attempt(team: Team<'_>, model: &OcctModel, options: &Options, go_on: GoOn<'_>) -> Option<Surface> {
    let topology = model.topology();
    let twins = Twins::of(model);
    let mut points = Points::new(model, edges::divided(model, options, &twins), twins);
    let mut faces: Vec<Face> = topology.faces.iter().map(|_| Face::default()).collect();
    let mut dirty: BTreeSet<u32> = (0..faces.len() as u32).collect();
    let mut history: Vec<usize> = Vec::new();
    let mut most_near = None;
    let mut best: Option<((usize, usize), Surface)> = None;
    for _ in 0..ROUNDS {
        let mut asked = Asked::default();
        let taken = |&face: &u32| (face, std::mem::take(&mut faces[face as usize]), Asked::default());
        let mut at_work: Vec<(u32, Face, Asked)> = dirty.iter().map(taken).collect();
        team.fill(1, &mut at_work, |_, some| {
            for (index, face, asked) in some {
                if go_on() {
                    work((model, options, go_on), &points, *index, face, asked);
                }
            }
        });
        if !go_on() {
            return None;
        }
        for (index, face, of_face) in at_work {
            faces[index as usize] = face;
            asked.pieces.extend(of_face.pieces);
            asked.faces.extend(of_face.faces);
        }
        if asked.pieces.is_empty() && asked.faces.is_empty() {
            let mut surface = whole::assemble(model, &points, &faces);
            let (faults, near) =
                whole::find_faults((team, model, options, go_on), &mut surface, &mut faces, &mut asked);
            if !go_on() {
                return None;
            }
            history.push(faults);
            if best.as_ref().is_none_or(|(least, _)| (faults, near) < *least) {
                best = Some(((faults, near), surface));
            }
            // In a tip triangles come the nearer the finer they are.
            let is_tip = near > *most_near.get_or_insert(2 * near + NEAR);
            if faults + near == 0 || history.len() > options.rounds || is_tip || faults > 0 && is_hopeless(&history) {
                break;
            }
        }
        asked.pieces.sort_unstable();
        asked.pieces.dedup();
        let touched = points.halve(model, &asked.pieces, options.least);
        dirty = asked.faces;
        dirty.extend(touched.iter().flat_map(|&edge| &topology.edges[edge as usize].faces));
        if dirty.is_empty() {
            break;
        }
    }
    let surface = best.map_or_else(
        || {
            let mut surface = whole::assemble(model, &points, &faces);
            whole::find_crossings(&mut surface, go_on);
            surface
        },
        |(_, surface)| surface,
    );
    Some(surface)
}

/// Whether further rounds will not help, after so many faults in those before: triangles that are finer cross more often where faces do so in
/// the model.
fn is_hopeless(history: &[usize]) -> bool {
    let (first, last) = (history[0], history[history.len() - 1]);
    let before = history.len().checked_sub(7).map(|i| history[i]);
    last > MANY || last > 8 * first + 200 || before.is_some_and(|before| last >= before)
}

/// Triangulates one face, or tells what of its border is to be divided first. Ends early where `go_on` says no.
fn work(
    (model, options, go_on): (&OcctModel, &Options, GoOn<'_>),
    points: &Points,
    index: u32,
    face: &mut Face,
    asked: &mut Asked,
) {
    let mut on = model.evaluator();
    let Some(outline) = outline::outline(model, &mut on, points, index, options.segments) else {
        face.patch = None;
        return;
    };
    face.segments.clone_from(&outline.segments);
    face.is_rough = false;
    match Patch::new(&mut on, index, &outline, points) {
        Ok(mut patch) => {
            patch.is_strict = face.turned < TURNED;
            patch.refine(&mut on, index, options, (&face.wishes, &face.barred), go_on);
            face.turned += 1;
            if face.turned <= TURNED {
                ask_turned(&patch, &outline, index, face, asked);
            }
            face.patch = Some(patch);
        }
        Err(conflicts) => {
            face.conflicts += 1;
            let before = asked.pieces.len();
            if face.conflicts <= CONFLICTS {
                for conflict in conflicts {
                    ask_conflict(conflict, &outline, asked);
                }
                let is_fine = |&(edge, piece): &(u32, u32)| points.length(edge, piece) > options.least;
                if asked.pieces[before..].iter().any(is_fine) {
                    return;
                }
                asked.pieces.truncate(before);
            }
            face.patch = rough::patch(&mut on, index, &outline, points);
            face.is_rough = true;
        }
    }
}

/// Asks for what is in conflict in halves.
fn ask_conflict(conflict: Conflict, outline: &Outline, asked: &mut Asked) {
    let ask = &mut |segment: u32| {
        let segment = &outline.segments[segment as usize];
        if segment.piece != NONE {
            asked.pieces.push((segment.edge, segment.piece));
        }
    };
    let at = |corner: u32| {
        (0..outline.segments.len() as u32).filter(move |&s| outline.segments[s as usize].ends.contains(&corner))
    };
    match conflict {
        Conflict::Cross(a, b) => [a, b].into_iter().for_each(ask),
        Conflict::Touch { point, segment } => at(point).chain([segment]).for_each(ask),
        Conflict::Equal(a, b) => at(a).chain(at(b)).for_each(ask),
        Conflict::Lost => {}
    }
}

/// Asks for finer triangles where some look away from the surface.
fn ask_turned(patch: &Patch, outline: &Outline, index: u32, face: &mut Face, asked: &mut Asked) {
    for &segment in &patch.pressed {
        let segment = &outline.segments[segment as usize];
        if segment.piece != NONE {
            asked.pieces.push((segment.edge, segment.piece));
        }
    }
    let turned = patch.turned_away();
    let is_few = turned.len() <= 8;
    for (t, fixed) in turned {
        let pieces = fixed.iter().filter(|&&s| s != NONE).map(|&s| &outline.segments[s as usize]);
        let before = asked.pieces.len();
        asked.pieces.extend(pieces.filter(|s| s.piece != NONE).map(|s| (s.edge, s.piece)));
        if asked.pieces.len() == before && is_few && face.wishes.len() < WISHES {
            let corners = patch.triangles[t as usize].map(|c| patch.at[c as usize]);
            let (at, length, _) = whole::longest(&corners);
            face.wishes.push(Wish { at, size: 0.4 * length, radius: 0.0 });
            asked.faces.insert(index);
        }
    }
}
