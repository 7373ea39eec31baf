//! The page: its files, as they stand in the program.

/// A file of the page: its path, its media type, its content.
type PageFile = (&'static str, &'static str, &'static str);

const SCRIPT: &str = "text/javascript; charset=utf-8";

/// Everything but the page itself; none of it tells anything of the scene, so it needs no token.
const FILES: [PageFile; 10] = [
    (
        "/page.css",
        "text/css; charset=utf-8",
        include_str!("page/page.css"),
    ),
    ("/main.js", SCRIPT, include_str!("page/main.js")),
    ("/socket.js", SCRIPT, include_str!("page/socket.js")),
    ("/scene.js", SCRIPT, include_str!("page/scene.js")),
    ("/paint.js", SCRIPT, include_str!("page/paint.js")),
    ("/shaders.js", SCRIPT, include_str!("page/shaders.js")),
    ("/eye.js", SCRIPT, include_str!("page/eye.js")),
    ("/hand.js", SCRIPT, include_str!("page/hand.js")),
    ("/panel.js", SCRIPT, include_str!("page/panel.js")),
    ("/maths.js", SCRIPT, include_str!("page/maths.js")),
];

/// The page itself.
pub(super) const PAGE: PageFile = (
    "/",
    "text/html; charset=utf-8",
    include_str!("page/page.html"),
);

/// The file at a path.
pub(super) fn file(path: &str) -> Option<PageFile> {
    FILES.into_iter().find(|(known, ..)| *known == path)
}
