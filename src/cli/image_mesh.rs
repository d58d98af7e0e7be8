//! `geo-adapt image-mesh`.
use super::Outcome;
use super::figures::FigureArguments;
use super::files::{Files, Outputs};
use super::table::{Table, figure};
use crate::formats::Dataset;
use crate::image::{self, Counts, Domain, Extracted, Limits, Wish};
use crate::mesh::vector::volume6;
use crate::tasks::{Backend, Plan, Pool, Team, stage};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// Arguments of `geo-adapt image-mesh`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The image: .nrrd or .nhdr, of 3 axes. Integers are labels: 0 is outside, every other a region with that reference
    image: PathBuf,
    /// Where the mesh goes, in any format that `convert` writes
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Greatest circumradius of a tetrahedron, in the image's units [default: 4 voxels]
    #[arg(long, value_name = "H", value_parser = super::positive, allow_negative_numbers = true)]
    size: Option<f64>,
    /// Greatest distance of a surface triangle from the surface, in the image's units [default: half a voxel]
    #[arg(long, value_name = "D", value_parser = super::positive, allow_negative_numbers = true)]
    surface_distance: Option<f64>,
    /// Greatest ratio of circumradius to shortest edge [default: 2, the least that can always be reached]
    #[arg(long, value_name = "B", value_parser = bound, allow_negative_numbers = true)]
    radius_edge: Option<f64>,
    /// The image is grey, and one region: what is above this value
    #[arg(long, value_name = "V", allow_negative_numbers = true)]
    isovalue: Option<f64>,
    /// Threads [default: all cores]. With more than one the mesh differs from run to run, not what is said of it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), allow_negative_numbers = true)]
    threads: Option<u16>,
    /// Who runs the tasks of the threads
    #[arg(long, value_enum, default_value_t = Backend::default())]
    backend: Backend,
    #[command(flatten)]
    figures: FigureArguments,
}

/// Parses a bound on the radius-edge ratio.
fn bound(text: &str) -> Result<f64, String> {
    let value = super::positive(text)?;
    if value >= 1.0 { Ok(value) } else { Err("give 2, or more; below 1 refinement would not end".into()) }
}

/// What was done.
#[derive(Serialize)]
struct Report {
    limits: Limits,
    vertices: usize,
    tets: usize,
    triangles: usize,
    /// By reference.
    volumes: BTreeMap<i32, f64>,
    surfaces: Vec<image::Surface>,
    radius_edge: image::RadiusEdge,
    left_out: usize,
    counts: Counts,
    threads: usize,
    seconds: Seconds,
}

#[derive(Serialize)]
struct Seconds {
    read: f64,
    refine: f64,
    extract: f64,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let start = Instant::now();
    let mut files = Files::new().reads_images([&arguments.image]);
    let target = files.writes_mesh(&arguments.output, "-o")?;
    let json = arguments.figures.target(&mut files, &[])?;
    if arguments.isovalue.is_some_and(|value| !value.is_finite()) {
        return Err("--isovalue: give a finite number".into());
    }
    let name = arguments.image.display();
    let image = image::read(&arguments.image)?;
    let domain = Domain::new(&image, arguments.isovalue).map_err(|error| format!("{name}: {error}"))?;
    drop(image);
    stage("image read");
    let threads = arguments.threads.map_or_else(super::cores, usize::from);
    let pool = Pool::new(threads)?;
    pool.prepare(arguments.backend)?;
    let wish =
        Wish { size: arguments.size, surface_distance: arguments.surface_distance, radius_edge: arguments.radius_edge };
    let read = start.elapsed().as_secs_f64();
    let (store, limits, counts) =
        image::mesh(&domain, wish, &pool, arguments.backend).map_err(|error| format!("{name}: {error}"))?;
    let refined = start.elapsed().as_secs_f64();
    stage("refined");
    let Extracted { mesh, surfaces, radius_edge, left_out } = Extracted::new(&store, &domain, &limits);
    drop(store);
    if mesh.tets.is_empty() {
        return Err(format!("{name}: no tetrahedron is inside; give a smaller --size").into());
    }
    let mut volumes = BTreeMap::new();
    for (nodes, region) in mesh.tets.iter() {
        let [a, b, c, d] = nodes.map(|v| mesh.vertices[v as usize]);
        *volumes.entry(region).or_insert(0.0) += volume6(a, b, c, d) / 6.0;
    }
    let extracted = start.elapsed().as_secs_f64();
    stage("extracted");
    let [vertices, tets, triangles] = [mesh.vertices.len(), mesh.tets.len(), mesh.triangles.len()];
    let seconds = Seconds { read, refine: refined - read, extract: extracted - refined };
    let report = Report {
        limits,
        vertices,
        tets,
        triangles,
        volumes,
        surfaces,
        radius_edge,
        left_out,
        counts,
        threads,
        seconds,
    };
    let mut outputs = Outputs::new();
    let team = Team::new(&pool, Plan::default());
    let lost = outputs.mesh(team, &target, &Dataset { mesh, ..Dataset::default() })?;
    outputs.json(json.as_ref(), &report)?;
    outputs.commit()?;
    lost.iter().for_each(super::note);
    arguments.figures.print(&report, || describe(&report))?;
    Ok(ExitCode::SUCCESS)
}

/// The text for people.
fn describe(report: &Report) -> String {
    let Report { limits, radius_edge, counts, seconds, .. } = report;
    let mut table = Table::new();
    table.row("vertices", report.vertices);
    table.row("tetrahedra", report.tets);
    for (reference, volume) in &report.volumes {
        table.row(&format!("  region {reference}"), format_args!("volume {}", figure(*volume)));
    }
    table.row("triangles", report.triangles);
    for image::Surface { reference, between: [a, b], triangles } in &report.surfaces {
        let beside = |region: &i32| if *region == 0 { "outside".into() } else { format!("region {region}") };
        table.row(
            &format!("  reference {reference}"),
            format_args!("{triangles} between {} and {}", beside(a), beside(b)),
        );
    }
    table.row("size", figure(limits.size));
    table.row("surface distance", figure(limits.surface_distance));
    let inside = figure(radius_edge.greatest_inside);
    table.row(
        "radius-edge ratio",
        format_args!("greatest {}, away from surfaces {inside}", figure(radius_edge.greatest)),
    );
    let (above, away, bound) = (radius_edge.above_at_surfaces, radius_edge.above_inside, figure(limits.radius_edge));
    table.row("", format_args!("above {bound}: {above} at surfaces, {away} away from them"));
    if report.left_out > 0 {
        table.row("left out", format_args!("{} tetrahedra where the boundary touched itself", report.left_out));
    }
    let rate = (counts.surface_points + counts.inner_points) as f64 / seconds.refine.max(1e-9);
    table.row("attempts", format_args!("{}, of which {} met another thread", counts.attempts, counts.conflicts));
    let plural = if report.threads == 1 { "" } else { "s" };
    table.row(
        "seconds",
        format_args!(
            "{:.2} to refine, {rate:.0} vertices a second on {} thread{plural}",
            seconds.refine, report.threads
        ),
    );
    table.text().into()
}
