//! Damaged models as jobs: each ends with a result or its reason, and the service takes no harm.
//!
//! A few by default; GEO_ADAPT_MUTATIONS says how many of each format. They are damaged as those of tests/cad/damaged.rs.
use crate::common::damage::{Random, damaged};
use crate::mutations::memory;
use crate::service::Service;
use serde_json::json;
use std::fs;
use std::path::Path;

/// Model after model through `model` and `bootstrap`.
#[test]
fn damaged_models_end_their_own_jobs_alone() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let count = std::env::var("GEO_ADAPT_MUTATIONS").ok().and_then(|count| count.parse().ok()).unwrap_or(6);
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &["--job-memory", "4GB", "--job-seconds", "120"]);
    let sources = [
        ("capped-cylinder.step", "step"),
        ("block-inches.igs", "igs"),
        ("torus.brep", "brep"),
        ("torus.brep", "egads"),
    ];
    let (mut refused, mut level) = (0, 0);
    for (source, ending) in sources {
        let valid = fs::read(data.join(source)).unwrap();
        let (name, mut random) = (format!("damaged.{ending}"), Random(20_261_126));
        for number in 0..count {
            let id = service.upload(&name, &damaged(&valid, &mut random));
            let files = json!({ name.as_str(): id });
            let words = json!([name, "-o", "out.meshb", "--time-limit", "5"]);
            let jobs = [
                service.accepted("model", json!([name, "--json"]), files.clone()),
                service.accepted("bootstrap", words, files),
            ];
            for job in jobs {
                let ended = service.ended(&job);
                let reason = ended["reason"].as_str().unwrap_or_default();
                let what = format!("{source}, number {number} of this seed: {ended}");
                match (ended["state"].as_str(), ended["exit_code"].as_i64()) {
                    (Some("done"), Some(0)) => assert!(reason.is_empty(), "{what}"),
                    // A mesh that has flaws is there, and told.
                    (Some("failed"), Some(1)) => {}
                    (Some("failed"), Some(2)) => {
                        refused += 1;
                        assert!(reason.contains("damaged."), "{what}");
                    }
                    _ => panic!("{what}"),
                }
            }
        }
        if level == 0 {
            level = memory(service.process());
        }
    }
    assert!(refused > 0, "no file was damaged enough to tell");
    let after = memory(service.process());
    assert!(after < level + (64 << 20), "from {level} to {after} bytes");
}
