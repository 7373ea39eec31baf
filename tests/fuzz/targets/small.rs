//! A file with something of everything, with settings under which it is solved in milliseconds.

#[expect(dead_code, reason = "the tests use all of it, the fuzzer one file")]
#[path = "../../renderer/support/all_features.rs"]
mod all_features;

use std::path::Path;
use sweeplight::settings::Settings;

/// Writes the file into a folder, and gives its settings.
pub(crate) fn settings(folder: &Path) -> Settings {
    let file = folder.join("rich.glb");
    std::fs::write(&file, all_features::rich().glb()).expect("a file is written");
    let mut settings = Settings::new(file);
    settings.scene.frames = Some(vec![0]);
    settings.solve.elements = Some(50);
    settings.solve.samples = Some(16);
    settings.solve.light_samples = 1;
    settings.solve.threads = Some(1);
    settings.image.finish_samples = 4;
    settings.image.size = (8, 4);
    settings
}
