//! What the operator of a service decides.
use super::Error;
use crate::cycle;
use std::fs::{self, File, TryLockError};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What the operator decides.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Where it listens.
    pub listen: SocketAddr,
    /// The folder for all that is kept.
    pub data: PathBuf,
    /// `postgres://…`, where several services share a queue; else a file in the folder.
    pub database: Option<String>,
    /// Where contents lie: `s3://bucket/prefix`, or a folder; else one in `data`.
    pub store: Option<String>,
    /// Who asks without a token may do everything. On the loopback only.
    pub is_open: bool,
    /// Certificate and key, where it speaks TLS itself.
    pub tls: Option<Tls>,
    /// What jobs and owners may take.
    pub limits: Limits,
    /// The solvers that loops may use.
    pub solvers: Solvers,
}

/// The solvers that the operator has set up for loops.
#[derive(Clone, Debug, Default)]
pub struct Solvers {
    /// What the file says, for each job that is a loop.
    pub text: String,
    /// What they are called.
    pub names: Vec<String>,
    /// What they read besides the system's programs.
    pub reads: Vec<PathBuf>,
}

impl Solvers {
    /// Reads the file of the operator.
    ///
    /// # Errors
    /// When it cannot be read, or says what cannot be.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let known = cycle::Solvers::read(path).map_err(Error::Settings)?;
        let text = fs::read_to_string(path).map_err(Error::disk(path.display()))?;
        let names = known.names().map(str::to_owned).collect();
        Ok(Self { text, names, reads: known.reads().map(Path::to_path_buf).collect() })
    }
}

/// Certificate and key, PEM.
#[derive(Clone, Debug)]
pub struct Tls {
    /// The chain of certificates.
    pub certificate: PathBuf,
    /// The private key.
    pub key: PathBuf,
}

/// What jobs and owners may take.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Jobs at once.
    pub jobs: usize,
    /// Threads for all of them.
    pub threads: usize,
    /// Bytes of memory for all of them.
    pub memory: u64,
    /// Bytes of memory of a job.
    pub job_memory: u64,
    /// Processor time of a job.
    pub job_time: Duration,
    /// Bytes of a file that a job writes, and of an upload.
    pub file: u64,
    /// Vertices that a job may make.
    pub vertices: u64,
    /// Bytes that an owner may keep.
    pub owner_bytes: u64,
    /// Jobs of an owner that have not ended.
    pub owner_jobs: u64,
    /// Requests of an owner in a second; for a while it may be ten times as many.
    pub rate: u32,
}

/// The file whose lock says that a service is at work in a folder.
const LOCK: &str = "lock";

impl Settings {
    /// Whether other machines can reach it.
    pub fn is_local(&self) -> bool {
        self.listen.ip().is_loopback()
    }

    /// A folder of it.
    pub fn folder(&self, name: &str) -> PathBuf {
        self.data.join(name)
    }

    /// Makes the folders, where they are not there.
    ///
    /// # Errors
    /// When they cannot be made.
    pub fn make_folders(&self) -> Result<(), Error> {
        for name in ["uploads", "jobs", "blobs"] {
            let folder = self.folder(name);
            fs::create_dir_all(&folder).map_err(Error::disk(folder.display()))?;
        }
        only_for_us(&self.data).map_err(Error::disk(self.data.display()))
    }

    /// Makes the folders, and holds them until the file is dropped: one service a folder. What another one has left half done is removed.
    ///
    /// # Errors
    /// When they cannot be made, or are held.
    pub fn hold(&self) -> Result<File, Error> {
        self.make_folders()?;
        let path = self.data.join(LOCK);
        let file = File::options().write(true).create(true).truncate(false).open(&path);
        let file = file.map_err(Error::disk(path.display()))?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                let text = format!("{}: another service is at work there; give another --data", self.data.display());
                return Err(Error::Settings(text));
            }
            Err(TryLockError::Error(error)) => return Err(Error::disk(path.display())(error)),
            Ok(()) => {}
        }
        for left in fs::read_dir(self.folder("jobs")).into_iter().flatten().flatten() {
            drop(fs::remove_dir_all(left.path()));
        }
        Ok(file)
    }
}

/// What is kept is for nobody else on the machine.
fn only_for_us(folder: &Path) -> std::io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        fs::set_permissions(folder, fs::Permissions::from_mode(0o700))?;
    }
    Ok(())
}
