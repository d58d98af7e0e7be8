//! Reading the meshes and fields of a command, in whatever format they come: nothing else in `cli` reads them.
use crate::formats::{self, Dataset, Format, NamedField};
use crate::geometry::names;
use crate::mesh::io::slices::MeshReader;
use crate::mesh::io::{self, FieldKind, Read, Solution, SolutionField};
use crate::mesh::vector::Vec3;
use crate::metric::{Field, Sym3};
use crate::tasks::Team;
use std::path::Path;

type Failure = Box<dyn std::error::Error>;

/// Reads a mesh with its names and the fields of its file. What lies beside .mesh and .meshb need not be of it: [`fields`] finds it where it
/// is asked for by its name.
pub fn mesh(team: Team<'_>, path: &Path) -> Result<Read<Dataset>, io::Error> {
    if Format::of_file(path)? != Format::Libmeshb {
        return formats::read_on(team, path);
    }
    let Read { content: (mesh, stack), notices } = io::read_mesh_and_stack(team, path)?;
    Ok(Read { content: Dataset { mesh, stack, names: names::read(path)?, ..Dataset::default() }, notices })
}

/// Opens a volume mesh (.meshb) that is larger than memory, to be read by slices.
pub fn mesh_by_slices(path: &Path) -> Result<MeshReader, Failure> {
    if Format::of_file(path)? != Format::Libmeshb {
        let remedy = "bring it into .meshb by `geo-adapt convert`, or leave --memory out";
        return Err(format!("{}: with --memory only .meshb is read: {remedy}", path.display()).into());
    }
    let mesh = MeshReader::open(path)?;
    names::read(path)?;
    mesh.notices().iter().for_each(crate::cli::note);
    if mesh.counts().tets == 0 {
        return Err(format!("{}: no tetrahedra: a volume mesh is needed", path.display()).into());
    }
    Ok(mesh)
}

/// The mesh that fields are wanted for.
#[derive(Clone, Copy)]
pub struct Carrier<'m> {
    /// Its file.
    pub path: &'m Path,
    /// Its vertices.
    pub vertices: &'m [Vec3],
    /// The fields of its file.
    pub fields: &'m [NamedField],
}

impl<'m> Carrier<'m> {
    /// A mesh as it was read.
    pub fn of(path: &'m Path, data: &'m Dataset) -> Self {
        Self { path, vertices: &data.mesh.vertices, fields: &data.fields }
    }
}

/// Fields as they were read.
#[derive(Debug, Default)]
pub struct Fields {
    /// The fields.
    pub solution: Solution,
    /// What they are called; none where the file does not say.
    pub names: Vec<String>,
    /// The mesh that their file holds too, without its fields.
    pub mesh: Option<Dataset>,
}

impl Fields {
    fn named(fields: Vec<NamedField>, vertices: usize) -> Self {
        let (mut names, mut found) = (Vec::new(), Vec::new());
        for NamedField { name, kind, values } in fields {
            names.push(name);
            found.push(SolutionField { kind, values });
        }
        Self { solution: Solution { vertices, fields: found }, names, mesh: None }
    }

    /// The fields with their names, such as tell their number where they have none.
    pub fn into_named(self) -> Vec<NamedField> {
        let Self { solution, names, .. } = self;
        let name = |index: usize| names.get(index).cloned().unwrap_or_else(|| format!("field {}", index + 1));
        let fields = solution.fields.into_iter().enumerate();
        fields.map(|(index, field)| NamedField { name: name(index), kind: field.kind, values: field.values }).collect()
    }

    /// Leaves the metric alone, where names or kinds tell which it is: among other fields it is called metric, or is the only symmetric
    /// tensor.
    fn keep_metric(&mut self) {
        let is_tensor = |field: &SolutionField| field.kind == FieldKind::SymmetricTensor;
        let tensors: Vec<usize> = (0..self.names.len()).filter(|&k| is_tensor(&self.solution.fields[k])).collect();
        let called = tensors.iter().copied().find(|&k| self.names[k] == METRIC);
        let found = called.or(tensors.first().copied().filter(|_| tensors.len() == 1));
        if let Some(found) = found {
            self.solution.fields = vec![self.solution.fields.swap_remove(found)];
            self.names = vec![self.names.swap_remove(found)];
        }
    }
}

/// What a metric is called among the fields of a file.
pub const METRIC: &str = "metric";

/// Reads the fields that an argument names: a file of fields (.sol, .solb, .csv, .dat), a mesh with fields in it or beside it, or the name
/// of a field of the `carrier`, in its file or beside it. Whether there are as many values as vertices is not asked.
pub fn fields(team: Team<'_>, asked: &Path, carrier: Carrier<'_>) -> Result<Read<Fields>, Failure> {
    let format = match Format::of(asked).ok().filter(|&format| format != Format::Foam) {
        Some(format) => format,
        None => match of_carrier(asked, carrier)? {
            Some(read) => return Ok(read),
            // A solution is known by its content, and so is a mesh.
            None => Some(Format::of_file(asked)?).filter(|&f| f != Format::Libmeshb).unwrap_or(Format::Solution),
        },
    };
    match format {
        Format::Solution => {
            let Read { content, notices } = io::read_solution_on(team, asked)?;
            Ok(Read { content: Fields { solution: content, ..Fields::default() }, notices })
        }
        Format::Table | Format::Restart => {
            let mut data = Dataset::default();
            data.mesh.vertices = carrier.vertices.to_vec();
            let notices = formats::read_fields_on(team, asked, &mut data)?;
            Ok(Read { content: Fields::named(data.fields, carrier.vertices.len()), notices })
        }
        _ => {
            let Read { content: Dataset { mesh, stack, names, fields }, notices } = formats::read_on(team, asked)?;
            if fields.is_empty() {
                let message = "no field at the vertices; give a file of fields, or a mesh with fields in its file";
                return Err(format!("{}: {message}", asked.display()).into());
            }
            let mut found = Fields::named(fields, mesh.vertices.len());
            found.mesh = Some(Dataset { mesh, stack, names, fields: Vec::new() });
            Ok(Read { content: found, notices })
        }
    }
}

/// The field of this name that the carrier has; none where there is none and a file of the name.
fn of_carrier(asked: &Path, carrier: Carrier<'_>) -> Result<Option<Read<Fields>>, Failure> {
    let (path, vertices) = (carrier.path, carrier.vertices.len());
    let mut notices = Vec::new();
    let beside;
    let mut known = carrier.fields;
    if known.is_empty() && Format::of_file(path)? == Format::Libmeshb {
        let read = formats::fields_beside(path, vertices)?;
        notices = read.notices;
        beside = read.content;
        known = &beside;
    }
    if let Some(field) = known.iter().find(|field| asked.to_str() == Some(&field.name)) {
        return Ok(Some(Read { content: Fields::named(vec![field.clone()], vertices), notices }));
    }
    if asked.exists() {
        return Ok(None);
    }
    let there: Vec<&str> = known.iter().map(|field| field.name.as_str()).take(20).collect();
    let there = if there.is_empty() { "it has none".into() } else { format!("there are {}", there.join(", ")) };
    let meant = io::meant(asked, &std::io::ErrorKind::NotFound.into());
    let (asked, path) = (asked.display(), path.display());
    Err(format!(
        "{asked}: No such file, and {path} has no field of this name ({there}); give a file or one of its fields{meant}"
    )
    .into())
}

/// Reads the metric that an argument names, as [`fields`] has it, and leaves other fields of its file out.
pub fn metric(team: Team<'_>, asked: &Path, carrier: Carrier<'_>) -> Result<Read<Fields>, Failure> {
    let mut read = fields(team, asked, carrier)?;
    read.content.keep_metric();
    Ok(read)
}

/// The same as ln M; of `vertices` of them, where that is known. With it the mesh that its file holds too.
pub fn logs(
    team: Team<'_>,
    asked: &Path,
    carrier: Carrier<'_>,
    vertices: Option<usize>,
) -> Result<(Read<Vec<Sym3>>, Option<Dataset>), Failure> {
    let Read { content: found, mut notices } = metric(team, asked, carrier)?;
    let logs = Field::logs_of_solution(team, asked, &found.solution, vertices)?;
    notices.extend(logs.notices);
    Ok((Read { content: logs.content, notices }, found.mesh))
}
