//! The workbench: from the drop of a model to a download, by keyboard; who has no token is asked for it. Passes where there is no Chromium.
use crate::browser::{Browser, SOFTWARE};
use crate::common::program;
use crate::service::{PATIENCE, Service};
use serde_json::Value;
use std::path::Path;
use std::time::{Duration, Instant};

/// The Enter key, as WebDriver has it.
const ENTER: &str = "\u{e007}";

/// A model as a file.
fn model() -> (&'static str, String) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("geometry/cube.step");
    ("cube.step", std::fs::read_to_string(path).unwrap())
}

/// The page of a service, when it has read what is there.
fn open(browser: &Browser, service: &Service) {
    browser.open_url(&service.url());
    browser.wait("document.body.dataset.state === 'ready'");
}

/// Drops a file on the page.
fn drop_file(browser: &Browser, (name, text): (&str, &str)) {
    let [name, text] = [name, text].map(|text| serde_json::to_string(text).unwrap());
    browser.script(&format!(
        "const data = new DataTransfer(); data.items.add(new File([{text}], {name}));
         document.body.dispatchEvent(new DragEvent('drop', {{ dataTransfer: data, bubbles: true, cancelable: true }}))"
    ));
}

/// Waits until a view shows a file.
fn shown(browser: &Browser, pane: &str, name: &str) {
    browser.wait(&format!(
        "document.querySelector('#{pane} h2').textContent === '{name}' && document.getElementById('{pane}').dataset.state === 'ready'"
    ));
}

/// The middle of the picture of the first view.
fn middle(browser: &Browser) -> [i32; 2] {
    let at = browser.script(
        "const box = document.querySelector('#first iframe').getBoundingClientRect(); return [box.x + (box.width - 292) / 2, box.y + box.height / 2].map(Math.round)",
    );
    [0, 1].map(|i| at[i].as_i64().unwrap() as i32)
}

/// Waits for a file in a folder.
fn downloaded(path: &Path) -> Vec<u8> {
    let began = Instant::now();
    while !path.exists() {
        assert!(began.elapsed() < PATIENCE, "{} does not come", path.display());
        std::thread::sleep(Duration::from_millis(50));
    }
    std::fs::read(path).unwrap()
}

#[test]
fn from_the_drop_of_a_model_to_a_download() {
    let Some(browser) = Browser::start(&SOFTWARE) else { return };
    let (folder, downloads) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let service = Service::start(folder.path(), &[]);
    browser.download_to(downloads.path());
    open(&browser, &service);
    let (name, text) = model();
    drop_file(&browser, (name, &text));
    shown(&browser, "first", name);

    // A face is clicked and named; its name goes along to what is made of the model.
    browser.drag(middle(&browser), [0, 0]);
    browser.wait("!document.querySelector('#first form').hidden");
    browser.tab_to("#first input");
    browser.keys(&format!("inlet{ENTER}"));
    browser.wait("document.getElementById('said').textContent.startsWith('Names are kept')");

    // From here on without a mouse.
    browser.tab_to("#bootstrap [name=start]");
    browser.keys(ENTER);
    shown(&browser, "first", "cube.meshb");
    browser.enter(Some("#first iframe"));
    let names = browser.script("return [...document.querySelectorAll('#surfaces input.name')].map(one => one.value)");
    assert!(names.as_array().unwrap().contains(&Value::from("inlet")), "{names}");
    browser.enter(None);
    browser.tab_to("#adapt [name=size]");
    browser.keys("0.15");
    let words = browser.script("return document.getElementById('shell').textContent");
    assert!(words.as_str().unwrap().starts_with("geo-adapt adapt cube.meshb -o cube-2.meshb"), "{words}");
    browser.keys(ENTER);
    shown(&browser, "first", "cube-2.meshb");
    browser.wait("document.querySelectorAll('#sizes tbody tr').length > 5 && document.querySelectorAll('#ratios tbody tr').length > 1");

    browser.tab_to("#jobs li:first-child summary");
    browser.keys(ENTER);
    browser.tab_to("#jobs li:first-child select");
    browser.keys(".vtu");
    browser.tab_to("#jobs li:first-child [data-part=convert]");
    browser.keys(ENTER);
    let mesh = downloads.path().join("cube-2.vtu");
    assert!(downloaded(&mesh).starts_with(b"<"));
    assert!(program().arg("inspect").arg(&mesh).output().unwrap().status.success());

    // Two beside each other turn together.
    browser.tab_to("#jobs li:nth-child(2) [data-part=compare]");
    browser.keys(ENTER);
    shown(&browser, "second", "cube.meshb");
    assert_eq!(browser.script("return document.querySelectorAll('#sizes thead th').length"), 2);
    browser.enter(Some("#second iframe"));
    browser.script("document.getElementById('canvas').focus()");
    // Left, as WebDriver has it.
    browser.key('\u{e012}');
    browser.enter(None);
    let azimuth = |pane: &str| {
        browser.enter(Some(&format!("#{pane} iframe")));
        let azimuth = browser.script("return document.body.dataset.azimuth");
        browser.enter(None);
        azimuth
    };
    let began = Instant::now();
    while azimuth("first") != "-50.00" || azimuth("second") != "-50.00" {
        assert!(began.elapsed() < PATIENCE, "{} {}", azimuth("first"), azimuth("second"));
        std::thread::sleep(Duration::from_millis(50));
    }

    // What cannot be undone wants to be said twice. Behind the last frame the tabulator leaves the page, for a bar that is not there.
    browser.script("document.getElementById('skip').focus()");
    browser.tab_to("#jobs li:first-child [data-part=remove]");
    browser.keys(&ENTER.repeat(2));
    browser.wait("document.querySelectorAll('#jobs > li').length === 1");
    assert_eq!(browser.errors(), Vec::<Value>::new());
}

#[test]
fn a_job_is_followed_and_cancelled() {
    let Some(browser) = Browser::start(&SOFTWARE) else { return };
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &[]);
    service.upload("in.meshb", &crate::service::cube(4));
    open(&browser, &service);
    browser.script(
        "document.querySelector('[name=what][value=adapt]').click();
         const form = document.getElementById('adapt').elements;
         [form.by.value, form.target.value] = ['analytic', '200000'];
         document.getElementById('adapt').dispatchEvent(new Event('input'));
         form.analytic.value = 'polar-2'; form.start.click()",
    );
    browser.wait("/[0-9] of about [0-9].* vertices/.test(document.querySelector('#jobs .told')?.textContent)");
    browser.tab_to("#jobs [data-part=cancel]");
    browser.keys(ENTER);
    browser.wait("document.querySelector('#jobs .state.cancelled')");
    // What it had is there.
    shown(&browser, "first", "in-2.meshb");
    assert_eq!(browser.errors(), Vec::<Value>::new());
}

#[test]
fn who_has_no_token_is_asked_for_it() {
    let Some(browser) = Browser::start(&[]) else { return };
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &["--tokens-only"]);
    let token = program().args(["serve", "token", "add", "ann", "--data"]).arg(folder.path()).output().unwrap();
    let token = String::from_utf8(token.stdout).unwrap();
    browser.open_url(&service.url());
    browser.wait("document.getElementById('session').open");
    browser.keys(&format!("wrong{ENTER}"));
    browser.wait("document.getElementById('token-wrong').textContent");
    browser.script("document.getElementById('token').value = ''");
    browser.keys(&format!("{}{ENTER}", token.trim()));
    browser.wait(
        "document.body.dataset.state === 'ready' && document.getElementById('about').textContent.includes('ann')",
    );
    // No script can read it.
    assert_eq!(browser.script("return document.cookie"), "");
    browser.errors();
    browser.tab_to("#leave");
    browser.keys(ENTER);
    browser.wait("document.getElementById('session').open");
}

#[test]
fn the_page_loads_nothing_from_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &[]);
    let page = service.get("/");
    let policy = page.header("content-security-policy").unwrap().to_owned();
    assert!(policy.contains("default-src 'none'") && !policy.contains("unsafe"), "{policy}");
    let text = page.text();
    assert!(!text.contains("://") && !text.contains(" style=") && !text.contains(" onclick"), "{text}");
    // All that it asks for is there, and all that this asks for.
    let mut parts: Vec<String> =
        text.split('"').filter_map(|word| word.strip_prefix("workbench/")).map(str::to_owned).collect();
    let mut seen = 0;
    while let Some(part) = parts.get(seen).cloned() {
        let answer = service.get(&format!("/workbench/{part}"));
        assert_eq!((answer.status, answer.header("x-content-type-options")), (200, Some("nosniff")), "{part}");
        let text = answer.text();
        let kind = answer.header("content-type").unwrap();
        assert_eq!(kind.starts_with("text/javascript"), part.ends_with(".js"), "{part}");
        let more = text.split('"').filter_map(|word| word.strip_prefix("./")).map(str::to_owned);
        let new: Vec<String> = more.filter(|name| !parts.contains(name)).collect();
        parts.extend(new);
        let own = text.replace("http://www.w3.org/2000/svg", "");
        assert!(!own.contains("http:") && !own.contains("https:") && !own.contains("innerHTML"), "{part}");
        seen += 1;
    }
    assert!(seen > 15, "{parts:?}");
}
