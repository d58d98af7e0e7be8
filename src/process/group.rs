//! Groups of processes: ended together, and found again by a later run.
use std::path::Path;
use std::time::{Duration, Instant};

/// How long a killed process may take to end: the system gives back its memory meanwhile.
const PATIENCE: Duration = Duration::from_secs(5);

/// A group of processes, by its first one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    id: u32,
    /// When its first process was started, in ticks since the system was, and which start of the system that was. Numbers of processes
    /// are used again, but not with the same times. Empty where the system does not tell.
    since: String,
}

impl Group {
    /// Of a process that was just started as the first of its group.
    pub fn of(id: u32) -> Self {
        Self { id, since: since(id).unwrap_or_default() }
    }

    /// The number of its first process.
    pub fn id(&self) -> u32 {
        self.id
    }

    /// For a file; [`Self::parse`] reads it.
    pub fn text(&self) -> String {
        format!("{} {}", self.id, self.since)
    }

    /// Of a file.
    pub fn parse(text: &str) -> Option<Self> {
        let (id, since) = text.trim().split_once(' ')?;
        Some(Self { id: id.parse().ok()?, since: since.into() })
    }

    /// Whether one of its processes is still there. The number alone proves nothing. The process must have started at that time; if it has
    /// ended, some process of the group must have the file open that the group writes to.
    pub fn is_there(&self, file: &Path) -> bool {
        match since(self.id) {
            _ if self.since.is_empty() => false,
            Some(since) => since == self.since,
            None => self.boot() == boot() && members(self.id).any(|process| has_open(process, file)),
        }
    }

    fn boot(&self) -> Option<String> {
        self.since.split_once(' ').map(|(_, boot)| boot.into())
    }

    /// Asks all its processes to end.
    pub fn ask_to_end(&self) {
        #[cfg(unix)]
        signal(self.id, libc::SIGTERM);
    }

    /// Ends all its processes at once.
    pub fn kill(&self) {
        #[cfg(unix)]
        signal(self.id, libc::SIGKILL);
    }

    /// Its processes with all that they have started, in other groups too; nothing on systems other than Linux.
    pub fn family(&self) -> Family {
        let mut others: Vec<_> = processes().filter_map(|id| Some((id, stat(id)?))).collect();
        let mut found: Vec<(u32, Vec<String>)> = Vec::new();
        loop {
            let is_one = |(_, words): &mut (u32, Vec<String>)| {
                let is = |place: usize, id: u32| words.get(place).is_some_and(|word| *word == id.to_string());
                is(2, self.id) || found.iter().any(|&(parent, _)| is(1, parent))
            };
            let new: Vec<_> = others.extract_if(.., is_one).collect();
            if new.is_empty() {
                break;
            }
            found.extend(new);
        }
        Family(found.into_iter().filter_map(|(id, words)| Some((id, start(&words)?))).collect())
    }
}

/// Processes by their numbers, with when they were started.
///
/// OpenMPI's mpirun starts its processes in groups of their own. It ends them when it is asked to, unless the machine is so busy that it is
/// killed before.
#[derive(Clone, Debug, Default)]
pub struct Family(Vec<(u32, String)>);

impl Family {
    /// Ends those that still work, and waits until they have ended.
    pub fn end(&self) {
        let began = Instant::now();
        let mut left: Vec<_> = self.0.iter().collect();
        loop {
            left.retain(|(id, start)| since(*id).as_ref() == Some(start));
            if left.is_empty() || began.elapsed() > PATIENCE {
                return;
            }
            for (id, _) in &left {
                #[cfg(unix)]
                // SAFETY: a call without memory.
                let _ = i32::try_from(*id).map(|id| unsafe { libc::kill(id, libc::SIGKILL) });
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

#[cfg(unix)]
fn signal(group: u32, signal: i32) {
    // 0 is our own group, and −1 everybody.
    if let Some(group) = libc::pid_t::try_from(group).ok().filter(|&group| group > 1) {
        // SAFETY: a call without memory; where there is no such group, or it is not ours, it does nothing.
        unsafe { libc::kill(-group, signal) };
    }
}

/// Asks the system to kill this process when its parent has ended, so that no orphan goes on. It is the first call in a process that
/// `parent` has started. On systems other than Linux nothing happens.
///
/// Only calls that are allowed between fork and exec.
pub(super) fn end_with_parent(parent: u32) {
    #[cfg(target_os = "linux")]
    // SAFETY: calls without memory.
    unsafe {
        libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGKILL);
        // It may have ended before.
        if u32::try_from(libc::getppid()) != Ok(parent) {
            libc::_exit(0);
        }
    }
    #[cfg(not(target_os = "linux"))]
    let _ = parent;
}

/// The words of /proc/ID/stat behind the name, which is in parentheses and may hold anything (proc(5)): from the third, the state.
fn stat(id: u32) -> Option<Vec<String>> {
    let text = std::fs::read_to_string(format!("/proc/{id}/stat")).ok()?;
    Some(text.rsplit_once(')')?.1.split_ascii_whitespace().map(str::to_owned).collect())
}

/// When a process was started; none where it has ended, even if nobody has waited for it.
fn since(id: u32) -> Option<String> {
    start(&stat(id)?)
}

/// The same from what [`stat`] says.
fn start(words: &[String]) -> Option<String> {
    (words.first()? != "Z").then_some(())?;
    Some(format!("{} {}", words.get(19)?, boot()?))
}

/// The identity of this start of the system.
fn boot() -> Option<String> {
    std::fs::read_to_string("/proc/sys/kernel/random/boot_id").ok().map(|id| id.trim().to_owned())
}

/// All processes.
fn processes() -> impl Iterator<Item = u32> {
    let all = std::fs::read_dir("/proc").into_iter().flatten().flatten();
    all.filter_map(|entry| entry.file_name().to_str()?.parse::<u32>().ok())
}

/// The processes of a group.
fn members(group: u32) -> impl Iterator<Item = u32> {
    let group = group.to_string();
    processes().filter(move |&id| stat(id).is_some_and(|words| words[0] != "Z" && words.get(2) == Some(&group)))
}

/// Whether a process has a file open.
#[cfg(unix)]
fn has_open(process: u32, file: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let Ok(wanted) = std::fs::metadata(file) else { return false };
    let open = std::fs::read_dir(format!("/proc/{process}/fd")).into_iter().flatten().flatten();
    let mut found = open.filter_map(|entry| std::fs::metadata(entry.path()).ok());
    found.any(|found| (found.dev(), found.ino()) == (wanted.dev(), wanted.ino()))
}

#[cfg(not(unix))]
fn has_open(_: u32, _: &Path) -> bool {
    false
}

/// Who has a file open, other than this process, by number and command; none where the system does not tell.
pub fn who_has_open(file: &Path) -> Option<String> {
    let found = processes().find(|&id| id != std::process::id() && has_open(id, file))?;
    Some(format!("process {found} ({})", command(found).unwrap_or_default()))
}

/// The command of a process; nothing where it has ended.
fn command(id: u32) -> Option<String> {
    let bytes = std::fs::read(format!("/proc/{id}/cmdline")).ok()?;
    let words: Vec<_> = bytes.split(|byte| *byte == 0).map(String::from_utf8_lossy).collect();
    let line = words.join(" ").trim().to_owned();
    (!line.is_empty()).then_some(line)
}

/// Processor time of a process so far, with what it has waited for, in ticks of 1/100 s; none on other systems than Linux.
pub(super) fn processor_time(id: u32) -> Option<Duration> {
    let words = stat(id)?;
    let ticks: u64 = words.get(11..15)?.iter().filter_map(|word| word.parse::<u64>().ok()).sum();
    Some(Duration::from_millis(10 * ticks))
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use std::process::{Command, Stdio};

    #[test]
    fn a_number_alone_is_no_group() {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("log");
        let file = std::fs::File::create(&log).unwrap();
        let mut command = Command::new("sh");
        command.args(["-c", "sleep 60 & echo $!; read line"]).stdin(Stdio::piped()).stderr(file).stdout(Stdio::piped());
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command.spawn().unwrap();
        let mut line = String::new();
        std::io::BufRead::read_line(&mut std::io::BufReader::new(child.stdout.take().unwrap()), &mut line).unwrap();
        let group = Group::of(child.id());
        assert_eq!(Group::parse(&group.text()), Some(group.clone()));
        assert!(group.is_there(&log) && who_has_open(&log).unwrap().contains("(s"));
        // The number of another time, or of nobody knows when.
        let other = Group { since: format!("1 {}", boot().unwrap()), ..group.clone() };
        assert!(!other.is_there(&log) && !Group { since: String::new(), ..group.clone() }.is_there(&log));
        // The first process has ended, and one of its children works on: it is known by the file that it has open.
        drop(child.stdin.take());
        child.wait().unwrap();
        assert!(group.is_there(&log) && !group.is_there(&folder.path().join("other")));
        group.kill();
        let sleeper: u32 = line.trim().parse().unwrap();
        let began = std::time::Instant::now();
        while since(sleeper).is_some() {
            assert!(began.elapsed() < Duration::from_secs(20), "it was not ended");
            std::thread::sleep(Duration::from_millis(5));
        }
        assert!(!group.is_there(&log));
    }

    #[test]
    fn a_family_ends_with_those_in_other_groups() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("id");
        let mut command = Command::new("sh");
        let inner =
            format!("trap '' TERM; echo $$ > {0}.new; mv {0}.new {0}; while true; do sleep 0.1; done", path.display());
        command.args(["-c", &format!("setsid sh -c \"{}\" & wait", inner.replace('$', "\\$"))]);
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command.spawn().unwrap();
        let began = std::time::Instant::now();
        while !path.exists() {
            assert!(began.elapsed() < Duration::from_secs(20), "it was not started");
            std::thread::sleep(Duration::from_millis(5));
        }
        let inner: u32 = std::fs::read_to_string(&path).unwrap().trim().parse().unwrap();
        let group = Group::of(child.id());
        let family = group.family();
        assert!(
            family.0.iter().any(|(id, _)| *id == inner) && !family.0.iter().any(|(id, _)| *id == std::process::id())
        );
        // A number that another process has now is left alone.
        Family(vec![(inner, "1 of another time".into())]).end();
        group.kill();
        child.wait().unwrap();
        assert!(since(inner).is_some());
        family.end();
        assert!(since(inner).is_none());
    }
}
