//! The files of a command, side files too: all that it reads and all that it writes are known before its work begins.
//!
//! A file is identified by device and inode, whatever links lead to it; a file that does not exist yet by its folder and name. No input is
//! ever overwritten, no two outputs go to the same file, and what cannot be written is refused before the work. Nothing else in `cli`
//! writes files: [`Outputs`] takes a [`Target`], and only [`Files`] makes one.
mod identity;
mod outputs;
pub mod reading;
pub mod room;
pub mod text;

pub use outputs::{Begun, On, Outputs, Slices, Written};

use crate::formats::Format;
use crate::mesh::io::check_writable;
use crate::{formats, geometry, image};
use identity::Identity;
use std::path::{Path, PathBuf};

/// Endings of reports.
pub const JSON: &[&str] = &["json"];

/// What a command reads and writes.
#[derive(Default)]
pub struct Files {
    read: Vec<Known>,
    written: Vec<Known>,
}

/// A file that is read or written.
struct Known {
    path: PathBuf,
    /// Which argument asks for it.
    by: String,
    identity: Identity,
}

/// A file that may be written.
pub struct Target {
    path: PathBuf,
}

impl Target {
    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Files {
    /// No files yet. All inputs must be named before the first output.
    pub fn new() -> Self {
        Self::default()
    }

    /// Reads files with nothing beside them.
    pub fn reads(mut self, paths: impl IntoIterator<Item = impl AsRef<Path>>) -> Self {
        for path in paths {
            self.read(path.as_ref());
        }
        self
    }

    /// Reads meshes of any format with their names, as [`reading::mesh`] does: not what lies beside .mesh and .meshb.
    pub fn reads_meshes(mut self, paths: impl IntoIterator<Item = impl AsRef<Path>>) -> Self {
        for path in paths {
            let path = path.as_ref();
            match Format::of(path) {
                Ok(Format::Libmeshb) | Err(_) => {
                    self.read(path);
                    self.read(&geometry::names::beside(path));
                }
                Ok(_) => self.read_all_of(path),
            }
        }
        self
    }

    /// Reads fields of a mesh, as [`reading::fields`] does.
    pub fn reads_fields(mut self, asked: impl IntoIterator<Item = impl AsRef<Path>>, of: &Path) -> Self {
        for path in asked {
            let path = path.as_ref();
            match Format::of(path) {
                // It may be the name of a field that lies beside the mesh.
                Err(_) => {
                    self.read(path);
                    self.read_all_of(of);
                }
                Ok(format) if format.is_fields() => self.read(path),
                Ok(_) => self.read_all_of(path),
            }
        }
        self
    }

    /// Reads CAD models, with the names beside them.
    pub fn reads_models(mut self, paths: impl IntoIterator<Item = impl AsRef<Path>>) -> Self {
        for path in paths {
            self.read(path.as_ref());
            self.read(&geometry::names::beside_model(path.as_ref()));
        }
        self
    }

    /// Reads images, whose voxels may be in another file.
    pub fn reads_images(mut self, paths: impl IntoIterator<Item = impl AsRef<Path>>) -> Self {
        for path in paths {
            self.read(path.as_ref());
            image::data_file(path.as_ref()).iter().for_each(|data| self.read(data));
        }
        self
    }

    /// Reads meshes of any format, with all that belongs to them.
    pub fn reads_any(mut self, paths: impl IntoIterator<Item = impl AsRef<Path>>) -> Self {
        for path in paths {
            self.read_all_of(path.as_ref());
        }
        self
    }

    fn read_all_of(&mut self, path: &Path) {
        formats::read_files(path).iter().for_each(|file| self.read(file));
    }

    fn read(&mut self, path: &Path) {
        if let Some(identity) = Identity::of(path) {
            self.read.push(Known { path: path.to_owned(), by: String::new(), identity });
        }
    }

    /// The command writes a file, as this argument says. `endings` without the dot; none for any.
    ///
    /// # Errors
    /// For another ending, an input, a file that is written already, and what cannot be written.
    pub fn writes(&mut self, path: &Path, by: &str, endings: &[&str]) -> Result<Target, String> {
        let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
        if !endings.is_empty() && !endings.contains(&extension) {
            return Err(format!("{}: the output must end in .{}", path.display(), endings.join(" or .")));
        }
        check_writable(path).map_err(|error| format!("{}: {error}", path.display()))?;
        self.written(path, by)?;
        Ok(Target { path: path.to_owned() })
    }

    /// The command writes a mesh of any format with the names of its references, as [`Outputs::mesh`] does.
    ///
    /// # Errors
    /// As [`Files::writes`].
    pub fn writes_mesh(&mut self, path: &Path, by: &str) -> Result<Target, String> {
        match Format::of(path).map_err(|error| error.to_string())? {
            Format::Libmeshb => {
                let target = self.writes(path, by, &[])?;
                self.writes(&geometry::names::beside(path), &format!("the names beside {by}"), &[])?;
                Ok(target)
            }
            format if format.is_fields() => Err(format!(
                "{}: holds fields and no mesh; give {by} a format of meshes, such as .meshb",
                path.display()
            )),
            _ => self.writes_any(path, by),
        }
    }

    /// The command writes fields of a mesh, as [`Outputs::fields`] does: .sol or .solb, or a format that `convert` knows and that holds them.
    ///
    /// # Errors
    /// As [`Files::writes`].
    pub fn writes_fields(&mut self, path: &Path, by: &str) -> Result<Target, String> {
        let format = Format::of(path).map_err(|error| error.to_string())?;
        if format.is_fields() || format.holds_fields() || format == Format::Foam {
            return self.writes_any(path, by);
        }
        let message = "holds no fields: the output must end in .sol or .solb, or in .vtu for mesh and fields";
        Err(format!("{}: {message}", path.display()))
    }

    /// The command writes a mesh of any format, with all that belongs to it.
    ///
    /// # Errors
    /// As [`Files::writes`].
    pub fn writes_any(&mut self, path: &Path, by: &str) -> Result<Target, String> {
        let files = formats::written_files(path).map_err(|error| error.to_string())?;
        for file in &files {
            if file.parent().is_some_and(Path::is_dir) || !formats::foam::is_folder(path) {
                self.writes(file, by, &[])?;
            }
        }
        Ok(Target { path: path.to_owned() })
    }

    fn written(&mut self, path: &Path, by: &str) -> Result<(), String> {
        let Some(identity) = Identity::of_output(path) else { return Ok(()) };
        let name = path.display();
        if let Some(input) = self.read.iter().find(|known| known.identity == identity) {
            let also = if input.path.as_os_str() == path.as_os_str() {
                String::new()
            } else {
                format!(" ({} is the same file)", input.path.display())
            };
            return Err(format!("{name}: is an input and would be overwritten{also}; give another output"));
        }
        if let Some(other) = self.written.iter().find(|known| known.identity == identity) {
            let (there, before) = (other.path.display(), &other.by);
            let is_same = other.path.as_os_str() == path.as_os_str();
            let also = if is_same { String::new() } else { format!(", which is {there},") };
            return Err(format!("{name}: {by} and {before} would write the same file{also}; give {by} another name"));
        }
        self.written.push(Known { path: path.to_owned(), by: by.to_owned(), identity });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_are_not_there_yet_are_told_apart_by_folder_and_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let mut files = Files::new();
        files.writes_mesh(&path("o.meshb"), "-o").unwrap();
        let mut refused = |name: &str| files.writes(&path(name), "--report", &[]).err();
        assert!(
            refused("o.meshb").unwrap().contains("--report and -o would write the same file; give --report another")
        );
        assert!(refused("./o.meshb").unwrap().contains("which is"));
        assert!(refused("o.names.json").unwrap().contains("the names beside -o"));
        assert!(refused("no/r.json").unwrap().contains("there is no folder"));
        assert_eq!(refused("r.json"), None);
        assert!(refused("r.json").is_some());
    }
}
