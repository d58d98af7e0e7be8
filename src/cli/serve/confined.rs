//! The process of a job has limits, and sees its own folder alone.
use crate::process;
use crate::serve::protocol::{EVENTS, FILES, LOG, PRINTED, Run, TEMPORARY};
use landlock::{ABI, Access, AccessFs, AccessNet, Ruleset, RulesetAttr, RulesetCreatedAttr, path_beneath_rules};
use std::fs::File;
use std::io;
use std::os::fd::AsRawFd;
use std::path::PathBuf;

/// Most open files of a job.
const MOST_FILES: u64 = 4096;

/// How much less urgent a job is than the service, which answers meanwhile.
const BEHIND: i32 = 5;

/// What every program reads. Nothing of other processes, nor what the machine keeps secret.
const SYSTEM: [&str; 18] = [
    "/usr",
    "/lib",
    "/lib64",
    "/bin",
    "/sbin",
    "/opt",
    "/etc/ld.so.cache",
    "/etc/ld.so.conf",
    "/etc/ld.so.conf.d",
    "/etc/alternatives",
    "/etc/fonts",
    "/etc/localtime",
    "/etc/nsswitch.conf",
    "/proc/self",
    "/proc/meminfo",
    "/proc/cpuinfo",
    "/proc/sys",
    "/sys/devices/system",
];

/// This process becomes that of a run: its folder, its limits, its outputs.
///
/// # Errors
/// What the system refuses.
pub fn confine(run: &Run) -> io::Result<()> {
    let open = |name: &str| File::options().create(true).append(true).open(run.folder.join(name));
    for (file, to) in [(File::open("/dev/null")?, 0), (open(PRINTED)?, 1), (open(LOG)?, 2)] {
        // SAFETY: a system call on descriptors that are open.
        check(unsafe { libc::dup2(file.as_raw_fd(), to) })?;
    }
    std::env::set_current_dir(run.folder.join(FILES))?;
    let temporary = run.folder.join(TEMPORARY);
    for (name, value) in
        [(process::EVENTS, run.folder.join(EVENTS)), ("TMPDIR", temporary.clone()), ("HOME", temporary)]
    {
        // SAFETY: there is one thread.
        unsafe { std::env::set_var(name, value) };
    }
    forget_secrets();
    // SAFETY: a system call. Where it is refused, the job is as urgent as the service.
    unsafe { libc::nice(BEHIND) };
    limit(libc::RLIMIT_AS, run.memory)?;
    limit(libc::RLIMIT_CPU, run.seconds)?;
    limit(libc::RLIMIT_FSIZE, run.file)?;
    limit(libc::RLIMIT_NOFILE, MOST_FILES)?;
    limit(libc::RLIMIT_CORE, 0)?;
    fence(run).map_err(io::Error::other)
}

fn check(result: i32) -> io::Result<()> {
    if result < 0 { Err(io::Error::last_os_error()) } else { Ok(()) }
}

fn limit(what: libc::__rlimit_resource_t, most: u64) -> io::Result<()> {
    let mut known = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
    // SAFETY: system calls on a record of their kind, which is ours.
    unsafe {
        check(libc::getrlimit(what, &mut known))?;
        let most = most.min(known.rlim_max);
        check(libc::setrlimit(what, &libc::rlimit { rlim_cur: most, rlim_max: most }))
    }
}

/// What the service knows and a job need not.
fn forget_secrets() {
    let is_secret = |name: &str| {
        name.starts_with("AWS_")
            || name.starts_with("PG")
            || ["GEO_ADAPT_DATABASE", "GEO_ADAPT_SERVER", "GEO_ADAPT_TOKEN"].contains(&name)
            || name.starts_with("DATABASE")
    };
    let names: Vec<_> = std::env::vars_os().map(|(name, _)| name).collect();
    for name in names.iter().filter(|name| name.to_str().is_none_or(is_secret)) {
        // SAFETY: there is one thread.
        unsafe { std::env::remove_var(name) };
    }
}

/// Whether the kernel keeps a job in its folder (Landlock).
pub fn is_fenced() -> bool {
    /// That its version is asked for.
    const VERSION: libc::c_int = 1;
    // SAFETY: a system call that reads nothing.
    unsafe { libc::syscall(libc::SYS_landlock_create_ruleset, std::ptr::null::<libc::c_void>(), 0_usize, VERSION) > 0 }
}

/// Nothing but the folder of the run can be written, nothing but it and programs can be read, and no network is there (Landlock, as far as the kernel
/// has it).
fn fence(run: &Run) -> Result<(), landlock::RulesetError> {
    let abi = ABI::V5;
    let mut seen: Vec<PathBuf> = SYSTEM.iter().map(PathBuf::from).collect();
    // This program, which reads models in a child of its own, and the meshers of `bootstrap`.
    let own = std::env::current_exe().ok().and_then(|path| path.parent().map(PathBuf::from));
    seen.extend(run.reads.iter().cloned());
    seen.extend(own.iter().flat_map(|folder| [folder.clone(), folder.join("../lib")]));
    seen.extend(std::env::var_os("PATH").iter().flat_map(std::env::split_paths));
    for name in ["LD_LIBRARY_PATH", "GEO_ADAPT_GMSH", "GEO_ADAPT_NETGEN"] {
        seen.extend(std::env::var_os(name).iter().flat_map(std::env::split_paths));
    }
    let written = [run.folder.clone(), PathBuf::from("/dev")];
    Ruleset::default()
        .handle_access(AccessFs::from_all(abi))?
        .handle_access(AccessNet::from_all(abi))?
        .create()?
        .add_rules(path_beneath_rules(seen, AccessFs::from_read(abi)))?
        .add_rules(path_beneath_rules(written, AccessFs::from_all(abi)))?
        .restrict_self()?;
    Ok(())
}
