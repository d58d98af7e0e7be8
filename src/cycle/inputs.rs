//! The files that a loop begins with, by their content. If one were changed before the loop has ended, later steps would not fit the
//! earlier ones.
use super::config::Loaded;
use super::error::Error;
use crate::geometry::names;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// What is in each file, in short.
pub type Fingerprints = BTreeMap<String, String>;

/// Of the mesh, the model, the names beside them, and what the solver reads besides.
///
/// # Errors
/// When one cannot be read.
pub fn fingerprints(loaded: &Loaded) -> Result<Fingerprints, Error> {
    let mesh = &loaded.config.mesh;
    let given =
        [&mesh.file, &mesh.bootstrap, &mesh.cad, &mesh.surface].into_iter().flatten().map(|path| loaded.at(path));
    let mut files: Vec<PathBuf> =
        given.flat_map(|path| [names::beside(&path), names::beside_model(&path), path]).collect();
    files.retain(|path| path.is_file());
    files.extend(loaded.config.solver.solver().inputs(&loaded.base));
    let of = |path: &PathBuf| {
        let print = fingerprint(path).map_err(|error| Error::Failed(format!("{}: {error}", path.display())))?;
        Ok((path.to_string_lossy().into_owned(), print))
    };
    files.iter().map(of).collect()
}

/// The files that are not as they were, and how they changed.
pub fn differences(old: &Fingerprints, new: &Fingerprints) -> Vec<(String, String)> {
    let changed = new.iter().filter_map(|(path, print)| match old.get(path) {
        Some(before) if before == print => None,
        Some(_) => Some((path, format!("{path} has changed"))),
        None => Some((path, format!("{path} was not there"))),
    });
    let gone = old.keys().filter(|path| !new.contains_key(*path));
    let gone = gone.map(|path| (path, format!("{path} is not there any more")));
    changed.chain(gone).map(|(path, text)| (path.clone(), text)).collect()
}

/// Length and a hash (FNV-1a, 64 bits): against a change by chance or by oversight, not against malice.
fn fingerprint(path: &Path) -> io::Result<String> {
    let (mut file, mut buffer) = (File::open(path)?, vec![0; 1 << 16]);
    let (mut length, mut hash) = (0, 0xcbf2_9ce4_8422_2325_u64);
    loop {
        let read = file.read(&mut buffer)?;
        if read == 0 {
            return Ok(format!("{length} bytes, {hash:016x}"));
        }
        length += read;
        buffer[..read].iter().for_each(|&byte| hash = (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_of_one_byte_is_seen() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mesh");
        let print = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            fingerprint(&path).unwrap()
        };
        // The published value of the hash of "a".
        assert_eq!(print(b"a"), "1 bytes, af63dc4c8601ec8c");
        assert_ne!(print(&[7; 100_000]), print(&[[7; 99_999].as_slice(), &[8]].concat()));
    }

    #[test]
    fn what_differs_is_named() {
        let of = |pairs: &[(&str, &str)]| -> Fingerprints {
            pairs.iter().map(|(path, print)| ((*path).to_owned(), (*print).to_owned())).collect()
        };
        let old = of(&[("a", "1"), ("b", "2"), ("c", "3")]);
        assert!(differences(&old, &old).is_empty());
        let told = differences(&old, &of(&[("a", "1"), ("b", "0"), ("d", "4")]));
        let texts: Vec<&str> = told.iter().map(|(_, text)| text.as_str()).collect();
        assert_eq!(texts, ["b has changed", "d was not there", "c is not there any more"]);
    }
}
