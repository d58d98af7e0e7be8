//! Models, meshes, fields: contents that an owner has uploaded, each once.
use super::Shared;
use super::caller::Caller;
use super::download::contents;
use super::error::Problem;
use super::uploads::receive;
use crate::serve::catalogue::{File, Kind};
use crate::serve::ids::is_file_name;
use axum::Json;
use axum::body::Body;
use axum::extract::rejection::QueryRejection;
use axum::extract::{Path, Query, State};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use utoipa::IntoParams;

/// Most that a list has.
const MOST: i64 = 1000;

/// What an uploaded file is called.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
pub struct Named {
    /// The name, with the ending that tells its format.
    pub name: String,
    /// What it is for [default: as the ending tells].
    pub kind: Option<Kind>,
}

impl Named {
    /// The name, if it may be one.
    pub fn checked(self) -> Result<(String, Kind), Problem> {
        if !is_file_name(&self.name) {
            return Err(Problem::bad("name: give a plain name, of letters, digits and . _ - + ( ) = ,"));
        }
        let kind = self.kind.unwrap_or_else(|| Kind::of_file(&self.name));
        Ok((self.name, kind))
    }
}

/// Which files to list.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
pub struct Listed {
    /// Of which kind.
    kind: Option<Kind>,
}

/// Lists the uploaded files, the newest first
#[utoipa::path(get, path = "/files", tag = "files", params(Listed), responses((status = 200, body = [File])))]
pub async fn list(
    State(service): State<Shared>,
    caller: Caller,
    asked: Result<Query<Listed>, QueryRejection>,
) -> Result<Json<Vec<File>>, Problem> {
    let Query(asked) = asked?;
    Ok(Json(service.catalogue.files(&caller.owner, asked.kind, MOST).await?))
}

/// Lists the CAD models
#[utoipa::path(get, path = "/models", tag = "files", responses((status = 200, body = [File])))]
pub async fn models(State(service): State<Shared>, caller: Caller) -> Result<Json<Vec<File>>, Problem> {
    Ok(Json(service.catalogue.files(&caller.owner, Some(Kind::Model), MOST).await?))
}

/// Lists the meshes
#[utoipa::path(get, path = "/meshes", tag = "files", responses((status = 200, body = [File])))]
pub async fn meshes(State(service): State<Shared>, caller: Caller) -> Result<Json<Vec<File>>, Problem> {
    Ok(Json(service.catalogue.files(&caller.owner, Some(Kind::Mesh), MOST).await?))
}

/// Lists the fields
#[utoipa::path(get, path = "/fields", tag = "files", responses((status = 200, body = [File])))]
pub async fn fields(State(service): State<Shared>, caller: Caller) -> Result<Json<Vec<File>>, Problem> {
    Ok(Json(service.catalogue.files(&caller.owner, Some(Kind::Field), MOST).await?))
}

/// Uploads a file in one go. Large ones may rather go by /uploads, which can be taken up again
#[utoipa::path(
    post, path = "/files", tag = "files", params(Named),
    request_body(content = Vec<u8>, content_type = "application/octet-stream"),
    responses((status = 201, body = File), (status = 413, body = Problem))
)]
pub async fn add(
    State(service): State<Shared>,
    caller: Caller,
    named: Result<Query<Named>, QueryRejection>,
    body: Body,
) -> Result<(StatusCode, Json<File>), Problem> {
    let (name, kind) = named?.0.checked()?;
    let file = receive(&service, &caller, body, (&name, kind)).await?;
    Ok((StatusCode::CREATED, Json(file)))
}

/// Looks up an uploaded file
#[utoipa::path(get, path = "/files/{id}", tag = "files", responses((status = 200, body = File), (status = 404, body = Problem)))]
pub async fn get(State(service): State<Shared>, caller: Caller, Path(id): Path<String>) -> Result<Json<File>, Problem> {
    let file = service.catalogue.file(&caller.owner, &id).await?;
    file.map(Json).ok_or_else(|| Problem::missing("file"))
}

/// Downloads an uploaded file, or a range of it
#[utoipa::path(get, path = "/files/{id}/content", tag = "files", responses((status = 200), (status = 206), (status = 404, body = Problem)))]
pub async fn content(
    State(service): State<Shared>,
    caller: Caller,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let file = service.catalogue.file(&caller.owner, &id).await?.ok_or_else(|| Problem::missing("file"))?;
    contents(&service, &headers, (&file.id, &file.name, u64::try_from(file.bytes).unwrap_or(0))).await
}

/// Forgets an uploaded file
#[utoipa::path(delete, path = "/files/{id}", tag = "files", responses((status = 204), (status = 404, body = Problem)))]
pub async fn remove(
    State(service): State<Shared>,
    caller: Caller,
    Path(id): Path<String>,
) -> Result<Response, Problem> {
    if !service.catalogue.remove_file(&caller.owner, &id).await? {
        return Err(Problem::missing("file"));
    }
    service.forget(&id).await;
    Ok(StatusCode::NO_CONTENT.into_response())
}
