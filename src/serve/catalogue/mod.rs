//! The database: who has which files, the queue of jobs with their ends, tokens. SQLite in the data folder, or PostgreSQL; the same statements for
//! both.
mod files;
mod jobs;
mod tokens;

pub use files::{File, Kind};
pub use jobs::{Claim, End, Job, NewJob, Produced, State};
pub use tokens::{Scope, Token};

use super::{Error, Settings};
use sqlx::any::{AnyConnectOptions, AnyPoolOptions};
use sqlx::{AnyConnection, AnyPool, Connection, Executor};
use std::str::FromStr;
use std::time::Duration;

/// All tables. A later version adds to it what is new.
const TABLES: &str = "
CREATE TABLE IF NOT EXISTS files (
    owner TEXT NOT NULL, id TEXT NOT NULL, kind TEXT NOT NULL, name TEXT NOT NULL, bytes BIGINT NOT NULL, created BIGINT NOT NULL,
    PRIMARY KEY (owner, id));
CREATE TABLE IF NOT EXISTS jobs (
    id TEXT NOT NULL PRIMARY KEY, owner TEXT NOT NULL, label TEXT NOT NULL, request TEXT NOT NULL, command TEXT NOT NULL, state TEXT NOT NULL,
    created BIGINT NOT NULL, started BIGINT, ended BIGINT, worker TEXT, attempt BIGINT NOT NULL, lease BIGINT NOT NULL,
    cancelled BIGINT NOT NULL, needs BIGINT NOT NULL, exit_code BIGINT, reason TEXT, progress TEXT);
CREATE INDEX IF NOT EXISTS jobs_of_state ON jobs (state, owner, created);
CREATE INDEX IF NOT EXISTS jobs_of_owner ON jobs (owner, created);
CREATE TABLE IF NOT EXISTS results (
    job TEXT NOT NULL, name TEXT NOT NULL, id TEXT NOT NULL, bytes BIGINT NOT NULL, PRIMARY KEY (job, name));
CREATE INDEX IF NOT EXISTS results_of_contents ON results (id);
CREATE TABLE IF NOT EXISTS tokens (
    id TEXT NOT NULL PRIMARY KEY, hash TEXT NOT NULL UNIQUE, owner TEXT NOT NULL, scopes TEXT NOT NULL, label TEXT NOT NULL,
    created BIGINT NOT NULL, expires BIGINT, revoked BIGINT);
";

/// How long a statement waits for another one's end.
const PATIENCE: Duration = Duration::from_secs(20);

/// The database.
#[derive(Clone)]
pub struct Catalogue {
    /// For who reads.
    pool: AnyPool,
    /// For who writes. Of SQLite it is one connection: whoever comes to it waits for the one before, and holds up no reader; two that write at once
    /// would sleep and try again, in connections that readers wait for.
    writer: AnyPool,
    /// Whether several machines may share it.
    is_shared: bool,
}

impl Catalogue {
    /// Opens it, and makes the tables where they are not there.
    ///
    /// # Errors
    /// When it is not to be had.
    pub async fn open(settings: &Settings) -> Result<Self, Error> {
        sqlx::any::install_default_drivers();
        let (address, is_shared) = match &settings.database {
            Some(address) => (address.clone(), true),
            None => (format!("sqlite://{}?mode=rwc", settings.data.join("catalogue.sqlite").display()), false),
        };
        let options = AnyConnectOptions::from_str(&address)?;
        let options = sqlx::ConnectOptions::disable_statement_logging(options);
        let connections = |most: u32| {
            let pool = AnyPoolOptions::new().max_connections(most).acquire_timeout(PATIENCE);
            let pool = pool.after_connect(move |connection, _| {
                Box::pin(async move {
                    if !is_shared {
                        // What is acknowledged is on the disk. Readers do not wait for a writer.
                        let how = "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA busy_timeout = 20000";
                        connection.execute(how).await?;
                    }
                    Ok(())
                })
            });
            pool.connect_with(options.clone())
        };
        // A pool would try again for long, and not say why.
        AnyConnection::connect_with(&options).await?.close().await?;
        let writer = connections(if is_shared { 8 } else { 1 }).await?;
        let pool = if is_shared { writer.clone() } else { connections(4).await? };
        let this = Self { pool, writer, is_shared };
        for table in TABLES.split(';').map(str::trim).filter(|table| !table.is_empty()) {
            sqlx::query(table).execute(&this.writer).await?;
        }
        Ok(this)
    }

    /// Whether it answers.
    ///
    /// # Errors
    /// When it does not.
    pub async fn answers(&self) -> Result<(), sqlx::Error> {
        sqlx::query("SELECT 1").execute(&self.pool).await.map(drop)
    }

    /// Whether several services may share it.
    pub fn is_shared(&self) -> bool {
        self.is_shared
    }

    /// What locks the chosen rows, and passes over those that another one holds.
    fn locked(&self) -> &'static str {
        if self.is_shared { "FOR UPDATE OF j SKIP LOCKED" } else { "" }
    }
}
