//! Runs a program to its end.
use super::fork::work_instead;
use super::group::{Family, Group, end_with_parent, processor_time};
use super::log::Log;
use super::outcome::Outcome;
use std::io;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Longest time between two looks at a program. One that has just begun is looked at sooner.
const LOOK: Duration = Duration::from_millis(20);

/// How long a program that was asked to end may take for it. OpenMPI's mpirun takes two seconds to end its processes, which are in
/// groups of their own.
const PATIENCE: Duration = Duration::from_secs(4);

/// A program that waits for a busy machine has so many times its limit.
const WAITING: u32 = 4;

/// How a program belongs to this one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tie {
    /// In a group of its own, so that an interrupt at the terminal is for us alone; it ends with us, however we end (on Linux).
    Bound,
    /// In a group of its own, which goes on where we are killed: a later run ends it ([`Group`]).
    Loose,
    /// In our group: whoever ends that group ends us both.
    Shared,
}

impl Tie {
    #[cfg(unix)]
    fn set(self, command: &mut Command) {
        use std::os::unix::process::CommandExt;
        if self != Self::Shared {
            command.process_group(0);
        }
        if self == Self::Bound && cfg!(target_os = "linux") {
            let parent = std::process::id();
            // SAFETY: it makes system calls only.
            unsafe {
                command.pre_exec(move || {
                    // A shell starts what runs in the background deaf to interrupts; our children hear them.
                    libc::signal(libc::SIGINT, libc::SIG_DFL);
                    end_with_parent(parent);
                    Ok(())
                })
            };
        }
    }

    #[cfg(not(unix))]
    fn set(self, _: &mut Command) {}
}

/// How a program is run.
pub struct Runner<'a> {
    /// How it belongs to us.
    pub tie: Tie,
    /// Processor time that it may take.
    pub limit: Option<Duration>,
    /// Set when it shall end.
    pub stop: &'a AtomicBool,
    /// Where what it says goes: nowhere without.
    pub log: Option<&'a Log>,
}

/// How many programs run.
static RUNNING: AtomicUsize = AtomicUsize::new(0);

/// Whether a program runs that this one has started, and waits for.
pub fn is_running() -> bool {
    RUNNING.load(Ordering::SeqCst) > 0
}

/// Whether a program could not be started because the machine has no memory, or no processes, left.
pub fn is_exhausted(error: &io::Error) -> bool {
    [io::ErrorKind::OutOfMemory, io::ErrorKind::WouldBlock].contains(&error.kind())
}

/// Counts a program as long as it runs.
struct Counted;

impl Counted {
    fn new() -> Self {
        RUNNING.fetch_add(1, Ordering::SeqCst);
        Self
    }
}

impl Drop for Counted {
    fn drop(&mut self) {
        RUNNING.fetch_sub(1, Ordering::SeqCst);
    }
}

impl Runner<'_> {
    /// Starts the program and waits until it has ended, with all of its group; `started` is told the group.
    ///
    /// # Errors
    /// When it cannot be started.
    pub fn run(&self, command: &mut Command, started: impl FnOnce(&Group)) -> io::Result<Outcome> {
        let _counted = Counted::new();
        let mut program = Program::start(command, self.tie, self.log)?;
        started(&program.group);
        self.wait(&mut program)
    }

    /// Waits until a program that was started has ended, with all of its group.
    ///
    /// # Errors
    /// When the system does not tell how it ended.
    pub fn wait_for(&self, mut program: Program) -> io::Result<Outcome> {
        let _counted = Counted::new();
        self.wait(&mut program)
    }

    /// Where this fails nothing is left behind: the program is ended when it is dropped.
    fn wait(&self, program: &mut Program) -> io::Result<Outcome> {
        let began = Instant::now();
        loop {
            let id = program.child.id();
            if has_ended(&mut program.child)? {
                let used = processor_time(id);
                // While the child was not waited for, its number is its group's: what is left there ends too.
                program.kill();
                let outcome = Outcome::of(program.child.wait()?);
                program.is_over = true;
                let is_late = used.zip(system_limit()).is_some_and(|(used, limit)| is_late(used, limit));
                // The system kills what goes on beyond its last limit of time.
                return Ok(if outcome == Outcome::Killed && is_late { Outcome::OutOfTime } else { outcome });
            }
            let elapsed = began.elapsed();
            if self.stop.load(Ordering::SeqCst) {
                program.end();
                return Ok(Outcome::Interrupted);
            }
            if let Some(limit) = self.limit.filter(|&limit| is_over(id, elapsed, limit)) {
                program.end();
                return Ok(Outcome::TooLong(limit));
            }
            std::thread::sleep(LOOK.min(elapsed / 8 + Duration::from_micros(500)));
        }
    }
}

/// A program that was started. Where nobody waits for it, it is ended when this is dropped.
pub struct Program {
    child: Child,
    group: Group,
    tie: Tie,
    is_over: bool,
}

impl Program {
    /// Starts a program; what it says goes into the log.
    ///
    /// # Errors
    /// When it cannot be started.
    pub fn start(command: &mut Command, tie: Tie, log: Option<&Log>) -> io::Result<Self> {
        let sink = || log.map_or_else(|| Ok(Stdio::null()), Log::sink);
        command.stdin(Stdio::null()).stdout(sink()?).stderr(sink()?);
        tie.set(command);
        Self::spawn(command, tie)
    }

    /// Forks a process that does this work and ends with the exit code. There must be one thread ([`super::may_fork`]).
    ///
    /// # Errors
    /// When it cannot be forked.
    pub fn fork(tie: Tie, work: impl Fn() -> u8 + Send + Sync + 'static) -> io::Result<Self> {
        // No program is started, whatever its name.
        let mut command = Command::new("/");
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        tie.set(&mut command);
        work_instead(&mut command, work);
        Self::spawn(&mut command, tie)
    }

    fn spawn(command: &mut Command, tie: Tie) -> io::Result<Self> {
        let child = command.spawn()?;
        Ok(Self { group: Group::of(child.id()), child, tie, is_over: false })
    }

    /// Asks it to end, and ends it where it does not, with all that it has started.
    fn end(&mut self) {
        let mut family = Family::default();
        if self.tie != Tie::Shared {
            family = self.group.family();
            self.group.ask_to_end();
            let asked = Instant::now();
            while asked.elapsed() < PATIENCE && !has_ended(&mut self.child).unwrap_or(true) {
                std::thread::sleep(LOOK / 4);
            }
        }
        self.kill();
        let _ = self.child.wait();
        family.end();
        self.is_over = true;
    }

    fn kill(&mut self) {
        if self.tie != Tie::Shared {
            self.group.kill();
        }
        // Not of a group, where there are none.
        let _ = self.child.kill();
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        if !self.is_over {
            self.end();
        }
    }
}

/// Whether a program has ended; it is not waited for, so its number stays its own.
#[cfg(unix)]
fn has_ended(child: &mut Child) -> io::Result<bool> {
    let mut info = std::mem::MaybeUninit::<libc::siginfo_t>::zeroed();
    let options = libc::WEXITED | libc::WNOHANG | libc::WNOWAIT;
    // SAFETY: waitid writes to a record of its own kind, which is ours; all zeroes are a value of it.
    let (code, info) =
        unsafe { (libc::waitid(libc::P_PID, child.id(), info.as_mut_ptr(), options), info.assume_init()) };
    if code != 0 {
        let error = io::Error::last_os_error();
        return if error.kind() == io::ErrorKind::Interrupted { Ok(false) } else { Err(error) };
    }
    // SAFETY: waitid has filled the record, or left it as it was: zeroes.
    Ok(unsafe { info.si_pid() } != 0)
}

#[cfg(not(unix))]
fn has_ended(child: &mut Child) -> io::Result<bool> {
    child.try_wait().map(|status| status.is_some())
}

/// Processor time that the system gives this process, and each that it starts (`ulimit -t`).
#[cfg(unix)]
fn system_limit() -> Option<Duration> {
    let mut limit = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
    // SAFETY: getrlimit writes to a record of its own kind, which is ours.
    let is_known = unsafe { libc::getrlimit(libc::RLIMIT_CPU, &mut limit) } == 0;
    (is_known && limit.rlim_cur != libc::RLIM_INFINITY).then(|| Duration::from_secs(limit.rlim_cur))
}

#[cfg(not(unix))]
fn system_limit() -> Option<Duration> {
    None
}

/// Whether a program that was killed after this processor time may have met the system's limit. The limit is held against whole ticks of
/// the clock, of which a busy machine counts more than were used.
fn is_late(used: Duration, limit: Duration) -> bool {
    used + LOOK.max(limit / 4) >= limit
}

/// Whether a program has used up its time. The time that it waits for a busy machine counts by a quarter, so that the result hardly depends
/// on what else runs.
fn is_over(id: u32, elapsed: Duration, limit: Duration) -> bool {
    elapsed > limit && processor_time(id).is_none_or(|time| time.max(elapsed / WAITING) > limit)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use crate::process::{last_line, last_lines};
    use std::path::Path;

    static NEVER: AtomicBool = AtomicBool::new(false);

    #[test]
    fn the_systems_limit_is_told_from_the_end_of_memory() {
        let seconds = Duration::from_secs_f64;
        for (used, limit, expected) in
            [(0.8, 1.0, true), (0.5, 1.0, false), (3500.0, 3600.0, true), (600.0, 3600.0, false)]
        {
            assert_eq!(is_late(seconds(used), seconds(limit)), expected, "{used} {limit}");
        }
    }

    fn shell(script: &str, limit: f64, log: Option<&Log>) -> Outcome {
        let runner = Runner { tie: Tie::Bound, limit: Some(Duration::from_secs_f64(limit)), stop: &NEVER, log };
        runner.run(Command::new("sh").args(["-c", script]), |_| ()).unwrap()
    }

    #[test]
    fn how_a_program_ends_is_told() {
        let crash = Outcome::Crashed(libc::SIGSEGV);
        for (script, outcome, words) in [
            ("true", Outcome::Done, "ended well"),
            ("exit 3", Outcome::Code(3), "exit code 3"),
            ("kill -SEGV $$", crash, "crashed (signal 11)"),
            ("kill -KILL $$", Outcome::Killed, "where memory ends"),
            ("kill -INT $$", Outcome::Interrupted, "was interrupted"),
            ("kill -TERM $$", Outcome::Interrupted, "was interrupted"),
            ("ulimit -c 0; kill -XCPU $$", Outcome::OutOfTime, "ulimit -t"),
        ] {
            let found = shell(script, 60.0, None);
            assert_eq!(found, outcome, "{script}");
            assert!(found.to_string().contains(words), "{found}");
        }
    }

    #[test]
    fn the_log_has_what_was_said() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log");
        let log = Log::create(&path).unwrap();
        assert_eq!(shell("echo one; echo two >&2", 60.0, Some(&log)), Outcome::Done);
        assert_eq!(last_lines(&path), "    one\n    two");
        assert_eq!(last_line(&path).unwrap(), "two");
    }

    #[test]
    fn what_hangs_is_ended_also_where_it_does_not_listen() {
        let began = Instant::now();
        assert_eq!(shell("exec sleep 60", 0.1, None), Outcome::TooLong(Duration::from_millis(100)));
        assert!(began.elapsed() < Duration::from_secs(30));
        assert!(matches!(shell("trap '' TERM; while true; do sleep 0.1; done", 0.1, None), Outcome::TooLong(_)));
        assert!(began.elapsed() < Duration::from_secs(30));
    }

    fn is_alive(id: &str) -> bool {
        let state = std::fs::read_to_string(format!("/proc/{}/stat", id.trim())).unwrap_or_default();
        state.rsplit(')').next().is_some_and(|rest| !rest.is_empty() && !rest.trim_start().starts_with('Z'))
    }

    fn ends(path: &Path) {
        let (id, began) = (std::fs::read_to_string(path).unwrap(), Instant::now());
        while is_alive(&id) {
            assert!(began.elapsed() < Duration::from_secs(20), "{id} is still there");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_whole_group_ends_with_its_first_process() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("id");
        let script = format!("sleep 60 & echo $! > {}", path.display());
        assert_eq!(shell(&script, 60.0, None), Outcome::Done);
        ends(&path);
        assert!(matches!(shell(&format!("{script}; wait"), 0.2, None), Outcome::TooLong(_)));
        ends(&path);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_waits_for_the_machine_has_more_time() {
        let own = || processor_time(std::process::id()).unwrap();
        let before = own();
        let began = Instant::now();
        while own() < before + Duration::from_millis(100) {
            std::hint::black_box((0..10_000).sum::<u64>());
        }
        assert!(began.elapsed() < Duration::from_secs(60));
        let second = Duration::from_secs(1);
        let mut child = Command::new("sleep").arg("60").spawn().unwrap();
        let is_over = |elapsed: Duration| is_over(child.id(), elapsed, second);
        assert!(!is_over(second / 2) && !is_over(3 * second) && is_over(5 * second));
        child.kill().unwrap();
        child.wait().unwrap();
    }

    #[test]
    fn what_runs_ends_with_an_interrupt() {
        let stop = AtomicBool::new(true);
        let runner = Runner { tie: Tie::Loose, limit: None, stop: &stop, log: None };
        assert_eq!(runner.run(Command::new("sleep").arg("60"), |_| ()).unwrap(), Outcome::Interrupted);
    }

    #[test]
    fn a_program_that_is_not_there_is_told_so() {
        let runner = Runner { tie: Tie::Bound, limit: None, stop: &NEVER, log: None };
        assert_eq!(
            runner.run(&mut Command::new("/nowhere/mesher"), |_| ()).unwrap_err().kind(),
            io::ErrorKind::NotFound
        );
    }
}
