//! A warm process: it has read a model, or needs none, and forks a process for each run that it is asked for ([`crate::serve::protocol`]). So a run
//! begins at once, and what becomes of it touches nobody else.
//!
//! It has one thread: what is forked has one too, and no lock of another is held in it.
use super::confined::confine;
use crate::cli::{load, terminal};
use crate::serve::protocol::{Answer, Run};
use std::ffi::OsString;
use std::io;
use std::mem::MaybeUninit;
use std::path::Path;

/// First argument of a warm process; then the model.
const WARM: &str = "warm";

/// If this is a warm process: serves, and does not return but in the process of a run, with its words.
pub fn words() -> Option<Vec<OsString>> {
    let mut arguments = std::env::args_os().skip(1);
    if arguments.next()? != WARM {
        return None;
    }
    let model = arguments.next();
    if let Some(path) = &model {
        match load::keep(Path::new(path)) {
            Ok(()) => {}
            Err(error) => {
                tell(&Answer::Unfit(error.to_string()));
                std::process::exit(0);
            }
        }
    }
    if threads() > 1 {
        tell(&Answer::Unfit("reading the model has started threads".into()));
        std::process::exit(0);
    }
    tell(&Answer::Ready { bytes: own_bytes() });
    match serve() {
        Ok(Some(run)) => Some(run.words.iter().map(OsString::from).collect()),
        Ok(None) | Err(_) => std::process::exit(0),
    }
}

/// How many threads this process has.
fn threads() -> usize {
    std::fs::read_dir("/proc/self/task").map_or(1, Iterator::count)
}

/// Bytes of this process in memory.
fn own_bytes() -> u64 {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages: u64 = text.split(' ').nth(1).and_then(|pages| pages.parse().ok()).unwrap_or(0);
    pages * 4096
}

/// Answers, in one piece. Where nobody listens any more the input ends too.
fn tell(answer: &Answer) {
    let Ok(mut line) = serde_json::to_vec(answer) else { return };
    line.push(b'\n');
    let mut from = 0;
    while from < line.len() {
        // SAFETY: a system call that reads from a slice.
        let written = unsafe { libc::write(1, line[from..].as_ptr().cast(), line.len() - from) };
        match usize::try_from(written) {
            Ok(written) => from += written,
            Err(_) if io::Error::last_os_error().kind() == io::ErrorKind::Interrupted => {}
            Err(_) => return,
        }
    }
}

/// Whatever a child leaves behind becomes a child of this process: it can be ended.
fn adopt() {
    // SAFETY: a system call.
    unsafe { libc::prctl(libc::PR_SET_CHILD_SUBREAPER, 1) };
}

/// The children of this process, as far as the kernel tells.
fn children() -> Vec<i32> {
    let own = std::process::id();
    let text = std::fs::read_to_string(format!("/proc/{own}/task/{own}/children")).unwrap_or_default();
    text.split_ascii_whitespace().filter_map(|process| process.parse().ok()).collect()
}

/// The runs of this process.
#[derive(Default)]
struct Runs {
    /// Process and number of each.
    running: Vec<(i32, u64)>,
}

/// Serves until the input ends. Returns a run in its own process.
fn serve() -> io::Result<Option<Run>> {
    adopt();
    let signals = Signals::new()?;
    let (mut runs, mut input) = (Runs::default(), Vec::new());
    loop {
        let mut sources = [0, signals.file].map(|fd| libc::pollfd { fd, events: libc::POLLIN, revents: 0 });
        // SAFETY: a system call on records that are ours.
        let ready = unsafe { libc::poll(sources.as_mut_ptr(), 2, -1) };
        if ready < 0 && io::Error::last_os_error().kind() != io::ErrorKind::Interrupted {
            break;
        }
        if sources[1].revents != 0 {
            signals.drain();
            runs.reap();
        }
        if sources[0].revents != 0 {
            let mut bytes = [0_u8; 1 << 16];
            // SAFETY: a system call that writes to an array of that length.
            let read = unsafe { libc::read(0, bytes.as_mut_ptr().cast(), bytes.len()) };
            match usize::try_from(read) {
                Ok(0) | Err(_) => break,
                Ok(read) => input.extend_from_slice(&bytes[..read]),
            }
            while let Some(end) = input.iter().position(|&b| b == b'\n') {
                let line: Vec<u8> = input.drain(..=end).collect();
                let Ok(run) = serde_json::from_slice::<Run>(&line) else { continue };
                if let Some(run) = runs.begin(run, &signals) {
                    return Ok(Some(run));
                }
            }
        }
    }
    runs.end();
    Ok(None)
}

impl Runs {
    /// Forks; returns the run in its own process.
    fn begin(&mut self, run: Run, signals: &Signals) -> Option<Run> {
        let parent = std::process::id();
        // SAFETY: there is one thread, so that the process that is forked is as whole as this one.
        match unsafe { libc::fork() } {
            -1 => {
                let why = io::Error::last_os_error().to_string();
                tell(&Answer::Refused { number: run.number, why });
                None
            }
            0 => {
                signals.forget();
                // What is left behind in a run stays within it until it ends.
                adopt();
                // SAFETY: system calls. Where the parent has died in between, its end was not heard of.
                unsafe {
                    libc::setpgid(0, 0);
                    libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGKILL);
                    if libc::getppid() != parent as i32 {
                        libc::_exit(1);
                    }
                }
                if let Some(name) = &run.model {
                    load::call(Path::new(name));
                }
                if let Err(error) = confine(&run) {
                    terminal::error(format_args!("the process of the job cannot be confined: {error}"));
                    // SAFETY: the process ends, with nothing to be written.
                    unsafe { libc::_exit(2) }
                }
                Some(run)
            }
            process => {
                // SAFETY: a system call. Whichever of both does it first.
                unsafe { libc::setpgid(process, process) };
                self.running.push((process, run.number));
                tell(&Answer::Started { number: run.number, process });
                None
            }
        }
    }

    /// Tells of those that have ended. What they have left behind ends too.
    fn reap(&mut self) {
        self.tell_ended();
        for left in children() {
            if !self.running.iter().any(|(known, _)| *known == left) {
                // SAFETY: a system call on a child that has not been waited for. When it has ended, this is called again.
                unsafe { libc::kill(left, libc::SIGKILL) };
            }
        }
    }

    fn tell_ended(&mut self) {
        loop {
            let (mut status, mut usage) = (0, MaybeUninit::<libc::rusage>::zeroed());
            // SAFETY: a system call on records that are ours; all zeroes are a value of rusage.
            let (process, usage) =
                unsafe { (libc::wait4(-1, &mut status, libc::WNOHANG, usage.as_mut_ptr()), usage.assume_init()) };
            if process <= 0 {
                return;
            }
            let Some(at) = self.running.iter().position(|(known, _)| *known == process) else { continue };
            let (_, number) = self.running.swap_remove(at);
            // SAFETY: a system call. The group has no first process any more, and keeps its number as long as others are in it.
            unsafe { libc::kill(-process, libc::SIGKILL) };
            let of = |time: libc::timeval| time.tv_sec as f64 + 1e-6 * time.tv_usec as f64;
            tell(&Answer::Ended {
                number,
                code: libc::WIFEXITED(status).then(|| libc::WEXITSTATUS(status)),
                signal: libc::WIFSIGNALED(status).then(|| libc::WTERMSIG(status)),
                seconds: of(usage.ru_utime) + of(usage.ru_stime),
                bytes: u64::try_from(usage.ru_maxrss).unwrap_or(0) * 1024,
            });
        }
    }

    /// Nobody waits for them any more.
    fn end(&self) {
        for (process, _) in &self.running {
            // SAFETY: a system call on a group that has not been waited for.
            unsafe { libc::kill(-process, libc::SIGKILL) };
        }
    }
}

/// That a process has ended, as something to be read.
struct Signals {
    file: i32,
    before: libc::sigset_t,
}

impl Signals {
    fn new() -> io::Result<Self> {
        let (mut ours, mut before) = (MaybeUninit::<libc::sigset_t>::zeroed(), MaybeUninit::<libc::sigset_t>::zeroed());
        // SAFETY: system calls on records that are ours, which they fill.
        unsafe {
            libc::sigemptyset(ours.as_mut_ptr());
            libc::sigaddset(ours.as_mut_ptr(), libc::SIGCHLD);
            libc::sigprocmask(libc::SIG_BLOCK, ours.as_ptr(), before.as_mut_ptr());
            let file = libc::signalfd(-1, ours.as_ptr(), libc::SFD_NONBLOCK | libc::SFD_CLOEXEC);
            if file < 0 {
                return Err(io::Error::last_os_error());
            }
            Ok(Self { file, before: before.assume_init() })
        }
    }

    fn drain(&self) {
        let mut bytes = [0_u8; 4096];
        // SAFETY: a system call that writes to an array of that length.
        while unsafe { libc::read(self.file, bytes.as_mut_ptr().cast(), bytes.len()) } > 0 {}
    }

    /// In the process of a run, all is as it was.
    fn forget(&self) {
        // SAFETY: system calls on what `new` has made.
        unsafe {
            libc::sigprocmask(libc::SIG_SETMASK, &self.before, std::ptr::null_mut());
            libc::close(self.file);
        }
    }
}
