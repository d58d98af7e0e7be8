//! What the kernel's tests work on: small meshes with a model and a metric, and sweeps over all of their items in random order.
use crate::adapt::core::check::{check, check_part, open_faces};
use crate::adapt::core::context::{Context, Limits};
use crate::adapt::core::edge_list::EdgeItem;
use crate::adapt::core::fill::{self, Filled, Known};
use crate::adapt::core::ids::{EDGE, FACE, TetId, VertexId};
use crate::adapt::core::refusal::Counts;
use crate::adapt::core::required::{Freeze, Required};
use crate::adapt::core::worker::State;
use crate::adapt::operations::collapse::onto_end::Collapse;
use crate::adapt::operations::collapse::thinning::Thin;
use crate::adapt::operations::insertion::edge_split::Split;
use crate::adapt::operations::projection::{Project, RemoveUnprojected};
use crate::adapt::operations::reconnection::criteria::Criterion;
use crate::adapt::operations::reconnection::sweep::Reconnect;
use crate::adapt::operations::repair::Repair;
use crate::adapt::operations::smoothing::vertex::Smooth;
use crate::adapt::passes::pipeline::Pipeline;
use crate::adapt::schedule::work::{Kind, Silent};
use crate::adapt::schedule::{self, Execution, Grains, Operation, Scheduler};
use crate::geometry::classify::Classification;
use crate::geometry::discrete::{DEFAULT_RIDGE_ANGLE, complete_boundary, samples};
use crate::geometry::{Discrete, Model};
use crate::mesh::TetMesh;
use crate::mesh::adjacency::{FACES, MatchedFaces, NONE, TriangleIndex, sorted2};
use crate::mesh::vector::{Vec3, lerp, norm, volume6};
use crate::metric::{Background, Source, Sym3};
use crate::tasks::{Plan, Pool, Team};
use std::collections::{BTreeMap, BTreeSet};

/// Numbers that repeat from run to run (splitmix64).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.below(i + 1));
        }
    }
}

/// The shapes of the tests.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    /// Six faces, twelve edges, eight corners.
    Cube,
    /// A cube of two regions: an interface with a closed chain of ridges about it.
    TwoRegions,
    /// Half way from the cube to the ball: curved faces.
    Round,
}

/// A mesh with all that is needed to adapt it.
pub struct Sample {
    pub mesh: TetMesh,
    pub place: Classification,
    pub model: Model,
    pub source: Source,
    /// Of a part of a larger mesh, the vertices and the triangles that must stay.
    pub held: Option<[Vec<u32>; 2]>,
    /// The volume, if its surface is plane.
    volume: f64,
}

impl Sample {
    /// A part of it: the tetrahedra that are wanted, by their vertices.
    pub fn part(mut self, is_wanted: impl Fn(&[u32; 4]) -> bool) -> Self {
        let mesh = &mut self.mesh;
        let (whole, all) = (mesh.tets.clone(), mesh.triangles.clone());
        mesh.tets = Default::default();
        for (nodes, region) in whole.iter().filter(|(nodes, _)| is_wanted(nodes)) {
            mesh.tets.push(nodes, region);
        }
        self.volume = mesh.tets.len() as f64 / whole.len() as f64;
        // Triangles and ridges of what is there.
        let index = TriangleIndex::new(Team::alone(), &all.nodes, mesh.vertices.len());
        let sides = |tets: &[[u32; 4]]| {
            let mut sides = vec![0; all.len()];
            index.sides(Team::alone(), tets).iter().for_each(|side| sides[side.triangle as usize] += 1);
            sides
        };
        let [before, now] = [sides(&whole.nodes), sides(&mesh.tets.nodes)];
        mesh.triangles = Default::default();
        let (faces, mut halves) = (std::mem::take(&mut self.place.faces), Vec::new());
        for t in (0..all.len()).filter(|&t| now[t] > 0) {
            if now[t] < before[t] {
                halves.push(mesh.triangles.len() as u32);
            }
            mesh.triangles.push(all.nodes[t], all.refs[t]);
            self.place.faces.push(faces[t]);
        }
        let edges: BTreeSet<[u32; 2]> =
            mesh.tets.nodes.iter().flat_map(|tet| EDGE.map(|[i, j]| sorted2([tet[i], tet[j]]))).collect();
        self.place.ridges.retain(|(nodes, _)| edges.contains(&sorted2(*nodes)));
        // What is held: open faces without a triangle, and triangles with a tetrahedron elsewhere.
        let index = TriangleIndex::new(Team::alone(), &mesh.triangles.nodes, mesh.vertices.len());
        let faces = MatchedFaces::of(Team::alone(), &mesh.tets.nodes);
        let mut held: BTreeSet<u32> = halves.iter().flat_map(|&t| mesh.triangles.nodes[t as usize]).collect();
        for (tet, around) in mesh.tets.nodes.iter().zip(&faces.neighbours) {
            let open = (0..4).filter(|&i| around[i] == NONE).map(|i| FACES[i].map(|k| tet[k]));
            held.extend(open.filter(|&face| index.find(face).next().is_none()).flatten());
        }
        self.held = Some([held.into_iter().collect(), halves]);
        self
    }
}

/// Half way to the ball about the cube's centre.
fn rounded(p: Vec3) -> Vec3 {
    let off = p.map(|x| 2.0 * x - 1.0);
    let greatest = off.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let shrink = if greatest > 0.0 { 0.5 + 0.5 * greatest / norm(off) } else { 1.0 };
    off.map(|x| 0.5 + 0.5 * shrink * x)
}

/// A small mesh of n cells along a side, with a metric of sizes about `size`, two to five times less in one direction
/// near a slanted plane.
pub fn sample(shape: Shape, n: u32, size: f64) -> Sample {
    let mut mesh = samples::cube(n);
    if let Shape::Round = shape {
        mesh.vertices.iter_mut().for_each(|p| *p = rounded(*p));
    }
    if let Shape::TwoRegions = shape {
        for t in 0..mesh.tets.len() {
            let middle: f64 = mesh.tets.nodes[t].iter().map(|&v| mesh.vertices[v as usize][0]).sum();
            mesh.tets.refs[t] = if middle < 2.0 { 1 } else { 2 };
        }
    }
    complete_boundary(Team::alone(), &mut mesh);
    let (model, place) = Discrete::from_mesh(Team::alone(), &mesh, DEFAULT_RIDGE_ANGLE).unwrap();
    let logs = mesh.vertices.iter().map(|p| {
        let off = (p[0] + 0.5 * p[1] - 0.3 * p[2] - 0.6).abs();
        let thin = size * (0.2 + 0.6 * off).min(0.5);
        let direction = p.map(|x| x + 0.2);
        let direction = direction.map(|x| x / norm(direction));
        let (wide, narrow) = (1.0 / (size * size), 1.0 / (thin * thin));
        Sym3::diagonal(wide, wide, wide).plus(Sym3::outer(direction, narrow - wide)).ln()
    });
    let background = Background::new(mesh.vertices.clone(), mesh.tets.nodes.clone(), logs.collect());
    Sample {
        source: Source::Background(background),
        model: Model::Discrete(model),
        mesh,
        place,
        held: None,
        volume: 1.0,
    }
}

/// What a sweep does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Task {
    Split,
    Thin,
    Collapse,
    Reconnect(Criterion),
    Smooth,
    Project,
    RemoveUnprojected,
    Repair,
}

impl Task {
    pub const ALL: [Task; 10] = [
        Task::Split,
        Task::Thin,
        Task::Collapse,
        Task::Reconnect(Criterion::Delaunay),
        Task::Reconnect(Criterion::EdgeWeight),
        Task::Reconnect(Criterion::MeanRatio),
        Task::Smooth,
        Task::Project,
        Task::RemoveUnprojected,
        Task::Repair,
    ];
}

/// A sample at work.
pub struct Bench<'m> {
    pub context: Context<'m>,
    pub states: Vec<State<'m>>,
    pub pool: Pool,
    pub scheduler: Scheduler,
    pub plan: Plan,
    pub random: Random,
    volume: f64,
    exact: bool,
    /// Of a part what must stay.
    held: Option<Held>,
}

/// The faces to other parts, and the vertices that are held with their positions to the bit.
type Held = (BTreeSet<[VertexId; 3]>, BTreeMap<VertexId, [u64; 3]>);

impl<'m> Bench<'m> {
    /// A bench with so many threads. Limits are lax, so that much is done: edges of any length are split and collapsed, even if bad
    /// elements come of that.
    pub fn new(sample: &'m Sample, threads: usize, seed: u64) -> Self {
        let Sample { mesh, place, source, .. } = sample;
        let known = Known { logs: source.logs_on(mesh), hints: None, is_part: sample.held.is_some() };
        let Filled { store, unprojected, ids } = fill::fill_known(Team::alone(), mesh, place, source, known).unwrap();
        assert!(unprojected.is_empty(), "the samples lie on their models");
        let mut context = Context::new(store, source, &sample.model);
        if let Some([held, halves]) = &sample.held {
            let mut required = Required::of(mesh, &Freeze::default());
            required.hold(mesh.vertices.len(), held, halves.iter().map(|&t| mesh.triangles.nodes[t as usize]));
            required.renumber(&ids);
            context.required = required;
        }
        context.limits = Limits { insert_floor: 0.02, collapse_floor: 0.02, ..Limits::default() };
        let pool = Pool::new(threads).unwrap();
        let states = (0..threads).map(|_| State::new(&context)).collect();
        let scheduler = if threads == 1 { Scheduler::Sequential } else { Scheduler::Speculative };
        let mut bench = Self {
            context,
            states,
            pool,
            scheduler,
            plan: Plan::default(),
            random: Random(seed),
            volume: 0.0,
            exact: true,
            held: None,
        };
        bench.held = sample.held.as_ref().map(|_| bench.held());
        bench.volume = bench.measure();
        // A plane surface keeps its volume, a curved one does not quite.
        bench.exact = (bench.volume - sample.volume).abs() < 1e-12;
        bench.check("as built");
        bench
    }

    /// Other sizes, so that there is always something to do: finer and coarser in turn.
    pub fn vary_sizes(&mut self) {
        let long = [0.7, 1.4, 2.8][self.random.below(3)];
        let limits = &mut self.context.limits;
        (limits.long, limits.short, limits.longest_new, limits.shortest_new) = (long, 0.5 * long, long, 0.3 * long);
    }

    fn measure(&self) -> f64 {
        let store = &self.context.store;
        let volume = |t: TetId| {
            let [a, b, c, d] = store.vertices(t).map(|v| store.position(v));
            volume6(a, b, c, d) / 6.0
        };
        store.live_tets().map(volume).sum()
    }

    /// What must stay as it is of a part.
    fn held(&self) -> Held {
        let store = &self.context.store;
        let face = |(t, i): (TetId, usize)| {
            let mut face = FACE[i].map(|k| store.vertices(t)[k]);
            face.sort_unstable();
            face
        };
        let vertices = self.context.required.frozen().map(|v| (v, store.position(v).map(f64::to_bits)));
        (open_faces(store).map(face).collect(), vertices.collect())
    }

    /// The whole store, and its volume.
    pub fn check(&self, after: &str) {
        let checked = if self.held.is_some() { check_part(&self.context) } else { check(&self.context) };
        if let Err(what) = checked {
            panic!("after {after}: {what}");
        }
        if let Some(held) = &self.held {
            assert!(*held == self.held(), "after {after}: a face to another part is not as it was");
        }
        let (volume, slack) = (self.measure(), if self.exact { 1e-9 } else { 0.5 });
        assert!((volume / self.volume - 1.0).abs() < slack, "after {after}: the volume {} is {volume}", self.volume);
    }

    /// What comes of the passes on the mesh, on one thread.
    pub fn with_pipeline<R>(&mut self, act: impl FnOnce(&mut Pipeline<'_, '_>) -> R) -> R {
        let pool = Pool::new(1).unwrap();
        let (scheduler, plan, grains) = (Scheduler::Sequential, Plan::default(), Grains::default());
        let execution = Execution { pool: &pool, scheduler, plan, grains };
        act(&mut Pipeline::new(&mut self.context, execution, &Silent, Criterion::MeanRatio, Vec::new()))
    }

    /// One sweep over all items that there are, in random order, and the check.
    pub fn sweep(&mut self, task: Task) -> Counts {
        self.context.store.tick();
        let counts = match task {
            Task::Split => self.on_edges(&Split),
            Task::Thin => self.on_vertices(&Thin, false),
            Task::Collapse => self.on_edges(&Collapse),
            Task::Reconnect(criterion) => self.on_tets(&Reconnect(criterion)),
            Task::Smooth => self.on_vertices(&Smooth, false),
            Task::Project => {
                self.push_off_the_model();
                self.on_vertices(&Project, true)
            }
            Task::RemoveUnprojected => self.on_vertices(&RemoveUnprojected { or_neighbour: true }, true),
            Task::Repair => self.on_tets(&Repair),
        };
        if task == Task::Project && self.states.iter().any(|state| !state.unprojected.is_empty()) {
            // Some stay where they were pushed to, until another operation brings them back.
            self.exact = false;
        }
        self.check(&format!("{task:?}"));
        self.states.iter_mut().for_each(|state| state.unprojected.clear());
        counts
    }

    fn run<O: Operation>(&mut self, operation: &O, mut items: Vec<O::Item>) -> Counts {
        self.random.shuffle(&mut items);
        let execution =
            Execution { pool: &self.pool, scheduler: self.scheduler, plan: self.plan, grains: Grains::uniform(8) };
        schedule::run(operation, &items, &self.context, &mut self.states, (execution, Kind::Split), &|_| true)
    }

    /// All edges; some are listed twice, with another tetrahedron.
    pub fn edges(&self) -> Vec<EdgeItem> {
        let store = &self.context.store;
        let mut items: Vec<EdgeItem> = Vec::new();
        for tet in store.live_tets() {
            let v = store.vertices(tet);
            items.extend(EDGE.map(|[i, j]| EdgeItem { a: v[i].min(v[j]), b: v[i].max(v[j]), tet }));
        }
        items.sort_unstable_by_key(|item| (item.a, item.b, item.tet));
        let mut n = 0;
        items.retain(|_| {
            n += 1;
            n % 3 != 0
        });
        items
    }

    fn on_edges<O: Operation<Item = EdgeItem>>(&mut self, operation: &O) -> Counts {
        let items = self.edges();
        self.run(operation, items)
    }

    fn on_tets<O: Operation<Item = TetId>>(&mut self, operation: &O) -> Counts {
        let items = self.context.store.live_tets().collect();
        self.run(operation, items)
    }

    /// All vertices, or one of five of those on the model.
    fn on_vertices<O: Operation<Item = VertexId>>(&mut self, operation: &O, few: bool) -> Counts {
        let store = &self.context.store;
        let wanted = |v: &VertexId| !few || (store.dimension(*v) < 3 && v.0.is_multiple_of(5));
        let items = store.live_vertices().filter(wanted).collect();
        self.run(operation, items)
    }

    /// Moves the boundary vertices that [`Bench::on_vertices`] takes a little towards a neighbour, if all stays positive.
    fn push_off_the_model(&mut self) {
        let store = &self.context.store;
        let may_move = |v: VertexId| matches!(store.dimension(v), 1 | 2) && !self.context.is_frozen(v);
        let wanted = |v: &VertexId| may_move(*v) && v.0.is_multiple_of(5);
        let shift = 0.1 + 1e-3 * self.random.below(100) as f64;
        for v in store.live_vertices().filter(wanted) {
            let tets: Vec<TetId> = store.live_tets().filter(|&t| store.vertices(t).contains(&v)).collect();
            let from = store.position(v);
            let inner = |t: &TetId| store.vertices(*t).into_iter().find(|&x| store.dimension(x) == 3);
            let Some(x) = tets.iter().find_map(inner) else { continue };
            store.displace(v, lerp(from, store.position(x), shift));
            let positive =
                |t: &TetId| crate::mesh::predicate::is_positive(store.vertices(*t).map(|v| store.position(v)));
            if !tets.iter().all(positive) {
                store.displace(v, from);
            }
        }
        fill::measure(Team::alone(), store);
    }
}
