//! Tetrahedra of second degree: between the chords of a coarse boundary and its model lies what belongs to the tetrahedra at the chords.
use crate::mesh::adjacency::EDGES;
use crate::mesh::vector::{Vec3, add, scale};
use crate::tasks::{GRAIN, Team};

/// An edge of the boundary, of a lesser vertex and a greater one, and how far the model is from its middle.
pub type Rise = ([u32; 2], Vec3);

/// The tetrahedra with edges that rise.
pub(super) struct Quadratic {
    /// For each tetrahedron its place in `rises`, or [`STRAIGHT`].
    places: Vec<u32>,
    /// Those of its edges, in the order of [`EDGES`].
    rises: Vec<[Vec3; 6]>,
}

/// The place of a tetrahedron none of whose edges rises.
const STRAIGHT: u32 = u32::MAX;

impl Quadratic {
    /// Of tetrahedra on so many vertices, with all edges that rise, ascending. None where none does.
    ///
    /// # Panics
    /// When a vertex is not there.
    pub fn of(team: Team<'_>, vertices: usize, tets: &[[u32; 4]], edges: &[Rise]) -> Option<Self> {
        if edges.is_empty() {
            return None;
        }
        let mut starts = vec![0u32; vertices + 1];
        edges.iter().for_each(|([first, _], _)| starts[*first as usize + 1] += 1);
        (0..vertices).for_each(|v| starts[v + 1] += starts[v]);
        let rise = |[a, b]: [u32; 2]| {
            let (first, second) = (a.min(b) as usize, a.max(b));
            let of_first = &edges[starts[first] as usize..starts[first + 1] as usize];
            of_first.iter().find(|([_, end], _)| *end == second).map(|(_, rise)| *rise)
        };
        let found = team.collect(GRAIN, tets.len(), |range, found: &mut Vec<(u32, [Vec3; 6])>| {
            for t in range {
                let of = EDGES.map(|edge| rise(edge.map(|i| tets[t][i])));
                if of.iter().any(Option::is_some) {
                    found.push((t as u32, of.map(Option::unwrap_or_default)));
                }
            }
        });
        let mut places = vec![STRAIGHT; tets.len()];
        (0..).zip(&found).for_each(|(place, &(t, _))| places[t as usize] = place);
        Some(Self { places, rises: found.into_iter().map(|(_, rises)| rises).collect() })
    }

    /// Where the point with these weights lies, beside that of the straight tetrahedron: Σ 4 a_i a_j d_ij over its edges, the shape functions of the
    /// second degree. None in a tetrahedron that is straight.
    #[inline]
    pub fn shift(&self, tet: u32, weights: [f64; 4]) -> Option<Vec3> {
        let rises = self.rises.get(self.places[tet as usize] as usize)?;
        let of = |(&[i, j], &rise): (&[usize; 2], &Vec3)| scale(rise, 4.0 * weights[i] * weights[j]);
        Some(EDGES.iter().zip(rises).map(of).fold([0.0; 3], add))
    }
}
