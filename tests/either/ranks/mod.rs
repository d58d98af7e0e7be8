//! Ranks say to each other what they were given to say, and none waits for ever for one that does not come.
//!
//! mpirun starts this program of tests again, several times, with [`PART`] as the only test and a part to play ([`play`]).
//! Without the feature `mpi` a program says that it cannot be one of several.
#[cfg(feature = "mpi")]
mod launch;
mod parts;

/// The environment's variable that names the part.
const PART: &str = "GEO_ADAPT_TEST_PART";

#[cfg(not(feature = "mpi"))]
mod without {
    use super::PART;
    use std::process::Command;

    /// What a process says that plays a part under these variables of the environment.
    fn said(variables: &[(&str, &str)]) -> String {
        let output = Command::new(std::env::current_exe().unwrap())
            .args(["ranks::parts::play", "--exact", "--nocapture"])
            .env(PART, "start")
            .envs(variables.iter().copied())
            .output()
            .unwrap();
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    }

    #[test]
    fn a_program_without_mpi_refuses_to_be_one_of_several() {
        let text = said(&[("OMPI_COMM_WORLD_SIZE", "4")]);
        for part in ["4 processes", "(OMPI_COMM_WORLD_SIZE)", "without MPI", "cargo build --release --features mpi"] {
            assert!(text.contains(part), "{part}: {text}");
        }
        assert!(said(&[("PMI_SIZE", "2")]).contains("2 processes"));
    }

    #[test]
    fn a_program_without_mpi_is_alone() {
        assert!(said(&[]).contains("rank 0 of 1 started"));
        assert!(said(&[("OMPI_COMM_WORLD_SIZE", "1")]).contains("rank 0 of 1 started"));
    }
}
