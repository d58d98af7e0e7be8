//! Closest points: closed forms where there are, else a descent from the guess, and cells that rule the rest out.
use super::cells::{self, Cell};
use super::curve::{self, CurvePoint};
use super::evaluator::OcctEvaluator;
use super::newton::{self, SurfacePoint};
use super::range::{is_whole, place};
use crate::geometry::{Evaluate, OnCurve, OnSurface};
use crate::mesh::vector::{Vec3, distance};

/// What counts as closer, relative: less is rounding.
const CLOSER: f64 = 1.0 - 1e-12;

/// Closest point of an edge, ends included.
pub fn on_edge(on: &mut OcctEvaluator, edge: u32, point: Vec3, guess: Option<f64>) -> OnCurve {
    on_edge_within(on, edge, point, guess, f64::INFINITY).unwrap_or_else(|| {
        // Only a point that is no number has no closest one.
        let t = guess.filter(|t| t.is_finite()).unwrap_or(on.model.topology.edges[edge as usize].range[0]);
        let (t, _) = place(t, on.model.topology.edges[edge as usize].range, None);
        OnCurve { t, point: on.edge_frame(edge, t).point, distance: f64::NAN }
    })
}

/// The same, if it is closer than `limit`.
fn on_edge_within(on: &mut OcctEvaluator, edge: u32, point: Vec3, guess: Option<f64>, limit: f64) -> Option<OnCurve> {
    let model = on.model;
    let entity = &model.topology.edges[edge as usize];
    if let Some(here) = on.degenerate_point(edge) {
        let found = OnCurve { t: entity.range[0], point: here, distance: distance(here, point) };
        return (found.distance < limit).then_some(found);
    }
    let at = |on: &mut OcctEvaluator, t: f64| {
        let here = on.curve(edge, t).point;
        OnCurve { t, point: here, distance: distance(here, point) }
    };
    let found = match model.curves[edge as usize].form.foot(point) {
        Some(foot) => {
            let (t, inside) = place(foot, entity.range, entity.period);
            let [first, last] = entity.range;
            if inside { at(on, t) } else { nearer(at(on, first), at(on, last)) }
        }
        None => {
            let found = search_curve(on, edge, point, guess, limit)?;
            OnCurve { t: found.t, point: found.point, distance: found.distance }
        }
    };
    (found.distance < limit).then_some(found)
}

fn nearer(a: OnCurve, b: OnCurve) -> OnCurve {
    if b.distance < a.distance { b } else { a }
}

/// The search on a curve without a closed form: down from the guess or the nearest cell, then into every other cell
/// that may hold a closer point.
fn search_curve(on: &mut OcctEvaluator, edge: u32, point: Vec3, guess: Option<f64>, limit: f64) -> Option<CurvePoint> {
    let model = on.model;
    let (shape, range) = (&model.curves[edge as usize], model.topology.edges[edge as usize].range);
    let cells =
        shape.cells.get_or_init(|| cells::cut(|uv| on.curve(edge, uv[0]).point, [range, [0.0; 2]], shape.counts));
    let nearest = nearest_cell(cells, point, limit)?;
    let start = guess.filter(|t| t.is_finite()).map_or(nearest.middle()[0], |t| place(t, range, None).0);
    let mut best = curve::descend(|t| on.curve(edge, t), point, start, range, model.size);
    for cell in cells {
        let [low, high] = cell.bounds[0];
        let width = high - low;
        let known = best.t >= low - width && best.t <= high + width;
        if !known && cell.least_distance(point) < best.distance {
            let found = curve::descend(|t| on.curve(edge, t), point, cell.middle()[0], cell.bounds[0], model.size);
            if found.distance < best.distance * CLOSER {
                best = curve::descend(|t| on.curve(edge, t), point, found.t, range, model.size);
            }
        }
    }
    best.distance.is_finite().then_some(best)
}

/// The cell whose middle is nearest, if any cell reaches within the limit; none for a point that is no number.
fn nearest_cell(cells: &[Cell], point: Vec3, limit: f64) -> Option<&Cell> {
    let mut nearest = (f64::INFINITY, None);
    let mut reached = false;
    for cell in cells {
        let length = distance(cell.center, point);
        reached |= length - cell.radius < limit;
        if length < nearest.0 {
            nearest = (length, Some(cell));
        }
    }
    nearest.1.filter(|_| reached)
}

/// Closest point of a face near the guess. Chords of its edges may leave the face, where its edges do not follow the parameters: there
/// the trimming counts.
pub fn on_surface(on: &mut OcctEvaluator, face: u32, point: Vec3, guess: [f64; 2]) -> OnSurface {
    let model = on.model;
    if let Some(foot) = model.surfaces[face as usize].form.foot(point, guess) {
        let (uv, in_range) = on.placed(face, foot);
        if in_range && is_within(on, face, uv) {
            return at(on, face, uv, point);
        }
    } else if guess[0].is_finite() && guess[1].is_finite() {
        let (start, _) = on.placed(face, guess);
        let bounds = open_bounds(on, face);
        let found = newton::descend(|uv| on.jet(face, uv), point, start, bounds, model.size);
        if found.foot && is_within(on, face, found.uv) {
            return finish(on, face, &found, point);
        }
    }
    on_face(on, face, point, Some(guess))
}

/// Closest point of the trimmed face.
pub fn on_face(on: &mut OcctEvaluator, face: u32, point: Vec3, guess: Option<[f64; 2]>) -> OnSurface {
    let guess = guess.filter(|uv| uv[0].is_finite() && uv[1].is_finite());
    let middle = on.model.topology.faces[face as usize].range.map(|[low, high]| 0.5 * (low + high));
    if !point.iter().all(|x| x.is_finite()) {
        let (uv, _) = on.placed(face, guess.unwrap_or(middle));
        return OnSurface { distance: f64::NAN, ..at(on, face, uv, point) };
    }
    if let Some(feet) = on.model.surfaces[face as usize].form.feet(point, guess.unwrap_or(middle)) {
        return analytic_face(on, face, point, feet.as_slice());
    }
    let found = search_surface(on, face, point, guess);
    found.unwrap_or_else(|| {
        let (uv, _) = on.placed(face, guess.unwrap_or(middle));
        at(on, face, uv, point)
    })
}

/// S at parameters, with its distance.
fn at(on: &mut OcctEvaluator, face: u32, uv: [f64; 2], point: Vec3) -> OnSurface {
    let here = on.surface_point(face, uv);
    OnSurface { uv, point: here, distance: distance(here, point) }
}

/// What a descent has found, with its parameters taken into the range.
fn finish(on: &mut OcctEvaluator, face: u32, found: &SurfacePoint, point: Vec3) -> OnSurface {
    let (uv, _) = on.placed(face, found.uv);
    if uv == found.uv {
        OnSurface { uv, point: found.point, distance: found.distance }
    } else {
        at(on, face, uv, point)
    }
}

/// Bounds for a descent: none where the face closes on itself.
fn open_bounds(on: &OcctEvaluator, face: u32) -> [[f64; 2]; 2] {
    let face = &on.model.topology.faces[face as usize];
    [0, 1].map(
        |k: usize| {
            if is_whole(face.range[k], face.period[k]) { [f64::NEG_INFINITY, f64::INFINITY] } else { face.range[k] }
        },
    )
}

/// Whether the parameters lie in the trimmed face, where that is in doubt.
fn is_within(on: &mut OcctEvaluator, face: u32, uv: [f64; 2]) -> bool {
    !on.model.rounded[face as usize] || inside(on, face, on.placed(face, uv).0)
}

/// Whether the parameters lie in the trimmed face.
fn inside(on: &mut OcctEvaluator, face: u32, uv: [f64; 2]) -> bool {
    on.occt.pin_mut().inside(face, uv[0], uv[1]).unwrap_or(false)
}

/// The closest point of a trimmed analytic face is one of the feet, or on its edges. When it is the surface's closest
/// point there is nothing else to ask.
fn analytic_face(on: &mut OcctEvaluator, face: u32, point: Vec3, feet: &[[f64; 2]]) -> OnSurface {
    let mut best: Option<OnSurface> = None;
    for (i, &foot) in feet.iter().enumerate() {
        let (uv, in_range) = on.placed(face, foot);
        if !in_range || !inside(on, face, uv) {
            continue;
        }
        let found = at(on, face, uv, point);
        if i == 0 {
            return found;
        }
        if best.is_none_or(|best| found.distance < best.distance) {
            best = Some(found);
        }
    }
    let limit = best.map_or(f64::INFINITY, |best| best.distance);
    let on_boundary = on_edges(on, face, point, limit);
    let (uv, _) = on.placed(face, feet[0]);
    on_boundary.or(best).unwrap_or_else(|| at(on, face, uv, point))
}

/// The closest point on the face's edges, as a point of its surface, if it is closer than `limit`.
fn on_edges(on: &mut OcctEvaluator, face: u32, point: Vec3, limit: f64) -> Option<OnSurface> {
    let model = on.model;
    let mut best: Option<(u32, OnCurve)> = None;
    for &edge in &model.topology.faces[face as usize].edges {
        let limit = best.map_or(limit, |(_, best)| best.distance);
        if let Some(found) = on_edge_within(on, edge, point, None, limit) {
            best = Some((edge, found));
        }
    }
    let (edge, found) = best?;
    let uv = on.edge_on_face(edge, found.t, face)?;
    Some(at(on, face, uv, point))
}

/// The search on a surface without a closed form: a foot that the descent from the guess (or the nearest cell) reaches
/// inside the face is the answer when no other cell may hold a closer point; else the edges and those cells decide.
fn search_surface(on: &mut OcctEvaluator, face: u32, point: Vec3, guess: Option<[f64; 2]>) -> Option<OnSurface> {
    let model = on.model;
    let (shape, range) = (&model.surfaces[face as usize], model.topology.faces[face as usize].range);
    let cells = shape.cells.get_or_init(|| cells::cut(|uv| on.surface_point(face, uv), range, shape.counts));
    let start = guess.map_or_else(|| nearest_cell(cells, point, f64::INFINITY).map(Cell::middle), Some)?;
    let (start, _) = on.placed(face, start);
    let first = descend_inside(on, face, point, start);
    let mut best = first;
    let mut pad = std::mem::take(&mut on.pad);
    pad.clear();
    let limit = first.map_or(f64::INFINITY, |best| best.distance);
    for (i, cell) in cells.iter().enumerate() {
        let least = cell.least_distance(point);
        if least < limit && !first.is_some_and(|first| is_beside(on, face, cell, first.uv)) {
            pad.push((least, i as u32));
        }
    }
    if !pad.is_empty() {
        best = on_edges(on, face, point, limit).or(best);
        pad.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        for &(least, i) in &pad {
            let limit = best.map_or(f64::INFINITY, |best| best.distance);
            if least >= limit {
                break;
            }
            best = search_cell(on, face, point, &cells[i as usize], limit).or(best);
        }
    }
    on.pad = pad;
    best
}

/// The foot that the descent from `start` reaches, if it lies in the face.
fn descend_inside(on: &mut OcctEvaluator, face: u32, point: Vec3, start: [f64; 2]) -> Option<OnSurface> {
    let (bounds, size) = (open_bounds(on, face), on.model.size);
    let found = newton::descend(|uv| on.jet(face, uv), point, start, bounds, size);
    let found = found.foot.then(|| finish(on, face, &found, point))?;
    inside(on, face, found.uv).then_some(found)
}

/// The closest point of one cell, if it lies in the face and is closer than `limit`; then the foot that it leads to.
fn search_cell(on: &mut OcctEvaluator, face: u32, point: Vec3, cell: &Cell, limit: f64) -> Option<OnSurface> {
    let size = on.model.size;
    let found = newton::descend(|uv| on.jet(face, uv), point, cell.middle(), cell.bounds, size);
    if found.distance.is_nan() || found.distance >= limit * CLOSER || !inside(on, face, found.uv) {
        return None;
    }
    let rough = finish(on, face, &found, point);
    let polished = descend_inside(on, face, point, found.uv);
    Some(polished.filter(|polished| polished.distance <= rough.distance).unwrap_or(rough))
}

/// Whether the parameters lie in the cell or in one that touches it.
fn is_beside(on: &OcctEvaluator, face: u32, cell: &Cell, uv: [f64; 2]) -> bool {
    let period = on.model.topology.faces[face as usize].period;
    (0..2).all(|k| {
        let [low, high] = cell.bounds[k];
        let middle = 0.5 * (low + high);
        let off = super::range::bring_near(uv[k], middle, period[k]) - middle;
        off.abs() <= 1.5 * (high - low)
    })
}
