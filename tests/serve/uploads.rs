//! Uploads, whole and in pieces; downloads, whole and in ranges.
use crate::service::Service;

#[test]
fn the_same_contents_are_one_file() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &[]);
    let contents: Vec<u8> = (0..300_000_u32).map(|i| (i % 253) as u8).collect();
    let id = service.upload("a.step", &contents);
    assert_eq!(service.upload("b%20c.step", &contents), id);
    let known = service.get("/v1/models").json();
    assert_eq!((known.as_array().unwrap().len(), known[0]["name"].as_str()), (1, Some("b c.step")));
    let path = format!("/v1/files/{id}/content");
    assert!(service.get(&path).body == contents);
    let part = service.ask("GET", &path, &["Range: bytes=1000-1999"], b"");
    assert!(part.status == 206 && part.body == contents[1000..2000]);
    assert_eq!(part.header("content-range"), Some("bytes 1000-1999/300000"));
    let last = service.ask("GET", &path, &["Range: bytes=-10"], b"");
    assert!(last.body == contents[299_990..]);
    assert_eq!(service.ask("GET", &path, &["Range: bytes=300000-"], b"").status, 416);
    assert_eq!(service.ask("GET", &path, &[&format!("If-None-Match: \"{id}\"")], b"").status, 304);
    assert_eq!(service.ask("DELETE", &format!("/v1/files/{id}"), &[], b"").status, 204);
    assert_eq!(service.get(&path).status, 404);
}

#[test]
fn an_upload_is_taken_up_again() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &[]);
    let contents: Vec<u8> = (0..100_000_u32).map(|i| (i % 241) as u8).collect();
    let begun = service.ask("POST", "/v1/uploads?name=a.meshb", &["Upload-Length: 100000"], b"");
    assert_eq!(begun.status, 201, "{}", begun.text());
    let place = begun.header("location").unwrap().to_owned();
    let patch = |service: &Service, from: usize, to: usize| {
        let offset = format!("Upload-Offset: {from}");
        service.ask("PATCH", &place, &[&offset, "Content-Type: application/offset+octet-stream"], &contents[from..to])
    };
    assert_eq!(patch(&service, 0, 30_000).status, 204);
    // What was acknowledged outlives the service.
    service.kill();
    let service = Service::start(folder.path(), &[]);
    let there = service.ask("HEAD", &place, &[], b"");
    assert_eq!(there.header("upload-offset"), Some("30000"));
    assert_eq!(patch(&service, 20_000, 40_000).status, 409);
    assert_eq!(patch(&service, 30_000, 60_000).status, 204);
    let ended = patch(&service, 60_000, 100_000);
    assert_eq!(ended.status, 200, "{}", ended.text());
    let id = ended.json()["id"].as_str().unwrap().to_owned();
    assert!(service.get(&format!("/v1/files/{id}/content")).body == contents);
    assert_eq!(service.ask("HEAD", &place, &[], b"").status, 404);
}

#[test]
fn what_is_too_large_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &["--file-size", "1MB", "--owner-bytes", "1500kB"]);
    let answer = service.ask("POST", "/v1/files?name=a.step", &[], &vec![1; 2_000_000]);
    assert_eq!(answer.status, 413, "{}", answer.text());
    assert_eq!(service.ask("POST", "/v1/uploads?name=a.step", &["Upload-Length: 2000000"], b"").status, 413);
    service.upload("a.step", &vec![1; 900_000]);
    let answer = service.ask("POST", "/v1/files?name=b.step", &[], &vec![2; 900_000]);
    assert_eq!(answer.status, 507, "{}", answer.text());
    let left = std::fs::read_dir(folder.path().join("uploads")).unwrap().count();
    assert_eq!(left, 0);
}

#[test]
fn names_are_plain() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &[]);
    for name in ["..%2Fa.step", "%2Fetc%2Fpasswd", ".a", "-o", "a%00b", "a%0Ab", ""] {
        assert_eq!(service.ask("POST", &format!("/v1/files?name={name}"), &[], b"x").status, 400, "{name}");
    }
    assert_eq!(service.ask("POST", "/v1/files", &[], b"x").status, 400);
    for id in ["..", "%2e%2e%2fcatalogue.sqlite", "0", &"0".repeat(64)] {
        assert_eq!(service.get(&format!("/v1/files/{id}/content")).status, 404, "{id}");
    }
}
