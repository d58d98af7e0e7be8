//! Second derivatives of a field that is known at the vertices of a mesh.
pub(super) mod extrapolate;
pub(super) mod fit;
mod l2;
mod limiter;
mod quadratic;
mod rings;

#[cfg(test)]
mod tests;

pub(super) use l2::gradients_of;
pub use rings::Rings;

use super::Sym3;
use crate::mesh::TetMesh;
use crate::mesh::vector::Vec3;
use crate::tasks::Team;
use serde::Serialize;

/// How Hessians are recovered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Recovery {
    /// A quadratic function for each vertex, fitted to the values of its neighbours and theirs: exact for quadratics, on the boundary too.
    #[default]
    Fit,
    /// The gradients of the elements, averaged to the vertices, twice: smooths more.
    L2,
    /// As fit, but made for fields with jumps or shocks: where the values jump the second derivative across counts more, so that fewer and thinner layers come.
    Jumps,
}

impl Recovery {
    /// All ways.
    pub const ALL: [Self; 3] = [Self::Fit, Self::L2, Self::Jumps];

    /// As the command line spells it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fit => "fit",
            Self::L2 => "l2",
            Self::Jumps => "jumps",
        }
    }

    /// The Hessian at the vertices of a mesh, shape (n,), of a field with these values there, shape (n,), in the field's units over length²
    /// (by L2 projection |H| on the boundary); and at how many vertices it is the mean of the neighbours', since the points around do not
    /// determine it. `rings` are those of the mesh.
    ///
    /// # Panics
    /// When there is not one value a vertex.
    pub fn hessians(self, team: Team<'_>, mesh: &TetMesh, rings: &Rings, values: &[f64]) -> (Vec<Sym3>, usize) {
        assert_eq!(mesh.vertices.len(), values.len(), "one value a vertex");
        match self {
            Self::Fit => fit::hessians(team, mesh, rings, values, None),
            Self::Jumps => fit::hessians(team, mesh, rings, values, Some(limiter::Limiter::of(team, values))),
            Self::L2 => (l2::hessians(team, mesh, rings, values), 0),
        }
    }
}

/// The gradient at the vertices of a mesh, shape (n,), of a field with these values there, shape (n,), in the field's units over length: those of the
/// elements, averaged by volume (Clément 1975). `rings` are those of the mesh.
pub fn gradients(team: Team<'_>, mesh: &TetMesh, rings: &Rings, values: &[f64]) -> Vec<Vec3> {
    gradients_of(team, mesh, rings, values.len(), |v| [values[v as usize]])
        .into_iter()
        .map(|[gradient]| gradient)
        .collect()
}
