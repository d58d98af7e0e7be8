//! What becomes of an attempted operation, and how it is counted.
use serde::{Deserialize, Serialize};

/// Why an operation was not carried out. Every refusal leaves the mesh as it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[repr(usize)]
pub enum Refusal {
    /// Another thread holds a vertex: to be tried again.
    Conflict,
    /// The item is gone, or no longer needs the operation.
    Stale,
    /// The model forbids it (corner, another face, frozen).
    Geometry,
    /// An edge would be too short or too long.
    Length,
    /// A tetrahedron would be inverted or flat.
    Inverted,
    /// A tetrahedron would be worse than the limit.
    Shape,
    /// A surface triangle would leave its face's normal.
    Normal,
    /// The cavity would not stay a ball, or grew beyond the limit.
    Topology,
    /// The store has no room left before the next sweep.
    Full,
    /// Two parts of the boundary would pass through each other, across a void.
    Crossing,
}

impl Refusal {
    /// The refusal of a second, larger attempt: the first one was refused for its shape, unless a thread is in the way.
    pub fn or_shape(self) -> Self {
        if self == Refusal::Conflict { self } else { Refusal::Shape }
    }

    /// What the next attempt comes to, unless a thread is in the way.
    ///
    /// # Errors
    /// `Conflict`, or the refusal of the next attempt.
    pub fn or_try(self, next: impl FnOnce() -> Result<(), Refusal>) -> Result<(), Refusal> {
        if self == Refusal::Conflict { Err(self) } else { next() }
    }

    /// All kinds, in the order of their counters.
    pub const ALL: [Refusal; 10] = [
        Refusal::Conflict,
        Refusal::Stale,
        Refusal::Geometry,
        Refusal::Length,
        Refusal::Inverted,
        Refusal::Shape,
        Refusal::Normal,
        Refusal::Topology,
        Refusal::Full,
        Refusal::Crossing,
    ];
}

/// Tries one after another until one is done, or a thread is in the way.
///
/// # Errors
/// The refusal of the last that was tried; `Shape` when there was none.
#[inline(always)]
pub fn first_done(tried: impl IntoIterator<Item = Result<(), Refusal>>) -> Result<(), Refusal> {
    let mut last = Err(Refusal::Shape);
    for result in tried {
        last = result;
        if matches!(result, Ok(()) | Err(Refusal::Conflict)) {
            break;
        }
    }
    last
}

/// Counts of one operation over one or more sweeps.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Counts {
    /// Items tried, conflicts and their repeats included.
    pub attempts: u64,
    /// Carried out.
    pub done: u64,
    /// Refused, by reason, in the order of [`Refusal::ALL`].
    pub refused: [u64; 10],
}

impl Counts {
    /// Counts one attempt.
    #[inline]
    pub fn record(&mut self, result: Result<(), Refusal>) {
        self.attempts += 1;
        match result {
            Ok(()) => self.done += 1,
            Err(refusal) => self.refused[refusal as usize] += 1,
        }
    }

    /// Adds another count.
    pub fn add(&mut self, other: &Counts) {
        self.attempts += other.attempts;
        self.done += other.done;
        for (mine, theirs) in self.refused.iter_mut().zip(other.refused) {
            *mine += theirs;
        }
    }
}
