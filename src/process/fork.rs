//! Work in a process of its own that starts no program.
use std::io;
use std::process::Command;

/// Whether this process may fork one that does some of its work: it has one thread, so no lock of another is held in the new one.
pub fn may_fork() -> bool {
    cfg!(target_os = "linux") && std::fs::read_dir("/proc/self/task").is_ok_and(|threads| threads.count() == 1)
}

/// The process of this command does this work, starts no program, and ends with the exit code. There must be one thread ([`may_fork`]).
#[cfg(target_os = "linux")]
pub(super) fn work_instead(command: &mut Command, work: impl Fn() -> u8 + Send + Sync + 'static) {
    use std::os::unix::process::CommandExt;
    let work = move || {
        // The parent reads a pipe until a program is loaded here. With all files the pipe is closed, so the parent goes on.
        // SAFETY: a system call on files that the work does not use.
        if unsafe { libc::syscall(libc::SYS_close_range, 3, u32::MAX, 0) } != 0 {
            return Err(io::Error::last_os_error());
        }
        // The parent may hold back interrupts; this process has none of its handlers, and ends at once.
        super::signals::let_through();
        let code = std::panic::catch_unwind(std::panic::AssertUnwindSafe(&work));
        // SAFETY: the process ends, with nothing to be written. After a panic with the exit code that one has.
        unsafe { libc::_exit(code.map_or(101, i32::from)) }
    };
    // SAFETY: with one thread the new process is as whole as this one.
    unsafe { command.pre_exec(work) };
}

#[cfg(not(target_os = "linux"))]
pub(super) fn work_instead(_: &mut Command, _: impl Fn() -> u8 + Send + Sync + 'static) {}
