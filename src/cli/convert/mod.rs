//! `geo-adapt convert`.
mod pieces;

use super::Outcome;
use super::files::{Files, Outputs};
use super::table::Table;
use super::translation::Translation;
use crate::formats::{self, Dataset, Format, Options, Placement};
use crate::geometry::{Label, names};
use crate::mesh::io::FieldKind;
use crate::mesh::stack::Stack;
use crate::tasks::{Plan, Team};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;

/// Most names that are listed; of more only the number is given.
const LISTED: usize = 16;

/// Arguments of `geo-adapt convert`.
#[derive(clap::Args)]
#[command(
    after_help = "Formats: .mesh, .meshb (with .solb and .names.json beside), .su2, .vtu, .pvtu (written alone, of a .meshb, a slice at a time), .vtk (legacy), \
                        .xdmf (FEniCSx) and .xmf (meshio, ParaView) with .h5 beside, .cgns (on HDF5), .msh (gmsh 4.1; reads 2.2 too), .msh2 (gmsh 2.2), .inp (Abaqus, CalculiX), .bdf and .nas (Nastran), \
                        .ugrid, .b8.ugrid, .lb8.ugrid (with .mapbc beside), folders (cases of OpenFOAM; \
                        a new one is named with a / at its end); the surface alone: .stl, .obj, .ply; fields alone: .sol, .solb, .csv, .dat (SU2)"
)]
pub struct Arguments {
    /// The mesh
    input: PathBuf,
    /// Where it goes, in the format that the extension tells
    output: PathBuf,
    /// Fields at the vertices of the mesh, instead of its own: .sol, .solb, or a restart of SU2 (.csv, .dat)
    #[arg(long, value_name = "FILE")]
    fields: Option<PathBuf>,
    /// Names of the references, instead of the mesh's own: JSON, as bootstrap writes it
    #[arg(long, value_name = "FILE")]
    names: Option<PathBuf>,
    /// Write text where the format would be binary (.vtu, .vtk, .xdmf, .msh, .ply, OpenFOAM)
    #[arg(long)]
    text: bool,
    /// Split prisms, pyramids and hexahedra into tetrahedra, and quadrilaterals into triangles, without new vertices
    #[arg(long)]
    split: bool,
    /// Leave the association with a model out of .mesh and .meshb: there are readers, meshio's among them, that stop at its keywords
    #[arg(long)]
    plain: bool,
    /// Multiply coordinates, about the origin: 0.001 from millimetres to metres. A metric goes with them; other fields keep their values
    #[arg(long, value_name = "F", value_parser = super::positive, allow_negative_numbers = true)]
    scale: Option<f64>,
    /// Move by this, after --scale
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    translate: Option<Translation>,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let Arguments { input, output, fields, names, text, split, plain, scale, translate } = arguments;
    if pieces::are_wanted(output) {
        return pieces::run(arguments);
    }
    let format = Format::of(output)?;
    let mut files = Files::new().reads_any([input]).reads(fields).reads(names);
    let target = files.writes_any(output, "the output")?;
    let pool = super::pool()?;
    let team = Team::new(&pool, Plan::default());
    let read = formats::read_on(team, input)?;
    let (mut data, mut notices) = (read.content, read.notices);
    if let Some(path) = fields {
        notices.extend(formats::read_fields_on(team, path, &mut data)?);
    }
    if let Some(path) = names {
        data.names = names::read_file(path)?;
    }
    if scale.is_some() || translate.is_some() {
        let placement = Placement { scale: scale.unwrap_or(1.0), translation: translate.unwrap_or_default().0 };
        notices.extend(placement.apply(&mut data));
    }
    if *split {
        data.stack = Stack::default();
    }
    if *plain {
        data.mesh.association = Default::default();
    }
    let mut outputs = Outputs::new();
    let lost = outputs.dataset(team, &target, &data, Options { text: *text })?;
    outputs.commit()?;
    notices.iter().for_each(crate::cli::note);
    lost.iter().for_each(|notice| crate::cli::note(format_args!("{}: {notice}", output.display())));
    super::say(describe(&data, format).text())?;
    Ok(ExitCode::SUCCESS)
}

/// What was read.
fn describe(data: &Dataset, to: Format) -> Table {
    let mut table = Table::new();
    let mesh = &data.mesh;
    if !to.is_fields() {
        table.row("vertices", mesh.vertices.len());
        let [tets, triangles] =
            if data.stack.is_empty() { [mesh.tets.len(), mesh.triangles.len()] } else { data.stack.own() };
        let rows = [
            ("tetrahedra", tets, &data.names.tetrahedra),
            ("triangles", triangles, &data.names.triangles),
            ("edges", mesh.edges.len(), &data.names.edges),
        ];
        for (name, count, labels) in rows {
            if count > 0 {
                table.row(name, format_args!("{count}{}", listed(labels)));
            }
        }
    }
    if !data.stack.is_empty() {
        table.row("other cells", data.stack.told());
        table.row("quadrilaterals", data.stack.quads.len());
    }
    for field in &data.fields {
        let kind = match field.kind {
            FieldKind::Scalar => "scalar",
            FieldKind::Vector => "vector",
            FieldKind::SymmetricTensor => "symmetric tensor",
            FieldKind::Tensor => "tensor",
        };
        table.row("field", format_args!("{} ({kind})", field.name));
    }
    table
}

/// Names with their references, in parentheses.
fn listed(labels: &BTreeMap<i32, Label>) -> String {
    let named = labels.iter().filter_map(|(reference, label)| Some(format!("{reference}: {}", label.name.as_ref()?)));
    let named: Vec<String> = named.collect();
    match named.len() {
        0 => String::new(),
        count if count > LISTED => format!(" ({count} names)"),
        _ => format!(" ({})", named.join(", ")),
    }
}
