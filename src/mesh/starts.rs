//! A grid with a tetrahedron in each cell, where searches from far away begin.
use super::adjacency::NONE;
use super::vector::Vec3;

/// About so many tetrahedra a cell.
const SHARE: usize = 8;

/// Most cells along an axis.
const MOST: f64 = 1024.0;

/// For each cell of a grid over the mesh a tetrahedron with a corner there.
pub struct Starts {
    low: Vec3,
    /// Cells a unit of length.
    per_unit: Vec3,
    counts: [usize; 3],
    tets: Vec<u32>,
}

impl Starts {
    /// Of a mesh.
    pub fn of(vertices: &[Vec3], tets: &[[u32; 4]]) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for p in vertices {
            low = std::array::from_fn(|i| low[i].min(p[i]));
            high = std::array::from_fn(|i| high[i].max(p[i]));
        }
        // A flat box is given some thickness, so that its cells are no finer than the mesh.
        let greatest = (0..3).map(|i| high[i] - low[i]).fold(f64::MIN_POSITIVE, f64::max);
        let extent: Vec3 = std::array::from_fn(|i| (high[i] - low[i]).max(1e-3 * greatest));
        let relative = extent.map(|x| x / greatest);
        let size = greatest * (relative.iter().product::<f64>() / (tets.len() / SHARE + 1) as f64).cbrt();
        let counts = extent.map(|x| (x / size).ceil().clamp(1.0, MOST) as usize);
        let per_unit = std::array::from_fn(|i| counts[i] as f64 / extent[i]);
        let mut starts = Self { low, per_unit, counts, tets: vec![NONE; counts.iter().product()] };
        for (nodes, t) in tets.iter().zip(0..) {
            let cell = starts.cell(vertices[nodes[0] as usize]);
            starts.tets[cell] = t;
        }
        starts
    }

    /// The cell of a point, or the one nearest to it.
    fn cell(&self, p: Vec3) -> usize {
        // NaN and numbers below 0 become 0.
        let [i, j, k] = [0, 1, 2].map(|i| (((p[i] - self.low[i]) * self.per_unit[i]) as usize).min(self.counts[i] - 1));
        (i * self.counts[1] + j) * self.counts[2] + k
    }

    /// A tetrahedron near p, if its cell knows one.
    pub fn near(&self, p: Vec3) -> Option<u32> {
        let tet = self.tets[self.cell(p)];
        (tet != NONE).then_some(tet)
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples::cube;
    use super::*;
    use crate::mesh::vector::distance;

    #[test]
    fn what_it_knows_is_near() {
        let mesh = cube(10);
        let starts = Starts::of(&mesh.vertices, &mesh.tets.nodes);
        let corner = |tet: u32| mesh.vertices[mesh.tets.nodes[tet as usize][0] as usize];
        for p in [[0.31, 0.52, 0.77], [0.05, 0.95, 0.5], [0.55; 3]] {
            let found = starts.near(p).expect("every cell has a corner");
            assert!(distance(corner(found), p) < 0.3);
        }
        // Points outside, and none at all, have the cell that is nearest, or any.
        assert!(distance(corner(starts.near([7.0, -3.0, 0.5]).expect("as above")), [1.0, 0.0, 0.5]) < 0.3);
        starts.near([f64::NAN; 3]);
    }

    #[test]
    fn a_flat_mesh_is_no_trouble() {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(Starts::of(&square, &[[0, 1, 2, 3]]).near([0.0; 3]), Some(0));
    }
}
