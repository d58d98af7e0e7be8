//! Who may what: tokens, owners, pages of other sites.
use crate::common::program;
use crate::service::{Service, cube};
use serde_json::json;
use std::path::Path;

/// Makes a token.
pub fn token(data: &Path, owner: &str, scopes: &str) -> String {
    let mut command = program();
    command.args(["serve", "token", "add", owner, "--scopes", scopes, "--data"]).arg(data);
    let made = command.output().unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    format!("Authorization: Bearer {}", String::from_utf8(made.stdout).unwrap().trim())
}

#[test]
fn nobody_sees_what_is_anothers() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path();
    let service = Service::start(data, &["--tokens-only"]);
    let (ann, bob) = (token(data, "ann", "read,write"), token(data, "bob", "read,write"));
    let json_kind = "Content-Type: application/json";
    let mesh = service.ask("POST", "/v1/files?name=a.meshb", &[&ann], &cube(2)).json();
    let id = mesh["id"].as_str().unwrap();
    let request = json!({ "command": "inspect", "arguments": ["a.meshb"], "files": { "a.meshb": id } }).to_string();
    let job = service.ask("POST", "/v1/jobs", &[&ann, json_kind], request.as_bytes()).json();
    let job = job["id"].as_str().unwrap();
    let begun = service.ask("POST", "/v1/uploads?name=b.meshb", &[&ann, "Upload-Length: 10"], b"");
    let upload = begun.header("location").unwrap();
    // Each route, by another one and by nobody.
    let routes = [
        ("GET", format!("/v1/files/{id}")),
        ("GET", format!("/v1/files/{id}/content")),
        ("DELETE", format!("/v1/files/{id}")),
        ("GET", format!("/v1/jobs/{job}")),
        ("GET", format!("/v1/jobs/{job}/log")),
        ("GET", format!("/v1/jobs/{job}/events")),
        ("GET", format!("/v1/jobs/{job}/results")),
        ("GET", format!("/v1/jobs/{job}/results/printed.txt")),
        ("POST", format!("/v1/jobs/{job}/cancel")),
        ("DELETE", format!("/v1/jobs/{job}")),
        ("HEAD", upload.to_owned()),
        ("PATCH", upload.to_owned()),
        ("DELETE", upload.to_owned()),
    ];
    for (method, path) in &routes {
        let by = |headers: &[&str]| service.ask(method, path, headers, b"").status;
        assert_eq!(by(&[&bob, "Upload-Offset: 0"]), 404, "{method} {path}");
        assert_eq!(by(&["Upload-Offset: 0"]), 401, "{method} {path}");
        assert_eq!(by(&["Authorization: Bearer ga_0000", "Upload-Offset: 0"]), 401, "{method} {path}");
    }
    // A job of another one on contents that are not his.
    assert_eq!(service.ask("POST", "/v1/jobs", &[&bob, json_kind], request.as_bytes()).status, 400);
    for list in ["files", "models", "meshes", "fields", "jobs"] {
        assert_eq!(service.ask("GET", &format!("/v1/{list}"), &[&bob], b"").json(), json!([]), "{list}");
    }
    // All of it is still there.
    assert!(service.ask("GET", &format!("/v1/files/{id}/content"), &[&ann], b"").body == cube(2));
    assert_eq!(service.ask("HEAD", upload, &[&ann], b"").status, 200);
}

#[test]
fn tokens_do_what_they_are_for_until_they_are_revoked() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path();
    let service = Service::start(data, &["--tokens-only"]);
    let (reads, writes, counts) =
        (token(data, "ann", "read"), token(data, "ann", "read,write"), token(data, "ops", "metrics"));
    let upload = |token: &str| service.ask("POST", "/v1/files?name=a.step", &[token], b"x").status;
    assert_eq!((upload(&reads), upload(&writes), upload(&counts)), (403, 201, 403));
    let looks = |token: &str, path: &str| service.ask("GET", path, &[token], b"").status;
    assert_eq!((looks(&reads, "/v1/files"), looks(&counts, "/v1/files")), (200, 403));
    assert_eq!((looks(&reads, "/metrics"), looks(&counts, "/metrics")), (403, 200));
    // The browser keeps it as a cookie.
    let secret = writes.rsplit(' ').next().unwrap();
    let session = json!({ "token": secret }).to_string();
    let begun = service.ask("POST", "/v1/session", &["Content-Type: application/json"], session.as_bytes());
    let cookie = begun.header("set-cookie").unwrap();
    assert!(cookie.contains("HttpOnly") && cookie.contains("SameSite=Strict"), "{cookie}");
    let cookie = format!("Cookie: {}", cookie.split(';').next().unwrap());
    assert_eq!(looks(&cookie, "/v1/me"), 200);
    let mut list = program();
    let listed = list.args(["serve", "token", "list", "--data"]).arg(data).output().unwrap().stdout;
    let listed = String::from_utf8(listed).unwrap();
    assert!(!listed.contains(secret) && listed.lines().count() == 4, "{listed}");
    let id = listed.lines().find(|line| line.contains("read,write")).unwrap().split(' ').next().unwrap();
    assert!(program().args(["serve", "token", "revoke", id, "--data"]).arg(data).status().unwrap().success());
    assert_eq!((looks(&writes, "/v1/me"), looks(&cookie, "/v1/me"), looks(&reads, "/v1/me")), (401, 401, 200));
}

#[test]
fn pages_of_other_sites_get_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &[]);
    let of = |headers: &[&str]| service.ask("GET", "/v1/files", headers, b"").status;
    assert_eq!(of(&[]), 200);
    assert_eq!(of(&["Origin: https://evil.example"]), 403);
    // A name that leads here (DNS rebinding).
    let request = b"GET /v1/files HTTP/1.1\r\nHost: evil.example\r\nConnection: close\r\n\r\n";
    assert_eq!(service.send(request).status, 403);
}

#[test]
fn what_everybody_may_see() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &["--tokens-only"]);
    for path in ["/healthz", "/readyz", "/v1/openapi.json", "/"] {
        assert_eq!(service.get(path).status, 200, "{path}");
    }
    let described = service.get("/v1/openapi.json").json();
    assert_eq!(described["openapi"].as_str().map(|version| &version[..3]), Some("3.1"));
    assert!(described["paths"]["/v1/jobs/{id}/events"]["get"].is_object());
    for path in ["/v1/me", "/v1/docs/", "/metrics", "/v1/nothing"] {
        assert_eq!(service.get(path).status, 401, "{path}");
    }
}

#[test]
fn who_asks_too_often_is_told_to_wait() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &["--rate", "2"]);
    let found: Vec<u16> = (0..40).map(|_| service.get("/v1/me").status).collect();
    assert!(found[..15].iter().all(|&status| status == 200) && found.contains(&429), "{found:?}");
}
