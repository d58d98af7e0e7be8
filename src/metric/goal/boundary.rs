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

    /// Limits weights, shape (n,), on the boundary. Where no neighbour is inside, the limits of theirs count.
    pub(super) fn limit(self, team: Team<'_>, rings: &Rings, weights: &mut [f64]) {
        if self == Self::Own {
            return;
        }
        let mut most = team.map(GRAIN, weights.len(), |v| rings.is_inside(v as u32).then_some(weights[v]));
        loop {
            let next = team.collect(GRAIN, most.len(), |range, found| {
                for vertex in range.filter(|&v| most[v].is_none()) {
                    let near = rings.neighbours(vertex as u32).iter().filter_map(|&other| most[other as usize]);
                    found.extend(near.reduce(f64::max).map(|limit| (vertex, limit)));
                }
            });
            if next.is_empty() {
                break;
            }
            next.into_iter().for_each(|(vertex, limit)| most[vertex] = Some(limit));
        }
        team.fill(GRAIN, weights, |start, weights| {
            for (weight, limit) in weights.iter_mut().zip(&most[start..]) {
                *weight = limit.map_or(*weight, |limit| weight.min(limit));
            }
        });
    }
}
