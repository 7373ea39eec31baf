//! The manifest keeps its word: what it depends on builds with the compiler that it names.

use serde_json::Value;
use std::process::Command;

/// A version of the compiler, `1.89` or `1.89.0`, as numbers that compare.
fn version(text: &str) -> Vec<u32> {
    let numbers = text.split('.').map(|number| number.parse());
    let mut numbers: Vec<u32> = numbers.collect::<Result<_, _>>().expect("a version");
    numbers.resize(3, 0);
    numbers
}

#[test]
fn no_package_asks_for_a_later_compiler() {
    let rustc = Command::new("rustc")
        .arg("-vV")
        .output()
        .expect("rustc starts");
    let about = String::from_utf8(rustc.stdout).expect("text");
    let host = about.lines().find_map(|line| line.strip_prefix("host: "));
    // Packages for other systems may not have been fetched.
    let metadata = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--offline"])
        .args(["--filter-platform", host.expect("a host")])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo starts");
    let metadata: Value = serde_json::from_slice(&metadata.stdout).expect("JSON");
    let packages = metadata["packages"].as_array().expect("packages");
    assert!(packages.len() > 20);
    let ours = version(env!("CARGO_PKG_RUST_VERSION"));
    for package in packages {
        if let Some(asked) = package["rust_version"].as_str() {
            assert!(
                version(asked) <= ours,
                "{} asks for {asked}",
                package["name"]
            );
        }
    }
}
