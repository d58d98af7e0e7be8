//! Who asks. Without a token only programs of the same machine, where the operator has it so; else the owner of the token.
use super::error::Problem;
use super::{Service, Shared};
use crate::serve::catalogue::Scope;
use axum::extract::{FromRequestParts, Request, State};
use axum::http::request::Parts;
use axum::http::{HeaderMap, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// The owner of what is asked for without a token.
pub const LOCAL: &str = "local";

/// The cookie of a session in the browser.
pub const COOKIE: &str = "geo-adapt-token";

/// For a while an owner may ask so many times as often.
const BURST: f64 = 10.0;

/// Most owners and addresses that are counted.
const MOST: usize = 10_000;

/// Who asks, and what they may.
#[derive(Clone, Debug)]
pub struct Caller {
    /// Whose things they see.
    pub owner: String,
    scopes: Vec<Scope>,
}

impl Caller {
    /// Whether they may do something.
    pub fn may(&self, scope: Scope) -> bool {
        self.scopes.contains(&scope)
    }

    /// What they may do.
    pub fn scopes(&self) -> Vec<&'static str> {
        self.scopes.iter().map(|scope| scope.name()).collect()
    }
}

/// How often who has asked.
pub struct Callers {
    rate: f64,
    /// What is left, and when that was.
    left: Mutex<HashMap<String, (f64, Instant)>>,
}

impl Callers {
    /// So many requests a second.
    pub fn new(rate: u32) -> Self {
        Self { rate: f64::from(rate), left: Mutex::default() }
    }

    /// Whether one more may be (a token bucket).
    fn let_in(&self, who: &str) -> bool {
        let mut all = self.left.lock().unwrap_or_else(PoisonError::into_inner);
        let (now, most) = (Instant::now(), BURST * self.rate);
        if all.len() > MOST {
            all.retain(|_, (_, since)| since.elapsed().as_secs_f64() < BURST);
        }
        let (left, since) = all.entry(who.to_owned()).or_insert((most, now));
        *left = (*left + self.rate * since.elapsed().as_secs_f64()).min(most);
        *since = now;
        let is_in = *left >= 1.0;
        *left -= f64::from(u8::from(is_in));
        is_in
    }
}

/// The token of a request: a bearer, or the cookie of a session.
pub fn secret(headers: &HeaderMap) -> Option<&str> {
    let bearer = headers.get(header::AUTHORIZATION).and_then(|value| value.to_str().ok());
    if let Some(text) = bearer {
        return text.strip_prefix("Bearer ").or_else(|| text.strip_prefix("bearer "));
    }
    let cookies = headers.get(header::COOKIE)?.to_str().ok()?;
    cookies.split(';').find_map(|cookie| cookie.trim().strip_prefix(COOKIE)?.strip_prefix('='))
}

/// Whether a page of another site may be behind a request: no token protects what is open, so it must name this machine.
fn is_ours(headers: &HeaderMap) -> bool {
    let host = |value: &str| {
        let name = value.split("://").last().unwrap_or_default();
        let name = name
            .rsplit_once(':')
            .filter(|(_, port)| port.bytes().all(|b| b.is_ascii_digit()))
            .map_or(name, |(name, _)| name);
        ["localhost", "127.0.0.1", "[::1]"].contains(&name)
    };
    let named = |name: header::HeaderName| headers.get(name).map(|value| value.to_str().is_ok_and(host));
    named(header::HOST) != Some(false) && named(header::ORIGIN) != Some(false)
}

/// Who asks.
async fn caller(service: &Service, headers: &HeaderMap) -> Result<Caller, Problem> {
    if let Some(secret) = secret(headers) {
        let token = service.catalogue.token(secret).await?;
        let token =
            token.ok_or_else(|| Problem::new(StatusCode::UNAUTHORIZED, "this token is not good, or not any more"))?;
        return Ok(Caller { owner: token.owner, scopes: token.scopes });
    }
    if !service.settings.is_open {
        let text =
            "give a token, as `Authorization: Bearer …`; the operator makes one with `geo-adapt serve token add`";
        return Err(Problem::new(StatusCode::UNAUTHORIZED, text));
    }
    if !is_ours(headers) {
        return Err(Problem::new(StatusCode::FORBIDDEN, "without a token only this machine may ask, as localhost"));
    }
    Ok(Caller { owner: LOCAL.into(), scopes: Scope::ALL.to_vec() })
}

/// What everybody may have: whether the service is well, the page, and how to begin a session.
fn is_for_all(method: &Method, path: &str) -> bool {
    let is_session = path == "/v1/session" && method == Method::POST;
    is_session
        || ["/healthz", "/readyz", "/v1/openapi.json"].contains(&path)
        || !path.starts_with("/v1/") && path != "/metrics"
}

/// Lets a request in, or not.
pub async fn guard(State(service): State<Shared>, mut request: Request, next: Next) -> Response {
    let path = request.uri().path().to_owned();
    if is_for_all(request.method(), &path) {
        return next.run(request).await;
    }
    let caller = match caller(&service, request.headers()).await {
        Ok(caller) => caller,
        Err(problem) => return problem.into_response(),
    };
    let wanted = match *request.method() {
        _ if path == "/metrics" => Scope::Metrics,
        Method::GET | Method::HEAD | Method::OPTIONS => Scope::Read,
        _ => Scope::Write,
    };
    if !caller.may(wanted) {
        let text = format!("this token is not for this: it lacks the scope {}", wanted.name());
        return Problem::new(StatusCode::FORBIDDEN, text).into_response();
    }
    if !service.callers.let_in(&caller.owner) {
        let mut response =
            Problem::new(StatusCode::TOO_MANY_REQUESTS, "too many requests: ask again in a second").into_response();
        response.headers_mut().insert(header::RETRY_AFTER, header::HeaderValue::from_static("1"));
        return response;
    }
    if wanted == Scope::Write {
        tracing::info!(target: "audit", owner = caller.owner, method = %request.method(), path, "asked");
    }
    request.extensions_mut().insert(caller);
    next.run(request).await
}

impl<S: Send + Sync> FromRequestParts<S> for Caller {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Problem> {
        parts.extensions.get::<Self>().cloned().ok_or_else(|| Problem::ours("a route without its guard"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_asks_too_often_waits() {
        let callers = Callers::new(2);
        assert_eq!((0..30).filter(|_| callers.let_in("a")).count(), 20);
        assert!(callers.let_in("b"));
    }

    #[test]
    fn a_page_of_another_site_is_told_apart() {
        let of = |host: &str, origin: Option<&str>| {
            let mut headers = HeaderMap::new();
            headers.insert(header::HOST, host.parse().unwrap());
            origin.map(|origin| headers.insert(header::ORIGIN, origin.parse().unwrap()));
            is_ours(&headers)
        };
        assert!(of("127.0.0.1:7878", None) && of("localhost", Some("http://localhost:7878")) && of("[::1]:80", None));
        assert!(!of("evil.example", None) && !of("localhost:7878", Some("https://evil.example")));
        assert!(!of("localhost.evil.example:7878", None) && !of("127.0.0.1:7878", Some("null")));
    }
}
