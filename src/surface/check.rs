//! What a surface is worth: whether it is closed, how far its areas and volumes are from those of the model.
use super::Surface;
use super::whole::{edges_of, pieces_of};
use crate::geometry::{Geometry, OcctModel, Use};
use crate::mesh::adjacency::sorted2;
use crate::mesh::vector::{Vec3, area2, norm, volume6};
use std::collections::BTreeMap;

/// What was found.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Edges that have other triangles than the model wants.
    pub bad_edges: usize,
    /// Directed edges of solids that nothing goes back along.
    pub open_edges: usize,
    /// Edges of the model that no triangle has.
    pub lost_pieces: usize,
    /// Faces whose area is off by more than three tenths, with the ratio.
    pub areas: Vec<(u32, f64)>,
    /// Triangles without area.
    pub flat: usize,
    /// Volume and the model's own, of each solid.
    pub volumes: Vec<[f64; 2]>,
    /// Sine of the smallest angle.
    pub least_sine: f64,
}

/// Compares a surface with its model.
pub fn report(model: &OcctModel, surface: &Surface) -> Report {
    let mut found = Report { least_sine: 1.0, ..Report::default() };
    let topology = model.topology();
    let corners = |t: usize| surface.triangles[t].map(|v| surface.points[v as usize]);
    let mut areas = vec![0.0; topology.faces.len()];
    for t in 0..surface.triangles.len() {
        let [p, q, r] = corners(t);
        let area = 0.5 * norm(area2(p, q, r));
        areas[surface.faces[t] as usize] += area;
        found.flat += usize::from(area == 0.0);
        let longest = super::whole::longest(&[p, q, r]).1;
        found.least_sine = found.least_sine.min(2.0 * area / (longest * longest));
    }
    for (face, area) in areas.iter().enumerate() {
        if let Some(exact) = model.face_area(face as u32) {
            let ratio = area / exact.abs();
            if !(ratio > 0.7 && ratio < 1.3) {
                found.areas.push((face as u32, ratio));
            }
        }
    }
    count_edges(model, surface, &mut found);
    for solid in 0..topology.solids {
        let mut directed: BTreeMap<[u32; 2], i64> = BTreeMap::new();
        let mut volume = 0.0;
        for (t, corners) in surface.triangles.iter().enumerate() {
            for (side, sign) in surface.sides[surface.faces[t] as usize].iter().zip([1, -1]) {
                if *side == Some(solid) {
                    for i in 0..3 {
                        let ends = [corners[i], corners[(i + 1) % 3]];
                        *directed.entry(sorted2(ends)).or_default() += if ends[0] < ends[1] { sign } else { -sign };
                    }
                    let from = topology.bounds[0];
                    let [p, q, r]: [Vec3; 3] = corners.map(|v| surface.points[v as usize]);
                    volume += sign as f64 * volume6(from, p, q, r) / 6.0;
                }
            }
        }
        found.open_edges += directed.values().filter(|&&sum| sum != 0).count();
        found.volumes.push([volume, model.solid_volume(solid).unwrap_or(f64::NAN)]);
    }
    found
}

/// Compares the triangles at each edge with the uses of the model's edges.
fn count_edges(model: &OcctModel, surface: &Surface, found: &mut Report) {
    let topology = model.topology();
    let mut uses = vec![0; topology.edges.len()];
    for face in 0..topology.faces.len() as u32 {
        for of in model.edge_uses(face) {
            uses[of.edge as usize] += match of.way {
                Use::Forward | Use::Reversed => 1,
                Use::Internal => 2,
                Use::External => 0,
            };
        }
    }
    let pieces = pieces_of(surface);
    let mut met = vec![false; pieces.len()];
    for group in edges_of(surface).chunk_by(|a, b| a.0 == b.0) {
        let on = pieces.binary_search_by_key(&group[0].0, |p| p.0);
        let expected = on.map_or(2, |i| {
            let all = || (0..pieces.len()).skip(i.saturating_sub(4)).take(9).filter(|&k| pieces[k].0 == group[0].0);
            all().for_each(|k| met[k] = true);
            all().map(|k| uses[pieces[k].1 as usize]).sum()
        });
        found.bad_edges += usize::from(group.len() != expected);
    }
    found.lost_pieces = pieces.iter().zip(&met).filter(|(p, met)| !**met && uses[p.1 as usize] > 0).count();
}
