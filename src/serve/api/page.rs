//! The workbench: one page, with all that it needs inside of the program.
use super::Shared;
use axum::Router;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use axum::routing::get;

/// The page itself.
const PAGE: &str = include_str!("../page/workbench.html");

macro_rules! parts {
    ($($name:literal),* $(,)?) => { [$((concat!("/workbench/", $name), include_str!(concat!("../page/", $name)))),*] };
}

/// What it loads.
const PARTS: [(&str, &str); 19] = parts![
    "adapt.js",
    "bootstrap.js",
    "catalogue.js",
    "downloads.js",
    "elements.js",
    "figures.js",
    "icon.svg",
    "pane.js",
    "queue.js",
    "service.js",
    "session.js",
    "shelf.js",
    "task.js",
    "things.js",
    "upload.js",
    "views.css",
    "words.js",
    "workbench.css",
    "workbench.js",
];

/// What the page may do: ask this service alone, with no script but its own files.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; frame-src 'self'; base-uri 'none'; \
form-action 'none'; frame-ancestors 'none'";

/// The type of a part, as its ending tells.
fn kind(path: &str) -> &'static str {
    match path.rsplit_once('.').map(|(_, ending)| ending) {
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("svg") => "image/svg+xml",
        _ => "text/html; charset=utf-8",
    }
}

fn part(path: &str, text: &'static str) -> Response {
    ([(header::CONTENT_TYPE, kind(path)), (header::CONTENT_SECURITY_POLICY, POLICY)], text).into_response()
}

/// Serves it.
pub fn router() -> Router<Shared> {
    [("/", PAGE)]
        .into_iter()
        .chain(PARTS)
        .fold(Router::new(), |router, (path, text)| router.route(path, get(move || async move { part(path, text) })))
}
