//! Which parameters lie in a trimmed face: told at once by a grid over its range, and in the cells that an edge crosses by what a line to another
//! cell crosses. Where that does not tell, OCCT's classifier is asked.
use super::chord::{Curves, Source};
use super::curve::Curve;
use super::evaluator::OcctEvaluator;
use super::hull::{self, as_jet};
use super::pieces::cuts;
use super::side::{Piece, Sides};
use crate::geometry::{EdgeUse, FaceEntity, Topology, Use};
use crate::mesh::vector::Vec3;

/// Cells of the grid in each direction.
pub const CELLS: usize = 64;
/// Pieces that an edge is cut into at least.
const PIECES: usize = 64;
/// How near to the border of the range, as a share of it, a p-curve must lie to be that border.
const BORDER: f64 = 3e-7;
/// What boxes of pieces are grown by, as a share of a cell.
const GROWTH: f64 = 0.1;

/// What is known of a face's trimming.
#[derive(Debug)]
pub enum Trim {
    /// All of its range is inside.
    Whole,
    /// By cells, those of v side by side, and by sides of the edges, where those tell something.
    Grid(Box<[[Place; CELLS]; CELLS]>, Option<Sides>),
    /// Nothing: an edge has no copy of its p-curve.
    Unknown,
}

/// Where a cell lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// Not yet known; when the grid is done there is none left.
    Free,
    Inside,
    Outside,
    /// An edge crosses it.
    Crossed,
}

impl Trim {
    /// Whether the parameters lie in the face that is looked at, if that is known without asking OCCT. They lie in the face's range.
    #[inline]
    pub fn known(&self, mut curves: Curves<'_>, uv: [f64; 2]) -> Option<bool> {
        let face = &curves.model.topology.faces[curves.face as usize];
        let (grid, sides) = match self {
            Self::Whole => return uv.iter().all(|x| x.is_finite()).then_some(true),
            Self::Grid(grid, sides) => (grid, sides),
            Self::Unknown => return None,
        };
        let share = |k: usize| (uv[k] - face.range[k][0]) / (face.range[k][1] - face.range[k][0]);
        let (s, r) = (share(0), share(1));
        if !((0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&r)) {
            return None;
        }
        let cell = |s: f64| ((s * CELLS as f64) as usize).min(CELLS - 1);
        let (i, j) = (cell(s), cell(r));
        match grid[i][j] {
            Place::Inside => Some(true),
            Place::Outside => Some(false),
            Place::Free | Place::Crossed => {
                let mut way = Way { grid, sides: sides.as_ref()?, curves: &mut curves };
                [0, 1]
                    .into_iter()
                    .find_map(|along| way.straight(along, [i, j], [s, r]))
                    .or_else(|| [0, 1].into_iter().find_map(|along| way.round_a_corner(along, [i, j], [s, r])))
            }
        }
    }
}

/// The way from a place in a crossed cell to one that is known. Places are shares of the range.
struct Way<'t, 'c, 'p> {
    grid: &'t [[Place; CELLS]; CELLS],
    sides: &'t Sides,
    curves: &'c mut Curves<'p>,
}

impl Way<'_, '_, '_> {
    /// The cells of a row or a column beside one of them, the nearest first.
    fn beside(own: usize) -> impl Iterator<Item = usize> {
        let both = move |k: usize| [own.checked_sub(k), (own + k < CELLS).then_some(own + k)];
        (1..CELLS).flat_map(both).flatten()
    }

    /// Whether a place is inside, by the nearest cell that is known of the row where `along` is 0, of the column where it is 1.
    fn straight(&mut self, along: usize, [i, j]: [usize; 2], at: [f64; 2]) -> Option<bool> {
        let place = |k: usize| if along == 0 { self.grid[k][j] } else { self.grid[i][k] };
        let [own, cell] = [[i, j], [j, i]][along];
        let known = Self::beside(own).find(|&k| place(k) != Place::Crossed)?;
        let known = (middle(known), place(known) == Place::Inside);
        self.sides.is_inside(self.curves, along, cell, at, known)
    }

    /// The same by a place in the next cell of the row or column, which is told by its column or row: in a corner of the face all cells of both may
    /// be crossed.
    fn round_a_corner(&mut self, along: usize, cell: [usize; 2], at: [f64; 2]) -> Option<bool> {
        let across = 1 - along;
        Self::beside(cell[along]).take(2).find_map(|next| {
            let (mut there, mut corner) = (cell, at);
            (there[along], corner[along]) = (next, middle(next));
            if !self.sides.is_clear(across, cell[across], corner) {
                return None;
            }
            let is_inside = self.straight(across, there, corner)?;
            self.sides.is_inside(self.curves, along, cell[across], at, (corner[along], is_inside))
        })
    }
}

/// The middle of a cell, as a share of the range.
fn middle(cell: usize) -> f64 {
    (cell as f64 + 0.5) / CELLS as f64
}

impl Trim {
    /// Whether no point of these parameters lies in the face, as far as that is known without asking OCCT.
    pub fn leaves_out(&self, face: &FaceEntity, bounds: [[f64; 2]; 2]) -> bool {
        let Self::Grid(grid, _) = self else { return false };
        let cells = |k: usize| {
            let [low, high] = face.range[k];
            let share = bounds[k].map(|x| (x - low) / (high - low) * CELLS as f64);
            // A bound on a line between cells belongs to both.
            let from = (share[0] - ROUNDING).floor().max(0.0) as usize;
            from..((share[1] + ROUNDING).floor().max(0.0) as usize + 1).min(CELLS)
        };
        let mut all = cells(0).flat_map(|i| cells(1).map(move |j| grid[i][j]));
        cells(0).len() * cells(1).len() > 0 && all.all(|place| place == Place::Outside)
    }
}

/// What of a cell is rounding.
const ROUNDING: f64 = 1e-6;

/// The trimming of a face.
pub fn build(on: &mut OcctEvaluator, index: u32) -> Trim {
    let topology = &on.model.topology;
    let face = &topology.faces[index as usize];
    let mut boxes = Vec::new();
    let mut bordered = true;
    let (mut all, mut ends) = (Sides::default(), Vec::new());
    for &edge in &face.edges {
        let Some(pcurve) = on.model.pcurves[edge as usize].iter().find(|pcurve| pcurve.face == index) else {
            return Trim::Unknown;
        };
        let seam = topology.edges[edge as usize].seam;
        if seam && pcurve.other.is_none() {
            return Trim::Unknown;
        }
        for (is_other, curve) in std::iter::once(&pcurve.curve).chain(&pcurve.other).enumerate() {
            if matches!(curve, Curve::General) {
                return Trim::Unknown;
            }
            let (first, mut last) = (boxes.len(), [f64::NAN; 2]);
            pieces(topology, (edge, is_other == 1), curve, |piece| {
                boxes.push(piece.bounds());
                all.add(piece, face.range, face.period);
                if boxes.len() == first + 1 {
                    ends.push(piece.ends[0]);
                }
                last = piece.ends[1];
            });
            ends.push(last);
            bordered &= is_border(face, &boxes[first..]);
        }
    }
    if bordered && samples_inside(on, index) {
        return Trim::Whole;
    }
    let mut grid = Box::new([[Place::Free; CELLS]; CELLS]);
    let topology = &on.model.topology;
    boxes.iter().for_each(|piece| cross(&mut grid, &topology.faces[index as usize], piece));
    fill(on, index, &mut grid);
    let is_crossed = grid.iter().flatten().any(|&place| place == Place::Crossed);
    let bound = |of: EdgeUse| matches!(of.way, Use::Forward | Use::Reversed);
    let sides = is_crossed && on.model.edge_uses(index).into_iter().all(bound);
    let face = &on.model.topology.faces[index as usize];
    Trim::Grid(grid, if sides { all.listed(&ends, face.range, face.period) } else { None })
}

/// Tells the pieces of a p-curve.
fn pieces(topology: &Topology, (edge, is_other): (u32, bool), curve: &Curve, mut tell: impl FnMut(&Piece<'_>)) {
    let mut points: Vec<Vec3> = Vec::new();
    let ends = cuts(topology.edges[edge as usize].range, None, curve.breaks(), 1);
    let parts = PIECES.div_ceil(ends.len() - 1).max(2);
    let place = |t: f64| curve.frame(t).map_or([f64::NAN; 2], |frame| [frame.point[0], frame.point[1]]);
    for span in ends.windows(2) {
        for k in 0..parts {
            let at =
                |k: usize| if k == parts { span[1] } else { span[0] + (span[1] - span[0]) * k as f64 / parts as f64 };
            points.clear();
            let mut jet = |uv: [f64; 2]| curve.frame(uv[0]).map_or_else(nowhere, as_jet);
            let range = [at(k), at(k + 1)];
            let margin = hull::of_curve(curve, &mut jet, range, &mut points);
            let source = Source { edge, is_other, range };
            tell(&Piece { source, ends: range.map(place), points: &points, margin });
        }
    }
}

/// A general curve has been sent away before.
pub fn nowhere() -> super::surface::Jet {
    as_jet(crate::geometry::CurveFrame { point: [f64::NAN; 3], d1: [0.0; 3], d2: [0.0; 3] })
}

/// Whether a p-curve runs along one border of the face's range.
fn is_border(face: &FaceEntity, boxes: &[[[f64; 2]; 2]]) -> bool {
    (0..2).any(|k| {
        let [low, high] = face.range[k];
        let slack = BORDER * (high - low);
        let shifts = face.period[k].map_or([0.0; 3], |period| [-period, 0.0, period]);
        [low, high].into_iter().any(|border| {
            shifts
                .iter()
                .any(|shift| boxes.iter().all(|piece| piece[k].iter().all(|x| (x + shift - border).abs() <= slack)))
        })
    })
}

/// Whether OCCT finds nine points of the range inside.
fn samples_inside(on: &mut OcctEvaluator, index: u32) -> bool {
    let range = on.model.topology.faces[index as usize].range;
    let at = |k: usize, s: f64| range[k][0] + s * (range[k][1] - range[k][0]);
    let shares = [0.11, 0.53, 0.87];
    shares.iter().all(|&s| shares.iter().all(|&r| on.inside_by_occt(index, [at(0, s), at(1, r)])))
}

/// Marks the cells that a box meets, wherever periods bring it.
fn cross(grid: &mut [[Place; CELLS]; CELLS], face: &FaceEntity, piece: &[[f64; 2]; 2]) {
    let turns = |k: usize| if face.period[k].is_some() { -1..=1 } else { 0..=0 };
    let cells = |k: usize, turn: i32| {
        let [low, high] = face.range[k];
        let shift = face.period[k].unwrap_or(0.0) * f64::from(turn);
        let [from, to] = piece[k].map(|x| (x + shift - low) / (high - low) * CELLS as f64);
        // A box beyond the range meets no cell; one at its border, rounded, meets the first or last.
        let from = (from - GROWTH).floor().max(0.0) as usize;
        let to = (to + GROWTH).floor();
        if to < 0.0 { 0..0 } else { from..(to as usize + 1).min(CELLS) }
    };
    for turn in turns(0) {
        for i in cells(0, turn) {
            for other in turns(1) {
                for j in cells(1, other) {
                    grid[i][j] = Place::Crossed;
                }
            }
        }
    }
}

/// Asks OCCT once for each connected part of the cells that no edge crosses.
fn fill(on: &mut OcctEvaluator, index: u32, grid: &mut [[Place; CELLS]; CELLS]) {
    let range = on.model.topology.faces[index as usize].range;
    let centre = |k: usize, i: usize| range[k][0] + (range[k][1] - range[k][0]) * middle(i);
    let mut stack = Vec::new();
    for start in 0..CELLS * CELLS {
        let (i, j) = (start / CELLS, start % CELLS);
        if grid[i][j] != Place::Free {
            continue;
        }
        let inside = on.inside_by_occt(index, [centre(0, i), centre(1, j)]);
        let place = if inside { Place::Inside } else { Place::Outside };
        grid[i][j] = place;
        stack.push((i, j));
        while let Some((i, j)) = stack.pop() {
            let beside = [(i.wrapping_sub(1), j), (i + 1, j), (i, j.wrapping_sub(1)), (i, j + 1)];
            for (i, j) in beside.into_iter().filter(|&(i, j)| i < CELLS && j < CELLS) {
                if grid[i][j] == Place::Free {
                    grid[i][j] = place;
                    stack.push((i, j));
                }
            }
        }
    }
}
