//! From a path or a URI to bytes: scene files, the files they refer to, and data URIs.
//!
//! glTF 2.0 specification, Khronos Group 2021, section 2.8 "URIs".

use crate::error::{Error, Result};
use crate::scene::fault::broken;
use serde_json::Value;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

/// The first bytes, `most` at most, of what a URI of the scene file stands for; `pointer` is where the URI is written.
///
/// A file has to lie inside the scene's folder, after all links, unless `external` ones are allowed.
pub(super) fn fetch(
    file: &Path,
    uri: &str,
    pointer: &str,
    most: u64,
    external: bool,
) -> Result<Vec<u8>> {
    // Decode what stands in the URI itself.
    if let Some(data) = uri.strip_prefix("data:") {
        let decoded = data.split_once(',').and_then(|(kind, data)| {
            if kind.ends_with(";base64") {
                base64(&unescape(data))
            } else {
                Some(unescape(data))
            }
        });
        return decoded.ok_or_else(|| {
            let got = format!("'{}…'", uri.chars().take(40).collect::<String>());
            broken(
                file,
                pointer.into(),
                "a data URI with a comma and valid base64",
                got,
                "export the file again",
            )
        });
    }

    // Refuse the network and foreign schemes; a single letter is a Windows drive.
    let scheme = uri
        .split(':')
        .next()
        .filter(|scheme| scheme.len() < uri.len() && scheme.len() > 1);
    if scheme.is_some_and(|scheme| {
        scheme
            .bytes()
            .all(|byte| byte.is_ascii_alphanumeric() || b"+-.".contains(&byte))
    }) {
        return Err(Error::Unsupported {
            file: file.into(),
            feature: format!(
                "{pointer}: the address '{}'",
                uri.chars().take(200).collect::<String>()
            ),
            way_out: "download what it points to and refer to it by a relative path".into(),
        });
    }

    let path = locate(file, uri, pointer)?;
    if !external && !is_inside(file, &path) {
        return Err(broken(
            file,
            pointer.into(),
            "a file inside the scene's folder",
            format!("'{uri}'"),
            "put the file beside the scene, or add --allow-external for a scene that you trust",
        ));
    }
    read(
        &path,
        most,
        &format!("{} refers to it at {pointer}; put it there", file.display()),
    )
}

/// Every file that a scene file refers to, as far as its addresses are paths.
pub(super) fn sources(file: &Path, json: &Value) -> Vec<PathBuf> {
    let sections = ["buffers", "images"].map(|section| json.get(section)?.as_array());
    let items = sections.into_iter().flatten().flatten();
    let uris = items.filter_map(|item| item.get("uri")?.as_str());
    let paths = uris.filter(|uri| !uri.starts_with("data:"));
    paths.filter_map(|uri| locate(file, uri, "").ok()).collect()
}

/// The path that an address stands for, seen from the scene's folder.
fn locate(file: &Path, uri: &str, pointer: &str) -> Result<PathBuf> {
    let relative = String::from_utf8(unescape(uri)).map_err(|_| {
        broken(
            file,
            pointer.into(),
            "a path in UTF-8",
            format!("'{uri}'"),
            "rename the file and export again",
        )
    })?;
    let folder = file.parent().unwrap_or(Path::new(""));
    let mut path = folder.join(&relative);
    // Some exporters on Windows write backslashes; elsewhere a name may hold them.
    if relative.contains('\\') && !path.exists() {
        path = folder.join(relative.replace('\\', "/"));
    }
    Ok(path)
}

/// Whether a file lies inside the scene's folder: as its address is written, on any system, and after all links.
fn is_inside(scene: &Path, path: &Path) -> bool {
    let folder = scene.parent().unwrap_or(Path::new(""));
    let Ok(inner) = path.strip_prefix(folder) else {
        return false;
    };
    let text = inner.to_string_lossy();
    if text.as_bytes().get(1) == Some(&b':') || text.starts_with(['/', '\\']) {
        return false;
    }
    let mut depth = 0;
    for step in inner.components() {
        depth += match step {
            Component::Normal(_) => 1,
            Component::CurDir => 0,
            _ => -1,
        };
        if depth < 0 {
            return false;
        }
    }
    let folder = if folder == Path::new("") {
        Path::new(".")
    } else {
        folder
    };
    match (folder.canonicalize(), path.canonicalize()) {
        (Ok(folder), Ok(path)) => path.starts_with(folder),
        // What is not there is told as that.
        _ => true,
    }
}

/// First bytes of a Git LFS pointer, the text in place of a file that was not fetched.
const LFS: &[u8] = b"version https://git-lfs";

/// A regular file's first bytes, `most` at most; devices and pipes, which may never end, are refused.
pub(super) fn read(path: &Path, most: u64, way_out: &str) -> Result<Vec<u8>> {
    let failed = |source| Error::Read {
        path: path.into(),
        source,
        way_out: way_out.into(),
    };
    let about = std::fs::metadata(path).map_err(failed)?;
    if !about.is_file() {
        let what = if about.is_dir() {
            "it is a folder"
        } else {
            "not a regular file"
        };
        return Err(failed(std::io::Error::other(what)));
    }
    let mut bytes = Vec::new();
    // A little more than is asked for tells what the file is.
    let least = most.max(LFS.len() as u64);
    let length = usize::try_from(about.len().min(least)).unwrap_or(usize::MAX);
    bytes
        .try_reserve_exact(length)
        .map_err(|_| failed(std::io::ErrorKind::OutOfMemory.into()))?;
    let file = std::fs::File::open(path).map_err(failed)?;
    file.take(least).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.starts_with(LFS) {
        return Err(Error::Read {
            path: path.into(),
            source: std::io::Error::other("it is a pointer of Git LFS, not the file itself"),
            way_out: "fetch it with `git lfs pull`".into(),
        });
    }
    bytes.truncate(usize::try_from(most).unwrap_or(usize::MAX));
    Ok(bytes)
}

/// A URI with %20 and its like made bytes again.
fn unescape(uri: &str) -> Vec<u8> {
    let bytes = uri.as_bytes();
    let mut plain = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while let Some(byte) = bytes.get(at) {
        let hex = bytes
            .get(at + 1..at + 3)
            .filter(|hex| *byte == b'%' && hex.iter().all(u8::is_ascii_hexdigit));
        let code = hex
            .and_then(|hex| std::str::from_utf8(hex).ok())
            .and_then(|hex| u8::from_str_radix(hex, 16).ok());
        plain.push(code.unwrap_or(*byte));
        at += if code.is_some() { 3 } else { 1 };
    }
    plain
}

/// RFC 4648: base64, with or without padding; `None` where a character is none of its 64.
fn base64(text: &[u8]) -> Option<Vec<u8>> {
    let digits = text
        .strip_suffix(b"==")
        .or(text.strip_suffix(b"="))
        .unwrap_or(text);
    let mut bytes = Vec::with_capacity(digits.len() / 4 * 3 + 2);
    for group in digits.chunks(4) {
        let mut bits = 0_u32;
        for digit in group {
            let value = match digit {
                b'A'..=b'Z' => digit - b'A',
                b'a'..=b'z' => digit - b'a' + 26,
                b'0'..=b'9' => digit - b'0' + 52,
                b'+' => 62,
                b'/' => 63,
                _ => return None,
            };
            bits = bits << 6 | u32::from(value);
        }
        // Two digits hold one byte, three hold two, four hold three; one alone holds none.
        let whole = bits << (6 * (4 - group.len()));
        bytes.extend(&whole.to_be_bytes()[1..group.len().max(1)]);
        if group.len() == 1 {
            return None;
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_the_rfc() {
        // RFC 4648, section 10.
        for (text, bytes) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYg==", "foob"),
            ("Zm9vYmE", "fooba"),
        ] {
            assert_eq!(base64(text.as_bytes()).as_deref(), Some(bytes.as_bytes()));
        }
        for wrong in ["Z", "Zm9vY", "Zm=v", "Zm9 "] {
            assert_eq!(base64(wrong.as_bytes()), None);
        }
    }

    #[test]
    fn escapes_become_bytes() {
        assert_eq!(unescape("a%20b%2fc%zz%4"), b"a b/c%zz%4");
    }

    #[test]
    fn what_git_lfs_left_behind_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 132\n";
        std::fs::write(folder.path().join("a.bin"), pointer).expect("a file");
        let scene = folder.path().join("a.gltf");
        // However few bytes are asked for.
        for most in [1, 1000] {
            let told =
                fetch(&scene, "a.bin", "/buffers/0/uri", most, false).map_err(|e| e.to_string());
            let expected = "a.bin: cannot be read: it is a pointer of Git LFS, not the file itself — fetch it with `git lfs pull`";
            assert!(told.is_err_and(|told| told.ends_with(expected)));
        }
    }

    #[test]
    fn backslashes_are_slashes_where_no_name_holds_them() {
        let folder = tempfile::tempdir().expect("a folder");
        let (scene, inner) = (
            folder.path().join("models/a.gltf"),
            folder.path().join("Textures"),
        );
        std::fs::create_dir(folder.path().join("models")).expect("a folder");
        std::fs::create_dir(&inner).expect("a folder");
        std::fs::write(inner.join("x.png"), "x").expect("a file");
        let read =
            |uri| fetch(&scene, uri, "/images/0/uri", 9, true).map_err(|error| error.to_string());
        assert_eq!(read("..\\Textures\\x.png"), Ok(b"x".to_vec()));
        assert_eq!(read("..%5CTextures%5Cx.png"), Ok(b"x".to_vec()));
        assert!(
            read("..\\Textures\\y.png").is_err_and(|told| told.contains("Textures/y.png: cannot"))
        );
    }

    #[test]
    fn addresses_are_refused_and_missing_files_named() {
        let told = |uri| {
            fetch(Path::new("dir/a.gltf"), uri, "/buffers/0/uri", 9, false)
                .map_err(|error| error.to_string())
        };
        assert!(
            told("https://example.org/a.bin")
                .is_err_and(|told| told.contains("download what it points to"))
        );
        assert!(
            told("no%20where.bin")
                .is_err_and(|told| told.starts_with("dir/no where.bin: cannot be read"))
        );
        assert!(
            told("data:application/octet-stream;base64,Zm9v!")
                .is_err_and(|told| told.contains("/buffers/0/uri"))
        );
        assert_eq!(told("data:,f%6fo"), Ok(b"foo".to_vec()));
        let folder = fetch(Path::new("a.gltf"), "src", "/buffers/0/uri", 9, false)
            .map_err(|error| error.to_string());
        assert!(folder.is_err_and(|told| told.starts_with("src: cannot be read: it is a folder")));
        for path in [
            "/etc/a",
            "%2fetc/a",
            "C:/a",
            "C:a",
            "c%3Aa",
            "\\\\a\\b",
            "\\a",
            "../a",
            "%2e%2e/a",
            "a/../../b",
        ] {
            assert!(
                told(path)
                    .is_err_and(|told| told.contains("expected a file inside the scene's folder")),
                "{path}"
            );
        }
        for (path, read) in [("a/../b", "dir/a/../b"), ("./a%20b.png", "dir/./a b.png")] {
            let read = format!("{read}: cannot be read");
            assert!(
                told(path).is_err_and(|told| told.starts_with(&read)),
                "{path}"
            );
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_lead_out_of_the_folder_only_where_that_is_allowed() {
        let home = tempfile::tempdir().expect("a folder");
        let at = |name: &str| home.path().join(name);
        std::fs::create_dir(at("in")).expect("a folder");
        for name in ["out.bin", "in/own.bin"] {
            std::fs::write(at(name), "x").expect("a file");
        }
        for (link, target) in [("in/far.bin", "../out.bin"), ("in/near.bin", "own.bin")] {
            std::os::unix::fs::symlink(target, at(link)).expect("a link");
        }
        let read = |uri, external| fetch(&at("in/a.gltf"), uri, "/buffers/0/uri", 9, external);
        assert!(read("near.bin", false).is_ok());
        let told = read("far.bin", false).map_err(|error| error.to_string());
        assert!(
            told.is_err_and(
                |told| told.ends_with("add --allow-external for a scene that you trust")
            )
        );
        for uri in ["far.bin", "../out.bin", "%2e%2e/out.bin"] {
            assert!(read(uri, true).is_ok(), "{uri}");
        }
    }
}
