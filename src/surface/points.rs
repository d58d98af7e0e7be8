//! The points of vertices and edges, numbered once for all faces.
use super::twins::Twins;
use crate::geometry::{Evaluate, Geometry, OcctEvaluator, OcctModel};
use crate::mesh::vector::{Vec3, distance};

/// What a point of the surface lies on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// A vertex of the model.
    Vertex(u32),
    /// An edge, at a parameter.
    Edge(u32, f64),
    /// A face, at parameters.
    Face(u32, [f64; 2]),
}

/// Points of the vertices, then of the insides of the edges, one edge after another.
#[derive(Clone, Debug, Default)]
pub struct Points {
    /// Coordinates.
    pub at: Vec<Vec3>,
    /// What each lies on.
    pub places: Vec<Place>,
    vertices: Vec<u32>,
    parameters: Vec<Vec<f64>>,
    chains: Vec<Vec<u32>>,
    twins: Twins,
}

impl Points {
    /// Numbers the points of edges that are divided at parameters; twins have the coordinates of the one that they follow.
    pub fn new(model: &OcctModel, mut parameters: Vec<Vec<f64>>, twins: Twins) -> Self {
        let topology = model.topology();
        let mut on = model.evaluator();
        let mut points = Self { chains: vec![Vec::new(); parameters.len()], twins, ..Self::default() };
        for i in 0..topology.vertices.len() {
            let at = topology.vertices[points.twins.first[i] as usize].point;
            let id = points.add(at, Place::Vertex(i as u32));
            points.vertices.push(id);
        }
        // Those that lead first.
        let count = parameters.len();
        let leads = |points: &Self, edge: usize| points.twins.follows[edge].is_none();
        let order: Vec<usize> =
            (0..count).filter(|&e| leads(&points, e)).chain((0..count).filter(|&e| !leads(&points, e))).collect();
        for edge in order {
            let mut spots: Option<Vec<Vec3>> = None;
            if let Some((other, is_against)) = points.twins.follows[edge] {
                let mut at: Vec<Vec3> = points.chains[other as usize].iter().map(|&p| points.at[p as usize]).collect();
                if is_against {
                    at.reverse();
                }
                match followed(&mut on, edge as u32, topology.edges[edge].range, &at) {
                    Some(t) => (parameters[edge], spots) = (t, Some(at)),
                    None => points.twins.follows[edge] = None,
                }
            }
            points.number(&mut on, edge, topology.edges[edge].vertices, &parameters[edge], spots);
        }
        points.parameters = parameters;
        points
    }

    fn number(
        &mut self,
        on: &mut OcctEvaluator,
        edge: usize,
        ends: [Option<u32>; 2],
        t: &[f64],
        spots: Option<Vec<Vec3>>,
    ) {
        let mut chain = Vec::with_capacity(t.len());
        for (k, &t_k) in t.iter().enumerate() {
            let (is_first, is_last) = (k == 0, k + 1 == t.len());
            let id = match ends {
                [Some(v), _] if is_first => self.vertices[v as usize],
                [_, Some(v)] if is_last => self.vertices[v as usize],
                // Closed, without a vertex.
                [_, None] if is_last && !chain.is_empty() => chain[0],
                _ => {
                    let at = spots.as_ref().map_or_else(|| on.edge_frame(edge as u32, t_k).point, |spots| spots[k]);
                    self.add(at, Place::Edge(edge as u32, t_k))
                }
            };
            chain.push(id);
        }
        self.chains[edge] = chain;
    }

    fn add(&mut self, at: Vec3, place: Place) -> u32 {
        self.at.push(at);
        self.places.push(place);
        self.at.len() as u32 - 1
    }

    /// The point of a vertex.
    pub fn of_vertex(&self, vertex: u32) -> u32 {
        self.vertices[vertex as usize]
    }

    /// Where an edge is divided.
    pub fn parameters(&self, edge: u32) -> &[f64] {
        &self.parameters[edge as usize]
    }

    /// The points along an edge.
    pub fn chain(&self, edge: u32) -> Vec<u32> {
        self.chains[edge as usize].clone()
    }

    /// All chains, edge by edge.
    pub fn chains(&self) -> &[Vec<u32>] {
        &self.chains
    }

    /// Halves some pieces (edge, piece), and those beside them that are then far longer; none shorter than `least`. The edges that have
    /// changed.
    pub fn halve(&mut self, model: &OcctModel, pieces: &[(u32, u32)], least: f64) -> Vec<u32> {
        let mut on = model.evaluator();
        let mut touched = Vec::new();
        let count = |edge: u32| self.chains[edge as usize].len().saturating_sub(1);
        let mut pieces: Vec<(u32, u32)> = pieces.iter().map(|&(e, p)| self.twins.leader(e, p, count(e))).collect();
        pieces.sort_unstable();
        pieces.dedup();
        for group in pieces.chunk_by(|a, b| a.0 == b.0) {
            let edge = group[0].0;
            let mut is_cut = self.cuts(group, &self.chains[edge as usize], least);
            let mut spots = self.cut(&mut on, edge, &is_cut, None);
            if spots.is_empty() {
                continue;
            }
            touched.push(edge);
            let mut is_turned = false;
            for other in 0..self.chains.len() as u32 {
                if let Some((of, is_against)) = self.twins.follows[other as usize]
                    && of == edge
                {
                    if is_against != is_turned {
                        is_cut.reverse();
                        spots.reverse();
                        is_turned = is_against;
                    }
                    self.cut(&mut on, other, &is_cut, Some(&spots));
                    touched.push(other);
                }
            }
        }
        touched
    }

    /// Cuts pieces of one edge in their middle, or at points; these points.
    fn cut(&mut self, on: &mut OcctEvaluator, edge: u32, is_cut: &[bool], spots: Option<&[Vec3]>) -> Vec<Vec3> {
        let (old, chain) = (self.parameters[edge as usize].clone(), self.chains[edge as usize].clone());
        let (mut t, mut ids) = (Vec::with_capacity(2 * old.len()), Vec::with_capacity(2 * old.len()));
        let mut new = Vec::new();
        for k in 0..old.len() {
            t.push(old[k]);
            ids.push(chain[k]);
            if k + 1 < old.len() && is_cut.get(k) == Some(&true) {
                let mut middle = 0.5 * (old[k] + old[k + 1]);
                let at = match spots.and_then(|spots| spots.get(new.len())) {
                    Some(&at) => {
                        let foot = on.closest_on_edge(edge, at, Some(middle)).t;
                        if foot > old[k] && foot < old[k + 1] {
                            middle = foot;
                        }
                        at
                    }
                    None => on.edge_frame(edge, middle).point,
                };
                if middle > old[k] && middle < old[k + 1] {
                    t.push(middle);
                    ids.push(self.add(at, Place::Edge(edge, middle)));
                    new.push(at);
                }
            }
        }
        if !new.is_empty() {
            self.parameters[edge as usize] = t;
            self.chains[edge as usize] = ids;
        }
        new
    }

    /// Which pieces of one edge to cut.
    fn cuts(&self, group: &[(u32, u32)], chain: &[u32], least: f64) -> Vec<bool> {
        let mut is_cut = vec![false; chain.len().saturating_sub(1)];
        let length = |k: usize| distance(self.at[chain[k] as usize], self.at[chain[k + 1] as usize]);
        for &(_, piece) in group {
            let k = piece as usize;
            if k < is_cut.len() && length(k) > least {
                is_cut[k] = true;
            }
        }
        let now = |is_cut: &[bool], k: usize| length(k) * if is_cut[k] { 0.5 } else { 1.0 };
        for _ in 0..3 {
            for k in 0..is_cut.len() {
                let beside = [k.checked_sub(1), Some(k + 1).filter(|&j| j < is_cut.len())];
                let shortest = beside.into_iter().flatten().map(|j| now(&is_cut, j)).fold(f64::INFINITY, f64::min);
                is_cut[k] |= now(&is_cut, k) > 2.5 * shortest.max(least);
            }
        }
        is_cut
    }

    /// Length of a piece; zero where there is none.
    pub fn length(&self, edge: u32, piece: u32) -> f64 {
        let Some(chain) = self.chains.get(edge as usize) else { return 0.0 };
        match (chain.get(piece as usize), chain.get(piece as usize + 1)) {
            (Some(&a), Some(&b)) => distance(self.at[a as usize], self.at[b as usize]),
            _ => 0.0,
        }
    }
}

/// Parameters of points along an edge, its ends exact; none where they do not rise.
fn followed(on: &mut OcctEvaluator, edge: u32, [from, to]: [f64; 2], at: &[Vec3]) -> Option<Vec<f64>> {
    let last = at.len().checked_sub(1)?;
    let mut t: Vec<f64> = at.iter().map(|&p| on.closest_on_edge(edge, p, None).t).collect();
    (t[0], t[last]) = (from, to);
    (last > 0 && t.windows(2).all(|w| w[0] < w[1])).then_some(t)
}
