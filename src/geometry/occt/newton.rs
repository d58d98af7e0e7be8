//! The descent to a closest point on a surface without a closed form.
use super::curve::{CONVERGED, CONVEX, HALVINGS, ITERATIONS, NOISE};
use super::surface::Jet;
use crate::mesh::vector::{Vec3, distance, dot, sub};

/// A point reached on a surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// Parameters.
    pub uv: [f64; 2],
    /// S(u, v).
    pub point: Vec3,
    /// Distance from the point asked for.
    pub distance: f64,
    /// Whether it is the foot of a perpendicular: no bound of the parameters held it back, and the descent converged.
    pub foot: bool,
}

/// Goes down from `start` to a closest point within `bounds` (of u, of v; infinite where the surface closes on
/// itself): Newton's method on |S(u, v) − p|², with the first fundamental form in place of the Hessian where that is not
/// convex. A parameter at its bound that a step would take beyond it stays there while the other one moves.
///
/// No step is longer than `longest`: near a pole, where S_u vanishes, it would leave no digits of u.
/// `size` is the size of the model, for what counts as rounding. NaN in gives NaN out.
pub fn descend(
    mut jet: impl FnMut([f64; 2]) -> Jet,
    point: Vec3,
    start: [f64; 2],
    bounds: [[f64; 2]; 2],
    longest: [f64; 2],
    size: f64,
) -> SurfacePoint {
    let clamp = |uv: [f64; 2]| [0, 1].map(|k: usize| uv[k].clamp(bounds[k][0], bounds[k][1]));
    let mut uv = clamp(start);
    let mut here = jet(uv);
    let mut length = distance(here.point, point);
    let mut foot = false;
    for _ in 0..ITERATIONS {
        let Some((mut step, held)) = newton_step(&here, sub(here.point, point), uv, bounds) else { break };
        for k in 0..2 {
            step[k] = step[k].clamp(-longest[k], longest[k]);
        }
        let mut moved = None;
        for _ in 0..HALVINGS {
            let next = clamp([uv[0] + step[0], uv[1] + step[1]]);
            let there = jet(next);
            let new_length = distance(there.point, point);
            if new_length <= length + NOISE * size {
                moved = Some([next[0] - uv[0], next[1] - uv[1]]);
                (uv, here, length) = (next, there, new_length);
                break;
            }
            step = step.map(|x| 0.5 * x);
        }
        let Some(went) = moved else { break };
        let travel = (0..3).map(|k| (here.du[k] * went[0] + here.dv[k] * went[1]).powi(2)).sum::<f64>().sqrt();
        if travel <= CONVERGED * size {
            foot = !held;
            break;
        }
    }
    SurfacePoint { uv, point: here.point, distance: length, foot }
}

/// The next step, and whether a bound holds a parameter; none where there is no step (NaN, no derivatives).
fn newton_step(jet: &Jet, arm: Vec3, uv: [f64; 2], bounds: [[f64; 2]; 2]) -> Option<([f64; 2], bool)> {
    let slope = [dot(arm, jet.du), dot(arm, jet.dv)];
    let metric = [dot(jet.du, jet.du), dot(jet.du, jet.dv), dot(jet.dv, jet.dv)];
    let bend = [metric[0] + dot(arm, jet.duu), metric[1] + dot(arm, jet.duv), metric[2] + dot(arm, jet.dvv)];
    let held =
        [0, 1].map(|k: usize| (uv[k] <= bounds[k][0] && slope[k] > 0.0) || (uv[k] >= bounds[k][1] && slope[k] < 0.0));
    let along = |k: usize| {
        let (bend, metric) = (bend[2 * k], metric[2 * k]);
        if metric > 0.0 { -slope[k] / if bend > CONVEX * metric { bend } else { metric } } else { 0.0 }
    };
    let step = match held {
        [true, true] => [0.0, 0.0],
        [true, false] => [0.0, along(1)],
        [false, true] => [along(0), 0.0],
        [false, false] => {
            let area2 = metric[0] * metric[2] - metric[1] * metric[1];
            let det = bend[0] * bend[2] - bend[1] * bend[1];
            let convex = bend[0] > CONVEX * metric[0] && det > CONVEX * CONVEX * area2;
            let form = if convex { bend } else { metric };
            let det = if convex { det } else { area2 };
            // At a pole one of the directions has no length: move along the other.
            if det > 1e-24 * metric[0].max(metric[2]).powi(2) {
                [(form[1] * slope[1] - form[2] * slope[0]) / det, (form[1] * slope[0] - form[0] * slope[1]) / det]
            } else {
                [along(0), along(1)]
            }
        }
    };
    step.iter().all(|x| x.is_finite()).then_some((step, held[0] || held[1]))
}
