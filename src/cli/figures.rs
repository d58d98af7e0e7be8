//! The figures of a command: a table for people, JSON for programs.
use super::files::{Files, Target};
use super::terminal::{PrintError, print, say};
use serde::Serialize;
use std::error::Error;
use std::path::PathBuf;

/// Where the figures go as JSON.
#[derive(clap::Args)]
pub struct FigureArguments {
    /// Print the figures as JSON, instead of the table. There too what has a number counts from 1
    #[arg(long)]
    json: bool,
    /// Write the figures as JSON, as --json prints them
    #[arg(long, value_name = "FILE.json")]
    pub report: Option<PathBuf>,
}

impl FigureArguments {
    /// The file, if one is asked for; `endings` as [`Files::writes`] has them.
    ///
    /// # Errors
    /// As there.
    pub fn target(&self, files: &mut Files, endings: &[&str]) -> Result<Option<Target>, String> {
        self.report.as_ref().map(|path| files.writes(path, "--report", endings)).transpose()
    }

    /// Whether nobody wants the figures.
    pub fn are_not_wanted(&self) -> bool {
        !self.json && self.report.is_none() && super::terminal::is_quiet()
    }

    /// Prints the figures as JSON, if that is asked for, else as a table, unless quiet.
    ///
    /// # Errors
    /// When they cannot be written.
    pub fn print(&self, figures: &impl Serialize, table: impl FnOnce() -> String) -> Result<(), Box<dyn Error>> {
        if self.json || !super::terminal::is_quiet() { self.answer(figures, table) } else { Ok(()) }
    }

    /// The same, also when quiet: of a command that does nothing but measure for this answer.
    ///
    /// # Errors
    /// When they cannot be written.
    pub fn answer(&self, figures: &impl Serialize, table: impl FnOnce() -> String) -> Result<(), Box<dyn Error>> {
        let text = if self.json { serde_json::to_string_pretty(figures)? + "\n" } else { table() };
        Ok(print(&text)?)
    }

    /// Prints a table, unless quiet, or JSON is asked for instead.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn say(&self, table: impl FnOnce() -> String) -> Result<(), PrintError> {
        if self.json || super::terminal::is_quiet() { Ok(()) } else { say(&table()) }
    }
}
