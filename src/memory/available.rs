//! How much memory a process may still take before the system ends it.
use std::path::{Path, PathBuf};

/// Bytes that can still be had: of the machine and of the control groups (Linux, version 2) that this process is in. None where the system
/// does not tell. A limit of address space (`ulimit -v`) does not count: where that is reached an allocation fails, and can be answered.
pub fn available() -> Option<u64> {
    let of_machine = std::fs::read_to_string("/proc/meminfo").ok().and_then(|text| kilobytes(&text, "MemAvailable:"));
    of_machine.into_iter().chain(of_groups()).min()
}

/// A line of /proc/meminfo, in bytes.
fn kilobytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    Some(1024 * line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?)
}

/// What the group of this process leaves, and each group around it.
fn of_groups() -> Option<u64> {
    let own = std::fs::read_to_string("/proc/self/cgroup").ok()?;
    let path = own.lines().find_map(|line| line.strip_prefix("0::/"))?;
    let root = Path::new("/sys/fs/cgroup");
    let own: PathBuf = root.join(path);
    own.ancestors().take_while(|folder| folder.starts_with(root)).filter_map(of_group).min()
}

fn of_group(folder: &Path) -> Option<u64> {
    let number = |name: &str| std::fs::read_to_string(folder.join(name)).ok()?.trim().parse::<u64>().ok();
    // Without a limit it is the word max.
    let (limit, used) = (number("memory.max")?, number("memory.current")?);
    Some(limit.saturating_sub(used))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_kilobytes_is_read() {
        let text = "MemTotal:       24576 kB\nMemAvailable:    1000 kB\n";
        assert_eq!(kilobytes(text, "MemAvailable:"), Some(1_024_000));
        assert_eq!(kilobytes(text, "SwapFree:"), None);
    }

    #[test]
    fn a_group_without_a_limit_leaves_all_and_one_with_a_limit_what_is_not_used() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("memory.current", "300\n");
        write("memory.max", "max\n");
        assert_eq!(of_group(folder.path()), None);
        write("memory.max", "1000\n");
        assert_eq!(of_group(folder.path()), Some(700));
        write("memory.max", "200\n");
        assert_eq!(of_group(folder.path()), Some(0));
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn this_machine_tells() {
        assert!(available().is_some_and(|bytes| bytes > 1 << 20));
    }
}
