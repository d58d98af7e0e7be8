//! What a run part by part begins with: a mesh in memory, or one that is read by slices.
use super::Arguments;
use super::by_parts::agreed;
use super::input::{Error, Input, OnModel};
use crate::decomposition::{self, Adapted, Common, Files, Given, InMemory, Shell, Skin};
use crate::metric::{Source, Sym3};
use crate::ranks::Ranks;
use crate::tasks::Team;
use std::hash::{DefaultHasher, Hash, Hasher};

/// What a run begins with.
pub struct Begun {
    /// The mesh, or its boundary, on the model.
    pub on: OnModel,
    /// The complexity of the metric.
    pub complexity: f64,
    /// All else of the mesh.
    pub content: Content,
}

/// A mesh with its metric.
pub enum Content {
    /// In memory, with ln M at its vertices.
    Whole(Vec<Sym3>),
    /// In files, with what is known of them as a whole.
    Slices(Box<Files>, Shell),
}

impl Begun {
    /// Reads the mesh, puts it on its model and makes the metric, whose source comes too, where there is one for all of the mesh. Collective.
    pub fn with(
        arguments: &Arguments,
        team: Team<'_>,
        ranks: &dyn Ranks,
        notices: &mut Vec<String>,
    ) -> Result<(Self, Option<Source>), Error> {
        let (input, memory) = (&arguments.input, arguments.parts.memory);
        if input.can_be_sliced() {
            let told = notices.len();
            match input.read_slices(team, ranks, notices)? {
                Ok(begun) => {
                    let source = begun.analytic();
                    return Ok((begun, source));
                }
                // The triangles are added where the mesh is read as a whole.
                Err(decomposition::Error::Incomplete) if agreed(ranks, input.fits(memory))? => notices.truncate(told),
                Err(error) => return Err(error.of(&input.mesh).into()),
            }
        }
        let given = input.read(team, notices);
        let prepared = given
            .and_then(|given| given.without_stack(&input.mesh, "work part by part"))
            .and_then(|given| input.prepare(team, given, None, notices));
        let Input { on, source, .. } = agreed(ranks, prepared)?;
        notices.extend(agreed(ranks, input.without_drafts(team, &on).map_err(Error::from))?);
        let complexity = input.amount.complexity().unwrap_or_else(|| source.complexity(team, &on.mesh));
        let logs = decomposition::logs_on(team, &on.mesh, &source);
        Ok((Self { on, complexity, content: Content::Whole(logs) }, Some(source)))
    }

    /// The analytic field of a mesh in files, if that is where its metric comes from.
    fn analytic(&self) -> Option<Source> {
        match &self.content {
            Content::Whole(_) => None,
            Content::Slices(files, _) => files.analytic(),
        }
    }

    /// A name for it, and for how it is adapted.
    pub fn name(&self, how: &str) -> u64 {
        let Self { on, complexity, content } = self;
        let mut name = DefaultHasher::new();
        how.hash(&mut name);
        complexity.to_bits().hash(&mut name);
        on.place.entities.hash(&mut name);
        on.place.faces.hash(&mut name);
        name.write(bytemuck::cast_slice(&on.mesh.vertices));
        name.write(bytemuck::cast_slice(&on.mesh.tets.nodes));
        name.write(bytemuck::cast_slice(&on.mesh.tets.refs));
        name.write(bytemuck::cast_slice(&on.mesh.triangles.nodes));
        match content {
            Content::Whole(logs) => logs.iter().for_each(|log| name.write(bytemuck::bytes_of(&log.0))),
            Content::Slices(_, shell) => shell.name.hash(&mut name),
        }
        name.finish()
    }

    /// Adapts it, with the source that came with it. `name` is one for this and for the way.
    pub fn adapt<'a>(
        &self,
        common: Common<'a>,
        source: Option<Source>,
        name: u64,
        goes_on: impl FnOnce(usize),
    ) -> Result<Adapted<'a>, decomposition::Error> {
        let team = Team::new(common.pool, common.options.plan);
        let Self { on, content, .. } = self;
        let complexity = self.complexity;
        match content {
            Content::Whole(logs) => {
                let input = InMemory { mesh: &on.mesh, logs };
                let skin = Skin::of(team, &on.mesh, &on.place);
                decomposition::adapt(common, Given { input: &input, skin: &skin, source, complexity, name }, goes_on)
            }
            Content::Slices(files, shell) => {
                let skin = shell.skin(team, &on.place);
                decomposition::adapt(common, Given { input: &**files, skin: &skin, source, complexity, name }, goes_on)
            }
        }
    }
}
