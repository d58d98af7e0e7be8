//! The queue of jobs, and what has become of them.
use super::Catalogue;
use crate::serve::ids::{new_id, now};
use serde::{Deserialize, Serialize};
use sqlx::Row;
use sqlx::any::AnyRow;
use utoipa::ToSchema;

/// How far a job is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum State {
    /// It waits.
    Queued,
    /// It is at work.
    Running,
    /// It has ended well.
    Done,
    /// It has ended otherwise; `reason` says why.
    Failed,
    /// It was ended on request, with the last valid mesh where it had one.
    Cancelled,
}

impl State {
    const ALL: [Self; 5] = [Self::Queued, Self::Running, Self::Done, Self::Failed, Self::Cancelled];

    /// As the database has it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Queued => "queued",
            Self::Running => "running",
            Self::Done => "done",
            Self::Failed => "failed",
            Self::Cancelled => "cancelled",
        }
    }

    fn of(name: &str) -> Self {
        Self::ALL.into_iter().find(|state| state.name() == name).unwrap_or(Self::Failed)
    }

    /// Whether nothing more comes.
    pub fn is_end(self) -> bool {
        !matches!(self, Self::Queued | Self::Running)
    }
}

/// A job.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
pub struct Job {
    /// What it is known by.
    pub id: String,
    /// What its owner calls it.
    pub label: String,
    /// The command, as `adapt` or `metric multiscale`.
    pub command: String,
    /// How far it is.
    pub state: State,
    /// When it was asked for, milliseconds since 1970.
    pub created: i64,
    /// When it began.
    pub started: Option<i64>,
    /// When it ended.
    pub ended: Option<i64>,
    /// How often it was begun: more than once where a worker died.
    pub attempt: i64,
    /// The exit code of the command.
    pub exit_code: Option<i64>,
    /// Why it did not end well.
    pub reason: Option<String>,
    /// The last that it said of its progress.
    #[schema(value_type = Object)]
    pub progress: Option<serde_json::Value>,
    /// What was asked for.
    #[schema(value_type = Object)]
    pub request: serde_json::Value,
}

impl Job {
    fn of(row: &AnyRow) -> Result<Self, sqlx::Error> {
        let state: String = row.try_get("state")?;
        let (progress, request): (Option<String>, String) = (row.try_get("progress")?, row.try_get("request")?);
        Ok(Self {
            id: row.try_get("id")?,
            label: row.try_get("label")?,
            command: row.try_get("command")?,
            state: State::of(&state),
            created: row.try_get("created")?,
            started: row.try_get("started")?,
            ended: row.try_get("ended")?,
            attempt: row.try_get("attempt")?,
            exit_code: row.try_get("exit_code")?,
            reason: row.try_get("reason")?,
            progress: progress.and_then(|text| serde_json::from_str(&text).ok()),
            request: serde_json::from_str(&request).unwrap_or_default(),
        })
    }
}

/// A file that a job has made.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Produced {
    /// What it is called.
    pub name: String,
    /// SHA-256 of its contents.
    pub id: String,
    /// How many bytes it has.
    pub bytes: i64,
}

/// A job that is asked for.
pub struct NewJob<'a> {
    /// Who asks.
    pub owner: &'a str,
    /// What they call it.
    pub label: &'a str,
    /// The command.
    pub command: &'a str,
    /// All of the request, as JSON.
    pub request: &'a str,
    /// Bytes of memory that it is thought to need.
    pub needs: u64,
}

/// A job that a worker has taken.
#[derive(Clone, Debug)]
pub struct Claim {
    /// What it is known by.
    pub id: String,
    /// Whose it is.
    pub owner: String,
    /// All of the request, as JSON.
    pub request: String,
    /// Which time this is.
    pub attempt: i64,
    /// Bytes of memory that it is thought to need.
    pub needs: u64,
}

/// How a job ended.
pub struct End {
    /// How.
    pub state: State,
    /// The exit code of the command.
    pub exit_code: Option<i64>,
    /// Why not well.
    pub reason: Option<String>,
    /// What it has made.
    pub results: Vec<Produced>,
}

impl Catalogue {
    /// Puts a job at the end of the queue: its name.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn add_job(&self, new: NewJob<'_>) -> Result<String, sqlx::Error> {
        let id = new_id()?;
        let text =
            "INSERT INTO jobs (id, owner, label, request, command, state, created, attempt, lease, cancelled, needs)
            VALUES ($1, $2, $3, $4, $5, 'queued', $6, 0, 0, 0, $7)";
        let query = sqlx::query(text).bind(&id).bind(new.owner).bind(new.label).bind(new.request).bind(new.command);
        query.bind(now()).bind(new.needs as i64).execute(&self.writer).await?;
        Ok(id)
    }

    /// A job of an owner.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn job(&self, owner: &str, id: &str) -> Result<Option<Job>, sqlx::Error> {
        let row = sqlx::query("SELECT * FROM jobs WHERE owner = $1 AND id = $2").bind(owner).bind(id);
        row.fetch_optional(&self.pool).await?.as_ref().map(Job::of).transpose()
    }

    /// The jobs of an owner, the newest first; those that are older than one.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn jobs(
        &self,
        owner: &str,
        state: Option<State>,
        before: &str,
        most: i64,
    ) -> Result<Vec<Job>, sqlx::Error> {
        let text = "SELECT * FROM jobs WHERE owner = $1 AND ($2 = '' OR state = $2) AND ($3 = '' OR id < $3) ORDER BY id DESC LIMIT $4";
        let query = sqlx::query(text).bind(owner).bind(state.map_or("", State::name)).bind(before).bind(most);
        query.fetch_all(&self.pool).await?.iter().map(Job::of).collect()
    }

    /// How many jobs there are in a state: of an owner, or of all.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn count_jobs(&self, owner: Option<&str>, states: [State; 2]) -> Result<u64, sqlx::Error> {
        let text = "SELECT COUNT(*) FROM jobs WHERE state IN ($1, $2) AND ($3 = '' OR owner = $3)";
        let query = sqlx::query(text).bind(states[0].name()).bind(states[1].name()).bind(owner.unwrap_or(""));
        let count: i64 = query.fetch_one(&self.pool).await?.try_get(0)?;
        Ok(u64::try_from(count).unwrap_or(0))
    }

    /// Takes the next job that needs no more memory than this, until the end of a lease: of the owner of whom the fewest are at work, the oldest.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn claim(&self, worker: &str, lease: i64, memory: u64) -> Result<Option<Claim>, sqlx::Error> {
        let text = format!(
            "UPDATE jobs SET state = 'running', worker = $1, attempt = attempt + 1, lease = $2, started = COALESCE(started, $3)
            WHERE state = 'queued' AND id = (SELECT j.id FROM jobs j WHERE j.state = 'queued' AND j.needs <= $4
                ORDER BY (SELECT COUNT(*) FROM jobs r WHERE r.state = 'running' AND r.owner = j.owner), j.created, j.id LIMIT 1 {})
            RETURNING id, owner, request, attempt, needs",
            self.locked()
        );
        let query = sqlx::query(&text).bind(worker).bind(lease).bind(now()).bind(memory as i64);
        let Some(row) = query.fetch_optional(&self.writer).await? else { return Ok(None) };
        Ok(Some(Claim {
            id: row.try_get("id")?,
            owner: row.try_get("owner")?,
            request: row.try_get("request")?,
            attempt: row.try_get("attempt")?,
            needs: u64::try_from(row.try_get::<i64, _>("needs")?).unwrap_or(0),
        }))
    }

    /// The jobs of a worker are its own until this time. Returns those of them that shall end.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn renew(&self, worker: &str, lease: i64) -> Result<Vec<String>, sqlx::Error> {
        let text = "UPDATE jobs SET lease = $2 WHERE worker = $1 AND state = 'running'";
        sqlx::query(text).bind(worker).bind(lease).execute(&self.writer).await?;
        let text = "SELECT id FROM jobs WHERE worker = $1 AND state = 'running' AND cancelled = 1";
        let rows = sqlx::query(text).bind(worker).fetch_all(&self.pool).await?;
        rows.iter().map(|row| row.try_get(0)).collect()
    }

    /// Jobs of workers that are gone wait again: those whose lease is over, or all that are at work, where no other service shares the database.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn take_back(&self, all: bool) -> Result<u64, sqlx::Error> {
        let text = "UPDATE jobs SET state = 'queued', worker = NULL WHERE state = 'running' AND (lease < $1 OR $2 = 1)";
        let query = sqlx::query(text).bind(now()).bind(i64::from(all));
        Ok(query.execute(&self.writer).await?.rows_affected())
    }

    /// A job that was taken waits again, and is known to need so much memory. Whether it was still ours.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn put_back(&self, (id, attempt): (&str, i64), worker: &str, needs: u64) -> Result<bool, sqlx::Error> {
        let text = "UPDATE jobs SET state = 'queued', worker = NULL, needs = $4
            WHERE id = $1 AND attempt = $2 AND worker = $3 AND state = 'running'";
        let query = sqlx::query(text).bind(id).bind(attempt).bind(worker).bind(needs as i64);
        Ok(query.execute(&self.writer).await?.rows_affected() > 0)
    }

    /// What a job says of its progress, as JSON.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn note_progress(&self, id: &str, progress: &str) -> Result<(), sqlx::Error> {
        let text = "UPDATE jobs SET progress = $2 WHERE id = $1 AND state = 'running'";
        sqlx::query(text).bind(id).bind(progress).execute(&self.writer).await.map(drop)
    }

    /// A job has ended: once, for the worker that has it, with all its results or not at all. Whether it was still ours.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn end_job(&self, (id, attempt): (&str, i64), worker: &str, end: &End) -> Result<bool, sqlx::Error> {
        let mut all = self.writer.begin().await?;
        let text = "UPDATE jobs SET state = $4, exit_code = $5, reason = $6, ended = $7, worker = NULL
            WHERE id = $1 AND attempt = $2 AND worker = $3 AND state = 'running'";
        let query = sqlx::query(text).bind(id).bind(attempt).bind(worker).bind(end.state.name()).bind(end.exit_code);
        if query.bind(end.reason.as_deref()).bind(now()).execute(&mut *all).await?.rows_affected() == 0 {
            return Ok(false);
        }
        for Produced { name, id: contents, bytes } in &end.results {
            let text = "INSERT INTO results (job, name, id, bytes) VALUES ($1, $2, $3, $4)";
            sqlx::query(text).bind(id).bind(name).bind(contents).bind(*bytes).execute(&mut *all).await?;
        }
        all.commit().await?;
        Ok(true)
    }

    /// A job shall end. One that waits has ended with that; whether there was one that had not.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn cancel(&self, owner: &str, id: &str) -> Result<bool, sqlx::Error> {
        let text = "UPDATE jobs SET cancelled = 1, ended = CASE WHEN state = 'queued' THEN $3 ELSE ended END,
                state = CASE WHEN state = 'queued' THEN 'cancelled' ELSE state END
            WHERE owner = $1 AND id = $2 AND state IN ('queued', 'running')";
        Ok(sqlx::query(text).bind(owner).bind(id).bind(now()).execute(&self.writer).await?.rows_affected() > 0)
    }

    /// Whether a job shall end.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn is_cancelled(&self, id: &str) -> Result<bool, sqlx::Error> {
        let row = sqlx::query("SELECT 1 FROM jobs WHERE id = $1 AND cancelled = 1").bind(id);
        Ok(row.fetch_optional(&self.pool).await?.is_some())
    }

    /// Forgets a job that has ended, with its results; whether there was one.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn remove_job(&self, owner: &str, id: &str) -> Result<bool, sqlx::Error> {
        let mut all = self.writer.begin().await?;
        let text = "DELETE FROM jobs WHERE owner = $1 AND id = $2 AND state NOT IN ('queued', 'running')";
        if sqlx::query(text).bind(owner).bind(id).execute(&mut *all).await?.rows_affected() == 0 {
            return Ok(false);
        }
        sqlx::query("DELETE FROM results WHERE job = $1").bind(id).execute(&mut *all).await?;
        all.commit().await?;
        Ok(true)
    }

    /// What a job of an owner has made.
    ///
    /// # Errors
    /// When the database refuses.
    pub async fn results(&self, owner: &str, id: &str) -> Result<Vec<Produced>, sqlx::Error> {
        let text = "SELECT r.name, r.id, r.bytes FROM results r JOIN jobs j ON j.id = r.job
            WHERE j.owner = $1 AND j.id = $2 ORDER BY r.name";
        let rows = sqlx::query(text).bind(owner).bind(id).fetch_all(&self.pool).await?;
        let of = |row: &AnyRow| {
            Ok(Produced { name: row.try_get("name")?, id: row.try_get("id")?, bytes: row.try_get("bytes")? })
        };
        rows.iter().map(of).collect()
    }
}
