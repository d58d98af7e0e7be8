//! When narrow voids are looked for: before the mesh has changed so much that edges may be longer than was assumed the last time.
use super::Pipeline;
use crate::adapt::core::voids::Voids;

/// In so many first passes edges grow most, and voids are looked for in each that follows upon some change.
const FIRST_PASSES: usize = 4;

/// Voids are looked for again after changes to this share of the vertices.
const MUCH: f64 = 0.3;

/// The same in the first passes, and where there are narrow voids, which have to be known well.
const SOME: f64 = 0.05;

/// The same where there are none to come, as it seems.
const ALL: f64 = 3.0;

/// So many times it is looked for whether there are voids to come.
const TRIES: usize = 2;

/// What is known of the voids.
#[derive(Default)]
pub struct Known {
    /// The pass, the vertices and the changes so far, when they were last looked for.
    when: Option<(usize, usize, u64)>,
    /// Whether they were narrow.
    narrow: bool,
    /// Whether there were none to come, and how often there were some.
    none_to_come: bool,
    tries: usize,
}

impl Pipeline<'_, '_> {
    /// Looks for narrow voids, if that was long ago.
    pub(super) fn find_voids(&mut self) {
        let changes = self.changes();
        if let Some((pass, vertices, before)) = self.voids.when {
            let lost = self.voids.narrow && self.context.voids.is_empty();
            let is_early = self.pass != pass && self.pass <= FIRST_PASSES;
            let much = match self.voids {
                Known { none_to_come: true, .. } => ALL,
                Known { narrow: true, .. } => SOME,
                _ if is_early => SOME,
                _ => MUCH,
            };
            if !lost && ((changes - before) as f64) < much * vertices as f64 {
                return;
            }
        }
        let (team, vertices) = (self.team(), self.live());
        self.voids.when = Some((self.pass, vertices, changes));
        self.voids.none_to_come = self.voids.tries < TRIES && Voids::are_none_to_come(team, self.context);
        self.voids.tries += usize::from(!self.voids.none_to_come);
        self.context.voids = if self.voids.none_to_come { Voids::default() } else { Voids::of(team, self.context) };
        self.voids.narrow = !self.context.voids.is_empty();
    }
}
