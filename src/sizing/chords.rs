//! Sizes along curved walls that straight edges can have.
//!
//! The ends of an edge of the length t along a wall of the radius R lie t²/8R higher than its middle. Where the cells are thinner than that the
//! edge dives through the layers, and no mesh meets the sizes. So the size along each principal direction is cut to a share of √(8 h R), the
//! chord whose sagitta is h, the size across the wall (METHOD.md §1.13).
use super::walls::{Wall, Walls};
use crate::geometry::Model;
use crate::geometry::classify::Classification;
use crate::mesh::vector::{Vec3, dot};
use crate::metric::multiscale::{Cut, SizeBound};
use crate::metric::{Eigen, Sym3};
use crate::tasks::{GRAIN, Team, stage};
use serde::Serialize;
use std::sync::OnceLock;

/// The share of √(8 h R) by default: at it an edge of length 1 along the wall measures 1.4 in the metrics of its ends.
pub const SHARE: f64 = 0.5;

/// Sizes along walls are too long where unit edges dive deep at more than this share of the vertices on curved walls. At a few a mesh meets its metric all
/// the same.
const MANY: f64 = 0.02;

/// A mesh comes near no metric whose unit edges dive through more layers than this. The UGAWG's polar-1 has 2.5, and is met by 95 % of the edges; with 5.1,
/// on a torus, 61 % did.
const DEEP: f64 = 4.0;

/// The metric of the cut has this many times the greatest size across the wall: any size, to rounding.
const FREE: f64 = 1e3;

/// The bound of the sizes along the walls of a model, for the metrics of one mesh. The walls are those of the first metric that it is
/// applied to: others may be scaled, but not be far from it.
pub struct Chords<'a> {
    place: &'a Classification,
    model: &'a Model,
    share: f64,
    walls: OnceLock<Walls>,
}

impl<'a> Chords<'a> {
    /// For a mesh that lies on the model.
    pub fn new(place: &'a Classification, model: &'a Model, share: f64) -> Self {
        Self { place, model, share, walls: OnceLock::new() }
    }
}

impl std::fmt::Debug for Chords<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Chords").field("share", &self.share).finish_non_exhaustive()
    }
}

impl SizeBound for Chords<'_> {
    /// Cuts ln M at each vertex of the mesh, shape (n,).
    fn apply(&self, team: Team<'_>, logs: &mut [Sym3]) -> Cut {
        let walls = self.walls.get_or_init(|| {
            let walls = Walls::near(team, self.place, self.model, logs);
            stage("walls found");
            walls
        });
        let cut = team.map(GRAIN / 4, logs.len(), |v| cut(&logs[v], walls.at(v), self.share));
        let parts = team.chunks(GRAIN, cut.len(), |range| {
            let changed = cut[range.clone()].iter().zip(&logs[range]).filter(|(cut, log)| cut.0 != **log);
            changed.fold(Cut::default(), |all, (cut, _)| all.and(Cut { vertices: 1, greatest: cut.1 }))
        });
        team.fill(GRAIN, logs, |start, logs| (start..).zip(logs).for_each(|(v, log)| *log = cut[v].0));
        parts.into_iter().fold(Cut::default(), Cut::and)
    }
}

/// What is done with sizes along curved walls.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ChordLimit {
    /// They are cut to 0.5 √(8 h R) on a CAD model where no mesh follows its walls with them, and left elsewhere.
    #[default]
    Auto,
    /// They are cut to this share of √(8 h R).
    Share(f64),
    /// They are left.
    Off,
}

impl ChordLimit {
    /// The share that was given.
    pub fn share(self) -> Option<f64> {
        match self {
            Self::Share(share) => Some(share),
            Self::Auto | Self::Off => None,
        }
    }
}

/// What was cut along curved walls.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Limited {
    /// The share of √(8 h R) that the sizes were cut to.
    pub share: f64,
    /// How many, and how much.
    #[serde(flatten)]
    pub cut: Cut,
}

/// How deep unit edges along curved walls dive through the layers there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dive {
    /// Vertices where they dive through more than four layers,
    pub vertices: usize,
    /// of so many on curved walls where sizes differ by direction.
    pub on_walls: usize,
    /// Most layers.
    pub layers: f64,
}

impl Dive {
    /// Whether they are so many that the sizes are to be cut.
    pub fn is_deep(&self) -> bool {
        self.vertices as f64 > MANY * self.on_walls as f64
    }

    fn and(self, other: Self) -> Self {
        Self {
            vertices: self.vertices + other.vertices,
            on_walls: self.on_walls + other.on_walls,
            layers: self.layers.max(other.layers),
        }
    }
}

/// How deep the unit edges of a metric dive, at the vertices on curved walls. For ln M at the vertices of a mesh that lies on the model, shape (n,).
pub fn dive(team: Team<'_>, place: &Classification, model: &Model, logs: &[Sym3]) -> Dive {
    let walls = Walls::below(team, place, model, logs);
    let none = Dive { vertices: 0, on_walls: 0, layers: 0.0 };
    let parts = team.chunks(GRAIN / 4, logs.len(), |range| {
        let layers = range.filter(|&v| !walls.at(v).is_empty()).map(|v| layers(&logs[v], walls.at(v)));
        layers.fold(none, |all, layers| all.and(Dive { vertices: usize::from(layers > DEEP), on_walls: 1, layers }))
    });
    parts.into_iter().fold(none, Dive::and)
}

/// The layers that unit edges dive through: Σ t_i²/(8 h R_i) over the principal directions of a wall, the sagitta of the diagonal of a unit cell over h.
/// The most of these walls.
fn layers(log: &Sym3, walls: &[Wall]) -> f64 {
    let size = sizes(log);
    let near = walls.iter().filter(|wall| wall.is_near(size(wall.normal)));
    let layers = near.map(|wall| {
        let along = longest(wall, size(wall.normal), 1.0);
        (0..2).map(|i| (size(wall.directions[i]) / along[i]).powi(2)).sum()
    });
    layers.fold(0.0, f64::max)
}

/// The size that a metric has in a direction.
fn sizes(log: &Sym3) -> impl Fn(Vec3) -> f64 {
    let eigen = log.eigen();
    move |direction| {
        let part = |i: usize| (0.5 * eigen.values[i]).exp() * dot(eigen.vectors[i], direction);
        part(0).hypot(part(1)).hypot(part(2)).recip()
    }
}

/// The longest sizes along a wall, by its principal directions. Cells that are as long as thick follow any wall.
fn longest(wall: &Wall, across: f64, share: f64) -> [f64; 2] {
    wall.radii.map(|radius| (share * (8.0 * across * radius).sqrt()).max(across))
}

/// ln M, cut along these walls, and by what factor at most. No size grows, and the size along the normal of a wall stays: what is intersected is
/// Σ e_i e_iᵀ/t_i² over the principal directions, so only multiples of these directions are added to M.
fn cut(log: &Sym3, walls: &[Wall], share: f64) -> (Sym3, f64) {
    let (mut all, mut factor) = (*log, 1.0);
    if walls.is_empty() {
        return (all, factor);
    }
    let greatest = (-0.5 * log.eigen().values[0]).exp();
    let size = sizes(log);
    for wall in walls {
        let across = size(wall.normal);
        let along = longest(wall, across, share);
        if !wall.is_near(across) || along.iter().all(|&along| along >= greatest) {
            continue;
        }
        let free = FREE * greatest;
        let [first, second] = wall.directions;
        let values = [along[0].min(free), along[1].min(free), free].map(|h| -2.0 * h.ln());
        all = all.intersect_logs(&Sym3::from_eigen(&Eigen { values, vectors: [first, second, wall.normal] }));
        factor = (0..2).fold(factor, |most, i| (size(wall.directions[i]) / along[i]).max(most));
    }
    (all, factor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Discrete;
    use crate::mesh::TetMesh;
    use crate::mesh::samples::cube;

    const AXES: [Vec3; 3] = [[0.36, 0.48, 0.8], [-0.8, 0.6, 0.0], [-0.48, -0.64, 0.6]];

    /// ln of the metric with these sizes along the axes.
    fn log_of(axes: [Vec3; 3], sizes: [f64; 3]) -> Sym3 {
        Sym3::from_eigen(&Eigen { values: sizes.map(|h| -2.0 * h.ln()), vectors: axes })
    }

    fn size(log: &Sym3, direction: Vec3) -> f64 {
        let eigen = log.eigen();
        let part = |i: usize| (0.5 * eigen.values[i]).exp() * dot(eigen.vectors[i], direction);
        part(0).hypot(part(1)).hypot(part(2)).recip()
    }

    fn is_near(a: f64, b: f64) -> bool {
        (a / b - 1.0).abs() < 1e-9
    }

    #[test]
    fn the_size_about_a_cylinder_is_cut_and_the_others_stay() {
        let [normal, around, along] = AXES;
        for h in [1e-2, 1e-4, 1e-6, 1e-8] {
            let log = log_of(AXES, [h, 0.1, 0.2]);
            let wall = Wall::through(normal, [around, along], [0.5, f64::INFINITY]);
            let expected = 0.5 * (8.0 * h * 0.5_f64).sqrt();
            let (found, factor) = cut(&log, &[wall], 0.5);
            let sizes = AXES.map(|axis| size(&found, axis));
            let all = [h, expected.min(0.1), 0.2];
            assert!(sizes.iter().zip(all).all(|(&size, expected)| is_near(size, expected)), "{h}: {sizes:?}");
            assert!(is_near(factor, (0.1 / expected).max(1.0)), "{h}: {factor}");
            assert!(
                cut(&found, &[wall], 0.5).0 == found || is_near(cut(&found, &[wall], 0.5).1, 1.0),
                "once is enough"
            );
        }
    }

    /// Where the thin direction leans from the normal, the size along the normal stays too, and no size grows.
    #[test]
    fn the_size_across_stays_where_the_metric_leans() {
        let [normal, around, along] = AXES;
        for lean in [1e-3_f64, 0.02, 0.3] {
            let (sin, cos) = lean.sin_cos();
            let turned = |a: Vec3, b: Vec3, s: f64| -> Vec3 { std::array::from_fn(|i| cos * a[i] + s * sin * b[i]) };
            let log = log_of([turned(normal, around, 1.0), turned(around, normal, -1.0), along], [1e-4, 0.1, 0.1]);
            let wall = Wall::through(normal, [around, along], [0.5, 0.02]);
            let (found, _) = cut(&log, &[wall], 0.5);
            assert!(is_near(size(&found, normal), size(&log, normal)), "{lean}");
            let across = size(&log, normal);
            for (direction, radius) in [(around, 0.5), (along, 0.02)] {
                assert!(size(&found, direction) <= 0.5 * (8.0 * across * radius).sqrt() * (1.0 + 1e-9), "{lean}");
            }
            for i in 0..50 {
                let [a, b] = [1.7, 2.3].map(|k| k * f64::from(i));
                let direction = [a.sin() * b.cos(), a.sin() * b.sin(), a.cos()];
                assert!(size(&found, direction) <= size(&log, direction) * (1.0 + 1e-9), "{lean}");
            }
        }
    }

    #[test]
    fn nothing_is_cut_where_nothing_dives() {
        let [normal, around, along] = AXES;
        let wall = |radius| Wall::through(normal, [around, along], [radius, f64::INFINITY]);
        // Nearly a plane, short cells, and cells that are thin along the wall.
        for (sizes, radius) in [([1e-3, 0.1, 0.1], 1e3), ([1e-3, 0.02, 0.2], 0.5), ([0.1, 1e-3, 0.1], 0.02)] {
            let log = log_of(AXES, sizes);
            let (found, factor) = cut(&log, &[wall(radius)], 0.5);
            assert!((0..6).all(|i| (found.0[i] - log.0[i]).abs() < 1e-9) && factor == 1.0, "{sizes:?}");
        }
        // At an axis cells are cut to their size across at most.
        let (found, _) = cut(&log_of(AXES, [1e-3, 0.1, 0.1]), &[wall(0.0)], 0.5);
        assert!(is_near(size(&found, around), 1e-3) && is_near(size(&found, along), 0.1));
    }

    /// The cube bent about an axis: x is the angle, y the height, z the distance from the inner wall of the radius 1; the outer one has 2.
    fn bent() -> TetMesh {
        let mut mesh = cube(12);
        mesh.vertices.iter_mut().for_each(|p| {
            let ((sin, cos), radius) = (p[0].sin_cos(), 1.0 + p[2]);
            *p = [radius * sin, p[1], radius * cos];
        });
        mesh
    }

    /// Sizes across, about and along the axis before and after, at the vertices away from the sides.
    fn cut_bent(across: f64) -> (Vec<(f64, [f64; 3])>, Cut) {
        let mesh = bent();
        let (model, place) = Discrete::from_mesh(Team::alone(), &mesh, 20.0).unwrap();
        let model = Model::Discrete(model);
        let frame = |p: Vec3| {
            let r = p[0].hypot(p[2]);
            ([[p[0] / r, 0.0, p[2] / r], [p[2] / r, 0.0, -p[0] / r], [0.0, 1.0, 0.0]], r)
        };
        let mut logs: Vec<Sym3> = mesh.vertices.iter().map(|&p| log_of(frame(p).0, [across, 0.5, 0.5])).collect();
        let found = Chords::new(&place, &model, 0.5).apply(Team::alone(), &mut logs);
        let is_inner = |p: &Vec3| (0.2..0.8).contains(&p[1]) && (0.2..0.8).contains(&p[0].atan2(p[2]));
        let inner = mesh.vertices.iter().zip(&logs).filter(|(p, _)| is_inner(p));
        let told = inner.map(|(&p, log)| {
            let (axes, r) = frame(p);
            (r, axes.map(|axis| size(log, axis)))
        });
        (told.collect(), found)
    }

    /// Convex towards the mesh inside, concave outside: the parallel surface at a vertex has its distance from the axis as its radius.
    #[test]
    fn surfaces_parallel_to_walls_have_the_radius_of_the_vertex() {
        let (found, told) = cut_bent(0.01);
        assert!(found.len() > 200);
        for (r, [across, about, along]) in found {
            let expected = 0.5 * (8.0 * 0.01 * r).sqrt();
            assert!(
                (across / 0.01 - 1.0).abs() < 1e-3 && (about / expected - 1.0).abs() < 0.03,
                "{r} {across} {about}"
            );
            assert!(along > 0.45, "{r} {along}");
        }
        assert!(told.vertices > 1000 && (3.4..3.7).contains(&told.greatest), "{told:?}");
    }

    /// Edges of 0.5 about the axis, and cells of 0.005 on a wall of the radius 1: they rise by 0.03125. Only the walls count that a vertex lies on.
    #[test]
    fn unit_edges_dive_through_layers_at_the_vertices_on_walls() {
        let mesh = bent();
        let (model, place) = Discrete::from_mesh(Team::alone(), &mesh, 20.0).unwrap();
        let model = Model::Discrete(model);
        let told = |about: f64| {
            let of = |p: &Vec3| {
                let r = p[0].hypot(p[2]);
                let axes = [[p[0] / r, 0.0, p[2] / r], [p[2] / r, 0.0, -p[0] / r], [0.0, 1.0, 0.0]];
                log_of(axes, [0.005, about, 0.5])
            };
            let logs: Vec<Sym3> = mesh.vertices.iter().map(of).collect();
            dive(Team::alone(), &place, &model, &logs)
        };
        let radii = || mesh.vertices.iter().map(|p| p[2].hypot(p[0]));
        let [inner, outer] = [radii().filter(|r| *r < 1.001).count(), radii().filter(|r| *r > 1.999).count()];
        let found = told(0.5);
        assert_eq!([found.vertices, found.on_walls], [inner, inner + outer]);
        assert!((6.0..6.6).contains(&found.layers), "{found:?}");
        let found = told(0.25);
        assert_eq!([found.vertices, found.on_walls], [0, inner + outer]);
        assert!((1.5..1.65).contains(&found.layers), "{found:?}");
    }

    /// Both directions count, each with its radius; none of them more than cells that are as long as thick.
    #[test]
    fn the_diagonal_of_a_cell_rises_by_both_curvatures() {
        let [normal, around, along] = AXES;
        let log = log_of(AXES, [1e-3, 0.1, 0.2]);
        let told = |radii| layers(&log, &[Wall::through(normal, [around, along], radii)]);
        assert!(is_near(told([0.5, f64::INFINITY]), 0.01 / (8.0 * 1e-3 * 0.5)));
        assert!(is_near(told([0.5, 2.0]), 0.01 / (8.0 * 1e-3 * 0.5) + 0.04 / (8.0 * 1e-3 * 2.0)));
        assert!(is_near(told([0.0, f64::INFINITY]), 1e4));
        assert_eq!(layers(&log, &[]), 0.0);
    }

    #[test]
    fn walls_that_are_more_than_a_hundred_cells_away_count_no_more() {
        let (found, _) = cut_bent(1e-3);
        for (r, [_, about, _]) in found {
            let is_cut = about < 0.4;
            assert_eq!(is_cut, (r - 1.0).min(2.0 - r) < 0.1, "{r} {about}");
        }
    }

    #[test]
    fn planes_cut_nothing() {
        let mesh = cube(3);
        let (model, place) = Discrete::from_mesh(Team::alone(), &mesh, 20.0).unwrap();
        let model = Model::Discrete(model);
        let before =
            vec![log_of([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [1e-5, 0.3, 0.3]); mesh.vertices.len()];
        let mut logs = before.clone();
        assert_eq!(Chords::new(&place, &model, 0.5).apply(Team::alone(), &mut logs), Cut::default());
        assert_eq!(logs, before);
    }

    #[test]
    fn threads_change_nothing() {
        let mesh = bent();
        let (model, place) = Discrete::from_mesh(Team::alone(), &mesh, 20.0).unwrap();
        let model = Model::Discrete(model);
        let of = |team: Team<'_>| {
            let mut logs: Vec<Sym3> =
                mesh.vertices.iter().map(|p| log_of(AXES, [1e-2 * (1.1 + p[1]), 0.3, 0.4])).collect();
            let cut = Chords::new(&place, &model, 0.5).apply(team, &mut logs);
            (logs, cut)
        };
        let pool = crate::tasks::Pool::new(3).unwrap();
        assert_eq!(of(Team::alone()), of(Team::new(&pool, crate::tasks::Plan::default())));
    }
}
