//! A mesh that is larger than memory, or that several processes share: read by slices, with its boundary alone in memory.
use super::begun::{Begun, Content};
use super::by_parts::{agreed, is_same};
use super::chords::told;
use super::input::{Error, InputArguments, OnModel};
use super::source::of_size;
use crate::decomposition::{self, Files, MetricOf, Shell};
use crate::geometry::{names, on_mesh};
use crate::mesh::crossing;
use crate::mesh::io::slices::MeshReader;
use crate::metric::field::complexity_factor;
use crate::metric::{Field, Source};
use crate::ranks::Ranks;
use crate::tasks::{Team, stage};
use std::fs::File;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;

/// Memory for a vertex of a mesh with its background, read as a whole, bytes.
const BYTES_A_VERTEX: f64 = 700.0;

/// So many blocks of a file are compared, of so many bytes.
const BLOCKS: u64 = 64;
const BLOCK: usize = 1 << 12;

fn is_of(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending))
}

impl InputArguments {
    /// Whether mesh and metric can be read by slices. Neither memory nor processes count: a run that goes on may have others.
    pub fn can_be_sliced(&self) -> bool {
        let metric = self.field.metric.as_deref();
        is_of(&self.mesh, "meshb")
            && metric.is_none_or(|path| is_of(path, "solb") && path.exists())
            && self.field.field.is_empty()
            && self.field.goal.is_none()
            && !self.is_bounded()
    }

    /// Whether a mesh in a file can be read as a whole within this memory.
    pub fn fits(&self, memory: Option<u64>) -> Result<bool, Error> {
        let vertices = MeshReader::open(&self.mesh)?.counts().vertices;
        Ok(memory.is_none_or(|memory| BYTES_A_VERTEX * vertices as f64 <= memory as f64))
    }

    /// Opens mesh and metric, reads them once, and puts the boundary on its model. Collective.
    pub fn read_slices(
        &self,
        team: Team<'_>,
        ranks: &dyn Ranks,
        notices: &mut Vec<String>,
    ) -> Result<Result<Begun, decomposition::Error>, Error> {
        let files = agreed(ranks, self.open_files(notices))?;
        let print = agreed(ranks, self.fingerprint())?;
        agreed(ranks, is_same(ranks, print))?;
        stage("files opened");
        let shell = match Shell::read(team, ranks, &files) {
            Ok(shell) => shell,
            Err(error) => return Ok(Err(error)),
        };
        stage("mesh read");
        let sliced = self.put_on_model(team, shell, files, notices);
        Ok(Ok(agreed(ranks, sliced)?))
    }

    /// What mesh and metric are known by, without reading all of them: each rank reads another share.
    fn fingerprint(&self) -> Result<u64, Error> {
        let mut print = DefaultHasher::new();
        for path in std::iter::once(&self.mesh).chain(&self.field.metric) {
            let told = |error: std::io::Error| format!("{}: {error}", path.display());
            let mut file = File::open(path).map_err(told)?;
            let length = file.metadata().map_err(told)?.len();
            length.hash(&mut print);
            for block in 0..BLOCKS {
                let mut bytes = [0; BLOCK];
                let start = length.saturating_sub(BLOCK as u64) / (BLOCKS - 1) * block;
                let read = file.seek(SeekFrom::Start(start)).and_then(|_| file.read(&mut bytes)).map_err(told)?;
                print.write(&bytes[..read]);
            }
        }
        Ok(print.finish())
    }

    fn open_files(&self, notices: &mut Vec<String>) -> Result<Files, Error> {
        let mesh = MeshReader::open(&self.mesh)?;
        notices.extend_from_slice(mesh.notices());
        let metric = match (&self.field.metric, self.field.size, self.field.analytic) {
            (Some(path), ..) => {
                let file = Field::open(path, mesh.counts().vertices)?;
                notices.extend_from_slice(file.notices());
                MetricOf::File(file)
            }
            (None, Some(h), _) => MetricOf::Uniform(of_size(h)),
            (None, None, Some(field)) => MetricOf::Analytic(Source::Analytic { field, log_scale: 0.0 }),
            (None, None, None) => return Err("no metric".into()),
        };
        Ok(Files::new(mesh, metric))
    }

    fn put_on_model(
        &self,
        team: Team<'_>,
        shell: Shell,
        mut files: Files,
        notices: &mut Vec<String>,
    ) -> Result<Begun, Error> {
        let mesh = Arc::clone(&shell.mesh);
        let crossings = crossing::crossings(team, &shell.outer(team), |v| mesh.vertices[v as usize], 1);
        notices.extend(self.crossings_told(&crossings));
        let (model, place) = self.place(team, &mesh, None, notices)?;
        stage("classified");
        let mut names = names::read(&self.mesh)?;
        if names.is_empty() {
            names = on_mesh(&mesh, &place, &model);
        }
        let wanted = self.amount.complexity();
        let complexity = self.checked_complexity(shell.complexity, wanted)?;
        if wanted.is_some() {
            files.scale(complexity_factor(shell.complexity, complexity).ln());
        }
        if self.field.analytic.is_none()
            && let Some(dive) = self.dive(team, &place, &model, &shell.logs(&files)?)
        {
            // What lies inside is not in memory, and cannot be cut.
            notices.push(told(&dive, false));
        }
        let counts = files.reader().counts();
        let size = [counts.vertices, counts.tets];
        let (crosses, how) = (crossings.count > 0, Default::default());
        let on = OnModel { mesh, size, crosses, place, model, names, how, meeting: None, beside: None };
        Ok(Begun { on, complexity, content: Content::Slices(Box::new(files), shell) })
    }
}
