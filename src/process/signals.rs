//! The signals that ask a process to end, held back for a moment.

/// While this is there, interrupts wait: SIGINT, SIGTERM and SIGHUP reach neither this thread nor the
/// threads and processes that it starts. On Windows it does nothing.
pub struct HeldSignals(());

impl HeldSignals {
    /// From now on they wait.
    #[allow(clippy::new_without_default)]
    pub fn new() -> Self {
        #[cfg(unix)]
        mask(libc::SIG_BLOCK);
        Self(())
    }
}

impl Drop for HeldSignals {
    fn drop(&mut self) {
        let_through();
    }
}

/// Signals that have waited come now, and later ones at once.
pub(super) fn let_through() {
    #[cfg(unix)]
    mask(libc::SIG_UNBLOCK);
}

#[cfg(unix)]
fn mask(how: libc::c_int) {
    let mut signals = std::mem::MaybeUninit::<libc::sigset_t>::zeroed();
    // SAFETY: calls on a set that is ours, which the first one fills.
    unsafe {
        libc::sigemptyset(signals.as_mut_ptr());
        for signal in [libc::SIGINT, libc::SIGTERM, libc::SIGHUP] {
            libc::sigaddset(signals.as_mut_ptr(), signal);
        }
        libc::pthread_sigmask(how, signals.as_ptr(), std::ptr::null_mut());
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    /// Of the signals of this thread, those of a line of its status.
    fn line(name: &str) -> u64 {
        let status = std::fs::read_to_string("/proc/thread-self/status").unwrap();
        let value = status.lines().find_map(|line| line.strip_prefix(name)).unwrap();
        u64::from_str_radix(value.trim_start_matches(':').trim(), 16).unwrap()
    }

    #[test]
    fn interrupts_wait_while_they_are_held_and_not_after() {
        let ours = [libc::SIGINT, libc::SIGTERM, libc::SIGHUP].iter().fold(0, |all, signal| all | 1 << (signal - 1));
        // A thread of its own: the mask goes with it.
        let of_thread = std::thread::spawn(move || {
            let held = HeldSignals::new();
            let while_held = line("SigBlk");
            drop(held);
            (while_held & ours, line("SigBlk") & ours)
        });
        assert_eq!(of_thread.join().unwrap(), (ours, 0));
    }
}
