//! The scene's folder: the only one of which a message may name a file.

use serde_json::Value;
use std::path::{Path, PathBuf};

/// Scene files that are offered, at most.
const MOST_FILES: usize = 200;

/// The folder of a scene file.
pub(super) fn of(scene: &Path) -> PathBuf {
    let folder = scene.parent().unwrap_or(Path::new(""));
    match folder.as_os_str().is_empty() {
        true => ".".into(),
        false => folder.into(),
    }
}

/// The scene files in a folder, sorted by name.
pub(super) fn scenes(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let mut names: Vec<String> = names.filter(|name| is_scene(Path::new(name))).collect();
    names.sort();
    names.truncate(MOST_FILES);
    names
}

fn is_scene(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
    ending.is_some_and(|ending| ending == "glb" || ending == "gltf")
}

/// Lets the files that edits add be those of the folder, and refuses all others; the error is for the one who sent them.
pub(super) fn keep_within(edits: &mut Value, folder: &Path) -> Result<(), String> {
    let adds = edits.as_array_mut().into_iter().flatten();
    for add in adds.filter_map(|edit| edit.get_mut("add")) {
        let Some(Value::String(file)) = add.get_mut("file") else {
            continue;
        };
        let path = folder.join(&*file);
        let inside = folder
            .canonicalize()
            .and_then(|folder| Ok((folder, path.canonicalize()?)));
        let is_inside = inside.is_ok_and(|(folder, path)| path.starts_with(folder));
        if !is_inside || !is_scene(&path) {
            return Err(format!(
                "add.file: expected a .glb or .gltf file in the scene's folder, got '{file}' — copy the file there"
            ));
        }
        *file = path.to_string_lossy().into_owned();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn files_outside_the_folder_are_refused() {
        let outer = tempfile::tempdir().expect("a folder");
        let folder = outer.path().join("scene");
        std::fs::create_dir(&folder).expect("a folder");
        std::fs::write(outer.path().join("secret.glb"), "x").expect("a file");
        std::fs::write(folder.join("lamp.glb"), "x").expect("a file");
        std::fs::write(folder.join("note.txt"), "x").expect("a file");
        #[cfg(unix)]
        std::os::unix::fs::symlink(outer.path().join("secret.glb"), folder.join("link.glb"))
            .expect("a link");
        let added = |file: &str| {
            let mut edits = json!([{ "add": { "file": file } }]);
            keep_within(&mut edits, &folder).map(|()| edits)
        };
        assert!(added("lamp.glb").is_ok());
        let absolute = outer.path().join("secret.glb");
        let absolute = absolute.to_string_lossy();
        for file in [
            "../secret.glb",
            "link.glb",
            "note.txt",
            "none.glb",
            "",
            &absolute,
        ] {
            assert!(added(file).is_err(), "{file}");
        }
        assert_eq!(
            scenes(&folder).first().map(String::as_str),
            Some("lamp.glb")
        );
    }
}
