//! Strangers: what has no token, another name for the server, or another page's origin is refused.

use super::client::serve;

#[test]
fn strangers_are_refused() {
    let live = serve(&[]);
    let (host, token) = (live.host.clone(), live.token.clone());
    let page = live.get(&format!("/?token={token}"));
    assert!(
        page.starts_with("HTTP/1.1 200") && page.contains("main.js"),
        "{page}"
    );
    assert!(
        page.contains("Content-Security-Policy: default-src 'self'"),
        "{page}"
    );
    assert!(live.get("/main.js").starts_with("HTTP/1.1 200"));
    for (path, status) in [
        ("/", 403),
        ("/?token=", 403),
        (&format!("/?token={}", "0".repeat(32)), 403),
        (&format!("/socket?token={}x", token), 403),
        ("/texture/0", 403),
        (&format!("/texture/0?token={token}"), 404),
        (&format!("/../Cargo.toml?token={token}"), 404),
        (&format!("/scene.gltf?token={token}"), 404),
    ] {
        let answer = live.get(path);
        assert!(
            answer.starts_with(&format!("HTTP/1.1 {status}")),
            "{path}: {answer}"
        );
    }
    let port = host.rsplit(':').next().expect("a port");
    for name in [
        "evil.example",
        &format!("evil.example:{port}"),
        "127.0.0.1:1",
    ] {
        let answer = live.http(&format!("GET /?token={token} HTTP/1.1\r\nHost: {name}"));
        assert!(answer.starts_with("HTTP/1.1 421"), "{name}: {answer}");
    }
    let post = live.http(&format!(
        "POST /?token={token} HTTP/1.1\r\nHost: {host}\r\nContent-Length: 0"
    ));
    assert!(post.starts_with("HTTP/1.1 405"), "{post}");
    let socket = |origin: &str| {
        live.http(&format!(
            "GET /socket?token={token} HTTP/1.1\r\nHost: {host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
             Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n{origin}X: y"
        ))
    };
    for origin in [
        "",
        "Origin: http://evil.example\r\n",
        "Origin: null\r\n",
        "Origin: https://127.0.0.1\r\n",
    ] {
        let answer = socket(origin);
        assert!(answer.starts_with("HTTP/1.1 403"), "{origin}: {answer}");
    }
    assert!(live.http("nonsense").starts_with("HTTP/1.1 400"));
    // The answer may be lost where the connection ends before all was sent.
    let long = live.http(&format!("GET /{} HTTP/1.1", "a".repeat(20_000)));
    assert!(
        long.is_empty() || long.starts_with("HTTP/1.1 400"),
        "{long}"
    );
    // Who belongs here still gets in.
    live.tab();
}
