//! A solver that `geo-adapt cycle` has prepared, run to its end in a process of its own.
use super::interrupt::{self, Interrupted};
use super::print;
use std::error::Error;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering::SeqCst;

/// What such a run came to; what it tells is printed line by line.
///
/// # Errors
/// The run's own, as an interrupt where it was ended by one; and when nothing can be printed.
pub fn driven<T>(
    drive: impl FnOnce(&AtomicBool, &mut dyn FnMut(&str)) -> Result<T, String>,
) -> Result<T, Box<dyn Error>> {
    let (stop, mut printed) = (interrupt::end_at_once(), Ok(()));
    let outcome = drive(stop, &mut |line| {
        // The solver goes on: what it has done counts more than what can be said of it.
        let done = print(&format!("{line}\n"));
        printed = std::mem::replace(&mut printed, Ok(())).and(done);
    });
    let outcome = outcome.map_err(|error| -> Box<dyn Error> {
        if stop.load(SeqCst) { Interrupted(error).into() } else { error.into() }
    })?;
    printed?;
    Ok(outcome)
}
