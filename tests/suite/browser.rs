//! A headless Chromium, led over the WebDriver protocol (w3.org/TR/webdriver2) by the chromedriver that belongs to it.
#![allow(dead_code, reason = "each program of tests uses its own part")]
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// How long a page may take; a software renderer on a busy machine is slow.
const PATIENCE: Duration = Duration::from_secs(120);

/// WebGL by software, for a page that draws.
pub const SOFTWARE: [&str; 3] = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

/// The tabulator key, as WebDriver has it.
pub const TAB: char = '\u{e004}';

/// Most presses of it from one end of a page to the other.
const MOST_TABS: usize = 300;

/// A browser with a profile of its own; it ends with this.
pub struct Browser {
    driver: Child,
    port: u16,
    session: String,
    _profile: tempfile::TempDir,
}

/// The path of a program, where there is one.
fn program(names: &[&str]) -> Option<std::path::PathBuf> {
    let path = std::env::var_os("PATH")?;
    let found = std::env::split_paths(&path).flat_map(|folder| names.iter().map(move |name| folder.join(name)));
    found.into_iter().find(|program| program.is_file())
}

impl Browser {
    /// Starts one, with these options beside the usual ones; none, with a word on it, where there is no browser. After set-up there must be one.
    pub fn start(options: &[&str]) -> Option<Self> {
        let programs = [program(&["chromium", "chromium-browser", "google-chrome"]), program(&["chromedriver"])];
        let [Some(browser), Some(driver)] = programs else {
            assert!(std::env::var_os("GEO_ADAPT_SET_UP").is_none(), "tests/run has set up chromium and chromedriver");
            eprintln!("skipped: no chromium with its chromedriver (Debian: chromium, chromium-driver)");
            return None;
        };
        let mut driver =
            Command::new(driver).arg("--port=0").stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut lines = BufReader::new(driver.stdout.take().unwrap()).lines();
        // "ChromeDriver was started successfully on port 12345."
        let port = lines
            .by_ref()
            .find_map(|line| line.ok()?.rsplit_once("successfully on port ")?.1.trim_end_matches('.').parse().ok())
            .expect("chromedriver names its port");
        // It goes on writing: nobody else reads it.
        std::thread::spawn(move || lines.for_each(drop));
        let profile = tempfile::tempdir().unwrap();
        let usual = "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking \
            --disable-component-update --disable-sync --disable-dev-shm-usage --window-size=1200,800";
        let mut arguments: Vec<String> = usual.split_whitespace().map(String::from).collect();
        arguments.push(format!("--user-data-dir={}", profile.path().display()));
        arguments.extend(options.iter().map(|&option| option.into()));
        let mut this = Self { driver, port, session: String::new(), _profile: profile };
        let wanted = json!({ "capabilities": { "alwaysMatch": {
            "browserName": "chrome",
            "goog:loggingPrefs": { "browser": "ALL" },
            "goog:chromeOptions": { "binary": browser, "args": arguments },
        } } });
        let answer = this.ask("POST", "/session", Some(wanted));
        this.session = answer["sessionId"].as_str().expect("a session").into();
        Some(this)
    }

    /// The value of an answer.
    fn ask(&self, method: &str, path: &str, body: Option<Value>) -> Value {
        let body = body.map_or(String::new(), |body| body.to_string());
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let head = format!(
            "{method} {path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nContent-Type: application/json\r\nContent-Length: {}\r\nConnection: close\r\n\r\n",
            self.port,
            body.len()
        );
        stream.write_all((head + &body).as_bytes()).unwrap();
        let mut reader = BufReader::new(stream);
        let mut length = 0;
        loop {
            let mut line = String::new();
            assert!(reader.read_line(&mut line).unwrap() > 0, "{path}: no answer");
            let line = line.trim().to_ascii_lowercase();
            if let Some(text) = line.strip_prefix("content-length:") {
                length = text.trim().parse().unwrap();
            }
            if line.is_empty() {
                break;
            }
        }
        let mut bytes = vec![0; length];
        reader.read_exact(&mut bytes).unwrap();
        let answer: Value = serde_json::from_slice(&bytes).unwrap();
        assert!(answer["value"]["error"].is_null(), "{path}: {answer}");
        answer["value"].clone()
    }

    fn command(&self, method: &str, what: &str, body: Option<Value>) -> Value {
        self.ask(method, &format!("/session/{}/{what}", self.session), body)
    }

    /// Loads a file.
    pub fn open(&self, path: &std::path::Path) {
        self.open_url(&format!("file://{}", path.display()));
    }

    /// Loads a page.
    pub fn open_url(&self, url: &str) {
        self.command("POST", "url", Some(json!({ "url": url })));
    }

    /// Scripts run in a frame from now on; in the page itself without one.
    pub fn enter(&self, frame: Option<&str>) {
        let id =
            frame.map_or(Value::Null, |selector| self.script(&format!("return document.querySelector('{selector}')")));
        self.command("POST", "frame", Some(json!({ "id": id })));
    }

    /// Puts downloads into a folder, without a question.
    pub fn download_to(&self, folder: &std::path::Path) {
        let params = json!({ "behavior": "allow", "downloadPath": folder });
        self.command(
            "POST",
            "goog/cdp/execute",
            Some(json!({ "cmd": "Browser.setDownloadBehavior", "params": params })),
        );
    }

    /// What a function's body in JavaScript returns.
    pub fn script(&self, text: &str) -> Value {
        self.command("POST", "execute/sync", Some(json!({ "script": text, "args": [] })))
    }

    /// Waits until an expression in JavaScript is true.
    pub fn wait(&self, condition: &str) {
        let start = Instant::now();
        while self.script(&format!("return Boolean({condition})")) != true {
            let state = "return JSON.stringify(document.body.dataset) + document.body.innerText.slice(0, 4000)";
            assert!(start.elapsed() < PATIENCE, "waited for {condition}; {}", self.script(state));
            std::thread::sleep(Duration::from_millis(100));
        }
    }

    /// Presses a mouse button at a point of the page, moves by so much, and lets go.
    pub fn drag(&self, [x, y]: [i32; 2], [right, down]: [i32; 2]) {
        let to = |x: i32, y: i32| json!({ "type": "pointerMove", "duration": 50, "x": x, "y": y });
        let button = |what: &str| json!({ "type": what, "button": 0 });
        self.act(json!({ "type": "pointer", "id": "mouse", "parameters": { "pointerType": "mouse" }, "actions":
            [to(x, y), button("pointerDown"), to(x + right, y + down), button("pointerUp")] }));
    }

    /// Turns the wheel at a point of the page.
    pub fn wheel(&self, [x, y]: [i32; 2], down: i32) {
        let scroll = json!({ "type": "scroll", "x": x, "y": y, "deltaX": 0, "deltaY": down });
        self.act(json!({ "type": "wheel", "id": "wheel", "actions": [scroll] }));
    }

    /// Presses a key, by its code of WebDriver.
    pub fn key(&self, key: char) {
        self.keys(&key.to_string());
    }

    /// Presses keys, one after the other.
    pub fn keys(&self, keys: &str) {
        let press = |key: char| ["keyDown", "keyUp"].map(|what| json!({ "type": what, "value": key.to_string() }));
        let actions: Vec<Value> = keys.chars().flat_map(press).collect();
        self.act(json!({ "type": "key", "id": "keys", "actions": actions }));
    }

    /// Goes to what a selector names as who has no mouse: by the tabulator.
    pub fn tab_to(&self, selector: &str) {
        let is_there = format!("return document.activeElement.matches('{selector}')");
        for _ in 0..MOST_TABS {
            if self.script(&is_there) == true {
                return;
            }
            self.key(TAB);
        }
        panic!("the tabulator does not reach {selector}");
    }

    fn act(&self, source: Value) {
        self.command("POST", "actions", Some(json!({ "actions": [source] })));
    }

    /// The page as PNG, in base64.
    pub fn screenshot(&self) -> String {
        self.command("GET", "screenshot", None).as_str().unwrap().into()
    }

    /// Errors in the console since the last call.
    pub fn errors(&self) -> Vec<Value> {
        let log = self.command("POST", "se/log", Some(json!({ "type": "browser" })));
        log.as_array().unwrap().iter().filter(|entry| entry["level"] == "SEVERE").cloned().collect()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Without a panic on the way: after a failed test there may be no answer.
        let end = format!("DELETE /session/{} HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n", self.session);
        if let Ok(mut stream) = TcpStream::connect(("127.0.0.1", self.port)) {
            let _ = stream.set_read_timeout(Some(Duration::from_secs(20)));
            let _ = stream.write_all(end.as_bytes()).and_then(|()| stream.read_to_end(&mut Vec::new()));
        }
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}
