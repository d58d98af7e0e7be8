//! The service: models, meshes and fields are kept, and the program's commands run on them on request, over HTTP.
//!
//! `api` is what clients see, `catalogue` the database, `blobs` where contents lie, `work` takes jobs from the queue and runs each as a process
//! of this program. Nothing of a client reaches a shell or names a file outside of its job's folder ([`commands`]).
mod api;
mod blobs;
mod catalogue;
mod commands;
mod ids;
mod settings;
mod work;

pub use commands::Commands;
pub use settings::{Limits, Settings, Solvers, Tls};
pub use work::protocol;

use api::Service;
use blobs::Blobs;
use catalogue::Catalogue;
pub use catalogue::{Scope, Token};
use std::sync::Arc;

/// Why the service does not start, or ends.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file or a folder.
    #[error("{what}: {error}")]
    Disk {
        /// Which.
        what: String,
        /// What the system says.
        error: std::io::Error,
    },
    /// The database.
    #[error("the database: {0}")]
    Database(#[from] sqlx::Error),
    /// The store of contents.
    #[error("the store: {0}")]
    Store(#[from] object_store::Error),
    /// What was asked of it.
    #[error("{0}")]
    Settings(String),
}

impl Error {
    fn disk(what: impl std::fmt::Display) -> impl FnOnce(std::io::Error) -> Self {
        let what = what.to_string();
        move |error| Self::Disk { what, error }
    }
}

/// Serves until it is asked to end. `told` gets the address.
///
/// # Errors
/// When it cannot start.
pub fn run(settings: Settings, commands: Commands, told: impl FnOnce(String)) -> Result<(), Error> {
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build();
    runtime.map_err(Error::disk("threads"))?.block_on(async {
        let held = settings.hold()?;
        let catalogue = Catalogue::open(&settings).await?;
        let blobs = Blobs::open(&settings).await?;
        let service = Arc::new(Service::new(settings, commands, catalogue, blobs));
        let worker = work::start(Arc::clone(&service)).await?;
        let served = api::listen(&service, told).await;
        worker.end().await;
        drop(held);
        served
    })
}

/// Does something with the tokens of a service that may run meanwhile.
///
/// # Errors
/// When the database is not to be had, or refuses.
pub fn with_tokens<T>(
    settings: &Settings,
    what: impl AsyncFnOnce(&catalogue::Catalogue) -> Result<T, sqlx::Error>,
) -> Result<T, Error> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    runtime.map_err(Error::disk("threads"))?.block_on(async {
        settings.make_folders()?;
        let catalogue = Catalogue::open(settings).await?;
        Ok(what(&catalogue).await?)
    })
}
