//! A warm process of the program, which forks one for each run.
use super::protocol::{Answer, Run};
use crate::process::own;
use std::collections::HashMap;
use std::io;
use std::path::Path;
use std::process::Stdio;
use std::sync::{Arc, Mutex, PoisonError};
use tokio::io::{AsyncBufReadExt, AsyncWriteExt, BufReader};
use tokio::process::{Child, ChildStdin, Command};
use tokio::sync::{mpsc, watch};

/// How far a warm process is.
#[derive(Clone, Debug)]
pub enum Warmth {
    /// It reads its model.
    Cold,
    /// It has it, in so many bytes.
    Ready(u64),
    /// It could not read it.
    Unfit,
    /// It has ended.
    Gone,
}

/// A warm process.
pub struct Process {
    input: tokio::sync::Mutex<ChildStdin>,
    warmth: watch::Receiver<Warmth>,
    runs: Arc<Mutex<HashMap<u64, mpsc::UnboundedSender<Answer>>>>,
    next: Mutex<u64>,
    /// It ends with this.
    _child: Child,
}

impl Process {
    /// Starts one, for a model or for none.
    ///
    /// # Errors
    /// When it cannot be started.
    pub fn start(model: Option<&Path>) -> io::Result<Self> {
        let mut command = Command::new(own()?);
        command.arg("warm").args(model).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
        // Ctrl-C at the terminal is for the service, which ends its jobs in good order. In a session of their own jobs do not take from the service
        // what the system gives to its session (sched_autogroup).
        // SAFETY: a system call, which may be made between fork and exec.
        unsafe { command.pre_exec(|| if libc::setsid() < 0 { Err(io::Error::last_os_error()) } else { Ok(()) }) };
        command.kill_on_drop(true);
        let mut child = command.spawn()?;
        let (Some(input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(io::Error::other("no pipes"));
        };
        let (tell, warmth) = watch::channel(Warmth::Cold);
        let runs: Arc<Mutex<HashMap<u64, mpsc::UnboundedSender<Answer>>>> = Arc::default();
        let known = Arc::clone(&runs);
        tokio::spawn(async move {
            let mut lines = BufReader::new(output).lines();
            while let Ok(Some(line)) = lines.next_line().await {
                match serde_json::from_str(&line) {
                    Ok(Answer::Ready { bytes }) => drop(tell.send(Warmth::Ready(bytes))),
                    Ok(Answer::Unfit(_)) | Err(_) => drop(tell.send(Warmth::Unfit)),
                    Ok(answer) => {
                        let (Answer::Started { number, .. }
                        | Answer::Ended { number, .. }
                        | Answer::Refused { number, .. }) = &answer
                        else {
                            continue;
                        };
                        let mut runs = known.lock().unwrap_or_else(PoisonError::into_inner);
                        // Nothing more is heard of what has ended.
                        let run = match &answer {
                            Answer::Started { .. } => runs.get(number).cloned(),
                            _ => runs.remove(number),
                        };
                        drop(runs);
                        drop(run.map(|run| run.send(answer)));
                    }
                }
            }
            // Nobody answers any more.
            drop(tell.send(Warmth::Gone));
            known.lock().unwrap_or_else(PoisonError::into_inner).clear();
        });
        Ok(Self { input: tokio::sync::Mutex::new(input), warmth, runs, next: Mutex::new(0), _child: child })
    }

    /// How far it is.
    pub fn warmth(&self) -> Warmth {
        self.warmth.borrow().clone()
    }

    /// Waits until its model is read; whether it is.
    pub async fn is_ready(&self) -> bool {
        let mut warmth = self.warmth.clone();
        let known = warmth.wait_for(|warmth| !matches!(warmth, Warmth::Cold)).await;
        known.is_ok_and(|warmth| matches!(*warmth, Warmth::Ready(_)))
    }

    /// Starts a run: what is heard of it. When the process dies nothing more is heard.
    ///
    /// # Errors
    /// When the process is gone.
    pub async fn run(&self, mut run: Run) -> io::Result<mpsc::UnboundedReceiver<Answer>> {
        let (sender, receiver) = mpsc::unbounded_channel();
        {
            let mut next = self.next.lock().unwrap_or_else(PoisonError::into_inner);
            *next += 1;
            run.number = *next;
        }
        self.runs.lock().unwrap_or_else(PoisonError::into_inner).insert(run.number, sender);
        let mut line = serde_json::to_vec(&run)?;
        line.push(b'\n');
        let mut input = self.input.lock().await;
        input.write_all(&line).await?;
        input.flush().await?;
        if matches!(self.warmth(), Warmth::Gone) {
            return Err(io::Error::other("the process is gone"));
        }
        Ok(receiver)
    }
}
