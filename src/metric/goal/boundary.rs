//! What is known at the boundary: there fits are one-sided, and the adjoint of a functional on a wall is singular.
use crate::metric::Sym3;
use crate::metric::recovery::{Rings, extrapolate};
use crate::tasks::{GRAIN, Team};

/// What vertices on the boundary of the domain get.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Boundary {
    /// |H| is carried on from inside: the mean of the neighbours'. Weights are at most the greatest of the neighbours inside.
    #[default]
    Inside,
    /// What is recovered there.
    Own,
}

impl Boundary {
    /// Both ways.
    pub const ALL: [Self; 2] = [Self::Inside, Self::Own];

    /// As the command line spells it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Inside => "inside",
            Self::Own => "own",
        }
    }

    /// Carries |H|, shape (n,), on to the boundary. Where no neighbour is inside, it comes from theirs.
    pub(super) fn carry(self, team: Team<'_>, rings: &Rings, hessians: &mut Vec<Sym3>) {
        if self == Self::Own {
            return;
        }
        let known = team.map(GRAIN, hessians.len(), |v| rings.is_inside(v as u32).then(|| hessians[v]));
        let filled = extrapolate::fill(team, rings, known);
        *hessians = team.map(GRAIN, filled.len(), |v| filled[v].unwrap_or(hessians[v]));
    }

    /// Limits weights, shape (n,), on the boundary.
    pub(super) fn limit(self, team: Team<'_>, rings: &Rings, weights: &mut Vec<f64>) {
        if self == Self::Own {
            return;
        }
        *weights = team.map(GRAIN, weights.len(), |v| {
            let own = weights[v];
            if rings.is_inside(v as u32) {
                return own;
            }
            let inside = rings.neighbours(v as u32).iter().filter(|&&other| rings.is_inside(other));
            let most = inside.map(|&other| weights[other as usize]).reduce(f64::max);
            most.map_or(own, |most| own.min(most))
        });
    }
}
