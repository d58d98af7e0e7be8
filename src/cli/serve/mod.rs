//! `serve`: the service ([`crate::serve`]), and its tokens.
mod confined;
mod token;
pub mod warm;

use super::{Outcome, amount, tell};
use crate::serve::{self, Commands, Limits, Settings, Solvers, Tls};
use clap::{Args, FromArgMatches};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

/// Keeps models, meshes and fields, and runs commands on them on request.
#[derive(clap::Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct Arguments {
    #[command(subcommand)]
    what: Option<What>,
    /// Where it listens: an address and a port; port 0 for any that is free
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1:7878")]
    listen: SocketAddr,
    #[command(flatten)]
    place: Place,
    /// Where contents lie: a folder, or s3://BUCKET/PREFIX with its keys in the environment (AWS_…) [default: in --data]
    #[arg(long, value_name = "WHERE")]
    store: Option<String>,
    /// Asks for a token on the loopback too: behind a proxy, say
    #[arg(long)]
    tokens_only: bool,
    /// The certificates of the server, PEM, for TLS without a proxy
    #[arg(long, value_name = "FILE", requires = "tls_key")]
    tls_certificate: Option<PathBuf>,
    /// Their private key, PEM
    #[arg(long, value_name = "FILE", requires = "tls_certificate")]
    tls_key: Option<PathBuf>,
    /// The solvers that loops may use besides the analytic one: a table for each, with its [NAME.command] as `cycle` has it, and the folders that it reads
    #[arg(long, value_name = "FILE.toml")]
    solvers: Option<PathBuf>,
    #[command(flatten, next_help_heading = "What jobs and owners may take")]
    limits: LimitArguments,
    /// Log as JSON, one object a line
    #[arg(long)]
    log_json: bool,
}

/// Where all is kept.
#[derive(clap::Args)]
pub struct Place {
    /// The folder for all that is kept
    #[arg(long, value_name = "DIR", default_value = "geo-adapt-data")]
    data: PathBuf,
    /// A database that several services share: postgres://USER:PASSWORD@HOST/NAME [default: a file in --data]
    #[arg(long, value_name = "URL", env = "GEO_ADAPT_DATABASE", hide_env_values = true)]
    database: Option<String>,
}

#[derive(clap::Args)]
struct LimitArguments {
    /// Jobs at once [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Threads of all jobs together [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Memory of all jobs together [default: three quarters of what the machine has]
    #[arg(long, value_name = "SIZE", value_parser = amount::bytes)]
    memory: Option<u64>,
    /// Memory of a job [default: that of all]
    #[arg(long, value_name = "SIZE", value_parser = amount::bytes)]
    job_memory: Option<u64>,
    /// Time of a job, in seconds: of each of its processes on the processor, and of all of it by the clock
    #[arg(long, value_name = "S", default_value_t = 24 * 3600)]
    job_seconds: u64,
    /// Bytes of a file: an upload, or one that a job writes
    #[arg(long, value_name = "SIZE", default_value = "20GB", value_parser = amount::bytes)]
    file_size: u64,
    /// Vertices that a job may make
    #[arg(long, value_name = "N", default_value_t = 50_000_000)]
    max_vertices: u64,
    /// Bytes that an owner may keep
    #[arg(long, value_name = "SIZE", default_value = "200GB", value_parser = amount::bytes)]
    owner_bytes: u64,
    /// Jobs of an owner that have not ended
    #[arg(long, value_name = "N", default_value_t = 1000)]
    owner_jobs: u64,
    /// Requests of an owner in a second; for a while it may be ten times as many
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..))]
    rate: u32,
}

#[derive(clap::Subcommand)]
enum What {
    /// Make, list and revoke tokens
    Token(token::Arguments),
}

impl Place {
    fn settings(&self, listen: SocketAddr) -> Settings {
        let data = std::path::absolute(&self.data).unwrap_or_else(|_| self.data.clone());
        let (database, limits) = (self.database.clone(), LimitArguments::usual().limits());
        Settings { listen, data, database, store: None, is_open: false, tls: None, limits, solvers: Solvers::default() }
    }
}

impl LimitArguments {
    /// What they are where nothing is given.
    fn usual() -> Self {
        let none = Self::augment_args(clap::Command::new("serve")).get_matches_from(["serve"]);
        Self::from_arg_matches(&none).unwrap_or_else(|error| error.exit())
    }

    fn limits(&self) -> Limits {
        let memory = self.memory.unwrap_or_else(|| crate::memory::available().unwrap_or(4 << 30) / 4 * 3);
        let of_cores = |given: Option<u16>| given.map_or_else(super::cores, usize::from);
        Limits {
            jobs: of_cores(self.jobs),
            threads: of_cores(self.threads),
            memory,
            job_memory: self.job_memory.unwrap_or(memory),
            job_time: Duration::from_secs(self.job_seconds.max(1)),
            file: self.file_size,
            vertices: self.max_vertices.clamp(1, u64::from(u32::MAX)),
            owner_bytes: self.owner_bytes,
            owner_jobs: self.owner_jobs,
            rate: self.rate,
        }
    }
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    if let Some(What::Token(arguments)) = &arguments.what {
        return token::run(arguments);
    }
    let tls = arguments.tls_certificate.clone().zip(arguments.tls_key.clone());
    let settings = Settings {
        store: arguments.store.clone(),
        is_open: arguments.listen.ip().is_loopback() && !arguments.tokens_only,
        tls: tls.map(|(certificate, key)| Tls { certificate, key }),
        limits: arguments.limits.limits(),
        solvers: arguments.solvers.as_deref().map_or_else(|| Ok(Solvers::default()), Solvers::read)?,
        ..arguments.place.settings(arguments.listen)
    };
    log(arguments.log_json);
    if !confined::is_fenced() {
        tracing::warn!("this kernel has no Landlock: jobs are not kept from what else the service's user may read");
    }
    super::interrupt::let_commands_end();
    serve::run(settings, Commands::new(super::command()), |address| {
        tell(format_args!("geo-adapt: listens at {address}; Ctrl-C ends it"));
    })?;
    Ok(ExitCode::SUCCESS)
}

/// Logs to standard error; what exactly is said by RUST_LOG, as tracing has it.
fn log(is_json: bool) {
    use tracing_subscriber::EnvFilter;
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new("geo_adapt=info,audit=info,warn"));
    let log = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_ansi(std::io::IsTerminal::is_terminal(&std::io::stderr()));
    let log = log.with_writer(std::io::stderr);
    let _ = if is_json { log.json().try_init() } else { log.with_target(false).try_init() };
}
