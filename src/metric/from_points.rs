//! A metric from the density of a cloud of points.
use super::Sym3;
use super::ellipsoid::smallest_about_origin;
use crate::mesh::box_tree::BoxTree;
use crate::mesh::vector::{Vec3, dot, scale, sub};
use crate::tasks::Team;

/// Half-axes are raised to at least this share of the greatest distance: points may lie in a plane, on a line, or in one place.
const THINNEST: f64 = 1e-3;

/// Vertices a task: one takes tens of microseconds.
const FEW: usize = 1 << 6;

/// Why there is no metric.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooFew {
    /// Points that differ from each other.
    pub distinct: usize,
}

/// A metric from points.
pub struct FromPoints {
    /// ln M at the vertices, shape (n,).
    pub logs: Vec<Sym3>,
    /// Points that repeat another one, which were left out.
    pub duplicates: usize,
    /// Vertices whose neighbours lie nearly in a plane or on a line, so that half-axes were raised.
    pub flat: usize,
}

/// At each vertex the metric whose unit ball is the smallest ellipsoid about the vertex that holds its `neighbours` ≥ 2 nearest
/// points. No half-axis is below 1e-3 of the distance to the farthest of them, so that all are positive definite.
///
/// # Errors
/// [`TooFew`] when fewer points differ than neighbours are asked for.
pub fn from_points(
    team: Team<'_>,
    vertices: &[Vec3],
    points: &[Vec3],
    neighbours: usize,
) -> Result<FromPoints, TooFew> {
    let mut cloud = points.to_vec();
    let order = |a: &Vec3, b: &Vec3| {
        (0..3).map(|i| a[i].total_cmp(&b[i])).find(|o| o.is_ne()).unwrap_or(std::cmp::Ordering::Equal)
    };
    // −0 is 0.
    cloud.iter_mut().flatten().for_each(|x| *x += 0.0);
    team.sort_by(&mut cloud, order);
    cloud.dedup();
    let neighbours = neighbours.max(2);
    if cloud.len() < neighbours {
        return Err(TooFew { distinct: cloud.len() });
    }
    let tree = BoxTree::new(cloud.len(), |i| [cloud[i as usize]; 2]);
    let parts = team.chunks(FEW, vertices.len(), |range| {
        let mut search =
            Search { cloud: &cloud, tree: &tree, nearest: Vec::new(), around: Vec::new(), weights: Vec::new() };
        let mut flat = 0;
        let mut logs = Vec::with_capacity(range.len());
        for &vertex in &vertices[range] {
            let (log, is_flat) = search.log_at(vertex, neighbours);
            flat += usize::from(is_flat);
            logs.push(log);
        }
        (logs, flat)
    });
    let flat = parts.iter().map(|part| part.1).sum();
    let logs = team.join(parts.into_iter().map(|part| part.0).collect());
    Ok(FromPoints { logs, duplicates: points.len() - cloud.len(), flat })
}

/// Room of a task.
struct Search<'c> {
    cloud: &'c [Vec3],
    tree: &'c BoxTree,
    /// Squared distance and point, ascending.
    nearest: Vec<(f64, u32)>,
    around: Vec<Vec3>,
    weights: Vec<f64>,
}

impl Search<'_> {
    /// ln M at a place, and whether its points are in a plane.
    fn log_at(&mut self, vertex: Vec3, neighbours: usize) -> (Sym3, bool) {
        let Self { cloud, tree, nearest, around, weights } = self;
        nearest.clear();
        tree.nearest(vertex, f64::INFINITY, |item| {
            let away = sub(cloud[item as usize], vertex);
            let entry = (dot(away, away), item);
            let at = nearest.partition_point(|other| *other < entry);
            if at < neighbours {
                nearest.truncate(neighbours - 1);
                nearest.insert(at, entry);
            }
            if nearest.len() == neighbours { nearest[neighbours - 1].0 } else { f64::INFINITY }
        });
        // Two different points are not both at the vertex. Should their squares underflow, the least size is taken.
        let radius = nearest.last().map_or(0.0, |entry| entry.0.sqrt()).max(1e-150);
        around.clear();
        around.extend(nearest.iter().map(|entry| scale(sub(cloud[entry.1 as usize], vertex), 1.0 / radius)));
        let axes = [[THINNEST, 0.0, 0.0], [0.0, THINNEST, 0.0], [0.0, 0.0, THINNEST]];
        // An octahedron stands for the ball of the thinnest half-axis; it is too small by √3 at most.
        around.extend(axes);
        let ball = Sym3::IDENTITY;
        let log = smallest_about_origin(around, weights).unwrap_or(ball).ln();
        let flat = log.eigen().values[2] > -2.0 * (2.0 * THINNEST).ln();
        (log.plus_identity(-2.0 * radius.ln()), flat)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tasks::{Plan, Pool};

    fn grid(n: i32, h: Vec3) -> Vec<Vec3> {
        let side = 2 * n + 1;
        let place = |i: i32| [i / (side * side) - n, i / side % side - n, i % side - n];
        (0..side * side * side).map(|i| std::array::from_fn(|axis| h[axis] * f64::from(place(i)[axis]))).collect()
    }

    #[test]
    fn the_nearest_of_a_grid() {
        // Seven nearest of the origin in a cubic grid: itself and its six neighbours.
        let points = grid(3, [0.1; 3]);
        let found = from_points(Team::alone(), &[[0.0; 3]], &points, 7).unwrap();
        let sizes = found.logs[0].exp().sizes();
        assert!(sizes.iter().all(|h| (h / 0.1 - 1.0).abs() < 1e-3), "{sizes:?}");
        assert_eq!((found.duplicates, found.flat), (0, 0));
    }

    #[test]
    fn degenerate_clouds_have_a_metric_or_are_refused() {
        let plane: Vec<Vec3> = grid(4, [0.1, 0.1, 0.0]);
        let found = from_points(Team::alone(), &[[0.0; 3], [0.05, 0.02, 0.0]], &plane, 9).unwrap();
        assert_eq!((found.flat, found.duplicates), (2, 729 - 81));
        for log in &found.logs {
            let m = log.exp();
            assert!(m.is_spd() && m.sizes()[0] / m.sizes()[2] > 100.0, "{m:?}");
        }
        assert_eq!(from_points(Team::alone(), &[[0.0; 3]], &[[1.0; 3]; 50], 8).err(), Some(TooFew { distinct: 1 }));
        let line: Vec<Vec3> = (0..20).map(|i| [0.1 * f64::from(i), 0.0, 0.0]).collect();
        assert!(from_points(Team::alone(), &[[0.5, 0.0, 0.0]], &line, 6).unwrap().logs[0].exp().is_spd());
    }

    #[test]
    fn any_number_of_threads_gives_the_same_bits() {
        let points = grid(5, [0.11, 0.07, 0.2]);
        let vertices: Vec<Vec3> = grid(4, [0.05, 0.06, 0.07]);
        let alone = from_points(Team::alone(), &vertices, &points, 12).unwrap().logs;
        let pool = Pool::new(3).unwrap();
        assert_eq!(from_points(Team::new(&pool, Plan::default()), &vertices, &points, 12).unwrap().logs, alone);
    }
}
