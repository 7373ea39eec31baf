//! The manifest keeps its word: what it depends on builds with the compiler that it names, comes from crates.io, and may be given
//! on under the licences of `deny.toml`. `cargo deny check` looks for known faults as well.

use serde_json::Value;
use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;

/// Where packages come from.
const REGISTRY: &str = "registry+https://github.com/rust-lang/crates.io-index";

/// The packages, as cargo tells of them.
static PACKAGES: LazyLock<Vec<Value>> = LazyLock::new(|| {
    let rustc = Command::new("rustc").arg("-vV").output();
    let about = String::from_utf8(rustc.expect("rustc starts").stdout).expect("text");
    let host = about.lines().find_map(|line| line.strip_prefix("host: "));
    // Packages for other systems may not have been fetched.
    let metadata = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--offline"])
        .args(["--filter-platform", host.expect("a host")])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo starts");
    let metadata: Value = serde_json::from_slice(&metadata.stdout).expect("JSON");
    let packages = metadata["packages"].as_array().expect("packages").clone();
    assert!(packages.len() > 20);
    packages
});

/// A version of the compiler, `1.89` or `1.89.0`, as numbers that compare.
fn version(text: &str) -> Vec<u32> {
    let numbers = text.split('.').map(|number| number.parse());
    let mut numbers: Vec<u32> = numbers.collect::<Result<_, _>>().expect("a version");
    numbers.resize(3, 0);
    numbers
}

#[test]
fn no_package_asks_for_a_later_compiler() {
    let ours = version(env!("CARGO_PKG_RUST_VERSION"));
    for package in &*PACKAGES {
        if let Some(asked) = package["rust_version"].as_str() {
            assert!(
                version(asked) <= ours,
                "{} asks for {asked}",
                package["name"]
            );
        }
    }
}

/// The licences that `deny.toml` allows: the words in quotation marks in its list.
fn allowed() -> Vec<String> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("deny.toml");
    let text = std::fs::read_to_string(file).expect("text");
    let list = text
        .split_once("allow = [")
        .and_then(|(_, rest)| rest.split_once(']'));
    let words = list.expect("a list").0.split('"').skip(1).step_by(2);
    words.map(String::from).collect()
}

#[test]
fn packages_come_from_one_place_under_licences_that_are_allowed() {
    let allowed = allowed();
    assert!(allowed.len() > 2);
    for package in &*PACKAGES {
        let name = &package["name"];
        let source = package["source"].as_str();
        assert!(
            source.is_none_or(|source| source == REGISTRY),
            "{name}: {source:?}"
        );
        let licence = package["license"].as_str().expect("a licence");
        let expression = spdx::Expression::parse_mode(licence, spdx::ParseMode::LAX);
        let expression = expression.unwrap_or_else(|error| panic!("{name}: {error}"));
        let may = expression.evaluate(|asked| {
            let id = asked.license.id();
            asked.addition.is_none() && id.is_some_and(|id| allowed.iter().any(|a| a == id.name))
        });
        assert!(may, "{name} is under {licence}");
    }
}
