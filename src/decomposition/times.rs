//! What parts and rounds took. It is told, and decides nothing.
use std::time::Instant;

/// A round.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Told {
    /// Parts.
    pub parts: usize,
    /// Tetrahedra that it began with.
    pub tets: usize,
    /// Vertices of the parts after it; one on several counts for each.
    pub vertices: usize,
    /// Wall time, s.
    pub seconds: f64,
    /// Of it those for finding the cuts, which every rank does, s.
    pub cutting: f64,
    /// And for giving the parts their shares, with the waiting in it, s.
    pub dealing: f64,
    /// What each part was.
    pub of_parts: Vec<ToldPart>,
}

/// A part of a round.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub struct ToldPart {
    /// The rank that adapted it.
    pub rank: u32,
    /// The work that it was expected to be, in vertices.
    pub work: f64,
    /// Its vertices in the end.
    pub vertices: u64,
    /// Of these, those that are not finished.
    pub active: u64,
    /// The tetrahedra that are not finished.
    pub active_tets: u64,
    /// Joining its shares, adapting it, and taking it apart, s: of its thread, or by the clock where it has several.
    pub seconds: f64,
}

impl Told {
    /// Seconds of the part that took longest, and of all parts.
    pub fn greatest_and_sum(&self) -> [f64; 2] {
        let seconds = self.of_parts.iter().map(|part| part.seconds);
        [seconds.clone().fold(0.0, f64::max), seconds.sum()]
    }
}

/// Where the decomposed mesh got its numbers, s.
#[derive(Clone, Copy, Debug, Default, serde::Serialize)]
pub struct Numbered {
    /// The outlines of all pieces, and their way to every rank.
    pub outlines: f64,
    /// The numbers of the vertices, which every rank finds.
    pub numbers: f64,
    /// The boundary with its crossings, by every rank.
    pub boundary: f64,
}

/// Measures what one thread does: the time that it has run, where the system tells it (Linux), else by the clock.
pub struct Stopwatch {
    began: Instant,
    ran: Option<f64>,
}

impl Stopwatch {
    /// From now on; `is_alone` where no other thread helps.
    pub fn start(is_alone: bool) -> Self {
        Self { began: Instant::now(), ran: is_alone.then(thread_seconds).flatten() }
    }

    /// Seconds so far. To be asked on the thread that started it.
    pub fn seconds(&self) -> f64 {
        let ran = self.ran.and_then(|before| Some(thread_seconds()? - before));
        ran.unwrap_or_else(|| self.began.elapsed().as_secs_f64())
    }

    /// Seconds so far; from now on they are counted anew.
    pub fn lap(&mut self) -> f64 {
        let seconds = self.seconds();
        *self = Self::start(self.ran.is_some());
        seconds
    }
}

/// How long this thread has run.
fn thread_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(text.split(' ').next()?.parse::<f64>().ok()? * 1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn a_thread_that_sleeps_does_not_run() {
        let [alone, helped] = [true, false].map(Stopwatch::start);
        std::thread::sleep(Duration::from_millis(60));
        assert!(helped.seconds() >= 0.06);
        if thread_seconds().is_some() {
            assert!(alone.seconds() < 0.03, "{}", alone.seconds());
        }
    }
}
