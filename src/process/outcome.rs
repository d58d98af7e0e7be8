//! How a program ended.
use std::fmt;
use std::process::ExitStatus;
use std::time::Duration;

/// How a program ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// With exit code 0.
    Done,
    /// With another exit code.
    Code(i32),
    /// By the user: by us, or by a signal that asks a program to end.
    Interrupted,
    /// It took longer than this, and we ended it.
    TooLong(Duration),
    /// By the system's own limit of processor time.
    OutOfTime,
    /// By SIGKILL, which did not come from us. Linux sends that where memory ends.
    Killed,
    /// By a signal that tells of a fault in the program.
    Crashed(i32),
}

impl Outcome {
    /// Of a program that ended by itself, or by somebody else's signal.
    pub fn of(status: ExitStatus) -> Self {
        match (status.code(), signal(status)) {
            (Some(0), _) => Self::Done,
            (Some(code), _) => Self::Code(code),
            (None, Some(signal)) => Self::of_signal(signal),
            (None, None) => Self::Killed,
        }
    }

    #[cfg(unix)]
    fn of_signal(signal: i32) -> Self {
        match signal {
            libc::SIGKILL => Self::Killed,
            libc::SIGINT | libc::SIGTERM | libc::SIGHUP | libc::SIGQUIT => Self::Interrupted,
            libc::SIGXCPU => Self::OutOfTime,
            _ => Self::Crashed(signal),
        }
    }

    #[cfg(not(unix))]
    fn of_signal(signal: i32) -> Self {
        Self::Crashed(signal)
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Done => write!(f, "ended well"),
            Self::Code(code) => write!(f, "ended with exit code {code}"),
            Self::Interrupted => write!(f, "was interrupted"),
            Self::TooLong(limit) => write!(f, "had not ended after {} s and was ended", limit.as_secs_f64()),
            Self::OutOfTime => write!(f, "used up the processor time that the system gives it (ulimit -t)"),
            Self::Killed => write!(f, "was killed (signal 9), as the system does where memory ends"),
            Self::Crashed(signal) => write!(f, "crashed (signal {signal})"),
        }
    }
}

#[cfg(unix)]
fn signal(status: ExitStatus) -> Option<i32> {
    std::os::unix::process::ExitStatusExt::signal(&status)
}

#[cfg(not(unix))]
fn signal(_: ExitStatus) -> Option<i32> {
    None
}
