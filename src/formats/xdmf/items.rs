//! The DataItems of an .xdmf: numbers in the XML, or in HDF5 files beside it.
use super::super::error;
use super::super::hdf5::{Array, Hdf5};
use super::super::scan::real_or_nan;
use super::xml::Element;
use crate::mesh::io::{Error, number};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Where the numbers of an item are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place<'e> {
    /// Words in the XML.
    Text(&'e str),
    /// In an HDF5 file, at a path within it.
    Heavy(&'e str, &'e str),
}

/// An item.
#[derive(Clone, Debug)]
pub(super) struct Item<'e> {
    pub place: Place<'e>,
    /// What NumberType says of the words: whole or not; nothing in many files.
    says_whole: Option<bool>,
    line: usize,
}

impl<'e> Item<'e> {
    /// The one item in an element.
    pub fn of(path: &Path, within: &'e Element<'_>) -> Result<Self, Error> {
        let mut all = within.all("DataItem");
        let (Some(item), None) = (all.next(), all.next()) else {
            let count = within.all("DataItem").count();
            return Err(within.fail(path, format!("{} has {count} DataItems; one is read", within.name)));
        };
        let wrong = |message: String| item.fail(path, message);
        if item.get("Reference").is_some()
            || item.get("ItemType").is_some_and(|kind| !kind.eq_ignore_ascii_case("Uniform"))
        {
            return Err(wrong(
                "a DataItem that refers to another, or is made of others; write the numbers themselves".into(),
            ));
        }
        let says_whole = item.get("NumberType").or(item.get("DataType"));
        let says_whole = says_whole.map(|kind| !kind.eq_ignore_ascii_case("Float"));
        let text = item.text.trim_ascii();
        let place = match item.get("Format").unwrap_or("XML") {
            "XML" => Place::Text(text),
            "HDF" => {
                let (file, at) =
                    text.rsplit_once(':').filter(|(file, at)| !file.is_empty() && !at.is_empty()).ok_or_else(|| {
                        wrong(format!(
                            "'{}' is no place in an HDF5 file; file.h5:/path is expected",
                            error::short(text)
                        ))
                    })?;
                Place::Heavy(file, at)
            }
            other => {
                let other = error::short(other);
                return Err(wrong(format!("a DataItem in the format {other}; write it with HDF or XML")));
            }
        };
        Ok(Self { place, says_whole, line: item.line })
    }
}

/// The numbers of an item, before they are read.
pub(super) enum Numbers<'h> {
    Words(Vec<&'h str>),
    Array(Array<'h>),
}

impl Numbers<'_> {
    /// How many there are.
    pub fn count(&self) -> usize {
        match self {
            Self::Words(words) => words.len(),
            Self::Array(array) => array.count,
        }
    }
}

/// Reads items.
pub(super) struct Items<'p> {
    path: &'p Path,
    files: BTreeMap<String, Hdf5>,
}

impl<'p> Items<'p> {
    /// Opens the files that items name, each once.
    pub fn open<'e>(path: &'p Path, of: impl Iterator<Item = &'e Item<'e>>) -> Result<Self, Error> {
        let mut files = BTreeMap::new();
        for item in of {
            let Place::Heavy(name, _) = item.place else { continue };
            if !files.contains_key(name) {
                let heavy = beside(path, name);
                let bytes = error::read(&heavy).map_err(|error| {
                    let message = format!("its arrays cannot be had: {error}; the two files belong together");
                    error::at(path, format!("line {}", item.line), message)
                })?;
                files.insert(name.to_owned(), Hdf5::of_bytes(&heavy, bytes)?);
            }
        }
        Ok(Self { path, files })
    }

    /// An error at an item.
    pub fn fail(&self, item: &Item<'_>, message: impl Into<String>) -> Error {
        error::at(self.path, format!("line {}", item.line), message)
    }

    /// Its numbers, not read yet.
    pub fn numbers<'h>(&'h self, item: &Item<'h>) -> Result<Numbers<'h>, Error> {
        match item.place {
            Place::Text(text) => Ok(Numbers::Words(text.split_ascii_whitespace().collect())),
            Place::Heavy(name, at) => {
                let file = self.files.get(name).ok_or_else(|| self.fail(item, "its file is not open"))?;
                Ok(Numbers::Array(file.array(at)?))
            }
        }
    }

    /// Whether they are whole. Words are where the file says so, or where it says nothing and all look so.
    pub fn are_whole(&self, item: &Item<'_>, numbers: &Numbers<'_>) -> bool {
        match numbers {
            Numbers::Array(array) => array.is_whole,
            Numbers::Words(words) => item.says_whole.unwrap_or_else(|| words.iter().all(is_whole)),
        }
    }

    /// Whether the words are said to be whole, or stand so in HDF5.
    pub fn are_said_whole(&self, item: &Item<'_>, numbers: &Numbers<'_>) -> bool {
        self.are_whole(item, numbers) && (item.says_whole.is_some() || matches!(numbers, Numbers::Array(_)))
    }

    /// As numbers.
    pub fn reals(&self, item: &Item<'_>, numbers: &Numbers<'_>) -> Result<Vec<f64>, Error> {
        match numbers {
            Numbers::Array(array) => array.reals(),
            Numbers::Words(words) => self.words(item, words, real_or_nan),
        }
    }

    /// As whole numbers.
    pub fn ints(&self, item: &Item<'_>, numbers: &Numbers<'_>) -> Result<Vec<i64>, Error> {
        match numbers {
            Numbers::Array(array) => array.ints(),
            Numbers::Words(words) => self.words(item, words, number::parse_int),
        }
    }

    fn words<T>(
        &self,
        item: &Item<'_>,
        words: &[&str],
        parse: impl Fn(&[u8]) -> Result<T, String>,
    ) -> Result<Vec<T>, Error> {
        words.iter().map(|word| parse(word.as_bytes()).map_err(|message| self.fail(item, message))).collect()
    }
}

fn is_whole(word: &&str) -> bool {
    number::parse_int(word.as_bytes()).is_ok()
}

/// A file that an .xdmf names.
pub(super) fn beside(path: &Path, name: &str) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).join(name)
}
