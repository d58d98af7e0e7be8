//! The report of a loop: one page that loads nothing.
use super::Error;
use super::config::Config;
use super::history::History;
use super::layout::Layout;

/// Writes the page.
pub fn write(_layout: &Layout, _config: &Config, _history: &History) -> Result<(), Error> {
    Ok(())
}
