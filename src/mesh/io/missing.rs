//! What may be meant by the name of a file that is not there.
use std::io::{self, ErrorKind};
use std::path::Path;

/// Names are alike from this similarity on (Jaro and Winkler, 1 for the same).
const ALIKE: f64 = 0.8;

/// What an error about a file says more, where it is not there: that its folder is not there either, or the file with the most similar
/// name. Nothing for other errors.
pub fn meant(path: &Path, error: &io::Error) -> String {
    // An error of our own says all of it already.
    let is_missing = error.kind() == ErrorKind::NotFound && error.get_ref().is_none();
    let Some(name) = path.file_name().filter(|_| is_missing) else { return String::new() };
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return format!("; there is no folder {}", folder.display());
    }
    let wanted = name.to_string_lossy().to_lowercase();
    let entries = folder.read_dir().into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let rated = names.map(|name| (strsim::jaro_winkler(&wanted, &name.to_lowercase()), name));
    // Of several that are as similar the first in the alphabet.
    let best = rated.max_by(|a, b| a.0.total_cmp(&b.0).then_with(|| b.1.cmp(&a.1)));
    match best.filter(|(similarity, _)| *similarity >= ALIKE) {
        Some((_, name)) => format!("; did you mean {}?", path.with_file_name(name).display()),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mistyped_name_is_told_with_the_one_that_is_meant() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["wing.meshb", "wing.solb", "tail.meshb"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let path = |name: &str| folder.path().join(name);
        let said = |name: &str| meant(&path(name), &ErrorKind::NotFound.into());
        assert_eq!(said("wign.meshb"), format!("; did you mean {}?", path("wing.meshb").display()));
        assert_eq!(said("Wing.solb"), format!("; did you mean {}?", path("wing.solb").display()));
        assert_eq!(said("qqq"), "");
        assert_eq!(said("no/wing.meshb"), format!("; there is no folder {}", path("no").display()));
        assert_eq!(meant(&path("wign.meshb"), &ErrorKind::PermissionDenied.into()), "");
        assert_eq!(meant(&path("wign.meshb"), &io::Error::new(ErrorKind::NotFound, "make it first")), "");
    }
}
