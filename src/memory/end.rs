//! Where memory ends the program ends: with one line and [`EXIT_CODE`].
//!
//! An allocation that fails would make the standard library abort, or panic on the way to it, and what a panic prints is allocated too: in
//! the worst case one thread waits for ever for a lock that it holds itself. So the program's allocator ([`super::HugePages`]) does not
//! answer that there is no memory. It writes a line from the stack and ends the program, from any thread. Code that can do with less calls
//! [`try_zeroed_vec`].
//!
//! The start of a thread that fails comes here by [`take_over_panics`], C++ by `geometry::on_memory_end`, and an abort of the C library,
//! which needs memory itself (for a thread's destructors, say), by [`take_over_aborts`].
use std::cell::Cell;
use std::fmt::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit code where the machine has no more memory, or no more threads.
pub const EXIT_CODE: u8 = 3;

/// What the main thread's stack has from the beginning, bytes.
const STACK: usize = 1 << 20;

/// Where no more than this can be had memory has ended, bytes: what a small request needs is had in steps of the system and of the C library.
const LITTLE: usize = 64 << 20;

thread_local! {
    /// Set while an allocation may fail.
    static MAY_FAIL: Cell<bool> = const { Cell::new(false) };
}

/// An array of zeroes, or none where memory ends.
pub fn try_zeroed_vec<T: bytemuck::Zeroable>(count: usize) -> Option<Vec<T>> {
    may_fail(|| bytemuck::allocation::try_zeroed_vec(count).ok())
}

/// Allocations in `work` may fail.
pub(super) fn may_fail<T>(work: impl FnOnce() -> T) -> T {
    struct Back(bool);
    impl Drop for Back {
        fn drop(&mut self) {
            MAY_FAIL.set(self.0);
        }
    }
    let _back = Back(MAY_FAIL.replace(true));
    work()
}

/// The answer of the allocator. Without memory it ends the program, unless the request may fail.
pub(super) fn checked(start: *mut u8, size: usize) -> *mut u8 {
    if start.is_null() && !MAY_FAIL.get() {
        leave(Some(size));
    }
    start
}

/// Ends the program at a panic where memory has ended: a thread without room to begin panics, and so does code that starts one.
pub fn take_over_panics() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if has_ended() {
            leave(None);
        }
        usual(panic);
    }));
}

/// Ends the program at an abort where memory has ended. Other aborts stay what they are.
pub fn take_over_aborts() {
    #[cfg(unix)]
    {
        extern "C" fn aborted(_: libc::c_int) {
            // It takes no memory and no lock. When it returns the C library goes on to abort.
            leave_if_ended();
        }
        // SAFETY: the record is all zeroes but for the function, which does what may be done in a handler of signals.
        unsafe {
            let mut action: libc::sigaction = std::mem::zeroed();
            action.sa_sigaction = aborted as extern "C" fn(libc::c_int) as usize;
            libc::sigaction(libc::SIGABRT, &action, std::ptr::null_mut());
        }
    }
}

/// Takes [`STACK`] of the main thread's stack. It grows as it is used, and where there is no memory for that the system ends the process by a
/// signal, without a word. So what is used later is there from the beginning, or the program ends here. To be called at the beginning of main.
pub fn take_stack() {
    #[inline(never)]
    fn touch() {
        std::hint::black_box(&mut [0_u8; STACK]);
    }
    // A user's own small limit of the stack is left as it is.
    #[cfg(unix)]
    if limit_of(libc::RLIMIT_STACK).is_none_or(|limit| limit >= 4 * STACK) {
        if !can_be_had(2 * STACK) {
            leave(Some(STACK));
        }
        touch();
    }
}

/// Whether there is next to no memory left.
pub fn has_ended() -> bool {
    !can_be_had(LITTLE)
}

/// Whether so many bytes can be had now.
fn can_be_had(bytes: usize) -> bool {
    #[cfg(unix)]
    // SAFETY: a new private mapping without a file overlaps nothing, and goes at once.
    unsafe {
        let (access, kind) = (libc::PROT_READ | libc::PROT_WRITE, libc::MAP_PRIVATE | libc::MAP_ANONYMOUS);
        let start = libc::mmap(std::ptr::null_mut(), bytes, access, kind, -1, 0);
        start != libc::MAP_FAILED && libc::munmap(start, bytes) == 0
    }
    #[cfg(not(unix))]
    {
        let _ = bytes;
        true
    }
}

/// Whether there is, or was at any time before, next to no memory left of what the process may have (`ulimit -v`). For code that answers an
/// allocation that failed by another error.
pub fn has_been_short() -> bool {
    has_ended() || peak().zip(address_space()).is_some_and(|(peak, limit)| peak.saturating_add(LITTLE) > limit)
}

/// Most address space of this process so far, bytes.
fn peak() -> Option<usize> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("VmPeak:"))?;
    Some(1024 * line.trim().trim_end_matches("kB").trim().parse::<usize>().ok()?)
}

/// Most that it may have, bytes.
fn address_space() -> Option<usize> {
    #[cfg(unix)]
    return limit_of(libc::RLIMIT_AS);
    #[cfg(not(unix))]
    None
}

/// A limit of this process, bytes.
#[cfg(unix)]
fn limit_of(resource: libc::__rlimit_resource_t) -> Option<usize> {
    let mut limit = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
    // SAFETY: getrlimit writes to a record of its own kind, which is ours.
    let is_known = unsafe { libc::getrlimit(resource, &mut limit) } == 0;
    usize::try_from(limit.rlim_cur).ok().filter(|_| is_known && limit.rlim_cur != libc::RLIM_INFINITY)
}

/// Ends the program where memory has ended, or does nothing where a request was too large for a machine that has memory. For C++
/// (`std::set_new_handler`).
pub extern "C" fn leave_if_ended() {
    if has_ended() {
        leave(None);
    }
}

/// Writes the line and ends the program, without any allocation; `size` is what could not be had, bytes.
#[cold]
pub fn leave(size: Option<usize>) -> ! {
    static BEGUN: AtomicBool = AtomicBool::new(false);
    // One line is enough: a second thread waits until the first one has ended the program.
    while BEGUN.swap(true, Ordering::SeqCst) {
        #[cfg(unix)]
        // SAFETY: a call without memory. What the standard library has for this may allocate.
        unsafe {
            libc::pause();
        }
    }
    let mut line = Line { bytes: [0; 256], length: 0 };
    let _ = line.write_str("geo-adapt: error: out of memory");
    if let Some(size) = size {
        let _ = write!(line, " ({size} bytes more cannot be had)");
    }
    let _ = line.write_str(
        "; free some, raise its limit (ulimit -v), or ask for less: a smaller --complexity, fewer --threads\n",
    );
    #[cfg(unix)]
    // SAFETY: the bytes are the line's own; nothing is left to be done by the process.
    unsafe {
        libc::write(libc::STDERR_FILENO, line.bytes.as_ptr().cast(), line.length);
        libc::_exit(i32::from(EXIT_CODE));
    }
    #[cfg(not(unix))]
    std::process::abort()
}

/// A line on the stack; what does not fit is cut off.
struct Line {
    bytes: [u8; 256],
    length: usize,
}

impl Write for Line {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let room = &mut self.bytes[self.length..];
        let fits = text.len().min(room.len());
        room[..fits].copy_from_slice(&text.as_bytes()[..fits]);
        self.length += fits;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_may_fail_is_told_and_nothing_else_may() {
        assert!(try_zeroed_vec::<u64>(1 << 58).is_none());
        assert_eq!(try_zeroed_vec::<u64>(3), Some(vec![0; 3]));
        assert!(!MAY_FAIL.get());
        assert!(!has_ended() && !has_been_short());
    }

    #[test]
    fn a_line_that_is_too_long_is_cut() {
        let mut line = Line { bytes: [0; 256], length: 0 };
        write!(line, "{}", "x".repeat(300)).unwrap();
        assert_eq!(line.length, 256);
    }
}
