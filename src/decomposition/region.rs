//! Where in space a part lies: so that it takes only what it needs of a metric that is larger than memory.
use super::piece::Piece;
use crate::mesh::vector::{Vec3, distance};

/// Cells along an axis.
const CELLS: usize = 64;

/// Cells of all rows along the first axis: a word has a row.
const ROWS: usize = CELLS * CELLS;

/// The box that the cells fill is larger than the part's by this share of its diagonal on each side.
const MARGIN: f64 = 0.05;

/// The cells that a part has tetrahedra in, and those beside them.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// The box of the cells.
    low: Vec3,
    high: Vec3,
    /// The box of the tetrahedra, which may reach farther: what lies beyond the cells counts to the last one.
    least: Vec3,
    greatest: Vec3,
    /// A bit for each cell.
    cells: Vec<u64>,
}

impl Region {
    /// An empty one, of a part that is to lie in this box.
    pub fn new([low, high]: [Vec3; 2]) -> Self {
        let margin = MARGIN * distance(low, high);
        Self {
            low: low.map(|x| x - margin),
            high: high.map(|x| x + margin),
            least: [f64::INFINITY; 3],
            greatest: [f64::NEG_INFINITY; 3],
            cells: vec![0; ROWS],
        }
    }

    /// Adds the tetrahedra of a piece.
    pub fn add(&mut self, piece: &Piece) {
        for t in 0..piece.len() {
            let own = tet_box(piece, t);
            let [first, last] = own.map(|p| self.cell(p));
            let row = u64::MAX >> (CELLS - 1 - (last[0] - first[0])) << first[0];
            for z in first[2]..=last[2] {
                self.cells[CELLS * z + first[1]..=CELLS * z + last[1]].iter_mut().for_each(|cells| *cells |= row);
            }
            for k in 0..3 {
                self.least[k] = self.least[k].min(own[0][k]);
                self.greatest[k] = self.greatest[k].max(own[1][k]);
            }
        }
    }

    /// With the cells beside: a new vertex on a curved face may lie outside of all tetrahedra.
    pub fn grown(mut self) -> Self {
        let margin = MARGIN * distance(self.low, self.high);
        self.least = self.least.map(|x| x - margin);
        self.greatest = self.greatest.map(|x| x + margin);
        for cells in &mut self.cells {
            *cells |= *cells << 1 | *cells >> 1;
        }
        for step in [1, CELLS] {
            let before = self.cells.clone();
            let is_first = |at: usize| (at / step).is_multiple_of(CELLS);
            for (at, cells) in self.cells.iter_mut().enumerate() {
                *cells |= if is_first(at) { 0 } else { before[at - step] };
                *cells |= if at + step < ROWS && !is_first(at + step) { before[at + step] } else { 0 };
            }
        }
        self
    }

    /// The tetrahedra of a piece that may lie here.
    pub fn of(&self, piece: &Piece) -> Vec<u32> {
        (0..piece.len() as u32).filter(|&t| self.has(tet_box(piece, t as usize))).collect()
    }

    /// Whether a box reaches here.
    pub fn reaches(&self, [low, high]: [Vec3; 2]) -> bool {
        (0..3).all(|k| low[k] <= self.greatest[k] && high[k] >= self.least[k])
    }

    fn has(&self, own: [Vec3; 2]) -> bool {
        if !self.reaches(own) {
            return false;
        }
        let [first, last] = own.map(|p| self.cell(p));
        let row = u64::MAX >> (CELLS - 1 - (last[0] - first[0])) << first[0];
        (first[2]..=last[2])
            .any(|z| self.cells[CELLS * z + first[1]..=CELLS * z + last[1]].iter().any(|cells| cells & row != 0))
    }

    /// The cell of a point; beyond all cells the last one on that side.
    fn cell(&self, p: Vec3) -> [usize; 3] {
        [0, 1, 2].map(|k| {
            let share = (p[k] - self.low[k]) / (self.high[k] - self.low[k]).max(f64::MIN_POSITIVE);
            (share.clamp(0.0, 1.0) * CELLS as f64).min(CELLS as f64 - 1.0) as usize
        })
    }

    /// With the cells of another one of the same box.
    pub fn join(&mut self, other: &Self) {
        self.cells.iter_mut().zip(&other.cells).for_each(|(cells, more)| *cells |= more);
        for k in 0..3 {
            self.least[k] = self.least[k].min(other.least[k]);
            self.greatest[k] = self.greatest[k].max(other.greatest[k]);
        }
    }

    /// As words: the boxes, and the rows that have cells with their numbers.
    pub fn words(&self) -> Vec<u64> {
        let boxes = [self.low, self.high, self.least, self.greatest];
        let rows = self.cells.iter().zip(0..).filter(|(cells, _)| **cells != 0).flat_map(|(cells, at)| [at, *cells]);
        boxes.as_flattened().iter().map(|x| x.to_bits()).chain(rows).collect()
    }

    /// Of these words.
    pub fn of_words(words: &[u64]) -> Option<Self> {
        let (boxes, rows) = words.split_first_chunk::<12>()?;
        let boxes = boxes.map(f64::from_bits);
        let [low, high, least, greatest] = [0, 3, 6, 9].map(|at| [boxes[at], boxes[at + 1], boxes[at + 2]]);
        let mut region = Self { low, high, least, greatest, cells: vec![0; ROWS] };
        for row in rows.as_chunks::<2>().0 {
            *region.cells.get_mut(row[0] as usize)? = row[1];
        }
        Some(region)
    }
}

/// The box of a tetrahedron.
fn tet_box(piece: &Piece, t: usize) -> [Vec3; 2] {
    let corners = piece.mesh.tets.nodes[t].map(|v| piece.mesh.vertices[v as usize]);
    box_of(&corners)
}

/// The box of some points.
pub fn box_of(points: &[Vec3]) -> [Vec3; 2] {
    let mut found = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for p in points {
        for k in 0..3 {
            found[0][k] = found[0][k].min(p[k]);
            found[1][k] = found[1][k].max(p[k]);
        }
    }
    found
}
