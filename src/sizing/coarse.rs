//! What the geometry asks for between the vertices of a mesh that is coarser than half the greatest size.
//!
//! Only coarse triangles and ridges are sampled, at about half the greatest size, so the number of samples depends on the surface and not
//! on the mesh. The sizes that are found grow with the distance to the vertices as gradation allows.
use super::curvature::cut;
use super::feature::{Gap, Place};
use super::field::{Asked, Sizing};
use crate::geometry::{Entity, Evaluate, Evaluator, Geometry};
use crate::mesh::vector::{Vec3, add, distance, lerp, scale};
use crate::metric::Sym3;
use crate::tasks::{Rows, Team};

/// Distance of samples, as a share of the greatest size.
const SPACING: f64 = 0.5;
/// Most samples along a side.
const MOST: f64 = 24.0;
/// Triangles or ridges a task.
const TASK: usize = 1 << 6;

/// A metric for a vertex, from a sample between vertices.
#[derive(Clone, Copy)]
struct Sent {
    vertex: u32,
    metric: Sym3,
}

/// What the samples of a piece of the mesh gave.
#[derive(Default)]
struct Found {
    sent: Vec<Sent>,
    samples: usize,
    gap: Option<Gap>,
}

/// Intersects the metrics at the vertices with those of the samples. Returns the number of samples and the nearest gap.
pub fn add_between(team: Team<'_>, sizing: &Sizing, metrics: &mut [Sym3]) -> (usize, Option<Gap>) {
    let (triangles, ridges) = (sizing.mesh.triangles.len(), sizing.place.ridges.len());
    let parts = team.chunks(TASK, triangles + ridges, |range| {
        let mut worker =
            Worker { sizing, evaluator: sizing.model.evaluator(), asked: Asked::default(), found: Found::default() };
        for i in range {
            if i < triangles { worker.look_in(i) } else { worker.look_along(i - triangles) }
        }
        worker.found
    });
    let samples = parts.iter().map(|part| part.samples).sum();
    let nearest = parts.iter().filter_map(|part| part.gap).min_by(|a, b| a.distance.total_cmp(&b.distance));
    let sent: Vec<Sent> = team.join_slices(parts.iter().map(|part| part.sent.as_slice()));
    let at = Rows::by_key(team, metrics.len(), sent.len(), |i| [sent[i].vertex]);
    team.fill(TASK, metrics, |start, metrics| {
        for (vertex, metric) in (start..).zip(metrics) {
            combine(metric, at.row(vertex).iter().map(|&entry| sent[entry as usize].metric));
        }
    });
    (samples, nearest)
}

/// Limits a metric by others, direction by direction, the finest size of all first, and only as far as it is not fine enough yet. (To
/// intersect many ellipsoids of slightly different directions one after the other would give sizes finer than any of them asks for.)
fn combine(metric: &mut Sym3, others: impl Iterator<Item = Sym3>) {
    let mut slabs: Vec<(f64, Vec3)> = others
        .flat_map(|other| {
            let eigen = other.eigen_spd();
            [0, 1, 2].map(|i| (1.0 / eigen.values[i].sqrt(), eigen.vectors[i]))
        })
        .collect();
    slabs.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (size, direction) in slabs {
        *metric = cut(*metric, direction, size);
    }
}

/// One task.
struct Worker<'a> {
    sizing: &'a Sizing<'a>,
    evaluator: Evaluator<'a>,
    asked: Asked,
    found: Found,
}

impl Worker<'_> {
    /// How many samples a side of this length takes; none if it is short.
    fn count(&self, length: f64) -> Option<usize> {
        let count = (length / (SPACING * self.sizing.options.greatest)).min(MOST);
        (count > 1.0).then(|| count.ceil() as usize)
    }

    /// Samples a triangle at the centroids of n² equal parts.
    fn look_in(&mut self, triangle: usize) {
        let nodes = self.sizing.mesh.triangles.nodes[triangle];
        let corners = nodes.map(|v| self.sizing.mesh.vertices[v as usize]);
        let longest = (0..3).map(|i| distance(corners[i], corners[(i + 1) % 3])).fold(0.0, f64::max);
        let Some(n) = self.count(longest) else { return };
        let face = self.sizing.place.faces[triangle];
        let mut guess = None;
        for (i, j) in (0..n).flat_map(|i| (0..n - i).map(move |j| (i, j))) {
            for third in [1.0, 2.0] {
                if third == 2.0 && i + j + 2 > n {
                    continue;
                }
                let [a, b] = [i, j].map(|k| (k as f64 + third / 3.0) / n as f64);
                let at = add(add(scale(corners[0], 1.0 - a - b), scale(corners[1], a)), scale(corners[2], b));
                let on = self.evaluator.closest_on_face(face, at, guess);
                guess = Some(on.uv);
                let entity = Entity::Face(face);
                let place = Place { point: on.point, entity, vertex: None, triangle: Some(triangle as u32) };
                self.ask(&place, on.uv, &nodes);
            }
        }
    }

    /// Samples a ridge at the middles of n equal parts.
    fn look_along(&mut self, ridge: usize) {
        let (nodes, edge) = self.sizing.place.ridges[ridge];
        let [a, b] = nodes.map(|v| self.sizing.mesh.vertices[v as usize]);
        let Some(n) = self.count(distance(a, b)) else { return };
        for i in 0..n {
            let on = self.evaluator.closest_on_edge(edge, lerp(a, b, (i as f64 + 0.5) / n as f64), None);
            let place = Place { point: on.point, entity: Entity::Edge(edge), vertex: None, triangle: None };
            self.ask(&place, [on.t, 0.0], &nodes);
        }
    }

    /// Asks for the metric at a sample and sends it to vertices.
    fn ask(&mut self, place: &Place, parameters: [f64; 2], vertices: &[u32]) {
        if !place.point.iter().all(|x| x.is_finite()) {
            return;
        }
        let (metric, gap) = self.sizing.metric_at(&mut self.evaluator, place, parameters, &mut self.asked);
        self.found.samples += 1;
        if let Some(gap) = gap
            && self.found.gap.is_none_or(|known| gap.distance < known.distance)
        {
            self.found.gap = Some(gap);
        }
        for &vertex in vertices {
            let to = self.sizing.mesh.vertices[vertex as usize];
            let metric = grown(metric, place.point, to, self.sizing.growth);
            self.found.sent.push(Sent { vertex, metric });
        }
    }
}

/// A metric as it may be at a distance: each size h has grown to h + ln r·|pq|.
fn grown(metric: Sym3, from: Vec3, to: Vec3, growth: f64) -> Sym3 {
    let more = growth * distance(from, to);
    metric.map_spd(|value| (1.0 / value.sqrt() + more).powi(-2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_that_point_a_little_apart_are_one() {
        let mut metric = Sym3::IDENTITY.times(0.01);
        let tilted = (-10..=10).map(|i| {
            let (sin, cos) = (0.02 * f64::from(i)).sin_cos();
            Sym3::from_sizes([[sin, 0.0, cos], [cos, 0.0, -sin], [0.0, 1.0, 0.0]], [1.0 + f64::from(i * i), 10.0, 10.0])
        });
        combine(&mut metric, tilted);
        let [_, b, c] = metric.sizes();
        assert!((c - 1.0).abs() < 1e-9 && b > 9.0, "{b} {c}");
    }

    #[test]
    fn sizes_grow_with_the_distance() {
        let metric = Sym3::diagonal(100.0, 4.0, 1.0);
        let [a, b, c] = grown(metric, [0.0; 3], [0.0, 3.0, 4.0], 0.2).sizes();
        assert!((a - 2.0).abs() < 1e-12 && (b - 1.5).abs() < 1e-12 && (c - 1.1).abs() < 1e-12);
    }
}
