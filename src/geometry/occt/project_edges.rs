//! Closest points of edges, and of the edges of a face: closed forms, else a descent and a tree of pieces.
use super::curve::{self, CurvePoint};
use super::evaluator::OcctEvaluator;
use super::hull::{self, as_jet};
use super::pieces::{Jets, Source, cuts};
use super::project::{CLOSER, at, starts};
use super::range::place;
use super::tree::Tree;
use crate::geometry::{Evaluate, OnCurve, OnSurface};
use crate::mesh::vector::{Vec3, distance};

/// Closest point of an edge, ends included.
pub fn on_edge(on: &mut OcctEvaluator, edge: u32, point: Vec3, guess: Option<f64>) -> OnCurve {
    on_edge_within(on, edge, point, guess, f64::INFINITY).unwrap_or_else(|| {
        // Only a point of NaN has no closest one.
        let t = guess.filter(|t| t.is_finite()).unwrap_or(on.model.topology.edges[edge as usize].range[0]);
        let (t, _) = place(t, on.model.topology.edges[edge as usize].range, None);
        OnCurve { t, point: on.edge_frame(edge, t).point, distance: f64::NAN }
    })
}

/// The same, if it is closer than `limit`.
pub fn on_edge_within(
    on: &mut OcctEvaluator,
    edge: u32,
    point: Vec3,
    guess: Option<f64>,
    limit: f64,
) -> Option<OnCurve> {
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

/// The pieces of an edge, made when first asked for.
fn edge_tree<'a>(on: &mut OcctEvaluator<'a>, edge: u32) -> &'a Tree {
    let model = on.model;
    let (shape, range) = (&model.curves[edge as usize], model.topology.edges[edge as usize].range);
    shape.tree.get_or_init(|| {
        let spans = (shape.spans[0] as usize).max(4);
        let period = model.topology.edges[edge as usize].period;
        let cuts = cuts(range, period, shape.form.breaks(), spans);
        let mut jet = |uv: [f64; 2]| as_jet(on.curve(edge, uv[0]));
        let hull =
            &mut |jet: &mut Jets, piece: [[f64; 2]; 2], out: &mut _| hull::of_curve(&shape.form, jet, piece[0], out);
        Tree::new(&mut Source { jet: &mut jet, hull }, [cuts, vec![0.0, 0.0]], [None; 2])
    })
}

/// The search on a curve without a closed form: down from the guess or the nearest piece, then into every other piece
/// that may hold a closer point.
fn search_curve(on: &mut OcctEvaluator, edge: u32, point: Vec3, guess: Option<f64>, limit: f64) -> Option<CurvePoint> {
    let tree = edge_tree(on, edge);
    let (range, size) = (on.model.topology.edges[edge as usize].range, on.model.size);
    let start = match guess.filter(|t| t.is_finite()) {
        Some(t) => place(t, range, None).0,
        None => tree.nearest(point, limit)?.middle()[0],
    };
    let mut best = curve::descend(|t| on.curve(edge, t), point, start, range, size);
    // A closed edge's ends are two ends to the descent.
    let periods = [None; 2];
    tree.visit(point, best.distance, |leaf, limit| {
        let [low, high] = leaf.bounds[0];
        let width = high - low;
        if leaf.is_covered([best.t, 0.0], periods, limit) {
            return limit;
        }
        let simple = leaf.is_simple(point, limit);
        for &s in starts(simple) {
            let found = curve::descend(|t| on.curve(edge, t), point, low + s * width, leaf.bounds[0], size);
            if found.distance < best.distance * CLOSER {
                best = curve::descend(|t| on.curve(edge, t), point, found.t, range, size);
            }
        }
        best.distance
    });
    best.distance.is_finite().then_some(best)
}

/// The closest point on the face's edges, as a point of its surface, if it is closer than `limit`. Those with a closed form are asked first,
/// then the one whose box is the nearest: that rules most others out.
pub fn on_edges(on: &mut OcctEvaluator, face: u32, point: Vec3, limit: f64) -> Option<OnSurface> {
    let model = on.model;
    let mut best: Option<(u32, OnCurve)> = None;
    let mut ask = |on: &mut OcctEvaluator, edge: u32| {
        let limit = best.map_or(limit, |(_, best)| best.distance);
        if let Some(found) = on_edge_within(on, edge, point, None, limit) {
            best = Some((edge, found));
        }
    };
    let edges = &model.topology.faces[face as usize].edges;
    let has_form =
        |edge: u32| model.topology.edges[edge as usize].degenerate || model.curves[edge as usize].form.has_foot();
    let mut nearest = (f64::INFINITY, None);
    for &edge in edges {
        if has_form(edge) {
            ask(on, edge);
        } else {
            let least = edge_tree(on, edge).least_distance(point);
            if least < nearest.0 {
                nearest = (least, Some(edge));
            }
        }
    }
    if let Some(first) = nearest.1 {
        ask(on, first);
        edges.iter().filter(|&&edge| edge != first && !has_form(edge)).for_each(|&edge| ask(on, edge));
    }
    let (edge, found) = best?;
    let uv = on.edge_on_face(edge, found.t, face)?;
    Some(at(on, face, uv, point))
}
