//! Writing the files of a result: all or none.
use super::Target;
use crate::formats::{self, Dataset, Options};
use crate::geometry::{Names, names};
use crate::mesh::TetMesh;
use crate::mesh::io::{self, Batch, Solution};
use crate::metric::{Field, Sym3};
use crate::tasks::Team;
use crate::view::{self, Scene, picture};
use serde::Serialize;
use std::fs::File;
use std::path::Path;

type Done = Result<(), Box<dyn std::error::Error>>;

/// The files of a result. Each is written beside its target; [`Outputs::commit`] renames them together, a mesh last.
#[derive(Default)]
pub struct Outputs {
    batch: Batch,
}

impl Outputs {
    /// None yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// A mesh, and what its references are called.
    pub fn mesh(&mut self, to: &Target, mesh: &TetMesh, called: &Names) -> Done {
        io::add_mesh(&mut self.batch, &to.path, mesh)?;
        Ok(names::add(&mut self.batch, &to.path, called, &[])?)
    }

    /// A mesh with all that belongs to it, in the format that its ending tells. Returns what that cannot carry.
    pub fn dataset(
        &mut self,
        team: Team<'_>,
        to: &Target,
        data: &Dataset,
        options: Options,
    ) -> Result<Vec<String>, io::Error> {
        formats::add(&mut self.batch, team, &to.path, data, options)
    }

    /// Names alone.
    pub fn names(&mut self, to: &Target, called: &Names) -> Done {
        Ok(names::add_file(&mut self.batch, &to.path, called, &[])?)
    }

    /// Fields at vertices.
    pub fn solution(&mut self, team: Team<'_>, to: &Target, solution: &Solution) -> Done {
        Ok(io::add_solution(&mut self.batch, team, &to.path, solution)?)
    }

    /// A metric.
    pub fn metric(&mut self, to: &Target, field: &Field) -> Done {
        Ok(field.add(&mut self.batch, &to.path)?)
    }

    /// The metric of these logarithms.
    pub fn logs(&mut self, team: Team<'_>, to: &Target, logs: &[Sym3]) -> Done {
        Ok(Field::add_logs(&mut self.batch, team, &to.path, logs)?)
    }

    /// A file that is there already, say in a folder that goes with the run.
    pub fn copy(&mut self, from: &Path, to: &Target) -> Done {
        let mut from = File::open(from)?;
        Ok(self.batch.add(&to.path, |file| std::io::copy(&mut from, file).map(drop))?)
    }

    /// A report, where one is asked for.
    pub fn json(&mut self, to: Option<&Target>, value: &impl Serialize) -> Done {
        let Some(to) = to else { return Ok(()) };
        let text = serde_json::to_vec_pretty(value)?;
        Ok(self.batch.add(&to.path, |file| file.write_all(&text).and_then(|()| file.write_all(b"\n")))?)
    }

    /// A text, as it is.
    pub fn text(&mut self, to: &Target, text: &[u8]) -> Done {
        Ok(self.batch.add(&to.path, |file| file.write_all(text))?)
    }

    /// A page for the browser.
    pub fn page(&mut self, team: Team<'_>, to: &Target, scene: &Scene<'_>, options: &picture::Options) -> Done {
        Ok(view::add_page(&mut self.batch, team, scene, options, &to.path)?)
    }

    /// A picture.
    pub fn picture(&mut self, team: Team<'_>, to: &Target, scene: &Scene<'_>, options: &picture::Options) -> Done {
        Ok(picture::add_picture(&mut self.batch, team, scene, options, &to.path)?)
    }

    /// Gives the files their names.
    pub fn commit(self) -> Done {
        Ok(self.batch.commit()?)
    }
}
