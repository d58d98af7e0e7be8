//! Space in cells, by planes, such that each has few points of both meshes.
use super::stored::{bounds_of, touch};
use crate::mesh::vector::Vec3;

/// A plane or a cell.
#[derive(Clone, Copy, Debug)]
enum Node {
    /// What is below the plane is in the first one.
    Plane {
        axis: u8,
        at: f64,
        below: u32,
        above: u32,
    },
    Cell(u32),
}

/// Cells of space. Which they are matters to the time that is taken, not to results.
#[derive(Debug)]
pub(super) struct Cells {
    nodes: Vec<Node>,
    count: usize,
}

/// The share of its extent by which the box of a part is larger on each side than that of the points in it, and the share of its diagonal.
const MARGIN: [f64; 2] = [1.0 / 32.0, 1.0 / 256.0];

impl Cells {
    /// By points of the new and the old mesh. Cells are halved at the median of the new points until `fits` is told numbers of new points, and of
    /// old ones about these, that it likes.
    pub fn of(new: &[Vec3], old: &[Vec3], fits: impl Fn(usize, usize) -> bool) -> Self {
        let mut cells = Self { nodes: vec![Node::Cell(0)], count: 0 };
        let mut open = vec![(0usize, new.to_vec(), old.to_vec())];
        while let Some((node, mut new, mut old)) = open.pop() {
            let around = grown(bounds_of(new.iter().copied()), 0.0);
            old.retain(|&p| touch(&[p; 2], &around));
            let (low, axis) = longest(&around);
            if fits(new.len(), old.len()) || new.len() < 2 || around[1][axis] <= low {
                cells.nodes[node] = Node::Cell(cells.count as u32);
                cells.count += 1;
                continue;
            }
            let above = split(&mut new, axis, |p| *p);
            let at = above[0][axis];
            let children = cells.nodes.len();
            cells.nodes.extend([Node::Cell(0); 2]);
            let [below, beyond] = [children as u32, children as u32 + 1];
            cells.nodes[node] = Node::Plane { axis: axis as u8, at, below, above: beyond };
            open.push((children + 1, above, old.clone()));
            open.push((children, new, old));
        }
        cells
    }

    /// Number of cells.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The cell of a point.
    pub fn cell(&self, p: Vec3) -> usize {
        let mut node = 0;
        loop {
            match self.nodes[node] {
                Node::Plane { axis, at, below, above } => {
                    node = if p[axis as usize] < at { below } else { above } as usize;
                }
                Node::Cell(cell) => return cell as usize,
            }
        }
    }
}

/// The axis along which a box is longest, and the least coordinate there.
pub(super) fn longest(bounds: &[Vec3; 2]) -> (f64, usize) {
    let extent = |k: usize| bounds[1][k] - bounds[0][k];
    let axis = (1..3).fold(0, |axis, k| if extent(k) > extent(axis) { k } else { axis });
    (bounds[0][axis], axis)
}

/// Takes the upper half of some items, along an axis, away.
pub(super) fn split<T>(items: &mut Vec<T>, axis: usize, at: impl Fn(&T) -> Vec3) -> Vec<T> {
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| at(a)[axis].total_cmp(&at(b)[axis]));
    items.split_off(middle)
}

/// The box of the tetrahedra that points in a box may want: by a margin larger, and by `least` at the least.
pub(super) fn grown([low, high]: [Vec3; 2], least: f64) -> [Vec3; 2] {
    let extent: Vec3 = std::array::from_fn(|k| high[k] - low[k]);
    let diagonal = extent.iter().map(|x| x * x).sum::<f64>().sqrt();
    let margin = extent.map(|x| least + (MARGIN[0] * x).max(MARGIN[1] * diagonal));
    [std::array::from_fn(|k| low[k] - margin[k]), std::array::from_fn(|k| high[k] + margin[k])]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_small_where_points_are_many() {
        let point = |i: u32| [0, 1, 2].map(|k| f64::from(i.wrapping_mul([7919, 104_729, 1_299_709][k]) % 1000) / 1e3);
        let new: Vec<Vec3> =
            (0..4000).map(|i| if i % 2 == 0 { point(i) } else { point(i).map(|x| 1e-3 * x) }).collect();
        let old: Vec<Vec3> = (0..3000).map(point).collect();
        let cells = Cells::of(&new, &old, |new, old| new <= 100 && old <= 300);
        assert!((40..300).contains(&cells.count()), "{}", cells.count());
        let mut points = vec![Vec::new(); cells.count()];
        new.iter().for_each(|&p| points[cells.cell(p)].push(p));
        for points in points {
            let around = grown(bounds_of(points.iter().copied()), 0.0);
            assert!((1..=150).contains(&points.len()));
            assert!(old.iter().filter(|&&p| touch(&[p; 2], &around)).count() <= 450);
        }
    }

    #[test]
    fn equal_points_are_one_cell() {
        let cells = Cells::of(&[[0.25; 3]; 50], &[[0.5; 3]; 50], |_, _| false);
        assert_eq!(cells.count(), 1);
        assert_eq!([cells.cell([0.0; 3]), cells.cell([1.0; 3])], [0, 0]);
        assert_eq!(Cells::of(&[], &[], |_, _| false).count(), 1);
    }
}
