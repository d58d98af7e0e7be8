//! The triangles of all faces as one surface, and where they are to be finer: at edges that are met too often, and where they cross.
use super::plane::NONE;
use super::points::{Place, Points};
use super::proximity;
use super::{Asked, Face, GoOn, MANY, Options, Surface, WISHES, Wish};
use crate::geometry::{Evaluate, Geometry, OcctEvaluator, OcctModel, Side};
use crate::mesh::adjacency::sorted2;
use crate::mesh::box_tree::{Bounds, BoxTree};
use crate::mesh::triangle_pair::meeting;
use crate::mesh::vector::{Vec3, add, area2, distance, dot, lerp, norm, scale, sub};
use crate::tasks::Team;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Height over length below which a triangle is flat.
const FLAT: f64 = 1e-10;

/// The solids behind and before the normal Su × Sv of each face.
fn solids_beside(model: &OcctModel) -> Vec<[Option<u32>; 2]> {
    let topology = model.topology();
    let mut sides = vec![[None; 2]; topology.faces.len()];
    for solid in 0..topology.solids {
        for (face, side) in model.solid_sides(solid) {
            let Some(of) = sides.get_mut(face as usize) else { continue };
            match side {
                Side::Behind => of[0] = of[0].or(Some(solid)),
                Side::Before => of[1] = of[1].or(Some(solid)),
                Side::Both => *of = [Some(solid); 2],
            }
        }
    }
    sides
}

/// Joins the faces along their edges, and turns their triangles out of the solids.
pub fn assemble(model: &OcctModel, points: &Points, faces: &[Face]) -> Surface {
    let topology = model.topology();
    let mut surface = Surface {
        points: points.at.clone(),
        places: points.places.clone(),
        sides: solids_beside(model),
        chains: points.chains().to_vec(),
        ..Surface::default()
    };
    for (index, face) in faces.iter().enumerate() {
        let number = index as u32;
        let Some(patch) = &face.patch else {
            surface.missing.push(number);
            continue;
        };
        if face.is_rough {
            surface.rough.push(number);
        }
        surface.turned += patch.turned_away().len();
        let mut ids = patch.points.clone();
        for (corner, id) in ids.iter_mut().enumerate().filter(|(_, id)| **id == NONE) {
            *id = surface.points.len() as u32;
            surface.points.push(patch.at[corner]);
            surface.places.push(Place::Face(number, patch.uv(corner as u32)));
        }
        let sides = &mut surface.sides[index];
        let is_turned = match sides {
            [None, Some(_)] => true,
            [None, None] => topology.faces[index].reversed,
            _ => false,
        };
        if is_turned {
            sides.swap(0, 1);
        }
        let before = surface.triangles.len();
        for corners in &patch.triangles {
            let [a, b, c] = corners.map(|c| ids[c as usize]);
            if a != b && b != c && c != a {
                surface.triangles.push(if is_turned { [a, c, b] } else { [a, b, c] });
                surface.faces.push(number);
                surface.off.push(patch.off(*corners));
            }
        }
        if surface.triangles.len() == before {
            surface.missing.push(number);
        }
    }
    surface
}

/// Each edge of the triangles (lower point first) with a triangle, sorted.
pub fn edges_of(surface: &Surface) -> Vec<([u32; 2], u32)> {
    let mut all = Vec::with_capacity(3 * surface.triangles.len());
    for (t, corners) in surface.triangles.iter().enumerate() {
        for i in 0..3 {
            all.push((sorted2([corners[i], corners[(i + 1) % 3]]), t as u32));
        }
    }
    all.sort_unstable();
    all
}

/// The pieces of the model's edges, sorted, with edge and piece.
pub fn pieces_of(surface: &Surface) -> Vec<([u32; 2], u32, u32)> {
    let mut all = Vec::new();
    for (edge, chain) in surface.chains.iter().enumerate() {
        for (piece, ends) in chain.windows(2).enumerate() {
            all.push((sorted2([ends[0], ends[1]]), edge as u32, piece as u32));
        }
    }
    all.sort_unstable();
    all
}

/// Looks for edges that are met too often and for triangles that cross, and asks for finer ones there. How many there are, and how many
/// triangles are too near to others. Where more than [`MANY`] pairs cross nothing else is looked for.
/// Both are not complete where `go_on` said no.
pub fn find_faults(
    (team, model, options, go_on): (Team<'_>, &OcctModel, &Options, GoOn<'_>),
    surface: &mut Surface,
    faces: &mut [Face],
    asked: &mut Asked,
) -> (usize, usize) {
    find_crossings(surface, go_on);
    if surface.crossings.len() > MANY || !go_on() {
        return (surface.crossings.len(), 0);
    }
    let pieces = pieces_of(surface);
    let piece_at = |ends: [u32; 2]| pieces.binary_search_by_key(&ends, |&(ends, _, _)| ends).ok().map(|i| &pieces[i]);
    let mut barred = Vec::new();
    for group in edges_of(surface).chunk_by(|a, b| a.0 == b.0) {
        let ends = group[0].0;
        let piece = piece_at(ends);
        // In the inside of a face an edge has two triangles; on an edge of the model one for each use.
        let own = |face: u32| group.iter().filter(|g| surface.faces[g.1 as usize] == face).count();
        let is_inner = |face: u32| !faces[face as usize].segments.iter().any(|s| piece.is_some_and(|p| s.edge == p.1));
        let mut strange: Vec<u32> = group.iter().map(|g| surface.faces[g.1 as usize]).collect();
        strange.dedup();
        if piece.is_none() && group.len() == 2 && strange.len() == 1 {
            continue;
        }
        for face in strange {
            let uses = |p: &&([u32; 2], u32, u32)| {
                faces[face as usize]
                    .segments
                    .iter()
                    .filter(|s| s.edge == p.1 && s.piece == p.2)
                    .map(|s| if s.counts { 1 } else { 2 })
                    .sum()
            };
            let expected: usize = piece.as_ref().map_or(0, uses);
            if is_inner(face) || own(face) != expected {
                barred.push((face, ends));
            }
        }
        if let Some(&(_, edge, piece)) = piece
            && pieces.iter().filter(|p| p.0 == ends).count() > 1
        {
            asked.pieces.push((edge, piece));
        }
    }
    let faults = surface.crossings.len() + surface.flat + barred.len();
    for (face, ends) in barred {
        if faces[face as usize].barred.insert(ends) {
            asked.faces.insert(face);
        }
    }
    let near = proximity::too_near(team, surface, &surface.off, go_on);
    for &t in &near {
        ask_finer(surface, faces, options, &piece_at, t, asked);
    }
    let mut on = model.evaluator();
    for pair in surface.crossings.clone() {
        let mut is_any = false;
        let feet = pair.map(|t| foot(surface, &mut on, t));
        for k in 0..2 {
            let [at, foot] = feet[k];
            // Off its surface to the side where the other is: only then does it help that it is finer. So a ball that touches its seat stays
            // within itself as it is, and the seat gets finer.
            if dot(sub(at, foot), sub(feet[1 - k][1], foot)) > 0.0 {
                is_any = true;
                ask_finer(surface, faces, options, &piece_at, pair[k], asked);
            }
        }
        for &t in pair.iter().filter(|_| !is_any) {
            ask_finer(surface, faces, options, &piece_at, t, asked);
        }
    }
    (faults, near.len())
}

/// The middle of a triangle, and the closest point of its face.
fn foot(surface: &Surface, on: &mut OcctEvaluator, t: u32) -> [Vec3; 2] {
    let [p, q, r] = surface.triangles[t as usize].map(|v| surface.points[v as usize]);
    let at = scale(add(add(p, q), r), 1.0 / 3.0);
    let face = surface.faces[t as usize];
    let inner = surface.triangles[t as usize].iter().find_map(|&v| match surface.places[v as usize] {
        Place::Face(_, uv) => Some(uv),
        _ => None,
    });
    let foot = match inner {
        Some(uv) => on.closest_on_surface(face, at, uv),
        None => on.closest_on_face(face, at, None),
    };
    [at, foot.point]
}

/// Asks for the longest edge of a triangle in halves.
fn ask_finer<'p>(
    surface: &Surface,
    faces: &mut [Face],
    options: &Options,
    piece_at: &impl Fn([u32; 2]) -> Option<&'p ([u32; 2], u32, u32)>,
    t: u32,
    asked: &mut Asked,
) {
    let nodes = surface.triangles[t as usize];
    let corners = nodes.map(|v| surface.points[v as usize]);
    let (at, length, _) = longest(&corners);
    if length <= options.least {
        return;
    }
    for k in 0..3 {
        if distance(corners[k], corners[(k + 1) % 3]) > 0.6 * length
            && let Some(&(_, edge, piece)) = piece_at(sorted2([nodes[k], nodes[(k + 1) % 3]]))
        {
            asked.pieces.push((edge, piece));
        }
    }
    let face = surface.faces[t as usize];
    let wishes = &mut faces[face as usize].wishes;
    // What an earlier wish covers is not wished for again.
    let is_new = |w: &Wish| w.size > 0.5 * length || distance(w.at, at) > 0.5 * w.radius;
    if wishes.len() < WISHES && wishes.iter().all(is_new) {
        wishes.push(Wish { at, size: 0.45 * length, radius: length });
        asked.faces.insert(face);
        // The border there too: its chords must be as short as those inside.
        for segment in faces[face as usize].segments.iter().filter(|s| s.piece != NONE) {
            let chain = &surface.chains[segment.edge as usize];
            let [p, q] = [0, 1].map(|k| surface.points[chain[segment.piece as usize + k] as usize]);
            let own = distance(p, q);
            if own > 0.6 * length && distance(lerp(p, q, 0.5), at) < 1.5 * length + 0.5 * own {
                asked.pieces.push((segment.edge, segment.piece));
            }
        }
    }
}

/// The middle of the longest edge, its length, and its first corner.
pub fn longest(corners: &[Vec3; 3]) -> (Vec3, f64, usize) {
    let length = |i: usize| distance(corners[i], corners[(i + 1) % 3]);
    let i = (0..3).max_by(|&i, &j| length(i).total_cmp(&length(j))).unwrap_or(0);
    (lerp(corners[i], corners[(i + 1) % 3], 0.5), length(i), i)
}

/// Most pairs that cross that are looked for: with so many the surface is beyond repair.
pub const ENOUGH: usize = 20_000;

/// Finds the pairs of triangles that cross or touch beside what they share, at most [`ENOUGH`]: exact. Ends early where `go_on`
/// says no.
pub fn find_crossings(surface: &mut Surface, go_on: GoOn<'_>) {
    let corners = |t: u32| surface.triangles[t as usize].map(|v| surface.points[v as usize]);
    let bounds = |t: u32| -> Bounds {
        let [p, q, r] = corners(t);
        [[0, 1, 2].map(|k| p[k].min(q[k]).min(r[k])), [0, 1, 2].map(|k| p[k].max(q[k]).max(r[k]))]
    };
    let tree = BoxTree::new(surface.triangles.len(), bounds);
    // One thread counts: which pairs are found is the same each time.
    let count = AtomicUsize::new(0);
    let parts = tree.overlapping_pairs(
        Team::alone(),
        bounds,
        |_, node| count.load(Relaxed) < ENOUGH && (node > 0 || go_on()),
        |found: &mut Vec<[u32; 2]>, i, j| {
            if count.load(Relaxed) < ENOUGH && meeting(&corners(i), &corners(j)).is_some() {
                count.fetch_add(1, Relaxed);
                found.push(sorted2([i, j]));
            }
        },
    );
    let is_flat = |t: &u32| {
        let all = corners(*t);
        norm(area2(all[0], all[1], all[2])) <= FLAT * longest(&all).1.powi(2)
    };
    surface.flat = (0..surface.triangles.len() as u32).filter(is_flat).count();
    let mut all = parts.concat();
    all.sort_unstable();
    surface.crossings = all;
}
