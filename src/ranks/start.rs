//! Who takes part in a run.
use super::{Alone, Ranks};

/// What launchers tell each process of their number: OpenMPI's mpirun; those of MPICH and of Intel; MVAPICH's; Slurm's srun.
/// The first that is set counts: mpirun under srun is the one that started us.
const NUMBERS: [&str; 4] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE", "SLURM_STEP_NUM_TASKS"];

/// The longest message of MPI, bytes. It counts in 32 bits with sign, so longer ones go in pieces.
const PIECE: usize = 1 << 30;

/// How to get a program that can be one of several processes.
const REMEDY: &str = "build it with `cargo build --release --features mpi` (on Debian: apt install libopenmpi-dev openmpi-bin libclang-dev)";

/// What started this process as one of several.
struct Launched {
    variable: &'static str,
    /// At least 2.
    processes: usize,
}

/// The processes of this run: those that mpirun or srun started, or [`Alone`] where none did or where they started one. Collective.
/// All that follows is to be called on the same thread: other threads may run, but say nothing to other ranks.
///
/// # Errors
/// Where several processes were started and this program was built without the feature `mpi`, or for another MPI than that of the
/// launcher; where MPI knows no threads; where it was started before in this process. The text says what to do. All ranks have the
/// same one.
pub fn start() -> Result<Box<dyn Ranks>, String> {
    start_in_pieces(PIECE)
}

/// [`start`] with messages in pieces of so many bytes, at least 1.
///
/// # Errors
/// As [`start`].
pub fn start_in_pieces(piece: usize) -> Result<Box<dyn Ranks>, String> {
    match launched(|name| std::env::var(name).ok()) {
        None => Ok(Box::new(Alone)),
        Some(launched) => start_several(&launched, piece),
    }
}

#[cfg(feature = "mpi")]
fn start_several(launched: &Launched, piece: usize) -> Result<Box<dyn Ranks>, String> {
    let world = super::world::World::start(piece)?;
    if world.count() == 1 {
        let Launched { variable, processes } = launched;
        return Err(format!(
            "{processes} processes were started ({variable}), and each sees itself alone: the launcher is of another MPI than the one \
             that this geo-adapt was built for ({}). Start it by the mpirun of that one; where a program under mpirun starts \
             geo-adapt as a single process, unset {variable}",
            super::world::version()
        ));
    }
    Ok(Box::new(world))
}

#[cfg(not(feature = "mpi"))]
fn start_several(launched: &Launched, _: usize) -> Result<Box<dyn Ranks>, String> {
    let Launched { variable, processes } = launched;
    Err(format!(
        "{processes} processes were started ({variable}), but this geo-adapt was built without MPI, and each would do all of the work: \
         {REMEDY}, or start one process, without mpirun. Where a program under mpirun starts geo-adapt as a single process, unset {variable}"
    ))
}

/// Refuses to start several processes of this program where it was built for one. Says nothing to the others.
///
/// # Errors
/// Without the feature `mpi`. The text says how to get it.
pub fn check() -> Result<(), String> {
    if cfg!(feature = "mpi") { Ok(()) } else { Err(format!("this geo-adapt was built without MPI: {REMEDY}")) }
}

/// Whether a launcher has started this process as one of several. Says nothing to the others.
pub fn is_one_of_several() -> bool {
    launched(|name| std::env::var(name).ok()).is_some()
}

/// What the environment says of several processes.
fn launched(variable: impl Fn(&str) -> Option<String>) -> Option<Launched> {
    let number = |name: &'static str| variable(name)?.trim().parse().ok().map(|count| (name, count));
    let (variable, processes) = NUMBERS.into_iter().find_map(number)?;
    (processes > 1).then_some(Launched { variable, processes })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn launched_by(set: &[(&str, &str)]) -> Option<(&'static str, usize)> {
        let variable = |name: &str| set.iter().find(|(key, _)| *key == name).map(|(_, value)| (*value).to_owned());
        launched(variable).map(|launched| (launched.variable, launched.processes))
    }

    #[test]
    fn launchers_are_known_by_their_variables() {
        assert_eq!(launched_by(&[]), None);
        assert_eq!(launched_by(&[("OMPI_COMM_WORLD_SIZE", "4")]), Some(("OMPI_COMM_WORLD_SIZE", 4)));
        assert_eq!(launched_by(&[("PMI_SIZE", "2")]), Some(("PMI_SIZE", 2)));
        assert_eq!(launched_by(&[("OMPI_COMM_WORLD_SIZE", "1")]), None);
        // mpirun -n 1 under srun -n 8.
        assert_eq!(launched_by(&[("SLURM_STEP_NUM_TASKS", "8"), ("OMPI_COMM_WORLD_SIZE", "1")]), None);
        assert_eq!(
            launched_by(&[("PMI_SIZE", "many"), ("SLURM_STEP_NUM_TASKS", "8")]),
            Some(("SLURM_STEP_NUM_TASKS", 8))
        );
    }
}
