//! Hessians where a recovery has none, from those of the neighbours.
use super::rings::Rings;
use crate::metric::Sym3;
use crate::tasks::{GRAIN, Team};

/// Fills gaps by the mean of the neighbours that are known, ring by ring, as long as that fills any.
pub fn fill(team: Team<'_>, rings: &Rings, mut known: Vec<Option<Sym3>>) -> Vec<Option<Sym3>> {
    loop {
        let filled = team.collect(GRAIN, known.len(), |range, filled| {
            for vertex in range.filter(|&v| known[v].is_none()) {
                let near = rings.neighbours(vertex as u32).iter().filter_map(|&other| known[other as usize]);
                filled.extend(mean(near).map(|mean| (vertex, mean)));
            }
        });
        if filled.is_empty() {
            return known;
        }
        filled.into_iter().for_each(|(vertex, hessian)| known[vertex] = Some(hessian));
    }
}

/// The mean of those that are known of the neighbours' Hessians; none of none.
pub fn mean(near: impl Iterator<Item = Sym3>) -> Option<Sym3> {
    let (sum, count) = near.fold((Sym3::ZERO, 0.0), |(sum, count), h| (sum.plus(h), count + 1.0));
    (count > 0.0).then(|| sum.times(1.0 / count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    #[test]
    fn gaps_are_filled_ring_by_ring() {
        let mesh = cube(3);
        let rings = Rings::of(Team::alone(), &mesh);
        let on_side = |v: usize| mesh.vertices[v][0] == 0.0;
        let h = Sym3::diagonal(1.0, 2.0, 3.0);
        let known = (0..64).map(|v| on_side(v).then_some(h)).collect();
        assert!(fill(Team::alone(), &rings, known).into_iter().all(|filled| filled == Some(h)));
        assert!(fill(Team::alone(), &rings, vec![None; 64]).into_iter().all(|filled| filled.is_none()));
    }
}
