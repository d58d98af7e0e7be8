//! What is wrong with a mesh that was adapted.
use crate::adapt::Adapted;
use crate::cli::table;
use crate::geometry::fidelity::Fidelity;
use crate::mesh::vector::Vec3;

/// Normal deviation of a triangle that is turned over or nearly so, degrees. The kernel's limit is 60°: beyond it are triangles of the first
/// surface that were never mended, or some that were left where a vertex found no room on the model.
const FOLDED: f64 = 75.0;

/// How many flaws there are, and a place of each.
#[derive(Clone, Copy, Debug, Default)]
pub struct Flaws {
    off: Flaw,
    crossings: Flaw,
    folds: Flaw,
}

#[derive(Clone, Copy, Debug, Default)]
struct Flaw {
    count: usize,
    at: Option<Vec3>,
}

impl Flaws {
    /// Those of a mesh that lies so on its model.
    pub fn of(adapted: &Adapted, fidelity: &Fidelity) -> Self {
        let extracted = &adapted.extracted;
        let folded = fidelity.worst_normal.filter(|worst| worst.degrees > FOLDED);
        Self {
            off: Flaw {
                count: extracted.off_model.len().max(fidelity.off),
                at: fidelity.from_entity.map(|farthest| farthest.at),
            },
            crossings: Flaw {
                count: extracted.crossings.count,
                at: extracted.crossings.first.first().map(|crossing| crossing.at),
            },
            folds: Flaw { count: usize::from(folded.is_some()), at: folded.map(|worst| worst.at) },
        }
    }

    /// Whether other commands refuse such a mesh.
    pub fn are_refused(&self) -> bool {
        self.off.count > 0 || self.crossings.count > 0
    }

    /// Whether there is less wrong: vertices off the model are the worst, then a fold.
    pub fn are_less_than(&self, other: &Self) -> bool {
        let order = |flaws: &Self| [flaws.off.count, flaws.folds.count, flaws.crossings.count];
        order(self) < order(other)
    }

    /// The worst of them, if there is any.
    pub fn worst(&self) -> Option<String> {
        let (text, at) = if self.off.count > 0 {
            (format!("vertices of its surface are off the model ({}), the farthest", self.off.count), self.off.at)
        } else if self.folds.count > 0 {
            ("its surface is folded".into(), self.folds.at)
        } else if self.crossings.count > 0 {
            (format!("{} pairs of triangles of its surface cross, the first", self.crossings.count), self.crossings.at)
        } else {
            return None;
        };
        Some(match at {
            Some(at) => format!("{text} at {}", table::place(at)),
            None => text,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flaws([off, folds, crossings]: [usize; 3]) -> Flaws {
        let flaw = |count| Flaw { count, at: Some([1.0, 2.0, 3.0]) };
        Flaws { off: flaw(off), crossings: flaw(crossings), folds: flaw(folds) }
    }

    #[test]
    fn what_others_refuse_does_not_pass() {
        assert!(!flaws([0, 0, 0]).are_refused() && !flaws([0, 1, 0]).are_refused());
        assert!(flaws([1, 0, 0]).are_refused() && flaws([0, 0, 1]).are_refused());
    }

    #[test]
    fn vertices_off_the_model_are_the_worst() {
        assert!(flaws([0, 1, 9]).are_less_than(&flaws([1, 0, 0])) && flaws([0, 0, 9]).are_less_than(&flaws([0, 1, 0])));
        assert!(flaws([1, 1, 1]).worst().unwrap().contains("off the model (1), the farthest at (1"));
        assert!(flaws([0, 1, 1]).worst().unwrap().contains("folded at (1"));
        assert!(flaws([0, 0, 2]).worst().unwrap().contains("2 pairs"));
        assert_eq!(flaws([0, 0, 0]).worst(), None);
    }
}
