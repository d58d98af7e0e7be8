//! Reading the fields that a metric is made from, and the options of the multiscale metric; `adapt --field` has them too.
use super::common::{Failure, GradationArgument, LimitArguments};
use crate::cli::files::reading::{self, Carrier};
use crate::mesh::TetMesh;
use crate::mesh::io::slices::{MeshReader, SolutionReader};
use crate::mesh::io::{FieldKind, Read, Solution};
use crate::mesh::ranges::Scratch;
use crate::mesh::split_nonmanifold::copy_values;
use crate::metric::multiscale::{self, Bounds, Cut, Measure, Norm, Options, SizeBound, Summary, multiscale};
use crate::metric::out_of_core::{self, Sizes, Step};
use crate::metric::recovery::Recovery;
use crate::metric::{Limits, Sym3};
use crate::tasks::Team;
use clap::ValueEnum;
use serde::Serialize;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// How several files become one metric.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Combine {
    /// They are steps in time of the same fields: the Hessians |H| of each are averaged
    #[default]
    Average,
    /// They are fields of their own: the metrics of all are intersected
    Intersect,
}

/// The options of the multiscale metric.
#[derive(Clone, clap::Args)]
pub struct MultiscaleArguments {
    /// The p of the L^p norm of the interpolation error: 1, 2, 4, any number from 1 on, or inf [default: 2; of a goal 1]
    #[arg(long, value_name = "P", allow_negative_numbers = true)]
    norm: Option<Norm>,
    /// How second derivatives are recovered
    #[arg(long, value_enum, default_value_t = Recovery::default())]
    hessian: Recovery,
    /// Use only value K of each vertex, from 1 (of a vector its component, of several fields counted through them all)
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..), allow_negative_numbers = true)]
    component: Option<u32>,
    /// What several FIELD files are (the scalars within a file are intersected in any case)
    #[arg(long, value_enum, default_value_t = Combine::default())]
    combine: Combine,
    #[command(flatten)]
    gradation: GradationArgument,
    #[command(flatten)]
    limits: LimitArguments,
}

/// The options that say how a metric is made, as [`MultiscaleArguments`] has them,
pub const OF_MADE: [&str; 2] = ["norm", "hessian"];
/// and those that say which fields it is made of.
pub const OF_FIELD: [&str; 2] = ["component", "combine"];

/// The options that bound sizes.
pub const BOUNDS: [&str; 4] = ["gradation", "hmin", "hmax", "aspect_ratio"];

/// The metric that was made, for tables and JSON.
#[derive(Clone, Serialize)]
pub struct Made {
    #[serde(serialize_with = "crate::cli::files::text::paths")]
    fields: Vec<PathBuf>,
    sensors: usize,
    steps: usize,
    combine: Combine,
    component: Option<u32>,
    hessian: Recovery,
    norm: Norm,
    gradation: Option<f64>,
    complexity_wanted: f64,
    #[serde(flatten)]
    summary: Summary,
}

impl MultiscaleArguments {
    /// The same without bounds of sizes and of their growth.
    pub fn unbounded(&self) -> Self {
        Self { gradation: GradationArgument::off(), limits: LimitArguments::none(), ..self.clone() }
    }

    /// The bounds of the sizes.
    pub fn limits(&self) -> Result<Limits, String> {
        self.limits.limits()
    }

    /// Greatest growth; none when off.
    pub fn growth(&self) -> Option<f64> {
        self.gradation.ratio()
    }

    /// The norm that was given, if one was, and how Hessians are recovered.
    pub fn how(&self) -> (Option<Norm>, Recovery) {
        (self.norm, self.hessian)
    }

    /// Whether a bound or a growth was given.
    pub fn bounds_are_given(&self) -> bool {
        self.gradation.is_given() || self.limits.limits() != Ok(Limits::default())
    }

    /// ln M at the vertices of the mesh, shape (n,), made from the fields that these arguments name, and what was done; `fixed`, ln of
    /// another metric, is intersected at any scale, and sizes are bounded `by_others`. The last vertices are `copies`, on which the files have nothing. Notices are added.
    pub fn make(
        &self,
        team: Team<'_>,
        (mesh, copies): (&TetMesh, &[u32]),
        (paths, of): (&[PathBuf], Carrier<'_>),
        (complexity, measure): (f64, Measure),
        (fixed, by_others): (Option<&[Sym3]>, Option<&dyn SizeBound>),
        notices: &mut Vec<String>,
    ) -> Result<(Vec<Sym3>, Made), Failure> {
        let limits = self.limits.limits()?;
        let mut files = Vec::new();
        for path in paths {
            let Read { content, notices: found } = reading::fields(team, path, of)?;
            notices.extend(found);
            let mut scalars = self.scalars(path, content.solution, mesh.vertices.len() - copies.len())?;
            scalars.iter_mut().for_each(|values| copy_values(values, copies));
            files.push(scalars);
        }
        let views: Vec<Vec<&[f64]>> = files.iter().map(|scalars| scalars.iter().map(Vec::as_slice).collect()).collect();
        let (sensors, names) = self.sensors(paths, &views)?;
        let (norm, recovery, gradation) = (self.norm.unwrap_or_default(), self.hessian, self.gradation.ratio());
        let bounds = Bounds { complexity, measure, gradation, limits, fixed, by_others };
        let options = Options { recovery, norm, bounds };
        let (logs, summary) =
            multiscale(team, mesh, &sensors, &options).map_err(|error| named_sensor(&error, &names))?;
        Ok((logs, self.made(paths, &sensors, complexity, summary)))
    }

    /// As [`MultiscaleArguments::make`], from files: the metric of a .meshb is in a scratch folder, and no more memory is used than is asked for.
    pub fn make_of_files<'t>(
        &self,
        team: Team<'t>,
        mesh: &MeshReader,
        paths: &[PathBuf],
        complexity: f64,
        (memory, scratch): (u64, &Scratch),
        notices: &mut Vec<String>,
    ) -> Result<(out_of_core::Metric<'t>, Made), Failure> {
        if self.hessian != Recovery::Fit {
            let name = self.hessian.name();
            return Err(
                format!("--hessian {name} needs all of the mesh in memory: leave --memory out, or --hessian").into()
            );
        }
        let (norm, gradation, limits) = (self.norm.unwrap_or_default(), self.gradation.ratio(), self.limits.limits()?);
        let vertices = mesh.counts().vertices;
        let files = paths.iter().map(|path| SolutionReader::open(path)).collect::<Result<Vec<_>, _>>()?;
        let mut steps = Vec::new();
        for (path, file) in paths.iter().zip(&files) {
            notices.extend_from_slice(file.notices());
            let components = self.components(path, file.kinds(), [file.vertices(), vertices])?;
            steps.push(components.map(|component| Step { file, component }).collect::<Vec<_>>());
        }
        let (sensors, names) = self.sensors(paths, &steps)?;
        let sizes = Sizes::of(memory, team.threads(), gradation.is_some(), mesh.counts())?;
        let options = out_of_core::Options { norm, complexity, gradation, limits };
        let made = out_of_core::multiscale(team, mesh, &sensors, &options, (&sizes, scratch));
        let (metric, summary) = made.map_err(|error| match error {
            out_of_core::Error::Multiscale(error) => named_sensor(&error, &names).into(),
            error => Failure::from(error),
        })?;
        Ok((metric, self.made(paths, &sensors, complexity, summary)))
    }

    /// What was made of these files.
    fn made<T>(&self, paths: &[PathBuf], sensors: &[Vec<T>], complexity_wanted: f64, summary: Summary) -> Made {
        Made {
            fields: paths.to_vec(),
            sensors: sensors.len(),
            steps: sensors.first().map_or(0, Vec::len),
            combine: self.combine,
            component: self.component,
            hessian: self.hessian,
            norm: self.norm.unwrap_or_default(),
            gradation: self.gradation.ratio(),
            complexity_wanted,
            summary,
        }
    }

    /// The scalars of a file, each with a value a vertex.
    fn scalars(&self, path: &Path, solution: Solution, vertices: usize) -> Result<Vec<Vec<f64>>, String> {
        let kinds: Vec<FieldKind> = solution.fields.iter().map(|field| field.kind).collect();
        let components = self.components(path, &kinds, [solution.vertices, vertices])?;
        if self.component.is_some() {
            return Ok(components.filter_map(|index| solution.component(index)).collect());
        }
        Ok(solution.fields.into_iter().map(|field| field.values).collect())
    }

    /// Which numbers of each vertex are scalars of their own, in a file with these fields at so many vertices, of a mesh of so many.
    fn components(
        &self,
        path: &Path,
        kinds: &[FieldKind],
        [found, vertices]: [usize; 2],
    ) -> Result<Range<usize>, String> {
        let name = path.display();
        if found != vertices {
            return Err(format!(
                "{name}: values at {found} vertices, but the mesh has {vertices}: give a field of this mesh"
            ));
        }
        let count: usize = kinds.iter().map(|kind| kind.values()).sum();
        if let Some(component) = self.component {
            let index = component as usize;
            if index <= count {
                return Ok(index - 1..index);
            }
            return Err(format!("{name}: {count} values a vertex, but --component is {component}; give 1 to {count}"));
        }
        if count == 0 {
            return Err(format!("{name}: no field at the vertices; give a file with a scalar field"));
        }
        if kinds.iter().any(|&kind| kind != FieldKind::Scalar) {
            let remedy =
                format!("choose one of the {count} values a vertex by --component 1 to {count}, such as a vector's x");
            return Err(format!("{name}: not all fields are scalars (libMeshb type 1); {remedy}"));
        }
        Ok(0..count)
    }

    /// The scalars of the files as sensors with their steps in time, and what each is called in errors.
    fn sensors<T: Copy>(&self, paths: &[PathBuf], files: &[Vec<T>]) -> Result<(Vec<Vec<T>>, Vec<String>), String> {
        let field = |path: &Path, number: usize, of: usize| match of {
            1 => path.display().to_string(),
            _ => format!("{}: field {}", path.display(), number + 1),
        };
        let (Some(first), Some(path)) = (files.first(), paths.first()) else { return Err("no field is given".into()) };
        if self.combine == Combine::Intersect {
            let sensors = files.iter().flatten().map(|&scalar| vec![scalar]).collect();
            let names = paths.iter().zip(files).flat_map(|(path, scalars)| {
                (0..scalars.len()).map(|number| field(path, number, scalars.len())).collect::<Vec<_>>()
            });
            return Ok((sensors, names.collect()));
        }
        if let Some((other, scalars)) = paths.iter().zip(files).find(|(_, scalars)| scalars.len() != first.len()) {
            let (here, there) = (scalars.len(), first.len());
            return Err(format!(
                "{}: {here} fields, but {} has {there}: steps in time have the same fields; files of different fields go with \
                 --combine intersect",
                other.display(),
                path.display()
            ));
        }
        let sensors = (0..first.len()).map(|k| files.iter().map(|scalars| scalars[k]).collect()).collect();
        let more = if paths.len() > 1 { format!(" and the {} other steps", paths.len() - 1) } else { String::new() };
        Ok((sensors, (0..first.len()).map(|k| field(path, k, first.len()) + &more).collect()))
    }
}

/// The error with the file of its sensor, if it has one.
fn named_sensor(error: &multiscale::Error, names: &[String]) -> String {
    match *error {
        multiscale::Error::Flat { sensor } | multiscale::Error::NotFinite { sensor, .. } => {
            format!("{}: {error}", names[sensor])
        }
        _ => error.to_string(),
    }
}

impl Made {
    /// What the bound of sizes by each other has cut.
    pub fn cut(&self) -> Option<Cut> {
        self.summary.cut
    }

    /// Rows of a table that tell what was done.
    pub fn rows(&self, table: &mut crate::cli::table::Table) {
        use crate::cli::table::figure;
        let Summary { complexity_before_gradation, complexity, limited, unfitted, rounds, .. } = self.summary;
        let fields = match (self.sensors, self.steps) {
            (1, 1) => String::new(),
            (sensors, 1) => format!(" ({sensors} scalars, metrics intersected)"),
            (1, steps) => format!(" ({steps} steps, |H| averaged)"),
            (sensors, steps) => format!(" ({sensors} scalars, metrics intersected, of {steps} steps, |H| averaged)"),
        };
        let names: Vec<_> = self.fields.iter().map(|path| path.display().to_string()).collect();
        table.row("field", format_args!("{}{fields}", names.join(", ")));
        table.row("hessian", self.hessian.name());
        if unfitted > 0 {
            table.row("hessian of neighbours", format_args!("{unfitted} vertices: too few points around them"));
        }
        table.row("norm", format_args!("L^{}", self.norm));
        match self.gradation {
            Some(ratio) => table.row("gradation", figure(ratio)),
            None => table.row("gradation", "off"),
        }
        table.row("limited", format_args!("{limited} vertices"));
        table.row("complexity wanted", figure(self.complexity_wanted));
        table.row(
            "complexity reached",
            format_args!(
                "{} ({} before gradation; {rounds} rounds)",
                figure(complexity),
                figure(complexity_before_gradation)
            ),
        );
    }
}
