//! A job that is at work here, and how it is made to end.
use std::sync::atomic::{AtomicBool, AtomicI32, AtomicU8, Ordering::SeqCst};

/// Why a run shall end.
pub const GOES_ON: u8 = 0;
pub const CANCELLED: u8 = 1;
pub const SERVICE_ENDS: u8 = 2;

/// A job that is at work here.
pub struct Running {
    /// The job.
    pub id: String,
    /// Bytes of memory that it is thought to need.
    pub memory: u64,
    /// The group of its processes, once there is one.
    group: AtomicI32,
    ends: AtomicU8,
    /// Whether its process was interrupted: a second time it would end at once, without its last valid mesh.
    is_interrupted: AtomicBool,
}

impl Running {
    /// A job that has no process yet.
    pub fn new(id: String, memory: u64) -> Self {
        let (group, ends) = (AtomicI32::new(0), AtomicU8::new(GOES_ON));
        Self { id, memory, group, ends, is_interrupted: AtomicBool::new(false) }
    }

    /// Why it shall end.
    pub fn ends(&self) -> u8 {
        self.ends.load(SeqCst)
    }

    /// Its process is there. Where it shall end already, that hears of it.
    pub fn began(&self, process: i32) {
        self.group.store(process, SeqCst);
        match self.ends() {
            GOES_ON => {}
            why => self.tell(why),
        }
    }

    /// Ends its processes at once.
    pub fn kill(&self) {
        self.signal(libc::SIGKILL);
    }

    /// It shall end. What was asked first counts.
    pub fn end(&self, why: u8) {
        let _ = self.ends.compare_exchange(GOES_ON, why, SeqCst, SeqCst);
        self.tell(why);
    }

    /// Has its process end, once there is one.
    fn tell(&self, why: u8) {
        if why != CANCELLED {
            self.signal(libc::SIGKILL);
        } else if self.group.load(SeqCst) > 1 && !self.is_interrupted.swap(true, SeqCst) {
            self.signal(libc::SIGINT);
        }
    }

    fn signal(&self, signal: i32) {
        let group = self.group.load(SeqCst);
        if group > 1 {
            // SAFETY: a system call. The group is that of a run that has not been waited for.
            unsafe { libc::kill(-group, signal) };
        }
    }
}
