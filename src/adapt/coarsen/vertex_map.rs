//! Which vertices stay, and onto which of them the others go.
use super::level::{Balls, FIXED, INSIDE, Level};
use super::surface::Surface;

/// Edges shorter than this in the metrics of both ends may vanish.
const SHORT: f64 = 0.85;

/// What becomes of a vertex.
#[derive(Clone, Copy)]
struct Image {
    /// The vertex that it goes onto; itself where it stays; [`OPEN`] where that is not decided.
    target: u32,
    /// Who looked at it last: a vertex, or a numbered look around one.
    seen: u32,
    /// Fourth power of the distance to its target.
    distance: f32,
}

const OPEN: u32 = u32::MAX;

/// The vertices that stay, each with those that go onto it.
pub struct VertexMap {
    images: Vec<Image>,
    /// The number of the present look, greater than that of any vertex.
    look: u32,
}

impl VertexMap {
    /// Vertices are taken in their order, those on edges of the model first, then those on its faces. A vertex stays when no vertex that
    /// stays is near it; else it goes onto the nearest of these.
    pub fn of(level: &Level, balls: &Balls, surface: &Surface) -> Self {
        let count = level.points.len();
        let mut map = Self {
            images: vec![Image { target: OPEN, seen: OPEN, distance: f32::INFINITY }; count],
            look: count as u32,
        };
        let those = |wanted: fn(u32) -> bool| (0..count as u32).filter(move |&v| wanted(level.faces[v as usize]));
        for v in those(|face| face == FIXED).chain(those(|face| face < FIXED)) {
            if map.stays(v) {
                surface.neighbours(level, v, |x| map.offer_target(level, v, x));
            }
        }
        for v in those(|face| face != INSIDE).chain(those(|face| face == INSIDE)) {
            if map.stays(v) {
                map.attract_inside(level, balls, v);
            }
        }
        map
    }

    /// Lets a vertex stay, unless it goes already.
    fn stays(&mut self, v: u32) -> bool {
        let image = &mut self.images[v as usize];
        if image.target == OPEN {
            (image.target, image.distance) = (v, 0.0);
        }
        image.target == v
    }

    /// Offers v, which stays, as a target to the vertices inside that are joined to it.
    fn attract_inside(&mut self, level: &Level, balls: &Balls, v: u32) {
        for &t in balls.at(v) {
            for x in level.tets[t as usize] {
                if x != v && self.images[x as usize].seen != v && level.faces[x as usize] == INSIDE {
                    self.offer_target(level, v, x);
                }
            }
        }
    }

    /// Offers v, which stays, as a target to a vertex that is joined to it.
    #[inline]
    fn offer_target(&mut self, level: &Level, v: u32, x: u32) {
        let image = &mut self.images[x as usize];
        image.seen = v;
        let distance = distance(level, v, x);
        if distance < image.distance {
            (image.target, image.distance) = (v, distance);
        }
    }

    /// Begins a look around a vertex.
    pub fn look_around(&mut self) {
        self.look = self.look.wrapping_add(1);
    }

    /// Whether this look meets a vertex for the first time.
    #[inline(always)]
    pub fn is_new(&mut self, v: u32) -> bool {
        std::mem::replace(&mut self.images[v as usize].seen, self.look) != self.look
    }

    /// The vertex that a vertex goes onto: itself where it stays.
    #[inline(always)]
    pub fn target(&self, v: u32) -> u32 {
        self.images[v as usize].target
    }

    /// An element with its vertices replaced by their targets.
    #[inline(always)]
    pub fn map<const N: usize>(&self, nodes: &[u32; N]) -> [u32; N] {
        nodes.map(|v| self.target(v))
    }

    /// Sends a vertex onto another. Returns its target before.
    pub fn send(&mut self, v: u32, target: u32, distance: f32) -> (u32, f32) {
        let image = &mut self.images[v as usize];
        let before = (image.target, image.distance);
        (image.target, image.distance) = (target, distance);
        before
    }

    /// For each vertex whether others go onto it.
    pub fn led(&self) -> Vec<bool> {
        let mut led = vec![false; self.images.len()];
        for (image, v) in self.images.iter().zip(0..) {
            led[image.target as usize] |= image.target != v;
        }
        led
    }

    /// Of the vertices of an element, lets the one with the longest way stay. None where all stay already.
    pub fn keep_one(&mut self, nodes: &[u32]) -> Option<u32> {
        let goes = nodes.iter().copied().filter(|&v| self.target(v) != v);
        let way = |v: &u32| self.images[*v as usize].distance;
        let v = goes.max_by(|a, b| way(a).total_cmp(&way(b)))?;
        (self.images[v as usize].target, self.images[v as usize].distance) = (v, 0.0);
        Some(v)
    }
}

/// Fourth power of the length of an edge, infinite where it is not short in the metrics of both ends. Single precision is enough to
/// choose by.
#[inline(always)]
pub fn distance(level: &Level, a: u32, b: u32) -> f32 {
    let [at_a, at_b] = level.squares(a, b);
    if at_a < SHORT * SHORT && at_b < SHORT * SHORT { (at_a * at_b).max(0.0) as f32 } else { f32::INFINITY }
}
