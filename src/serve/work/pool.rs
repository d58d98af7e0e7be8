//! Warm processes: one for what needs no model, and one for each of the models of late, as far as memory allows.
use super::process::{Process, Warmth};
use crate::serve::blobs::Blobs;
use std::io;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// Most models that are kept.
const MOST: usize = 16;

/// The processes.
pub struct Pool {
    plain: Mutex<Option<Arc<Process>>>,
    /// By the id of the model's contents and its ending; the last used one is the last.
    models: Mutex<Vec<(String, Arc<Process>)>>,
    /// Where models lie for those that read them.
    folder: PathBuf,
    /// Bytes that all of them may take.
    memory: u64,
}

impl Pool {
    /// None yet.
    pub fn new(folder: PathBuf, memory: u64) -> Self {
        Self { plain: Mutex::default(), models: Mutex::default(), folder, memory }
    }

    /// The process for what needs no model.
    ///
    /// # Errors
    /// When it cannot be started.
    pub fn plain(&self) -> io::Result<Arc<Process>> {
        let mut plain = self.plain.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(process) = plain.as_ref().filter(|process| !matches!(process.warmth(), Warmth::Gone)) {
            return Ok(Arc::clone(process));
        }
        let process = Arc::new(Process::start(None)?);
        *plain = Some(Arc::clone(&process));
        Ok(process)
    }

    /// The process that has a model, which was called by such a name: one that has it since long, or a new one. None where the model cannot be read:
    /// the command itself says why.
    ///
    /// # Errors
    /// When it cannot be started.
    pub async fn of_model(&self, blobs: &Blobs, id: &str, name: &str) -> io::Result<Option<Arc<Process>>> {
        let ending = name.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase()).unwrap_or_default();
        let key = format!("{id}.{ending}");
        let process = match self.known(&key) {
            Some(process) => process,
            None => {
                std::fs::create_dir_all(&self.folder)?;
                let path = self.folder.join(&key);
                if !path.exists() {
                    blobs.place(id, &path).await?;
                }
                let process = Arc::new(Process::start(Some(&path))?);
                self.keep(key.clone(), Arc::clone(&process));
                process
            }
        };
        if process.is_ready().await {
            self.make_room();
            return Ok(Some(process));
        }
        self.lock().retain(|(known, _)| *known != key);
        Ok(None)
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Vec<(String, Arc<Process>)>> {
        self.models.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn known(&self, key: &str) -> Option<Arc<Process>> {
        let mut models = self.lock();
        models.retain(|(_, process)| !matches!(process.warmth(), Warmth::Gone));
        let at = models.iter().position(|(known, _)| known == key)?;
        let entry = models.remove(at);
        let process = Arc::clone(&entry.1);
        models.push(entry);
        Some(process)
    }

    fn keep(&self, key: String, process: Arc<Process>) {
        self.lock().push((key, process));
    }

    /// The least recently used go, where there are too many or too large ones. Those that are at work stay.
    fn make_room(&self) {
        let bytes = |process: &Arc<Process>| match process.warmth() {
            Warmth::Ready(bytes) => bytes,
            _ => 0,
        };
        let mut models = self.lock();
        while models.len() > 1 {
            let all: u64 = models.iter().map(|(_, process)| bytes(process)).sum();
            if all <= self.memory && models.len() <= MOST {
                return;
            }
            let last = models.len() - 1;
            let Some(at) = models[..last].iter().position(|(_, process)| Arc::strong_count(process) == 1) else {
                return;
            };
            let (key, _) = models.remove(at);
            drop(std::fs::remove_file(self.folder.join(key)));
        }
    }

    /// How many models are in memory, and their bytes.
    pub fn kept(&self) -> (usize, u64) {
        let models = self.lock();
        let bytes = models.iter().map(|(_, process)| match process.warmth() {
            Warmth::Ready(bytes) => bytes,
            _ => 0,
        });
        (models.len(), bytes.sum())
    }
}
