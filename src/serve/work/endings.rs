//! What the end of a run means to who asked for it.
use crate::serve::catalogue::{End, Produced, State};

/// How a run has ended.
pub enum Ended {
    /// By itself, or by a signal.
    Process { code: Option<i32>, signal: Option<i32> },
    /// It asks for more than there is.
    TooMuch(String),
    /// For more memory than there is now.
    Later(u64),
    /// Nobody knows.
    Vanished,
}

/// What an end means to who asked.
pub fn end_of(ended: Ended, is_cancelled: bool, lost: Option<String>, results: Vec<Produced>, log: &str) -> End {
    let (code, reason) = match ended {
        Ended::Process { code: Some(0), .. } => (Some(0), None),
        Ended::Process { code: Some(code), .. } => (Some(code), Some(why(code, log))),
        Ended::Process { signal, .. } => (None, Some(why_killed(signal.unwrap_or(0)))),
        Ended::TooMuch(why) => (None, Some(why)),
        Ended::Later(_) | Ended::Vanished => {
            (None, Some("its process vanished again and again: memory may have ended".into()))
        }
    };
    let reason = lost.or(reason);
    let state = match &reason {
        _ if is_cancelled && code != Some(0) => State::Cancelled,
        None => State::Done,
        Some(_) => State::Failed,
    };
    End { state, exit_code: code.map(i64::from), reason: reason.filter(|_| state == State::Failed), results }
}

/// What an exit code means, in the words of the program where it has said some.
fn why(code: i32, log: &str) -> String {
    let said = log.rsplit_once("geo-adapt: error: ").map(|(_, said)| said.trim());
    match (said, code) {
        (Some(said), _) => said.to_owned(),
        (None, 1) => "the mesh is not valid, or not on its model: see the report".into(),
        (None, 3) => "memory, or the vertices that it may make, ended: the mesh is the last valid one, and does not meet the metric".into(),
        (None, code) => format!("exit code {code}"),
    }
}

fn why_killed(signal: i32) -> String {
    match signal {
        libc::SIGXCPU => "it took more processor time than a job may have".into(),
        libc::SIGXFSZ => "it wrote a file larger than a job may write".into(),
        libc::SIGKILL => "it was killed: its time was over, or the machine's memory".into(),
        signal => format!("it crashed (signal {signal})"),
    }
}
