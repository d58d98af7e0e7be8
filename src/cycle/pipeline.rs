//! The steps of a cycle, each by the commands that make it.
use super::adaptation::{self, TERMS, begun};
use super::config::{Goal, Loaded, TransferMethod, option};
use super::data::{Adapted, Begun, FieldName, SolveResult, text};
use super::done::Done;
use super::error::Error;
use super::field_value::{as_words, flow_values, values_of};
use super::layout::Layout;
use super::observer::Options;
use super::probe;
use super::solver::{Before, Choice, Job};
use super::step::{Running, Steps};
use crate::geometry::{Label, Names, called, names};
use crate::mesh::io::{
    Solution, SolutionField, read_mesh, read_mesh_and_stack, write_beside, write_mesh, write_solution,
};
use crate::mesh::samples::cube;
use crate::tasks::Team;
use std::collections::BTreeMap;
use std::path::Path;

/// Size of a picture, pixels: it goes into the report.
const PICTURE: &str = "800x600";

/// What makes steps.
pub struct Pipeline<'a> {
    /// The configuration.
    pub loaded: &'a Loaded,
    /// Where.
    pub steps: Steps<'a>,
    /// How.
    pub options: &'a Options,
    /// The words that say the threads, if the configuration does.
    pub threads: Vec<String>,
}

impl<'a> Pipeline<'a> {
    fn layout(&self) -> &'a Layout {
        self.steps.layout
    }

    /// The first mesh: bootstrapped, converted or copied.
    pub fn start(&self) -> Result<Done<Begun>, Error> {
        let mesh = &self.loaded.config.mesh;
        self.steps.step(self.layout().start(), |running| {
            let target = running.file("mesh.meshb");
            if let Some(model) = &mesh.bootstrap {
                let model = self.loaded.at(model);
                let mut words = vec!["bootstrap".into(), text(&model), "-o".into(), text(&target)];
                words.extend(self.loaded.config.bootstrap_words().into_iter().chain(self.threads.clone()));
                running.geo_adapt(words)?;
                return Ok(begun(self.loaded, &target));
            }
            if let Some(cells) = mesh.cube {
                write_mesh(&target, &cube(cells))?;
                return Ok(begun(self.loaded, &target));
            }
            let Some(file) = &mesh.file else {
                return Err(Error::Failed("[mesh] names neither file nor bootstrap".into()));
            };
            let file = self.loaded.at(file);
            if file.extension().is_some_and(|ending| ending == "meshb") {
                copy(&file, &target)?;
                names::write(&target, &names::read(&file)?, &[])?;
            } else {
                running.geo_adapt(vec!["convert".into(), text(&file), text(&target)])?;
            }
            self.check_stack(&target)?;
            Ok(begun(self.loaded, &target))
        })
    }

    /// Refuses prisms, pyramids and hexahedra of the first mesh that could not go through the loop.
    fn check_stack(&self, first: &Path) -> Result<(), Error> {
        let (_, stack) = read_mesh_and_stack(Team::alone(), first)?.content;
        if !stack.is_empty() && self.loaded.config.adapt.is_by_parts() {
            return Err(Error::Failed(format!(
                "the first mesh has {}, which are not kept where it is adapted part by part: leave [adapt] processes and memory out, or split them by \
                 `geo-adapt convert --split`",
                stack.told()
            )));
        }
        Ok(self.loaded.config.solver.solver().check_stack(&stack)?)
    }

    /// The solution on the mesh of a cycle; `before` are the fields of the last one, where it was brought here.
    pub fn solve(&self, cycle: u32, solver: &Choice, before: Option<&[FieldName]>) -> Result<Done<SolveResult>, Error> {
        let (layout, solver) = (self.layout(), solver.solver());
        self.steps.step(layout.step(cycle, "solve"), |running| {
            let (mesh, folder) = (layout.mesh(cycle), running.folder.clone());
            let path = before.map(|_| layout.transferred(cycle));
            let before = path.as_deref().zip(before).map(|(path, fields)| Before { path, fields });
            let base = &self.loaded.base;
            let (threads, thread_words) = (self.options.threads, &self.threads[..]);
            let job = Job { folder: &folder, base, cycle, mesh: &mesh, before, threads, thread_words };
            for call in solver.prepare(&job)? {
                running.call(&call)?;
            }
            let mut solved = solver.collect(&job)?;
            let (counted, stack) = read_mesh_and_stack(Team::alone(), &mesh)?.content;
            solved.check(counted.vertices.len())?;
            probe::add(&self.loaded.config.probes, &counted, &mut solved)?;
            self.loaded.config.goal.as_ref().map_or(Ok(()), |goal| goal.add(&mut solved))?;
            let fields: Vec<FieldName> = solved.fields.iter().map(FieldName::of).collect();
            let called: Vec<String> = fields.iter().map(|field| field.name.clone()).collect();
            let content =
                solved.fields.into_iter().map(|field| SolutionField { kind: field.kind, values: field.values });
            let solution = Solution { vertices: counted.vertices.len(), fields: content.collect() };
            write_solution(&layout.solution(cycle), &solution)?;
            names::write(&layout.solution(cycle), &Names::default(), &called)?;
            let (vertices, tets) = (counted.vertices.len(), stack.own_tets(&counted));
            Ok(SolveResult { vertices, tets, fields, functionals: solved.functionals })
        })
    }

    /// Which values of the solution the metric is made from, as `field pick --take` has them.
    fn sensors(&self, fields: &[FieldName]) -> Result<String, String> {
        Ok(as_words(&values_of(&self.loaded.config.metric.fields, fields)?))
    }

    /// Pictures of the mesh of a cycle: surface and cut.
    pub fn picture(&self, cycle: u32, fields: &[FieldName]) -> Result<(), Error> {
        let (layout, output) = (self.layout(), &self.loaded.config.output);
        self.steps.step(layout.step(cycle, "picture"), |running| {
            let (mesh, field) = (layout.mesh(cycle), running.file("field.solb"));
            let sensors = self.sensors(fields)?;
            let first = sensors.split(',').next().unwrap_or_default().to_owned();
            pick(running, &layout.solution(cycle), first, &field)?;
            // What the legend calls it.
            let asked = self.loaded.config.metric.fields.first();
            let name = asked.or_else(|| fields.iter().find(|field| field.values == 1).map(|field| &field.name));
            names::write(&field, &Names::default(), &Vec::from_iter(name.cloned()))?;
            let mut common =
                vec!["view".into(), text(&mesh), "--field".into(), text(&field), "--color".into(), "field".into()];
            common.extend(["--size".into(), PICTURE.into(), "-q".into()]);
            option(&mut common, "--view", output.view.map(|[a, e]| format!("{a},{e}")).as_ref());
            let mut surface = common.clone();
            let mut near = Vec::new();
            option(&mut near, "--zoom", output.zoom.as_ref());
            option(&mut near, "--at", output.at.map(|[x, y, z]| format!("{x},{y},{z}")).as_ref());
            let mut hidden = output.hide.clone();
            hidden.extend(around(&names::read(&mesh)?.triangles));
            if hidden.is_empty() {
                surface.extend(near.clone());
            } else {
                // What is left fills the picture.
                surface.extend(["--hide".into(), hidden.iter().map(i32::to_string).collect::<Vec<_>>().join(",")]);
            }
            surface.extend(["--png".into(), text(&running.file("surface.png"))]);
            running.geo_adapt(surface)?;
            // Where the picture is to look is told for all of the mesh.
            if !near.is_empty() {
                common.extend(["--hide".into(), "none".into()]);
            }
            common.extend(near);
            common.extend(["--cut-style".into(), "tets".into()]);
            let plane = output.cut.clone().map_or_else(|| middle(&mesh), Ok)?;
            common.extend(["--cut".into(), plane, "--png".into(), text(&running.file("cut.png"))]);
            running.geo_adapt(common)
        })?;
        Ok(())
    }

    /// What the metric is made from: the fields of the configuration, of the solution; or the terms of the goal.
    pub fn metric(&self, cycle: u32, solver: &Choice, fields: &[FieldName]) -> Result<(), Error> {
        let solution = self.layout().solution(cycle);
        self.steps.step(self.layout().step(cycle, "metric"), |running| match &self.loaded.config.goal {
            Some(goal) => write_terms(running, goal, solver, &solution, fields),
            None => pick(running, &solution, self.sensors(fields)?, &running.file("sensors.solb")),
        })?;
        Ok(())
    }

    /// The next mesh.
    pub fn adapt(&self, cycle: u32, begun: &Begun) -> Result<Done<Adapted>, Error> {
        let complexity = self.loaded.config.schedule.of_cycle(cycle);
        self.steps.step(self.layout().step(cycle, "adapt"), |running| {
            running.call(&adaptation::call(self.loaded, self.layout(), self.options.threads, cycle, begun)?)?;
            Ok(Adapted { complexity })
        })
    }

    /// The solution on the next mesh.
    pub fn transfer(&self, cycle: u32) -> Result<(), Error> {
        let (layout, method) = (self.layout(), self.loaded.config.transfer.method);
        self.steps.step(layout.step(cycle, "transfer"), |running| {
            let mut words = vec!["transfer".into(), text(&layout.mesh(cycle)), text(&layout.solution(cycle))];
            words.extend([text(&layout.mesh(cycle + 1)), "-o".into(), text(&running.file("solution.solb"))]);
            if method == TransferMethod::Conservative {
                words.push("--conservative".into());
            }
            words.extend(self.threads.clone());
            running.geo_adapt(words)
        })?;
        Ok(())
    }
}

/// The terms of a goal, with the files of its flow.
fn write_terms(
    running: &mut Running<'_>,
    goal: &Goal,
    solver: &Choice,
    solution: &Path,
    fields: &[FieldName],
) -> Result<(), Error> {
    let mut terms = goal.terms(solution, fields)?;
    let of_solver = solver.solver().flow();
    if let Some(flow) = goal.flow(of_solver.as_ref())? {
        let files = ["primal.solb", "adjoint.solb"].map(|name| running.file(name));
        for (values, file) in flow_values(flow, fields)?.iter().zip(&files) {
            pick(running, solution, as_words(values), file)?;
        }
        let [primal, adjoint] = files;
        terms.flow = Some(flow.at(primal, adjoint));
    }
    let text = toml::to_string(&terms).map_err(|error| error.to_string())?;
    Ok(write_beside(&running.file(TERMS), |file| file.write_all(text.as_bytes()))?)
}

/// Writes some values of a solution to a file of their own.
fn pick(running: &mut Running<'_>, solution: &Path, values: String, target: &Path) -> Result<(), Error> {
    let words = ["field".into(), "pick".into(), text(solution), "--take".into(), values, "-o".into(), text(target)];
    running.geo_adapt(words.into())
}

fn copy(from: &Path, to: &Path) -> Result<(), Error> {
    std::fs::copy(from, to).map(drop).map_err(|error| Error::Failed(format!("{}: {error}", from.display())))
}

/// The plane x = middle of the box.
fn middle(mesh: &Path) -> Result<String, Error> {
    let vertices = read_mesh(mesh)?.content.vertices;
    let ends =
        vertices.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| [low.min(p[0]), high.max(p[0])]);
    Ok(format!("x={}", (ends[0] + ends[1]) / 2.0))
}

/// What surrounds the body in a flow: it would hide the body, or make it small.
fn around(labels: &BTreeMap<i32, Label>) -> Vec<i32> {
    let far = called(labels, "farfield");
    let both = [far.clone(), called(labels, "symmetry")].concat();
    if far.is_empty() || both.len() == labels.len() { far } else { both }
}
