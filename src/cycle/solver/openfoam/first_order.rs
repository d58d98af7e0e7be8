//! Cells in which a flow blew up: they and those around them are solved to first order, which keeps pressures positive.
//!
//! The order is lowered where a step has failed, and nowhere else, as in the MOOD method (Clain, Diot and Loubere, Journal of Computational
//! Physics 230, 2011): at a sharp edge that a flow goes around it has next to no pressure, and a limiter's slopes can overshoot.
use super::cells::Cells;
use super::dictionaries::central::{AT_FACES, factor};
use crate::formats::foam;
use std::path::Path;

/// A cell has failed where the pressure has fallen to less than this share of that at the beginning of the block,
const OF_PRESSURE: f64 = 0.5;

/// or the temperature to less than this one.
const OF_TEMPERATURE: f64 = 0.7;

/// The cells of a mesh that are solved to first order.
pub struct FirstOrderCells {
    marked: Vec<bool>,
    /// How many are marked.
    pub count: usize,
}

impl FirstOrderCells {
    /// None on so many cells.
    pub fn none(cells: usize) -> Self {
        Self { marked: vec![false; cells], count: 0 }
    }

    /// Marks the cells that have failed since (pressure, temperature) were as `before`, and those that have a vertex in common with one; how many
    /// failed ones had no mark.
    pub fn add(&mut self, cells: &Cells, before: [&[f64]; 2], after: [&[f64]; 2]) -> usize {
        let fell = |which: usize, cell: usize, share: f64| after[which][cell] < share * before[which][cell];
        let failed: Vec<bool> = (0..cells.count())
            .map(|cell| !self.marked[cell] && (fell(0, cell, OF_PRESSURE) || fell(1, cell, OF_TEMPERATURE)))
            .collect();
        let mut touched = vec![false; cells.mesh.vertices.len()];
        let tets = || cells.mesh.tets.nodes.iter().zip(&cells.of).map(|(nodes, &cell)| (nodes, cell as usize));
        let of_failed = tets().filter(|(_, cell)| failed[*cell]);
        of_failed.for_each(|(nodes, _)| nodes.iter().for_each(|&v| touched[v as usize] = true));
        for (nodes, cell) in tets() {
            self.marked[cell] |= nodes.iter().any(|&v| touched[v as usize]);
        }
        self.count = self.marked.iter().filter(|&&marked| marked).count();
        failed.iter().filter(|&&failed| failed).count()
    }

    /// Writes the blending factors to a time folder: 0 at the faces of marked cells, 1 at the others. `symmetry`: the patches of that type.
    pub fn write(&self, case: &Path, time: &Path, symmetry: &[String]) -> Result<(), String> {
        let faces = foam::read_inner_faces(case).map_err(|error| error.to_string())?;
        let of = |cells: &[u32; 2]| if cells.iter().any(|&cell| self.marked[cell as usize]) { 0.0 } else { 1.0 };
        let values: Vec<f64> = faces.iter().map(of).collect();
        let entries = |kind: &str| format!("type {kind}; value uniform 1;");
        // OpenFOAM takes a name before a pattern.
        let mut patches = vec![("\".*\"".to_owned(), entries("calculated"))];
        patches.extend(symmetry.iter().map(|name| (name.clone(), entries("symmetry"))));
        for field in AT_FACES {
            foam::write_face_field(&time.join(factor(field)), &values, &patches, false)
                .map_err(|error| error.to_string())?;
        }
        Ok(())
    }

    /// Removes what [`Self::write`] has written.
    pub fn remove(time: &Path) {
        for field in AT_FACES {
            let _ = std::fs::remove_file(time.join(factor(field))); // what stays is read by nobody
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::Dataset;
    use crate::mesh::samples::cube;

    #[test]
    fn what_fell_is_marked_with_what_is_around_it() {
        let all = Cells::of(Dataset { mesh: cube(4), ..Dataset::default() });
        let (mesh, cells) = (&all.mesh, all.count());
        let (p, t) = (vec![1.0; cells], vec![1.0; cells]);
        let mut marks = FirstOrderCells::none(cells);
        assert_eq!((marks.add(&all, [&p, &t], [&p, &t]), marks.count), (0, 0));
        let mut fallen = p.clone();
        fallen[7] = -0.1;
        assert_eq!(marks.add(&all, [&p, &t], [&fallen, &t]), 1);
        let near = |cell: usize| mesh.tets.nodes[cell].iter().any(|v| mesh.tets.nodes[7].contains(v));
        assert!((0..cells).all(|cell| marks.marked[cell] == near(cell)));
        assert_eq!(marks.count, (0..cells).filter(|&cell| near(cell)).count());
        assert_eq!(marks.add(&all, [&p, &t], [&fallen, &t]), 0, "it has its mark");
        fallen[cells - 1] = 0.6;
        assert_eq!(marks.add(&all, [&p, &t], [&t, &fallen]), 1, "as a temperature 0.6 is too little");
    }
}
