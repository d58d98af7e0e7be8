//! The service itself: whether it is well, what it can do, who asks.
use super::Shared;
use super::caller::{COOKIE, Caller};
use super::error::Problem;
use crate::serve::ids::now;
use axum::extract::State;
use axum::extract::rejection::JsonRejection;
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::{Json, Router};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use utoipa::ToSchema;
use utoipa::openapi::OpenApi;
use utoipa_swagger_ui::SwaggerUi;

/// What is outside of /v1, and the description.
pub fn router(description: OpenApi) -> Router<Shared> {
    let page = SwaggerUi::new("/v1/docs").url("/v1/openapi.json", description);
    Router::new()
        .route("/healthz", get(|| async { "well\n" }))
        .route("/readyz", get(ready))
        .route("/metrics", get(metrics))
        .merge(page)
}

async fn ready(State(service): State<Shared>) -> Response {
    match service.catalogue.answers().await {
        Ok(()) if service.shop().is_some() => "ready\n".into_response(),
        _ => (StatusCode::SERVICE_UNAVAILABLE, "not ready\n").into_response(),
    }
}

async fn metrics(State(service): State<Shared>) -> Result<Response, Problem> {
    let text = service.figures.text(&service).await?;
    let kind = "application/openmetrics-text; version=1.0.0; charset=utf-8";
    Ok(([(header::CONTENT_TYPE, HeaderValue::from_static(kind))], text).into_response())
}

/// Who asks, and what they may.
#[derive(Serialize, ToSchema)]
pub struct Me {
    /// Whose things are seen.
    owner: String,
    /// What may be done: read, write, metrics.
    #[schema(value_type = Vec<String>)]
    scopes: Vec<&'static str>,
    /// Bytes that are kept.
    bytes: u64,
    /// Bytes that may be kept.
    most_bytes: u64,
    /// Vertices that a job may make.
    most_vertices: u64,
    /// The solvers that loops may use besides the analytic one, as `[solver.named]`.
    solvers: Vec<String>,
    /// The version of the program.
    #[schema(value_type = String)]
    version: &'static str,
    /// The time of the service, milliseconds since 1970.
    now: i64,
}

/// Tells who asks, and what they may
#[utoipa::path(get, path = "/me", tag = "service", responses((status = 200, body = Me), (status = 401, body = Problem)))]
pub async fn me(State(service): State<Shared>, caller: Caller) -> Result<Json<Me>, Problem> {
    let bytes = service.catalogue.bytes_of(&caller.owner).await?;
    let limits = service.settings.limits;
    let scopes = caller.scopes();
    let solvers = service.settings.solvers.names.clone();
    let version = env!("CARGO_PKG_VERSION");
    let (most_bytes, most_vertices) = (limits.owner_bytes, limits.vertices);
    Ok(Json(Me { owner: caller.owner, scopes, bytes, most_bytes, most_vertices, solvers, version, now: now() }))
}

/// Lists the commands that a job may run, with their arguments
#[utoipa::path(get, path = "/commands", tag = "jobs", responses((status = 200, body = Object)))]
pub async fn commands(State(service): State<Shared>) -> Json<Value> {
    Json(service.commands.described())
}

/// A token for the browser.
#[derive(Deserialize, ToSchema)]
pub struct Session {
    token: String,
}

/// Lets the browser keep a token as a cookie that no script can read
#[utoipa::path(post, path = "/session", tag = "service", request_body = Session, responses((status = 200, body = Object), (status = 401, body = Problem)))]
pub async fn begin_session(
    State(service): State<Shared>,
    headers: HeaderMap,
    asked: Result<Json<Session>, JsonRejection>,
) -> Result<Response, Problem> {
    let Json(Session { token }) = asked?;
    let Some(known) = service.catalogue.token(&token).await? else {
        return Err(Problem::new(StatusCode::UNAUTHORIZED, "this token is not good, or not any more"));
    };
    let by_proxy = headers.get("x-forwarded-proto").is_some_and(|value| value == "https");
    let secure = if service.settings.tls.is_some() || by_proxy { "; Secure" } else { "" };
    let cookie = format!("{COOKIE}={token}; HttpOnly; SameSite=Strict; Path=/{secure}");
    Ok(([(header::SET_COOKIE, cookie)], Json(json!({ "owner": known.owner }))).into_response())
}

/// Ends the session of the browser
#[utoipa::path(delete, path = "/session", tag = "service", responses((status = 204)))]
pub async fn end_session() -> Response {
    let cookie = format!("{COOKIE}=; HttpOnly; SameSite=Strict; Path=/; Max-Age=0");
    (StatusCode::NO_CONTENT, [(header::SET_COOKIE, cookie)]).into_response()
}
