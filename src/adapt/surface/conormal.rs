//! Where a curved face crosses thin layers of the metric: distances and angles there are measured along the conormal M⁻¹n, n the normal.
//!
//! A chord within a layer rises by s over the face. Along n that is s/h layers of thickness h, though in its own layer, where sizes are
//! large, it is little (docs/decisions/surface.md).
use crate::mesh::vector::{Vec3, dot};
use crate::metric::{Sym3, plane_basis};

/// A face crosses layers where the square of the metric's extent along its normal is more than this many times that of the least size along it.
const CROSSED: f64 = 25.0;

/// It does not where the trace of M⁻¹ is more than this many times the square of that extent: there layers lie nearly along it.
const SHALLOW: f64 = 100.0;

/// A layer runs through several vertices where the traces of their metrics, 1/h² of its thickness, differ by no more than this factor.
const ALIKE: f64 = 1000.0;

/// The metric beside a face, as seen along its normal n.
#[derive(Clone, Copy, Debug)]
pub struct Conormal {
    /// M.
    metric: Sym3,
    /// M⁻¹n.
    way: Vec3,
    /// nᵀM⁻¹n, the square of the unit ellipsoid's extent along n.
    square: f64,
}

/// The mean of the metrics of vertices; none where no layer can run through them all.
pub fn metric_of_layer(metrics: impl ExactSizeIterator<Item = Sym3> + Clone) -> Option<Sym3> {
    let share = 1.0 / metrics.len() as f64;
    let (least, most) = metrics
        .clone()
        .map(|metric| metric.trace())
        .fold((f64::INFINITY, 0.0_f64), |(least, most), trace| (least.min(trace), most.max(trace)));
    (most <= ALIKE * least).then(|| metrics.fold(Sym3::ZERO, |sum, metric| sum.plus(metric.times(share))))
}

impl Conormal {
    /// That of a metric and a unit normal, if a face with this normal crosses layers.
    pub fn of_face(metric: &Sym3, normal: Vec3) -> Option<Self> {
        let (x, y) = plane_basis(normal);
        let (a, b, c) = (metric.quadratic(x), dot(x, metric.apply(y)), metric.quadratic(y));
        Self::where_crossed(metric, normal, 0.5 * (a + c + (a - c).hypot(2.0 * b)))
    }

    /// That of an edge of the model with this unit tangent, for a unit vector normal to it.
    pub fn of_edge(metric: &Sym3, tangent: Vec3, normal: Vec3) -> Option<Self> {
        Self::where_crossed(metric, normal, metric.quadratic(tangent))
    }

    /// `finest` is 1/h², h the least size along the entity.
    fn where_crossed(metric: &Sym3, normal: Vec3, finest: f64) -> Option<Self> {
        let way = metric.solve(normal);
        let square = dot(normal, way);
        let is_crossed = square * finest > CROSSED && inverse_trace(metric) <= SHALLOW * square;
        is_crossed.then_some(Self { metric: *metric, way, square })
    }

    /// The distance in the metric of a plane with the normal n at this distance in space.
    pub fn length(&self, distance: f64) -> f64 {
        distance.abs() / self.square.sqrt()
    }

    /// The way, to that plane, to the point that is nearest in the metric.
    pub fn step(&self, distance: f64) -> Vec3 {
        self.way.map(|x| x * distance / self.square)
    }

    /// The cosine, in unit space, between n and another normal of any length.
    pub fn cosine(&self, other: Vec3) -> f64 {
        dot(other, self.way) / (self.square * dot(other, self.metric.solve(other))).sqrt()
    }
}

/// tr M⁻¹, the sum of the squares of the sizes.
fn inverse_trace(metric: &Sym3) -> f64 {
    (0..3).map(|i| metric.solve(std::array::from_fn(|k| f64::from(u8::from(k == i))))[i]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::vector::{add, cross, norm, sub, unit};

    const NORMAL: Vec3 = [0.6, 0.0, 0.8];

    /// Layers along z, a thousandth across.
    fn layers() -> Sym3 {
        Sym3::from_sizes([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.1, 0.1, 1e-4])
    }

    #[test]
    fn a_face_crosses_what_does_not_lie_along_it() {
        let crosses = |degrees: f64| {
            let (s, c) = degrees.to_radians().sin_cos();
            Conormal::of_face(&layers(), [s, 0.0, c]).is_some()
        };
        // Of a face that leans by 5 degrees the layers lie along it, though a chord's rise may be more than they are thick.
        assert_eq!([0.0, 5.0, 10.0, 45.0, 90.0].map(crosses), [false, false, true, true, true]);
        assert!(Conormal::of_face(&Sym3::diagonal(4.0, 4.0, 4.0), NORMAL).is_none());
        // Of a face that crosses them uprightly the edges of the model along the layers do not.
        let upright = [1.0, 0.0, 0.0];
        assert!(Conormal::of_edge(&layers(), [0.0, 1.0, 0.0], upright).is_none());
        assert!(Conormal::of_edge(&layers(), [0.0, 0.0, 1.0], upright).is_some());
    }

    #[test]
    fn no_layer_runs_through_vertices_whose_metrics_have_nothing_in_common() {
        let [thin, thick, coarse] = [layers(), layers().times(1.0 / 900.0), Sym3::IDENTITY];
        let mean = metric_of_layer([thin, thick].into_iter()).unwrap();
        assert!((mean.at(2, 2) / thin.at(2, 2) - 0.5 * (1.0 + 1.0 / 900.0)).abs() < 1e-12);
        assert_eq!(metric_of_layer([thin, thin, coarse].into_iter()), None);
    }

    #[test]
    fn the_step_leads_to_the_nearest_point_of_a_plane() {
        let (metric, distance) = (layers(), 0.01);
        let conormal = Conormal::of_face(&metric, NORMAL).unwrap();
        let step = conormal.step(distance);
        assert!((dot(step, NORMAL) - distance).abs() < 1e-15);
        let length = |way: Vec3| metric.quadratic(way).sqrt();
        assert!((length(step) / conormal.length(-distance) - 1.0).abs() < 1e-9);
        let (x, y) = plane_basis(NORMAL);
        for beside in [x, y, x.map(|c| -c), y.map(|c| -c)] {
            assert!(length(add(step, beside.map(|c| 1e-4 * c))) > length(step));
        }
        // In its own layer, where the closest point is 80 away.
        assert!(length(step) < 0.2 && length(NORMAL.map(|c| c * distance)) > 50.0);
    }

    #[test]
    fn the_angle_is_that_of_unit_space() {
        let (metric, other) = (layers(), unit([0.5, 0.3, -0.7]));
        let conormal = Conormal::of_face(&metric, NORMAL).unwrap();
        let root = metric.sqrt();
        let seen = |normal: Vec3| {
            let (x, y) = plane_basis(normal);
            unit(cross(root.apply(x), root.apply(y)))
        };
        let expected = dot(seen(NORMAL), seen(other));
        assert!((conormal.cosine(other.map(|c| 3.0 * c)) - expected).abs() < 1e-6, "{expected}");
        assert!(norm(sub(seen(NORMAL), NORMAL)) > 0.5 && expected > 0.5 && dot(NORMAL, other) < 0.0);
    }
}
