//! `geo-adapt man`: a manual page for each command, made from its help.
use super::Outcome;
use super::files::{Files, Outputs};
use clap::Command;
use clap_mangen::Man;
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `geo-adapt man`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The folder for them, such as ~/.local/share/man/man1; it must be there
    folder: PathBuf,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let mut command = super::command();
    command.build();
    let mut pages = Vec::new();
    list(&command, "geo-adapt", &mut pages);
    let (mut files, mut outputs) = (Files::new(), Outputs::new());
    for (name, command) in &pages {
        let target = files.writes(&arguments.folder.join(format!("{name}.1")), "a page", &[])?;
        let mut text = Vec::new();
        Man::new(command.clone()).render(&mut text)?;
        outputs.text(&target, &text)?;
    }
    outputs.commit()?;
    super::print(&format!("{} pages are in {}\n", pages.len(), arguments.folder.display()))?;
    Ok(ExitCode::SUCCESS)
}

/// A command and those below it, each with its name on the page.
fn list(command: &Command, name: &str, pages: &mut Vec<(String, Command)>) {
    let page = command.clone().name(name.to_owned()).display_name(name.to_owned());
    pages.push((name.to_owned(), page));
    let below = command.get_subcommands().filter(|below| !below.is_hide_set() && below.get_name() != "help");
    below.for_each(|below| list(below, &format!("{name}-{}", below.get_name()), pages));
}
