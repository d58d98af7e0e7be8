//! What becomes of a job, as server-sent events: `progress` with what it says, and `end` with the job.
use super::Shared;
use super::caller::Caller;
use super::error::Problem;
use crate::serve::work::Seen;
use axum::extract::{Path, State};
use axum::response::IntoResponse;
use axum::response::sse::{Event, KeepAlive, Sse};
use std::convert::Infallible;
use std::time::Duration;
use tokio::sync::watch;

/// How often the database is asked of a job that may be at work elsewhere,
const LOOK: Duration = Duration::from_secs(2);
/// and of one that can be at work here alone.
const LOOK_HERE: Duration = Duration::from_secs(30);

/// The stream of one client.
struct Watched {
    service: Shared,
    caller: Caller,
    id: String,
    news: watch::Receiver<Seen>,
    /// What was told last.
    told: String,
    has_ended: bool,
}

impl Watched {
    /// The next event; none after the end.
    async fn next(mut self) -> Option<(Result<Event, Infallible>, Self)> {
        if self.has_ended {
            return None;
        }
        loop {
            let job = self.service.catalogue.job(&self.caller.owner, &self.id).await.ok().flatten()?;
            let text = serde_json::to_string(&job).unwrap_or_default();
            if job.state.is_end() {
                self.has_ended = true;
                return Some((Ok(Event::default().event("end").data(text)), self));
            }
            let here = self.news.borrow_and_update().progress.clone();
            let progress = here.or_else(|| job.progress.as_ref().map(ToString::to_string)).unwrap_or_default();
            let said = format!("{} {progress}", job.state.name());
            if said != self.told {
                self.told = said;
                return Some((Ok(Event::default().event("progress").data(text)), self));
            }
            // News of a job that is at work here come at once.
            let look = if self.service.catalogue.is_shared() { LOOK } else { LOOK_HERE };
            let _ = tokio::time::timeout(look, self.news.changed()).await;
        }
    }
}

/// Follows a job: events `progress` and at last `end`, each with the job as JSON
#[utoipa::path(get, path = "/jobs/{id}/events", tag = "jobs", responses((status = 200, content_type = "text/event-stream"), (status = 404, body = Problem)))]
pub async fn events(
    State(service): State<Shared>,
    caller: Caller,
    Path(id): Path<String>,
) -> Result<impl IntoResponse, Problem> {
    let news = service.hub.watch(&id);
    if service.catalogue.job(&caller.owner, &id).await?.is_none() {
        return Err(Problem::missing("job"));
    }
    let watched = Watched { service, caller, id, news, told: String::new(), has_ended: false };
    let stream = futures_util::stream::unfold(watched, Watched::next);
    Ok(Sse::new(stream).keep_alive(KeepAlive::default()))
}
