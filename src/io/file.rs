//! A frame on disk: encoded in memory, written beside its place, then renamed into it once the disk has all of it.
//!
//! So a file that is there is whole, whenever the run was cut: what watches the folder never sees half a frame.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::image::{Tone, film::Image};
use crate::io::channel::ImageChannel;
use crate::io::destination::{self, Destination};
use crate::io::part::{self, PartFile};
use crate::io::pattern::FileKind;
use crate::io::{exr, manifest, png};
use crate::settings::PngBits;

/// How images are written.
#[derive(Clone, Copy, Debug, Default)]
pub struct Format {
    /// Exposure and tone curve of PNG.
    pub tone: Tone,
    /// Bits of its channels.
    pub png_bits: PngBits,
    /// 32-bit floats in EXR instead of 16-bit halves.
    pub exr_float: bool,
    /// Frames per second, for EXR to say; 0 for nothing.
    pub fps: f64,
}

/// Write an image: as PNG in a tone, or as EXR in linear radiance (which no exposure and no curve changes).
///
/// `channels` are further layers of an EXR; `notes` are kept in the file as text.
/// Folders that are missing are made, and a file that is there is replaced. Returns the checksum of its bytes.
pub fn write(
    path: &Path,
    kind: FileKind,
    image: &Image,
    channels: &[ImageChannel],
    format: Format,
    notes: &[(String, String)],
) -> Result<String> {
    let encoded = image.validate().and_then(|()| match kind {
        FileKind::Png => png::encode(image, format.tone, format.png_bits, notes),
        FileKind::Exr => exr::encode(image, channels, format.exr_float, format.fps, notes),
    });
    let bytes = encoded.map_err(|reason| Error::Write {
        path: path.into(),
        reason,
        way_out: "render at another size or in another format (.png, .exr)".into(),
    })?;
    replace(path, &bytes)?;
    Ok(manifest::checksum(&bytes))
}

/// Put bytes into a file, all at once: either the old content is there or the new one. Links are followed; a pipe, a device
/// or a standard stream gets the bytes written into it.
pub fn replace(path: &Path, bytes: &[u8]) -> Result<()> {
    persist(path, bytes).map_err(|source| refused(path, &source))
}

/// Let a file be written in pieces, or by another program: it is there once all of it is.
pub fn whole(
    path: &Path,
    write: impl FnOnce(&mut PartFile) -> std::result::Result<(), String>,
) -> std::result::Result<(), String> {
    let told = |error: io::Error| error.to_string();
    let place = Destination::of(path);
    if let Destination::File(path) = &place {
        let mut part = temporary(path).map_err(told)?;
        write(&mut part)?;
        return part.persist(path).map_err(told);
    }
    // A stream cannot be searched, as encoders do: it gets a copy.
    let mut part = PartFile::new(&std::env::temp_dir()).map_err(told)?;
    write(&mut part)?;
    let bytes = fs::read(part.path()).map_err(told)?;
    match place.pour(&bytes).map_err(told)? {
        true => Ok(()),
        false => Err(told(io::ErrorKind::IsADirectory.into())),
    }
}

/// Find out whether a file could be written, before hours of work depend on it: makes its folder, and a file in it. Both go
/// again where they are new, and what a killed run left there is removed.
pub fn check(path: &Path) -> Result<()> {
    let tried = match Destination::of(path) {
        Destination::File(file) => tried_in(destination::folder(&file)),
        Destination::Folder(_) => Err(io::ErrorKind::IsADirectory.into()),
        Destination::Stdout | Destination::Stderr | Destination::Stream(_) => Ok(()),
    };
    tried.map_err(|source| refused(path, &source))
}

/// Makes a folder and a file in it, and removes what of them was not there before.
fn tried_in(folder: &Path) -> io::Result<()> {
    let new: Vec<PathBuf> = (folder.ancestors())
        .take_while(|folder| !folder.as_os_str().is_empty() && !folder.exists())
        .map(PathBuf::from)
        .collect();
    fs::create_dir_all(folder)?;
    let tried = PartFile::new(folder).map(drop);
    part::sweep(folder);
    for folder in new {
        // Another run may have begun to use it.
        let _ = fs::remove_dir(folder);
    }
    tried
}

/// Write a temporary file in the same folder, where renaming is atomic, and rename it.
fn persist(path: &Path, bytes: &[u8]) -> io::Result<()> {
    match Destination::of(path) {
        Destination::File(path) => {
            let mut part = temporary(&path)?;
            part.file()?.write_all(bytes)?;
            part.persist(&path)
        }
        Destination::Folder(_) => Err(io::ErrorKind::IsADirectory.into()),
        stream => stream.pour(bytes).map(drop),
    }
}

/// A new file beside the one that is to be written.
fn temporary(path: &Path) -> io::Result<PartFile> {
    let folder = destination::folder(path);
    fs::create_dir_all(folder)?;
    PartFile::new(folder)
}

/// The error for what the system refused to write.
fn refused(path: &Path, source: &io::Error) -> Error {
    Error::Write {
        path: path.into(),
        reason: source.to_string(),
        way_out: way_out(source).into(),
    }
}

/// How to get on after the system refused to write.
fn way_out(source: &io::Error) -> &'static str {
    match source.kind() {
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            "name a folder that you may write to, e.g. -o ~/frames/frame_####.png"
        }
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "free some space or name another disk"
        }
        io::ErrorKind::FileTooLarge => {
            "raise the limit of a file's size (ulimit -f), or write a smaller picture"
        }
        io::ErrorKind::NotADirectory | io::ErrorKind::AlreadyExists => {
            "a file stands where a folder is needed: move it away or name another folder"
        }
        io::ErrorKind::IsADirectory => {
            "a folder of this name is there: move it away or name another file"
        }
        io::ErrorKind::InvalidFilename => "name a shorter file",
        _ => "check the path, or name another folder",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The names in a folder.
    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("a folder");
        let mut names: Vec<String> = entries
            .map(|entry| {
                entry
                    .expect("an entry")
                    .file_name()
                    .to_string_lossy()
                    .into_owned()
            })
            .collect();
        names.sort();
        names
    }

    /// Writes an image without layers and notes.
    fn plain(path: &Path, kind: FileKind, image: &Image) -> Result<()> {
        write(path, kind, image, &[], Format::default(), &[]).map(drop)
    }

    #[test]
    fn folders_are_made_and_nothing_else_is_left() {
        let folder = tempfile::tempdir().expect("a folder");
        let deep = folder.path().join("a/b");
        let image = Image::black(4, 3);
        plain(&deep.join("x_0000.png"), FileKind::Png, &image).expect("a PNG");
        plain(&deep.join("x_0000.exr"), FileKind::Exr, &image).expect("an EXR");
        plain(&deep.join("x_0000.png"), FileKind::Png, &image).expect("a PNG again");
        assert_eq!(names(&deep), ["x_0000.exr", "x_0000.png"]);
        assert!(
            fs::read(deep.join("x_0000.png"))
                .expect("a file")
                .starts_with(b"\x89PNG")
        );
        assert!(
            fs::read(deep.join("x_0000.exr"))
                .expect("a file")
                .starts_with(&[0x76, 0x2f, 0x31, 0x01])
        );
    }

    #[test]
    fn the_same_image_gives_the_same_bytes() {
        let folder = tempfile::tempdir().expect("a folder");
        let image = Image {
            width: 64,
            height: 40,
            radiance: (0..64 * 40)
                .map(|pixel| [pixel as f32 * 1e-3, (pixel % 64) as f32, 0.5])
                .collect(),
        };
        for (kind, name) in [(FileKind::Png, "png"), (FileKind::Exr, "exr")] {
            let [first, second] = ["1", "2"].map(|take| {
                let path = folder.path().join(format!("{take}.{name}"));
                write(
                    &path,
                    kind,
                    &image,
                    &[],
                    Format::default(),
                    &[("scene".into(), "x".into())],
                )
                .expect("a file");
                fs::read(path).expect("a file")
            });
            assert!(first == second, "{name} differs");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_and_its_file_is_replaced() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("inner")).expect("a folder");
        for (link, target) in [
            ("old", "inner/old"),
            ("new", "inner/new"),
            ("null", "/dev/null"),
        ] {
            std::os::unix::fs::symlink(target, at(link)).expect("a link");
        }
        fs::write(at("inner/old"), "x").expect("a file");
        for link in ["old", "new", "null"] {
            check(&at(link)).expect("a place");
            replace(&at(link), b"bytes").expect("a file");
            let about = fs::symlink_metadata(at(link)).expect("a link");
            assert!(about.is_symlink(), "{link}");
        }
        for name in ["inner/old", "inner/new"] {
            assert_eq!(fs::read(at(name)).expect("a file"), b"bytes");
        }
        assert_eq!(names(&at("inner")), ["new", "old"]);
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("any"), "x").expect("a file");
        replace(&folder.path().join("ours"), b"x").expect("a file");
        let mode = |name: &str| {
            fs::metadata(folder.path().join(name))
                .expect("a file")
                .permissions()
                .mode()
        };
        assert_eq!(mode("ours"), mode("any"));
    }

    #[test]
    fn a_refusal_leaves_nothing_behind_and_names_the_way_out() {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("file"), "x").expect("a file");
        let told = replace(&folder.path().join("file/x.png"), b"x")
            .expect_err("no folder")
            .to_string();
        assert!(
            told.contains("file/x.png: cannot be written: ")
                && told.ends_with("name another folder"),
            "{told}"
        );

        fs::create_dir(folder.path().join("dir")).expect("a folder");
        let error = replace(&folder.path().join("dir"), b"x").expect_err("a folder is there");
        assert_eq!(error.exit_code(), 6);
        assert_eq!(names(folder.path()), ["dir", "file"]);

        let broken = Image {
            width: 2,
            height: 2,
            radiance: Vec::new(),
        };
        let told =
            plain(&folder.path().join("x.png"), FileKind::Png, &broken).expect_err("no pixels");
        assert!(
            told.to_string().contains("an image of 2x2 holds 0 pixels"),
            "{told}"
        );
        assert_eq!(names(folder.path()), ["dir", "file"]);
    }
}
