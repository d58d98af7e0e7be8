//! Where a new vertex takes its metric from.
use super::field::complexity_of_logs;
use super::{Analytic, Background, Error, Sym3, held};
use crate::mesh::TetMesh;
use crate::mesh::adjacency::{EDGES, MatchedFaces};
use crate::mesh::vector::{Vec3, add, dot, lerp, scale, sub, volume6};
use crate::tasks::{GRAIN, Team};

/// About how many samples of an analytic field are taken for its complexity.
const SAMPLES: usize = 1 << 20;

/// About how many are taken where the complexity need not be exact.
const FEW_SAMPLES: usize = 1 << 17;

/// The source of the metric at any point. Shared by all threads.
pub enum Source {
    /// An analytic field, evaluated.
    Analytic {
        /// The field.
        field: Analytic,
        /// Logarithm of the factor of M (scaling to a complexity); 0 leaves the field as it is.
        log_scale: f64,
    },
    /// The background mesh, interpolated.
    Background(Background),
}

impl Source {
    /// ln M at p. `hint` serves the background (see [`Background::log_at`]): keep one a thread or a vertex.
    #[inline]
    pub fn log_at(&self, p: Vec3, hint: &mut u32) -> Sym3 {
        match self {
            Self::Analytic { field, log_scale } => {
                let log = field.log_at(p).plus_identity(*log_scale);
                if Analytic::is_moderate(p) { log } else { log.held_log() }
            }
            Self::Background(background) => background.log_at(p, hint),
        }
    }

    /// ln M at the vertices of a mesh, if the background is on this very mesh.
    pub fn logs_on(&self, mesh: &TetMesh) -> Option<&[Sym3]> {
        self.background_on(mesh).map(Background::logs)
    }

    /// The matched faces of a mesh, if the background is on this very mesh.
    pub fn faces_of(&self, mesh: &TetMesh) -> Option<&MatchedFaces> {
        self.background_on(mesh).map(|background| background.locator().faces())
    }

    fn background_on(&self, mesh: &TetMesh) -> Option<&Background> {
        let Self::Background(background) = self else { return None };
        std::ptr::eq(background.locator().mesh(), mesh).then_some(background)
    }

    /// Complexity ∫ √det M of the field on a mesh; of a background on its own mesh. An analytic field is integrated by the midpoint
    /// rule over bisected tetrahedra, since the vertices of a coarse mesh do not resolve it.
    pub fn complexity(&self, team: Team<'_>, mesh: &TetMesh) -> f64 {
        let corners = |t: usize| Some(mesh.tets.nodes[t].map(|v| mesh.vertices[v as usize]));
        match self {
            Self::Background(background) => background.complexity(team),
            Self::Analytic { .. } => self.sampled_complexity(team, (SAMPLES, mesh.tets.len()), corners),
        }
    }

    /// As [`Source::complexity`], of a mesh of up to so many tetrahedra, told by their corners; none where there is no tetrahedron. Less exact: an
    /// analytic field is asked at fewer places, which is enough for a forecast and for the bound on growth.
    pub fn complexity_within(
        &self,
        team: Team<'_>,
        tets: usize,
        corners: impl Fn(usize) -> Option<[Vec3; 4]> + Sync,
    ) -> f64 {
        match self {
            Self::Background(background) => background.complexity(team),
            Self::Analytic { .. } => self.sampled_complexity(team, (FEW_SAMPLES, tets), corners),
        }
    }

    fn sampled_complexity(
        &self,
        team: Team<'_>,
        (samples, tets): (usize, usize),
        corners: impl Fn(usize) -> Option<[Vec3; 4]> + Sync,
    ) -> f64 {
        self.sampled_terms(team, samples / tets.max(1), tets, corners).into_iter().sum()
    }

    /// The terms of the complexity of an analytic field on a mesh of `all` tetrahedra, at some of them, told by their corners: in slices of
    /// multiples of [`GRAIN`] tetrahedra they are the same.
    pub fn complexity_terms(&self, all: usize, tets: usize, corners: impl Fn(usize) -> [Vec3; 4] + Sync) -> Vec<f64> {
        self.sampled_terms(Team::alone(), SAMPLES / all.max(1), tets, |t| Some(corners(t)))
    }

    /// The terms with about so many samples a tetrahedron.
    fn sampled_terms(
        &self,
        team: Team<'_>,
        samples: usize,
        tets: usize,
        corners: impl Fn(usize) -> Option<[Vec3; 4]> + Sync,
    ) -> Vec<f64> {
        let depth = samples.max(1).ilog2();
        // As many samples a task whatever their depth.
        team.chunks(GRAIN >> depth.min(GRAIN.ilog2()), tets, |range| {
            range.filter_map(&corners).map(|corners| self.integrate(corners, depth)).sum()
        })
    }

    /// An upper bound of the complexity, found quickly where the field lies on the mesh itself: the exponential function is convex,
    /// so its mean over a tetrahedron is at most that of the vertices.
    pub fn complexity_bound(&self, team: Team<'_>, mesh: &TetMesh) -> f64 {
        match self {
            Self::Background(background) => complexity_of_logs(team, mesh, background.logs()),
            Self::Analytic { .. } => f64::INFINITY,
        }
    }

    /// √det M at p.
    fn density_at(&self, p: Vec3) -> f64 {
        match self {
            Self::Analytic { field, log_scale } if Analytic::is_moderate(p) => {
                field.density_at(p) * (1.5 * log_scale).exp()
            }
            _ => (0.5 * self.log_at(p, &mut 0).trace()).exp(),
        }
    }

    /// ∫ √det M over a tetrahedron, bisected `depth` times across its longest edge.
    fn integrate(&self, x: [Vec3; 4], depth: u32) -> f64 {
        if depth == 0 {
            let centroid = scale(add(add(x[0], x[1]), add(x[2], x[3])), 0.25);
            return self.density_at(centroid) * volume6(x[0], x[1], x[2], x[3]).abs() / 6.0;
        }
        let mut longest = (0.0, [0, 1]);
        for [i, j] in EDGES {
            let edge = sub(x[j], x[i]);
            let square = dot(edge, edge);
            if square >= longest.0 {
                longest = (square, [i, j]);
            }
        }
        let [i, j] = longest.1;
        let middle = lerp(x[i], x[j], 0.5);
        let (mut left, mut right) = (x, x);
        left[i] = middle;
        right[j] = middle;
        self.integrate(left, depth - 1) + self.integrate(right, depth - 1)
    }

    /// Checks that all sizes at the vertices of a mesh can be computed with. Between them, they can too.
    ///
    /// # Errors
    /// [`Error::Sizes`] of the first vertex where not.
    pub fn check(&self, team: Team<'_>, mesh: &TetMesh) -> Result<(), Error> {
        let logs = self.logs_on(mesh);
        let log = |v: usize| logs.map_or_else(|| self.log_at(mesh.vertices[v], &mut 0), |logs| logs[v]);
        held::check(team, mesh.vertices.len(), log)
    }

    /// At how many vertices of the background sizes were cut, since doubles do not hold the metric else.
    pub fn cut(&self) -> usize {
        match self {
            Self::Analytic { .. } => 0,
            Self::Background(background) => background.cut(),
        }
    }

    /// Scales M by e^log_factor.
    pub fn scale(&mut self, team: Team<'_>, log_factor: f64) {
        match self {
            Self::Analytic { log_scale, .. } => *log_scale += log_factor,
            Self::Background(background) => background.scale(team, log_factor),
        }
    }
}
