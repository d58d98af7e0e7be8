//! A mesh of any size as a .pvtu: read by slices, a piece each, with the boundary before them.
use super::super::files::reading::METRIC;
use super::super::files::{Files, Outputs};
use super::super::table::Table;
use super::{Arguments, Outcome};
use crate::formats::vtu::pieces::piece_path;
use crate::formats::{Dataset, NamedField};
use crate::geometry::names;
use crate::mesh::io::slices::{MeshReader, SolutionReader};
use crate::mesh::io::{self, FieldKind, SolutionField};
use crate::mesh::ranges::{gathered, renumbered, runs};
use crate::tasks::{Plan, Team};
use std::path::Path;
use std::process::ExitCode;

/// Tetrahedra of a piece.
const PIECE: usize = 1 << 20;

/// Whether a file is of pieces.
pub fn are_wanted(output: &Path) -> bool {
    output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("pvtu"))
}

/// The mesh, and the fields at its vertices with their names.
struct Source {
    mesh: MeshReader,
    fields: Option<(SolutionReader, Vec<String>)>,
}

type Failure = Box<dyn std::error::Error>;

/// Converts a .meshb with its .solb.
pub fn run(arguments: &Arguments) -> Outcome {
    crate::cli::say(converted(arguments, PIECE)?.text())?;
    Ok(ExitCode::SUCCESS)
}

/// As [`run`], with so many tetrahedra a piece. Returns what was done.
fn converted(arguments: &Arguments, size: usize) -> Result<Table, Failure> {
    let Arguments { input, output, fields, scale, translate, text, .. } = arguments;
    if *text || scale.is_some() || translate.is_some() {
        return Err(format!(
            "{}: a .pvtu is written as it is, in binary; leave --text, --scale and --translate away",
            output.display()
        )
        .into());
    }
    let source = Source::open(input, fields.as_deref())?;
    let names = match &arguments.names {
        Some(path) => names::read_file(path)?,
        None => names::read(input)?,
    };
    let counts = *source.mesh.counts();
    let count = 1 + counts.tets.div_ceil(size);
    let mut files = Files::new().reads_any([input]).reads(fields).reads(&arguments.names);
    let target = files.writes(output, "the output", &[])?;
    for number in 0..count {
        files.writes(&piece_path(output, number), "a piece of the output", &[])?;
    }
    let pool = super::super::pool()?;
    let team = Team::new(&pool, Plan::default());
    let mut outputs = Outputs::new();
    let mut boundary = source.boundary(team)?;
    boundary.names = names;
    outputs.piece(team, &target, 0, &mut boundary)?;
    for number in 1..count {
        let start = (number - 1) * size;
        let tets = source.mesh.tets(team, start..counts.tets.min(start + size))?;
        let mut piece = Dataset::default();
        piece.mesh.tets = tets;
        let numbers = renumbered(&mut [piece.mesh.tets.nodes.as_flattened_mut()]);
        source.put_vertices(team, &mut piece, &numbers)?;
        outputs.piece(team, &target, number, &mut piece)?;
    }
    outputs.pieces(&target, count, &boundary)?;
    outputs.commit()?;
    source.mesh.notices().iter().for_each(crate::cli::note);
    let mut table = Table::new();
    table.row("vertices", counts.vertices);
    table.row("tetrahedra", counts.tets);
    table.row("pieces", format_args!("{count}, the first has the boundary"));
    Ok(table)
}

impl Source {
    fn open(input: &Path, fields: Option<&Path>) -> Result<Self, Failure> {
        let mesh = MeshReader::open(input)?;
        let beside = input.with_extension("solb");
        let Some(path) = fields.or(Some(&beside).filter(|path| path.exists()).map(|path| path.as_path())) else {
            return Ok(Self { mesh, fields: None });
        };
        let file = SolutionReader::open(path)?;
        let (found, vertices) = (file.vertices(), mesh.counts().vertices);
        if found != vertices {
            let (path, input) = (path.display(), input.display());
            return Err(format!(
                "{path}: values at {found} vertices, and {input} has {vertices}; give the --fields of this mesh"
            )
            .into());
        }
        let given = names::read_fields(path)?;
        let name = |index: usize| match given.get(index) {
            Some(name) => name.clone(),
            None if file.kinds() == [FieldKind::SymmetricTensor] => METRIC.to_owned(),
            None => format!("field {}", index + 1),
        };
        let names = (0..file.kinds().len()).map(name).collect();
        Ok(Self { mesh, fields: Some((file, names)) })
    }

    /// Triangles and edges.
    fn boundary(&self, team: Team<'_>) -> Result<Dataset, Failure> {
        let counts = self.mesh.counts();
        let mut data = Dataset::default();
        data.mesh.triangles = self.mesh.triangles(team, 0..counts.triangles)?;
        data.mesh.edges = self.mesh.edges(team, 0..counts.edges)?;
        let mesh = &mut data.mesh;
        let numbers = renumbered(&mut [mesh.triangles.nodes.as_flattened_mut(), mesh.edges.nodes.as_flattened_mut()]);
        self.put_vertices(team, &mut data, &numbers)?;
        Ok(data)
    }

    /// The vertices of these numbers, with their fields.
    fn put_vertices(&self, team: Team<'_>, data: &mut Dataset, numbers: &[u32]) -> Result<(), Failure> {
        let points = |range| Ok::<_, io::Error>(self.mesh.vertices(Team::alone(), range)?.0);
        data.mesh.vertices = gathered(team, numbers, [0.0; 3], points)?;
        data.mesh.vertex_refs = vec![0; numbers.len()];
        let Some((file, names)) = &self.fields else { return Ok(()) };
        let named = names.iter().zip(file.kinds());
        data.fields = named.map(|(name, &kind)| NamedField { name: name.clone(), kind, values: Vec::new() }).collect();
        for places in runs(numbers) {
            let rows = &numbers[places];
            let (start, end) = (rows[0] as usize, rows[rows.len() - 1] as usize + 1);
            let read = file.fields(team, start..end)?.fields;
            for (field, SolutionField { kind, values }) in data.fields.iter_mut().zip(&read) {
                let width = kind.values();
                let at = |&row: &u32| &values[width * (row as usize - start)..][..width];
                field.values.extend(rows.iter().flat_map(at));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats;
    use crate::mesh::samples::cube;
    use crate::mesh::vector::volume6;
    use crate::metric::Sym3;
    use std::fs;

    fn arguments(folder: &Path, output: &str) -> Arguments {
        let [input, output] = ["in.meshb", output].map(|name| folder.join(name));
        let (fields, names, scale, translate) = (None, None, None, None);
        Arguments { input, output, fields, names, text: false, plain: false, split: false, scale, translate }
    }

    /// A cube with a metric and a name.
    fn written(folder: &Path) {
        let mut data = Dataset { mesh: cube(4), ..Dataset::default() };
        let tensor = |p: &[f64; 3]| Sym3::diagonal(1.0 + p[0], 2.0 + p[1], 3.0 + p[2]).0;
        let values = data.mesh.vertices.iter().flat_map(tensor).collect();
        data.fields.push(NamedField { name: METRIC.into(), kind: FieldKind::SymmetricTensor, values });
        data.names.triangles.insert(2, crate::geometry::Label { name: Some("wing".into()), colour: None });
        formats::write(&folder.join("in.meshb"), &data).unwrap();
    }

    #[test]
    fn the_pieces_are_the_mesh() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        written(folder);
        let output = folder.join("out.pvtu");
        converted(&arguments(folder, "out.pvtu"), 100).unwrap();
        let head = fs::read_to_string(&output).unwrap();
        assert_eq!(head.matches("<Piece Source=\"out_").count(), 5);
        assert!(head.contains("<PDataArray type=\"Float64\" Name=\"metric\" NumberOfComponents=\"6\"/>"), "{head}");
        let mut volume = 0.0;
        for number in 0..5 {
            let piece = formats::read(&piece_path(&output, number)).unwrap().content;
            let mesh = &piece.mesh;
            if number == 0 {
                assert!(mesh.triangles.len() == 192 && piece.names.triangles[&2].name.as_deref() == Some("wing"));
            } else {
                assert!(mesh.tets.len() == if number == 4 { 84 } else { 100 } && mesh.triangles.is_empty());
            }
            volume += mesh.tets.nodes.iter().fold(0.0, |sum, nodes| {
                let [a, b, c, d] = nodes.map(|v| mesh.vertices[v as usize]);
                sum + volume6(a, b, c, d) / 6.0
            });
            for (p, tensor) in mesh.vertices.iter().zip(piece.fields[0].values.as_chunks::<6>().0) {
                assert_eq!(*tensor, Sym3::diagonal(1.0 + p[0], 2.0 + p[1], 3.0 + p[2]).0);
            }
        }
        assert!((volume - 1.0).abs() < 1e-12);
        // Fewer pieces: the last ones are of the old mesh.
        converted(&arguments(folder, "out.pvtu"), 1000).unwrap();
        assert!(piece_path(&output, 1).exists() && !piece_path(&output, 2).exists());
    }

    #[test]
    fn what_is_no_meshb_and_a_field_of_another_mesh_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        fs::write(folder.join("in.meshb"), "MeshVersionFormatted 2\n").unwrap();
        let told = |arguments: &Arguments| converted(arguments, 100).err().unwrap().to_string();
        assert!(told(&arguments(folder, "out.pvtu")).contains("in.meshb"));
        written(folder);
        let short = [1.0; 12].to_vec();
        let fields = vec![SolutionField { kind: FieldKind::SymmetricTensor, values: short }];
        crate::mesh::io::write_solution(&folder.join("in.solb"), &crate::mesh::io::Solution { vertices: 2, fields })
            .unwrap();
        assert!(told(&arguments(folder, "out.pvtu")).contains("values at 2 vertices"));
        let text = Arguments { text: true, ..arguments(folder, "out.pvtu") };
        assert!(told(&text).contains("leave --text"));
    }
}
