//! The coarse boundary does not pass through itself.
use super::level::Level;
use super::surface::Surface;
use super::vertex_map::VertexMap;
use crate::mesh::crossing::{Test, crossings_of};
use crate::mesh::triangle_pair::meeting;
use crate::tasks::{GRAIN, Team};

/// Lets vertices stay of triangles that would pass through others; whether there are such. Triangles that stay in their planes cover what
/// they covered, so they are not asked.
pub fn keep(team: Team<'_>, level: &Level, surface: &Surface, map: &VertexMap) -> bool {
    let bends = team.map(GRAIN, level.triangles.len(), |t| surface.bends(level, t as u32, map));
    if !bends.contains(&true) {
        return false;
    }
    let left = map.left(team, &level.triangles);
    let mapped: Vec<[u32; 3]> = left.iter().map(|&t| map.map(&level.triangles[t as usize])).collect();
    // It is not known which side of a triangle is outward, so none may even touch.
    let test: Test = |a, b| meeting(a.1, b.1);
    let found =
        crossings_of(team, &mapped, |v| level.points[v as usize], |i| bends[left[i] as usize], test, usize::MAX);
    let mut kept = false;
    for i in found.first.iter().flat_map(|crossing| crossing.triangles) {
        kept |= map.keep_one(&level.triangles[left[i] as usize]).is_some();
    }
    kept
}
