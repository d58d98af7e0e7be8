//! Closest points of faces: by closed forms where there are any, else by a descent from the guess, with a tree of pieces to rule out the
//! rest.
use super::chord::Curves;
use super::evaluator::OcctEvaluator;
use super::hull;
use super::newton::{self, SurfacePoint};
use super::pieces::{Jets, Source, cuts};
use super::project_edges::on_edges;
use super::range::{is_whole, longest};
use super::tree::{Node, Tree};
use super::trim::{self, Trim};
use crate::geometry::OnSurface;
use crate::mesh::vector::{Vec3, distance};

/// A point is closer when its distance is less by this share. Less is rounding.
pub const CLOSER: f64 = 1.0 - 1e-12;
/// What counts as the same parameters, as a share of the longest step.
const SAME: f64 = 1e-9;

/// Where descents in a piece start, as shares of its sides: from its middle, and where the distance may have several
/// minima from its quarters too.
pub fn starts(simple: bool) -> &'static [f64] {
    if simple { &[0.5] } else { &[0.5, 0.2, 0.8] }
}

/// Closest point of a face near the guess. Chords of its edges may leave the face, where its edges do not follow the parameters: there
/// the trimming counts.
pub fn on_surface(on: &mut OcctEvaluator, face: u32, point: Vec3, guess: [f64; 2]) -> OnSurface {
    near(on, face, point, guess, is_within)
}

/// The same, beyond the face's edges too.
pub fn foot(on: &mut OcctEvaluator, face: u32, point: Vec3, guess: [f64; 2]) -> OnSurface {
    near(on, face, point, guess, |_, _, _| true)
}

fn near(
    on: &mut OcctEvaluator,
    face: u32,
    point: Vec3,
    guess: [f64; 2],
    is_within: impl Fn(&mut OcctEvaluator, u32, [f64; 2]) -> bool,
) -> OnSurface {
    let model = on.model;
    if let Some(foot) = model.surfaces[face as usize].form.foot(point, guess) {
        let (uv, in_range) = on.placed(face, foot);
        if in_range && is_within(on, face, uv) {
            return at(on, face, uv, point);
        }
    } else if guess[0].is_finite() && guess[1].is_finite() {
        let (start, _) = on.placed(face, guess);
        let bounds = open_bounds(on, face);
        let longest = longest(model.topology.faces[face as usize].range);
        let found = newton::descend(|uv| on.jet(face, uv), point, start, bounds, longest, model.size);
        if found.foot && is_within(on, face, found.uv) {
            return finish(on, face, &found, point);
        }
    }
    on_face(on, face, point, Some(guess))
}

/// Closest point of the trimmed face.
pub fn on_face(on: &mut OcctEvaluator, face: u32, point: Vec3, guess: Option<[f64; 2]>) -> OnSurface {
    let guess = guess.filter(|uv| uv[0].is_finite() && uv[1].is_finite());
    let middle = middle(on, face);
    if !point.iter().all(|x| x.is_finite()) {
        let (uv, _) = on.placed(face, guess.unwrap_or(middle));
        return OnSurface { distance: f64::NAN, ..at(on, face, uv, point) };
    }
    on_face_within(on, face, point, guess, f64::INFINITY).unwrap_or_else(|| {
        let (uv, _) = on.placed(face, guess.unwrap_or(middle));
        at(on, face, uv, point)
    })
}

/// The same, if it is closer than `limit`. In most cases the untrimmed surface shows already that nothing is.
pub fn on_face_within(
    on: &mut OcctEvaluator,
    face: u32,
    point: Vec3,
    guess: Option<[f64; 2]>,
    limit: f64,
) -> Option<OnSurface> {
    let found = match on.model.surfaces[face as usize].form.feet(point, guess.unwrap_or_else(|| middle(on, face))) {
        Some(feet) => analytic_face(on, face, point, feet.as_slice(), limit),
        None => search_surface(on, face, point, guess, limit),
    };
    found.filter(|found| found.distance < limit)
}

/// The middle of a face's parameters.
fn middle(on: &OcctEvaluator, face: u32) -> [f64; 2] {
    on.model.topology.faces[face as usize].range.map(|[low, high]| 0.5 * (low + high))
}

/// S at parameters, with its distance.
pub fn at(on: &mut OcctEvaluator, face: u32, uv: [f64; 2], point: Vec3) -> OnSurface {
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

/// Whether the parameters, which lie in the face's range, lie in the trimmed face.
fn inside(on: &mut OcctEvaluator, face: u32, uv: [f64; 2]) -> bool {
    let trim = trim_of(on, face);
    let curves = Curves { model: on.model, face, points: &mut on.points };
    trim.known(curves, uv).unwrap_or_else(|| on.inside_by_occt(face, uv))
}

/// The trimming of a face, made when first asked for.
fn trim_of<'a>(on: &mut OcctEvaluator<'a>, face: u32) -> &'a Trim {
    let model = on.model;
    model.trims[face as usize].get_or_init(|| trim::build(on, face))
}

/// The closest point of a trimmed analytic face is one of the feet, or on its edges. When it is the surface's closest
/// point there is nothing else to ask, nor where that is beyond the limit.
fn analytic_face(on: &mut OcctEvaluator, face: u32, point: Vec3, feet: &[[f64; 2]], limit: f64) -> Option<OnSurface> {
    if limit < f64::INFINITY && distance(on.surface_point(face, feet[0]), point) >= limit {
        return None;
    }
    let mut best: Option<OnSurface> = None;
    for (i, &foot) in feet.iter().enumerate() {
        let (uv, in_range) = on.placed(face, foot);
        if !in_range || !inside(on, face, uv) {
            continue;
        }
        let found = at(on, face, uv, point);
        if i == 0 {
            return Some(found);
        }
        if best.is_none_or(|best| found.distance < best.distance) {
            best = Some(found);
        }
    }
    let within = best.map_or(limit, |best| best.distance.min(limit));
    let found = on_edges(on, face, point, within).or(best);
    if found.is_some() || limit < f64::INFINITY {
        return found;
    }
    let (uv, _) = on.placed(face, feet[0]);
    Some(at(on, face, uv, point))
}

/// The pieces of a face, made when first asked for.
fn face_tree<'a>(on: &mut OcctEvaluator<'a>, face: u32) -> &'a Tree {
    let model = on.model;
    let (shape, entity) = (&model.surfaces[face as usize], &model.topology.faces[face as usize]);
    if let Some(tree) = shape.tree.get() {
        return tree;
    }
    let trim = trim_of(on, face);
    shape.tree.get_or_init(|| {
        let cuts = [0, 1].map(|k: usize| {
            let spans = (shape.spans[k] as usize).max(2);
            cuts(entity.range[k], entity.period[k], shape.form.breaks(k), spans)
        });
        let mut jet = |uv: [f64; 2]| on.jet(face, uv);
        let hull =
            &mut |jet: &mut Jets, piece: [[f64; 2]; 2], out: &mut _| hull::of_surface(&shape.form, jet, piece, out);
        Tree::new(&mut Source { jet: &mut jet, hull }, cuts, entity.period)
            .trimmed(|bounds| trim.leaves_out(entity, bounds))
    })
}

/// The search on a surface without a closed form. A foot that the descent from the guess (or the nearest piece) reaches
/// inside the face is the answer when no other piece holds a closer point, inside or not; else the edges and those
/// pieces decide. What is found may be beyond the limit, then it is not the closest.
fn search_surface(
    on: &mut OcctEvaluator,
    face: u32,
    point: Vec3,
    guess: Option<[f64; 2]>,
    limit: f64,
) -> Option<OnSurface> {
    let tree = face_tree(on, face);
    let size = on.model.size;
    let start = guess.or_else(|| tree.nearest(point, limit).map(Node::middle))?;
    let (start, _) = on.placed(face, start);
    let first = descend_inside(on, face, point, start);
    let mut best = first;
    let mut edges_asked = first.is_none();
    if edges_asked {
        best = on_edges(on, face, point, limit);
    }
    let periods = on.model.topology.faces[face as usize].period;
    let far = |best: Option<OnSurface>| best.map_or(limit, |best| best.distance.min(limit));
    // Descents from several starts in a piece end at the same point: OCCT is asked once.
    let mut refused = [f64::NAN; 2];
    let same = longest(on.model.topology.faces[face as usize].range).map(|side| SAME * side);
    tree.visit(point, far(best), |leaf, limit| {
        if first.is_some_and(|first| leaf.is_covered(first.uv, periods, first.distance)) {
            return limit;
        }
        let simple = leaf.is_simple(point, limit);
        for &s in starts(simple) {
            for &r in starts(simple) {
                let [[u0, u1], [v0, v1]] = leaf.bounds;
                let start = [u0 + s * (u1 - u0), v0 + r * (v1 - v0)];
                let found =
                    newton::descend(|uv| on.jet(face, uv), point, start, leaf.bounds, longest(leaf.bounds), size);
                if found.distance.is_nan() || found.distance >= far(best) * CLOSER {
                    continue;
                }
                if (0..2).all(|k| (found.uv[k] - refused[k]).abs() <= same[k]) {
                    continue;
                }
                if inside(on, face, on.placed(face, found.uv).0) {
                    best = Some(polished(on, face, point, &found));
                    continue;
                }
                refused = found.uv;
                if !edges_asked {
                    edges_asked = true;
                    best = on_edges(on, face, point, far(best)).or(best);
                }
            }
        }
        far(best)
    });
    best
}

/// The foot that the descent from `start` reaches, if it lies in the face.
fn descend_inside(on: &mut OcctEvaluator, face: u32, point: Vec3, start: [f64; 2]) -> Option<OnSurface> {
    let (bounds, size) = (open_bounds(on, face), on.model.size);
    let longest = longest(on.model.topology.faces[face as usize].range);
    let found = newton::descend(|uv| on.jet(face, uv), point, start, bounds, longest, size);
    let found = found.foot.then(|| finish(on, face, &found, point))?;
    inside(on, face, found.uv).then_some(found)
}

/// What a descent within a piece has found, or the foot that it leads to.
fn polished(on: &mut OcctEvaluator, face: u32, point: Vec3, found: &SurfacePoint) -> OnSurface {
    let rough = finish(on, face, found, point);
    let foot = descend_inside(on, face, point, rough.uv);
    foot.filter(|foot| foot.distance <= rough.distance).unwrap_or(rough)
}
