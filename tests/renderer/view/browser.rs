//! The page in a real browser: headless Chromium loads it, walks, drags a block, switches the lamp, and pixels follow.
//!
//! It is driven by the Chrome DevTools Protocol over the same WebSockets. Where no browser is installed, the test says so and is
//! passed over; `SWEEPLIGHT_SHOTS=FOLDER` keeps its screenshots.

use super::client::{PATIENCE, serve};
use base64::Engine;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;
use tungstenite::{Message, WebSocket};

/// Names by which the browser is installed.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];

/// A page of a browser; both end with this.
struct Browser {
    child: Child,
    socket: WebSocket<TcpStream>,
    next: u64,
    _profile: TempDir,
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Browser {
    /// Starts a browser; `None` where none is installed, or it does not start here.
    fn start() -> Option<Browser> {
        let profile = tempfile::tempdir().expect("a folder");
        let folder = format!("--user-data-dir={}", profile.path().display());
        let args = [
            "--headless=new",
            "--no-sandbox",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
            "--hide-scrollbars",
            "--disable-dev-shm-usage",
        ];
        let mut child = NAMES.iter().find_map(|name| {
            let mut command = Command::new(name);
            let command =
                command
                    .args(args)
                    .args(["--remote-debugging-port=0", &folder, "about:blank"]);
            command
                .stdout(Stdio::null())
                .stderr(Stdio::piped())
                .spawn()
                .ok()
        })?;
        let errors = BufReader::new(child.stderr.take()?);
        let mut lines = errors.lines().map_while(Result::ok);
        let address = lines.find_map(|line| Some(line.split_once("ws://")?.1.to_string()));
        let host = address
            .as_deref()
            .and_then(|address| address.split('/').next());
        // Its further words go nowhere, but must be read.
        std::thread::spawn({
            let host = host.map(String::from);
            move || drop((host, lines.count()))
        });
        let page = page(address?.split('/').next()?)?;
        let stream = TcpStream::connect(page.split('/').nth(2)?).ok()?;
        stream.set_read_timeout(Some(PATIENCE)).ok()?;
        let (socket, _) = tungstenite::client(page.as_str(), stream).ok()?;
        Some(Browser {
            child,
            socket,
            next: 0,
            _profile: profile,
        })
    }

    fn call(&mut self, method: &str, params: Value) -> Value {
        self.next += 1;
        let message = json!({ "id": self.next, "method": method, "params": params });
        self.socket
            .send(Message::text(message.to_string()))
            .expect("a message is sent");
        loop {
            let Message::Text(text) = self.socket.read().expect("an answer") else {
                continue;
            };
            let answer: Value = serde_json::from_str(&text).expect("JSON");
            if answer["id"].as_u64() == Some(self.next) {
                assert!(answer.get("error").is_none(), "{method}: {answer}");
                return answer["result"].clone();
            }
        }
    }

    /// The value of an expression in the page.
    fn value(&mut self, expression: &str) -> Value {
        let params =
            json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let result = self.call("Runtime.evaluate", params);
        assert!(
            result.get("exceptionDetails").is_none(),
            "{expression}: {result}"
        );
        result["result"]["value"].clone()
    }

    fn until(&mut self, expression: &str) {
        let start = Instant::now();
        while self.value(expression) != json!(true) {
            assert!(
                start.elapsed() < PATIENCE,
                "it does not become so: {expression}"
            );
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    fn mouse(&mut self, kind: &str, [x, y]: [f64; 2]) {
        let buttons = u32::from(kind != "mouseReleased");
        let params = json!({ "type": kind, "x": x, "y": y, "button": "left", "buttons": buttons, "clickCount": 1 });
        self.call("Input.dispatchMouseEvent", params);
    }

    /// A window of this size, light or dark, and a picture of it.
    fn shot(&mut self, name: &str, [width, height]: [u32; 2], scheme: &str) -> Vec<u8> {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600 });
        self.call("Emulation.setDeviceMetricsOverride", size);
        let scheme = json!({ "features": [{ "name": "prefers-color-scheme", "value": scheme }] });
        self.call("Emulation.setEmulatedMedia", scheme);
        std::thread::sleep(Duration::from_millis(300));
        let shot = self.call("Page.captureScreenshot", json!({ "format": "png" }));
        let text = shot["data"].as_str().expect("a picture");
        let bytes = base64::engine::general_purpose::STANDARD
            .decode(text)
            .expect("base64");
        if let Some(folder) = std::env::var_os("SWEEPLIGHT_SHOTS") {
            std::fs::write(std::path::Path::new(&folder).join(name), &bytes).expect("a file");
        }
        bytes
    }

    /// The mean of all codes of the canvas.
    fn brightness(&mut self) -> f64 {
        // The next frame has drawn what has come.
        let mean = self.value(
            "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => {
                const { gl } = sweeplight.paint, [w, h] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
                const codes = new Uint8Array(4 * w * h);
                gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, codes);
                done(codes.reduce((sum, code) => sum + code, 0) / codes.length);
            })))",
        );
        mean.as_f64().expect("a number")
    }
}

/// The address of the first page.
fn page(host: &str) -> Option<String> {
    let mut stream = TcpStream::connect(host).ok()?;
    let head = format!("GET /json HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n");
    stream.write_all(head.as_bytes()).ok()?;
    stream.set_read_timeout(Some(Duration::from_secs(3))).ok()?;
    let mut text = Vec::new();
    let _ = stream.read_to_end(&mut text);
    let text = String::from_utf8_lossy(&text).into_owned();
    let list = &text[text.find("\r\n\r\n")? + 4..];
    let list: Value = serde_json::from_str(&list[list.find('[')?..=list.rfind(']')?]).ok()?;
    let page = list
        .as_array()?
        .iter()
        .find(|target| target["type"] == "page")?;
    Some(page["webSocketDebuggerUrl"].as_str()?.to_string())
}

#[test]
fn the_page_shows_light_that_follows_a_hand() {
    let Some(mut browser) = Browser::start() else {
        println!("SKIPPED: no Chromium is installed that starts here (apt-get install chromium)");
        return;
    };
    let live = serve(&[]);
    let address = format!("http://{}/?token={}", live.host, live.token);
    browser.call("Page.enable", json!({}));
    let size = json!({ "width": 1000, "height": 600, "deviceScaleFactor": 1, "mobile": false });
    browser.call("Emulation.setDeviceMetricsOverride", size);
    browser.call("Page.navigate", json!({ "url": address }));
    browser.until("Boolean(globalThis.sweeplight?.times.first)");
    let lit = browser.brightness();
    assert!(lit > 80.0, "{lit}");
    let settled = "sweeplight.scene.values.coarse === false && sweeplight.times.sent.size === 0";

    // Pick the block where its middle is seen, and drag it.
    let middle = browser.value("(() => { const { scene, view } = sweeplight; const v = view(); return [v, scene.middle(3)]; })()");
    let at = seen(&middle[0], &middle[1]);
    browser.mouse("mousePressed", at);
    browser.mouse("mouseReleased", at);
    assert_eq!(browser.value("sweeplight.hand.selected"), json!(3));
    browser.mouse("mousePressed", at);
    for k in 1..=10 {
        browser.mouse(
            "mouseMoved",
            [at[0] + 6.0 * f64::from(k), at[1] + f64::from(k)],
        );
    }
    browser.until("sweeplight.times.drawn.length > 0");
    browser.mouse("mouseReleased", [at[0] + 60.0, at[1] + 10.0]);
    browser.until(settled);
    assert_eq!(browser.value("sweeplight.scene.values.lines"), json!(1));
    println!(
        "ms from a drag to its light: {}",
        browser.value("sweeplight.times.drawn.map(Math.round).join(' ')")
    );

    // Walk, and look through the eye.
    let before = browser.value("JSON.stringify(sweeplight.eye.eye)");
    let before = before.as_str().expect("three numbers");
    browser.value("document.getElementById('walk').click(), sweeplight.eye.keys.add('KeyW'), 0");
    browser.until(&format!(
        "JSON.stringify(sweeplight.eye.eye) !== '{before}'"
    ));
    browser.value("sweeplight.eye.keys.clear()");

    // Switch the lamp off and on.
    let lit = browser.brightness();
    let click = "document.querySelector('#lamps input[type=checkbox]').click()";
    browser.value(click);
    browser.until("sweeplight.scene.values.lines === 2");
    let dark = browser.brightness();
    assert!(dark < 0.6 * lit, "{dark} of {lit}");
    browser.value(click);
    browser.until("sweeplight.scene.values.lines === 3");
    let again = browser.brightness();
    assert!((again / lit - 1.0).abs() < 0.02, "{again} of {lit}");

    // The true picture covers the view when it rests.
    browser.value("document.getElementById('true').click()");
    browser.until("!sweeplight.still.image.hidden && sweeplight.still.image.naturalWidth === 1000");

    // The state is that of a fresh build.
    let verified = browser.value("sweeplight.socket.ask({ do: 'verify' })");
    assert_eq!(
        (&verified["holds"], &verified["verified"]["differ"]),
        (&json!(true), &json!(0))
    );
    for (name, size, scheme) in [
        ("desktop-light.png", [1200, 720], "light"),
        ("phone-dark.png", [390, 844], "dark"),
    ] {
        assert!(browser.shot(name, size, scheme).starts_with(b"\x89PNG"));
    }
    assert_eq!(browser.value("sweeplight.paint.gl.getError()"), json!(0));
}

/// Where a point is seen in a window of 1000 × 600, given what `view` says; a little above it.
fn seen(view: &Value, point: &Value) -> [f64; 2] {
    let vector = |value: &Value| {
        let part = |k: usize| value[k].as_f64().expect("a number");
        glam::DVec3::new(part(0), part(1), part(2))
    };
    let (eye, at) = (vector(&view["eye"]), vector(&view["at"]));
    let forward = (at - eye).normalize();
    let right = forward.cross(glam::DVec3::Y).normalize();
    let up = right.cross(forward);
    let way = vector(point) + glam::DVec3::Y * 0.6 - eye;
    let half = (0.5 * view["degrees"].as_f64().expect("an angle"))
        .to_radians()
        .tan();
    let scale = 300.0 / half / way.dot(forward);
    [500.0 + scale * way.dot(right), 300.0 - scale * way.dot(up)]
}
