//! Uploads. Those that can be taken up again speak tus 1.0.0 (tus.io), with creation and termination.
use super::Shared;
use super::caller::Caller;
use super::error::Problem;
use super::files::Named;
use crate::serve::blobs::digest_of;
use crate::serve::catalogue::{File, Kind};
use crate::serve::ids::new_id;
use crate::serve::settings::Settings;
use axum::Json;
use axum::body::Body;
use axum::extract::rejection::QueryRejection;
use axum::extract::{Path, Query, State};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use futures_util::StreamExt;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::time::{Duration, SystemTime};
use tokio::fs;
use tokio::io::AsyncWriteExt;

/// How long a client may say nothing within an upload.
const SILENCE: Duration = Duration::from_secs(30);

/// After so long an upload that was not ended is removed.
const KEPT: Duration = Duration::from_secs(24 * 3600);

/// Most uploads of an owner that have not ended.
const MOST: usize = 100;

/// An upload that has begun, beside its bytes.
#[derive(Serialize, Deserialize)]
struct Begun {
    owner: String,
    name: String,
    kind: Kind,
    length: u64,
}

/// The folder of uploads, with the files of one.
fn files(settings: &Settings, id: &str) -> Result<[PathBuf; 2], Problem> {
    let is_id = id.len() == 32 && id.bytes().all(|b| b.is_ascii_hexdigit());
    if !is_id {
        return Err(Problem::missing("upload"));
    }
    let folder = settings.folder("uploads");
    Ok([folder.join(format!("{id}.part")), folder.join(format!("{id}.json"))])
}

/// Refuses what would be more than an owner may keep.
pub async fn check_room(service: &Shared, caller: &Caller, bytes: u64) -> Result<(), Problem> {
    let limits = service.settings.limits;
    if bytes > limits.file {
        let text = format!("a file may have {} bytes here", limits.file);
        return Err(Problem::new(StatusCode::PAYLOAD_TOO_LARGE, text));
    }
    let kept = service.catalogue.bytes_of(&caller.owner).await?;
    if kept.saturating_add(bytes) > limits.owner_bytes {
        let text = format!("you keep {kept} bytes, and may keep {}: remove files or jobs", limits.owner_bytes);
        return Err(Problem::new(StatusCode::INSUFFICIENT_STORAGE, text));
    }
    Ok(())
}

/// Appends a body to a file of which there are so many bytes, up to a length. Returns the bytes then; what came before an error stays.
async fn append_body(body: Body, to: &mut fs::File, from: u64, most: u64) -> Result<u64, Problem> {
    let (mut stream, mut length) = (body.into_data_stream(), from);
    let result = loop {
        match tokio::time::timeout(SILENCE, stream.next()).await {
            Err(_) => break Err(Problem::new(StatusCode::REQUEST_TIMEOUT, "nothing came for too long")),
            Ok(None) => break Ok(()),
            Ok(Some(Err(_))) => break Err(Problem::bad("the upload broke off")),
            Ok(Some(Ok(bytes))) => {
                if length + bytes.len() as u64 > most {
                    break Err(Problem::new(StatusCode::PAYLOAD_TOO_LARGE, format!("more than {most} bytes")));
                }
                to.write_all(&bytes).await?;
                length += bytes.len() as u64;
            }
        }
    };
    to.flush().await?;
    result.map(|()| length)
}

/// Takes the file of a body in.
pub async fn receive(
    service: &Shared,
    caller: &Caller,
    body: Body,
    (name, kind): (&str, Kind),
) -> Result<File, Problem> {
    check_room(service, caller, 0).await?;
    let [path, _] = files(&service.settings, &new_id()?)?;
    let mut file = fs::File::create(&path).await?;
    let most = service.settings.limits.file;
    let length = match append_body(body, &mut file, 0, most).await {
        Ok(length) => length,
        Err(problem) => {
            drop(fs::remove_file(&path).await);
            return Err(problem);
        }
    };
    drop(file);
    keep(service, caller, &path, (name, kind, length)).await
}

/// A file that is complete becomes the owner's.
async fn keep(
    service: &Shared,
    caller: &Caller,
    path: &std::path::Path,
    (name, kind, length): (&str, Kind, u64),
) -> Result<File, Problem> {
    if let Err(problem) = check_room(service, caller, length).await {
        drop(fs::remove_file(path).await);
        return Err(problem);
    }
    let of = path.to_owned();
    let id = tokio::task::spawn_blocking(move || digest_of(&of)).await.map_err(Problem::ours)??;
    // Known first, so that nobody removes the contents in between.
    let file = service.catalogue.add_file(&caller.owner, (&id, length), kind, name).await?;
    service.blobs.put(path, &id).await?;
    Ok(file)
}

/// The length of an upload, as tus has it.
fn number(headers: &HeaderMap, name: &str) -> Result<u64, Problem> {
    let value = headers.get(name).and_then(|value| value.to_str().ok()?.parse().ok());
    value.ok_or_else(|| Problem::bad(format!("{name}: a number is wanted")))
}

fn tus(status: StatusCode, more: &[(&'static str, String)]) -> Response {
    let mut response = status.into_response();
    response.headers_mut().insert("Tus-Resumable", HeaderValue::from_static("1.0.0"));
    for (name, value) in more {
        if let Ok(value) = HeaderValue::from_str(value) {
            response.headers_mut().insert(*name, value);
        }
    }
    response
}

async fn begun(service: &Shared, caller: &Caller, id: &str) -> Result<(Begun, [PathBuf; 2], u64), Problem> {
    let paths = files(&service.settings, id)?;
    let Ok(text) = fs::read(&paths[1]).await else { return Err(Problem::missing("upload")) };
    let known: Begun = serde_json::from_slice(&text).map_err(Problem::ours)?;
    if known.owner != caller.owner {
        return Err(Problem::missing("upload"));
    }
    let there = fs::metadata(&paths[0]).await?.len();
    Ok((known, paths, there))
}

/// Begins an upload of `Upload-Length` bytes that can be taken up again (tus 1.0.0)
#[utoipa::path(
    post, path = "/uploads", tag = "files",
    params(Named, ("Upload-Length" = u64, Header, description = "Bytes of the file")),
    responses((status = 201, description = "`Location` says where to"), (status = 413, body = Problem))
)]
pub async fn begin(
    State(service): State<Shared>,
    caller: Caller,
    named: Result<Query<Named>, QueryRejection>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let (name, kind) = named?.0.checked()?;
    let length = number(&headers, "Upload-Length")?;
    check_room(&service, &caller, length).await?;
    let mut others = fs::read_dir(service.settings.folder("uploads")).await?;
    let mut count = 0;
    while let Some(entry) = others.next_entry().await? {
        let is_one = entry.path().extension().is_some_and(|ending| ending == "json");
        let text = if is_one { fs::read(entry.path()).await.unwrap_or_default() } else { Vec::new() };
        count += usize::from(serde_json::from_slice::<Begun>(&text).is_ok_and(|begun| begun.owner == caller.owner));
    }
    if count >= MOST {
        let text = format!("{MOST} uploads have begun and not ended: end or remove some");
        return Err(Problem::new(StatusCode::TOO_MANY_REQUESTS, text));
    }
    let id = new_id()?;
    let [part, json] = files(&service.settings, &id)?;
    fs::File::create(&part).await?;
    let begun = Begun { owner: caller.owner, name, kind, length };
    fs::write(&json, serde_json::to_vec(&begun).map_err(Problem::ours)?).await?;
    Ok(tus(StatusCode::CREATED, &[("Location", format!("/v1/uploads/{id}"))]))
}

/// How far an upload is: `Upload-Offset`
#[utoipa::path(head, path = "/uploads/{id}", tag = "files", responses((status = 200), (status = 404)))]
pub async fn offset(
    State(service): State<Shared>,
    caller: Caller,
    Path(id): Path<String>,
) -> Result<Response, Problem> {
    let (begun, _, there) = begun(&service, &caller, &id).await?;
    Ok(tus(StatusCode::OK, &[("Upload-Offset", there.to_string()), ("Upload-Length", begun.length.to_string())]))
}

/// Appends to an upload, from `Upload-Offset` on. The last byte ends it: the answer is the file then
#[utoipa::path(
    patch, path = "/uploads/{id}", tag = "files",
    params(("Upload-Offset" = u64, Header, description = "Bytes that are there")),
    request_body(content = Vec<u8>, content_type = "application/offset+octet-stream"),
    responses((status = 200, body = File), (status = 204), (status = 409, body = Problem))
)]
pub async fn append(
    State(service): State<Shared>,
    caller: Caller,
    Path(id): Path<String>,
    headers: HeaderMap,
    body: Body,
) -> Result<Response, Problem> {
    let (begun, [part, json], there) = begun(&service, &caller, &id).await?;
    let from = number(&headers, "Upload-Offset")?;
    if from != there {
        return Err(Problem::new(StatusCode::CONFLICT, format!("{there} bytes are there")));
    }
    let mut file = fs::OpenOptions::new().append(true).open(&part).await?;
    // One writer at a time.
    let (held, file_again) = (file.try_clone().await?.into_std().await, &mut file);
    if held.try_lock().is_err() {
        return Err(Problem::new(StatusCode::CONFLICT, "this upload is being written to"));
    }
    let length = append_body(body, file_again, there, begun.length).await?;
    if length < begun.length {
        return Ok(tus(StatusCode::NO_CONTENT, &[("Upload-Offset", length.to_string())]));
    }
    drop(held);
    drop(file);
    let kept = keep(&service, &caller, &part, (&begun.name, begun.kind, length)).await?;
    drop(fs::remove_file(&json).await);
    let mut response = (StatusCode::OK, Json(kept)).into_response();
    response.headers_mut().extend(tus(StatusCode::OK, &[("Upload-Offset", length.to_string())]).headers().clone());
    Ok(response)
}

/// Gives an upload up
#[utoipa::path(delete, path = "/uploads/{id}", tag = "files", responses((status = 204), (status = 404, body = Problem)))]
pub async fn give_up(
    State(service): State<Shared>,
    caller: Caller,
    Path(id): Path<String>,
) -> Result<Response, Problem> {
    let (_, paths, _) = begun(&service, &caller, &id).await?;
    for path in paths {
        drop(fs::remove_file(path).await);
    }
    Ok(tus(StatusCode::NO_CONTENT, &[]))
}

/// Removes uploads that were given up without a word.
pub async fn sweep(settings: &Settings) {
    let Ok(mut entries) = fs::read_dir(settings.folder("uploads")).await else { return };
    while let Ok(Some(entry)) = entries.next_entry().await {
        let changed = entry.metadata().await.and_then(|of| of.modified());
        let age = changed.map(|at| SystemTime::now().duration_since(at).unwrap_or_default());
        if age.is_ok_and(|age| age > KEPT) {
            drop(fs::remove_file(entry.path()).await);
        }
    }
}
