//! `adapt --limit-chords`: sizes along curved walls that straight edges can have.
use super::input::InputArguments;
use crate::cli::table::{Table, figure};
use crate::geometry::Model;
use crate::geometry::classify::Classification;
use crate::metric::Sym3;
use crate::metric::multiscale::Cut;
use crate::sizing::chords::{ChordLimit, Dive, Limited, SHARE, dive};
use crate::tasks::{Team, stage};

/// What --limit-chords says.
pub(super) fn parse(text: &str) -> Result<ChordLimit, String> {
    if text == "off" {
        return Ok(ChordLimit::Off);
    }
    match crate::cli::positive(text) {
        Ok(share) if share <= 1.0 => Ok(ChordLimit::Share(share)),
        _ => Err("give a share above 0, and no more than 1: the chord whose sagitta is the size across; or off".into()),
    }
}

/// What the table says of what was cut.
pub(super) fn row(limited: &Limited, table: &mut Table) {
    let Limited { share, cut: Cut { vertices, greatest } } = limited;
    let most = if *vertices > 0 { format!(", by a factor of {} at most", figure(*greatest)) } else { String::new() };
    table.row("cut along curved walls", format_args!("{vertices} vertices{most} ({share} √(8 h R))"));
}

/// What is told of sizes along curved walls that are too long.
pub(super) fn told(dive: &Dive, is_cut: bool) -> String {
    let Dive { vertices, on_walls, layers } = dive;
    let layers = figure(*layers);
    let what = format!("the sizes along curved walls are too long: their edges dive through up to {layers} layers");
    if is_cut {
        let remedy = format!("cut to {SHARE} √(8 h R), as by --limit-chords; --limit-chords=off leaves them");
        return format!("{what}, and no mesh meets such sizes. They are {remedy}");
    }
    let remedy = "The mesh gets bad cells; --limit-chords cuts these sizes";
    format!("{what} at {vertices} of {on_walls} vertices there. {remedy}")
}

impl InputArguments {
    /// What --limit-chords says.
    pub(super) fn chord_limit(&self) -> ChordLimit {
        self.limit_chords.unwrap_or_default()
    }

    /// How deep unit edges of a metric that is no analytic field dive along the curved walls of a CAD model, where they do and --limit-chords does not
    /// say what to do. ln M at the vertices of a mesh that lies on the model, shape (n,).
    pub(super) fn dive(&self, team: Team<'_>, place: &Classification, model: &Model, logs: &[Sym3]) -> Option<Dive> {
        if self.cad.is_none() || self.chord_limit() != ChordLimit::Auto {
            return None;
        }
        let found = dive(team, place, model, logs);
        stage("sizes along walls");
        (found.vertices > 0).then_some(found)
    }
}
