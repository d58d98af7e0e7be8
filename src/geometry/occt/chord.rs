//! Chords of pieces of p-curves, and how a line to a place crosses a piece: as its chord, or as those of its halves where the place is in its hull.
use super::OcctModel;
use super::curve::Curve;
use super::hull::{self, as_jet};
use super::trim::nowhere;
use crate::mesh::vector::Vec3;

/// Places in the plane are shares of the face's range.
pub type Share = [f64; 2];

/// What counts as rounding, as a share of the range: so near to a straight edge is on it.
pub const SLACK: f64 = 1e-9;

/// What is so near to a piece that was halved is on it, as a share of the range.
const FINE: f64 = 1e-12;

/// How often a piece is halved at most: what still lies in its hull then is on it.
const HALVINGS: usize = 24;

/// The chord of a piece of a p-curve.
#[derive(Clone, Copy, Debug)]
pub struct Chord {
    /// Its ends.
    pub ends: [Share; 2],
    /// The box of the piece.
    pub low: Share,
    pub high: Share,
    /// How far the piece may be from the line of its chord.
    pub width: f64,
    /// Whether it is its chord.
    pub is_straight: bool,
    /// What it is the chord of, and by how many periods that is shifted; none where it closes a gap.
    pub source: Option<(Source, [f64; 2])>,
}

/// A piece of an edge's p-curve.
#[derive(Clone, Copy, Debug)]
pub struct Source {
    /// The edge.
    pub edge: u32,
    /// Whether it is of the second curve of a seam.
    pub is_other: bool,
    /// Its parameters.
    pub range: [f64; 2],
}

impl Chord {
    /// Of a piece within the hull of points, by a margin.
    pub fn new(ends: [Share; 2], points: impl Iterator<Item = Share>, margin: f64) -> Self {
        let [p, q] = ends;
        let along = [q[0] - p[0], q[1] - p[1]];
        let length = along[0].hypot(along[1]);
        let (mut low, mut high, mut width) = ([p[0].min(q[0]), p[1].min(q[1])], [p[0].max(q[0]), p[1].max(q[1])], 0.0);
        for at in points {
            let to = [at[0] - p[0], at[1] - p[1]];
            let off = if length > 0.0 { (along[0] * to[1] - along[1] * to[0]).abs() / length } else { f64::INFINITY };
            width = f64::max(width, off);
            for k in 0..2 {
                (low[k], high[k]) = (low[k].min(at[k]), high[k].max(at[k]));
            }
        }
        let (low, high) = (low.map(|x| x - margin), high.map(|x| x + margin));
        Self { ends, low, high, width: width + margin, is_straight: false, source: None }
    }

    /// Whether a place is in its hull.
    pub fn holds(&self, at: Share) -> bool {
        if !(0..2).all(|k| (self.low[k]..=self.high[k]).contains(&at[k])) {
            return false;
        }
        let [p, q] = self.ends;
        let chord = [q[0] - p[0], q[1] - p[1]];
        let off = chord[0] * (at[1] - p[1]) - chord[1] * (at[0] - p[0]);
        off.abs() <= self.width * chord[0].hypot(chord[1])
    }
}

/// A line to a place, of u where `along` is 0, of v where it is 1.
pub struct Line {
    /// In which direction it runs.
    pub along: usize,
    /// The place.
    pub at: Share,
    /// Where it begins and ends.
    pub from: f64,
    pub to: f64,
}

impl Line {
    /// Whether a chord crosses it; none where an end is as good as on it.
    pub fn is_crossed(&self, [p, q]: [Share; 2]) -> Option<bool> {
        let Self { along, at, from, to } = *self;
        let (across, r) = (1 - along, at[1 - along]);
        let is_on = |end: Share| (end[across] - r).abs() <= SLACK && (from - SLACK..=to + SLACK).contains(&end[along]);
        if is_on(p) || is_on(q) {
            return None;
        }
        let has_sides = (p[across] > r) != (q[across] > r);
        Some(
            has_sides && {
                let crossing = p[along] + (r - p[across]) * ((q[along] - p[along]) / (q[across] - p[across]));
                (from..to).contains(&crossing)
            },
        )
    }
}

/// What a closer look at a piece tells.
pub enum Seen {
    /// The place is on it.
    On,
    /// Whether the line crosses it an odd number of times.
    Parity(bool),
}

/// The curves of a face, to look closer at.
pub struct Curves<'a> {
    /// The model.
    pub model: &'a OcctModel,
    /// The face.
    pub face: u32,
    /// Points of a hull, allocated once.
    pub points: &'a mut Vec<Vec3>,
}

impl Curves<'_> {
    /// How a line crosses a piece in whose hull its place lies; none where that is not known.
    pub fn look(&mut self, chord: &Chord, line: &Line) -> Option<Seen> {
        let (source, turns) = chord.source?;
        let pcurve = self.model.pcurves[source.edge as usize].iter().find(|pcurve| pcurve.face == self.face)?;
        let curve = if source.is_other { pcurve.other.as_ref()? } else { &pcurve.curve };
        self.halved((curve, turns), (source.range, chord.ends), line, HALVINGS)
    }

    /// The same of the piece of a curve between parameters, with its ends.
    fn halved(
        &mut self,
        of: (&Curve, [f64; 2]),
        ([from, to], [p, q]): ([f64; 2], [Share; 2]),
        line: &Line,
        deep: usize,
    ) -> Option<Seen> {
        let (curve, turns) = of;
        let face = &self.model.topology.faces[self.face as usize];
        let extent = face.range.map(|[low, high]| high - low);
        let share = |p: Vec3| {
            [0, 1].map(|k: usize| (p[k] + turns[k] * face.period[k].unwrap_or(0.0) - face.range[k][0]) / extent[k])
        };
        let middle = 0.5 * (from + to);
        let m = share(curve.frame(middle)?.point);
        let mut parity = false;
        for (range, ends) in [([from, middle], [p, m]), ([middle, to], [m, q])] {
            self.points.clear();
            let mut jet = |uv: [f64; 2]| curve.frame(uv[0]).map_or_else(nowhere, as_jet);
            let margin = hull::of_curve(curve, &mut jet, range, self.points) / extent[0].min(extent[1]) + FINE;
            let half = Chord::new(ends, self.points.iter().map(|&p| share(p)), margin);
            parity ^= if !half.holds(line.at) {
                line.is_crossed(ends)?
            } else if deep == 0 || half.width <= 2.0 * FINE {
                return Some(Seen::On);
            } else {
                match self.halved(of, (range, ends), line, deep - 1)? {
                    Seen::On => return Some(Seen::On),
                    Seen::Parity(parity) => parity,
                }
            };
        }
        Some(Seen::Parity(parity))
    }
}
