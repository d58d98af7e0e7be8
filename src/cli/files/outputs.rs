//! Writing the files of a result: all or none.
use super::Target;
use super::reading::{Fields, METRIC};
use crate::decomposition;
use crate::formats::vtu::pieces;
use crate::formats::{self, Dataset, Format, Options};
use crate::geometry::{Names, names};
use crate::mesh::io::slices::{self, MeshWriter, MetricWriter, SolutionWriter};
use crate::mesh::io::{self, Batch, FieldKind, MeshCounts, Slice};
use crate::mesh::{Association, TetMesh};
use crate::metric::{Field, Sym3};
use crate::tasks::Team;
use crate::view::{self, Scene, picture};
use serde::{Deserialize, Serialize};
use std::ffi::OsString;
use std::fs::File;
use std::path::Path;

type Failure = Box<dyn std::error::Error>;
type Done = Result<(), Failure>;

/// The mesh that fields are of, with its stack and names, where the command has it.
pub type On<'m> = Option<&'m Dataset>;

/// Notices with the file that they are of.
fn named(to: &Target, notices: Vec<String>) -> Vec<String> {
    notices.into_iter().map(|notice| format!("{}: {notice}", to.path.display())).collect()
}

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

    /// A mesh, what its references are called, and its fields where they stand in the same file; beside .mesh and .meshb no fields are
    /// written. Returns what the format cannot carry.
    pub fn mesh(&mut self, team: Team<'_>, to: &Target, data: &Dataset) -> Result<Vec<String>, io::Error> {
        if Format::of(&to.path)? != Format::Libmeshb {
            let lost = self.dataset(team, to, data, Options::default())?;
            return Ok(named(to, lost));
        }
        let written = data.as_written();
        io::add_mesh_and_stack(&mut self.batch, team, &to.path, (&written.mesh, &written.stack))?;
        names::add(&mut self.batch, &to.path, &data.names, &[])?;
        Ok(Vec::new())
    }

    /// A mesh (.meshb) of these counts with its names, and its metric beside it (.solb), which are written by slices; and what other processes
    /// must know to write some of them.
    pub fn slices(
        &mut self,
        mesh: &Target,
        metric: &Target,
        counts: &MeshCounts,
        called: &Names,
    ) -> Result<(Slices, Begun), io::Error> {
        let file = self.batch.open(&mesh.path, true)?;
        names::add(&mut self.batch, &mesh.path, called, &[])?;
        let of_metric = self.batch.open(&metric.path, false)?;
        let slices = Slices {
            mesh: MeshWriter::create(file, &mesh.path, counts)?,
            metric: MetricWriter::create(of_metric, &metric.path, counts.vertices)?,
        };
        let files = [mesh, metric].map(|to| self.batch.beside(&to.path).unwrap_or(&to.path).into());
        Ok((slices, Begun { files, counts: *counts }))
    }

    /// A metric (.solb) at so many vertices, which is written by slices.
    pub fn metric_by_slices(&mut self, to: &Target, vertices: usize) -> Result<MetricWriter, io::Error> {
        MetricWriter::create(self.batch.open(&to.path, true)?, &to.path, vertices)
    }

    /// Fields (.solb) of these kinds at so many vertices, which are written by slices.
    pub fn fields_by_slices(
        &mut self,
        to: &Target,
        vertices: usize,
        kinds: &[FieldKind],
    ) -> Result<SolutionWriter, io::Error> {
        SolutionWriter::create(self.batch.open(&to.path, true)?, &to.path, vertices, kinds)
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

    /// A piece of a .pvtu.
    pub fn piece(&mut self, team: Team<'_>, to: &Target, number: usize, data: &mut Dataset) -> Result<(), io::Error> {
        pieces::add_piece(&mut self.batch, team, &to.path, number, data)
    }

    /// The .pvtu of so many pieces, of which this is one.
    pub fn pieces(&mut self, to: &Target, count: usize, one: &Dataset) -> Result<(), io::Error> {
        pieces::add_pieces(&mut self.batch, &to.path, count, one)
    }

    /// A CAD model that was written elsewhere, with its names. A model without names makes a names file from before empty, which would be taken
    /// for its own.
    pub fn model(&mut self, from: &Path, (to, beside): (&Target, &Target), called: &Names) -> Done {
        self.copy(from, to)?;
        if called.is_empty() && !names::beside_model(&to.path).exists() { Ok(()) } else { self.names(beside, called) }
    }

    /// Names alone.
    pub fn names(&mut self, to: &Target, called: &Names) -> Done {
        Ok(names::add_file(&mut self.batch, &to.path, called, &[])?)
    }

    /// Fields at the vertices of a mesh: alone, or with the mesh where the format holds that too. Returns what the format cannot carry.
    /// (To .sol and .solb go values without names: the names file there is that of a mesh.)
    pub fn fields(&mut self, team: Team<'_>, to: &Target, fields: Fields, on: On<'_>) -> Result<Vec<String>, Failure> {
        let format = Format::of(&to.path)?;
        if format == Format::Solution {
            io::add_solution(&mut self.batch, team, &to.path, &fields.solution)?;
            return Ok(Vec::new());
        }
        let Some(Dataset { mesh, stack, names, .. }) = on else {
            let path = to.path.display();
            return Err(format!("{path}: a mesh is wanted for this format; give .sol or .solb").into());
        };
        // What is written is all owned; only formats of other programs come here.
        let (mesh, stack, names) = (mesh.clone(), stack.clone(), names.clone());
        let data = Dataset { mesh, stack, names, fields: fields.into_named() };
        let notices = self.dataset(team, to, &data, Options::default())?;
        Ok(if format.is_fields() { Vec::new() } else { named(to, notices) })
    }

    /// The metric of these logarithms, as [`Outputs::fields`] has it.
    pub fn logs(&mut self, team: Team<'_>, to: &Target, logs: &[Sym3], on: On<'_>) -> Result<Vec<String>, Failure> {
        let solution = Field::solution_of_logs(team, &to.path, logs)?;
        self.fields(team, to, Fields { solution, names: vec![METRIC.into()], mesh: None }, on)
    }

    /// A metric beside a mesh: .sol or .solb.
    pub fn metric(&mut self, team: Team<'_>, to: &Target, field: &Field) -> Done {
        Ok(field.add(&mut self.batch, team, &to.path)?)
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

    /// A file that comes from elsewhere.
    #[cfg(feature = "serve")]
    pub fn fetched(&mut self, to: &Target, fetch: impl FnOnce(&mut dyn std::io::Write) -> std::io::Result<()>) -> Done {
        Ok(self.batch.add(&to.path, fetch)?)
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

/// A mesh and its metric that a process has begun, for others that write some of them.
#[derive(Serialize, Deserialize)]
pub struct Begun {
    /// Where they are written.
    files: [OsString; 2],
    counts: MeshCounts,
}

/// A mesh and its metric that are being written by slices.
pub struct Slices {
    mesh: MeshWriter,
    metric: MetricWriter,
}

/// The rows of both that another process has written.
pub type Written = [Vec<slices::Written>; 2];

impl Slices {
    /// Those that another process has begun.
    ///
    /// # Errors
    /// Where its files are not here.
    pub fn join(begun: &Begun) -> Result<Self, Failure> {
        let [mesh, metric] = begun.files.each_ref().map(Path::new);
        let open = |path: &Path| {
            File::options().read(true).write(true).open(path).map_err(|error| {
                let wanted = "all processes write the output together, and it must be on a disk that all of them see";
                format!("{}: {error}; {wanted}", path.display())
            })
        };
        Ok(Self {
            mesh: MeshWriter::join(open(mesh)?, mesh, &begun.counts)?,
            metric: MetricWriter::join(open(metric)?, metric, begun.counts.vertices)?,
        })
    }

    /// What this process had to write is on the disk.
    pub fn leave(self) -> Result<Written, Failure> {
        Ok([self.mesh.leave()?, self.metric.leave()?])
    }

    /// Another process has written this.
    pub fn add_written(&self, [mesh, metric]: &Written) -> Done {
        self.mesh.add_written(mesh)?;
        Ok(self.metric.add_written(metric)?)
    }

    /// What a mesh without tetrahedra lists: its vertices are the first ones, with these metrics.
    pub fn put_listed(&self, team: Team<'_>, mesh: &TetMesh, metrics: &[Sym3]) -> Done {
        let Association { vertices, edges, faces } = &mesh.association;
        let lists = [
            Slice::Vertices(&mesh.vertices, &mesh.vertex_refs),
            Slice::Edges(&mesh.edges.nodes, &mesh.edges.refs),
            Slice::Triangles(&mesh.triangles.nodes, &mesh.triangles.refs),
            Slice::Corners(&mesh.corners),
            Slice::Ridges(&mesh.ridges),
            Slice::RequiredVertices(&mesh.required_vertices),
            Slice::RequiredEdges(&mesh.required_edges),
            Slice::RequiredTriangles(&mesh.required_triangles),
            Slice::OnVertices(vertices),
            Slice::OnEdges(edges),
            Slice::OnFaces(faces),
        ];
        lists.into_iter().try_for_each(|list| self.mesh.put(team, 0, list))?;
        Ok(Field::put(team, &self.metric, 0, metrics)?)
    }

    /// A slice of an adapted mesh.
    pub fn put(&self, slice: &decomposition::Slice) -> Done {
        let team = Team::alone();
        self.mesh.put(team, slice.first, Slice::Vertices(&slice.vertices, &slice.vertex_refs))?;
        self.mesh.put(team, slice.first_tet, Slice::Tets(&slice.tets.nodes, &slice.tets.refs))?;
        Ok(Field::put(team, &self.metric, slice.first, &slice.metrics)?)
    }

    /// All is written.
    pub fn finish(self) -> Done {
        self.mesh.finish()?;
        Ok(self.metric.finish()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_another_machine_does_not_see_are_told() {
        let folder = tempfile::tempdir().unwrap();
        let files = ["a.meshb", "a.solb"].map(|name| folder.path().join(name).into());
        let begun = Begun { files, counts: MeshCounts { vertices: 1, ..MeshCounts::default() } };
        let told = Slices::join(&begun).err().unwrap().to_string();
        assert!(told.contains("a.meshb") && told.contains("a disk that all of them see"), "{told}");
    }
}
