//! The workbench: one page, with all that it needs inside of the program.
use super::Shared;
use axum::Router;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use axum::routing::get;

/// Its parts.
const PARTS: [(&str, &str, &str); 1] = [("/", "text/html; charset=utf-8", include_str!("../page/workbench.html"))];

/// What the page may do: ask this service alone.
const POLICY: &str = "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; frame-src 'self' blob:; object-src 'none'; base-uri 'none'";

fn part(kind: &'static str, text: &'static str) -> Response {
    ([(header::CONTENT_TYPE, kind), (header::CONTENT_SECURITY_POLICY, POLICY)], text).into_response()
}

/// Serves it.
pub fn router() -> Router<Shared> {
    PARTS.into_iter().fold(Router::new(), |router, (path, kind, text)| {
        router.route(path, get(move || async move { part(kind, text) }))
    })
}
