//! Triangles that come and go, found by their place: for each size, a power of two, there is a grid with the triangles of that size.
use super::{bounds, overlap};
use crate::adapt::core::ids::VertexId;
use crate::mesh::box_tree::Bounds;
use crate::mesh::triangle_pair::{Corners, crossing};
use std::collections::{BTreeMap, HashMap};

/// A triangle's vertices, ascending: which triangle it is, whichever way it is seen.
pub type Key = [VertexId; 3];

/// The key of a triangle of these vertices.
pub fn key(mut vertices: [VertexId; 3]) -> Key {
    vertices.sort_unstable();
    vertices
}

/// A boundary triangle, seen from outside.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    /// Its vertices, so that the normal points out of the mesh.
    pub vertices: [VertexId; 3],
    /// Where they are, in this order.
    pub corners: Corners,
}

impl Triangle {
    /// Which it is.
    pub fn key(&self) -> Key {
        key(self.vertices)
    }
}

type Cell = [i64; 3];

/// The triangles.
#[derive(Default)]
pub struct Triangles {
    slots: Vec<Triangle>,
    free: Vec<u32>,
    of: HashMap<Key, u32>,
    /// By the power of two that is no less than the sides of the triangles' boxes: the triangles by the cell of their least corners.
    levels: BTreeMap<i32, HashMap<Cell, Vec<u32>>>,
}

/// The cell of side 2^level that holds a point.
fn cell(level: i32, p: [f64; 3]) -> Cell {
    p.map(|x| (x / f64::from(level).exp2()).floor() as i64)
}

/// Level and cell of a triangle.
fn home(corners: &Corners) -> (i32, Cell) {
    let [low, high] = bounds(corners, 0.0);
    let side = (0..3).fold(f64::MIN_POSITIVE, |side, k| (high[k] - low[k]).max(side));
    let level = side.log2().ceil() as i32;
    (level, cell(level, low))
}

impl Triangles {
    /// Adds a triangle.
    pub fn insert(&mut self, triangle: Triangle) {
        let slot = self.free.pop().unwrap_or(self.slots.len() as u32);
        match self.slots.get_mut(slot as usize) {
            Some(old) => *old = triangle,
            None => self.slots.push(triangle),
        }
        self.of.insert(triangle.key(), slot);
        let (level, cell) = home(&triangle.corners);
        self.levels.entry(level).or_default().entry(cell).or_default().push(slot);
    }

    /// Takes a triangle out, if it is there.
    pub fn remove(&mut self, key: &Key) {
        let Some(slot) = self.of.remove(key) else { return };
        let (level, cell) = home(&self.slots[slot as usize].corners);
        if let Some(cells) = self.levels.get_mut(&level) {
            if let Some(list) = cells.get_mut(&cell) {
                list.retain(|&other| other != slot);
                if list.is_empty() {
                    cells.remove(&cell);
                }
            }
            if cells.is_empty() {
                self.levels.remove(&level);
            }
        }
        self.free.push(slot);
    }

    /// The triangle of these vertices, if it is there.
    pub fn get(&self, key: &Key) -> Option<&Triangle> {
        self.of.get(key).map(|&slot| &self.slots[slot as usize])
    }

    /// How many there are.
    #[cfg(test)]
    pub fn len(&self) -> usize {
        self.of.len()
    }

    /// Calls `f` with the triangles whose boxes meet a box.
    fn each_near(&self, around: &Bounds, mut f: impl FnMut(&Triangle)) {
        let mut visit = |list: &Vec<u32>| {
            for &slot in list {
                let triangle = &self.slots[slot as usize];
                if overlap(around, &bounds(&triangle.corners, 0.0)) {
                    f(triangle);
                }
            }
        };
        for (&level, cells) in &self.levels {
            let side = f64::from(level).exp2();
            let (from, to) = (cell(level, around[0].map(|x| x - side)), cell(level, around[1]));
            let many = (0..3).map(|k| (to[k] as f64 - from[k] as f64) + 1.0).product::<f64>();
            if many > cells.len() as f64 {
                cells.values().for_each(&mut visit);
                continue;
            }
            for i in from[0]..=to[0] {
                for j in from[1]..=to[1] {
                    for k in from[2]..=to[2] {
                        cells.get(&[i, j, k]).into_iter().for_each(&mut visit);
                    }
                }
            }
        }
    }

    /// Pairs that cross, of `some` triangles with each other and with those that are here, but not those that are `left_out`.
    pub fn crossings(&self, some: &[Triangle], left_out: impl Fn(&Key) -> bool) -> usize {
        let mut count = 0;
        for (i, triangle) in some.iter().enumerate() {
            let around = bounds(&triangle.corners, 0.0);
            let Triangle { vertices, corners } = triangle;
            let is_met = |other: &Triangle| crossing((vertices, corners), (&other.vertices, &other.corners)).is_some();
            count += some[..i].iter().filter(|other| is_met(other)).count();
            self.each_near(&around, |other| count += usize::from(!left_out(&other.key()) && is_met(other)));
        }
        count
    }
}
