//! Flaws while they are gathered.
use super::super::vector::{Vec3, add, scale};
use super::super::{Flaw, FlawKind, Offender};
use super::{NAMED, Validity};

/// Flaws in the order in which they are found; where they are is not known yet.
#[derive(Clone, Debug, Default)]
pub struct Found(Vec<Flaw>);

impl Found {
    /// Counts a flaw. `nodes` are those of the whole mesh.
    pub fn add(&mut self, kind: FlawKind, index: Option<usize>, nodes: &[u32]) {
        let flaw = self.of_kind(kind);
        flaw.count += 1;
        if flaw.first.len() < NAMED {
            flaw.first.push(Offender { index, other: None, nodes: nodes.to_vec(), at: [0.0; 3] });
        }
    }

    /// These, and then those that were found later.
    #[must_use]
    pub fn and(mut self, later: Self) -> Self {
        for Flaw { kind, count, first } in later.0 {
            let flaw = self.of_kind(kind);
            flaw.count += count;
            let room = NAMED - flaw.first.len();
            flaw.first.extend(first.into_iter().take(room));
        }
        self
    }

    /// How often a kind was found.
    pub fn count(&self, kind: FlawKind) -> usize {
        self.0.iter().find(|flaw| flaw.kind == kind).map_or(0, |flaw| flaw.count)
    }

    fn of_kind(&mut self, kind: FlawKind) -> &mut Flaw {
        let at = self.0.iter().position(|flaw| flaw.kind == kind).unwrap_or_else(|| {
            self.0.push(Flaw { kind, count: 0, first: Vec::new() });
            self.0.len() - 1
        });
        &mut self.0[at]
    }

    /// The flaws with their places: the middles of their nodes. `points` gives the coordinates of vertices in ascending order.
    ///
    /// # Errors
    /// Those of `points`.
    pub fn located<E>(self, points: impl Fn(&[u32]) -> Result<Vec<Vec3>, E>) -> Result<Validity, E> {
        let Self(mut flaws) = self;
        let mut nodes: Vec<u32> = flaws.iter().flat_map(|flaw| &flaw.first).flat_map(|o| &o.nodes).copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let known = points(&nodes)?;
        let at = |v: &u32| nodes.binary_search(v).map_or([f64::NAN; 3], |place| known[place]);
        for offender in flaws.iter_mut().flat_map(|flaw| &mut flaw.first) {
            let sum = offender.nodes.iter().fold([0.0; 3], |sum, v| add(sum, at(v)));
            offender.at = scale(sum, 1.0 / offender.nodes.len() as f64);
        }
        Ok(Validity { flaws })
    }
}
