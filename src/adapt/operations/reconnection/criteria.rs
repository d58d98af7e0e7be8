//! What makes one triangulation of a cavity better than another: the criteria of local reconnection (METHOD.md §2.3).
use crate::adapt::core::access::Access;
use crate::adapt::core::ids::{TetId, VertexId};
use crate::adapt::core::worker::Worker;
use crate::mesh::predicate::is_positive;
use crate::mesh::vector::{Vec3, add, cross, dot, scale, sub, volume6};
use crate::metric::Sym3;
use serde::Serialize;

/// A criterion of reconnection.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Criterion {
    /// No vertex of the cavity inside the circumsphere, measured in five metrics (anisotropic Delaunay).
    Delaunay,
    /// Least greatest Laplacian edge weight (max-min).
    EdgeWeight,
    /// Least Σ (1/Q − 1) of the mean ratios Q: all tetrahedra count, the worst most.
    MeanRatio,
}

impl Criterion {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Delaunay, Self::EdgeWeight, Self::MeanRatio];

    /// As the command line spells it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Delaunay => "delaunay",
            Self::EdgeWeight => "edge-weight",
            Self::MeanRatio => "mean-ratio",
        }
    }

    /// The score of a triangulation, from those of its two parts.
    #[inline(always)]
    pub fn join(self, x: f64, y: f64) -> f64 {
        if self == Self::MeanRatio { x + y } else { x.min(y) }
    }

    /// The score of no tetrahedra.
    #[inline(always)]
    pub fn nothing(self) -> f64 {
        if self == Self::MeanRatio { 0.0 } else { f64::INFINITY }
    }
}

/// Score of a tetrahedron by [`Criterion::MeanRatio`]: 1 − 1/Q, −∞ when it is not positive.
#[inline(always)]
pub fn mean_ratio_score(quality: f64) -> f64 {
    if quality > 0.0 { 1.0 - 1.0 / quality } else { f64::NEG_INFINITY }
}

/// A triangulation must be better by this share of its score. So rounding does not make flips go back and forth.
const GAIN: f64 = 1e-3;

/// What a triangulation must score to replace one that scores `old`. Any score will do where the old one is infinite.
pub fn wanted_score(old: f64) -> f64 {
    if old.is_finite() { old + GAIN * old.abs().max(GAIN) } else { f64::MIN }
}

impl<A: Access> Worker<'_, '_, A> {
    /// Score of one tetrahedron in a cavity with these vertices, to be joined with the others' by [`Criterion::join`]. Greater is better;
    /// −∞ when the tetrahedron is not positive.
    pub fn score(&self, criterion: Criterion, tet: [VertexId; 4], cavity: &[VertexId]) -> f64 {
        let points = tet.map(|v| self.store.position(v));
        match criterion {
            Criterion::MeanRatio => mean_ratio_score(self.shape(tet)),
            _ if !is_positive(points) => f64::NEG_INFINITY,
            // Positive, but so flat that its volume rounds to nothing: no score can be trusted.
            _ if volume6(points[0], points[1], points[2], points[3]) <= 0.0 => f64::NEG_INFINITY,
            Criterion::EdgeWeight => {
                let logs = tet.map(|v| self.store.log(v));
                let mean = Sym3(std::array::from_fn(|i| 0.25 * logs.iter().map(|l| l.0[i]).sum::<f64>())).exp();
                -edge_weight(points, &mean)
            }
            Criterion::Delaunay => {
                let others = cavity.iter().filter(|v| !tet.contains(v));
                -others.map(|&p| self.encroachment(tet, points, p)).fold(0.0, f64::max)
            }
        }
    }

    /// Score of a tetrahedron that is there: its mean ratio is kept with it.
    pub fn present_score(&self, criterion: Criterion, t: TetId, cavity: &[VertexId]) -> f64 {
        match criterion {
            Criterion::MeanRatio => mean_ratio_score(self.store.quality(t)),
            _ => self.score(criterion, self.store.vertices(t), cavity),
        }
    }

    /// How deep p lies in the circumsphere of the tetrahedron: 5 − Σ α over the metrics of p and of the four
    /// vertices, where α_p < 1; otherwise 0.
    fn encroachment(&self, tet: [VertexId; 4], points: [Vec3; 4], p: VertexId) -> f64 {
        let point = self.store.position(p);
        let own = alpha(points, &self.store.metric(p), point);
        if own >= 1.0 {
            return 0.0;
        }
        let sum: f64 = tet.iter().map(|&v| alpha(points, &self.store.metric(v), point)).sum();
        (5.0 - own - sum).max(0.0)
    }
}

/// d_M(O, p)/d_M(O, x_0), with O the circumcentre of the tetrahedron in the constant metric M.
fn alpha(x: [Vec3; 4], m: &Sym3, p: Vec3) -> f64 {
    // (x_i − x_0)ᵀ M (O − x_0) = |x_i − x_0|²_M / 2, solved for w = M (O − x_0), then for O − x_0.
    let e = [sub(x[1], x[0]), sub(x[2], x[0]), sub(x[3], x[0])];
    let h = e.map(|v| 0.5 * m.quadratic(v));
    let det = dot(e[0], cross(e[1], e[2]));
    let w = add(
        scale(cross(e[1], e[2]), h[0] / det),
        add(scale(cross(e[2], e[0]), h[1] / det), scale(cross(e[0], e[1]), h[2] / det)),
    );
    let centre = m.inverse().apply(w);
    let radius = m.quadratic(centre).sqrt();
    m.quadratic(sub(sub(p, x[0]), centre)).sqrt() / radius
}

/// max over the six edges i of [⟨e_i,e_j⟩⟨e_i,e_k⟩ − ⟨e_i,e_i⟩⟨e_j,e_k⟩] / (6|K|_M), with e_j and e_k the edges of the two
/// faces at e_i that leave the same end.
fn edge_weight(x: [Vec3; 4], m: &Sym3) -> f64 {
    let volume = volume6(x[0], x[1], x[2], x[3]) * m.det().sqrt();
    let mut greatest = f64::NEG_INFINITY;
    for [i, j] in crate::adapt::core::ids::EDGE {
        let [k, l] = crate::adapt::core::ids::ACROSS[i][j];
        let (ei, ej, ek) = (sub(x[j], x[i]), sub(x[k], x[i]), sub(x[l], x[i]));
        let (mi, mj) = (m.apply(ei), m.apply(ej));
        let weight = dot(mi, ej) * dot(mi, ek) - dot(mi, ei) * dot(mj, ek);
        greatest = greatest.max(weight / volume);
    }
    greatest
}

#[cfg(test)]
mod tests {
    use super::*;

    const REGULAR: [Vec3; 4] = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];

    #[test]
    fn the_circumsphere_is_found_in_any_metric() {
        let m = Sym3([4.0, 0.3, 9.0, -0.2, 0.1, 0.5]);
        for p in REGULAR {
            assert!((alpha(REGULAR, &m, p) - 1.0).abs() < 1e-12);
        }
        assert!(alpha(REGULAR, &Sym3::IDENTITY, [0.0; 3]) < 1e-12);
        assert!((alpha(REGULAR, &Sym3::IDENTITY, [3.0, 0.0, 0.0]) - 3.0_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn the_edge_weight_grows_with_an_obtuse_dihedral_angle() {
        let mut flat = REGULAR;
        flat[0] = [0.0, 0.0, 0.0];
        let positive = |x: [Vec3; 4]| if is_positive(x) { x } else { [x[1], x[0], x[2], x[3]] };
        assert!(edge_weight(positive(flat), &Sym3::IDENTITY) > edge_weight(positive(REGULAR), &Sym3::IDENTITY));
    }
}
