//! A name means one thing: no type is defined twice.

use crate::code;
use std::collections::BTreeMap;

/// Numbers of definitions of each type in some code.
fn defined<'a>(codes: impl Iterator<Item = &'a str>) -> BTreeMap<String, usize> {
    let mut defined = BTreeMap::new();
    for line in codes.flat_map(str::lines) {
        let mut words = line.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
        let is_kind = |word: &str| matches!(word, "struct" | "enum" | "union" | "trait");
        let Some(at) = words.clone().position(is_kind) else {
            continue;
        };
        // Nothing stands before it but its visibility.
        let mut before = words.clone().take(at);
        let alone = before.all(|word| matches!(word, "" | "pub" | "crate" | "super" | "in"));
        if let (true, Some(name)) = (alone, words.nth(at + 1)) {
            *defined.entry(name.to_string()).or_default() += 1;
        }
    }
    defined
}

#[test]
fn each_type_is_defined_once() {
    let files = code::files();
    let mut found = defined(files.iter().map(|file| file.code.as_str()));
    found.retain(|_, times| *times > 1);
    assert!(
        found.is_empty(),
        "types are defined more than once: {found:?}"
    );
}

#[test]
fn definitions_are_counted() {
    let code = "pub(crate) struct Ray<T> {\n    structure: u32,\n}\nenum Ray { A }\nlet union = 1;\nimpl Trait for Ray {}";
    assert_eq!(
        defined([code].into_iter()),
        BTreeMap::from([("Ray".to_string(), 2)])
    );
}
