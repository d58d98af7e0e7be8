//! The spellings of other adapters: command lines of mmg3d and of refine, brought into our own.
//!
//! `geo-adapt mmg3d -in a.mesh -sol m.sol -out b.mesh`, the same without `mmg3d`, and `geo-adapt ref adapt a.meshb -m m.solb -x b.meshb`.
mod mmg;
mod refine;
#[cfg(test)]
mod tests;

use std::ffi::{OsStr, OsString};

/// A command line of ours, with what of the other one was left out.
#[derive(Debug, Default, PartialEq)]
pub struct Translated {
    /// The words behind the program's name.
    pub words: Vec<OsString>,
    /// What the user should know.
    pub notices: Vec<String>,
}

/// Our command line for that of another adapter, given the words behind the program's name; none where it is one of ours.
///
/// # Errors
/// When it asks for what we do in another way: the command to type.
pub fn translated(words: &[OsString]) -> Option<Result<Translated, String>> {
    let (first, rest) = words.split_first()?;
    match first.to_str()? {
        "mmg3d" | "mmg3d_O3" | "feflo.a" | "feflo" => Some(mmg::translated(rest)),
        "ref" => Some(refine::translated(rest)),
        // Our command with their options: -hmin would ask for help, -in would be two options.
        "adapt" if mmg::is_line(rest) => Some(mmg::translated(rest)),
        option if mmg::is_option(option) => Some(mmg::translated(words)),
        _ => None,
    }
}

/// A command line as it is typed in a shell.
pub fn typed(words: &[OsString]) -> String {
    let quoted = |word: &OsString| {
        let text = word.to_string_lossy();
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:=+@%".contains(c);
        if !text.is_empty() && text.chars().all(is_plain) {
            text.into_owned()
        } else {
            format!("'{}'", text.replace('\'', "'\\''"))
        }
    };
    std::iter::once("geo-adapt".to_owned()).chain(words.iter().map(quoted)).collect::<Vec<_>>().join(" ")
}

impl Translated {
    /// A command of ours.
    fn of(command: &[&str]) -> Self {
        Self { words: command.iter().map(OsString::from).collect(), notices: Vec::new() }
    }

    /// Adds an option with its value.
    fn add(&mut self, option: &str, value: impl AsRef<OsStr>) {
        self.words.push(option.into());
        self.words.push(value.as_ref().to_owned());
    }
}

/// The words of a command line in turn.
struct Words<'a> {
    left: std::slice::Iter<'a, OsString>,
}

impl<'a> Words<'a> {
    fn new(words: &'a [OsString]) -> Self {
        Self { left: words.iter() }
    }

    fn next(&mut self) -> Option<&'a OsStr> {
        self.left.next().map(OsString::as_os_str)
    }

    /// The value of an option.
    fn value(&mut self, option: &str) -> Result<&'a OsStr, String> {
        self.next().ok_or_else(|| format!("{option} wants a value behind it"))
    }

    /// The value of an option that is a number.
    fn number(&mut self, option: &str) -> Result<(&'a OsStr, f64), String> {
        let text = self.value(option)?;
        let number = text.to_str().and_then(|text| text.parse().ok());
        let number = number.ok_or_else(|| format!("{option} {}: give a number", text.to_string_lossy()))?;
        Ok((text, number))
    }
}
