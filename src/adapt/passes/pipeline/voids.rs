//! When narrow voids are looked for: before the mesh has changed so much that edges may be longer than was assumed the last time.
use super::Pipeline;
use crate::adapt::core::voids::Voids;

/// In so many first passes edges grow most, and voids are looked for in each that follows upon some change.
const FIRST_PASSES: usize = 4;

/// Voids are looked for again after changes to this share of the vertices.
const MUCH: f64 = 0.3;

/// The same in the first passes, and where there are narrow voids, which have to be known well.
const SOME: f64 = 0.05;

/// What is known of the voids.
#[derive(Default)]
pub struct Known {
    /// The pass, the vertices and the changes so far, when they were last looked for.
    when: Option<(usize, usize, u64)>,
    /// Whether they were narrow.
    narrow: bool,
}

impl Pipeline<'_, '_> {
    /// Looks for narrow voids, if that was long ago.
    pub(super) fn find_voids(&mut self) {
        let changes = self.changes();
        if let Some((pass, vertices, before)) = self.voids.when {
            let lost = self.voids.narrow && self.context.voids.is_empty();
            let is_early = self.pass != pass && self.pass <= FIRST_PASSES;
            let much = if self.voids.narrow || is_early { SOME } else { MUCH };
            if !lost && ((changes - before) as f64) < much * vertices as f64 {
                return;
            }
        }
        let (team, vertices) = (self.team(), self.live());
        self.context.voids = Voids::of(team, self.context);
        self.voids = Known { when: Some((self.pass, vertices, changes)), narrow: !self.context.voids.is_empty() };
    }
}
