//! Jobs: a command on files, and what became of it.
use super::Shared;
use super::caller::Caller;
use super::download::contents;
use super::error::Problem;
use super::uploads::check_room;
use crate::serve::catalogue::{Job, NewJob, Produced, State};
use crate::serve::commands::Request;
use crate::serve::work::LOG_NAME;
use axum::Json;
use axum::extract::rejection::{JsonRejection, QueryRejection};
use axum::extract::{Path, Query, State as Of};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use utoipa::IntoParams;

/// Most that a list has.
const MOST: i64 = 200;

/// Most bytes of a log while a job is at work.
const MOST_LOG: u64 = 1 << 18;

/// Which jobs to list.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
pub struct Listed {
    /// In which state.
    state: Option<State>,
    /// Older than this one.
    #[serde(default)]
    before: String,
    /// At most so many, up to 200.
    limit: Option<u32>,
}

/// Lists jobs, the newest first
#[utoipa::path(get, path = "/jobs", tag = "jobs", params(Listed), responses((status = 200, body = [Job])))]
pub async fn list(
    Of(service): Of<Shared>,
    caller: Caller,
    asked: Result<Query<Listed>, QueryRejection>,
) -> Result<Json<Vec<Job>>, Problem> {
    let Query(Listed { state, before, limit }) = asked?;
    let most = limit.map_or(MOST, i64::from).clamp(1, MOST);
    Ok(Json(service.catalogue.jobs(&caller.owner, state, &before, most).await?))
}

/// Asks for a job. It waits until there is room for it
#[utoipa::path(
    post, path = "/jobs", tag = "jobs", request_body = Request,
    responses((status = 202, body = Job), (status = 400, body = Problem), (status = 429, body = Problem))
)]
pub async fn add(
    Of(service): Of<Shared>,
    caller: Caller,
    asked: Result<Json<Request>, JsonRejection>,
) -> Result<Response, Problem> {
    let Json(request) = asked?;
    service.commands.check(&request).map_err(|error| Problem::bad(error.to_string()))?;
    for (name, id) in &request.files {
        if !service.catalogue.may_read(&caller.owner, id).await? {
            return Err(Problem::bad(format!(
                "files: {name}: there is no upload and no result of yours with the id {id}"
            )));
        }
    }
    check_room(&service, &caller, 0).await?;
    let limits = service.settings.limits;
    let waiting = service.catalogue.count_jobs(Some(&caller.owner), [State::Queued, State::Running]).await?;
    if waiting >= limits.owner_jobs {
        let text =
            format!("{waiting} jobs of yours have not ended, and {} may be: wait, or cancel some", limits.owner_jobs);
        return Err(Problem::new(StatusCode::TOO_MANY_REQUESTS, text));
    }
    let text = serde_json::to_string(&request).map_err(Problem::ours)?;
    let new =
        NewJob { owner: &caller.owner, label: &request.label, command: &request.command, request: &text, needs: 0 };
    let id = service.catalogue.add_job(new).await?;
    if let Some(shop) = service.shop() {
        shop.wake();
    }
    let job = service.catalogue.job(&caller.owner, &id).await?.ok_or_else(|| Problem::missing("job"))?;
    let location = [(header::LOCATION, format!("/v1/jobs/{id}"))];
    Ok((StatusCode::ACCEPTED, location, Json(job)).into_response())
}

/// Looks up a job
#[utoipa::path(get, path = "/jobs/{id}", tag = "jobs", responses((status = 200, body = Job), (status = 404, body = Problem)))]
pub async fn get(Of(service): Of<Shared>, caller: Caller, Path(id): Path<String>) -> Result<Json<Job>, Problem> {
    service.catalogue.job(&caller.owner, &id).await?.map(Json).ok_or_else(|| Problem::missing("job"))
}

/// Forgets a job that has ended, with its results
#[utoipa::path(delete, path = "/jobs/{id}", tag = "jobs", responses((status = 204), (status = 409, body = Problem)))]
pub async fn remove(Of(service): Of<Shared>, caller: Caller, Path(id): Path<String>) -> Result<Response, Problem> {
    let job = service.catalogue.job(&caller.owner, &id).await?.ok_or_else(|| Problem::missing("job"))?;
    let results = service.catalogue.results(&caller.owner, &id).await?;
    if !service.catalogue.remove_job(&caller.owner, &job.id).await? {
        return Err(Problem::new(StatusCode::CONFLICT, "it has not ended: cancel it first"));
    }
    for result in results {
        service.forget(&result.id).await;
    }
    Ok(StatusCode::NO_CONTENT.into_response())
}

/// Ends a job. One that is at work writes its last valid mesh, where it has one
#[utoipa::path(post, path = "/jobs/{id}/cancel", tag = "jobs", responses((status = 202, body = Job), (status = 404, body = Problem)))]
pub async fn cancel(Of(service): Of<Shared>, caller: Caller, Path(id): Path<String>) -> Result<Response, Problem> {
    service.catalogue.cancel(&caller.owner, &id).await?;
    let job = service.catalogue.job(&caller.owner, &id).await?.ok_or_else(|| Problem::missing("job"))?;
    match service.shop() {
        Some(shop) if !job.state.is_end() => shop.cancel(&id),
        _ => service.hub.tell(&id, |seen| seen.has_ended = true),
    }
    Ok((StatusCode::ACCEPTED, Json(job)).into_response())
}

/// What a job has printed: all of it when it has ended, else the last of it
#[utoipa::path(get, path = "/jobs/{id}/log", tag = "jobs", responses((status = 200, body = String), (status = 404, body = Problem)))]
pub async fn log(
    Of(service): Of<Shared>,
    caller: Caller,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let job = service.catalogue.job(&caller.owner, &id).await?.ok_or_else(|| Problem::missing("job"))?;
    if job.state.is_end() {
        return match find(&service, &caller, &id, LOG_NAME).await {
            Ok(found) => {
                contents(&service, &headers, (&found.id, LOG_NAME, u64::try_from(found.bytes).unwrap_or(0))).await
            }
            Err(_) => Ok(String::new().into_response()),
        };
    }
    let text = service.shop().and_then(|shop| shop.log(&job.id, MOST_LOG)).unwrap_or_default();
    Ok(text.into_response())
}

/// Lists what a job has made
#[utoipa::path(get, path = "/jobs/{id}/results", tag = "jobs", responses((status = 200, body = [Produced]), (status = 404, body = Problem)))]
pub async fn results(
    Of(service): Of<Shared>,
    caller: Caller,
    Path(id): Path<String>,
) -> Result<Json<Vec<Produced>>, Problem> {
    if service.catalogue.job(&caller.owner, &id).await?.is_none() {
        return Err(Problem::missing("job"));
    }
    Ok(Json(service.catalogue.results(&caller.owner, &id).await?))
}

async fn find(service: &Shared, caller: &Caller, id: &str, name: &str) -> Result<Produced, Problem> {
    let results = service.catalogue.results(&caller.owner, id).await?;
    results.into_iter().find(|result| result.name == name).ok_or_else(|| Problem::missing("result"))
}

/// Downloads what a job has made, or a range of it
#[utoipa::path(get, path = "/jobs/{id}/results/{name}", tag = "jobs", responses((status = 200), (status = 206), (status = 404, body = Problem)))]
pub async fn result(
    Of(service): Of<Shared>,
    caller: Caller,
    Path((id, name)): Path<(String, String)>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let found = find(&service, &caller, &id, &name).await?;
    contents(&service, &headers, (&found.id, &found.name, u64::try_from(found.bytes).unwrap_or(0))).await
}
