//! Configurations of SU2: lines KEY= VALUE, comments after %, a backslash at the end where the next line goes on.
use std::path::Path;

/// A configuration, its lines as they came but for what was set.
#[derive(Clone, Debug, Default)]
pub struct Cfg {
    /// Each with its key, empty of comments; a value over several lines is one entry.
    entries: Vec<(String, String)>,
}

impl Cfg {
    /// Reads a configuration.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn read(path: &Path) -> Result<Self, String> {
        let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
        let mut entries: Vec<(String, String)> = Vec::new();
        let mut goes_on = false;
        for line in text.lines() {
            let code = line.split('%').next().unwrap_or_default().trim();
            match entries.last_mut().filter(|_| goes_on) {
                Some((_, entry)) => *entry += &format!("\n{line}"),
                None => {
                    let key = code.split_once('=').map_or("", |(key, _)| key.trim());
                    entries.push((key.to_ascii_uppercase(), line.into()));
                }
            }
            goes_on = code.ends_with('\\');
        }
        Ok(Self { entries })
    }

    /// Gives an option a value, in its place where it is there.
    pub fn set(&mut self, key: &str, value: &str) {
        let key = key.to_ascii_uppercase();
        let line = format!("{key}= {value}");
        let place = self.entries.iter().position(|(known, _)| *known == key);
        // SU2 refuses an option that stands twice.
        self.entries.retain({
            let mut at = 0;
            move |(known, _)| {
                at += 1;
                Some(at - 1) == place || *known != key
            }
        });
        match place {
            Some(place) => self.entries[place].1 = line,
            None => self.entries.push((line.split('=').next().unwrap_or_default().into(), line)),
        }
    }

    /// The value of an option, without its comment.
    pub fn get(&self, key: &str) -> Option<String> {
        let (_, line) = self.entries.iter().find(|(known, _)| known == key)?;
        let value = line.split_once('=')?.1.split('%').next().unwrap_or_default();
        Some(value.trim().to_owned())
    }

    /// Gives an option a value where it has none.
    pub fn set_missing(&mut self, key: &str, value: &str) {
        if self.entries.iter().all(|(known, _)| known != key) {
            self.set(key, value);
        }
    }

    /// As a file.
    pub fn text(&self) -> String {
        self.entries.iter().map(|(_, line)| format!("{line}\n")).collect()
    }

    /// Writes it.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), String> {
        std::fs::write(path, self.text()).map_err(|error| format!("{}: {error}", path.display()))
    }
}
