//! A PostgreSQL for a test, of Debian's package; it ends with this.
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

pub struct Postgres {
    folder: tempfile::TempDir,
    programs: PathBuf,
    port: u16,
}

/// Where Debian has the programs of the newest version.
fn programs() -> Option<PathBuf> {
    let versions = std::fs::read_dir("/usr/lib/postgresql").ok()?.flatten();
    let mut found: Vec<PathBuf> =
        versions.map(|entry| entry.path().join("bin")).filter(|path| path.join("initdb").is_file()).collect();
    found.sort();
    found.pop()
}

impl Postgres {
    /// Starts one, with a word where there is none. After set-up there must be one.
    pub fn start() -> Option<Self> {
        let Some(programs) = programs() else {
            assert!(std::env::var_os("GEO_ADAPT_SET_UP").is_none(), "tests/run has set up postgresql");
            eprintln!("skipped: no PostgreSQL (Debian: postgresql)");
            return None;
        };
        let folder = tempfile::tempdir().unwrap();
        let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let this = Self { folder, programs, port };
        if is_root() {
            // It does not run as root, and others must see its folder.
            assert!(Command::new("chown").arg("postgres").arg(this.folder.path()).status().unwrap().success());
        }
        this.run("initdb", &["--auth=trust", "--username=geo_adapt", "--no-sync"], &[]);
        let options = format!("-p {port} -k {} -c listen_addresses=127.0.0.1", this.folder.path().display());
        let log = this.folder.path().join("log");
        this.run("pg_ctl", &["-w", "-o", &options, "-l", log.to_str().unwrap()], &["start"]);
        Some(this)
    }

    fn data(&self) -> PathBuf {
        self.folder.path().join("data")
    }

    fn run(&self, program: &str, arguments: &[&str], then: &[&str]) {
        let program = self.programs.join(program);
        let mut command = Command::new(if is_root() { Path::new("runuser") } else { &program });
        if is_root() {
            command.args(["-u", "postgres", "--"]).arg(&program);
        }
        command.arg("-D").arg(self.data()).args(arguments).args(then).current_dir("/");
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        assert!(command.status().unwrap().success(), "{}", program.display());
    }

    /// What a service is given.
    pub fn url(&self) -> String {
        format!("postgres://geo_adapt@127.0.0.1:{}/postgres", self.port)
    }
}

impl Drop for Postgres {
    fn drop(&mut self) {
        if self.data().exists() {
            self.run("pg_ctl", &["-m", "immediate"], &["stop"]);
        }
    }
}

fn is_root() -> bool {
    // SAFETY: a system call without arguments.
    unsafe { libc::geteuid() == 0 }
}
