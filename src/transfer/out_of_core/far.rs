//! Points whose nearest tetrahedra are farther than the part of the old mesh that was about them: all tetrahedra go past them.
use super::stored::{Stored, bounds_of, touch};
use super::{Error, Field, Found, Sizes};
use crate::mesh::box_tree::BoxTree;
use crate::mesh::locate::{Location, nearest_in, take_nearer};
use crate::mesh::ranges::{Bins, Numbering, Table};
use crate::mesh::vector::Vec3;
use crate::tasks::{GRAIN, Team};
use crate::transfer::Places;

/// A point, and the tetrahedron that is the nearest so far.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct Far {
    pub x: Vec3,
    /// Of the vertex.
    pub number: u32,
    tet: u32,
    distance: f64,
    weights: [f64; 4],
    nodes: [u32; 4],
}

impl Far {
    /// With the nearest tetrahedron of a part, by its number and nodes in the mesh, or with none.
    pub fn new(x: Vec3, number: u32, nearest: Option<(Location, [u32; 4])>) -> Self {
        let none = (Location { tet: u32::MAX, weights: [0.25; 4], distance: f64::INFINITY }, [0; 4]);
        let (Location { tet, weights, distance }, nodes) = nearest.unwrap_or(none);
        Self { x, number, tet, distance, weights, nodes }
    }

    fn location(&self) -> Location {
        Location { tet: self.tet, weights: self.weights, distance: self.distance }
    }

    /// What is no farther than the nearest so far touches this box.
    fn bounds(&self) -> [Vec3; 2] {
        let away = self.distance + 1e-9 * self.distance;
        [self.x.map(|x| x - away), self.x.map(|x| x + away)]
    }
}

/// Finds the nearest tetrahedra, and gives the vertices their values.
pub(super) fn settle<F: Field>(
    team: Team<'_>,
    old: &Stored<'_>,
    far: &Bins<Far>,
    (field, rows, to): (&F, &Table, &Table),
    (sizes, tolerance): (&Sizes, f64),
) -> Result<Found, Error> {
    let (mut found, most) = (Found::default(), sizes.far(rows.width()));
    let mut group: Vec<Far> = Vec::new();
    far.each_chunk(0, |more| -> Result<bool, Error> {
        group.extend_from_slice(more);
        if group.len() >= most {
            found = found.and(settle_group(team, old, &mut group, (field, rows, to), (sizes, tolerance))?);
            group.clear();
        }
        Ok(true)
    })?;
    if group.is_empty() {
        Ok(found)
    } else {
        Ok(found.and(settle_group(team, old, &mut group, (field, rows, to), (sizes, tolerance))?))
    }
}

fn settle_group<F: Field>(
    team: Team<'_>,
    old: &Stored<'_>,
    group: &mut [Far],
    (field, rows, to): (&F, &Table, &Table),
    (sizes, tolerance): (&Sizes, f64),
) -> Result<Found, Error> {
    let tets = old.counts().tets;
    for start in (0..tets).step_by(sizes.slice) {
        let nodes = old.tets(start..tets.min(start + sizes.slice))?;
        let slice = old.slice(nodes)?;
        let around = bounds_of(slice.points.iter().copied());
        if !group.iter().any(|far| touch(&far.bounds(), &around)) {
            continue;
        }
        let tree = BoxTree::on(team, slice.nodes.len(), |tet| bounds_of(slice.corners(tet as usize)));
        team.fill(GRAIN / 16, group, |_, group| {
            for far in group {
                let (x, mut best) = (far.x, far.location());
                take_nearer(&mut best, &tree, x, |tet| nearest_in(start as u32 + tet, &slice.corners(tet as usize), x));
                if best.tet != far.tet {
                    let nodes = slice.nodes[best.tet as usize - start].map(|v| slice.numbers[v as usize]);
                    *far = Far::new(x, far.number, Some((best, nodes)));
                }
            }
        });
    }
    group.sort_unstable_by_key(|far| far.number);
    let numbering = Numbering::of(group.iter().flat_map(|far| far.nodes));
    let nodes: Vec<[u32; 4]> = group.iter().map(|far| far.nodes.map(|v| numbering.place(v))).collect();
    let values = rows.at(&numbering.into_numbers())?;
    let found = Found::of(group.iter().map(|far| far.distance), tolerance);
    let places = Places {
        tets: (0..group.len() as u32).collect(),
        weights: group.iter().map(|far| far.weights).collect(),
        outside: found.outside,
        farthest: found.farthest,
    };
    let values = field.interpolate(&nodes, &places, &values);
    to.put(&group.iter().map(|far| far.number).collect::<Vec<u32>>(), &values)?;
    Ok(found)
}
