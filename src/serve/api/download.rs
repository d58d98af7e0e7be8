//! Contents on their way to a client, whole or a range of them (RFC 9110, 14).
use super::Service;
use super::error::Problem;
use axum::body::Body;
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};

/// The one range that is asked for, if it can be had. Several ranges may be answered by the whole.
fn range(headers: &HeaderMap, length: u64) -> Result<Option<std::ops::Range<u64>>, ()> {
    let Some(text) = headers.get(header::RANGE).and_then(|value| value.to_str().ok()) else { return Ok(None) };
    let Some(text) = text.strip_prefix("bytes=").filter(|text| !text.contains(',')) else { return Ok(None) };
    let Some((from, to)) = text.split_once('-') else { return Ok(None) };
    let found = match (from.trim().parse::<u64>(), to.trim().parse::<u64>()) {
        (Ok(from), Ok(to)) if from <= to => from..to.saturating_add(1).min(length),
        (Ok(from), Err(_)) if to.trim().is_empty() => from..length,
        (Err(_), Ok(last)) if from.trim().is_empty() => length.saturating_sub(last)..length,
        _ => return Ok(None),
    };
    if found.start < found.end { Ok(Some(found)) } else { Err(()) }
}

/// The type of a file: what browsers show in safety, else bytes.
fn kind(name: &str) -> &'static str {
    match name.rsplit_once('.').map(|(_, ending)| ending) {
        Some("json") => "application/json",
        Some("txt") => "text/plain; charset=utf-8",
        Some("png") => "image/png",
        Some("html") => "text/html; charset=utf-8",
        _ => "application/octet-stream",
    }
}

/// Contents under a name. A page is a client's own work: it has no rights here.
///
/// # Errors
/// When they are not there.
pub async fn contents(
    service: &Service,
    headers: &HeaderMap,
    (id, name, length): (&str, &str, u64),
) -> Result<Response, Problem> {
    let tag = format!("\"{id}\"");
    if headers.get(header::IF_NONE_MATCH).is_some_and(|value| value.as_bytes() == tag.as_bytes()) {
        return Ok(StatusCode::NOT_MODIFIED.into_response());
    }
    let is_current = headers.get(header::IF_RANGE).is_none_or(|value| value.as_bytes() == tag.as_bytes());
    let asked = if is_current { range(headers, length) } else { Ok(None) };
    let Ok(asked) = asked else {
        let mut response =
            Problem::new(StatusCode::RANGE_NOT_SATISFIABLE, format!("it has {length} bytes")).into_response();
        set(&mut response, header::CONTENT_RANGE, &format!("bytes */{length}"));
        return Ok(response);
    };
    let whole = asked.clone().unwrap_or(0..length);
    let stream = service.blobs.read(id, whole.clone()).await?;
    let mut response = Body::from_stream(stream).into_response();
    if asked.is_some() {
        *response.status_mut() = StatusCode::PARTIAL_CONTENT;
        set(&mut response, header::CONTENT_RANGE, &format!("bytes {}-{}/{length}", whole.start, whole.end - 1));
    }
    set(&mut response, header::CONTENT_LENGTH, &(whole.end - whole.start).to_string());
    set(&mut response, header::ACCEPT_RANGES, "bytes");
    set(&mut response, header::ETAG, &tag);
    set(&mut response, header::CACHE_CONTROL, "private, max-age=31536000, immutable");
    let kind = kind(name);
    set(&mut response, header::CONTENT_TYPE, kind);
    if kind.starts_with("text/html") {
        set(
            &mut response,
            header::CONTENT_SECURITY_POLICY,
            "sandbox allow-scripts allow-downloads; frame-ancestors 'self'",
        );
    }
    let plain: String = name.chars().map(|c| if c.is_ascii() && c != '"' && c != '\\' { c } else { '_' }).collect();
    let shown = if kind == "application/octet-stream" { "attachment" } else { "inline" };
    set(&mut response, header::CONTENT_DISPOSITION, &format!("{shown}; filename=\"{plain}\""));
    Ok(response)
}

fn set(response: &mut Response, name: header::HeaderName, value: &str) {
    if let Ok(value) = HeaderValue::from_str(value) {
        response.headers_mut().insert(name, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges() {
        let of = |text: &str| {
            let mut headers = HeaderMap::new();
            headers.insert(header::RANGE, text.parse().unwrap());
            range(&headers, 100)
        };
        for (text, expected) in [
            ("bytes=0-9", Ok(Some(0..10))),
            ("bytes=90-", Ok(Some(90..100))),
            ("bytes=-10", Ok(Some(90..100))),
            ("bytes=-1000", Ok(Some(0..100))),
            ("bytes=50-1000", Ok(Some(50..100))),
            ("bytes=100-", Err(())),
            ("bytes=-0", Err(())),
            ("bytes=9-0", Ok(None)),
            ("bytes=0-1,5-6", Ok(None)),
            ("pages=1-2", Ok(None)),
            ("bytes=99999999999999999999-", Ok(None)),
        ] {
            assert_eq!(of(text), expected, "{text}");
        }
    }
}
