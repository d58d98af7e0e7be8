//! `adapt --limit-chords`: sizes along curved walls that straight edges can have.
use super::input::InputArguments;
use super::source::On;
use crate::cli::table::{Table, figure};
use crate::metric::Source;
use crate::metric::multiscale::Cut;
use crate::sizing::chords::{Dive, SHARE, dive};
use crate::tasks::{Team, stage};
use serde::Serialize;

/// Sizes along walls are cut by default where they are too long at more than this share of the vertices on curved walls. At a few a mesh meets its metric
/// all the same.
const MANY: f64 = 0.02;

/// What --limit-chords says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ChordLimit {
    /// Sizes are cut to this share of √(8 h R).
    Share(f64),
    /// They are left.
    Off,
}

impl ChordLimit {
    /// A share above 0 and no more than 1, or off.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        if text == "off" {
            return Ok(Self::Off);
        }
        match crate::cli::positive(text) {
            Ok(share) if share <= 1.0 => Ok(Self::Share(share)),
            _ => {
                Err("give a share above 0, and no more than 1: the chord whose sagitta is the size across; or off"
                    .into())
            }
        }
    }

    /// The share.
    pub(super) fn share(self) -> Option<f64> {
        match self {
            Self::Share(share) => Some(share),
            Self::Off => None,
        }
    }
}

/// What was cut along curved walls.
#[derive(Clone, Copy, Serialize)]
pub struct Chords {
    /// The share of √(8 h R).
    pub(super) share: f64,
    #[serde(flatten)]
    pub(super) cut: Cut,
}

impl Chords {
    /// What the table says of it.
    pub fn row(&self, table: &mut Table) {
        let Self { share, cut: Cut { vertices, greatest } } = self;
        let most =
            if *vertices > 0 { format!(", by a factor of {} at most", figure(*greatest)) } else { String::new() };
        table.row("cut along curved walls", format_args!("{vertices} vertices{most} ({share} √(8 h R))"));
    }
}

/// Unit edges that dive deep through the layers along curved walls: no mesh meets such sizes.
pub(super) struct TooLong(Dive);

impl TooLong {
    /// Whether they are many.
    pub(super) fn is_to_be_cut(&self) -> bool {
        self.0.vertices as f64 > MANY * self.0.on_walls as f64
    }

    /// What is told of them.
    pub(super) fn told(&self, is_cut: bool) -> String {
        let Dive { vertices, on_walls, layers } = self.0;
        let (layers, share) = (figure(layers), SHARE);
        let what = format!("the sizes along curved walls are too long: their edges dive through up to {layers} layers");
        if is_cut {
            let remedy = format!("cut to {share} √(8 h R), as by --limit-chords; --limit-chords=off leaves them");
            format!("{what}, and no mesh meets such sizes. They are {remedy}")
        } else {
            format!(
                "{what} at {vertices} of {on_walls} vertices there. The mesh gets bad cells; --limit-chords cuts these sizes"
            )
        }
    }
}

impl InputArguments {
    /// Where the metric of a file or a field asks for cells along curved walls of a CAD model that no straight edges can have. An analytic
    /// field is taken as it is, and nothing is looked for where --limit-chords says what to do.
    pub(super) fn too_long_along_walls(&self, team: Team<'_>, source: &Source, on: On<'_>) -> Option<TooLong> {
        let Source::Background(background) = source else { return None };
        if self.cad.is_none() || self.limit_chords.is_some() {
            return None;
        }
        let found = dive(team, on.place, on.model, background.logs());
        stage("sizes along walls");
        (found.vertices > 0).then_some(TooLong(found))
    }
}
