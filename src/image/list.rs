//! The items that a task works on, and what became of them.
use super::rules::{Item, Part};
use serde::Serialize;
use std::collections::VecDeque;

/// A list of items.
#[derive(Default)]
pub struct List {
    pub faces: VecDeque<Item>,
    pub tets: VecDeque<Item>,
}

impl List {
    /// Number of items.
    pub fn len(&self) -> usize {
        self.faces.len() + self.tets.len()
    }

    /// Puts an item behind the others of its kind.
    pub fn push(&mut self, item: Item) {
        match item.part {
            Part::Face(..) => self.faces.push_back(item),
            Part::Whole => self.tets.push_back(item),
        }
    }

    /// The next item: faces first.
    pub fn pop(&mut self) -> Option<Item> {
        self.faces.pop_front().or_else(|| self.tets.pop_front())
    }

    /// Cuts the list in two by a plane through the middle, so that the threads of both halves are seldom in each other's way. The order stays.
    pub fn split(&mut self) -> Self {
        let places = || self.faces.iter().chain(&self.tets).map(|item| item.at);
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for p in places() {
            low = std::array::from_fn(|i| low[i].min(p[i]));
            high = std::array::from_fn(|i| high[i].max(p[i]));
        }
        let axis = (0..3).max_by(|&i, &j| (high[i] - low[i]).total_cmp(&(high[j] - low[j]))).unwrap_or(0);
        let mut along: Vec<f64> = places().map(|p| p[axis]).collect();
        let middle = along.len() / 2;
        let bound = *along.select_nth_unstable_by(middle, f64::total_cmp).1;
        let cut = |list: &mut VecDeque<Item>| {
            let (below, above) = list.drain(..).partition(|item| item.at[axis] < bound);
            *list = below;
            above
        };
        Self { faces: cut(&mut self.faces), tets: cut(&mut self.tets) }
    }

    /// Takes all of another list.
    pub fn append(&mut self, mut other: Self) {
        self.faces.append(&mut other.faces);
        self.tets.append(&mut other.tets);
    }
}

/// What was done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Items that were tried.
    pub attempts: usize,
    /// How many of these ended in a conflict, and were tried again.
    pub conflicts: usize,
    /// How many were gone already.
    pub stale: usize,
    /// How many were put off, since their point was within the surface ball of a face, which was refined first.
    pub put_off: usize,
    /// How many were given up, since there was no room beside the surface's vertices.
    pub crowded: usize,
    /// How many were given up at the limit of floating point.
    pub lost: usize,
    /// Vertices on surfaces.
    pub surface_points: usize,
    /// Vertices inside.
    pub inner_points: usize,
}

impl Counts {
    /// Adds those of another thread.
    pub fn add(&mut self, other: &Self) {
        self.attempts += other.attempts;
        self.conflicts += other.conflicts;
        self.stale += other.stale;
        self.put_off += other.put_off;
        self.crowded += other.crowded;
        self.lost += other.lost;
        self.surface_points += other.surface_points;
        self.inner_points += other.inner_points;
    }
}
