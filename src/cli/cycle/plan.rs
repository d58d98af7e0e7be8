//! What a run of the loop would do, for people.
use super::super::table::{Table, figure};
use crate::adapt::meeting::VERTICES_PER_COMPLEXITY;
use crate::cycle::{Error, Loaded, Options, Plan, plan};

/// Rows of complexities at the beginning and the end of a long loop.
const SHOWN: usize = 6;

/// The plan as a text.
///
/// # Errors
/// What the run would refuse.
pub fn text(loaded: &Loaded, options: &Options) -> Result<String, Error> {
    let Plan { folder, finished, taken, next, adaptation, complexities, last } = plan(loaded, options)?;
    let mut table = Table::new();
    table.row("configuration", loaded.path.display());
    let there = match finished.last() {
        None => "no step is done".to_owned(),
        Some(last) => format!("{} steps are done, the last is {last}", finished.len()),
    };
    let thrown = if options.restart { ", --restart removes what is there" } else { "" };
    table.row("folder", format_args!("{} ({there}{thrown})", folder.display()));
    for change in taken {
        table.row("changed", format_args!("{change} (taken: nothing that depends on it is done)"));
    }
    table.row("next", next.as_deref().unwrap_or("nothing, the loop has ended"));
    table.line(&format!("{:>10} {:>12} {:>16}", "adaptation", "complexity", "about vertices"));
    for (at, &complexity) in complexities.iter().enumerate() {
        if at == SHOWN && complexities.len() > 2 * SHOWN {
            table.line(&format!("{:>10}", "…"));
        }
        if at < SHOWN || at + SHOWN >= complexities.len() {
            let vertices = format!("{:.0}", VERTICES_PER_COMPLEXITY * complexity);
            table.line(&format!("{:>10} {:>12} {vertices:>16}", at + 1, figure(complexity)));
        }
    }
    let schedule = &loaded.config.schedule;
    let converged = schedule.converged.as_ref().map(|of| format!(", or when {} changes no more", of.functional));
    let until = schedule.until.as_ref().map(|until| format!(", or when {until}"));
    let earlier: String = [converged, until].into_iter().flatten().collect();
    if let Some(last) = last {
        table.row("ends", format_args!("after {last} adaptations and {} solves{earlier}", last + 1));
    }
    if let Some(command) = adaptation {
        table.line(&format!("the next adaptation: {command}"));
    }
    Ok(table.text().to_owned())
}
