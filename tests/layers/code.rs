//! The source as text: its files, its code without comments and literals, and the paths that the code names.

use std::fs;
use std::path::Path;

/// A file below `src`.
pub(crate) struct File {
    /// Its path below `src`, as `solver/rows.rs`.
    pub(crate) name: String,
    /// Its code: no comments, no literals, no tests.
    pub(crate) code: String,
}

/// All Rust files below `src`, sorted, but those that hold tests alone.
pub(crate) fn files() -> Vec<File> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    read(&src, "", &mut files);
    files.retain(|file| !file.name.ends_with("tests.rs") && !file.name.contains("/tests/"));
    files.sort_by(|a, b| a.name.cmp(&b.name));
    files
}

fn read(folder: &Path, above: &str, files: &mut Vec<File>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let last = path.file_name().expect("a name").to_string_lossy();
        let name = format!("{above}{last}");
        if path.is_dir() {
            read(&path, &format!("{name}/"), files);
        } else if last.ends_with(".rs") {
            let text = fs::read_to_string(&path).expect("text");
            let code = without_tests(&bare(&text));
            files.push(File { name, code });
        }
    }
}

/// Code in which spaces stand for comments, strings and characters.
pub(crate) fn bare(text: &str) -> String {
    let mut rest = text;
    let mut code = String::new();
    while let Some(first) = rest.chars().next() {
        let length = literal(rest).unwrap_or(0);
        if length > 0 {
            let lines = rest[..length].matches('\n').count();
            code += " ";
            code.extend(std::iter::repeat_n('\n', lines));
            rest = &rest[length..];
            continue;
        }
        // A whole word at once, so that the r of `for"` opens no raw string.
        let word = rest.len() - rest.trim_start_matches(is_of_word).len();
        let length = word.max(first.len_utf8());
        code += &rest[..length];
        rest = &rest[length..];
    }
    code
}

/// The length of the comment, string or character that code begins with.
fn literal(code: &str) -> Option<usize> {
    let until = |from: usize, end: &str| {
        Some(
            code[from..]
                .find(end)
                .map_or(code.len(), |at| from + at + end.len()),
        )
    };
    if code.starts_with("//") {
        return Some(code.find('\n').unwrap_or(code.len()));
    }
    if code.starts_with("/*") {
        return until(2, "*/");
    }
    for start in ["r", "br"] {
        let Some(hashes) = code.strip_prefix(start) else {
            continue;
        };
        let number = hashes.len() - hashes.trim_start_matches('#').len();
        if hashes[number..].starts_with('"') {
            let end = format!("\"{}", "#".repeat(number));
            return until(start.len() + number + 1, &end);
        }
    }
    let opened = usize::from(code.starts_with("b\"") || code.starts_with("b'"));
    match code.as_bytes().get(opened)? {
        b'"' => Some(opened + quoted(&code[opened..], '"')),
        // A lifetime has no second quote where a character has one.
        b'\'' => {
            let mut inner = code[opened + 1..].chars();
            let character = match inner.next()? {
                '\\' => true,
                _ => inner.next()? == '\'',
            };
            character.then(|| opened + quoted(&code[opened..], '\''))
        }
        _ => None,
    }
}

/// The length of a text in quotes, with those.
fn quoted(code: &str, quote: char) -> usize {
    let mut escaped = true;
    for (at, letter) in code.char_indices() {
        match letter {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            _ if letter == quote => return at + 1,
            _ => {}
        }
    }
    code.len()
}

/// Code without its modules of tests.
pub(crate) fn without_tests(code: &str) -> String {
    const MARK: &str = "#[cfg(test)]";
    let mut kept = String::new();
    let mut rest = code;
    while let Some(at) = rest.find(MARK) {
        kept += &rest[..at];
        rest = &rest[at + MARK.len()..];
        // The item ends with the brace that closes its first one, or with a semicolon before any.
        let mut depth = 0;
        let end = rest.char_indices().find(|(_, letter)| {
            depth += i32::from(*letter == '{') - i32::from(*letter == '}');
            depth == 0 && (*letter == '}' || *letter == ';')
        });
        rest = end.map_or("", |(at, _)| &rest[at + 1..]);
    }
    kept + rest
}

fn is_of_word(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_'
}

/// A path that code names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Named {
    /// Its steps: `crate`, `geometry`, `Ray`.
    pub(crate) steps: Vec<String>,
    /// The name that a `pub use` gives it here.
    pub(crate) exported: Option<String>,
}

/// All paths of more than one step that bare code names; lists, wrapped or nested, are taken apart.
pub(crate) fn paths(code: &str) -> Vec<Named> {
    let words = words(code);
    let mut paths = Vec::new();
    let mut at = 0;
    while at < words.len() {
        let used = words[at] == "use";
        let public = used && at > 0 && matches!(words[at - 1], "pub" | ")");
        at += usize::from(used);
        // `pub(in crate::gltf)` says who may use an item, and uses nothing.
        if words[at..].starts_with(&["pub", "(", "in"]) {
            at += words[at..]
                .iter()
                .position(|word| *word == ")")
                .unwrap_or(3);
            continue;
        }
        if !used && words.get(at + 1) != Some(&"::") {
            at += 1;
            continue;
        }
        let before = paths.len();
        let next = tree(&words, at, &[], &mut paths);
        if !public {
            paths[before..]
                .iter_mut()
                .for_each(|path| path.exported = None);
        }
        at = next.max(at + 1);
    }
    paths.retain(|path: &Named| path.steps.len() > 1);
    paths
}

/// Reads one path, or a list of them, from a word on; gives the first word behind it.
fn tree(words: &[&str], mut at: usize, above: &[String], paths: &mut Vec<Named>) -> usize {
    let mut steps = above.to_vec();
    while let Some(&word) = words.get(at) {
        if word == "{" && !steps.is_empty() {
            at += 1;
            while words.get(at).is_some_and(|word| *word != "}") {
                at = tree(words, at, &steps, paths).max(at + 1);
                at += usize::from(words.get(at) == Some(&","));
            }
            return at + 1;
        }
        if !word.starts_with(is_of_word) && word != "*" {
            break;
        }
        if word != "self" || steps.is_empty() {
            steps.push(word.into());
        }
        at += 1;
        if words.get(at) != Some(&"::") {
            break;
        }
        at += 1;
    }
    let mut exported = steps.last().cloned();
    if words.get(at) == Some(&"as") {
        exported = words.get(at + 1).map(|word| word.to_string());
        at += 2;
    }
    if !steps.is_empty() {
        paths.push(Named { steps, exported });
    }
    at
}

/// Code as words and marks.
fn words(code: &str) -> Vec<&str> {
    let mut words = Vec::new();
    let mut rest = code.trim_start();
    while let Some(first) = rest.chars().next() {
        let word = rest.len() - rest.trim_start_matches(is_of_word).len();
        let length = match word {
            0 if rest.starts_with("::") => 2,
            0 => first.len_utf8(),
            _ => word,
        };
        words.push(&rest[..length]);
        rest = rest[length..].trim_start();
    }
    words
}

#[test]
fn paths_are_found_in_lists_wrapped_and_nested() {
    let code = "pub use crate::{\n    geometry::{Ray, bounds::{self, Aabb}},\n    mesh,\n};\n\
        fn f(x: &'a str) { super::rows::all(\"crate::a\", '\"', r#\"crate::b\"#) } // crate::c\n\
        use super::cut::Cut as Knife;\n\
        pub(in crate::solver::rows) fn g() {}";
    let found = paths(&bare(code));
    let told: Vec<String> = found
        .iter()
        .map(|path| {
            format!(
                "{} {}",
                path.steps.join("::"),
                path.exported.as_deref().unwrap_or("-")
            )
        })
        .collect();
    assert_eq!(
        told,
        [
            "crate::geometry::Ray Ray",
            "crate::geometry::bounds bounds",
            "crate::geometry::bounds::Aabb Aabb",
            "crate::mesh mesh",
            "super::rows::all -",
            "super::cut::Cut -",
        ]
    );
}

#[test]
fn tests_are_left_out() {
    let code = "fn a() {}\n#[cfg(test)]\nmod tests {\n    fn b() { if c {} }\n}\n#[cfg(test)]\nmod d;\nfn e() {}";
    let kept = without_tests(code);
    assert_eq!(
        kept.split_whitespace().collect::<Vec<_>>().join(" "),
        "fn a() {} fn e() {}"
    );
}
