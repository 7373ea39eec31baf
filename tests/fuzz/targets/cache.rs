//! Any bytes, as a preparation in the cache: it is used or made anew. Its label and its checksum are set right, as damage that
//! they find would hide the rest.
#![no_main]

mod small;

use libfuzzer_sys::fuzz_target;
use std::fs;
use std::path::PathBuf;
use std::sync::LazyLock;
use sweeplight::sequence::prepare::prepare;
use sweeplight::sequence::silence;
use sweeplight::settings::Settings;
use tempfile::TempDir;

/// A scene with its preparation.
struct Kept {
    _folder: TempDir,
    settings: Settings,
    file: PathBuf,
    label: Vec<u8>,
}

impl Kept {
    fn new() -> Kept {
        let folder = tempfile::tempdir().expect("a folder");
        let mut settings = small::settings(folder.path());
        let cache = folder.path().join("cache");
        settings.output.cache = Some(cache.clone());
        prepare(&settings, &silence).expect("a preparation");
        let mut entries = fs::read_dir(cache).expect("a folder");
        let file = entries.next().expect("a file").expect("an entry").path();
        // A file is named by its key, with which its label ends.
        let bytes = fs::read(&file).expect("a file");
        let name = file
            .file_name()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        let hex = |bytes: &[u8]| -> String { bytes.iter().map(|b| format!("{b:02x}")).collect() };
        let is_end = |end: &usize| name.contains(&hex(&bytes[end - 32..*end]));
        let end = (32..128).find(is_end).expect("a label");
        if let Some(seed) = std::env::var_os("SEED") {
            fs::write(seed, &bytes[end..bytes.len() - 32]).expect("a seed is written");
        }
        let label = bytes[..end].to_vec();
        Kept {
            _folder: folder,
            settings,
            file,
            label,
        }
    }
}

static KEPT: LazyLock<Kept> = LazyLock::new(Kept::new);

fuzz_target!(|content: &[u8]| {
    let mut bytes = KEPT.label.clone();
    bytes.extend(content);
    let checksum = *blake3::hash(&bytes).as_bytes();
    bytes.extend(checksum);
    fs::write(&KEPT.file, &bytes).expect("a file is written");
    prepare(&KEPT.settings, &silence).expect("it is read, or made anew");
});
