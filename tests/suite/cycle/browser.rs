//! The report page of `geo-adapt cycle` in a browser: loads nothing, no error, charts and pictures there. Passes where there is no Chromium.
use crate::browser::Browser;
use crate::common::program;

const CONFIG: &str = r#"
threads = 1
[mesh]
cube = 3
[solver.analytic]
function = "sinfun3"
[metric]
[schedule]
complexity = 100
every = 2
max_complexity = 200
[output]
folder = "out"
"#;

#[test]
fn a_report_shows_charts_histograms_and_pictures() {
    let Some(browser) = Browser::start(&[]) else { return };
    let folder = tempfile::tempdir().unwrap();
    let config = folder.path().join("loop.toml");
    std::fs::write(&config, CONFIG).unwrap();
    let run = program().arg("cycle").arg(&config).output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    browser.open(&folder.path().join("out/report.html"));
    let count = |selector: &str| {
        browser.script(&format!("return document.querySelectorAll('{selector}').length")).as_u64().unwrap()
    };
    // Five meshes: the cube, and two of each complexity, of which the last ones are shown in two pictures each.
    assert_eq!((count("tbody tr"), count("circle"), count("article")), (5, 5, 4));
    assert_eq!((count("circle.point:not(.early)"), count("figure.picture img")), (3, 4));
    assert_eq!(count("figure.histogram svg"), 8);
    let drawn = "return [...document.images].every(image => image.complete && image.naturalWidth === 800)";
    assert_eq!(browser.script(drawn), true);
    // Nothing is drawn outside of its chart, and no number is none.
    let outside = "return [...document.querySelectorAll('svg')].flatMap(svg => { const frame = svg.getBoundingClientRect(); \
        return [...svg.querySelectorAll('rect, circle, text')].filter(part => { const box = part.getBoundingClientRect(); \
        return box.left < frame.left - 1 || box.right > frame.right + 1 || box.top < frame.top - 1 || box.bottom > frame.bottom + 1 }) }) \
        .map(part => part.outerHTML)";
    assert_eq!(browser.script(outside), serde_json::json!([]));
    // Without the pictures, whose letters may be any.
    let text =
        "document.querySelectorAll('img').forEach(image => image.remove()); return document.documentElement.outerHTML";
    let text = browser.script(text).as_str().unwrap().to_owned();
    assert!(text.contains("[solver.analytic]"), "the configuration");
    assert!(!text.contains("NaN") && !text.contains("{{"), "a number that is none, or a place not filled");
    assert!(
        browser
            .script("return document.querySelector('header').textContent")
            .as_str()
            .unwrap()
            .contains("complexity 200 is reached")
    );
    assert_eq!(
        browser.script(
            "return performance.getEntriesByType('resource').filter(entry => !entry.name.startsWith('data:')).length"
        ),
        0
    );
    assert_eq!(browser.errors(), Vec::<serde_json::Value>::new());
}
