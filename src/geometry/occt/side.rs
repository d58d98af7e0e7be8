//! On which side of a face's edges parameters lie: by the parity of what a line to a place that is known crosses of their chords.
//!
//! Each piece of a p-curve is replaced by its chord. Piece and chord together bound a place within the piece's hull, so that the parity of the
//! crossings of a line is that of the curves, wherever neither end of the line lies in such a hull. Where one does, the piece is halved until it does
//! not. Where an end of a chord is as good as on the line, and of faces whose edges are no closed lines in the plane of the parameters, nothing is
//! known.
use super::chord::{Chord, Curves, Line, SLACK, Seen, Share, Source};
use super::trim::CELLS;
use crate::mesh::vector::Vec3;

/// The widest gap between the ends of edges that is closed, as a share of the range.
const GAP: f64 = 1e-2;

/// The chords of a face by the columns and the rows of its grid.
#[derive(Debug, Default)]
pub struct Sides {
    chords: Vec<Chord>,
    lists: [List; 2],
}

/// Chords by their places in one direction.
#[derive(Debug, Default)]
struct List {
    /// Where those of a place begin.
    starts: Vec<u32>,
    chords: Vec<u32>,
}

impl List {
    /// Those of a direction.
    fn of(chords: &[Chord], across: usize) -> Self {
        let cells = |chord: &Chord| {
            let cell = |x: f64| ((x * CELLS as f64).floor().max(0.0) as usize).min(CELLS - 1);
            cell(chord.low[across])..cell(chord.high[across]) + 1
        };
        let mut starts = vec![0u32; CELLS + 1];
        chords.iter().flat_map(cells).for_each(|cell| starts[cell + 1] += 1);
        for cell in 0..CELLS {
            starts[cell + 1] += starts[cell];
        }
        let mut next = starts.clone();
        let mut list = vec![0; starts[CELLS] as usize];
        for (i, chord) in chords.iter().enumerate() {
            for cell in cells(chord) {
                list[next[cell] as usize] = i as u32;
                next[cell] += 1;
            }
        }
        Self { starts, chords: list }
    }
}

/// A piece of a p-curve in parameters: its ends, points whose hull with a margin holds it.
pub struct Piece<'a> {
    /// Which it is.
    pub source: Source,
    /// Ends.
    pub ends: [Share; 2],
    /// Points, the third coordinate 0.
    pub points: &'a [Vec3],
    /// How far beyond their hull it may go.
    pub margin: f64,
}

impl Piece<'_> {
    /// Its box of u and v.
    pub fn bounds(&self) -> [[f64; 2]; 2] {
        [0, 1].map(|k: usize| {
            let low = self.points.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min);
            [low - self.margin, self.points.iter().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max) + self.margin]
        })
    }
}

impl Sides {
    /// A piece, wherever periods bring it.
    pub fn add(&mut self, piece: &Piece<'_>, range: [[f64; 2]; 2], period: [Option<f64>; 2]) {
        let turns = |k: usize| if period[k].is_some() { -1..=1 } else { 0..=0 };
        for turn in turns(0) {
            for other in turns(1) {
                let shift = [turn, other].map(f64::from);
                let share = |k: usize, x: f64| {
                    (x + shift[k] * period[k].unwrap_or(0.0) - range[k][0]) / (range[k][1] - range[k][0])
                };
                let place = |p: Share| [share(0, p[0]), share(1, p[1])];
                let margin = piece.margin / (range[0][1] - range[0][0]).min(range[1][1] - range[1][0]);
                let points = piece.points.iter().map(|p| place([p[0], p[1]]));
                self.add_chord(piece.ends.map(place), points, margin, Some((piece.source, shift)));
            }
        }
    }

    fn add_chord(
        &mut self,
        ends: [Share; 2],
        points: impl Iterator<Item = Share>,
        margin: f64,
        source: Option<(Source, [f64; 2])>,
    ) {
        let chord = Chord::new(ends, points, margin + SLACK);
        let is_straight = chord.width - SLACK <= 1e-3 * SLACK;
        if (0..2).all(|k| chord.high[k] >= 0.0 && chord.low[k] <= 1.0) {
            self.chords.push(Chord { is_straight, source, ..chord });
        }
    }

    /// Closes the gaps between the ends of edges, which tolerances leave: each end with the nearest. Whether all within the range are closed: only
    /// then do the edges bound something. On its border an end needs none.
    fn close(&mut self, ends: &[Share]) -> bool {
        let is_within = |at: &Share| at.iter().all(|x| (SLACK..1.0 - SLACK).contains(x));
        let mut pairs = Vec::new();
        for (i, p) in ends.iter().enumerate() {
            for (j, q) in ends.iter().enumerate().skip(i + 1) {
                let far = (p[0] - q[0]).hypot(p[1] - q[1]);
                if far <= GAP && (is_within(p) || is_within(q)) {
                    pairs.push((far, i, j));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut is_met = vec![false; ends.len()];
        for (far, i, j) in pairs {
            if !is_met[i] && !is_met[j] {
                (is_met[i], is_met[j]) = (true, true);
                if far > 0.0 {
                    self.add_chord([ends[i], ends[j]], std::iter::empty(), far, None);
                }
            }
        }
        ends.iter().zip(is_met).all(|(at, is_met)| is_met || !is_within(at))
    }

    /// Lists the chords by rows, when all are there; `ends` are those of the whole edges, in parameters. None where the edges are not closed.
    pub fn listed(mut self, ends: &[Share], range: [[f64; 2]; 2], period: [Option<f64>; 2]) -> Option<Self> {
        let into = |k: usize, x: f64| {
            let share = (x - range[k][0]) / (range[k][1] - range[k][0]);
            let turn = period[k].map(|period| period / (range[k][1] - range[k][0]));
            // Into the range, if a period brings it there.
            turn.map_or(share, |turn| {
                [0.0, -turn, turn]
                    .map(|turn| share + turn)
                    .into_iter()
                    .find(|x| (-SLACK..=1.0 + SLACK).contains(x))
                    .unwrap_or(share)
            })
        };
        let ends: Vec<Share> = ends.iter().map(|at| [into(0, at[0]), into(1, at[1])]).collect();
        let is_finite = |chord: &Chord| chord.ends.iter().flatten().all(|x| x.is_finite()) && chord.width.is_finite();
        if !self.chords.iter().all(is_finite) || !self.close(&ends) {
            return None;
        }
        self.lists = [0, 1].map(|across| List::of(&self.chords, across));
        Some(self)
    }

    /// Whether no piece is near a place in a row, where `across` is 1, or in a column.
    pub fn is_clear(&self, across: usize, cell: usize, at: Share) -> bool {
        let list = &self.lists[across];
        let near = &list.chords[list.starts[cell] as usize..list.starts[cell + 1] as usize];
        !near.iter().any(|&i| self.chords[i as usize].holds(at))
    }

    /// Whether a place is in the face or on its border, by one of which that is known and no piece is near of, along a line: of v where `along` is 0,
    /// which crosses the cells of a row; of u where it is 1. `cell` is that row or column, and `known` the share along the line.
    pub fn is_inside(
        &self,
        curves: &mut Curves<'_>,
        along: usize,
        cell: usize,
        at: Share,
        (known, mut is_inside): (f64, bool),
    ) -> Option<bool> {
        let across = 1 - along;
        let line = Line { along, at, from: at[along].min(known), to: at[along].max(known) };
        let list = &self.lists[across];
        for &i in &list.chords[list.starts[cell] as usize..list.starts[cell + 1] as usize] {
            let chord = &self.chords[i as usize];
            // Beside the line, or to one side of it.
            let (low, high) = (&chord.low, &chord.high);
            if high[along] < line.from || low[along] > line.to || high[across] < at[across] || low[across] > at[across]
            {
                continue;
            }
            if !chord.holds(at) {
                is_inside ^= line.is_crossed(chord.ends)?;
            } else if chord.is_straight {
                return Some(true);
            } else {
                match curves.look(chord, &line)? {
                    Seen::On => return Some(true),
                    Seen::Parity(parity) => is_inside ^= parity,
                }
            }
        }
        Some(is_inside)
    }
}

#[cfg(test)]
mod tests {
    use super::super::chord::Curves;
    use super::super::evaluator::OcctEvaluator;
    use super::super::trim::{self, Place, Trim};
    use crate::geometry::{Geometry, OcctModel};
    use std::path::Path;

    /// Places in crossed cells of a model's faces whose edges are closed lines: how many there are, and how many are told.
    fn compared(name: &str) -> [usize; 2] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("geometry").join(name);
        let model = OcctModel::read(&path).unwrap();
        let mut on = model.evaluator();
        let mut counts = [0; 2];
        for (index, face) in model.topology().faces.iter().enumerate() {
            let trim = trim::build(&mut on, index as u32);
            let Trim::Grid(grid, Some(_)) = &trim else { continue };
            let mut random = 1u64;
            let mut share = || {
                random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (random >> 33) as f64 / (1u64 << 31) as f64
            };
            for _ in 0..400 {
                let at = [share(), share()];
                let [i, j] = at.map(|x| (x * super::CELLS as f64) as usize);
                if grid[i][j] != Place::Crossed {
                    continue;
                }
                let place = |at: [f64; 2]| {
                    [0, 1].map(|k: usize| face.range[k][0] + at[k] * (face.range[k][1] - face.range[k][0]))
                };
                counts[0] += 1;
                let curves = Curves { model: &model, face: index as u32, points: &mut Vec::new() };
                let Some(told) = trim.known(curves, place(at)) else { continue };
                counts[1] += 1;
                let occt = |on: &mut OcctEvaluator, ds: f64, dr: f64| {
                    on.inside_by_occt(index as u32, place([at[0] + ds, at[1] + dr]))
                };
                // Near an edge OCCT's classifier takes what it likes.
                let around = [(0.0, 0.0), (1e-4, 0.0), (-1e-4, 0.0), (0.0, 1e-4), (0.0, -1e-4)];
                let said = around.map(|(ds, dr)| occt(&mut on, ds, dr));
                assert!(said.contains(&told), "{name} face {} at {:?}: {told}", index + 1, place(at));
            }
        }
        counts
    }

    /// Places at both sides of each edge of a model's faces, so near that they are in the hulls of its pieces: how many there are, and how many are told.
    fn beside_edges(name: &str) -> [usize; 2] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("geometry").join(name);
        let model = OcctModel::read(&path).unwrap();
        let mut on = model.evaluator();
        let mut counts = [0; 2];
        for (index, face) in model.topology().faces.iter().enumerate() {
            let trim = trim::build(&mut on, index as u32);
            if !matches!(trim, Trim::Grid(_, Some(_))) {
                continue;
            }
            let extent = face.range.map(|[low, high]| high - low);
            for &edge in &face.edges {
                let [from, to] = model.topology().edges[edge as usize].range;
                let at = |on: &mut OcctEvaluator, s: f64| on.pcurve(edge, index as u32, from + s * (to - from), true);
                for s in [0.13, 0.37, 0.51, 0.9] {
                    let (Some(here), Some(ahead)) = (at(&mut on, s), at(&mut on, s + 1e-5)) else { continue };
                    let along = [0, 1].map(|k: usize| (ahead[k] - here[k]) / extent[k]);
                    let length = along[0].hypot(along[1]);
                    // Beyond what OCCT takes for the edge itself.
                    let off = 1e-5 / length;
                    let beside =
                        |off: f64| [here[0] - off * along[1] * extent[0], here[1] + off * along[0] * extent[1]];
                    for uv in [beside(off), beside(-off)] {
                        if !(0..2).all(|k| (face.range[k][0]..=face.range[k][1]).contains(&uv[k])) {
                            continue;
                        }
                        counts[0] += 1;
                        let curves = Curves { model: &model, face: index as u32, points: &mut Vec::new() };
                        let Some(told) = trim.known(curves, uv) else { continue };
                        counts[1] += 1;
                        assert_eq!(
                            told,
                            on.inside_by_occt(index as u32, uv),
                            "{name} face {} edge {} at {s}: {uv:?}",
                            index + 1,
                            edge + 1
                        );
                    }
                }
            }
        }
        counts
    }

    #[test]
    fn beside_edges_it_is_as_occt_tells() {
        let names = [
            "aircraft/transport-half.step",
            "cube-cylinder.step",
            "wing.step",
            "zoo/screw.step",
            "zoo/cusps.step",
            "zoo/three-tori.step",
        ];
        let counts = names.map(beside_edges);
        let [all, told] = [0, 1].map(|k: usize| counts.iter().map(|count| count[k]).sum::<usize>());
        assert!(all > 1000 && 100 * told >= 95 * all, "{told} of {all}");
    }

    #[test]
    fn sides_are_those_of_occt() {
        let mut compared_in_all = 0;
        for name in [
            "aircraft/transport-half.step",
            "cube-cylinder.step",
            "sphere-in-box.step",
            "wing.step",
            "zoo/screw.step",
            "zoo/partial-torus.step",
            "zoo/cusps.step",
            "zoo/three-tori.step",
        ] {
            let [all, told] = compared(name);
            // On a line through an end of a piece OCCT is asked.
            assert!(100 * told >= 99 * all, "{name}: {told} of {all}");
            compared_in_all += told;
        }
        assert!(compared_in_all > 2000, "{compared_in_all}");
    }
}
