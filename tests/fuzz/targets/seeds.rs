//! Writes valid files for the fuzzer to start from, into the folder that is named.

#[expect(dead_code, reason = "the tests use all of it, the fuzzer one file")]
#[path = "../../renderer/support/all_features.rs"]
mod all_features;

fn main() -> std::io::Result<()> {
    let folder =
        std::path::PathBuf::from(std::env::args_os().nth(1).unwrap_or("corpus/open".into()));
    std::fs::create_dir_all(&folder)?;
    let rich = all_features::rich();
    std::fs::write(folder.join("rich.glb"), rich.glb())?;
    std::fs::write(folder.join("rich.gltf"), rich.json.to_string())
}
